// The projection of projection-based CPO (Yang et al. 2020, algorithm 1): a reward step of the whole trust
// region, then the nearest point of the half-space b'y + c <= 0, in the metric L of the KL (L = H) or of the
// parameters (L = I):
//   y = a x - max(0, (a b'x + c) / b'L^-1 b) L^-1 b,   a = sqrt(2 delta / q)
// As a peer does, a line search shortens the step until the KL is within delta (line_search_steps,
// 100); the paper takes it whole.
#pragma once

namespace rdm {

struct PcpoProblem {
  double q = 0, r = 0;  // G'x and b'x, x = H^-1 G
  double c = 0, delta = 0.01;
  double metric = 0;  // b'L^-1 b: b'H^-1 b for the KL, b'b for the parameters
};

// y = along_x x - multiplier L^-1 b.
struct PcpoStep {
  double along_x = 0, multiplier = 0;
};
PcpoStep project_pcpo(const PcpoProblem& problem);

}  // namespace rdm
