#include "algos/trust_region/pcpo_projection.hpp"

#include <algorithm>
#include <cmath>

namespace rdm {

PcpoStep project_pcpo(const PcpoProblem& p) {
  constexpr double kTiny = 1e-30;
  PcpoStep out;
  out.along_x = p.q > kTiny ? std::sqrt(2 * p.delta / p.q) : 0;
  if (p.metric > kTiny) out.multiplier = std::max(0.0, out.along_x * p.r + p.c) / p.metric;
  return out;
}

}  // namespace rdm
