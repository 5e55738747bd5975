#include "robot/kinematics.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "base/eigen.hpp"
#include "base/elementary.hpp"
#include "base/error.hpp"
#include "physics/collision/convex.hpp"

namespace rdm {
namespace {

using Vector6 = Eigen::Matrix<double, 6, 1>;
using Matrix6 = Eigen::Matrix<double, 6, 6>;
using Jacobian =
    Eigen::Matrix<double, 6, kMaxRobotLinks>;  // columns of joints that do not move the flange are 0

constexpr int kIterations = 80;
constexpr double kClose = 1e-6;    // m, rad
constexpr double kSteepest = 0.5;  // rad, m of one iteration

Pose joint_motion(const RobotLink& l, double q) {
  return l.kind == JointKind::kPrismatic ? Pose{q * l.axis, {}} : Pose{{}, axis_angle(l.axis, q)};
}

// As a vector along the axis of the turn that remains, 2 sin of half its angle long.
Vec3 turn_between(const Quat& to, const Quat& from) {
  const Quat d = to * conjugate(from);
  const double sign = d.w < 0 ? -2 : 2;
  return {sign * d.x, sign * d.y, sign * d.z};
}

// How a joint at X_RL moves a point at p, and turns it: m, then rad, of a rad (m).
Vector6 twist_of(const RobotLink& l, const Pose& X_RL, const Vec3& p) {
  const Vec3 axis = rotate(X_RL.q, l.axis);
  const bool slides = l.kind == JointKind::kPrismatic;
  const Vec3 linear = slides ? axis : cross(axis, p - X_RL.p);
  const Vec3 angular = slides ? Vec3{} : axis;
  Vector6 out;
  out << linear.x, linear.y, linear.z, angular.x, angular.y, angular.z;
  return out;
}

struct Reach {
  const Robot& robot;
  Pose X_RL[kMaxRobotLinks];
  Pose X_RF;
  Jacobian J;

  void update(const double* q) {
    link_poses(robot, q, X_RL);
    X_RF = robot.flange == kRootLink ? robot.X_LF : X_RL[robot.flange] * robot.X_LF;
    J.leftCols(robot.links.count).setZero();
    for (int32_t i = robot.flange; i >= 0; i = robot.links[i].parent)
      J.col(i) = twist_of(robot.links[i], X_RL[i], X_RF.p);
  }
  Matrix6 square() const {
    Matrix6 a = Matrix6::Zero();
    for (int32_t i = 0; i < robot.links.count; ++i) a += J.col(i) * J.col(i).transpose();
    return a;
  }
};

// How well a pose can go on from where it is: the least room to a joint's limit, in its range, times the
// manipulability (Yoshikawa 1985) with lengths in units of `length`.
double dexterity(Reach* reach, const double* q, double length) {
  reach->update(q);
  double room = 0.15;  // more is no better
  const Robot& robot = reach->robot;
  for (int32_t i = 0; i < robot.links.count; ++i) {
    const RobotLink& l = robot.links[i];
    room = std::min({room, (q[i] - l.lower) / (l.upper - l.lower), (l.upper - q[i]) / (l.upper - l.lower)});
  }
  reach->J.topRows(3) /= length;
  const double square = reach->square().determinant();
  return room * std::sqrt(std::max(square, 0.0));
}

// q of the joints of `by` after one damped step for e, again without a joint that it takes beyond its bounds.
void damped_step(const Jacobian& J, const PalmJoints& by, Vector6 e, double* q) {
  double step[kMaxRobotLinks] = {};
  bool stuck[kMaxRobotLinks] = {};
  for (bool again = true; again;) {  // ends: each round one more is stuck
    again = false;
    Matrix6 a = Matrix6::Zero();
    for (int32_t k = 0; k < by.count; ++k)
      if (!stuck[k]) a += J.col(k) * J.col(k).transpose();
    a.diagonal().array() += kPalmDamping * kPalmDamping;
    const Vector6 y = a.llt().solve(e);
    for (int32_t k = 0; k < by.count && !again; ++k) {
      if (stuck[k]) continue;
      step[k] = J.col(k).dot(y);
      const double from = q[by.joints[k]], to = from + step[k];
      if (to >= by.low[k] && to <= by.high[k]) continue;
      step[k] = std::clamp(to, by.low[k], by.high[k]) - from;
      e -= step[k] * J.col(k);  // the others do the rest
      stuck[k] = again = true;
    }
  }
  for (int32_t k = 0; k < by.count; ++k) q[by.joints[k]] += step[k];
}

// A turn by |w| rad about w.
Quat rotation_of(const Vec3& w) {
  const double angle = norm(w);
  return angle > 0 ? axis_angle((1 / angle) * w, angle) : Quat{};
}

}  // namespace

Pose link_frame(const RobotLink& link) {
  return {link.p_PL, from_rpy(link.rpy_PL) * link.q_PL};
}

double start_angle(const Robot& robot, const Table<double>& q, int32_t link) {
  return q.count ? q[link] : std::clamp(0.0, robot.links[link].lower, robot.links[link].upper);
}

void link_poses(const Robot& robot, const double* q, Pose* X_RL) {
  for (int32_t i = 0; i < robot.links.count; ++i) {
    const RobotLink& l = robot.links[i];
    const Pose X_PL = link_frame(l) * joint_motion(l, q[i]);
    X_RL[i] = l.parent < 0 ? X_PL : X_RL[l.parent] * X_PL;
  }
}

Pose link_pose(const Robot& robot, const double* q, int32_t link) {
  Pose X_RL[kMaxRobotLinks];
  link_poses(robot, q, X_RL);
  return link < 0 ? Pose{} : X_RL[link];
}

Pose flange_pose(const Robot& robot, const double* q) {
  return link_pose(robot, q, robot.flange) * robot.X_LF;
}

Pose palm_frame(const Robot& robot, const double* q) {
  const Vec3 z = robot.z_palm, y = -robot.n_palm, x = cross(y, z);
  const Mat3 R = {{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}};
  return link_pose(robot, q, robot.palm) * Pose{robot.p_hold, to_quat(R)};
}

bool solve_reach(const Robot& robot, const Pose& X_RF, double* q) {
  Reach reach{robot, {}, {}, {}};
  for (int k = 0; k <= kIterations; ++k) {
    reach.update(q);
    const Vec3 dp = X_RF.p - reach.X_RF.p, dw = turn_between(X_RF.q, reach.X_RF.q);
    Vector6 e;
    e << dp.x, dp.y, dp.z, dw.x, dw.y, dw.z;
    const double square = e.squaredNorm();
    if (square < kClose * kClose) return true;
    if (k == kIterations) break;
    Matrix6 a = reach.square();
    a.diagonal().array() += 0.5 * square + 1e-9;
    const Vector6 y = a.llt().solve(e);
    double most = 0, step[kMaxRobotLinks];
    for (int32_t i = 0; i < robot.links.count; ++i) {
      step[i] = reach.J.col(i).dot(y);
      most = std::max(most, std::fabs(step[i]));
    }
    const double share = most > kSteepest ? kSteepest / most : 1;
    for (int32_t i = 0; i < robot.links.count; ++i)
      q[i] = std::clamp(q[i] + share * step[i], robot.links[i].lower, robot.links[i].upper);
  }
  return false;
}

void move_palm(const Robot& robot, const PalmJoints& by, const Vec3& dp, const Vec3& dw, double* q) {
  constexpr int kSteps = 4;
  double begin[kMaxRobotLinks];
  for (int32_t k = 0; k < by.count; ++k) begin[k] = q[by.joints[k]];
  Pose goal;
  for (int n = 0; n < kSteps; ++n) {
    Pose X_RL[kMaxRobotLinks];
    link_poses(robot, q, X_RL);
    const Pose X_RP = (robot.palm < 0 ? Pose{} : X_RL[robot.palm]) * Pose{robot.p_hold, {}};
    if (n == 0) goal = {X_RP.p + dp, rotation_of(dw) * X_RP.q};
    const Vec3 p = goal.p - X_RP.p, w = turn_between(goal.q, X_RP.q);
    Vector6 e;
    e << p.x, p.y, p.z, w.x, w.y, w.z;
    if (e.squaredNorm() < kClose * kClose) break;
    Jacobian J;
    J.leftCols(by.count).setZero();
    for (int32_t i = robot.palm; i >= 0; i = robot.links[i].parent)
      for (int32_t k = 0; k < by.count; ++k)
        if (by.joints[k] == i) J.col(k) = twist_of(robot.links[i], X_RL[i], X_RP.p);
    damped_step(J, by, e, q);
  }
  double share = 1;
  for (int32_t k = 0; k < by.count; ++k)
    if (const double way = std::fabs(q[by.joints[k]] - begin[k]); way > by.most[k])
      share = std::min(share, by.most[k] / way);
  for (int32_t k = 0; k < by.count; ++k) {
    double& x = q[by.joints[k]];
    x = begin[k] + share * (x - begin[k]);
  }
}

double arm_length(const Robot& robot) {
  double length = norm(robot.X_LF.p);
  for (int32_t i = robot.flange; i >= 0 && robot.links[i].parent >= 0; i = robot.links[i].parent)
    length += norm(robot.links[i].p_PL);
  return length;
}

namespace {

// One look at places for an arm's base around the flange, in polar coordinates, in units of the arm's length.
struct Places {
  int32_t starts;  // from how many poses the arm is sent there
  int32_t num_turns, num_away, num_below;
  double away[6], below[8];
};
constexpr double kLowest = 0.03;  // m, of a link's frame
constexpr double kGap = 0.002;    // m, of what turns and the ground

// Home, and the same with one or two joints at other parts of their ranges: elbow and wrist the other way.
struct Start {
  int32_t joints[2];
  double shares[2];
};
constexpr Start kStarts[] = {
    {{-1, -1}, {}}, {{1, 2}, {0.7, 0.3}}, {{1, 2}, {0.3, 0.7}}, {{4, -1}, {0.25}}, {{4, -1}, {0.75}}};
void start_pose(const Robot& arm, int32_t start, double* q) {
  for (int32_t i = 0; i < arm.links.count; ++i) q[i] = start_angle(arm, arm.home, i);
  for (int k = 0; k < 2; ++k) {
    const int32_t i = kStarts[start].joints[k];
    if (i < 0 || i >= arm.links.count) continue;
    const RobotLink& l = arm.links[i];
    q[i] = l.lower + kStarts[start].shares[k] * (l.upper - l.lower);
  }
}

constexpr double kTurns[] = {0, 0.25 * kPi, -0.25 * kPi, 0.5 * kPi, -0.5 * kPi, 0.75 * kPi, -0.75 * kPi, kPi};
constexpr Places kNear = {1, 5, 4, 5, {0.45, 0.35, 0.55, 0.65}, {0.2, 0.35, 0.05, 0.5, -0.1}};
// A large arm may have to stand far off, or on a pedestal and reach down.
constexpr Places kWide = {
    static_cast<int32_t>(std::size(kStarts)),    8, 6, 8, {0.3, 0.4, 0.5, 0.6, 0.7, 0.8},
    {0.5, 0.3, 0.1, 0, -0.1, -0.25, -0.4, -0.55}};

// How high the base is at least: the first link, which turns about the vertical, does not scrape the ground.
double standing_height(const Robot& arm) {
  if (arm.links.count == 0 || std::fabs(rotate(link_frame(arm.links[0]).q, arm.links[0].axis).z) < 0.999)
    return 0;
  const Pose X_BL = arm.X_BR * link_frame(arm.links[0]);
  double lowest = kGap;
  for (const RobotShape& s : arm.shapes) {
    if (s.link != 0 || s.kind == ShapeKind::kPlane || s.kind == ShapeKind::kHull) continue;
    const Pose X_BS = X_BL * Pose{s.p, s.q};
    const Convex solid{s.kind, s.size, X_BS.p, to_matrix(X_BS.q), nullptr};
    lowest = std::min(lowest, farthest(solid, {0, 0, -1}).z);
  }
  return kGap - lowest;
}

void best_first(Vector<ArmPlace>* places) {
  std::stable_sort(places->begin(), places->end(),
                   [](const ArmPlace& a, const ArmPlace& b) { return a.score > b.score; });
}

bool above_ground(const Robot& arm, const Reach& reach, const Pose& X_WB) {
  return std::all_of(reach.X_RL, reach.X_RL + arm.links.count,
                     [&](const Pose& X) { return (X_WB * X).p.z > kLowest; });
}

}  // namespace

Vector<ArmPlace> arm_places(const Robot& arm, const Pose& X_WF, const Vec3& from, bool wide) {
  const Places& places = wide ? kWide : kNear;
  const double length = arm_length(arm), height = standing_height(arm);
  const double side = elementary::atan2(from.y, from.x);
  Reach reach{arm, {}, {}, {}};
  Vector<ArmPlace> out;
  const auto look = [&](double turn, double away, double below, int32_t start) {
    const elementary::SinCos a = elementary::sincos(side + turn);
    ArmPlace place{};
    place.X_WB.p = X_WF.p + Vec3{away * length * a.cos, away * length * a.sin, -below * length};
    place.X_WB.p.z = std::max(place.X_WB.p.z, height);
    place.X_WB.q = axis_angle({0, 0, 1}, side + turn + kPi);  // x of the base towards the flange
    start_pose(arm, start, place.q);
    if (!solve_reach(arm, inverse(place.X_WB) * X_WF, place.q)) return;
    place.score = dexterity(&reach, place.q, length) * (1.2 + elementary::sincos(turn).cos);
    if (place.score > 0 && above_ground(arm, reach, place.X_WB)) out.push_back(place);
  };
  for (int32_t turn = 0; turn < places.num_turns; ++turn)
    for (int32_t i = 0; i < places.num_away; ++i)
      for (int32_t k = 0; k < places.num_below; ++k)
        for (int32_t start = 0; start < places.starts; ++start)
          look(kTurns[turn], places.away[i], places.below[k], start);
  best_first(&out);
  return out;
}

Vector<ArmPlace> arm_poses(const Robot& arm, const Pose& X_WF, const Pose& X_WB) {
  const Pose X_RF = inverse(X_WB) * X_WF;
  const double length = arm_length(arm);
  Reach reach{arm, {}, {}, {}};
  Vector<ArmPlace> out;
  const auto look = [&](int32_t turned, double share) {
    ArmPlace place{};
    place.X_WB = X_WB;
    start_pose(arm, 0, place.q);
    if (turned >= 0) {
      const RobotLink& l = arm.links[turned];
      place.q[turned] = l.lower + share * (l.upper - l.lower);
    }
    if (!solve_reach(arm, X_RF, place.q)) return;
    place.score = dexterity(&reach, place.q, length);
    out.push_back(place);
  };
  look(-1, 0);
  for (int32_t i = 0; i < arm.links.count; ++i)
    for (const double share : {0.25, 0.75}) look(i, share);
  best_first(&out);
  return out;
}

bool place_arm(const Robot& arm, const Pose& X_WF, const Vec3& from, Pose* X_WB, double* q) {
  for (const bool wide : {false, true}) {
    const Vector<ArmPlace> places = arm_places(arm, X_WF, from, wide);
    if (places.empty()) continue;
    *X_WB = places[0].X_WB;
    std::copy_n(places[0].q, arm.links.count, q);
    return true;
  }
  return false;
}

}  // namespace rdm
