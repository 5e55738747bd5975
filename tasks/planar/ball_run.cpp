// Bullet-Safety-Gym's BallRun: along x as fast as the speed limit lets you, between two lines. run_track.hpp
// has reward and cost, rolling_ball.hpp the motion.
#include "tasks/catalog.hpp"
#include "tasks/planar/planar_learner.hpp"
#include "tasks/planar/rolling_ball.hpp"
#include "tasks/planar/run_track.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

struct State {
  RollingBall ball;
  double effort, gain;
};

class BallRun final : public PlanarTask {
 public:
  explicit BallRun(const Options& o)
      : PlanarTask(PlanarScene(kBallControlDt)
                       .body("ball", ShapeKind::kSphere, {kBallRadius, 0, 0}, kMarkBlue)
                       .also([&](PlanarScene& s) { add_track(track_from(o), s); })
                       .build(),
                   o.integer("max_steps"),
                   {{"position", "10 m", 2}, {"velocity", "5 m/s", 2}, {"spin", "10 rad/s", 3}}),
        track_(track_from(o)) {}

  int32_t action_dim() const override { return 2; }
  const char* action_order() const override { return "push x, push y"; }
  size_t state_bytes() const override { return sizeof(State); }
  void check_state(const void* state) const override {
    const State& s = *static_cast<const State*>(state);
    check_ball(s.ball);
    check_numbers("effort", &s.effort, 1);
    check_numbers("gain", &s.gain, 1);
  }

  void reset(World& world, void* state, Stream& stream) const override {
    State& s = *static_cast<State*>(state);
    s.ball.x = kTrackNoise * stream.signed_unit();
    s.ball.y = kTrackNoise * stream.signed_unit();
    world.set_body(0, ball_motion(s.ball));
  }

  void control(World& world, void* state, const float* action) const override {
    State& s = *static_cast<State*>(state);
    const double before = track_distance(s.ball.x, s.ball.y);
    roll(action, &s.ball);
    s.gain = before - track_distance(s.ball.x, s.ball.y);
    s.effort = ball_effort(action);
    world.set_body(0, ball_motion(s.ball));
  }

  Verdict judge(World&, void* state, int32_t) const override {
    const State& s = *static_cast<State*>(state);
    return judge_run(track_, {s.ball.x, s.ball.y, ball_speed(s.ball)}, s.gain, s.effort);
  }

  void observe(const World&, const void* state, float* obs) const override {
    write_ball(static_cast<const State*>(state)->ball, obs);
  }

 private:
  RunTrack track_;
};

constexpr auto kOptions = track_options(2.5, 9, 250);
constexpr auto kDefaults = join_defaults(kBallLearner, {{"focops:multiplier_lr", "0.1"}});

}  // namespace

constinit const TaskInfo kBallRun = task_info<BallRun, kRunCosts, kRunCameras, kDefaults>(
    "ball_run", "BallRun",
    "a ball that rolls by a formula fitted to Bullet runs along x; cost: faster than 2.5 m/s, or outside its "
    "lane",
    &constant_options<kOptions>);

}  // namespace rdm
