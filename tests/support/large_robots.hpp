// Arms of six or seven joints with a hand on the last one, light and heavy, and trees of many joints.
#pragma once
#include <algorithm>
#include <cmath>

#include "articulated.hpp"

namespace rdm::test {

// A joint of an arm, in the pose in which it hangs straight up: how far it stands from the last one, its
// axis, what it moves and what moves it.
struct ArmJoint {
  Vec3 p, axis;
  double mass, radius, half_length;  // kg; of the link's capsule along z, m
  double lower, upper, kp, kd, effort;
};

// A light arm of seven joints, 0.9 m long, 25 kg.
inline constexpr ArmJoint kLightArm[] = {
    {{0, 0, 0.16}, {0, 0, 1}, 5, 0.06, 0.06, -2.9, 2.9, 4000, 400, 300},
    {{0, 0, 0.18}, {0, 1, 0}, 5, 0.06, 0.06, -2, 2, 4000, 400, 300},
    {{0, 0, 0.2}, {0, 0, 1}, 4, 0.06, 0.06, -2.9, 2.9, 3000, 300, 200},
    {{0, 0, 0.2}, {0, -1, 0}, 3.5, 0.06, 0.06, -2, 2, 3000, 300, 200},
    {{0, 0, 0.2}, {0, 0, 1}, 3, 0.05, 0.05, -2.9, 2.9, 1500, 150, 150},
    {{0, 0, 0.2}, {0, 1, 0}, 3, 0.05, 0.05, -2, 2, 1000, 100, 80},
    {{0, 0, 0.08}, {0, 0, 1}, 0.8, 0.04, 0.02, -3, 3, 500, 50, 40},
};
// An industrial one of six joints, 2 m long, 350 kg.
inline constexpr ArmJoint kHeavyArm[] = {
    {{0, 0, 0.5}, {0, 0, 1}, 100, 0.25, 0.1, -3, 3, 200000, 20000, 6500},
    {{0.175, 0, 0}, {0, 1, 0}, 70, 0.14, 0.4, -1.5, 2.6, 200000, 20000, 6500},
    {{0, 0, 0.9}, {0, 1, 0}, 100, 0.2, 0.07, -3, 1.3, 100000, 10000, 2500},
    {{0, 0, 0.175}, {0, 0, 1}, 39, 0.12, 0.26, -3, 3, 20000, 2000, 600},
    {{0, 0, 0.6}, {0, 1, 0}, 3.5, 0.08, 0.01, -2, 2, 20000, 2000, 600},
    {{0, 0, 0.135}, {0, 0, 1}, 0.8, 0.06, 0.01, -3, 3, 10000, 1000, 300},
};

template <size_t kCount>
ArticulationDef make_arm(const ArmJoint (&joints)[kCount], const Pose& X_WB) {
  ArticulationDef def;
  def.name = "arm";
  def.X_WB = X_WB;
  def.gravity = true;
  for (const ArmJoint& j : joints) {
    LinkDef link;
    link.parent = static_cast<int32_t>(def.links.size()) - 1;
    link.X_PL.p = j.p;
    link.inertia = capsule_inertia(j.mass, j.radius, j.half_length);
    link.inertia.com = {0.01, 0, j.half_length};
    link.joint.axis = j.axis;
    link.joint.lower = j.lower;
    link.joint.upper = j.upper;
    link.joint.kp = j.kp;
    link.joint.kd = j.kd;
    link.joint.effort = j.effort;
    def.links.push_back(link);
    ArticulationShape shape;
    shape.link = link.parent + 1;
    shape.shape.kind = ShapeKind::kCapsule;
    shape.shape.size = {j.radius, j.half_length, 0};
    shape.shape.X_LS.p = {0, 0, j.half_length};
    def.shapes.push_back(shape);
  }
  return def;
}

// The Shadow Hand's links and shapes behind the last link of `arm`, 0.05 m above it.
inline ArticulationDef with_hand(ArticulationDef arm, Side side, bool weightless = false) {
  const ArticulationDef hand =
      make_articulation(kShadowHand, side, {}, side == Side::kLeft ? "left_" : "right_");
  const auto first = static_cast<int32_t>(arm.links.size());
  for (LinkDef link : hand.links) {
    if (link.parent < 0) link.X_PL.p += Vec3{0, 0, 0.05};
    link.parent = link.parent < 0 ? first - 1 : first + link.parent;
    if (link.joint.coupled_to >= 0) link.joint.coupled_to += first;
    link.weightless = weightless;
    arm.links.push_back(link);
  }
  const auto first_shape = static_cast<int32_t>(arm.shapes.size());
  for (ArticulationShape shape : hand.shapes) {
    if (shape.link < 0) shape.shape.X_LS.p += Vec3{0, 0, 0.05};
    shape.link = shape.link < 0 ? first - 1 : first + shape.link;
    arm.shapes.push_back(shape);
  }
  for (const auto& [a, b] : hand.self_pairs) arm.self_pairs.push_back({first_shape + a, first_shape + b});
  return arm;
}

// A trunk of `trunk` joints with `fingers` fingers of `joints` each, axes in turn; light.
inline ArticulationDef make_bush(int trunk, int fingers, int joints, const Pose& X_WB) {
  ArticulationDef def;
  def.name = "bush";
  def.X_WB = X_WB;
  def.gravity = true;
  const auto add = [&](int32_t parent, const Vec3& p, double mass, double kp) {
    LinkDef link;
    link.parent = parent;
    link.X_PL.p = p;
    link.inertia = capsule_inertia(mass, 0.01, 0.015);
    link.inertia.com = {0, 0, 0.02};
    link.joint.axis = def.links.size() % 2 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
    link.joint.lower = -0.8;
    link.joint.upper = 0.8;
    link.joint.kp = kp;
    link.joint.kd = 0.1 * kp;
    link.joint.effort = 2 * kp;
    def.links.push_back(link);
    ArticulationShape shape;
    shape.link = static_cast<int32_t>(def.links.size()) - 1;
    shape.shape.kind = ShapeKind::kCapsule;
    shape.shape.size = {0.01, 0.015, 0};
    shape.shape.X_LS.p = {0, 0, 0.02};
    def.shapes.push_back(shape);
    return shape.link;
  };
  int32_t last = -1;
  for (int i = 0; i < trunk; ++i) last = add(last, {0, 0, 0.05}, 0.3, 60);
  for (int f = 0; f < fingers; ++f) {
    int32_t parent = last;
    const double angle = 6.28 * f / std::max(fingers, 1);
    for (int i = 0; i < joints; ++i)
      parent = add(parent, i ? Vec3{0, 0, 0.05} : Vec3{0.05 * std::cos(angle), 0.05 * std::sin(angle), 0.05},
                   0.02, 2);
  }
  return def;
}

}  // namespace rdm::test
