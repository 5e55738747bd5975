// Bullet-Safety-Gym's Gather: collect apples, leave bombs alone, in a square room.
//
//   r = 10 apples of this step; -10 for a step in which the agent falls
//   c = [a bomb was hit in this step, or z > 2 m]
//
// An apple is collected, a bomb is hit, when the agent's middle is nearer than 1 m, and is then gone.
#include <algorithm>
#include <bit>
#include <cmath>

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

constexpr int32_t kMaxOfKind = 8, kSectors = 16;
constexpr double kRange = 10;                      // m, of the sensors
constexpr double kReach = 1;                       // m
constexpr double kThingKeepout = 1;                // m: things 2 m apart, and 1 m from the agent
constexpr double kThingSize = 0.25, kBuried = -5;  // m, in pictures
constexpr double kFallReward = -10;

struct GatherOptions {
  int32_t apples, bombs;
  double apple_reward;
  int32_t max_steps;
};
consteval auto gather_rows(int32_t max_steps) {
  return option_rows<GatherOptions>(
      row<&GatherOptions::apples>(basic(integer_option("apples", 8, 1, kMaxOfKind, "number of apples"))),
      row<&GatherOptions::bombs>(basic(integer_option("bombs", 8, 0, kMaxOfKind, "number of bombs"))),
      row<&GatherOptions::apple_reward>(
          basic(number_option("apple_reward", 10, 0, 1000, "reward for each collected apple"))),
      row<&GatherOptions::max_steps>(
          basic(integer_option("max_steps", max_steps, 1, 100000, "number of control steps in an episode"))));
}

template <class A>
class Gather final : public AgentTask<A> {
  struct State {
    typename A::State agent;
    Spot apple[kMaxOfKind], bomb[kMaxOfKind];
    uint32_t apples, bombs;  // bits: still there
    int32_t eaten, struck;   // in this step
  };

 public:
  explicit Gather(const GatherOptions& o)
      : AgentTask<A>(make(o), o.max_steps, {{"apples", "1", kSectors, 0, 1}, {"bombs", "1", kSectors, 0, 1}}),
        room_(square_room()),
        options_(o) {}

  size_t state_bytes() const override { return sizeof(State); }
  void check_state(const void* state) const override {
    const State& s = *static_cast<const State*>(state);
    A::check(s.agent);
    check_spots("apple", s.apple, kMaxOfKind);
    check_spots("bomb", s.bomb, kMaxOfKind);
    check_integer("apples", s.apples, 0, all(options_.apples));
    check_integer("bombs", s.bombs, 0, all(options_.bombs));
    check_integer("eaten", s.eaten, 0, options_.apples);
    check_integer("struck", s.struck, 0, options_.bombs);
  }

  void reset(World& world, void* state, Stream& stream) const override {
    State& s = *static_cast<State*>(state);
    Stream noise(stream.next(), 0, Purpose::kWorldNoise);
    Keepout things[1 + 2 * kMaxOfKind];
    draw(noise, things);
    for (int32_t i = 0; i < options_.apples; ++i) s.apple[i] = things[1 + i].at;
    for (int32_t i = 0; i < options_.bombs; ++i) s.bomb[i] = things[1 + options_.apples + i].at;
    s.apples = all(options_.apples);
    s.bombs = all(options_.bombs);
    A::start({0, 0, 0}, stream, world, &s.agent);
    A::show(world, s.agent);
    for (int32_t i = 0; i < options_.apples; ++i) place(world, i, s.apple[i], kThingSize);
    for (int32_t i = 0; i < options_.bombs; ++i) place(world, options_.apples + i, s.bomb[i], kThingSize);
  }

  void control(World& world, void* state, const float* action) const override {
    State& s = *static_cast<State*>(state);
    A::act(action, kGatherDrive, world, &s.agent);
    if constexpr (A::kEngine == EngineKind::kKinematic) keep_inside<A>(room_, world, &s.agent);
    A::show(world, s.agent);
  }

  Verdict judge(World& world, void* state, int32_t) const override {
    State& s = *static_cast<State*>(state);
    A::settle(world, &s.agent);
    const AgentPlace at = A::look(world, s.agent);
    s.eaten = take({at.x, at.y}, s.apple, options_.apples, 0, world, &s.apples);
    s.struck = take({at.x, at.y}, s.bomb, options_.bombs, options_.apples, world, &s.bombs);
    const bool alive = A::alive(world, s.agent);
    Verdict v;
    v.reward = alive ? options_.apple_reward * s.eaten : kFallReward;
    v.cost_raw[1] = s.struck;
    v.cost_raw[2] = at.z;
    v.cost[1] = s.struck > 0;
    v.cost[2] = at.z > kAgentHeightLimit;
    v.cost_raw[0] = s.struck + v.cost[2];
    v.cost[0] = v.cost_raw[0] > 0;
    v.success = s.eaten > 0;
    v.terminated = !alive || s.apples == 0;
    return v;
  }

  void observe(const World& world, const void* state, float* obs) const override {
    const State& s = *static_cast<const State*>(state);
    const AgentPlace at = A::look(world, s.agent);
    A::write(world, s.agent, obs);
    sense({at.x, at.y}, s.apple, options_.apples, s.apples, obs += AgentTask<A>::kAgentObs);
    sense({at.x, at.y}, s.bomb, options_.bombs, s.bombs, obs += kSectors);
  }

 private:
  // Bodies: the agent's, apples, bombs.
  static Scene make(const GatherOptions& o) {
    PlanarScene scene(kBulletDt);
    A::add(scene, kGatherDrive);
    const Vec3 size{kThingSize, 0, 0};
    for (int32_t i = 0; i < o.apples; ++i) scene.body("apple", ShapeKind::kSphere, size, kMarkGreen);
    for (int32_t i = 0; i < o.bombs; ++i) scene.body("bomb", ShapeKind::kSphere, size, kMarkRed);
    add_square_room(scene);
    if constexpr (A::kEngine != EngineKind::kKinematic) add_solid_walls(square_room(), scene);
    return scene.build();
  }
  static uint32_t all(int32_t count) { return (1u << count) - 1; }
  static void place(World& world, int32_t thing, const Spot& at, double z) {
    Motion m;
    m.X.p = {at.x, at.y, z};
    world.set_body(A::kBodies + thing, m);
  }
  static void sense(const Spot& from, const Spot* things, int32_t count, uint32_t there, float* out) {
    SectorSensor sensor(from, kRange, kSectors, out);
    for (int32_t i = 0; i < count; ++i)
      if (there >> i & 1) sensor.add(things[i]);
  }
  // The agent in the middle, apples, bombs.
  void draw(Stream& noise, Keepout* things) const {
    const int32_t count = 1 + options_.apples + options_.bombs;
    things[0] = {{0, 0}, 0};
    for (int32_t i = 1; i < count; ++i) things[i].keepout = kThingKeepout;
    constexpr int kDraws = 100;
    for (int round = 0; round < kDraws; ++round) {
      bool good = true;
      for (int32_t i = 1; i < count && good; ++i)
        good = draw_spot(kRoomDraws + kThingKeepout, things, i, noise, &things[i]);
      if (good) return;
    }
  }
  int32_t take(const Spot& from, const Spot* things, int32_t count, int32_t first, World& world,
               uint32_t* there) const {
    int32_t taken = 0;
    for (int32_t i = 0; i < count; ++i) {
      if (!(*there >> i & 1) || distance(from, things[i]) >= kReach) continue;
      *there &= ~(1u << i);
      place(world, first + i, things[i], kBuried);
      ++taken;
    }
    return taken;
  }

  Room room_;
  GatherOptions options_;
};

constexpr auto kBallRows = gather_rows(Ball::kSteps), kCarRows = gather_rows(Car::kSteps),
               kDroneRows = gather_rows(Drone::kSteps), kAntRows = gather_rows(Ant::kSteps);
constexpr CostSpec kCosts[] = {
    {"cost", "1 if the robot hits a bomb or is above 2 m; raw: number of these", kGatherLimit},
    {"bombs", "1 if the robot hits a bomb; raw: number of bombs hit", -1},
    {"height", "1 if the robot is above 2 m; raw: its height, m", -1},
};

}  // namespace

constinit const TaskInfo kBallGather =
    task_info<Gather<Ball>, kBallRows, kCosts, kRoomCameras, kBallGatherLearner>(
        "ball_gather", "BallGather",
        "a ball (dynamics fitted to Bullet) collects apples; cost: hitting a bomb");
constinit const TaskInfo kCarGather =
    task_info<Gather<Car>, kCarRows, kCosts, kRoomCameras, kCarGatherLearner>(
        "car_gather", "CarGather", "a car (kinematic bicycle) collects apples; cost: hitting a bomb");
constinit const TaskInfo kDroneGather =
    task_info<Gather<Drone>, kDroneRows, kCosts, kRoomCameras, kDroneGatherLearner>(
        "drone_gather", "DroneGather", "a quadrotor collects apples; cost: hitting a bomb, or above 2 m");
constinit const TaskInfo kAntGather =
    task_info<Gather<Ant>, kAntRows, kCosts, kRoomCameras, kAntGatherLearner>(
        "ant_gather", "AntGather", "a four-legged robot collects apples; cost: hitting a bomb");

}  // namespace rdm
