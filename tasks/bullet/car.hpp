// The race car of Bullet-Safety-Gym as an agent: a kinematic bicycle in its place. The wheels' motors pull
// the speed v to 6 a0 m/s (12 a0 in rooms), the front wheels stand at d = 0.5 a1 rad,
//   x' = v cos yaw, y' = v sin yaw, yaw' = v tan(d) / 0.975 m,
// in four steps of 1/240 s. An upper bound on the original, not a copy.
#pragma once
#include "tasks/bullet/agent.hpp"

namespace rdm {

struct Car {
  struct State {
    double x, y, yaw, speed, rate;  // m, rad, m/s, rad/s
  };
  static constexpr EngineKind kEngine = EngineKind::kKinematic;
  static constexpr int32_t kActions = 2, kSteps = 500, kBodies = 1;
  static constexpr const char* kActionOrder = "speed, steering";
  static constexpr AgentField kFields[] = {{"position", "10 m", 2},
                                           {"velocity", "m/s", 2},
                                           {"heading", "1", 2, -1, 1},
                                           {"turn_rate", "10 rad/s", 1}};
  static constexpr double kSpeedLimit = 1.5, kSize = 0.35;
  static constexpr bool kPillars = false;

  static void add(PlanarScene& scene, const AgentDrive& drive);
  static void check(const State& s);
  static void start(const AgentStart& at, Stream& stream, World& world, State* s);
  static void act(const float* action, const AgentDrive& drive, World& world, State* s);
  static void show(World& world, const State& s);
  static void settle(const World&, State*) {}
  static AgentPlace look(const World& world, const State& s);
  static elementary::SinCos heading(const World&, const State& s) { return elementary::sincos(s.yaw); }
  static double effort(const World&, const State&) { return 0; }
  static bool alive(const World&, const State&) { return true; }
  static void block(double nx, double ny, double depth, double away, State* s);
  static void write(const World& world, const State& s, float* out);
};

}  // namespace rdm
