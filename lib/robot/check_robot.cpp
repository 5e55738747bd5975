// What a robot's tables must hold before an articulation is made of them. The text of an error names the
// robot, the row and the number.
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>

#include "base/error.hpp"
#include "base/format.hpp"
#include "base/option.hpp"
#include "base/text.hpp"
#include "physics/model/inertia.hpp"
#include "robot/robot.hpp"

namespace rdm {
namespace {

constexpr double kUnit = 1e-6;          // of the length of a unit vector
constexpr double kTriangle = 1 + 1e-6;  // of the triangle rule, for rounded tables
constexpr double kMost = 1e6;

// Every check of one robot: the owner's name in front of each text.
struct Check {
  const Robot& robot;

  [[gnu::format(printf, 3, 4)]] [[noreturn]] void bad(Code code, const char* format, ...) const {
    char text[kErrorTextSize];
    va_list list;
    va_start(list, format);
    print_list(text, sizeof text, format, list);
    va_end(list);
    fail(code, "robot %s: %s", Quoted(robot.name ? robot.name : "").text, text);
  }
  void within(double value, double low, double high, const char* row, const char* what) const {
    if (!std::isfinite(value)) bad(Code::kArgument, "%s: %s is not finite", Quoted(row).text, what);
    if (value < low || value > high)
      bad(Code::kRange, "%s: %s %s is outside [%s, %s]", Quoted(row).text, what, Number(value).text,
          Number(low).text, Number(high).text);
  }
  void within(const Vec3& v, const char* row, const char* what) const {
    for (int i = 0; i < 3; ++i) within(v[i], -kMost, kMost, row, what);
  }
  void unit(const Vec3& v, const char* row, const char* what) const {
    within(v, row, what);
    if (std::fabs(norm(v) - 1) > kUnit)
      bad(Code::kArgument, "%s: %s has length %g, not 1", Quoted(row).text, what, norm(v));
  }
  void unit(const Quat& q, const char* row) const {
    for (const double x : {q.w, q.x, q.y, q.z}) within(x, -kMost, kMost, row, "quaternion");
    const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    if (std::fabs(length - 1) > 1e-4)
      bad(Code::kArgument, "%s: the quaternion has length %g, not 1", Quoted(row).text, length);
  }
  void pose(const Pose& X, const char* row) const {
    within(X.p, row, "position");
    unit(X.q, row);
  }
  void index(int32_t i, int32_t low, int32_t count, const char* row, const char* what) const {
    if (i < low || i >= count)
      bad(Code::kRange, "%s: %s %d is outside [%d, %d)", Quoted(row).text, what, i, low, count);
  }
  // Room for the prefix of a side.
  void name(const char* text, const char* what) const {
    constexpr size_t kLongest = kNameSize - 1 - 6;
    if (!text || !*text) bad(Code::kArgument, "%s: the name is empty", what);
    if (std::strlen(text) > kLongest)
      bad(Code::kRange, "%s %s: the name is longer than %zu characters", what, Quoted(text).text, kLongest);
    for (const char* c = text; *c; ++c)
      if (!std::isalnum(static_cast<unsigned char>(*c)) && !std::strchr("_-+", *c))
        bad(Code::kArgument, "%s %s: a name is made of letters, digits, '_', '-' and '+'", what,
            Quoted(text).text);
  }

  void inertia(const char* row, double mass, const Vec3& com, const double* moment, bool may_be_none) const {
    within(com, row, "centre of mass");
    within(mass, 0, kMost, row, "mass");
    for (int i = 0; i < 6; ++i) within(moment[i], -kMost, kMost, row, "moment of inertia");
    if (mass == 0) {
      for (int i = 0; i < 6; ++i)
        if (moment[i] != 0)
          bad(Code::kArgument, "%s: it has moments of inertia, but no mass", Quoted(row).text);
      if (!may_be_none) bad(Code::kRange, "%s: the mass must be above 0", Quoted(row).text);
      return;
    }
    Inertia body;
    body.mass = mass;
    std::copy_n(moment, 6, body.moment);
    const Mat3 m = moment_matrix(body);
    if (!positive_definite(m))
      bad(Code::kArgument, "%s: the moment of inertia is not positive definite", Quoted(row).text);
    const Vec3 p = principal_moments(m);
    if (p.x + p.y < p.z / kTriangle || p.y + p.z < p.x / kTriangle || p.z + p.x < p.y / kTriangle)
      bad(Code::kArgument, "%s: principal moments %g, %g, %g violate the triangle inequality",
          Quoted(row).text, p.x, p.y, p.z);
  }

  void links() const {
    if (robot.links.count < 1 || robot.links.count > kMaxRobotLinks)
      bad(Code::kRange, "the number of links, %d, is outside [1, %d]", robot.links.count, kMaxRobotLinks);
    for (int32_t i = 0; i < robot.links.count; ++i) {
      const RobotLink& l = robot.links[i];
      name(l.name, "link");
      name(l.joint, "joint");
      for (int32_t k = 0; k < i; ++k) {
        if (same_name(robot.links[k].name, l.name))
          bad(Code::kArgument, "link %s occurs twice", Quoted(l.name).text);
        if (same_name(robot.links[k].joint, l.joint))
          bad(Code::kArgument, "joint %s occurs twice", Quoted(l.joint).text);
      }
      if (l.parent < -1 || l.parent >= i)
        bad(Code::kRange, "%s: parent %d does not come before row %d", Quoted(l.name).text, l.parent, i);
      within(l.p_PL, l.name, "position");
      within(l.rpy_PL, l.name, "rotation");
      unit(l.q_PL, l.name);
      inertia(l.name, l.mass, l.com, l.moment, true);
      if (l.kind != JointKind::kRevolute && l.kind != JointKind::kPrismatic)
        bad(Code::kRange, "%s: the kind of the joint is unknown", Quoted(l.joint).text);
      unit(l.axis, l.joint, "axis");
      within(l.lower, -kMost, kMost, l.joint, "lower limit");
      within(l.upper, -kMost, kMost, l.joint, "upper limit");
      if (!(l.lower < l.upper))
        bad(Code::kRange, "%s: the range [%g, %g] is empty", Quoted(l.joint).text, l.lower, l.upper);
      within(l.kp, 0, kMost, l.joint, "kp");
      within(l.kd, 0, kMost, l.joint, "kd");
      within(l.effort, 0, kMost, l.joint, "effort");
      within(l.armature, 0, kMost, l.joint, "armature");
      within(l.friction, 0, kMost, l.joint, "friction");
      within(l.velocity, 0, kMost, l.joint, "velocity");
    }
    inertia("root", robot.root.mass, robot.root.com, robot.root.moment, true);
    pose(robot.X_BR, "root");
  }

  void shapes() const {
    for (int32_t i = 0; i < robot.shapes.count; ++i) {
      const RobotShape& s = robot.shapes[i];
      name(s.name, "shape");
      for (int32_t k = 0; k < i; ++k)
        if (same_name(robot.shapes[k].name, s.name))
          bad(Code::kArgument, "shape %s occurs twice", Quoted(s.name).text);
      index(s.link, kRootLink, robot.links.count, s.name, "link");
      pose({s.p, s.q}, s.name);
      const int sizes = num_sizes(s.kind);
      if (sizes == 0)
        bad(Code::kUnsupported, "%s: a robot's shapes are spheres, capsules, boxes, cylinders and ellipsoids",
            Quoted(s.name).text);
      for (int k = 0; k < sizes; ++k) within(s.size[k], 1e-6, 1e3, s.name, "size");
    }
    for (const RobotPair& p : robot.self_pairs) {
      index(p.a, 0, robot.shapes.count, "pair", "shape");
      index(p.b, 0, robot.shapes.count, "pair", "shape");
      if (robot.shapes[p.a].link == robot.shapes[p.b].link)
        bad(Code::kArgument, "pair: %s and %s are on one link", Quoted(robot.shapes[p.a].name).text,
            Quoted(robot.shapes[p.b].name).text);
    }
  }

  void drives() const {
    const int32_t n = robot.links.count;
    for (int32_t i = 0; i < robot.couplings.count; ++i) {
      const RobotCoupling& c = robot.couplings[i];
      index(c.link, 0, n, "coupling", "link");
      const char* row = robot.links[c.link].joint;
      index(c.other, 0, n, row, "coupling: the other link");
      within(c.ratio, -1e3, 1e3, row, "ratio");
      within(c.slack, 0, 1e3, row, "slack");
      if (robot.coupled(c.other) || c.link == c.other)
        bad(Code::kArgument, "%s follows %s, which follows itself", Quoted(row).text,
            Quoted(robot.links[c.other].joint).text);
      for (int32_t k = 0; k < i; ++k)
        if (robot.couplings[k].link == c.link) bad(Code::kArgument, "%s is coupled twice", Quoted(row).text);
    }
    for (int32_t i = 0; i < robot.curves.count; ++i) {
      const RobotCurve& c = robot.curves[i];
      index(c.link, 0, n, "curve", "link");
      const char* row = robot.links[c.link].joint;
      index(c.driver, 0, n, row, "curve: the driver");
      if (c.knots < 2 || c.knots > kMaxKnots)
        bad(Code::kRange, "%s: the number of knots, %d, is outside [2, %d]", Quoted(row).text, c.knots,
            kMaxKnots);
      for (int32_t k = 0; k < c.knots; ++k) {
        within(c.command[k], -1, 1, row, "command of a knot");
        within(c.angle[k], robot.links[c.link].lower, robot.links[c.link].upper, row, "angle of a knot");
        if (k > 0 && !(c.command[k] > c.command[k - 1]))
          bad(Code::kArgument, "%s: the commands of its knots are not ascending", Quoted(row).text);
      }
      if (robot.coupled(c.link))
        bad(Code::kArgument, "%s: it cannot both be coupled and have a curve", Quoted(row).text);
      for (int32_t k = 0; k < i; ++k)
        if (robot.curves[k].link == c.link) bad(Code::kArgument, "%s has two curves", Quoted(row).text);
    }
    if (robot.passive && (robot.commands.count > 0 || robot.curves.count > 0))
      bad(Code::kArgument, "it takes no commands, but has commands or curves");
    if (robot.passive && robot.kind != RobotKind::kOther)
      bad(Code::kArgument, "a hand or an arm must take commands");
    for (int32_t i = 0; i < robot.commands.count; ++i) {
      index(robot.commands[i], 0, n, "commands", "link");
      if (robot.action_of(robot.commands[i]) != i)
        bad(Code::kArgument, "commands: %s occurs twice, or follows another joint",
            Quoted(robot.links[robot.commands[i]].joint).text);
    }
    for (const RobotCurve& c : robot.curves)
      if (robot.action_of(c.driver) < 0)
        bad(Code::kArgument, "%s: its driver %s has no command", Quoted(robot.links[c.link].joint).text,
            Quoted(robot.links[c.driver].joint).text);
    pose_of(robot.home, "home");
    pose_of(robot.poses.folded, "folded");
    if (robot.poses.closed.count != 0 && robot.poses.closed.count != robot.num_actuated())
      bad(Code::kRange, "closed: it has %d commands, but the robot has %d", robot.poses.closed.count,
          robot.num_actuated());
    for (const float a : robot.poses.closed) within(static_cast<double>(a), -1, 1, "closed", "command");
  }

  void pose_of(const Table<double>& q, const char* what) const {
    if (q.count != 0 && q.count != robot.links.count)
      bad(Code::kRange, "%s: it has %d joints, but the robot has %d", what, q.count, robot.links.count);
    for (int32_t i = 0; i < q.count; ++i)
      within(q[i], robot.links[i].lower, robot.links[i].upper, robot.links[i].joint, what);
  }

  void parts() const {
    const int32_t n = robot.links.count;
    if (robot.fingers.count != 0 && robot.fingers.count != robot.tips.count)
      bad(Code::kArgument, "it has %d fingers, but %d tips", robot.fingers.count, robot.tips.count);
    for (const RobotTip& t : robot.tips) {
      index(t.link, 0, n, "tip", "link");
      within(t.p_L, robot.links[t.link].name, "tip");
    }
    for (int32_t i = 0; i < robot.fingers.count; ++i) {
      const RobotFinger& f = robot.fingers[i];
      name(f.name, "finger");
      index(f.first, 0, robot.tips[i].link + 1, f.name, "first link");
      for (int32_t link = robot.tips[i].link; link > f.first; --link)
        if (robot.links[link].parent < f.first)
          bad(Code::kArgument,
              "finger %s: link %s, between its first link and its tip, belongs to another finger",
              Quoted(f.name).text, Quoted(robot.links[link].name).text);
      for (const int32_t role : {f.lateral, f.proximal, f.middle})
        if (role != -1) index(role, f.first, robot.tips[i].link + 1, f.name, "a joint of it");
    }
    if (robot.palm != kNoLink) {
      index(robot.palm, kRootLink, n, "palm", "link");
      within(robot.p_palm, "palm", "position");
      within(robot.p_hold, "palm", "holding point");
      unit(robot.n_palm, "palm", "normal");
      unit(robot.z_palm, "palm", "direction of the fingers");
      if (std::fabs(dot(robot.n_palm, robot.z_palm)) > 1e-3)
        bad(Code::kArgument, "palm: the direction of the fingers is not in the palm's plane");
    } else if (robot.kind == RobotKind::kHand) {
      bad(Code::kArgument, "a hand must have a palm");
    }
    if (robot.kind == RobotKind::kHand && robot.fingers.count == 0)
      bad(Code::kArgument, "a hand must have fingers");
    if (robot.kind == RobotKind::kArm && robot.flange == kNoLink)
      bad(Code::kArgument, "an arm must have a flange");
    if (robot.flange != kNoLink) index(robot.flange, 0, n, "flange", "link");
    pose(robot.X_LF, "flange");
    pose(robot.X_RM, "mount");
    index(robot.mirror, -1, 3, "mirror", "axis");
  }
};

}  // namespace

void check_robot(const Robot& robot) {
  const Check check{robot};
  check.name(robot.name, "robot");
  if (robot.alias) check.name(robot.alias, "robot");
  check.links();
  check.shapes();
  check.drives();
  check.parts();
}

}  // namespace rdm
