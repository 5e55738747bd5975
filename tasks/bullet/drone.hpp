// The quadrotor (Hummingbird) of Bullet-Safety-Gym as an agent: one rigid body under four thrusts.
//
// A rotor at 0.34 m before, left, behind, right of the middle turns at w = 461.52 (1 + 0.1 a) rad/s and pulls
// along the body's z with
//   T = rho pi r^2 (u^2 - u v) (k1 2 r / p)^1.5,  u = w p / 2 pi
// rho 1.225 kg/m3, radius r 0.14 m, pitch p 0.11938 m, k1 = 1/3.29546, v the body's speed along its z: 3.4826
// N, a quarter of the weight, at a = 0 and at rest. Mass 1.42 kg, moments (.05, .05, .24) kg m2, Bullet's
// damping 0.04 (1 + |v|) of both velocities, semi-implicit steps of 1/240 s. Of the ground it knows four
// feet, under the rotors, that do not bounce and rub (0.8). Rotors turn against each other: nothing turns it
// about z.
#pragma once
#include "tasks/bullet/agent.hpp"

namespace rdm {

struct Drone {
  static constexpr int kRotors = 4;
  struct State {
    Vec3 p, v, w;           // m, m/s, rad/s; world axes
    Quat q;                 // q_WB
    double rotor[kRotors];  // rad/s above hovering
    int32_t touching, pad;  // feet on the ground
  };
  static constexpr EngineKind kEngine = EngineKind::kKinematic;
  static constexpr int32_t kActions = kRotors, kSteps = 500, kBodies = 1;
  static constexpr const char* kActionOrder = "front rotor, left rotor, back rotor, right rotor";
  static constexpr AgentField kFields[] = {{"position", "10 m", 3},
                                           {"velocity", "5 m/s", 3},
                                           {"rotation", "1", 4, -1, 1},
                                           {"spin", "10 rad/s", 3},
                                           {"rotor_speed", "400 rad/s", 4}};
  static constexpr double kSpeedLimit = 1.5, kSize = 0.5;
  static constexpr bool kPillars = true;

  static void add(PlanarScene& scene, const AgentDrive& drive);
  static void check(const State& s);
  static void start(const AgentStart& at, Stream& stream, World& world, State* s);
  static void act(const float* action, const AgentDrive& drive, World& world, State* s);
  static void show(World& world, const State& s);
  static void settle(const World&, State*) {}
  static AgentPlace look(const World& world, const State& s);
  static elementary::SinCos heading(const World& world, const State& s);
  // 1 in the air and upright, -10 fallen; less 0.01 |w|^2 and 1 for each foot on the ground.
  static double effort(const World& world, const State& s);
  static bool alive(const World& world, const State& s);  // roll within +-90 degrees
  static void block(double nx, double ny, double depth, double away, State* s);
  static void write(const World& world, const State& s, float* out);
};

// N, of a rotor at `w` rad/s on a body that moves at `v` m/s along its z.
double rotor_thrust(double w, double v);
inline constexpr double kHoverSpeed = 461.52;  // rad/s

}  // namespace rdm
