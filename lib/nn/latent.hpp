// A part of what a policy sees that it sees as a few numbers, the latent z (Kumar et al. 2021, RMA, arXiv 2107.04034):
//
//   z = mu(o_l),   a = pi(o_p, z)      o_l, o_p: entries of the row, or of the row with its history behind it
//
// pi of a policy that sees points has their features behind z.
//
// mu is a perceptron whose last layer is linear; pi's network has z behind its own entries. Of a teacher o_l are fields
// that a robot cannot measure, of a student its last decisions, and pi is the same.
#pragma once
#include "nn/mlp.hpp"

namespace rdm {

inline constexpr int32_t kMaxLatent = 256;

struct LatentShape {
  MlpShape mlp;                      // of mu; out: numbers of z, 0: there is none
  const int32_t* columns = nullptr;  // [mlp.in] that mu reads, ascending
  const int32_t* own = nullptr;      // [num_own] that pi reads beside z, ascending
  int32_t num_own = 0;
  int32_t entries = 0;  // of a row, that either reads

  explicit operator bool() const { return mlp.out > 0; }
  size_t num_params() const { return mlp.out ? mlp.num_params() : 0; }
};

// What pi sees, own and z at the begin of seen [rows][step], of rows x [rows][width] and their z [rows][mlp.out].
inline void put_latent(const LatentShape& l, const float* x, int32_t width, const float* z, int32_t rows,
                       float* seen, size_t step) {
  const auto own = static_cast<size_t>(l.num_own), out = static_cast<size_t>(l.mlp.out);
  for (int32_t i = 0; i < rows; ++i, x += width, z += out, seen += step) {
    pick_columns(x, 1, width, l.own, l.num_own, seen);
    std::copy_n(z, out, seen + own);
  }
}

}  // namespace rdm
