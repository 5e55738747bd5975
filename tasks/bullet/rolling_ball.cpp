#include "tasks/bullet/rolling_ball.hpp"

#include <cmath>

#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr double kForce = 3.5;     // N
constexpr double kInertia = 0.42;  // kg: 0.3 and 0.03 kg m2 / (0.5 m)^2
constexpr double kLinearDrag = 0.012, kAngularDrag = 0.0024, kRollingFriction = 0.1413;

double drag(double v) {  // N
  const double w = v / kBallRadius;
  return kLinearDrag * v * (1 + v) + kAngularDrag * w * (1 + w) + kRollingFriction;
}

}  // namespace

void check_ball(const RollingBall& b) {
  const double values[] = {b.x, b.y, b.vx, b.vy};
  check_numbers("ball", values, 4);
}

double ball_speed(const RollingBall& b) {
  return std::sqrt(b.vx * b.vx + b.vy * b.vy);
}

void roll(const float* action, RollingBall* ball, int32_t substeps) {
  const double step = kBallControlDt / substeps;
  const double push_x = kForce / kInertia * step * static_cast<double>(action[0]);
  const double push_y = kForce / kInertia * step * static_cast<double>(action[1]);
  RollingBall b = *ball;
  for (int i = 0; i < substeps; ++i) {
    const double loss = drag(ball_speed(b)) / kInertia * step;
    b.vx += push_x;
    b.vy += push_y;
    const double v = ball_speed(b);
    const double left = v > loss ? 1 - loss / v : 0;
    b.vx *= left;
    b.vy *= left;
    b.x += step * b.vx;
    b.y += step * b.vy;
  }
  *ball = b;
}

void write_ball(const RollingBall& b, float* out) {
  const double row[kBallObs] = {
      0.1 * b.x, 0.1 * b.y, 0.2 * b.vx, 0.2 * b.vy, -0.1 * b.vy / kBallRadius, 0.1 * b.vx / kBallRadius, 0};
  for (int i = 0; i < kBallObs; ++i) out[i] = static_cast<float>(row[i]);
}

Motion ball_motion(const RollingBall& b) {
  Motion m;
  m.X.p = {b.x, b.y, kBallRadius};
  m.v = {b.vx, b.vy, 0};
  m.w = {-b.vy / kBallRadius, b.vx / kBallRadius, 0};
  return m;
}

double ball_effort(const float* action) {
  const double a0 = static_cast<double>(action[0]), a1 = static_cast<double>(action[1]);
  return -0.5 * std::sqrt(a0 * a0 + a1 * a1);
}

}  // namespace rdm
