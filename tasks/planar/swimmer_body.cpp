#include "tasks/planar/swimmer_body.hpp"

#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"

namespace rdm {
namespace {

constexpr int kSubsteps = 4;
constexpr double kStep = kSwimmerControlDt / kSubsteps;  // s
constexpr double kGear = 150;                            // N m
constexpr double kMass = 35.6047, kMoment = 3.91757;     // kg, kg m2 of one link about z
constexpr double kArmature = 0.1;                        // on every coordinate, those of x and y too
constexpr double kLimit = 100 * kPi / 180;               // rad, of both joints
// the fluid, and the box whose inertia is a link's
constexpr double kDensity = 4000, kViscosity = 0.1;
constexpr double kBoxX = 1.136248, kBoxY = 0.171155, kBoxZ = 0.171155;
constexpr double kBoxMean = (kBoxX + kBoxY + kBoxZ) / 3;
// centre of link i = (x, y) + sum over k of kArm[i][k] e(angle k)
constexpr double kArm[3][3] = {{1, 0, 0}, {0.5, -0.5, 0}, {0.5, -1, -0.5}};
// MuJoCo's soft limits: solref (0.02, 1), solimp (0.9, 0.95, 0.001, 0.5, 2)
constexpr double kTimeConst = 0.02, kImpLow = 0.9, kImpHigh = 0.95, kImpWidth = 0.001;
constexpr double kLimitStiffness = 1 / (kImpHigh * kImpHigh * kTimeConst * kTimeConst);
constexpr double kLimitDamping = 2 / (kImpHigh * kTimeConst);
constexpr int kLimitSweeps = 10;

// Sums of kArm over the links: of one column, of the product of two.
constexpr double arm_sum(int j) {
  return kArm[0][j] + kArm[1][j] + kArm[2][j];
}
constexpr double arm_product(int j, int k) {
  return kArm[0][j] * kArm[0][k] + kArm[1][j] * kArm[1][k] + kArm[2][j] * kArm[2][k];
}

using Row = double[kSwimmerDofs];

struct Links {
  elementary::SinCos turn[3];
  double rate[3];
};

Links links_of(const double* q, const double* qd) {
  Links l;
  double angle = 0, rate = 0;
  for (int k = 0; k < 3; ++k) {
    angle += q[2 + k];
    rate += qd[2 + k];
    l.turn[k] = elementary::sincos(angle);
    l.rate[k] = rate;
  }
  return l;
}

// M in the coordinates (x, y, absolute angles), turned into that of q: joint k moves all links from k on.
void inertia_of(const Links& l, Row* M) {
  double absolute[3][3], slide[2][3];
  for (int j = 0; j < 3; ++j) {
    slide[0][j] = -kMass * arm_sum(j) * l.turn[j].sin;
    slide[1][j] = kMass * arm_sum(j) * l.turn[j].cos;
    for (int k = 0; k < 3; ++k)
      absolute[j][k] =
          kMass * arm_product(j, k) * (l.turn[j].cos * l.turn[k].cos + l.turn[j].sin * l.turn[k].sin) +
          (j == k ? kMoment : 0);
  }
  for (int j = 2; j >= 0; --j)
    for (int k = 2; k >= 0; --k) {
      const double right = k < 2 ? absolute[j][k + 1] : 0, below = j < 2 ? absolute[j + 1][k] : 0;
      absolute[j][k] += right + below - (j < 2 && k < 2 ? absolute[j + 1][k + 1] : 0);
    }
  for (int i = 0; i < 2; ++i) {
    for (int k = 1; k >= 0; --k) slide[i][k] += slide[i][k + 1];
    for (int k = 0; k < 2; ++k) M[i][k] = i == k ? 3 * kMass : 0;
    for (int k = 0; k < 3; ++k) M[i][2 + k] = M[2 + k][i] = slide[i][k];
  }
  for (int j = 0; j < 3; ++j)
    for (int k = 0; k < 3; ++k) M[2 + j][2 + k] = absolute[j][k];
  for (int i = 0; i < kSwimmerDofs; ++i) M[i][i] += kArmature;
}

// M = L L' in place (lower part), the diagonal inverted.
void factor(Row* M) {
  for (int j = 0; j < kSwimmerDofs; ++j) {
    double d = M[j][j];
    for (int k = 0; k < j; ++k) d -= M[j][k] * M[j][k];
    M[j][j] = 1 / std::sqrt(d);
    for (int i = j + 1; i < kSwimmerDofs; ++i) {
      double s = M[i][j];
      for (int k = 0; k < j; ++k) s -= M[i][k] * M[j][k];
      M[i][j] = s * M[j][j];
    }
  }
}

void solve(const Row* L, double* x) {
  for (int i = 0; i < kSwimmerDofs; ++i) {
    for (int k = 0; k < i; ++k) x[i] -= L[i][k] * x[k];
    x[i] *= L[i][i];
  }
  for (int i = kSwimmerDofs - 1; i >= 0; --i) {
    for (int k = i + 1; k < kSwimmerDofs; ++k) x[i] -= L[k][i] * x[k];
    x[i] *= L[i][i];
  }
}

double drag(double v, double area) {
  return -(0.5 * kDensity * area * std::fabs(v) + 3 * kPi * kViscosity * kBoxMean) * v;
}
double spin_drag(double w) {
  constexpr double kSquare =
      kDensity * kBoxZ * (kBoxX * kBoxX * kBoxX * kBoxX + kBoxY * kBoxY * kBoxY * kBoxY) / 64;
  constexpr double kLinear = kPi * kViscosity * kBoxMean * kBoxMean * kBoxMean;
  return -(kSquare * std::fabs(w) + kLinear) * w;
}

// Fluid forces less centrifugal ones, in q.
void forces_of(const Links& l, const double* qd, double* out) {
  double slide[2] = {}, turn[3];
  for (int j = 0; j < 3; ++j) {
    turn[j] = spin_drag(l.rate[j]);
    for (int k = 0; k < 3; ++k)  // e(k) . n(j) = sin(angle k - angle j)
      turn[j] += kMass * arm_product(j, k) * l.rate[k] * l.rate[k] *
                 (l.turn[k].sin * l.turn[j].cos - l.turn[k].cos * l.turn[j].sin);
    slide[0] += kMass * arm_sum(j) * l.rate[j] * l.rate[j] * l.turn[j].cos;
    slide[1] += kMass * arm_sum(j) * l.rate[j] * l.rate[j] * l.turn[j].sin;
  }
  for (int i = 0; i < 3; ++i) {
    double vx = qd[0], vy = qd[1];
    for (int k = 0; k < 3; ++k) {
      vx -= kArm[i][k] * l.rate[k] * l.turn[k].sin;
      vy += kArm[i][k] * l.rate[k] * l.turn[k].cos;
    }
    const elementary::SinCos& own = l.turn[i];
    const double along = drag(vx * own.cos + vy * own.sin, kBoxY * kBoxZ);
    const double across = drag(vy * own.cos - vx * own.sin, kBoxX * kBoxZ);
    const double fx = along * own.cos - across * own.sin, fy = along * own.sin + across * own.cos;
    slide[0] += fx;
    slide[1] += fy;
    for (int k = 0; k < 3; ++k) turn[k] += kArm[i][k] * (fy * l.turn[k].cos - fx * l.turn[k].sin);
  }
  out[0] = slide[0];
  out[1] = slide[1];
  double sum = 0;
  for (int k = 2; k >= 0; --k) out[2 + k] = sum += turn[k];
}

// Share of the wanted acceleration that a limit enforces, by its violation in m or rad.
double impedance(double violation) {
  const double x = std::min(violation / kImpWidth, 1.0);
  const double y = x <= 0.5 ? 2 * x * x : 1 - 2 * (1 - x) * (1 - x);
  return kImpLow + y * (kImpHigh - kImpLow);
}

}  // namespace

SwimmerBody::SwimmerBody() {
  const double q[kSwimmerDofs] = {}, qd[kSwimmerDofs] = {};
  Row L[kSwimmerDofs];
  inertia_of(links_of(q, qd), L);
  factor(L);
  for (int i = 0; i < kSwimmerMotors; ++i) {
    double unit[kSwimmerDofs] = {};
    unit[3 + i] = 1;
    solve(L, unit);
    give_[i] = unit[3 + i];
  }
}

void SwimmerBody::accelerate(const double* q, const double* qd, const double* torque, double* qdd) const {
  const Links l = links_of(q, qd);
  Row L[kSwimmerDofs];
  inertia_of(l, L);
  factor(L);
  forces_of(l, qd, qdd);
  for (int i = 0; i < kSwimmerMotors; ++i) qdd[3 + i] += torque[i];
  solve(L, qdd);

  // limits that are passed push back; at most one side of each joint
  double push[2] = {}, wanted[2], soft[2], unit[2][kSwimmerDofs] = {};
  bool active[2], any = false;
  for (int i = 0; i < kSwimmerMotors; ++i) {
    const double violation = std::fabs(q[3 + i]) - kLimit, side = q[3 + i] > 0 ? -1 : 1;
    active[i] = violation > 0;
    if (!active[i]) continue;
    any = true;
    const double imp = impedance(violation);
    wanted[i] = -kLimitDamping * side * qd[3 + i] + kLimitStiffness * imp * violation;
    soft[i] = (1 - imp) / imp * give_[i];
    unit[i][3 + i] = side;
    solve(L, unit[i]);
  }
  if (!any) return;
  for (int sweep = 0; sweep < kLimitSweeps; ++sweep)
    for (int i = 0; i < kSwimmerMotors; ++i) {
      if (!active[i]) continue;
      const double side = q[3 + i] > 0 ? -1 : 1, own = side * unit[i][3 + i];
      const double change = (wanted[i] - side * qdd[3 + i] - soft[i] * push[i]) / (own + soft[i]);
      const double next = std::max(0.0, push[i] + change);
      for (int k = 0; k < kSwimmerDofs; ++k) qdd[k] += (next - push[i]) * unit[i][k];
      push[i] = next;
    }
}

void SwimmerBody::advance(const float* action, SwimmerState* state) const {
  const double torque[kSwimmerMotors] = {kGear * static_cast<double>(action[0]),
                                         kGear * static_cast<double>(action[1])};
  constexpr double kAt[4] = {0, 0.5, 0.5, 1}, kWeight[4] = {1.0 / 6, 1.0 / 3, 1.0 / 3, 1.0 / 6};
  for (int n = 0; n < kSubsteps; ++n) {
    const SwimmerState s = *state;
    double v[kSwimmerDofs] = {}, a[kSwimmerDofs] = {};  // of the stage before
    for (int stage = 0; stage < 4; ++stage) {
      double q[kSwimmerDofs], qd[kSwimmerDofs];
      for (int i = 0; i < kSwimmerDofs; ++i) {
        q[i] = s.q[i] + kStep * kAt[stage] * v[i];
        qd[i] = s.qd[i] + kStep * kAt[stage] * a[i];
      }
      accelerate(q, qd, torque, a);
      for (int i = 0; i < kSwimmerDofs; ++i) {
        v[i] = qd[i];
        state->q[i] += kStep * kWeight[stage] * qd[i];
        state->qd[i] += kStep * kWeight[stage] * a[i];
      }
    }
  }
}

SwimmerLink swimmer_link(const SwimmerState& state, int i) {
  SwimmerLink link{state.q[0], state.q[1], 0};
  double angle = 0;
  for (int k = 0; k < kSwimmerLinks; ++k) {
    angle += state.q[2 + k];
    const elementary::SinCos turn = elementary::sincos(angle);
    link.x += kArm[i][k] * turn.cos;
    link.y += kArm[i][k] * turn.sin;
    if (k == i) link.angle = angle;
  }
  return link;
}

}  // namespace rdm
