// The local problem of constrained policy optimisation (Achiam et al. 2017), solved in closed form:
//   max G'y  subject to  b'y + c <= 0  and  y'H y / 2 <= delta,
// G and b ascent gradients of reward and cost surrogate. With x = H^-1 G and p = H^-1 b the solution lies in
// the span of x and p and needs three numbers: q = G'x, r = G'p = b'x, s = b'p.
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
