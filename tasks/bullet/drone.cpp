#include "tasks/bullet/drone.hpp"

#include <algorithm>
#include <cmath>

#include "env/fields.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr double kMass = 1.42, kGravity = 9.81;     // kg, m/s2
constexpr Vec3 kMoments{0.05, 0.05, 0.24};          // kg m2
constexpr double kArm = 0.34, kRotorRadius = 0.14;  // m
constexpr double kPitch = 0.11938, kAir = 1.225;    // m, kg/m3
constexpr double kLoss = 3.29546, kSwing = 0.1;
constexpr double kDamping = 0.04, kFriction = 0.8;
constexpr double kStartHeight = 0.17, kLeg = 0.16;   // m
constexpr double kRepair = 0.2, kRepairSpeed = 0.5;  // share of depth undone in a substep, m/s at most
constexpr int kSweeps = 5;
constexpr double kPlaceBound = 1e5, kRateBoundOf = 1e3;  // m; m/s, rad/s
constexpr double kUnit = 1e-3;

// Rotors and feet, in their order: front, left, back, right.
constexpr double kX[Drone::kRotors] = {kArm, 0, -kArm, 0}, kY[Drone::kRotors] = {0, kArm, 0, -kArm};

double damped(const Vec3& v, double h) {
  return std::max(0.0, 1 - h * kDamping * (1 + norm(v)));
}

// Inverse inertia in world axes, applied.
Vec3 give(const Mat3& R, const Vec3& impulse) {
  const Vec3 b = transpose(R) * impulse;
  return R * Vec3{b.x / kMoments.x, b.y / kMoments.y, b.z / kMoments.z};
}

// Feet that are in the ground get impulses until none sinks deeper; their count.
int32_t stand(const Mat3& R, double h, Drone::State* s) {
  Vec3 arm[Drone::kRotors];
  double bias[Drone::kRotors], pressed[Drone::kRotors];
  int32_t n = 0;
  for (int i = 0; i < Drone::kRotors; ++i) {
    arm[n] = R * Vec3{kX[i], kY[i], -kLeg};
    const double depth = -(s->p.z + arm[n].z);
    if (depth < 0) continue;
    bias[n] = std::min(kRepairSpeed, kRepair * depth / h);
    pressed[n++] = 0;
  }
  const auto push = [&](int i, const Vec3& axis, double low, double high, double wanted, double* total) {
    const Vec3 lever = cross(arm[i], axis), turned = give(R, lever);
    const double speed = dot(axis, s->v + cross(s->w, arm[i]));
    const double now = std::clamp(*total + (wanted - speed) / (1 / kMass + dot(lever, turned)), low, high);
    s->v += (now - *total) / kMass * axis;
    s->w += (now - *total) * turned;
    *total = now;
  };
  double rubbed[Drone::kRotors][2] = {};
  for (int sweep = 0; sweep < kSweeps && n > 0; ++sweep)
    for (int i = 0; i < n; ++i) {
      push(i, {0, 0, 1}, 0, HUGE_VAL, bias[i], &pressed[i]);
      const double most = kFriction * pressed[i];
      push(i, {1, 0, 0}, -most, most, 0, &rubbed[i][0]);
      push(i, {0, 1, 0}, -most, most, 0, &rubbed[i][1]);
    }
  return n;
}

}  // namespace

double rotor_thrust(double w, double v) {
  const double u = w * kPitch / (2 * kPi), k = 2 * kRotorRadius / kPitch / kLoss;
  return kAir * kPi * kRotorRadius * kRotorRadius * (u * u - u * v) * k * std::sqrt(k);
}

void Drone::add(PlanarScene& scene, const AgentDrive&) {
  scene.body("drone", ShapeKind::kBox, {0.1, 0.1, 0.06}, kMarkBlue)
      .shape("beam", ShapeKind::kBox, {kArm, 0.02, 0.02}, kMarkGrey)
      .shape("beam", ShapeKind::kBox, {0.02, kArm, 0.02}, kMarkGrey);
  for (int i = 0; i < kRotors; ++i) {
    const Vec3 at{kX[i], kY[i], 0.04};
    scene
        .shape("rotor", ShapeKind::kCylinder, {kRotorRadius, 0.01, 0}, i == 0 ? kMarkYellow : kMarkCyan,
               {at, {}})
        .shape("foot", ShapeKind::kCylinder, {0.02, 0.5 * kLeg, 0}, kMarkGrey,
               {{kX[i], kY[i], -0.5 * kLeg}, {}});
  }
}

void Drone::check(const State& s) {
  const double places[] = {s.p.x, s.p.y, s.p.z};
  const double rates[] = {s.v.x, s.v.y, s.v.z, s.w.x, s.w.y, s.w.z};
  check_numbers("position", places, 3, kPlaceBound);
  check_numbers("velocities", rates, 6, kRateBoundOf);
  check_rotation("rotation", s.q);
  const double square = s.q.w * s.q.w + s.q.x * s.q.x + s.q.y * s.q.y + s.q.z * s.q.z;
  if (square != 0) {
    const double off = square - 1;
    check_numbers("rotation: length", &off, 1, kUnit);
  }
  check_numbers("rotors", s.rotor, kRotors, kHoverSpeed);
  check_integer("touching", s.touching, 0, kRotors);
}

void Drone::start(const AgentStart& at, Stream&, World&, State* s) {
  *s = {};
  s->p = {at.x, at.y, kStartHeight};
  s->q = axis_angle({0, 0, 1}, at.yaw);
}

void Drone::act(const float* action, const AgentDrive& drive, World&, State* state) {
  State& s = *state;
  const double h = kBulletDt / drive.substeps;
  for (int i = 0; i < kRotors; ++i) s.rotor[i] = kSwing * kHoverSpeed * static_cast<double>(action[i]);
  for (int k = 0; k < drive.substeps; ++k) {
    const Mat3 R = to_matrix(s.q);
    const Vec3 up = R.col(2), spin = transpose(R) * s.w;
    const double climb = dot(up, s.v);
    double lift = 0;
    Vec3 torque;
    for (int i = 0; i < kRotors; ++i) {
      const double pull = rotor_thrust(kHoverSpeed + s.rotor[i], climb);
      lift += pull;
      torque += {kY[i] * pull, -kX[i] * pull, 0};
    }
    const Vec3 carried{kMoments.x * spin.x, kMoments.y * spin.y, kMoments.z * spin.z};
    s.v += h * (lift / kMass * up + Vec3{0, 0, -kGravity});
    s.w += h * give(R, R * (torque - cross(spin, carried)));
    s.v = damped(s.v, h) * s.v;
    s.w = damped(s.w, h) * s.w;
    s.touching = stand(R, h, &s);
    const Pose X = moved({s.p, s.q}, s.v, s.w, h);
    s.p = X.p;
    s.q = normalized(X.q);
  }
}

void Drone::show(World& world, const State& s) {
  world.set_body(0, {{s.p, s.q}, s.v, s.w});
}

AgentPlace Drone::look(const World&, const State& s) {
  return {s.p.x, s.p.y, s.p.z, s.v.x, s.v.y, std::sqrt(s.v.x * s.v.x + s.v.y * s.v.y)};
}

elementary::SinCos Drone::heading(const World&, const State& s) {
  return flat_heading(s.q);
}

double Drone::effort(const World& world, const State& s) {
  return (alive(world, s) ? 1 : -10) - 0.01 * dot(s.w, s.w) - s.touching;
}

bool Drone::alive(const World&, const State& s) {
  return to_matrix(s.q)(2, 2) >= 0;
}

void Drone::block(double nx, double ny, double depth, double away, State* s) {
  const double into = std::max(0.0, nx * s->v.x + ny * s->v.y - away);
  s->p.x -= depth * nx;
  s->p.y -= depth * ny;
  s->v.x -= into * nx;
  s->v.y -= into * ny;
}

void Drone::write(const World&, const State& s, float* out) {
  put(s.p, out, 0.1);
  put(s.v, out + 3, 0.2);
  put(s.q, out + 6);
  put(s.w, out + 10, 0.1);
  for (int i = 0; i < kRotors; ++i) out[13 + i] = static_cast<float>(2.5e-3 * s.rotor[i]);
}

}  // namespace rdm
