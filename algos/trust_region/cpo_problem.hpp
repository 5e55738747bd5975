// The local problem of constrained policy optimisation (Achiam et al. 2017, section 6.1 and theorem 2),
// solved in closed form:
//   max G'y  subject to  b'y + c <= 0  and  y'H y / 2 <= delta,
// G and b ascent gradients of reward and cost surrogate. With x = H^-1 G and p = H^-1 b the solution lies in
// the span of x and p and needs three numbers: q = G'x, r = G'p = b'x, s = b'p.
//
// The paper solves the dual, max over lambda, nu >= 0 of
//   -(q - 2 r nu + s nu^2) / (2 lambda) + nu c - lambda delta
// by cases. Here the primal, by geometry in the metric of H, where the region is a ball of radius
// sqrt(2 delta) and the limit a plane:
//   room = 2 delta - c^2 / s    squared radius of the disc in which the plane cuts the ball
//   c >= 0, room < 0            recovery: no feasible point, y = -sqrt(2 delta / s) p (section 6.2)
//   the free step sqrt(2 delta / q) x is feasible: y is that
//   else                        y = centre of the disc + its radius along what of x lies in the plane:
//                               y = -(c / s) p + sqrt(room / (q - r^2 / s)) (x - (r / s) p)
// and lambda = sqrt((q - r^2 / s) / room), nu = max(0, lambda c + r) / s are the paper's.
// Two unknowns and square roots: nothing that a linear-algebra library would do.
#pragma once
#include <cstdint>

namespace rdm {

enum class CpoCase : int32_t {
  kRecovery = 0,    // c >= 0, no feasible point in the trust region: straight down the cost
  kInfeasible = 1,  // c >= 0, the trust region reaches feasible points
  kBoundary = 2,    // c < 0, the boundary crosses the trust region
  kInside = 3,      // c < 0, the whole trust region is feasible
  kNoCost = 4,      // the cost gradient vanishes
};

struct CpoProblem {
  double q = 0, r = 0, s = 0, c = 0;
  double delta = 0.01;  // bound on y'H y / 2
};

// y = along_x x + along_p p. lambda belongs to the trust region, nu to the cost, as the dual has them
// (0 where none binds, and both in the recovery).
struct CpoStep {
  CpoCase which = CpoCase::kInside;
  double along_x = 0, along_p = 0;
  double lambda = 0, nu = 0;
};

// In the primal form: on the plane b'y + c = 0 the centre is -(c / s) p, and sqrt(2 delta - c^2 / s) is what
// is left of the radius in the H-metric. It has no division that a parallel G and b could make 0 / 0.
CpoStep solve_cpo(const CpoProblem& problem);

}  // namespace rdm
