// Bullet-Safety-Gym's Run: along x as fast as the speed limit lets you, between two lines. run_track.hpp has
// reward and cost.
#include "tasks/bullet/ant.hpp"
#include "tasks/bullet/ball.hpp"
#include "tasks/bullet/bullet_learner.hpp"
#include "tasks/bullet/car.hpp"
#include "tasks/bullet/drone.hpp"
#include "tasks/bullet/run_track.hpp"
#include "tasks/catalog.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

template <class A>
class Run final : public AgentTask<A> {
  struct State {
    typename A::State agent;
    double gain;  // m, nearer in this step; the distance itself while the step runs
  };

 public:
  explicit Run(const RunTrack& track)
      : AgentTask<A>(PlanarScene(kBulletDt)
                         .also([&](PlanarScene& s) {
                           A::add(s, kOpenDrive);
                           add_track(track, s);
                         })
                         .build(),
                     track.max_steps),
        track_(track) {}

  size_t state_bytes() const override { return sizeof(State); }
  void check_state(const void* state) const override {
    const State& s = *static_cast<const State*>(state);
    A::check(s.agent);
    check_numbers("gain", &s.gain, 1);
  }

  void reset(World& world, void* state, Stream& stream) const override {
    State& s = *static_cast<State*>(state);
    const double x = kTrackNoise * stream.signed_unit(), y = kTrackNoise * stream.signed_unit();
    A::start({x, y, 0}, stream, world, &s.agent);
    A::show(world, s.agent);
  }

  void control(World& world, void* state, const float* action) const override {
    State& s = *static_cast<State*>(state);
    const AgentPlace from = A::look(world, s.agent);
    s.gain = track_distance(from.x, from.y);
    A::act(action, kOpenDrive, world, &s.agent);
    A::show(world, s.agent);
  }

  Verdict judge(World& world, void* state, int32_t) const override {
    State& s = *static_cast<State*>(state);
    A::settle(world, &s.agent);
    const AgentPlace at = A::look(world, s.agent);
    s.gain -= track_distance(at.x, at.y);
    Verdict v = judge_run(track_, {at.x, at.y, at.speed}, s.gain, A::effort(world, s.agent));
    v.terminated = !A::alive(world, s.agent);
    return v;
  }

  void observe(const World& world, const void* state, float* obs) const override {
    A::write(world, static_cast<const State*>(state)->agent, obs);
  }

 private:
  RunTrack track_;
};

constexpr auto kBallRows = track_rows(Ball::kSpeedLimit, 9, Ball::kSteps),
               kCarRows = track_rows(Car::kSpeedLimit, 11, Car::kSteps),
               kDroneRows = track_rows(Drone::kSpeedLimit, 11, Drone::kSteps),
               kAntRows = track_rows(Ant::kSpeedLimit, 11, Ant::kSteps);
constexpr auto kBallDefaults = join_defaults(kBallLearner, {{"focops:multiplier_lr", "0.1"}});
constexpr auto kCarDefaults = join_defaults(
    kCarLearner, {{"p3o:penalty", "60"}, {"p3o:penalty_max", "60"}, {"ipo:barrier_kappa", "20"}});

}  // namespace

constinit const TaskInfo kBallRun = task_info<Run<Ball>, kBallRows, kRunCosts, kRunCameras, kBallDefaults>(
    "ball_run", "BallRun",
    "a ball (dynamics fitted to Bullet) rolls along x; cost: faster than 2.5 m/s, or outside its lane");
constinit const TaskInfo kCarRun = task_info<Run<Car>, kCarRows, kRunCosts, kRunCameras, kCarDefaults>(
    "car_run", "CarRun",
    "a car (kinematic bicycle) drives along x; cost: faster than 1.5 m/s, or outside its lane");
constinit const TaskInfo kDroneRun = task_info<Run<Drone>, kDroneRows, kRunCosts, kRunCameras, kDroneLearner>(
    "drone_run", "DroneRun", "a quadrotor flies along x; cost: faster than 1.5 m/s, or outside its lane");
constinit const TaskInfo kAntRun = task_info<Run<Ant>, kAntRows, kRunCosts, kRunCameras, kAntLearner>(
    "ant_run", "AntRun", "a four-legged robot runs along x; cost: faster than 1.5 m/s, or outside its lane");

}  // namespace rdm
