// A finger of two links on a block: what a robot needs at least. z along the finger, the palm faces -y.
#include "robot/robot.hpp"

namespace rdm {
namespace {

constexpr RobotLink phalanx(const char* name, const char* joint, int32_t parent, Vec3 p) {
  return {.name = name,
          .joint = joint,
          .parent = parent,
          .p_PL = p,
          .rpy_PL = {},
          .mass = 0.05,
          .com = {0, 0, 0.02},
          .moment = {1e-5, 1e-5, 1e-5, 0, 0, 0},
          .kind = JointKind::kRevolute,
          .axis = {1, 0, 0},
          .lower = 0,
          .upper = 1.5,
          .kp = 1,
          .kd = 0.1,
          .effort = 1,
          .armature = 0,
          .friction = 0.001};
}
constexpr RobotLink kLinks[] = {phalanx("near", "J1", -1, {0, 0, 0.05}),
                                phalanx("far", "J2", 0, {0, 0, 0.04})};

constexpr RobotShape bone(int32_t link, const char* name) {
  return {link, name, ShapeKind::kCapsule, {0.01, 0.015, 0}, {0, 0, 0.02}, {}, {200, 200, 200}};
}
constexpr RobotShape kShapes[] = {bone(0, "near"), bone(1, "far")};
constexpr RobotTip kTips[] = {{1, {0, 0, 0.045}}};

}  // namespace

extern constinit const Robot kOneFinger = {
    .name = "one_finger",
    .help = "a finger of two driven joints on a block",
    .X_BR = {},
    .root = {0.2, {}, {1e-4, 1e-4, 1e-4, 0, 0, 0}},
    .links = table(kLinks),
    .shapes = table(kShapes),
    .tips = table(kTips),
    .mirror = 1,
};

}  // namespace rdm
