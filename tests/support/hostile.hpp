// Hard treatment of a pool through the C ABI, and what came of it: actions that jump, extreme drives and
// masses, pushes. Used by test_hostile.cpp and bench_hostile.cpp.
#pragma once
#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include <redman/redman.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <vector>

namespace hostile {

// Actions of a step: uniform draws, all joints jumping between -1 and +1, or each with a sign of its own
// that is drawn anew in one of 16 steps.
enum class Actions { kRandom, kJump, kSigns };

struct Case {
  const char* name;
  Actions actions;
  double push;  // N, on a random shape in one of 8 steps of a world; 0: none
  std::vector<rdm_option> options;
};

inline std::vector<Case> cases() {
  const rdm_option stiff{"scale.kp", nullptr, 100}, undamped{"scale.kd", nullptr, 0.01},
      limp{"scale.kp", nullptr, 0.01}, damped{"scale.kd", nullptr, 100}, light{"object_mass", nullptr, 0.001},
      heavy{"object_mass", nullptr, 5};
  return {
      {"random", Actions::kRandom, 0, {}},
      {"jump", Actions::kJump, 0, {}},
      {"signs", Actions::kSigns, 0, {}},
      {"stiff", Actions::kRandom, 0, {stiff, undamped}},
      {"limp", Actions::kRandom, 0, {limp, damped}},
      {"stiff_signs", Actions::kSigns, 0, {stiff, undamped}},
      {"light", Actions::kRandom, 0, {light}},
      {"heavy", Actions::kRandom, 0, {heavy}},
      {"push", Actions::kRandom, 1000, {}},
      {"all_light", Actions::kSigns, 1000, {stiff, undamped, light}},
      {"all_heavy", Actions::kSigns, 1000, {stiff, undamped, heavy}},
  };
}

// Largest values over all steps and worlds. Speeds are means over a control step, from differences.
struct Figures {
  int64_t steps = 0;           // control steps of one world, resets left out
  int64_t episodes = 0;        // that ended
  int64_t not_finite = 0;      // steps with a number in any buffer, pose or contact that is not finite
  int64_t diverged = 0;        // steps with RDM_STATUS_DIVERGED
  int64_t overflowed = 0;      // steps with RDM_STATUS_CONTACTS
  int64_t other = 0;           // steps with any other bit than those, RDM_STATUS_SOLVER and RDM_STATUS_SLOWED
  int64_t unflagged = 0;       // steps whose status has no bit, but a value beyond the bounds below
  int64_t stuck = 0;           // longest run of diverged steps of one world, resets left out
  double contacts_mean = 0;    // per step, of the last substep
  int32_t contacts_max = 0;    // of the library's own list
  double object_distance = 0;  // m, from the world's origin
  double object_speed = 0;     // m/s
  double object_height = -1e9;  // m
  double joint_rate = 0;        // rad/s
  double joint_excess = 0;      // rad, beyond a joint's range
  double tip_fast = 0;          // share of fingertip velocity entries at the bound of the observation, 5 m/s
  double rotation_error = 0;    // of the object's quaternion from unit length
  double contact_depth = 0;     // m
  double contact_force = 0;     // N
};

struct Event {   // the first divergences
  int64_t step;  // of the pool, from 0
  int32_t env;
  uint32_t status;
};

// Joints stay within their ranges and the engines' margin (5e-3 rad), rotations are of unit length. The
// drives of a thumb do 9.5 J over their ranges, with which 1 g would have 138 m/s; more only comes from
// pushes.
constexpr double kJointExcess = 0.006, kRotationError = 1e-3, kDrivenSpeed = 150;
constexpr double kLinkMass = 0.01;  // kg, of the lightest link that can be pushed

class Trial {
 public:
  Trial(const char* task, const char* engine, const Case& hard, int32_t envs, uint64_t seed)
      : case_(hard), envs_(envs), random_(seed) {
    std::vector<rdm_option> options = hard.options;
    options.push_back({"engine", engine, 0});
    rdm_pool_config c;
    rdm_pool_config_init(&c, sizeof c);
    c.task = task;
    c.num_envs = envs;
    c.seed = seed;
    c.autoreset = RDM_AUTORESET_NEXT_STEP;  // the last pose of an episode can be looked at
    c.options = options.data();
    c.num_options = static_cast<int32_t>(options.size());
    if (rdm_pool_create(&pool_, &c)) return;
    spec_.struct_size = sizeof spec_;
    rows_.struct_size = sizeof rows_;
    rdm_pool_get_spec(pool_, &spec_);
    rdm_pool_get_buffers(pool_, &rows_);
    rdm_pool_reset(pool_, nullptr, nullptr);
    find_fields();
    find_shapes();
    const auto n = static_cast<size_t>(envs);
    place_.resize(3 * n);
    angles_.resize(n * halves_.size());
    signs_.resize(n * static_cast<size_t>(spec_.action_dim), 1.0f);
    run_.assign(n, 0);
    pushes_.assign(n, 0);
    mass_ = object_mass();
    for (int32_t env = 0; env < envs; ++env) remember(env);
  }
  ~Trial() { rdm_pool_destroy(pool_); }
  Trial(const Trial&) = delete;
  Trial& operator=(const Trial&) = delete;

  rdm_pool* pool() const { return pool_; }
  const rdm_buffers& rows() const { return rows_; }
  const rdm_spec& spec() const { return spec_; }
  const Figures& figures() const { return figures_; }
  const std::vector<Event>& events() const { return events_; }
  rdm_result result() const { return result_; }  // first failure of a call

  // Steps all worlds once and looks at everything.
  void step() {
    act();
    if (case_.push > 0) push();
    keep(rdm_pool_step(pool_));
    for (int32_t env = 0; env < envs_; ++env) look(env);
    ++time_;
  }

  // What the library counted joins the figures.
  void finish() {
    rdm_pool_stats s{};
    s.struct_size = sizeof s;
    keep(rdm_pool_get_stats(pool_, &s));
    figures_.contacts_mean = s.contacts_mean;
    figures_.contacts_max = s.contacts_max;
    const double entries = 30.0 * static_cast<double>(figures_.steps);
    figures_.tip_fast = entries > 0 ? static_cast<double>(tips_fast_) / entries : 0;
  }

 private:
  void keep(rdm_result r) {
    if (result_ == RDM_OK) result_ = r;
  }

  void find_fields() {
    rdm_field_info f = RDM_INIT(rdm_field_info);
    for (int32_t i = 0; i < spec_.num_fields; ++i) {
      rdm_pool_field_at(pool_, i, &f);
      const std::string name = f.name;
      if (name == "object.position") object_ = f.offset;
      if (name == "object.rotation") rotation_ = f.offset;
      if (name.ends_with("joint_position"))
        for (int32_t k = 0; k < f.count; ++k) {
          rdm_joint_info joint = RDM_INIT(rdm_joint_info);
          rdm_robot_joint_at(0, k, &joint);
          joints_.push_back(f.offset + k);
          halves_.push_back((joint.upper - joint.lower) / 2);
        }
      if (name.ends_with("tip_velocity")) tips_.push_back(f.offset);
    }
  }

  void find_shapes() {
    rdm_shape_info s = RDM_INIT(rdm_shape_info);
    for (int32_t i = 0; i < spec_.num_shapes; ++i) {
      rdm_pool_shape_at(pool_, i, &s);
      const std::string name = s.name;
      if (name == "object") object_shape_ = i;
      const float nothing[3] = {};
      if (rdm_pool_push(pool_, 0, i, nothing) == RDM_OK) pushed_.push_back(i);
    }
    poses_.resize(static_cast<size_t>(spec_.num_shapes));
  }

  double object_mass() const {
    for (const rdm_option& o : case_.options)
      if (std::strcmp(o.key, "object_mass") == 0) return o.number;
    rdm_object_info egg = RDM_INIT(rdm_object_info);
    for (int32_t i = 0; rdm_object_info_at(i, &egg) == RDM_OK && std::strcmp(egg.name, "egg") != 0; ++i)
      continue;
    return egg.mass;
  }

  // What the object may have by the pushes so far: momentum of its own, or the energy of a link's.
  double fastest(size_t env) const {
    const double impulse = case_.push * static_cast<double>(spec_.control_dt);
    return kDrivenSpeed +
           static_cast<double>(pushes_[env]) * impulse / std::sqrt(mass_ * std::min(mass_, kLinkMass));
  }

  void act() {
    if (case_.actions == Actions::kRandom) return keep(rdm_pool_baseline(pool_, RDM_BASELINE_RANDOM));
    const size_t width = static_cast<size_t>(spec_.action_dim);
    const float side = time_ % 2 ? 1.0f : -1.0f;
    for (size_t i = 0; i < signs_.size(); ++i) {
      if (case_.actions == Actions::kSigns && i % width == 0 && random_() % 16 == 0)
        for (size_t k = 0; k < width; ++k) signs_[i + k] = random_() % 2 ? 1.0f : -1.0f;
      rows_.action[i] = side * signs_[i];
    }
  }

  void push() {
    for (int32_t env = 0; env < envs_; ++env) {
      if (random_() % 8) continue;
      // the object as often as all links together
      const int32_t shape = random_() % 2 ? object_shape_ : pushed_[random_() % pushed_.size()];
      double d[3], square = 0;
      for (double& x : d) x = static_cast<double>(random_() >> 11) * 0x1p-52 - 1;
      for (const double x : d) square += x * x;
      float force[3];
      for (int k = 0; k < 3; ++k) force[k] = static_cast<float>(case_.push * d[k] / std::sqrt(square));
      keep(rdm_pool_push(pool_, env, shape, force));
      ++pushes_[static_cast<size_t>(env)];
    }
  }

  static bool finite(const float* row, int32_t count) {
    uint32_t bad = 0;
    for (int32_t i = 0; i < count; ++i) {
      uint32_t bits;
      std::memcpy(&bits, row + i, sizeof bits);
      bad |= (bits & 0x7f800000u) == 0x7f800000u;
    }
    return bad == 0;
  }

  bool rows_finite(int32_t env) const {
    const auto row = [env](const float* p, int32_t width) {
      return finite(p + static_cast<size_t>(env) * static_cast<size_t>(width), width);
    };
    return row(rows_.obs, spec_.obs_dim) && row(rows_.final_obs, spec_.obs_dim) &&
           row(rows_.action, spec_.action_dim) && row(rows_.reward, 1) && row(rows_.cost, spec_.cost_dim) &&
           row(rows_.cost_raw, spec_.cost_dim) && row(rows_.episode_return, 1) &&
           row(rows_.episode_cost, spec_.cost_dim);
  }

  const float* obs(int32_t env) const {
    return rows_.obs + static_cast<size_t>(env) * static_cast<size_t>(spec_.obs_dim);
  }

  // Where the object is; beyond the bound of the observation from the poses. False when a pose is not finite.
  bool place(int32_t env, double* p) {
    const float* at = obs(env) + object_;
    bool far = false;
    for (int k = 0; k < 3; ++k) {
      p[k] = static_cast<double>(at[k]);
      far = far || std::fabs(p[k]) > 4.999;
    }
    if (!far) return true;
    keep(rdm_pool_get_poses(pool_, env, poses_.data()));
    std::copy_n(poses_[static_cast<size_t>(object_shape_)].p, 3, p);
    const auto whole = [](double v) { return std::isfinite(v); };
    return std::all_of(poses_.begin(), poses_.end(), [&](const rdm_pose& X) {
      return std::all_of(X.p, X.p + 3, whole) && std::all_of(X.q, X.q + 4, whole);
    });
  }

  void remember(int32_t env) {
    place(env, &place_[3 * static_cast<size_t>(env)]);
    for (size_t k = 0; k < joints_.size(); ++k)
      angles_[static_cast<size_t>(env) * joints_.size() + k] = obs(env)[joints_[k]];
  }

  static void raise(double* most, double x) { *most = x > *most ? x : *most; }

  void look(int32_t env) {
    const auto e = static_cast<size_t>(env);
    Figures& f = figures_;
    bool good = rows_finite(env), bounded = true;
    if (rows_.episode_step[env] == 0) {  // this step only reset
      f.not_finite += !good;
      pushes_[e] = 0;
      remember(env);
      return;
    }
    const uint32_t status = rows_.status[env];
    ++f.steps;
    f.diverged += (status & RDM_STATUS_DIVERGED) != 0;
    f.overflowed += (status & RDM_STATUS_CONTACTS) != 0;
    f.other += (status & ~static_cast<uint32_t>(RDM_STATUS_DIVERGED | RDM_STATUS_CONTACTS |
                                                RDM_STATUS_SOLVER | RDM_STATUS_SLOWED)) != 0;
    f.episodes += rows_.terminated[env] || rows_.truncated[env];
    run_[e] = status & RDM_STATUS_DIVERGED ? run_[e] + 1 : 0;
    f.stuck = std::max(f.stuck, run_[e]);
    if ((status & RDM_STATUS_DIVERGED) && events_.size() < 8) events_.push_back({time_, env, status});
    good = look_at_object(env, &bounded) && good;
    look_at_joints(env, &bounded);
    good = look_at_contacts(env) && good;
    f.not_finite += !good;
    f.unflagged += status == 0 && !bounded;
    remember(env);
  }

  bool look_at_object(int32_t env, bool* bounded) {
    Figures& f = figures_;
    const double* before = &place_[3 * static_cast<size_t>(env)];
    double now[3], square = 0, moved = 0, length = 0;
    const bool good = place(env, now);
    for (int k = 0; k < 3; ++k) {
      square += now[k] * now[k];
      moved += (now[k] - before[k]) * (now[k] - before[k]);
    }
    for (int k = 0; k < 4; ++k) {
      const double x = static_cast<double>(obs(env)[rotation_ + k]);
      length += x * x;
    }
    raise(&f.object_distance, std::sqrt(square));
    raise(&f.object_height, now[2]);
    const double speed = std::sqrt(moved) / static_cast<double>(spec_.control_dt);
    raise(&f.object_speed, speed);
    const double error = std::fabs(std::sqrt(length) - 1);
    raise(&f.rotation_error, error);
    *bounded = *bounded && error < kRotationError && speed < fastest(static_cast<size_t>(env));
    return good;
  }

  void look_at_joints(int32_t env, bool* bounded) {
    Figures& f = figures_;
    const float* before = &angles_[static_cast<size_t>(env) * joints_.size()];
    const float* row = obs(env);
    const double dt = static_cast<double>(spec_.control_dt);
    for (size_t k = 0; k < joints_.size(); ++k) {
      const double share = static_cast<double>(row[joints_[k]]);
      const double excess = (std::fabs(share) - 1) * halves_[k];
      raise(&f.joint_excess, excess);
      *bounded = *bounded && excess < kJointExcess;
      raise(&f.joint_rate, std::fabs(share - static_cast<double>(before[k])) * halves_[k] / dt);
    }
    for (const int32_t tip : tips_)
      for (int k = 0; k < 3; ++k) tips_fast_ += std::fabs(row[tip + k]) > 4.999f;
  }

  bool look_at_contacts(int32_t env) {
    constexpr size_t kMost = 64;
    rdm_contact list[kMost];
    size_t count = 0;
    bool good = true;
    keep(rdm_pool_get_contacts(pool_, env, list, kMost, &count));
    for (size_t i = 0; i < std::min(count, kMost); ++i) {
      const rdm_contact& c = list[i];
      const bool fine =
          finite(c.position, 3) && finite(c.normal, 3) && finite(c.force, 3) && finite(&c.depth, 1);
      good = good && fine;
      const double x = static_cast<double>(c.force[0]), y = static_cast<double>(c.force[1]),
                   z = static_cast<double>(c.force[2]);
      raise(&figures_.contact_depth, static_cast<double>(c.depth));
      raise(&figures_.contact_force, std::sqrt(x * x + y * y + z * z));
    }
    return good;
  }

  Case case_;
  int32_t envs_;
  std::mt19937_64 random_;
  rdm_pool* pool_ = nullptr;
  rdm_buffers rows_{};
  rdm_spec spec_{};
  rdm_result result_ = RDM_OK;
  int32_t object_ = 0, rotation_ = 0, object_shape_ = 0;
  std::vector<int32_t> joints_, tips_, pushed_;
  std::vector<double> halves_, place_;
  std::vector<float> angles_, signs_;
  std::vector<rdm_pose> poses_;
  std::vector<int64_t> run_, pushes_;  // pushes: of this episode
  std::vector<Event> events_;
  Figures figures_;
  int64_t time_ = 0, tips_fast_ = 0;
  double mass_ = 0;
};

}  // namespace hostile
