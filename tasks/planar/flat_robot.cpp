#include "tasks/planar/flat_robot.hpp"

#include <cmath>
#include <iterator>

#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr double kGravity = 9.81, kField = -0.5;

float to_float(double v) {
  return static_cast<float>(v);
}

}  // namespace

void check_flat_robot(const FlatRobot& r) {
  const double place[] = {r.x, r.y, r.yaw}, rates[] = {r.vx, r.vy, r.w}, accelerations[] = {r.ax, r.ay};
  check_numbers("robot", place, std::size(place));
  // drives and damping leave a few m/s and rad/s; the square of a rate drives the body
  check_numbers("robot's rates", rates, std::size(rates), 1e3);
  check_numbers("robot's accelerations", accelerations, std::size(accelerations), 1e6);
}

RobotGap part_gap(const RobotPart& part, const FlatRobot& robot, const elementary::SinCos& h, double x,
                  double y, double radius) {
  const double dx = x - robot.x, dy = y - robot.y;
  const double along = h.cos * dx + h.sin * dy, across = h.cos * dy - h.sin * dx;
  const double ex = along - std::clamp(along, part.x0, part.x1),
               ey = across - std::clamp(across, part.y0, part.y1);
  const double near = std::sqrt(ex * ex + ey * ey);
  if (near == 0)
    return {-radius, h.cos * part.out_x - h.sin * part.out_y, h.sin * part.out_x + h.cos * part.out_y};
  return {near - radius, (h.cos * ex - h.sin * ey) / near, (h.sin * ex + h.cos * ey) / near};
}

void write_accelerometer(const FlatRobot& r, const elementary::SinCos& h, float* out) {
  out[0] = to_float(h.cos * r.ax + h.sin * r.ay);
  out[1] = to_float(h.cos * r.ay - h.sin * r.ax);
  out[2] = to_float(kGravity);
}
void write_velocimeter(const FlatRobot& r, const elementary::SinCos& h, float* out) {
  out[0] = to_float(h.cos * r.vx + h.sin * r.vy);
  out[1] = to_float(h.cos * r.vy - h.sin * r.vx);
  out[2] = 0;
}
void write_gyro(const FlatRobot& r, float* out) {
  out[0] = out[1] = 0;
  out[2] = to_float(r.w);
}
void write_magnetometer(const elementary::SinCos& h, float* out) {
  out[0] = to_float(kField * h.sin);
  out[1] = to_float(kField * h.cos);
  out[2] = 0;
}

}  // namespace rdm
