// The four-legged ant of MuJoCo and Bullet: a sphere with four legs of three capsules, the first of which is
// fixed to it; a hip turns about z, an ankle about the leg's side. Density 5, 0.911 kg.
//
// Legs in order: front left (+,+), front right (-,+), back left (-,-), back right (+,-) of x and y; links are
// the legs' hip and ankle in turn. An ankle at 0 would stretch its leg out; both models keep it bent to one
// side.
#pragma once
#include "tasks/legged/walker_scene.hpp"

namespace rdm {

inline constexpr int32_t kAntLegs = 4, kAntJoints = 8;
inline constexpr double kAntHeight = 0.75;  // m, of the torso's middle in the first pose
inline constexpr const char* kAntOrder = "hip 1, ankle 1, hip 2, ankle 2, hip 3, ankle 3, hip 4, ankle 4";

struct AntRange {
  double hip, ankle_low, ankle_high;  // rad; of the ankle in magnitude
  double gear;                        // N m
};
// 1 or -1: the side to which the ankle of a leg is bent.
inline double ankle_side(int32_t leg) {
  return leg == 0 || leg == 3 ? 1 : -1;
}
void add_ant(const AntRange& range, PlanarScene& scene);

// The middle of the torso at the place and yaw, its joints at q, everything at the velocities qd, v and w
// (world).
void set_ant(World& world, const Pose& X, const Vec3& v, const Vec3& w, const double* q, const double* qd);
void drive_ant(World& world, const float* action, double gear);
// The body of a shape of the ant, in the order of MuJoCo's: torso, then of each leg the fixed part, hip and
// ankle; 0 is the world. -1: no part of it.
inline constexpr int32_t kAntBodies = 14;
int32_t ant_body(const SceneShape& shape);

}  // namespace rdm
