#include "nn/mlp.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "nn/kernels.hpp"
#include "nn/scratch.hpp"

namespace rdm {
namespace {

size_t sz(int32_t n) {
  return static_cast<size_t>(n);
}

size_t forward_pack_floats(const MlpShape& shape, int32_t columns) {
  size_t most = 0;
  for (int32_t l = 0; l < shape.num_layers(); ++l)
    most = std::max(most, gemm_pack_floats(shape.layer_out(l), shape.layer_in(l), columns));
  return most;
}

size_t pack_floats(const MlpShape& shape, int32_t rows) {
  size_t most = forward_pack_floats(shape, kPackColumns);
  for (int32_t l = 0; l < shape.num_layers(); ++l)
    most = std::max({most, gemm_pack_floats(shape.layer_in(l), shape.layer_out(l)),
                     gemm_pack_floats(shape.layer_in(l), rows)});
  return most;
}

// C [rows][out] = x W^T of layer l.
GemmArgs times_weights(const MlpShape& shape, int32_t l, const float* w, const float* x, int32_t rows,
                       float* c, float* packed) {
  GemmArgs g;
  g.m = rows, g.n = shape.layer_out(l), g.k = shape.layer_in(l);
  g.a = x, g.a_row = sz(g.k), g.a_col = 1;
  g.b = w, g.b_row = 1, g.b_col = sz(g.k);
  g.c = c;
  g.activation = shape.activation;
  g.packed = packed;
  return g;
}

}  // namespace

size_t MlpShape::weight_offset(int32_t l) const {
  size_t n = 0;
  for (int32_t i = 0; i < l; ++i) n += sz(layer_out(i)) * (sz(layer_in(i)) + 1);
  return n;
}
size_t MlpShape::bias_offset(int32_t l) const {
  return weight_offset(l) + sz(layer_out(l)) * sz(layer_in(l));
}
size_t MlpShape::num_params() const {
  return weight_offset(num_layers());
}

MlpScratch carve_mlp_scratch(Arena& arena, const MlpShape& shape, int32_t rows) {
  MlpScratch s;
  s.rows = rows;
  int32_t widest = 0;
  for (int32_t l = 0; l < shape.num_layers(); ++l) widest = std::max(widest, shape.layer_out(l));
  for (int32_t l = 0; l < shape.num_hidden; ++l)
    s.activation[l] = arena.make<float>(sz(rows) * sz(shape.hidden[l]));
  for (float*& d : s.delta) d = arena.make<float>(sz(rows) * sz(widest));
  for (int32_t l = 0; shape.layer_norm && l < shape.num_hidden; ++l) {
    s.normed[l] = arena.make<float>(sz(rows) * sz(shape.hidden[l]));
    s.inverse[l] = arena.make<float>(sz(rows));
  }
  s.packed = arena.make<float>(pack_floats(shape, rows));
  return s;
}

MlpScratch cut_forward_scratch(ScratchCutter& cutter, const MlpShape& shape, int32_t rows) {
  MlpScratch s;
  s.rows = rows;
  int32_t widest[2] = {0, 0};
  for (int32_t l = 0; l < shape.num_hidden; ++l) widest[l & 1] = std::max(widest[l & 1], shape.hidden[l]);
  float* const rows_of[2] = {cutter.make(sz(rows) * sz(widest[0])), cutter.make(sz(rows) * sz(widest[1]))};
  for (int32_t l = 0; l < shape.num_hidden; ++l) s.activation[l] = rows_of[l & 1];
  s.pack_columns = std::min(rows / kSkinnyRows * kPackStep, kPackColumns);
  s.packed = cutter.make(rows > kSkinnyRows ? forward_pack_floats(shape, s.pack_columns) : 0);
  return s;
}

void pick_columns(const float* x, int32_t rows, int32_t width, const int32_t* columns, int32_t count,
                  float* y) {
  for (size_t r = 0; r < sz(rows); ++r, x += width, y += count)
    for (int32_t i = 0; i < count; ++i) y[i] = x[columns[i]];
}

namespace {

// Sums of a row by eight lanes, so that they do not wait for each other; in a fixed order.
constexpr size_t kLanes = 8;
template <class Term>
float lane_sum(size_t n, Term&& term) {
  float lane[kLanes] = {};
  size_t j = 0;
  for (; j + kLanes <= n; j += kLanes)
    for (size_t k = 0; k < kLanes; ++k) lane[k] += term(j + k);
  for (; j < n; ++j) lane[0] += term(j);
  return ((lane[0] + lane[4]) + (lane[2] + lane[6])) + ((lane[1] + lane[5]) + (lane[3] + lane[7]));
}

// normed [rows][n] of z, and inverse [rows].
void layer_norm(const float* z, int32_t rows, int32_t width, float* normed, float* inverse) {
  const size_t n = sz(width);
  const float share = 1 / static_cast<float>(width);
  for (size_t i = 0; i < sz(rows); ++i, z += n, normed += n) {
    const float mean = share * lane_sum(n, [&](size_t j) { return z[j]; });
    const float variance = share * lane_sum(n, [&](size_t j) { return (z[j] - mean) * (z[j] - mean); });
    const float scale = 1 / std::sqrt(variance + 1e-5f);
    inverse[i] = scale;
    for (size_t j = 0; j < n; ++j) normed[j] = (z[j] - mean) * scale;
  }
}

// d(loss)/dz in the place of d(loss)/d(normed).
void layer_norm_backward(const float* normed, const float* inverse, int32_t rows, int32_t width, float* d) {
  const size_t n = sz(width);
  const float share = 1 / static_cast<float>(width);
  for (size_t i = 0; i < sz(rows); ++i, normed += n, d += n) {
    const float mean = share * lane_sum(n, [&](size_t j) { return d[j]; });
    const float along = share * lane_sum(n, [&](size_t j) { return d[j] * normed[j]; });
    for (size_t j = 0; j < n; ++j) d[j] = inverse[i] * (d[j] - mean - normed[j] * along);
  }
}

}  // namespace

void mlp_forward(const MlpShape& shape, const float* params, const float* x, int32_t rows,
                 const MlpScratch& scratch, float* y) {
  const Kernels& kernel = kernels();
  for (int32_t l = 0; l < shape.num_layers(); ++l) {
    const bool last = l == shape.num_hidden;
    if (last && !y) return;
    float* z = last ? y : scratch.activation[l];
    GemmArgs g = times_weights(shape, l, params + shape.weight_offset(l), x, rows, z, scratch.packed);
    g.bias = params + shape.bias_offset(l);
    g.activate = !last && !shape.layer_norm;
    if (scratch.pack_columns > 0) g.pack_columns = scratch.pack_columns;
    kernel.gemm(g);
    if (!last && shape.layer_norm) {
      const size_t count = sz(rows) * sz(shape.hidden[l]);
      layer_norm(z, rows, shape.hidden[l], scratch.normed[l], scratch.inverse[l]);
      std::copy_n(scratch.normed[l], count, z);
      kernel.activate(shape.activation, z, count);
    }
    x = z;
  }
}

void mlp_tangent(const MlpShape& shape, const float* params, const float* direction, const float* x,
                 int32_t rows, const MlpScratch& scratch, float* dy, int32_t first_input, const float* dx) {
  const Kernels& kernel = kernels();
  int32_t moved = shape.in - first_input;  // inputs of the layer that move
  for (int32_t l = 0; l < shape.num_layers(); ++l) {
    const bool last = l == shape.num_hidden;
    if (last && !dy) return;
    float* dz = last ? dy : scratch.delta[l & 1];
    GemmArgs g = times_weights(shape, l, direction + shape.weight_offset(l), x, rows, dz, scratch.packed);
    if (dx) {
      kernel.gemm(g);
      g.a = dx, g.a_row = sz(moved), g.k = moved;
      g.b = params + shape.weight_offset(l) + shape.layer_in(l) - moved, g.add = true;
    }
    g.bias = direction + shape.bias_offset(l);
    g.slope_of = last ? nullptr : scratch.activation[l];
    kernel.gemm(g);
    x = scratch.activation[l], dx = dz, moved = shape.layer_out(l);
  }
}

namespace {

// C = delta W of layer l, for inputs from `first` on.
GemmArgs times_layer(const MlpShape& shape, int32_t l, const float* params, const float* delta, int32_t rows,
                     int32_t first, float* c, float* packed) {
  GemmArgs d;
  d.m = rows, d.n = shape.layer_in(l) - first, d.k = shape.layer_out(l);
  d.a = delta, d.a_row = sz(d.k), d.a_col = 1;
  d.b = params + shape.weight_offset(l) + first, d.b_row = sz(shape.layer_in(l)), d.b_col = 1;
  d.c = c;
  d.packed = packed;
  return d;
}

// From layer l down, given the derivative by its outputs before their activation.
void backward_from(const MlpShape& shape, int32_t l, const float* params, const float* x, int32_t rows,
                   const MlpScratch& scratch, const float* delta, float* grad, int32_t first_input,
                   float* dx) {
  const Kernels& kernel = kernels();
  for (; l >= 0; --l) {
    const int32_t in = shape.layer_in(l), out = shape.layer_out(l);
    const float* h = l == 0 ? x : scratch.activation[l - 1];
    if (grad) {
      kernel.column_sums(delta, rows, out, grad + shape.bias_offset(l));
      GemmArgs g;  // dW = delta^T h
      g.m = out, g.n = in, g.k = rows;
      g.a = delta, g.a_row = 1, g.a_col = sz(out);
      g.b = h, g.b_row = sz(in), g.b_col = 1;
      g.c = grad + shape.weight_offset(l);
      g.packed = scratch.packed;
      kernel.gemm(g);
    }
    if (l == 0) break;
    // next delta = delta W .* act'(h)
    GemmArgs d = times_layer(shape, l, params, delta, rows, 0, scratch.delta[l & 1], scratch.packed);
    d.slope_of = h;
    d.activation = shape.activation;
    kernel.gemm(d);
    if (shape.layer_norm)
      layer_norm_backward(scratch.normed[l - 1], scratch.inverse[l - 1], rows, shape.hidden[l - 1], d.c);
    delta = d.c;
  }
  if (dx) kernel.gemm(times_layer(shape, 0, params, delta, rows, first_input, dx, scratch.packed));
}

}  // namespace

void mlp_backward(const MlpShape& shape, const float* params, const float* x, int32_t rows,
                  const MlpScratch& scratch, const float* dy, float* grad, int32_t first_input, float* dx) {
  if (rows == 0 && grad) std::fill_n(grad, shape.num_params(), 0.0f);
  backward_from(shape, shape.num_hidden, params, x, rows, scratch, dy, grad, first_input, dx);
}

void mlp_backward_hidden(const MlpShape& shape, const float* params, const float* x, int32_t rows,
                         const MlpScratch& scratch, float* dh, float* grad) {
  const int32_t last = shape.num_hidden - 1;
  if (rows == 0) std::fill_n(grad, shape.weight_offset(shape.num_hidden), 0.0f);
  if (last < 0) return;
  kernels().slope(shape.activation, scratch.activation[last], sz(rows) * sz(shape.hidden[last]), dh);
  backward_from(shape, last, params, x, rows, scratch, dh, grad, 0, nullptr);
}

void mlp_init(const MlpShape& shape, Stream& stream, float last_layer_scale, float* params) {
  for (int32_t l = 0; l < shape.num_layers(); ++l) {
    const double bound = 1 / std::sqrt(static_cast<double>(shape.layer_in(l)));
    const double scale = l == shape.num_hidden ? static_cast<double>(last_layer_scale) * bound : bound;
    for (size_t i = shape.weight_offset(l); i < shape.weight_offset(l + 1); ++i)
      params[i] = static_cast<float>(scale * stream.signed_unit());
  }
}

void check_mlp_shape(const MlpShape& shape) {
  if (shape.num_hidden < 0 || shape.num_hidden > kMaxHidden)
    fail(Code::kRange, "hidden: there are %d layers, but 0 to %d are allowed", shape.num_hidden, kMaxHidden);
  for (int32_t l = 0; l < shape.num_hidden; ++l)
    if (shape.hidden[l] < 1 || shape.hidden[l] > kMaxWidth)
      fail(Code::kRange, "hidden: width %d is outside [1, %d]", shape.hidden[l], kMaxWidth);
  if (shape.in < 1 || shape.in > kMaxInputs)
    fail(Code::kRange, "network inputs: %d is outside [1, %d]", shape.in, kMaxInputs);
  if (shape.out < 1 || shape.out > kMaxWidth)
    fail(Code::kRange, "network outputs: %d is outside [1, %d]", shape.out, kMaxWidth);
  const auto a = static_cast<int32_t>(shape.activation);
  if (a < 0 || a > static_cast<int32_t>(Activation::kRelu))
    fail(Code::kRange, "activation: %d is unknown", a);
}

}  // namespace rdm
