// The inner loops of lib/nn, one table of them per instruction set, chosen at run time.
//
// Every entry of a product adds its terms in an order that depends on the sizes n and k alone, never on the
// number of rows: so a row's result does not depend on the batch that it came in.
//
// One instruction set gives the same bytes on every processor that has it. Two sets do not: v3 and v4 agree
// in products, activations and Adam, not in the sums over a row or a gradient (log_prob, kl, sum_squares),
// which they add in as many parts as they have lanes; v2 has no fused multiply-add and differs in nearly all.
// So a policy acts alike on v3 and v4, and training repeats bit by bit on machines of one set; every machine
// can be lowered to v2 by set_kernel_isa.
#pragma once
#include <cstddef>
#include <cstdint>

#include "nn/mlp.hpp"

namespace rdm {

// Columns and depth of B that are packed at a time. Fewer columns change no entry of the product; what they
// save in memory they cost in passes over A, which few rows do not mind.
inline constexpr int32_t kPackColumns = 512, kPackStep = 64, kPackDepth = 256;
// Up to so many rows B is not packed at all when A's rows and B's columns lie in order in memory.
inline constexpr int32_t kSkinnyRows = 4;
// Up to so many columns dot products along k beat padded panels.
inline constexpr int32_t kDotColumns = 3;

// C = A B, or C += A B, then optionally + bias[j], an activation, or a product with an activation's slope.
struct GemmArgs {
  int32_t m = 0, n = 0, k = 0;
  const float* a = nullptr;  // A(i, k) = a[i a_row + k a_col]; a_row or a_col is 1
  size_t a_row = 0, a_col = 0;
  const float* b = nullptr;  // B(k, j) = b[k b_row + j b_col]; b_row or b_col is 1
  size_t b_row = 0, b_col = 0;
  float* c = nullptr;  // C(i, j) = c[i n + j]
  bool add = false;
  const float* bias = nullptr;      // [n] or null
  bool activate = false;            // C = act(C)
  const float* slope_of = nullptr;  // [m][n] values of act or null: C *= act' there
  Activation activation = Activation::kTanh;
  int32_t pack_columns = kPackColumns;  // of B at a time, a multiple of kPackStep
  float* packed = nullptr;              // gemm_pack_floats(n, k, pack_columns) floats
  bool is_packed = false;               // the last product with these panels had the same B (packs_whole)
};
size_t gemm_pack_floats(int32_t n, int32_t k, int32_t pack_columns = kPackColumns);
// All of B is packed at a time, so that a product of more than kSkinnyRows rows and more than kDotColumns
// columns leaves it in `packed`.
inline bool packs_whole(int32_t n, int32_t k) {
  return n <= kPackColumns && k <= kPackDepth;
}

struct AdamArgs {
  size_t size;
  float *params, *m, *v;
  const float* grad;
  float scale, step, root;  // gradient scale, rate / (1 - 0.9^t), 1 / sqrt(1 - 0.999^t)
};

struct Kernels {
  const char* isa;
  void (*gemm)(const GemmArgs& args);
  // sum[j] = sum of x[r][j] over r, in the order of r. x [rows][n].
  void (*column_sums)(const float* x, int32_t rows, int32_t n, float* sum);
  void (*adam)(const AdamArgs& args);
  double (*sum_squares)(const float* x, size_t n);
  // Mean and sum of squared deviations of the first n columns of x [rows][row_step] over the rows whose mask
  // is not 0 (null: all); `count` of them, at least one.
  void (*column_moments)(const float* x, int32_t rows, int32_t n, int32_t row_step, const uint8_t* mask,
                         double count, double* mean, double* m2);
  // y = clip((x - shift) scale, +-limit); not-a-number stays.
  void (*normalize)(const float* x, int32_t rows, int32_t n, const float* shift, const float* scale,
                    float limit, float* y);
  // y = clip(y + exp(log_std) noise, +-limit); noise null: the clip alone. y, noise [rows][n].
  void (*add_noise)(const float* log_std, const float* noise, int32_t rows, int32_t n, float limit, float* y);
  float (*log_prob)(const float* mean, const float* log_std, const float* action, int32_t n);
  void (*log_prob_grad)(const float* mean, const float* log_std, const float* action, int32_t n, float scale,
                        float* dmean, float* dlog_std);
  float (*kl)(const float* mean0, const float* log_std0, const float* mean1, const float* log_std1,
              int32_t n);
  // What a PointNet needs beside products. best[j] = max(best[j], z[r][j]) over the rows of z [rows][n], and
  // at[j] = first + r where it rose; of equal values the first keeps its place.
  void (*max_rows)(const float* z, int32_t rows, int32_t n, float first, float* best, float* at);
  void (*activate)(Activation a, float* x, size_t n);               // x = act(x)
  void (*slope)(Activation a, const float* h, size_t n, float* d);  // d *= act' at values h of act
  // Of z[j] = w[j] . h[slot[j]], w [n][k], h [][k]: dw[j] += dz[j] h[slot[j]], dh[slot[j]] += dz[j] w[j] (dh
  // null: not wanted), for j in order, but where dz[j] is 0.
  void (*spread_slots)(const float* dz, const int32_t* slot, int32_t n, int32_t k, const float* h,
                       const float* w, float* dw, float* dh);
  // y[j] += v[j] . h[slot[j]], likewise.
  void (*dot_slots)(const int32_t* slot, int32_t n, int32_t k, const float* h, const float* v, float* y);
  // A step of a GRU (nn/gru.hpp). state_part, gates [rows][3 n] in the order r, z, n, before and h [rows][n].
  // gates: what the input gives, which becomes the gates' values.
  void (*gru_gates)(const float* state_part, const float* before, int32_t rows, int32_t n, float* gates,
                    float* h);
  // Its derivatives: carry comes as d(loss)/dh of the steps behind, to which dh is added, and leaves as what flows
  // past the products to the state before. gates and state_part become d(loss) by what input and state give.
  void (*gru_slopes)(const float* before, const float* dh, int32_t rows, int32_t n, float* gates,
                     float* state_part, float* carry);
  // Its derivative along a direction, after gru_gates: of what input and state give, dgates and dstate_part, and of
  // the state before, dbefore; to dh, which may be dbefore.
  void (*gru_tangents)(const float* state_part, const float* before, const float* gates, int32_t rows,
                       int32_t n, const float* dgates, const float* dstate_part, const float* dbefore,
                       float* dh);
  // Elementwise, y may be x: for tests of their accuracy.
  void (*map_tanh)(const float* x, size_t n, float* y);
  void (*map_elu)(const float* x, size_t n, float* y);
  void (*map_exp)(const float* x, size_t n, float* y);
};

// The table in force: chosen once at first use, from what the processor has (base/cpu.hpp), or by
// set_kernel_isa, which forces a lower one for tests; false if this machine or build has it not.
const Kernels& kernels();
const char* kernel_isa();
bool set_kernel_isa(const char* name);

// Null where this compiler or processor family has none.
const Kernels* kernels_v2();
const Kernels* kernels_v3();
const Kernels* kernels_v4();

}  // namespace rdm
