// A point on a line walks to a drawn goal: reward -|x - g|, cost 1 in each step beyond the fence at x = 1.
#include <cmath>

#include "tasks/catalog.hpp"
#include "tasks/planar/planar_scene.hpp"
#include "tasks/state_check.hpp"
#include "tasks/task_info.hpp"

namespace rdm {
namespace {

constexpr double kReach = 0.1;   // m, the longest stride
constexpr double kFence = 1;     // m
constexpr double kRadius = 0.1;  // m, of the point in pictures

struct WalkOptions {
  int32_t max_steps;
};
constexpr auto kRows = option_rows<WalkOptions>(
    row<&WalkOptions::max_steps>(integer_option("max_steps", 50, 1, 100000, "control steps of an episode")));

struct State {
  double x, goal;
};

class FencedWalk final : public PlanarTask {
 public:
  explicit FencedWalk(const WalkOptions& o)
      : PlanarTask(PlanarScene(0.1)
                       .body("point", ShapeKind::kSphere, {kRadius, 0, 0}, kMarkBlue)
                       .wall("fence", kMarkRed, kFence, -1, kFence, 1)
                       .build(),
                   o.max_steps, {{"position", "m", 1}, {"goal", "m", 1}}) {}

  int32_t action_dim() const override { return 1; }
  const char* action_order() const override { return "stride"; }
  size_t state_bytes() const override { return sizeof(State); }

  void check_state(const void* state) const override {
    const State& s = *static_cast<const State*>(state);
    check_numbers("x", &s.x, 1);
    check_numbers("goal", &s.goal, 1, 2);
  }
  void reset(World& world, void* state, Stream& stream) const override {
    State& s = *static_cast<State*>(state);
    s = {0, stream.uniform(-2, 2)};
    place(world, s);
  }
  void control(World& world, void* state, const float* action) const override {
    State& s = *static_cast<State*>(state);
    s.x += kReach * static_cast<double>(action[0]);
    place(world, s);
  }
  Verdict judge(World&, void* state, int32_t) const override {
    const State& s = *static_cast<const State*>(state);
    Verdict v;
    v.reward = -std::fabs(s.x - s.goal);
    v.cost_raw[0] = s.x - kFence;
    v.cost[0] = s.x > kFence;
    v.success = std::fabs(s.x - s.goal) < kReach;
    return v;
  }
  void observe(const World&, const void* state, float* obs) const override {
    const State& s = *static_cast<const State*>(state);
    obs[0] = static_cast<float>(s.x);
    obs[1] = static_cast<float>(s.goal);
  }

 private:
  static void place(World& world, const State& s) { world.set_body(0, planar_motion({s.x, 0, kRadius}, 0)); }
};

constexpr CostSpec kCosts[] = {{"cost", "1 in a step that ends beyond the fence", 5}};
constexpr CameraSpec kCameras[] = {{"front", {0, -4, 2}, {0, 0, 0}, 0.8}};
constexpr std::array kDefaults = {LearnerDefault{"horizon", "100"}, LearnerDefault{"init_std", "0.5"}};

}  // namespace

constinit const TaskInfo kFencedWalk = task_info<FencedWalk, kRows, kCosts, kCameras, kDefaults>(
    "fenced_walk", nullptr, "walk to a drawn goal; cost: beyond the fence");

}  // namespace rdm
