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

// The iterates, a product at a time:
//   begin(b, ...);  while (next()) product = A direction
// leaves in x [size] the iterate reached from 0. Stops early at the tolerance, and where rounding leaves no
// positive curvature.
class ConjugateGradient {
 public:
  void begin(const float* b, const CgWork& work, const CgOptions& options, float* x);
  // Takes in the product that it asked for, and asks for the next one; false: x is as it stays.
  bool next();
  const float* direction() const { return work_.direction; }
  float* product() const { return work_.product; }
  int32_t products() const { return products_; }  // that x is made of

 private:
  bool take();

  CgWork work_;
  CgOptions options_;
  float* x_ = nullptr;
  double rr_ = 0, enough_ = 0;
  int32_t products_ = 0;
  bool asked_ = false;
};

inline void ConjugateGradient::begin(const float* b, const CgWork& work, const CgOptions& options, float* x) {
  work_ = work;
  options_ = options;
  x_ = x;
  for (size_t i = 0; i < work.size; ++i) x[i] = 0, work.residual[i] = work.direction[i] = b[i];
  rr_ = dot(work.residual, work.residual, work.size);
  enough_ = options.tolerance * options.tolerance * rr_;
  products_ = 0;
  asked_ = false;
}

inline bool ConjugateGradient::take() {
  const size_t n = work_.size;
  float *const r = work_.residual, *const d = work_.direction, *const z = work_.product;
  const double curvature = dot(d, z, n);
  if (!(curvature > 0) || !std::isfinite(curvature)) return false;
  const auto alpha = static_cast<float>(rr_ / curvature);
  for (size_t i = 0; i < n; ++i) x_[i] += alpha * d[i], r[i] -= alpha * z[i];
  const double next = dot(r, r, n);
  const auto beta = static_cast<float>(next / rr_);
  for (size_t i = 0; i < n; ++i) d[i] = r[i] + beta * d[i];
  rr_ = next;
  ++products_;
  return true;
}

inline bool ConjugateGradient::next() {
  if (asked_ && !take()) return false;
  asked_ = products_ < options_.iterations && rr_ > enough_;
  return asked_;
}

}  // namespace rdm
