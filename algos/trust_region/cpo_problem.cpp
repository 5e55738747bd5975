#include "algos/trust_region/cpo_problem.hpp"

#include <algorithm>
#include <cmath>

namespace rdm {
namespace {

constexpr double kTiny = 1e-30;      // of q and s: no gradient
constexpr double kParallel = 1e-12;  // of A / q: G and b are parallel

CpoCase classify(const CpoProblem& p, double room) {
  if (p.s <= kTiny) return CpoCase::kNoCost;
  if (p.c < 0) return room < 0 ? CpoCase::kInside : CpoCase::kBoundary;
  return room < 0 ? CpoCase::kRecovery : CpoCase::kInfeasible;
}

}  // namespace

CpoStep solve_cpo(const CpoProblem& p) {
  CpoStep out;
  const double room = p.s > kTiny ? 2 * p.delta - p.c * p.c / p.s : 0;
  out.which = classify(p, room);
  const double free = p.q > kTiny ? std::sqrt(2 * p.delta / p.q) : 0;  // the step without the cost
  if (out.which == CpoCase::kNoCost || free * p.r + p.c <= 0) {
    // A recovery never gets here: c >= 0 with no room means c > sqrt(2 delta s) >= -free r.
    out.along_x = free;
    out.lambda = free > 0 ? 1 / free : 0;
    return out;
  }
  if (out.which == CpoCase::kRecovery) {
    out.along_p = -std::sqrt(2 * p.delta / p.s);
    return out;
  }
  const double rest = std::max(0.0, p.q - p.r * p.r / p.s);  // squared length of G within the plane
  const double reach = rest > kParallel * p.q ? std::sqrt(std::max(0.0, room) / rest) : 0;
  out.along_x = reach;
  out.along_p = -reach * p.r / p.s - p.c / p.s;
  out.lambda = reach > 0 ? 1 / reach : 0;
  out.nu = std::max(0.0, out.lambda * p.c + p.r) / p.s;
  return out;
}

}  // namespace rdm
