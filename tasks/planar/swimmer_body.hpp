// The planar three-link swimmer of MuJoCo: rigid links in a viscous fluid, two motors, soft joint limits.
//
// Coordinates q = (x, y, t0, t1, t2): the free end of the first link's axis, its angle, two joint angles.
// The equations are MuJoCo 2's ("Computation", fluid forces by the inertia box, and soft limits):
//   M(q) q'' = fluid + torques - centrifugal forces + limits
// with the armature 0.1 on each coordinate. Along an axis of a link's box of sides x, y, z the fluid pulls
// with (rho A |v| / 2 + 3 pi beta d) v, A the face and d the mean side, and turns against its spin w with
// (rho z (x^4 + y^4) |w| / 64 + pi beta d^3) w. A joint beyond its limit is pushed back as a damped spring
// of solref and solimp. Four steps of RK4 of 0.01 s; positions agree with MuJoCo to six digits.
#pragma once
#include "base/vec.hpp"

namespace rdm {

inline constexpr int kSwimmerDofs = 5, kSwimmerLinks = 3, kSwimmerMotors = 2;
inline constexpr double kSwimmerLength = 1, kSwimmerRadius = 0.1;  // m
inline constexpr double kSwimmerControlDt = 0.04;                  // s

struct SwimmerState {
  double q[kSwimmerDofs], qd[kSwimmerDofs];  // m, rad; m/s, rad/s
};

class SwimmerBody {
 public:
  SwimmerBody();
  // One control step: four steps of RK4 under the torques 150 action N m, |action| <= 1.
  void advance(const float* action, SwimmerState* state) const;
  // Accelerations under motor torques, N m.
  void accelerate(const double* q, const double* qd, const double* torque, double* qdd) const;

 private:
  double give_[kSwimmerMotors] = {};  // inverse inertia seen by the motors in the straight pose
};

// Centre of link i and its angle.
struct SwimmerLink {
  double x, y, angle;
};
SwimmerLink swimmer_link(const SwimmerState& state, int i);

}  // namespace rdm
