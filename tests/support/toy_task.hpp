// A task of a few lines for the tests of the pool: a ball without gravity in an empty world, pushed along x
// by the action. Fast, and everything about it is known.
#pragma once
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "base/error.hpp"
#include "env/fields.hpp"
#include "env/pool.hpp"
#include "physics/model/inertia.hpp"

namespace rdm::test {

inline constexpr int kToyActions = 2, kToyObs = 8, kToyCosts = 2;

// action[0]: push along x; action[1]: the reward. cost: action[0] > 0.5, and 0.25 each step. Ends beyond
// x = 1 m. Breaks by option: at step `nan_at` an observation is not finite, at `blast_at` the push is not, at
// `huge_at` the reward is beyond a float.
class ToyTask final : public Task {
 public:
  struct State {
    double start;
    int64_t steps;
    float action[kToyActions];
  };

  explicit ToyTask(const Options& o)
      : max_steps_(o.integer("max_steps")),
        nan_at_(o.integer("nan_at")),
        blast_at_(o.integer("blast_at")),
        throw_at_(o.integer("throw_at")),
        huge_at_(o.integer("huge_at")),
        engine_(same_name(o.text("engine"), "ode") ? EngineKind::kOde : static_cast<EngineKind>(99)) {
    SceneDef def;
    def.gravity = {};
    BodyDef ball;
    ball.name = "ball";
    ball.inertia = sphere_inertia(1, 0.1);
    ShapeDef shape;
    shape.name = "ball";
    shape.size = {0.1, 0, 0};
    ball.shapes.push_back(shape);
    def.bodies.push_back(ball);
    scene_ = make_scene(std::move(def));
    add_field(fields_, "ball", "position", "m", 3);
    add_field(fields_, "ball", "velocity", "m/s", 3);
    add_field(fields_, nullptr, "action", "1", kToyActions);
  }
  const Scene& scene() const override { return scene_; }
  EngineKind engine() const override { return engine_; }
  int32_t max_steps() const override { return max_steps_; }
  int32_t action_dim() const override { return kToyActions; }
  const Vector<FieldSpec>& fields() const override { return fields_; }
  const char* action_order() const override { return "push, reward"; }
  size_t state_bytes() const override { return sizeof(State); }
  void check_state(const void* state) const override {
    const auto& s = *static_cast<const State*>(state);
    if (!(std::abs(s.start) <= 0.1) || s.steps < 0 || s.steps > 1000)
      fail(Code::kFormat, "toy: start %g, steps %lld", s.start, static_cast<long long>(s.steps));
  }
  void reset(World& world, void* state, Stream& stream) const override {
    auto& s = *static_cast<State*>(state);
    s.start = stream.uniform(-0.1, 0.1);
    Motion m;
    m.X.p.x = s.start;
    world.set_body(0, m);
  }
  void control(World& world, void* state, const float* action) const override {
    auto& s = *static_cast<State*>(state);
    ++s.steps;
    std::memcpy(s.action, action, sizeof s.action);
    const double push = s.steps == blast_at_ ? 1e308 : 500.0 * action[0];
    for (int twice = 0; twice < 2; ++twice)
      world.push_body(0, {push, 0, 0}, {});  // the sum of blasts is infinite
  }
  Verdict judge(World& world, void* state, int32_t) const override {
    const auto& s = *static_cast<const State*>(state);
    if (s.steps == throw_at_) fail(Code::kInternal, "the toy throws");
    Verdict v;
    v.reward = s.steps == huge_at_ ? 1e39 : s.action[1];  // finite, but not as a float
    v.cost[0] = s.action[0] > 0.5f;
    v.cost_raw[0] = s.action[0];
    v.cost[1] = v.cost_raw[1] = 0.25;
    v.terminated = world.body(0).X.p.x > 1;
    v.success = world.body(0).X.p.x > 0.5;
    return v;
  }
  void observe(const World& world, const void* state, float* obs) const override {
    const auto& s = *static_cast<const State*>(state);
    put(world.body(0).X.p, obs);
    if (s.steps == nan_at_) obs[1] = std::numeric_limits<float>::quiet_NaN();
    put(world.body(0).v, obs + 3);
    std::memcpy(obs + 6, s.action, sizeof s.action);
  }
  void hold_action(float* action) const override { action[0] = action[1] = 0.125f; }
  void initial_mean(float* action) const override { action[0] = action[1] = 0; }

 private:
  int32_t max_steps_, nan_at_, blast_at_, throw_at_, huge_at_;
  EngineKind engine_;
  Scene scene_;
  FieldTable fields_;
};

inline const TaskInfo& toy_info() {
  static const OptionSpec options[] = {
      integer_option("max_steps", 10, 1, 1000, "control steps of an episode"),
      integer_option("nan_at", -1, -1, 1000, "step whose observation is not finite"),
      integer_option("blast_at", -1, -1, 1000, "step whose push is not finite"),
      integer_option("throw_at", -1, -1, 1000, "step that throws"),
      integer_option("huge_at", -1, -1, 1000, "step whose reward no float holds"),
      text_option("engine", "ode", "ode|absent", "physics engine"),
  };
  static const CostSpec costs[kToyCosts] = {{"cost", "push above 0.5", 3}, {"step", "each step", -1}};
  static const CameraSpec cameras[] = {{"front", {1, 0, 0}, {0, 0, 0}, 1}};
  static const LearnerDefault defaults[] = {{"hidden", "8"}};
  static const TaskInfo info = {
      "toy_push",
      "ToyPush",
      "a ball that is pushed",
      [](int32_t* count, OptionTable*) -> const OptionSpec* {
        *count = 6;
        return options;
      },
      costs,
      kToyCosts,
      cameras,
      1,
      defaults,
      1,
      [](const Options& o, const HostHooks& hooks) -> Task* { return host_new<ToyTask>(hooks, o); },
      [](Task* task, const HostHooks& hooks) { host_delete(hooks, static_cast<ToyTask*>(task)); },
  };
  return info;
}

inline void register_toy() {
  static const bool done = (register_task(toy_info()), true);
  static_cast<void>(done);
}

// Owns a pool; its rows by index.
class TestPool {
 public:
  TestPool(const char* task, int32_t envs, std::vector<OptionInput> options = {}, PoolConfig config = {}) {
    config.task = task;
    config.num_envs = envs;
    config.options = options.data();
    config.num_options = static_cast<int32_t>(options.size());
    pool_ = Pool::create(config);
  }
  ~TestPool() { Pool::destroy(pool_); }
  TestPool(const TestPool&) = delete;
  TestPool& operator=(const TestPool&) = delete;
  Pool* operator->() { return pool_; }
  Pool& operator*() { return *pool_; }
  const Buffers& rows() const { return pool_->buffers(); }
  float* obs(int32_t env) const { return rows().obs + env * pool_->obs_dim(); }
  float* final_obs(int32_t env) const { return rows().final_obs + env * pool_->obs_dim(); }
  float* action(int32_t env) const { return rows().action + env * pool_->task().action_dim(); }
  float* cost(int32_t env) const { return rows().cost + env * pool_->cost_dim(); }
  bool ended(int32_t env) const { return rows().terminated[env] || rows().truncated[env]; }
  std::vector<unsigned char> state(int32_t env = -1) const {
    std::vector<unsigned char> bytes(pool_->state_size(env));
    Writer out(bytes.data(), bytes.size());
    pool_->get_state(env, out);
    EXPECT_TRUE(out.fits());
    return bytes;
  }

 private:
  Pool* pool_ = nullptr;
};

// The code that f fails with, kOk when it does not.
template <class F>
Code code_of(F&& f) {
  return guard(f);
}

}  // namespace rdm::test
