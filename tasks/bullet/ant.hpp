// The ant of Bullet-Safety-Gym as an agent: eight motors on a free body that the articulated engine moves.
//
// The body is MuJoCo's ant (legged/ant_body.hpp) with hips of +-40 and ankles of 30 to 100 degrees; a motor
// gives 250 a N m. Its armature and damping of 1 are those of that model. It is over when the torso is at
// 0.26 m or lower. Departure: in rooms too, where the original has 1000 a. The effort is
//   -2 mean |a r| - 0.1 mean a^2 - 0.1 #(|p| > 0.99) + 1 (fallen: -1),   p: joint position relative to its
//   range, in [-1, 1]; r: 0.1 times the joint's rate
#pragma once
#include "tasks/bullet/agent.hpp"
#include "tasks/legged/ant_body.hpp"

namespace rdm {

struct Ant {
  struct State {
    float action[kAntJoints];
    uint32_t feet, pad;  // bits: the foot touched something in the last control step
  };
  static constexpr EngineKind kEngine = EngineKind::kArticulated;
  static constexpr int32_t kActions = kAntJoints, kSteps = 1000, kBodies = 0;
  static constexpr const char* kActionOrder = kAntOrder;
  static constexpr AgentField kFields[] = {{"position", "10 m", 3},
                                           {"velocity", "3.333 m/s", 3},
                                           {"rotation", "1", 4, -1, 1},
                                           {"spin", "6.667 rad/s", 3},
                                           {"joints", "2, 20 rad/s", 2 * kAntJoints},
                                           {"feet", "1", kAntLegs, 0, 1}};
  static constexpr double kSpeedLimit = 1.5, kSize = 0.5;
  static constexpr bool kPillars = false;

  static void add(PlanarScene& scene, const AgentDrive& drive);
  static void check(const State& s);
  static void start(const AgentStart& at, Stream& stream, World& world, State* s);
  static void act(const float* action, const AgentDrive& drive, World& world, State* s);
  static void show(World&, const State&) {}
  static void settle(const World& world, State* s);
  static AgentPlace look(const World& world, const State& s);
  static elementary::SinCos heading(const World& world, const State& s);
  static double effort(const World& world, const State& s);
  static bool alive(const World& world, const State& s);
  static void write(const World& world, const State& s, float* out);
};

}  // namespace rdm
