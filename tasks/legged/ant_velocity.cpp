// Safety-Gymnasium's AntVelocity: walk along x, but slower than the limit.
//
//   r = vx + 1 - 0.5 |a|^2 - 5e-4 |clip(f, -1, 1)|^2     vx: mean speed of the torso over the step, m/s
//   c = [|(vx, vy)| > 2.6222]
//
// f are the contact torques and forces on each body in the last substep, world axes: N m, N. As in Gymnasium
// the torques are about the ant's centre of mass, the world's row is 0, and motors are in the order hip 4,
// ankle 4, hip 1, ... With order=redman, torques are about each body's frame, the world has a row, the fixed
// parts of legs count to the torso, and motors are in the order of the joints. The episode ends when the torso
// is outside 0.2 to 1 m. walker_scene.hpp says what differs from MuJoCo.
#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/names.hpp"
#include "env/fields.hpp"
#include "tasks/catalog.hpp"
#include "tasks/legged/ant_body.hpp"
#include "tasks/legged/legged_learner.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr double kStep = 0.005;  // s
constexpr int32_t kSubsteps = 10;
constexpr double kLowest = 0.2, kHighest = 1;  // m
constexpr AntRange kRange{30 * kDegree, 30 * kDegree, 70 * kDegree, 150};
constexpr double kBent = 1;  // rad, of ankles at the start
constexpr double kMu = 1;
constexpr int32_t kForces = 6 * kAntBodies;
constexpr MujocoContact kContact{0.9, 0.95, 0.001, 0.01};
constexpr const char* kGymnasiumOrder = "hip 4, ankle 4, hip 1, ankle 1, hip 2, ankle 2, hip 3, ankle 3";

struct State {
  double x, y;  // m, of the torso before the step
  double effort;
  float force[kForces];  // torque, force of each body, cut at +-1
};

struct AntOptions {
  double speed_limit, effort_weight, contact_weight, healthy_reward, reset_noise;
  int32_t max_steps;
  bool own_order;
};
constexpr auto kRows = option_rows<AntOptions>(
    row<&AntOptions::speed_limit>(basic(
        number_option("speed_limit", 2.6222, 0, 100, "horizontal speed above which a step costs 1, m/s"))),
    row<&AntOptions::effort_weight>(
        basic(number_option("effort_weight", 0.5, 0, 10, "weight of the squared action in the reward"))),
    row<&AntOptions::contact_weight>(
        number_option("contact_weight", 5e-4, 0, 10, "weight of the squared contact forces in the reward")),
    row<&AntOptions::healthy_reward>(
        basic(number_option("healthy_reward", 1, 0, 100,
                            "reward for each control step in which the robot is healthy (has not fallen)"))),
    row<&AntOptions::reset_noise>(number_option(
        "reset_noise", 0.1, 0, 0.2,
        "start noise: half width (uniform) for positions, standard deviation (normal) for velocities")),
    row<&AntOptions::max_steps>(
        basic(integer_option("max_steps", 1000, 1, 100000, "number of control steps in an episode"))),
    row<&AntOptions::own_order, false, true>(legacy(
        text_option("order", "gymnasium", "gymnasium|redman",
                    "order of the actions and of the contact fields: as in Gymnasium, or redman's own"))));

class AntVelocity final : public PlanarTask {
 public:
  explicit AntVelocity(const AntOptions& o)
      : PlanarTask(make(), o.max_steps,
                   {{"height", "m", 1},
                    {"rotation", "1", 4, -1, 1},
                    {"joint_position", "rad", kAntJoints},
                    {"velocity", "m/s", 3},
                    {"spin", "rad/s", 3},
                    {"joint_velocity", "rad/s", kAntJoints},
                    {"contact_force", "1", kForces, -1, 1}}),
        options_(o) {}

  EngineKind engine() const override { return EngineKind::kArticulated; }
  int32_t action_dim() const override { return kAntJoints; }
  const char* action_order() const override { return options_.own_order ? kAntOrder : kGymnasiumOrder; }
  int32_t action_of(int32_t joint) const override {
    const int32_t own = PlanarTask::action_of(joint);
    return own < 0 ? own : entry_of(own);
  }
  size_t state_bytes() const override { return sizeof(State); }
  void check_state(const void* state) const override {
    const State& s = *static_cast<const State*>(state);
    const double values[] = {s.x, s.y, s.effort};
    check_numbers("ant", values, std::size(values));
    check_numbers("forces", s.force, kForces, 1);
  }

  void reset(World& world, void* state, Stream& stream) const override {
    Pose X{{0, 0, kAntHeight}, {}};
    double q[kAntJoints], qd[kAntJoints];
    float rates[6 + kAntJoints];
    const auto noise = [&] { return options_.reset_noise * stream.signed_unit(); };
    X.p = X.p + Vec3{noise(), noise(), noise()};
    X.q = normalized(Quat{1 + noise(), noise(), noise(), noise()});
    for (int32_t i = 0; i < kAntJoints; ++i) q[i] = (i % 2 == 0 ? 0 : kBent * ankle_side(i / 2)) + noise();
    stream.normals(rates, 6 + kAntJoints);
    const auto rate = [&](int32_t i) { return options_.reset_noise * static_cast<double>(rates[i]); };
    for (int32_t i = 0; i < kAntJoints; ++i) qd[i] = rate(6 + i);
    set_ant(world, X, {rate(0), rate(1), rate(2)}, rotate(X.q, {rate(3), rate(4), rate(5)}), q, qd);
    *static_cast<State*>(state) = {};
  }

  void control(World& world, void* state, const float* action) const override {
    State& s = *static_cast<State*>(state);
    const Vec3& at = world.base(0).X.p;
    s.x = at.x, s.y = at.y;
    s.effort = 0;
    for (int32_t i = 0; i < kAntJoints; ++i)
      s.effort += static_cast<double>(action[i]) * static_cast<double>(action[i]);
    float in_order[kAntJoints];
    for (int32_t i = 0; i < kAntJoints; ++i) in_order[i] = action[entry_of(i)];
    drive_ant(world, in_order, kRange.gear);
  }

  Verdict judge(World& world, void* state, int32_t) const override {
    State& s = *static_cast<State*>(state);
    const Vec3& at = world.base(0).X.p;
    const double vx = (at.x - s.x) / scene().control_dt(), vy = (at.y - s.y) / scene().control_dt();
    const double speed = std::sqrt(vx * vx + vy * vy), contact = feel(world, &s);
    const bool healthy = at.z > kLowest && at.z < kHighest;
    Verdict v;
    v.reward = vx + options_.healthy_reward * healthy - options_.effort_weight * s.effort -
               options_.contact_weight * contact;
    v.cost_raw[0] = speed;
    v.cost[0] = speed > options_.speed_limit;
    v.success = healthy && vx > 0.5 * options_.speed_limit && speed <= options_.speed_limit;
    v.terminated = !healthy;
    return v;
  }

  void observe(const World& world, const void* state, float* obs) const override {
    const State& s = *static_cast<const State*>(state);
    const Motion& base = world.base(0);
    const Quat& q = base.X.q;
    *obs++ = static_cast<float>(base.X.p.z);
    for (const double value : {q.w, q.x, q.y, q.z}) *obs++ = static_cast<float>(value);
    for (int32_t i = 0; i < kAntJoints; ++i) *obs++ = static_cast<float>(world.q()[i]);
    put(base.v, obs);
    put(rotate(conjugate(q), base.w), obs + 3);  // in the torso's axes
    obs += 6;
    for (int32_t i = 0; i < kAntJoints; ++i) *obs++ = static_cast<float>(world.qd()[i]);
    std::copy_n(s.force, kForces, obs);
  }

 private:
  // Entry of the action for motor i in the order of the joints: Gymnasium's order begins with the last leg.
  int32_t entry_of(int32_t i) const { return options_.own_order ? i : (i + 2) % kAntJoints; }

  static Scene make() {
    PlanarScene scene(kStep * kSubsteps);
    make_walkable(scene, kStep, kSubsteps, kMu, kMu);
    add_ant(kRange, scene);
    soften(kContact, scene);
    for (int x = 0; x <= 100; x += 2) scene.disc("metres", 0.15, kMarkGrey, x, 0);
    return scene.build();
  }

  // Sums the contacts of the last substep by body, cuts them; the sum of their squares.
  double feel(const World& world, State* s) const {
    double sum[kForces] = {};
    const Vec3 middle = options_.own_order ? Vec3{} : centre_of_mass(world);
    const auto join = [&](int32_t shape, const Vec3& p, const Vec3& force) {
      const SceneShape& at = scene().shapes[static_cast<size_t>(shape)];
      int32_t body = std::max(0, ant_body(at));
      if (!options_.own_order && body == 0) return;
      if (options_.own_order && at.carrier == Carrier::kBase) body = 1;
      const Vec3 origin = !options_.own_order ? middle
                          : body == 0         ? Vec3{}
                          : body == 1         ? world.base(0).X.p
                                              : world.link(at.index).X.p;
      const Vec3 torque = cross(p - origin, force);
      for (int k = 0; k < 3; ++k) {
        sum[6 * body + k] += torque[k];
        sum[6 * body + 3 + k] += force[k];
      }
    };
    for (int32_t i = 0; i < world.num_contacts(); ++i) {
      const Contact& c = world.contacts()[i];
      join(c.shape_a, c.p, c.force);
      join(c.shape_b, c.p, -c.force);
    }
    double squares = 0;
    for (int32_t i = 0; i < kForces; ++i) {
      const double cut = std::clamp(sum[i], -1.0, 1.0);
      s->force[i] = static_cast<float>(cut);
      squares += cut * cut;
    }
    return squares;
  }

  Vec3 centre_of_mass(const World& world) const {
    const ArticulationDef& ant = scene().def.articulations[0];
    Vec3 sum = ant.base.mass * (world.base(0).X * ant.base.com);
    double mass = ant.base.mass;
    for (int32_t i = 0; i < kAntJoints; ++i) {
      const Inertia& part = scene().link(i).inertia;
      sum += part.mass * (world.link(i).X * part.com);
      mass += part.mass;
    }
    return (1 / mass) * sum;
  }

  AntOptions options_;
};

constexpr CostSpec kCosts[] = {
    {"cost", "1 if the robot is above the speed limit; raw: its horizontal speed, m/s", 25}};
constexpr CameraSpec kCameras[] = {
    {"front", {2, -6, 3}, {2, 0, 0.4}, 0.9},
    {"top", {2, -0.01, 8}, {2, 0, 0}, 0.9},
};

}  // namespace

constinit const TaskInfo kAntVelocity = task_info<AntVelocity, kRows, kCosts, kCameras, kLeggedLearner>(
    "ant_velocity", "AntVelocity", "a four-legged robot walks along x; cost: faster than 2.6222 m/s");

}  // namespace rdm
