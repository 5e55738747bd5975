// Adam (betas 0.9 and 0.999, epsilon 1e-8) over a flat vector, with global-norm clipping in the same pass.
#pragma once
#include <cstddef>
#include <cstdint>

#include "base/arena.hpp"
#include "nn/kernels.hpp"

namespace rdm {

struct Adam {
  size_t size = 0;
  float *m = nullptr, *v = nullptr;  // [size]
  int64_t t = 0;                     // steps taken
};
Adam carve_adam(Arena& arena, size_t size);

// params -= rate * m^/(sqrt(v^) + 1e-8) with the gradient scaled by min(1, max_norm / (norm + 1e-6)).
// max_norm <= 0: no clipping. Returns the norm before clipping, summed in a fixed order in double. With a
// norm that is not finite nothing is changed.
double adam_step(Adam& adam, float* params, const float* grad, double rate, double max_norm);

// The same in two parts: what is to be done, counted as a step, and entries [low, high) of it, in any order
// and on any thread.
struct AdamStep {
  double norm = 0;
  AdamArgs args = {};
};
AdamStep adam_begin(Adam& adam, float* params, const float* grad, double rate, double max_norm);
// Likewise, of a norm that was summed already, such as that of more than this vector.
AdamStep adam_begin(Adam& adam, float* params, const float* grad, double norm, double rate, double max_norm);
double sum_squares(const float* x, size_t count);  // in a fixed order
void adam_range(const AdamStep& step, size_t low, size_t high);

}  // namespace rdm
