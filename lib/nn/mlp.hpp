// Multilayer perceptron: forward and backward over batches, parameters in one flat float vector.
//
// A batch is row-major, one row per sample. All memory comes from the caller; nothing is allocated.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "base/arena.hpp"
#include "base/rng.hpp"

namespace rdm {

enum class Activation : int32_t { kTanh = 0, kElu = 1, kRelu = 2 };

inline constexpr int kMaxHidden = 4;
inline constexpr int kMaxWidth = 4096;  // of a hidden layer and of the output
inline constexpr int kMaxInputs = 65536;

struct MlpShape {
  int32_t in = 0, out = 0;
  int32_t num_hidden = 0;
  int32_t hidden[kMaxHidden] = {};
  Activation activation = Activation::kTanh;
  // Each hidden layer's sums z are normalised before the activation, (z - mean z) / sqrt(var z + 1e-5), a row by
  // itself (Ba, Kiros and Hinton 2016), without a scale and a shift of their own. Not with cut_forward_scratch and
  // mlp_tangent.
  bool layer_norm = false;

  int32_t num_layers() const { return num_hidden + 1; }
  int32_t layer_in(int32_t l) const { return l == 0 ? in : hidden[l - 1]; }
  int32_t layer_out(int32_t l) const { return l == num_hidden ? out : hidden[l]; }
  // Per layer: weight [layer_out][layer_in] row-major, then bias [layer_out].
  size_t weight_offset(int32_t l) const;
  size_t bias_offset(int32_t l) const;
  size_t num_params() const;
};
// Error(kRange) for a count, width or activation outside the bounds above.
void check_mlp_shape(const MlpShape& shape);

// Bound on the magnitude of every sum within a network whose inputs are within +-bound: layer by layer the
// largest sum of a row's magnitudes. params[i] is the i-th.
template <class Params>
double mlp_bound(const MlpShape& s, const Params& params, double bound) {
  double most = bound;
  for (int32_t l = 0; l < s.num_layers(); ++l) {
    const auto rows = static_cast<size_t>(s.layer_out(l)), cols = static_cast<size_t>(s.layer_in(l));
    double widest = 0;
    for (size_t i = 0; i < rows; ++i) {
      double sum = 0;
      for (size_t j = 0; j < cols; ++j)
        sum += std::abs(static_cast<double>(params[s.weight_offset(l) + i * cols + j]));
      widest = std::max(widest, bound * sum + std::abs(static_cast<double>(params[s.bias_offset(l) + i])));
    }
    most = std::max(most, widest);
    if (s.layer_norm) widest = std::sqrt(static_cast<double>(rows));
    bound = s.activation == Activation::kTanh ? 1 : std::max(1.0, widest);
  }
  return most;
}

// Workspace of one thread for batches of up to `rows` rows.
struct MlpScratch {
  int32_t rows = 0;
  float* activation[kMaxHidden + 1] = {};  // [rows][layer_out(l)], hidden layers after their activation
  float* delta[2] = {};                    // [rows][widest layer], ping and pong
  float* normed[kMaxHidden] = {};          // with layer_norm: [rows][layer_out(l)] before the activation
  float* inverse[kMaxHidden] = {};         // [rows] 1 / sqrt(var + 1e-5)
  int32_t pack_columns = 0;                // of a matrix product at a time; 0: as many as are fastest
  float* packed = nullptr;                 // panels of the matrix products
  float* picked = nullptr;                 // [rows][in], of a caller whose rows are wider than the network
};
MlpScratch carve_mlp_scratch(Arena& arena, const MlpShape& shape, int32_t rows);

// y [rows][count] of the listed entries of x [rows][width].
void pick_columns(const float* x, int32_t rows, int32_t width, const int32_t* columns, int32_t count,
                  float* y);

// y = net(x). x [rows][in], y [rows][out]; hidden activations stay in the scratch for the backward pass. y
// null: the hidden layers alone.
void mlp_forward(const MlpShape& shape, const float* params, const float* x, int32_t rows,
                 const MlpScratch& scratch, float* y);

// grad [num_params] (null: not wanted) is overwritten with d(loss)/d(params), given dy = d(loss)/dy [rows][out] of the last
// forward pass over the same x. Sums over rows are taken in a fixed order. dx [rows][in - first_input], null:
// not wanted, becomes d(loss)/dx of the inputs from first_input on.
void mlp_backward(const MlpShape& shape, const float* params, const float* x, int32_t rows,
                  const MlpScratch& scratch, const float* dy, float* grad, int32_t first_input = 0,
                  float* dx = nullptr);
// The same of the hidden layers alone, given dh = d(loss)/d(values of the last one), which it overwrites; dh
// may be scratch.delta[num_hidden & 1]. The last layer's entries of grad stay as they are.
void mlp_backward_hidden(const MlpShape& shape, const float* params, const float* x, int32_t rows,
                         const MlpScratch& scratch, float* dh, float* grad);

// dy = (d net / d params) direction, rows of the same x as the last forward pass: the tangent half of a
// Fisher-vector product (mlp_backward is the other half). direction [num_params], dy [rows][out]; null: the
// hidden layers alone, of which the last one's stays in scratch.delta[(num_hidden - 1) & 1]. dx [rows][in -
// first_input]: how the inputs from first_input on move along with it; null: none does.
void mlp_tangent(const MlpShape& shape, const float* params, const float* direction, const float* x,
                 int32_t rows, const MlpScratch& scratch, float* dy, int32_t first_input = 0,
                 const float* dx = nullptr);

// Kaiming-uniform with a = sqrt(5): weight and bias ~ U(-1/sqrt(fan_in), 1/sqrt(fan_in)); the last layer's
// weights and bias are scaled by last_layer_scale.
void mlp_init(const MlpShape& shape, Stream& stream, float last_layer_scale, float* params);

}  // namespace rdm
