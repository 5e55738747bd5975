#include "tasks/bullet/car.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr double kTopSpeed = 6;                    // m/s: 40 rad/s on wheels of 0.15 m
constexpr double kAcceleration = 20 / 0.15 / 5.9;  // m/s2: 20 N m at the wheels, 5.9 kg
constexpr double kRoomMotors = 2;                  // in rooms both are twice that
constexpr double kSteer = 0.5;                     // rad
constexpr double kWheelbase = 0.975;               // m
constexpr Vec3 kChassis{0.6, 0.25, 0.1};           // m, half sizes in pictures
constexpr double kHeight = 0.2;                    // m

}  // namespace

void Car::add(PlanarScene& scene, const AgentDrive&) {
  scene.body("car", ShapeKind::kBox, kChassis, kMarkBlue)
      .shape("nose", ShapeKind::kBox, {0.1, 0.2, 0.12}, kMarkYellow, {{kChassis.x, 0, 0}, {}});
}

void Car::check(const State& s) {
  const double values[] = {s.x, s.y, s.yaw, s.speed, s.rate};
  check_numbers("car", values, std::size(values));
}

void Car::start(const AgentStart& at, Stream&, World&, State* s) {
  *s = {at.x, at.y, at.yaw, 0, 0};
}

void Car::act(const float* action, const AgentDrive& drive, World&, State* state) {
  State& s = *state;
  const double step = kBulletDt / drive.substeps, motors = drive.room ? kRoomMotors : 1;
  const elementary::SinCos steer = elementary::sincos(kSteer * static_cast<double>(action[1]));
  const double curvature = steer.sin / steer.cos / kWheelbase;
  const double wanted = motors * kTopSpeed * static_cast<double>(action[0]);
  const double change = motors * kAcceleration * step;
  for (int i = 0; i < drive.substeps; ++i) {
    s.speed += std::clamp(wanted - s.speed, -change, change);
    s.rate = s.speed * curvature;
    s.yaw += step * s.rate;
    const elementary::SinCos heading = elementary::sincos(s.yaw);
    s.x += step * s.speed * heading.cos;
    s.y += step * s.speed * heading.sin;
  }
}

void Car::show(World& world, const State& s) {
  const elementary::SinCos heading = elementary::sincos(s.yaw);
  world.set_body(
      0, planar_motion({s.x, s.y, kHeight}, s.yaw, s.speed * heading.cos, s.speed * heading.sin, s.rate));
}

AgentPlace Car::look(const World&, const State& s) {
  const elementary::SinCos heading = elementary::sincos(s.yaw);
  return {s.x, s.y, kHeight, s.speed * heading.cos, s.speed * heading.sin, std::fabs(s.speed)};
}

// Wheels do not slide: what is left of the velocity along the wall is left along the heading.
void Car::block(double nx, double ny, double depth, double away, State* s) {
  const elementary::SinCos heading = elementary::sincos(s->yaw);
  const double along = nx * heading.cos + ny * heading.sin;
  s->x -= depth * nx;
  s->y -= depth * ny;
  s->speed -= std::max(0.0, s->speed * along - away) * along;
}

void Car::write(const World&, const State& s, float* out) {
  const elementary::SinCos heading = elementary::sincos(s.yaw);
  const double row[] = {0.1 * s.x,   0.1 * s.y,   s.speed * heading.cos, s.speed * heading.sin,
                        heading.sin, heading.cos, 0.1 * s.rate};
  for (const double value : row) *out++ = static_cast<float>(value);
}

}  // namespace rdm
