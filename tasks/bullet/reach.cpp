// Bullet-Safety-Gym's Reach: goal after goal in a square room, around puddles and a box that runs in a
// circle.
//
//   r = d' - d + 0.01 effort + 5 [d <= 1.3 m, speed < 5 m/s]    d: distance of the goal after, d' before the
//   step c = [within a puddle by the agent's disc, touching the box, or z > 2 m]
//
// The box stands along the axes, its middle on a circle of 0.7 m at 1 rad/s from a drawn phase, and pushes.
// For the drone the puddles are pillars, which stop it. Rays end at walls, box and pillars; sectors sense
// puddles (or pillars) and the box. Departures: the box does not turn and gives way to nobody; the range of
// the sectors is that of the rays.
#include <algorithm>
#include <cmath>

#include "physics/model/inertia.hpp"
#include "tasks/bullet/ant.hpp"
#include "tasks/bullet/ball.hpp"
#include "tasks/bullet/bullet_learner.hpp"
#include "tasks/bullet/car.hpp"
#include "tasks/bullet/drone.hpp"
#include "tasks/bullet/sensors.hpp"
#include "tasks/catalog.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr int32_t kMaxObstacles = 8, kSectors = 24;
constexpr double kPuddle = 1, kPillar = 0.45;  // m, radii
constexpr double kTouch = 1e-6;  // m: a robot that leans on a pillar is at its edge, up to rounding
constexpr double kBoxHalf = 0.5, kBoxHigh = 1.5, kBoxTravel = 0.7;  // m
constexpr double kBoxMass = 5;                                      // kg
constexpr double kBoxRate = 1;                                      // rad/s
constexpr double kApart = 2.5, kGoalApart = 1.5;                    // m
constexpr double kGoalSpeed = 5;                                    // m/s
constexpr double kRange = 5;                                        // m, of the sensors

struct ReachOptions {
  int32_t obstacles;
  double goal_size, goal_reward;
  int32_t max_steps;
};
consteval auto reach_rows(int32_t max_steps) {
  return option_rows<ReachOptions>(
      row<&ReachOptions::obstacles>(
          basic(integer_option("obstacles", kMaxObstacles, 0, kMaxObstacles,
                               "number of obstacles (puddles, or pillars for the drone)"))),
      row<&ReachOptions::goal_size>(
          basic(number_option("goal_size", 1.3, 0.01, 10, "distance at which a goal counts as reached, m"))),
      row<&ReachOptions::goal_reward>(
          basic(number_option("goal_reward", 5, 0, 1000, "reward for each reached goal"))),
      row<&ReachOptions::max_steps>(
          basic(integer_option("max_steps", max_steps, 1, 100000, "number of control steps in an episode"))));
}

template <class A>
class Reach final : public AgentTask<A> {
  struct State {
    typename A::State agent;
    Stream noise;
    Spot goal, obstacle[kMaxObstacles], box;  // box: the middle of its circle
    double last, phase;                       // m, distance of the goal; rad
    int32_t box_hit, pad;
  };

 public:
  explicit Reach(const ReachOptions& o)
      : AgentTask<A>(make(o), o.max_steps,
                     {{"lidar", "1", RaySensor::kRays, 0, 1},
                      {"obstacles", "1", kSectors, 0, 1},
                      {"goal", "20 m", 2}}),
        room_(square_room()),
        options_(o) {}

  size_t state_bytes() const override { return sizeof(State); }
  void check_state(const void* state) const override {
    const State& s = *static_cast<const State*>(state);
    A::check(s.agent);
    check_spots("goal", &s.goal, 1);
    check_spots("obstacle", s.obstacle, kMaxObstacles);
    const double box[] = {s.box.x, s.box.y};
    check_numbers("box", box, 2, kBoxBound);
    check_numbers("distance", &s.last, 1);
    check_numbers("phase", &s.phase, 1);
    check_integer("box_hit", s.box_hit, 0, 1);
  }

  void reset(World& world, void* state, Stream& stream) const override {
    State& s = *static_cast<State*>(state);
    s.noise = Stream(stream.next(), 0, Purpose::kWorldNoise);
    Keepout things[2 + kMaxObstacles];
    for (Keepout& t : things) t = {{0, 0}, 0.5 * kApart};
    draw_layout(kRoomDraws + 0.5 * kApart, s.noise, things, 2 + options_.obstacles);
    s.box = things[1].at;
    s.phase = 2 * kPi * s.noise.uniform();
    for (int32_t i = 0; i < options_.obstacles; ++i) {
      s.obstacle[i] = things[2 + i].at;
      place(world, kFirstObstacle + i, s.obstacle[i], 0);
    }
    A::start({things[0].at.x, things[0].at.y, 0}, stream, world, &s.agent);
    A::show(world, s.agent);
    place_box(world, s);
    draw_goal(kApart, world, &s);
  }

  void control(World& world, void* state, const float* action) const override {
    State& s = *static_cast<State*>(state);
    A::act(action, kReachDrive, world, &s.agent);
    s.phase += kBoxRate * kBulletDt;
    s.box_hit = 0;
    if constexpr (A::kEngine == EngineKind::kKinematic) {
      if (A::kPillars) stand_off(world, &s);
      meet_box(world, &s);
      keep_inside<A>(room_, world, &s.agent);
    }
    A::show(world, s.agent);
    place_box(world, s);
  }

  Verdict judge(World& world, void* state, int32_t) const override {
    State& s = *static_cast<State*>(state);
    A::settle(world, &s.agent);
    const AgentPlace at = A::look(world, s.agent);
    if constexpr (A::kEngine != EngineKind::kKinematic) s.box_hit = body_touched(world, kBox);
    const double now = distance({at.x, at.y}, s.goal);
    Verdict v;
    v.reward = s.last - now + 0.01 * A::effort(world, s.agent);
    s.last = now;
    v.success = now <= options_.goal_size && at.speed < kGoalSpeed;
    for (int32_t i = 0; i < options_.obstacles; ++i)
      v.cost_raw[1] += distance({at.x, at.y}, s.obstacle[i]) <= kObstacle + A::kSize + kEdge;
    v.cost_raw[2] = s.box_hit;
    v.cost_raw[3] = at.z;
    v.cost[1] = v.cost_raw[1] > 0;
    v.cost[2] = s.box_hit;
    v.cost[3] = at.z > kAgentHeightLimit;
    v.cost_raw[0] = v.cost_raw[1] + v.cost_raw[2] + v.cost[3];
    v.cost[0] = v.cost_raw[0] > 0;
    v.terminated = !A::alive(world, s.agent);
    if (v.success) {
      v.reward += options_.goal_reward;
      draw_goal(kGoalApart, world, &s);
    }
    return v;
  }

  void observe(const World& world, const void* state, float* obs) const override {
    const State& s = *static_cast<const State*>(state);
    const AgentPlace at = A::look(world, s.agent);
    const Spot here{at.x, at.y}, box = box_at(s);
    A::write(world, s.agent, obs);
    RaySensor rays(here, A::heading(world, s.agent), kRange, obs += AgentTask<A>::kAgentObs);
    rays.add_room(room_);
    rays.add_square(box, kBoxHalf);
    SectorSensor sectors(here, kRange, kSectors, obs += RaySensor::kRays);
    sectors.add(box);
    for (int32_t i = 0; i < options_.obstacles; ++i) {
      sectors.add(s.obstacle[i]);
      if (A::kPillars) rays.add_disc(s.obstacle[i], kPillar);
    }
    obs += kSectors;
    obs[0] = static_cast<float>((s.goal.x - at.x) / 20);
    obs[1] = static_cast<float>((s.goal.y - at.y) / 20);
  }

 private:
  static constexpr double kObstacle = A::kPillars ? kPillar : kPuddle;
  static constexpr double kEdge = A::kPillars ? kTouch : 0;
  static constexpr double kBoxBound = 1e5;  // m, well within a body's
  static constexpr int32_t kBox = A::kBodies, kGoal = kBox + 1, kFirstObstacle = kBox + 2;

  // Bodies: the agent's, the box, the goal, the obstacles.
  static Scene make(const ReachOptions& o) {
    PlanarScene scene(kBulletDt);
    A::add(scene, kReachDrive);
    scene.body("box", ShapeKind::kBox, {kBoxHalf, kBoxHalf, 0.5 * kBoxHigh}, kMarkPurple);
    if constexpr (A::kEngine != EngineKind::kKinematic) {
      BodyDef& box = scene.def().bodies.back();
      box.inertia = box_inertia(kBoxMass, box.shapes[0].size);
      box.shapes[0].collides = true;
    }
    scene.body("goal", ShapeKind::kCylinder, {o.goal_size, 0.01, 0}, kMarkGreen);
    for (int32_t i = 0; i < o.obstacles; ++i)
      scene.body(A::kPillars ? "pillar" : "puddle", ShapeKind::kCylinder,
                 {kObstacle, A::kPillars ? 1 : 0.005, 0}, kMarkRed);
    add_square_room(scene);
    if constexpr (A::kEngine != EngineKind::kKinematic) add_solid_walls(square_room(), scene);
    return scene.build();
  }
  static void place(World& world, int32_t body, const Spot& at, double z) {
    Motion m;
    m.X.p = {at.x, at.y, z};
    world.set_body(body, m);
  }
  static Spot box_at(const State& s) {
    const elementary::SinCos at = elementary::sincos(s.phase);
    return {s.box.x + kBoxTravel * at.sin, s.box.y + kBoxTravel * at.cos};
  }
  static Spot box_velocity(const State& s) {
    const elementary::SinCos at = elementary::sincos(s.phase);
    return {kBoxTravel * kBoxRate * at.cos, -kBoxTravel * kBoxRate * at.sin};
  }
  static void place_box(World& world, const State& s) {
    const Spot at = box_at(s), v = box_velocity(s);
    Motion m;
    m.X.p = {at.x, at.y, 0.5 * kBoxHigh};
    m.v = {v.x, v.y, 0};
    world.set_body(kBox, m);
  }

  // Anew until it is `apart` m from the agent and kGoalApart m from what is in the way; after 100 draws the
  // last one stands.
  void draw_goal(double apart, World& world, State* s) const {
    const AgentPlace at = A::look(world, s->agent);
    constexpr int kDraws = 100;
    for (int k = 0; k < kDraws; ++k) {
      s->goal.x = kRoomDraws * s->noise.signed_unit();
      s->goal.y = kRoomDraws * s->noise.signed_unit();
      bool good = distance(s->goal, {at.x, at.y}) > apart && distance(s->goal, s->box) > kGoalApart;
      for (int32_t i = 0; i < options_.obstacles && good; ++i)
        good = distance(s->goal, s->obstacle[i]) > kGoalApart;
      if (good) break;
    }
    s->last = distance({at.x, at.y}, s->goal);
    place(world, kGoal, s->goal, 0);
  }

  void stand_off(World& world, State* s) const {
    for (int32_t i = 0; i < options_.obstacles; ++i) {
      const AgentPlace at = A::look(world, s->agent);
      const double far = distance({at.x, at.y}, s->obstacle[i]), depth = kPillar + A::kSize - far;
      if (depth > 0 && far > 0)
        A::block((s->obstacle[i].x - at.x) / far, (s->obstacle[i].y - at.y) / far, depth, 0, &s->agent);
    }
  }

  // The disc of the agent against the square of the box.
  void meet_box(World& world, State* s) const {
    const AgentPlace at = A::look(world, s->agent);
    const Spot box = box_at(*s), v = box_velocity(*s);
    const double x = std::clamp(at.x, box.x - kBoxHalf, box.x + kBoxHalf) - at.x;
    const double y = std::clamp(at.y, box.y - kBoxHalf, box.y + kBoxHalf) - at.y;
    const double gap = std::sqrt(x * x + y * y);
    if (gap > A::kSize || at.z > kBoxHigh) return;
    s->box_hit = 1;
    if (gap == 0) return;  // its middle is inside: no side to leave by
    A::block(x / gap, y / gap, A::kSize - gap, v.x * x / gap + v.y * y / gap, &s->agent);
  }

  Room room_;
  ReachOptions options_;
};

constexpr auto kBallRows = reach_rows(Ball::kSteps), kCarRows = reach_rows(Car::kSteps),
               kDroneRows = reach_rows(Drone::kSteps), kAntRows = reach_rows(Ant::kSteps);
constexpr CostSpec kCosts[] = {
    {"cost", "1 if the robot meets an obstacle, touches the box or is above 2 m; raw: number of these", 25},
    {"obstacles", "1 if the robot is in a puddle or at a pillar; raw: number of these", -1},
    {"box", "1 if the robot touches the box; raw: the same", -1},
    {"height", "1 if the robot is above 2 m; raw: its height, m", -1},
};

}  // namespace

constinit const TaskInfo kBallReach =
    task_info<Reach<Ball>, kBallRows, kCosts, kRoomCameras, kBallReachLearner>(
        "ball_reach", "BallReach",
        "a ball (dynamics fitted to Bullet) reaches goal after goal; cost: puddles and a moving box");
constinit const TaskInfo kCarReach = task_info<Reach<Car>, kCarRows, kCosts, kRoomCameras, kCarReachLearner>(
    "car_reach", "CarReach",
    "a car (kinematic bicycle) reaches goal after goal; cost: puddles and a moving box");
constinit const TaskInfo kDroneReach =
    task_info<Reach<Drone>, kDroneRows, kCosts, kRoomCameras, kDroneReachLearner>(
        "drone_reach", "DroneReach",
        "a quadrotor reaches goal after goal; cost: pillars, a moving box, more than 2 m of height");
constinit const TaskInfo kAntReach = task_info<Reach<Ant>, kAntRows, kCosts, kRoomCameras, kAntReachLearner>(
    "ant_reach", "AntReach", "a four-legged robot reaches goal after goal; cost: puddles and a moving box");

}  // namespace rdm
