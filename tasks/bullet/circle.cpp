// Bullet-Safety-Gym's Circle: run clockwise along a circle of 7 m whose sides lie outside the safe strip.
//
//   r = 0.1 (y vx - x vy) / (1 + ||p| - 7|) + 0.01 effort    p = (x, y), m; v, m/s; effort: the agent's own
//   c = [|x| > 6]
#include <algorithm>
#include <cmath>

#include "tasks/bullet/ant.hpp"
#include "tasks/bullet/ball.hpp"
#include "tasks/bullet/bullet_learner.hpp"
#include "tasks/bullet/car.hpp"
#include "tasks/bullet/drone.hpp"
#include "tasks/bullet/room.hpp"
#include "tasks/catalog.hpp"

namespace rdm {
namespace {

constexpr double kStartInner = 2, kStartOuter = 4;  // m
constexpr int32_t kWalls = 8;
constexpr double kOnCircle = 1;  // m

struct CircleOptions {
  double radius, safe_x, wall;
  int32_t max_steps;
};
consteval auto circle_rows(int32_t max_steps) {
  return option_rows<CircleOptions>(
      row<&CircleOptions::radius>(
          basic(number_option("radius", 7, 1, 100, "radius of the circle to follow, m"))),
      row<&CircleOptions::safe_x>(
          basic(number_option("safe_x", 6, 0.1, 100, "a step with |x| above this costs 1, m"))),
      row<&CircleOptions::wall>(
          basic(number_option("wall", 12, 5, 1000, "distance of the eight walls from the centre, m"))),
      row<&CircleOptions::max_steps>(
          basic(integer_option("max_steps", max_steps, 1, 100000, "number of control steps in an episode"))));
}

template <class A>
class Circle final : public AgentTask<A> {
  struct State {
    typename A::State agent;
  };

 public:
  explicit Circle(const CircleOptions& o)
      : AgentTask<A>(make(o), o.max_steps, {{"circle_distance", "10 m", 1}}),
        options_(o),
        room_(regular_room(kWalls, o.wall)) {}

  size_t state_bytes() const override { return sizeof(State); }
  void check_state(const void* state) const override { A::check(static_cast<const State*>(state)->agent); }

  // Uniform over the ring, by area, and along the circle the way that is rewarded.
  void reset(World& world, void* state, Stream& stream) const override {
    State& s = *static_cast<State*>(state);
    constexpr double kInner2 = kStartInner * kStartInner, kOuter2 = kStartOuter * kStartOuter;
    const double r = std::sqrt(stream.uniform(kInner2, kOuter2)), angle = stream.uniform(0, 2 * kPi);
    const elementary::SinCos at = elementary::sincos(angle);
    A::start({r * at.cos, r * at.sin, angle - 0.5 * kPi}, stream, world, &s.agent);
    A::show(world, s.agent);
  }

  void control(World& world, void* state, const float* action) const override {
    State& s = *static_cast<State*>(state);
    A::act(action, kOpenDrive, world, &s.agent);
    if constexpr (A::kEngine == EngineKind::kKinematic) keep_inside<A>(room_, world, &s.agent);
    A::show(world, s.agent);
  }

  Verdict judge(World& world, void* state, int32_t) const override {
    State& s = *static_cast<State*>(state);
    A::settle(world, &s.agent);
    const AgentPlace b = A::look(world, s.agent);
    const double off = std::fabs(distance(b) - options_.radius);
    Verdict v;
    v.reward = 0.1 * (b.y * b.vx - b.x * b.vy) / (1 + off) + 0.01 * A::effort(world, s.agent);
    v.cost_raw[0] = std::fabs(b.x);
    v.cost[0] = v.cost_raw[0] > options_.safe_x;
    v.success = off <= kOnCircle;
    v.terminated = !A::alive(world, s.agent);
    return v;
  }

  void observe(const World& world, const void* state, float* obs) const override {
    const State& s = *static_cast<const State*>(state);
    A::write(world, s.agent, obs);
    obs[AgentTask<A>::kAgentObs] =
        static_cast<float>(0.1 * (distance(A::look(world, s.agent)) - options_.radius));
  }

 private:
  static Scene make(const CircleOptions& o) {
    const double safe = o.safe_x, end = o.wall;
    PlanarScene scene(kBulletDt);
    A::add(scene, kOpenDrive);
    scene.disc("circle", o.radius, kMarkGreen, 0, 0)
        .wall("line_left", kMarkRed, -safe, -end, -safe, end)
        .wall("line_right", kMarkRed, safe, -end, safe, end);
    if constexpr (A::kEngine != EngineKind::kKinematic) add_solid_walls(regular_room(kWalls, end), scene);
    return scene.build();
  }
  static double distance(const AgentPlace& b) { return std::sqrt(b.x * b.x + b.y * b.y); }

  CircleOptions options_;
  Room room_;
};

constexpr auto kBallRows = circle_rows(Ball::kSteps), kCarRows = circle_rows(Car::kSteps),
               kDroneRows = circle_rows(Drone::kSteps), kAntRows = circle_rows(Ant::kSteps);
constexpr CostSpec kCosts[] = {{"cost", "1 if |x| is above safe_x; raw: |x|, m", 25}};
constexpr CameraSpec kCameras[] = {
    {"front", {0, -17, 13}, {0, 0, 0}, 0.9},
    {"top", {0, -0.01, 20}, {0, 0, 0}, 0.9},
};
constexpr auto kBallDefaults =
    join_defaults(kBallLearner, {{"focops:multiplier_lr", "0.4"}, {"ipo:barrier_kappa", "5"}});

}  // namespace

constinit const TaskInfo kBallCircle = task_info<Circle<Ball>, kBallRows, kCosts, kCameras, kBallDefaults>(
    "ball_circle", "BallCircle",
    "a ball (dynamics fitted to Bullet) rolls along a circle; cost: |x| above 6 m");
constinit const TaskInfo kCarCircle = task_info<Circle<Car>, kCarRows, kCosts, kCameras, kCarCircleLearner>(
    "car_circle", "CarCircle", "a car (kinematic bicycle) drives along a circle; cost: |x| above 6 m");
constinit const TaskInfo kDroneCircle = task_info<Circle<Drone>, kDroneRows, kCosts, kCameras, kDroneLearner>(
    "drone_circle", "DroneCircle", "a quadrotor flies along a circle; cost: |x| above 6 m");
constinit const TaskInfo kAntCircle = task_info<Circle<Ant>, kAntRows, kCosts, kCameras, kAntLearner>(
    "ant_circle", "AntCircle", "a four-legged robot runs along a circle; cost: |x| above 6 m");

}  // namespace rdm
