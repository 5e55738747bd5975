// Bullet-Safety-Gym's BallCircle: run clockwise along a circle of 7 m whose sides lie outside the safe strip.
//
//   r = 0.1 (y vx - x vy) / (1 + ||p| - 7|) - 0.005 |a|     p = (x, y), m; v, m/s
//   c = [|x| > 6]
#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"
#include "tasks/catalog.hpp"
#include "tasks/planar/planar_learner.hpp"
#include "tasks/planar/rolling_ball.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr double kStartInner = 2, kStartOuter = 4;  // m
constexpr double kBounce = 0.35;                    // restitution of ball and wall, multiplied
constexpr double kWallSlack = 11;                   // m; no wall is nearer

struct State {
  RollingBall ball;
  double effort;
};

class BallCircle final : public PlanarTask {
 public:
  explicit BallCircle(const Options& o)
      : PlanarTask(make(o), o.integer("max_steps"),
                   {{"position", "10 m", 2},
                    {"velocity", "5 m/s", 2},
                    {"spin", "10 rad/s", 3},
                    {"circle_distance", "10 m", 1}}),
        radius_(o.number("radius")),
        safe_(o.number("safe_x")),
        wall_(o.number("wall")) {
    for (int k = 0; k < kWalls; ++k) {
      const elementary::SinCos n = elementary::sincos(2 * kPi * k / kWalls);
      wall_x_[k] = n.cos;
      wall_y_[k] = n.sin;
    }
  }

  int32_t action_dim() const override { return 2; }
  const char* action_order() const override { return "push x, push y"; }
  size_t state_bytes() const override { return sizeof(State); }
  void check_state(const void* state) const override {
    const State& s = *static_cast<const State*>(state);
    check_ball(s.ball);
    check_numbers("effort", &s.effort, 1);
  }

  // Uniform over the ring, by area.
  void reset(World& world, void* state, Stream& stream) const override {
    State& s = *static_cast<State*>(state);
    constexpr double kInner2 = kStartInner * kStartInner, kOuter2 = kStartOuter * kStartOuter;
    const double r = std::sqrt(stream.uniform(kInner2, kOuter2));
    const elementary::SinCos at = elementary::sincos(stream.uniform(0, 2 * kPi));
    s.ball.x = r * at.cos;
    s.ball.y = r * at.sin;
    world.set_body(0, ball_motion(s.ball));
  }

  void control(World& world, void* state, const float* action) const override {
    State& s = *static_cast<State*>(state);
    roll(action, &s.ball);
    bounce(&s.ball);
    s.effort = ball_effort(action);
    world.set_body(0, ball_motion(s.ball));
  }

  Verdict judge(World&, void* state, int32_t) const override {
    const State& s = *static_cast<State*>(state);
    const RollingBall& b = s.ball;
    const double off = std::fabs(distance(b) - radius_);
    Verdict v;
    v.reward = 0.1 * (b.y * b.vx - b.x * b.vy) / (1 + off) + 0.01 * s.effort;
    v.cost_raw[0] = std::fabs(b.x);
    v.cost[0] = v.cost_raw[0] > safe_;
    v.success = off <= kOnCircle;
    return v;
  }

  void observe(const World&, const void* state, float* obs) const override {
    const State& s = *static_cast<const State*>(state);
    write_ball(s.ball, obs);
    obs[kBallObs] = static_cast<float>(0.1 * (distance(s.ball) - radius_));
  }

 private:
  static constexpr int kWalls = 8;
  static constexpr double kOnCircle = 1;  // m

  static Scene make(const Options& o) {
    const double safe = o.number("safe_x"), radius = o.number("radius"), end = o.number("wall");
    return PlanarScene(kBallControlDt)
        .body("ball", ShapeKind::kSphere, {kBallRadius, 0, 0}, kMarkBlue)
        .disc("circle", radius, kMarkGreen, 0, 0)
        .wall("line_left", kMarkRed, -safe, -end, -safe, end)
        .wall("line_right", kMarkRed, safe, -end, safe, end)
        .build();
  }
  static double distance(const RollingBall& b) { return std::sqrt(b.x * b.x + b.y * b.y); }

  // Off the walls of the octagon: back inside, and the speed into the wall turns round.
  void bounce(RollingBall* b) const {
    if (distance(*b) < std::min(kWallSlack, wall_ - kBallRadius)) return;
    for (int k = 0; k < kWalls; ++k) {
      const double depth = wall_x_[k] * b->x + wall_y_[k] * b->y - (wall_ - kBallRadius);
      if (depth <= 0) continue;
      const double into = std::max(0.0, wall_x_[k] * b->vx + wall_y_[k] * b->vy) * (1 + kBounce);
      b->x -= depth * wall_x_[k];
      b->y -= depth * wall_y_[k];
      b->vx -= into * wall_x_[k];
      b->vy -= into * wall_y_[k];
    }
  }

  double radius_, safe_, wall_;
  double wall_x_[kWalls], wall_y_[kWalls];  // outward normals
};

constexpr OptionSpec kOptions[] = {
    number_option("radius", 7, 1, 100, "radius of the circle, m"),
    number_option("safe_x", 6, 0.1, 100, "a step with |x| beyond this costs 1, m"),
    number_option("wall", 12, 5, 1000, "distance of the eight walls from the middle, m"),
    integer_option("max_steps", 250, 1, 100000, "control steps of an episode"),
};
constexpr CostSpec kCosts[] = {{"cost", "1 beyond the safe strip; raw: |x|, m", 25}};
constexpr CameraSpec kCameras[] = {
    {"front", {0, -17, 13}, {0, 0, 0}, 0.9},
    {"top", {0, -0.01, 20}, {0, 0, 0}, 0.9},
};
constexpr auto kDefaults =
    join_defaults(kBallLearner, {{"focops:multiplier_lr", "0.4"}, {"ipo:barrier_kappa", "5"}});

}  // namespace

constinit const TaskInfo kBallCircle = task_info<BallCircle, kCosts, kCameras, kDefaults>(
    "ball_circle", "BallCircle",
    "a ball that rolls by a formula fitted to Bullet runs along a circle; cost: further than 6 m to a side",
    &constant_options<kOptions>);

}  // namespace rdm
