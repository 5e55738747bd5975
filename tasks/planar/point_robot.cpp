#include "tasks/planar/point_robot.hpp"

#include <cmath>

namespace rdm {
namespace {

constexpr double kMass = 0.00518879;    // kg
constexpr double kAhead = 0.0192723;    // m, of the centre of mass
constexpr double kMoment = 2.84218e-5;  // kg m2, about the origin
constexpr double kGain = 0.3, kRange = 0.05;
constexpr double kDamping = 0.01, kTurnDamping = 0.005;  // N s/m, N m s

}  // namespace

void PointRobot::substep(const float* action, PointRobot* robot) {
  PointRobot r = *robot;
  const elementary::SinCos h = elementary::sincos(r.yaw);
  const double thrust = kGain * std::clamp(static_cast<double>(action[0]), -kRange, kRange);
  const double servo = kGain * std::clamp(static_cast<double>(action[1]) - kGain * r.w, -kRange, kRange);
  const double swing = kMass * kAhead * r.w * r.w;
  const double fx = (thrust + swing) * h.cos - kDamping * r.vx;
  const double fy = (thrust + swing) * h.sin - kDamping * r.vy;
  const double torque = servo - kTurnDamping * r.w;
  // (M + dt D) acc = f with the two linear rows eliminated; joint damping is implicit
  constexpr double kMassDamped = kMass + kStep * kDamping, kArm = kMass * kAhead;
  constexpr double kMomentDamped = kMoment + kStep * kTurnDamping - kArm * kArm / kMassDamped;
  const double spin = (torque - kArm * (h.cos * fy - h.sin * fx) / kMassDamped) / kMomentDamped;
  r.ax = (fx + kArm * h.sin * spin) / kMassDamped;
  r.ay = (fy - kArm * h.cos * spin) / kMassDamped;
  r.vx += kStep * r.ax;
  r.vy += kStep * r.ay;
  r.w += kStep * spin;
  r.x += kStep * r.vx;
  r.y += kStep * r.vy;
  r.yaw += kStep * r.w;
  *robot = r;
}

RobotGap PointRobot::gap(const PointRobot& robot, const elementary::SinCos& h, double x, double y,
                         double radius) {
  const double dx = x - robot.x, dy = y - robot.y;
  const double far = std::sqrt(dx * dx + dy * dy);
  const RobotGap disc{far - kRadius - radius, far > 0 ? dx / far : 1, far > 0 ? dy / far : 0};
  constexpr RobotPart kPart{kNose - kNoseHalf, kNose + kNoseHalf, -kNoseHalf, kNoseHalf, 1, 0};
  const RobotGap nose = part_gap(kPart, robot, h, x, y, radius);
  return nose.gap < disc.gap ? nose : disc;
}

void PointRobot::add(PlanarScene& scene) {
  scene.body("robot", ShapeKind::kSphere, {kRadius, 0, 0}, kMarkRed)
      .shape("nose", ShapeKind::kBox, {kNoseHalf, kNoseHalf, kNoseHalf}, kMarkRed, {{kNose, 0, 0}, {}});
}

}  // namespace rdm
