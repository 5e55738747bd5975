// Gated recurrent unit (Cho et al. 2014, arXiv 1406.1078, eq. 5 to 8), over steps of rows, and a perceptron that
// has one before its last layer.
//
//   r = s(Wr x + br + Ur h + cr)         what of the state the candidate sees, s(v) = 1 / (1 + e^-v)
//   z = s(Wz x + bz + Uz h + cz)         what of the state stays
//   n = tanh(Wn x + bn + r (Un h + cn))  the candidate
//   h' = z h + (1 - z) n = n + z (h - n)
//
// Cho et al. have no biases, and n = tanh(Wn x + Un (r h)): r is applied behind the product here, as in cuDNN and
// torch.nn.GRU, so that one product of the state serves all three. Parameters: W [3 units][in], b [3 units], U
// [3 units][units], c [3 units], gates in the order r, z, n.
//
// Steps stand one behind the other: entry (step, row) of an array is row step rows + row. Where `clear` is not 0
// the state before that step is zeros, and nothing flows back over it.
#pragma once
#include "nn/mlp.hpp"

namespace rdm {

class ScratchCutter;

inline constexpr int kMaxUnits = 1024;

struct GruShape {
  int32_t in = 0, units = 0;  // units 0: there is none

  size_t input_bias_offset() const { return 3 * cells() * static_cast<size_t>(in); }
  size_t state_offset() const { return input_bias_offset() + 3 * cells(); }
  size_t state_bias_offset() const { return state_offset() + 3 * cells() * cells(); }
  size_t num_params() const { return units ? state_bias_offset() + 3 * cells() : 0; }

 private:
  size_t cells() const { return static_cast<size_t>(units); }
};

// Workspace of one thread for so many steps times rows. What a backward pass needs stays in it.
struct GruScratch {
  float *gates = nullptr, *state_part = nullptr;  // [][3 units] r, z, n; what the state gives
  float* before = nullptr;                        // [][units] the state before each step
  float* carry = nullptr;                         // [rows][units] of the backward pass, or of a tangent
  float *gates_moved = nullptr,
        *state_moved = nullptr;  // as the two above, of a tangent; null: there are none
  float *pack_input = nullptr, *pack_state = nullptr;
};
GruScratch carve_gru_scratch(Arena& arena, const GruShape& shape, int32_t rows, bool tangents = false);

// h [steps][rows][units] of x [steps][rows][in], from h0 [rows][units]; clear [steps][rows] or null. h may be h0
// where there is one step.
void gru_forward(const GruShape& shape, const float* params, const float* x, int32_t steps, int32_t rows,
                 const float* h0, const uint8_t* clear, const GruScratch& scratch, float* h);
// grad [num_params] and dx [steps][rows][in] (null: not wanted) are overwritten with the derivatives of a loss with
// dh [steps][rows][units] = d(loss)/dh, of the last forward pass, which it spoils. h0 is a constant.
void gru_backward(const GruShape& shape, const float* params, const float* x, int32_t steps, int32_t rows,
                  const uint8_t* clear, const GruScratch& scratch, const float* dh, float* grad, float* dx);
// dh [steps][rows][units] along a direction of the parameters and dx [steps][rows][in] of the inputs (null: they do
// not move), of the last forward pass, which it leaves as it is. h0 is a constant. Scratch with tangents.
void gru_tangent(const GruShape& shape, const float* params, const float* direction, const float* x,
                 const float* dx, int32_t steps, int32_t rows, const uint8_t* clear,
                 const GruScratch& scratch, float* dh);
// Weights and biases ~ U(-1/sqrt(units), 1/sqrt(units)), but those of Wz x + bz: bz = log u, u ~ U(1, span - 1), with
// which a unit at rest keeps its state for 2 to `span` steps, 1 / (1 - s(bz)) = 1 + u (Tallec and Ollivier 2018, arXiv
// 1804.11188, "chrono"). With bz about 0 it keeps half of it, and of `span` = 20 steps ago 2e-6: no gradient reaches
// back. span below 3: 2.
void gru_init(const GruShape& shape, Stream& stream, int32_t span, float* params);

// Hidden layers, then a GRU, then the last layer; without units the perceptron alone. Parameters in that order.
struct RecurrentShape {
  MlpShape mlp;
  GruShape gru;

  size_t gru_offset() const { return gru.units ? mlp.weight_offset(mlp.num_hidden) : mlp.num_params(); }
  size_t head_offset() const { return gru_offset() + gru.num_params(); }
  MlpShape head() const {
    MlpShape s;
    s.in = gru.units, s.out = mlp.out, s.activation = mlp.activation;
    return s;
  }
  size_t num_params() const { return gru.units ? head_offset() + head().num_params() : mlp.num_params(); }
};
// The GRU of so many units that stands before the last layer.
RecurrentShape with_gru(const MlpShape& mlp, int32_t units);

struct RecurrentScratch {
  GruScratch gru;
  float *h = nullptr, *dh = nullptr;  // [][units]
  float* pack_head = nullptr;
};
RecurrentScratch carve_recurrent_scratch(Arena& arena, const RecurrentShape& shape, int32_t rows,
                                         bool tangents = false);
// Enough for one forward step at a time.
RecurrentScratch cut_recurrent_scratch(ScratchCutter& cutter, const RecurrentShape& shape, int32_t rows);

// y [steps][rows][out], and the states in scratch.h; `layers` for as many rows in all.
void recurrent_forward(const RecurrentShape& shape, const float* params, const float* x, int32_t steps,
                       int32_t rows, const float* h0, const uint8_t* clear, const MlpScratch& layers,
                       const RecurrentScratch& scratch, float* y);
// grad [num_params] is overwritten, given dy [steps][rows][out] of the last forward pass over the same x.
void recurrent_backward(const RecurrentShape& shape, const float* params, const float* x, int32_t steps,
                        int32_t rows, const uint8_t* clear, const MlpScratch& layers,
                        const RecurrentScratch& scratch, const float* dy, float* grad);
// dy [steps][rows][out] along a direction of the parameters, of the last forward pass over the same x, which it leaves
// as it is.
void recurrent_tangent(const RecurrentShape& shape, const float* params, const float* direction,
                       const float* x, int32_t steps, int32_t rows, const uint8_t* clear,
                       const MlpScratch& layers, const RecurrentScratch& scratch, float* dy);
void recurrent_init(const RecurrentShape& shape, Stream& stream, float last_layer_scale, int32_t span,
                    float* params);

// As mlp_bound: states are within +-1.
template <class Params>
double recurrent_bound(const RecurrentShape& s, const Params& params, double bound) {
  if (!s.gru.units) return mlp_bound(s.mlp, params, bound);
  struct Part {
    const Params& all;
    size_t at;
    auto operator[](size_t i) const { return all[at + i]; }
  };
  const auto part_bound = [&](const MlpShape& shape, size_t at, double inputs) {
    return mlp_bound(shape, Part{params, at}, inputs);
  };
  MlpShape layer = s.head();
  double most = part_bound(layer, s.head_offset(), 1);
  layer.in = s.gru.units, layer.out = 3 * s.gru.units;
  most = std::max(most, part_bound(layer, s.gru_offset() + s.gru.state_offset(), 1));
  double inputs = bound;
  if (s.mlp.num_hidden > 0) {
    MlpShape hidden = s.mlp;
    hidden.out = hidden.hidden[--hidden.num_hidden];
    inputs = part_bound(hidden, 0, bound);
    most = std::max(most, inputs);
  }
  layer.in = s.gru.in;
  return std::max(most, part_bound(layer, s.gru_offset(), inputs));
}

}  // namespace rdm
