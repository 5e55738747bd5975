// A hand on an arm of six joints, two of them sliding: 30 coordinates in one tree.
#pragma once
#include "quality_hands.hpp"

namespace rdm::test {

inline constexpr int32_t kArmLinks = 6, kArmHandLinks = kArmLinks + kHandLinks;

inline SceneDef arm_def() {
  struct Row {
    const char* name;
    JointKind kind;
    Vec3 axis, p_PL;
    double range, kp, kd, effort, mass;
    Vec3 half_size;  // of the box of metal that gives the inertia, m
  };
  constexpr JointKind kTurn = JointKind::kRevolute, kSlide = JointKind::kPrismatic;
  const Row rows[kArmLinks] = {
      {"rail", kSlide, {1, 0, 0}, {0, 0, 0.1}, 0.5, 4000, 400, 500, 5, {0.2, 0.1, 0.05}},
      {"turret", kTurn, {0, 0, 1}, {0, 0, 0.1}, 2, 300, 30, 150, 4, {0.1, 0.08, 0.1}},
      {"lift", kSlide, {0, 0, 1}, {0.05, 0, 0.2}, 0.2, 6000, 400, 800, 3, {0.05, 0.1, 0.2}},
      {"shoulder", kTurn, {0, 1, 0}, {0, 0, 0.2}, 1, 300, 30, 150, 2, {0.03, 0.05, 0.15}},
      {"elbow", kTurn, {1, 0, 0}, {0, 0.1, 0.25}, 1, 200, 20, 100, 1.5, {0.04, 0.03, 0.12}},
      {"flange", kTurn, {0, 0, 1}, {0, 0, 0.2}, 1.5, 50, 5, 40, 0.5, {0.03, 0.04, 0.02}}};
  SceneDef def;
  def.articulations.push_back(make_articulation(kShadowHand, Side::kRight, {{0, 0, 0}, {}}, "hand_"));
  ArticulationDef& arm = def.articulations[0];
  arm.gravity = true;
  const Pose X_FH = {{0, 0, 0.05}, {}};  // hand on the flange
  for (LinkDef& link : arm.links) {
    if (link.parent < 0) link.X_PL = X_FH * link.X_PL;
    link.parent += kArmLinks;  // -1, the base, becomes the flange
    if (link.joint.coupled_to >= 0) link.joint.coupled_to += kArmLinks;
  }
  for (ArticulationShape& s : arm.shapes) {
    if (s.link < 0) s.shape.X_LS = X_FH * s.shape.X_LS;
    s.link = s.link < 0 ? kArmLinks - 1 : s.link + kArmLinks;
  }
  arm.self_pairs.clear();
  for (int32_t i = kArmLinks - 1; i >= 0; --i) {
    const Row& row = rows[i];
    LinkDef link;
    link.name = row.name;
    link.parent = i - 1;
    link.X_PL.p = row.p_PL;
    link.inertia = box_inertia(row.mass, row.half_size);
    link.inertia.com = {0.01, -0.02, 0.5 * row.half_size.z};
    link.joint.name = row.name;
    link.joint.kind = row.kind;
    link.joint.axis = row.axis;
    link.joint.lower = -row.range;
    link.joint.upper = row.range;
    link.joint.kp = row.kp;
    link.joint.kd = row.kd;
    link.joint.effort = row.effort;
    arm.links.insert(arm.links.begin(), link);
  }
  return def;
}

// All joints are sent to a third of their ranges at once, and back after a quarter of a second. Ends of ranges are
// out of the way: each engine has a law of its own for them (limits, in quality_hands.hpp).
struct Reach {
  static constexpr int kTicks = 30;
  double coordinate[kTicks][kArmHandLinks];  // rad, m
};
inline Reach reach(const Column& column, bool coupled = true) {
  SceneDef def = arm_def();
  if (!coupled) uncouple(&def);
  double target[2][kArmHandLinks];
  int32_t joints = 0;
  for (ArticulationDef& a : def.articulations)
    for (LinkDef& link : a.links) {
      JointDef& joint = link.joint;
      const double middle = 0.5 * (joint.lower + joint.upper), half = 0.5 * (joint.upper - joint.lower);
      const double way = (joints % 2 ? -1 : 1) * half / 3;
      target[0][joints] = middle + way, target[1][joints++] = middle - way;
      joint.lower -= 1, joint.upper += 1;
    }
  Rig rig(def, column);
  Reach out;
  for (int k = 0; k < Reach::kTicks; ++k) {
    for (int32_t i = 0; i < kArmHandLinks; ++i) rig->target()[i] = target[k < Reach::kTicks / 2 ? 0 : 1][i];
    rig.tick([] {});
    for (int32_t i = 0; i < kArmHandLinks; ++i) out.coordinate[k][i] = rig.checked(rig->q()[i]);
  }
  return out;
}
// Over the run and the joints from `first` to before `end`, rad (m).
inline double rms_error(const Reach& a, const Reach& b, int32_t first, int32_t end) {
  double sum = 0;
  for (int k = 0; k < Reach::kTicks; ++k)
    for (int32_t i = first; i < end; ++i) sum += square(a.coordinate[k][i] - b.coordinate[k][i]);
  return std::sqrt(sum / (Reach::kTicks * (end - first)));
}

}  // namespace rdm::test
