// Conjugate gradients (Hestenes and Stiefel 1952) for A x = b with a symmetric positive definite A that is
// only known by its products.
//
//   r = d = b, x = 0;  repeat   alpha = r'r / d'A d,  x += alpha d,  r -= alpha A d,
//                               beta = r'r (new) / r'r (old),  d = r + beta d
//
// After k products x minimises |x - A^-1 b| in the metric of A over the first k powers of A on b; ten to
// fifteen are enough for a natural gradient (Schulman et al. 2015, appendix C).
//
// Not Eigen's ConjugateGradient: its float sums run in the order of the processor's vectors, dot() adds in
// double in one order, so that a policy is the same on every machine.
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/arena.hpp"
#include "nn/dot.hpp"

namespace rdm {

struct CgWork {
  size_t size = 0;
  float *residual = nullptr, *direction = nullptr, *product = nullptr;  // [size]
};
inline CgWork carve_cg_work(Arena& arena, size_t size) {
  CgWork w;
  w.size = size;
  for (float** v : {&w.residual, &w.direction, &w.product}) *v = arena.make<float>(size);
  return w;
}

struct CgOptions {
  int32_t iterations = 15;
  double tolerance = 1e-6;  // |residual| / |b| that is enough
};

// x [size] = the iterate reached from 0. multiply(v, out): out = A v. Stops early at the tolerance, and
// where rounding leaves no positive curvature. Returns the number of products.
template <class Multiply>
int32_t conjugate_gradient(Multiply&& multiply, const float* b, const CgWork& work, const CgOptions& options,
                           float* x) {
  const size_t n = work.size;
  float *const r = work.residual, *const d = work.direction, *const z = work.product;
  for (size_t i = 0; i < n; ++i) x[i] = 0, r[i] = d[i] = b[i];
  double rr = dot(r, r, n);
  const double enough = options.tolerance * options.tolerance * rr;
  for (int32_t k = 0; k < options.iterations; ++k) {
    if (!(rr > enough)) return k;
    multiply(static_cast<const float*>(d), z);
    const double curvature = dot(d, z, n);
    if (!(curvature > 0) || !std::isfinite(curvature)) return k;
    const auto alpha = static_cast<float>(rr / curvature);
    for (size_t i = 0; i < n; ++i) x[i] += alpha * d[i], r[i] -= alpha * z[i];
    const double next = dot(r, r, n);
    const auto beta = static_cast<float>(next / rr);
    for (size_t i = 0; i < n; ++i) d[i] = r[i] + beta * d[i];
    rr = next;
  }
  return options.iterations;
}

}  // namespace rdm
