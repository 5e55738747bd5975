#include "tasks/legged/ant_body.hpp"

#include <cmath>

namespace rdm {
namespace {

constexpr double kTorso = 0.25, kLimb = 0.08;  // m, radii
constexpr double kJoint = 0.2, kShin = 0.4;    // m, along x and y: from torso to hip to ankle; of the shin
constexpr double kDensity = 5;                 // kg/m3
constexpr double kDamping = 1, kArmature = 1;  // N m s/rad, kg m2
constexpr double kX[kAntLegs] = {1, -1, -1, 1}, kY[kAntLegs] = {1, 1, -1, -1};
constexpr const char* kFixed[kAntLegs] = {"leg_1", "leg_2", "leg_3", "leg_4"};
constexpr const char* kHips[kAntLegs] = {"hip_1", "hip_2", "hip_3", "hip_4"};
constexpr const char* kAnkles[kAntLegs] = {"ankle_1", "ankle_2", "ankle_3", "ankle_4"};

}  // namespace

void add_ant(const AntRange& range, PlanarScene& scene) {
  ArticulationDef robot;
  robot.name = "ant";
  robot.free_base = true;
  robot.gravity = true;
  robot.X_WB.p = {0, 0, kAntHeight};
  add_sphere("torso", kTorso, kDensity, kMarkYellow, -1, &robot);
  for (int32_t i = 0; i < kAntLegs; ++i) {
    const Vec3 to{kJoint * kX[i], kJoint * kY[i], 0}, shin{kShin * kX[i], kShin * kY[i], 0};
    const double side = ankle_side(i), low = range.ankle_low, high = range.ankle_high;
    const MotorJoint hip{-range.hip, range.hip, range.gear, kDamping, kArmature};
    const MotorJoint ankle{side > 0 ? low : -high, side > 0 ? high : -low, range.gear, kDamping, kArmature};
    // about (-1, 1, 0) in the first and third leg, (1, 1, 0) in the others
    const Vec3 axis = normalized(Vec3{i % 2 == 0 ? -1.0 : 1.0, 1, 0});
    robot.links.push_back(hinged_link(kHips[i], -1, to, {0, 0, 1}, &hip));
    robot.links.push_back(hinged_link(kAnkles[i], 2 * i, to, axis, &ankle));
    add_capsule(kFixed[i], {}, to, kLimb, kDensity, kLimbMaterial, kMarkYellow, -1, &robot);
    add_capsule(kHips[i], {}, to, kLimb, kDensity, kLimbMaterial, kMarkBlue, 2 * i, &robot);
    add_capsule(kAnkles[i], {}, shin, kLimb, kDensity, kFootMaterial, kMarkCyan, 2 * i + 1, &robot);
  }
  scene.def().articulations.push_back(std::move(robot));
}

void set_ant(World& world, const Pose& X, const Vec3& v, const Vec3& w, const double* q, const double* qd) {
  world.set_joints(0, q, qd);
  world.set_base(0, {X, v, w});
  for (int32_t i = 0; i < kAntJoints; ++i) world.feedforward()[i] = 0;
}

void drive_ant(World& world, const float* action, double gear) {
  for (int32_t i = 0; i < kAntJoints; ++i) world.feedforward()[i] = gear * static_cast<double>(action[i]);
}

int32_t ant_body(const SceneShape& shape) {
  if (shape.articulation != 0) return -1;
  for (int32_t i = 0; i < kAntLegs; ++i)
    if (shape.carrier == Carrier::kBase && shape.def.name == kFixed[i]) return 2 + 3 * i;
  if (shape.carrier == Carrier::kBase) return 1;
  return 2 + 3 * (shape.index / 2) + 1 + shape.index % 2;
}

}  // namespace rdm
