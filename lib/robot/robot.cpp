#include "robot/robot.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "base/error.hpp"
#include "physics/model/inertia.hpp"
#include "robot/kinematics.hpp"

namespace rdm {
namespace {

Name joined(const char* prefix, const char* name) {
  char text[2 * kNameSize];
  std::snprintf(text, sizeof text, "%s%s", prefix, name);
  return Name(text);
}

// The left side's tint: the same greys, a little towards blue.
void tint(uint8_t* color) {
  color[0] = static_cast<uint8_t>(color[0] * 7 / 8);
  color[2] = static_cast<uint8_t>(color[2] + (255 - color[2]) / 6);
}

LinkDef make_link(const Robot& robot, const RobotLink& row, const char* prefix) {
  LinkDef link;
  link.name = joined(prefix, row.name);
  link.parent = row.parent;
  link.X_PL = link_frame(row);
  link.inertia.mass = row.mass;
  link.inertia.com = row.com;
  std::memcpy(link.inertia.moment, row.moment, sizeof row.moment);
  JointDef& joint = link.joint;
  joint.name = joined(prefix, row.joint);
  joint.kind = row.kind;
  joint.axis = row.axis;
  joint.lower = row.lower;
  joint.upper = row.upper;
  joint.kp = row.kp;
  joint.kd = row.kd;
  joint.effort = row.effort;
  joint.velocity = row.velocity;
  joint.armature = row.armature;
  joint.friction = row.friction;
  for (const RobotTip& tip : robot.tips)
    if (&robot.links[tip.link] == &row) link.sensor = true;
  for (const RobotCoupling& c : robot.couplings)
    if (&robot.links[c.link] == &row) {
      joint.coupled_to = c.other;
      joint.ratio = c.ratio;
      joint.slack = c.slack;
    }
  return link;
}

// A prismatic axis is a true vector, a turn's a pseudovector.
void mirror(ArticulationDef* def, int32_t axis) {
  def->base = mirrored_inertia(def->base, axis);
  for (LinkDef& link : def->links) {
    link.X_PL = {mirrored_point(link.X_PL.p, axis), mirrored_turn(link.X_PL.q, axis)};
    link.inertia = mirrored_inertia(link.inertia, axis);
    JointDef& joint = link.joint;
    joint.axis = joint.kind == JointKind::kPrismatic ? mirrored_point(joint.axis, axis)
                                                     : mirrored_axis(joint.axis, axis);
  }
  for (ArticulationShape& s : def->shapes) {
    Pose& X = s.shape.X_LS;
    X = {mirrored_point(X.p, axis), mirrored_turn(X.q, axis)};
    tint(s.shape.color);
  }
}

// From the root frame of the tables into the base frame.
void hang(ArticulationDef* def, const Pose& X_BR) {
  if (def->base.mass > 0) def->base = transformed(def->base, X_BR);
  for (LinkDef& link : def->links)
    if (link.parent < 0) link.X_PL = X_BR * link.X_PL;
  for (ArticulationShape& s : def->shapes)
    if (s.link < 0) s.shape.X_LS = X_BR * s.shape.X_LS;
}

}  // namespace

Vec3 mirrored_point(const Vec3& p, int32_t axis) {
  Vec3 out = p;
  out[axis] = -out[axis];
  return out;
}

Vec3 mirrored_axis(const Vec3& a, int32_t axis) {
  return -mirrored_point(a, axis);
}

Quat mirrored_turn(const Quat& q, int32_t axis) {
  const Vec3 v = mirrored_axis({q.x, q.y, q.z}, axis);
  return {q.w, v.x, v.y, v.z};
}

Inertia mirrored_inertia(const Inertia& inertia, int32_t axis) {
  Inertia out = inertia;
  out.com = mirrored_point(inertia.com, axis);
  // Products of inertia with the mirrored axis change sign: xy, xz, yz are rows 3, 4, 5.
  constexpr int kProducts[3][2] = {{3, 4}, {3, 5}, {4, 5}};
  for (const int k : kProducts[axis]) out.moment[k] = -inertia.moment[k];
  return out;
}

double RobotCurve::at(double a) const {
  int32_t k = 1;
  while (k < knots - 1 && a > command[k]) ++k;
  const double share = std::clamp((a - command[k - 1]) / (command[k] - command[k - 1]), 0.0, 1.0);
  return angle[k - 1] + share * (angle[k] - angle[k - 1]);
}

double RobotCurve::inverse(double q) const {
  double best = command[0], off = std::fabs(angle[0] - q);
  for (int32_t k = 1; k < knots; ++k) {
    const double rise = angle[k] - angle[k - 1];
    const double share = rise != 0 ? std::clamp((q - angle[k - 1]) / rise, 0.0, 1.0) : 0;
    const double a = command[k - 1] + share * (command[k] - command[k - 1]);
    const double d = std::fabs(at(a) - q);
    if (d < off) best = a, off = d;
  }
  return best;
}

bool Robot::coupled(int32_t link) const {
  for (const RobotCoupling& c : couplings)
    if (c.link == link) return true;
  return false;
}

const RobotCurve* Robot::curve(int32_t link) const {
  for (const RobotCurve& c : curves)
    if (c.link == link) return &c;
  return nullptr;
}

bool Robot::follows(int32_t link) const {
  const RobotCurve* c = curve(link);
  return coupled(link) || (c && c->driver != link);
}

int32_t Robot::num_actuated() const {
  if (passive) return 0;
  if (commands.count > 0) return commands.count;
  int32_t n = 0;
  for (int32_t row = 0; row < links.count; ++row) n += !follows(row);
  return n;
}

int32_t Robot::actuated(int32_t i) const {
  if (i >= 0 && i < commands.count) return commands[i];
  if (commands.count == 0 && !passive)
    for (int32_t row = 0; row < links.count; ++row)
      if (!follows(row) && i-- == 0) return row;
  fail(Code::kArgument, "%s: there is no such actuated joint", name);
}

int32_t Robot::action_of(int32_t link) const {
  if (link < 0 || link >= links.count || follows(link) || passive) return -1;
  if (commands.count > 0) {
    const int32_t* at = std::find(commands.begin(), commands.end(), link);
    return at == commands.end() ? -1 : static_cast<int32_t>(at - commands.begin());
  }
  int32_t entry = 0;
  for (int32_t row = 0; row < link; ++row) entry += !follows(row);
  return entry;
}

int32_t Robot::leading_action(int32_t link) const {
  for (const RobotCoupling& c : couplings)
    if (c.link == link) return action_of(c.other);
  const RobotCurve* c = curve(link);
  return action_of(c ? c->driver : link);
}

ArticulationDef make_articulation(const Robot& robot, Side side, const Pose& X_WB, const char* prefix) {
  if (side == Side::kLeft && robot.mirror < 0)
    fail(Code::kUnsupported, "%s: this robot has no left side", robot.name);
  ArticulationDef def;
  def.name = joined(prefix, robot.name);
  def.X_WB = X_WB;
  def.base = robot.root;
  for (const RobotLink& row : robot.links) def.links.push_back(make_link(robot, row, prefix));
  for (const RobotShape& row : robot.shapes) {
    ArticulationShape s;
    s.link = row.link;
    s.shape.name = joined(prefix, row.name);
    s.shape.kind = row.kind;
    s.shape.size = row.size;
    s.shape.X_LS = {row.p, row.q};
    std::memcpy(s.shape.color, row.color, sizeof row.color);
    def.shapes.push_back(s);
  }
  for (const RobotPair& pair : robot.self_pairs) def.self_pairs.push_back({pair.a, pair.b});
  if (side == Side::kLeft) mirror(&def, robot.mirror);
  hang(&def, robot.X_BR);
  return def;
}

}  // namespace rdm
