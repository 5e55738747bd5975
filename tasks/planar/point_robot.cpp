#include "tasks/planar/point_robot.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr double kMass = 0.00518879;    // kg
constexpr double kAhead = 0.0192723;    // m, of the centre of mass
constexpr double kMoment = 2.84218e-5;  // kg m2, about the origin
constexpr double kGain = 0.3, kRange = 0.05;
constexpr double kDamping = 0.01, kTurnDamping = 0.005;  // N s/m, N m s
constexpr double kGravity = 9.81, kField = -0.5;
constexpr double kHeight = 0.1;  // m, in pictures

float to_float(double v) {
  return static_cast<float>(v);
}

}  // namespace

void check_point_robot(const PointRobot& r) {
  const double place[] = {r.x, r.y, r.yaw}, rates[] = {r.vx, r.vy, r.w}, accelerations[] = {r.ax, r.ay};
  check_numbers("robot", place, std::size(place));
  // thrust and damping leave 1.5 m/s and 3 rad/s; the square of a rate drives the body
  check_numbers("robot's rates", rates, std::size(rates), 1e3);
  check_numbers("robot's accelerations", accelerations, std::size(accelerations), 1e6);
}

void point_substep(const float* action, PointRobot* robot) {
  PointRobot r = *robot;
  const elementary::SinCos h = elementary::sincos(r.yaw);
  const double thrust = kGain * std::clamp(static_cast<double>(action[0]), -kRange, kRange);
  const double servo = kGain * std::clamp(static_cast<double>(action[1]) - kGain * r.w, -kRange, kRange);
  const double swing = kMass * kAhead * r.w * r.w;
  const double fx = (thrust + swing) * h.cos - kDamping * r.vx;
  const double fy = (thrust + swing) * h.sin - kDamping * r.vy;
  const double torque = servo - kTurnDamping * r.w;
  // (M + dt D) acc = f with the two linear rows eliminated; joint damping is implicit
  constexpr double kMassDamped = kMass + kPointStep * kDamping, kArm = kMass * kAhead;
  constexpr double kMomentDamped = kMoment + kPointStep * kTurnDamping - kArm * kArm / kMassDamped;
  const double spin = (torque - kArm * (h.cos * fy - h.sin * fx) / kMassDamped) / kMomentDamped;
  r.ax = (fx + kArm * h.sin * spin) / kMassDamped;
  r.ay = (fy - kArm * h.cos * spin) / kMassDamped;
  r.vx += kPointStep * r.ax;
  r.vy += kPointStep * r.ay;
  r.w += kPointStep * spin;
  r.x += kPointStep * r.vx;
  r.y += kPointStep * r.vy;
  r.yaw += kPointStep * r.w;
  *robot = r;
}

PointGap point_gap(const PointRobot& robot, const elementary::SinCos& h, double x, double y, double radius) {
  const double dx = x - robot.x, dy = y - robot.y;
  const double far = std::sqrt(dx * dx + dy * dy);
  PointGap disc{far - kPointRadius - radius, far > 0 ? dx / far : 1, far > 0 ? dy / far : 0};
  // the nose: a square whose nearest point to the centre is found in the robot's frame
  const double along = h.cos * dx + h.sin * dy, across = h.cos * dy - h.sin * dx;
  const double ex = along - std::clamp(along, kPointNose - kPointNoseHalf, kPointNose + kPointNoseHalf);
  const double ey = across - std::clamp(across, -kPointNoseHalf, kPointNoseHalf);
  const double near = std::sqrt(ex * ex + ey * ey);
  if (near == 0) return {-radius, h.cos, h.sin};
  const PointGap nose{near - radius, (h.cos * ex - h.sin * ey) / near, (h.sin * ex + h.cos * ey) / near};
  return nose.gap < disc.gap ? nose : disc;
}

bool point_block(double x, double y, double radius, PointRobot* robot) {
  const PointGap g = point_gap(*robot, elementary::sincos(robot->yaw), x, y, radius);
  if (g.gap >= 0) return false;
  robot->x += g.gap * g.nx;
  robot->y += g.gap * g.ny;
  const double into = std::max(0.0, robot->vx * g.nx + robot->vy * g.ny);
  robot->vx -= into * g.nx;
  robot->vy -= into * g.ny;
  return true;
}

void add_point_body(PlanarScene& scene) {
  scene.body("robot", ShapeKind::kSphere, {kPointRadius, 0, 0}, kMarkRed)
      .shape("nose", ShapeKind::kBox, {kPointNoseHalf, kPointNoseHalf, kPointNoseHalf}, kMarkRed,
             {{kPointNose, 0, 0}, {}});
}

Motion point_motion(const PointRobot& r) {
  return planar_motion({r.x, r.y, kHeight}, r.yaw, r.vx, r.vy, r.w);
}

void write_accelerometer(const PointRobot& r, const elementary::SinCos& h, float* out) {
  out[0] = to_float(h.cos * r.ax + h.sin * r.ay);
  out[1] = to_float(h.cos * r.ay - h.sin * r.ax);
  out[2] = to_float(kGravity);
}
void write_velocimeter(const PointRobot& r, const elementary::SinCos& h, float* out) {
  out[0] = to_float(h.cos * r.vx + h.sin * r.vy);
  out[1] = to_float(h.cos * r.vy - h.sin * r.vx);
  out[2] = 0;
}
void write_gyro(const PointRobot& r, float* out) {
  out[0] = out[1] = 0;
  out[2] = to_float(r.w);
}
void write_magnetometer(const elementary::SinCos& h, float* out) {
  out[0] = to_float(kField * h.sin);
  out[1] = to_float(kField * h.cos);
  out[2] = 0;
}

}  // namespace rdm
