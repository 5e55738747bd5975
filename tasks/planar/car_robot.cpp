#include "tasks/planar/car_robot.hpp"

#include <cmath>
#include <iterator>

#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr double kChassis = 0.0239, kWheel = 0.0019635, kBall = 0.00261799;  // kg
constexpr double kMass = kChassis + 2 * kWheel + kBall;
constexpr double kChassisMiddle = 0.00395397;  // m along y, of the chassis' centre of mass
constexpr double kAxle = 0.1, kTrack = 0.13, kTread = 0.025, kRadius = 0.05;  // m; of wheels and ball
constexpr double kMiddle = (kChassisMiddle * kChassis + kAxle * (2 * kWheel - kBall)) / kMass;
constexpr double kMoment = 3.63827e-4 - kMass * kMiddle * kMiddle;  // kg m2, about the centre of mass
constexpr double kWheelMoment = 2.45437e-6, kBallMoment = 2.61799e-6, kDamping = 0.001;  // kg m2, N m s
constexpr double kTorque = 0.02, kTurnDrag = 0.006, kTorsion = 0.005;                    // N m, N m s2, m
constexpr double kWeight = 9.81 * kMass;
constexpr double kBallLoad = kWeight * (kAxle - kMiddle) / (2 * kAxle), kEdgeLoad = (kWeight - kBallLoad) / 4;
constexpr int kSweeps = 5;

// rad/s per N m s, damping within a substep included
constexpr double kWheelGive = 1 / (kWheelMoment + CarRobot::kStep * kDamping),
                 kBallGive = 1 / (kBallMoment + CarRobot::kStep * kDamping);

// Where the floor touches: the edges of the left tread, of the right one, the ball. The stiffer direction of
// its slip counts for both.
constexpr bool is_ball(double y) {
  return y < 0;
}
struct Touch {
  double x, y, load;  // m, N
  double mass;        // kg, that an impulse against its slip moves
};
constexpr Touch touch_at(double x, double y, double load) {
  const double lever = y - kMiddle, roll = kRadius * kRadius * (is_ball(y) ? kBallGive : kWheelGive);
  const double give_x = 1 / kMass + lever * lever / kMoment + (is_ball(y) ? roll : 0);
  const double give_y = 1 / kMass + x * x / kMoment + roll;
  return {x, y, load, 1 / std::max(give_x, give_y)};
}
constexpr Touch kTouch[CarRobot::kTouches] = {
    touch_at(-kTrack - kTread, kAxle, kEdgeLoad), touch_at(-kTrack + kTread, kAxle, kEdgeLoad),
    touch_at(kTrack - kTread, kAxle, kEdgeLoad), touch_at(kTrack + kTread, kAxle, kEdgeLoad),
    touch_at(0, -kAxle, kBallLoad)};
constexpr int kBallTouch = 4;

// What moves, in the car's frame, and how an impulse of the floor moves it.
struct Rates {
  double vx, vy, w, wheel[2], ball[2];

  void hit(int touch, double px, double py) {
    const Touch& at = kTouch[touch];
    const double turn = (at.x * py - (at.y - kMiddle) * px) * (1 / kMoment);
    w += turn;
    vx += px * (1 / kMass) + turn * kMiddle;
    vy += py * (1 / kMass);
    if (touch == kBallTouch) {
      ball[0] += kRadius * py * kBallGive;
      ball[1] -= kRadius * px * kBallGive;
    } else {
      wheel[touch / 2] += kRadius * py * kWheelGive;
    }
  }
};

// One impulse against the slip at a touch, within the disc of friction.
void hold(int touch, Rates* v, double* push) {
  const Touch& at = kTouch[touch];
  double slip_x = v->vx - v->w * at.y, slip_y = v->vy + v->w * at.x;
  if (touch == kBallTouch) {
    slip_x -= kRadius * v->ball[1];
    slip_y += kRadius * v->ball[0];
  } else {
    slip_y += kRadius * v->wheel[touch / 2];
  }
  double px = push[0] - slip_x * at.mass, py = push[1] - slip_y * at.mass;
  const double most = at.load * CarRobot::kStep, square = px * px + py * py;
  if (square > most * most) {
    const double share = most / std::sqrt(square);
    px *= share, py *= share;
  }
  v->hit(touch, px - push[0], py - push[1]);
  push[0] = px, push[1] = py;
}

constexpr double kBodyHalf = 0.1;  // m
constexpr RobotPart kParts[] = {{-0.1, 0.1, -0.1, 0.16, 0, 1},
                                {-0.05, 0.05, -0.175, -0.1, 0, -1},
                                {-kTrack - kTread, kTrack + kTread, kAxle - kRadius, kAxle + kRadius, 0, 1}};

}  // namespace

void CarRobot::check(const CarRobot& r) {
  check_flat_robot(r);
  check_numbers("wheels", r.wheel, std::size(r.wheel), 1e4);
  check_numbers("ball", r.ball, std::size(r.ball), 1e4);
  const Quat& q = r.turned;
  const double off = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z - 1;
  check_numbers("ball's rotation", &off, 1, 1e-6);
  // no more than the disc of friction
  for (const auto& push : r.push) check_numbers("push", push, std::size(push), kWeight * kStep);
}

void CarRobot::substep(const float* action, CarRobot* robot) {
  CarRobot& r = *robot;
  const elementary::SinCos h = elementary::sincos(r.yaw);
  Rates v{h.cos * r.vx + h.sin * r.vy, h.cos * r.vy - h.sin * r.vx, r.w, {}, {}};
  v.vy += kStep * kMiddle * r.w * r.w;  // the centre of mass goes straight on
  v.w /= 1 + kStep * kTurnDrag * std::fabs(r.w) / kMoment;
  for (int i = 0; i < 2; ++i) {
    const double torque = std::clamp(static_cast<double>(action[i]), -kTorque, kTorque);
    v.wheel[i] = kWheelGive * (kWheelMoment * r.wheel[i] + kStep * torque);
    v.ball[i] = kBallGive * kBallMoment * r.ball[i];
  }
  for (int i = 0; i < kTouches; ++i) v.hit(i, r.push[i][0], r.push[i][1]);
  for (int sweep = 0; sweep < kSweeps; ++sweep)
    for (int i = 0; i < kTouches; ++i) hold(i, &v, r.push[i]);

  const double vx = h.cos * v.vx - h.sin * v.vy, vy = h.sin * v.vx + h.cos * v.vy;
  r.ax = (vx - r.vx) / kStep, r.ay = (vy - r.vy) / kStep;
  r.vx = vx, r.vy = vy, r.w = v.w;
  r.x += kStep * r.vx;
  r.y += kStep * r.vy;
  r.yaw += kStep * r.w;
  // about the vertical the floor holds the ball back as far as friction reaches, and it turns in the car
  constexpr double kMostTurn = kTorsion * kBallLoad / kDamping;
  for (int i = 0; i < 2; ++i) r.wheel[i] = v.wheel[i], r.ball[i] = v.ball[i];
  r.ball[2] = std::clamp(-r.w, -kMostTurn, kMostTurn);
  const double half = 0.5 * kStep;
  const Quat turn{1, half * r.ball[0], half * r.ball[1], half * r.ball[2]};
  r.turned = normalized(turn * r.turned);
}

RobotGap CarRobot::gap(const CarRobot& robot, const elementary::SinCos& h, double x, double y,
                       double radius) {
  RobotGap least = part_gap(kParts[0], robot, h, x, y, radius);
  for (size_t i = 1; i < std::size(kParts); ++i) {
    const RobotGap g = part_gap(kParts[i], robot, h, x, y, radius);
    if (g.gap < least.gap) least = g;
  }
  return least;
}

// The ball's rates in its own frame, then the rows of its rotation.
void CarRobot::write(const CarRobot& r, float* out) {
  const Vec3 rates = rotate(conjugate(r.turned), {r.ball[0], r.ball[1], r.ball[2]});
  for (const double v : {rates.x, rates.y, rates.z}) *out++ = static_cast<float>(v);
  for (const double v : to_matrix(r.turned).m) *out++ = static_cast<float>(v);
}

void CarRobot::add(PlanarScene& scene) {
  const Quat sideways = axis_angle({0, 1, 0}, kPi / 2);
  scene.body("robot", ShapeKind::kBox, {kBodyHalf, kBodyHalf, 0.05}, kMarkRed)
      .shape("back bumper", ShapeKind::kBox, {0.1, 0.01, 0.05}, kMarkBlue, {{0, 0.15, 0}, {}})
      .shape("front bumper", ShapeKind::kBox, {0.05, 0.01, 0.05}, kMarkBlue, {{0, -0.165, 0}, {}})
      .shape("nose", ShapeKind::kBox, {0.05, 0.03, 0.01}, kMarkBlue, {{0, -0.13, 0.04}, {}})
      .shape("left", ShapeKind::kCylinder, {kRadius, kTread, 0}, kMarkGrey,
             {{-kTrack, kAxle, -0.05}, sideways})
      .shape("right", ShapeKind::kCylinder, {kRadius, kTread, 0}, kMarkGrey,
             {{kTrack, kAxle, -0.05}, sideways})
      .shape("rear", ShapeKind::kSphere, {kRadius, 0, 0}, kMarkGrey, {{0, -kAxle, -0.05}, {}});
}

}  // namespace rdm
