#include "nn/gru.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/elementary.hpp"
#include "nn/kernels.hpp"
#include "nn/scratch.hpp"

namespace rdm {
namespace {

size_t sz(int32_t n) {
  return static_cast<size_t>(n);
}

// C [rows][out] = x W^T + bias.
GemmArgs layer_product(const float* x, int32_t rows, int32_t in, const float* w, const float* bias,
                       int32_t out, float* c, float* packed) {
  GemmArgs g;
  g.m = rows, g.n = out, g.k = in;
  g.a = x, g.a_row = sz(in), g.a_col = 1;
  g.b = w, g.b_row = 1, g.b_col = sz(in);
  g.c = c;
  g.bias = bias;
  g.packed = packed;
  return g;
}

// dW [out][in] = delta^T x.
void weight_gradient(const float* delta, int32_t rows, int32_t out, const float* x, int32_t in, float* packed,
                     float* grad) {
  GemmArgs g;
  g.m = out, g.n = in, g.k = rows;
  g.a = delta, g.a_row = 1, g.a_col = sz(out);
  g.b = x, g.b_row = sz(in), g.b_col = 1;
  g.c = grad;
  g.packed = packed;
  kernels().gemm(g);
}

// C [rows][in] = or += delta W.
GemmArgs input_gradient(const float* delta, int32_t rows, int32_t out, const float* w, int32_t in, float* c,
                        float* packed) {
  GemmArgs g;
  g.m = rows, g.n = in, g.k = out;
  g.a = delta, g.a_row = sz(out), g.a_col = 1;
  g.b = w, g.b_row = sz(in), g.b_col = 1;
  g.c = c;
  g.packed = packed;
  return g;
}

size_t backward_pack_floats(int32_t in, int32_t out) {
  return std::max({gemm_pack_floats(out, in), gemm_pack_floats(in, out), gemm_pack_floats(in, kPackDepth)});
}

}  // namespace

GruScratch carve_gru_scratch(Arena& arena, const GruShape& shape, int32_t rows, bool tangents) {
  GruScratch s;
  const size_t n = sz(rows), units = sz(shape.units);
  s.gates = arena.make<float>(n * 3 * units);
  s.state_part = arena.make<float>(n * 3 * units);
  s.before = arena.make<float>(n * units);
  s.carry = arena.make<float>(n * units);
  for (float** moved : {&s.gates_moved, &s.state_moved})
    if (tangents) *moved = arena.make<float>(n * 3 * units);
  s.pack_input = arena.make<float>(backward_pack_floats(shape.in, 3 * shape.units));
  s.pack_state = arena.make<float>(backward_pack_floats(shape.units, 3 * shape.units));
  return s;
}

void gru_forward(const GruShape& shape, const float* params, const float* x, int32_t steps, int32_t rows,
                 const float* h0, const uint8_t* clear, const GruScratch& scratch, float* h) {
  const Kernels& kernel = kernels();
  const int32_t gates = 3 * shape.units;
  const size_t units = sz(shape.units), block = sz(rows) * units;
  kernel.gemm(layer_product(x, steps * rows, shape.in, params, params + shape.input_bias_offset(), gates,
                            scratch.gates, scratch.pack_input));
  // The panels of one step serve the next, where a product leaves all of them.
  const bool stays = rows > kSkinnyRows && gates > kDotColumns && packs_whole(gates, shape.units);
  for (int32_t s = 0; s < steps; ++s) {
    const size_t at = sz(s) * block;
    float* const before = scratch.before + at;
    std::copy_n(s == 0 ? h0 : h + at - block, block, before);
    for (size_t r = 0; clear && r < sz(rows); ++r)
      if (clear[sz(s) * sz(rows) + r]) std::fill_n(before + r * units, units, 0.0f);
    GemmArgs g = layer_product(before, rows, shape.units, params + shape.state_offset(),
                               params + shape.state_bias_offset(), gates, scratch.state_part + 3 * at,
                               scratch.pack_state);
    g.is_packed = stays && s > 0;
    kernel.gemm(g);
    kernel.gru_gates(scratch.state_part + 3 * at, before, rows, shape.units, scratch.gates + 3 * at, h + at);
  }
}

void gru_backward(const GruShape& shape, const float* params, const float* x, int32_t steps, int32_t rows,
                  const uint8_t* clear, const GruScratch& scratch, const float* dh, float* grad, float* dx) {
  const Kernels& kernel = kernels();
  const int32_t gates = 3 * shape.units, all = steps * rows;
  const size_t units = sz(shape.units), block = sz(rows) * units;
  float* const carry = scratch.carry;
  std::fill_n(carry, block, 0.0f);
  const bool stays = rows > kSkinnyRows && packs_whole(shape.units, gates);
  for (int32_t s = steps; s-- > 0;) {
    const size_t at = sz(s) * block;
    // carry = d(loss)/d(state before the step): through the gates, then through the state's product
    kernel.gru_slopes(scratch.before + at, dh + at, rows, shape.units, scratch.gates + 3 * at,
                      scratch.state_part + 3 * at, carry);
    GemmArgs g = input_gradient(scratch.state_part + 3 * at, rows, gates, params + shape.state_offset(),
                                shape.units, carry, scratch.pack_state);
    g.add = true;
    g.is_packed = stays && s < steps - 1;
    kernel.gemm(g);
    for (size_t r = 0; clear && r < sz(rows); ++r)
      if (clear[sz(s) * sz(rows) + r]) std::fill_n(carry + r * units, units, 0.0f);
  }
  kernel.column_sums(scratch.gates, all, gates, grad + shape.input_bias_offset());
  kernel.column_sums(scratch.state_part, all, gates, grad + shape.state_bias_offset());
  weight_gradient(scratch.gates, all, gates, x, shape.in, scratch.pack_input, grad);
  weight_gradient(scratch.state_part, all, gates, scratch.before, shape.units, scratch.pack_state,
                  grad + shape.state_offset());
  if (dx) kernel.gemm(input_gradient(scratch.gates, all, gates, params, shape.in, dx, scratch.pack_input));
}

void gru_tangent(const GruShape& shape, const float* params, const float* direction, const float* x,
                 const float* dx, int32_t steps, int32_t rows, const uint8_t* clear,
                 const GruScratch& scratch, float* dh) {
  const Kernels& kernel = kernels();
  const int32_t gates = 3 * shape.units, all = steps * rows;
  const size_t units = sz(shape.units), block = sz(rows) * units;
  // C = x D^T + dbias + dx W^T, D and dbias of the direction
  const auto moved = [&](const float* in, const float* din, int32_t n, int32_t width, size_t weights,
                         size_t bias, float* out, float* packed) {
    GemmArgs g = layer_product(in, n, width, direction + weights, din ? nullptr : direction + bias, gates,
                               out, packed);
    kernel.gemm(g);
    if (!din) return;
    g = layer_product(din, n, width, params + weights, direction + bias, gates, out, packed);
    g.add = true;
    kernel.gemm(g);
  };
  moved(x, dx, all, shape.in, 0, shape.input_bias_offset(), scratch.gates_moved, scratch.pack_input);
  for (int32_t s = 0; s < steps; ++s) {
    const size_t at = sz(s) * block;
    float* const dbefore = scratch.carry;
    if (s > 0) std::copy_n(dh + at - block, block, dbefore);
    for (size_t r = 0; s > 0 && clear && r < sz(rows); ++r)
      if (clear[sz(s) * sz(rows) + r]) std::fill_n(dbefore + r * units, units, 0.0f);
    if (s == 0) std::fill_n(dbefore, block, 0.0f);
    moved(scratch.before + at, s > 0 ? dbefore : nullptr, rows, shape.units, shape.state_offset(),
          shape.state_bias_offset(), scratch.state_moved, scratch.pack_state);
    kernel.gru_tangents(scratch.state_part + 3 * at, scratch.before + at, scratch.gates + 3 * at, rows,
                        shape.units, scratch.gates_moved + 3 * at, scratch.state_moved, dbefore, dh + at);
  }
}

void gru_init(const GruShape& shape, Stream& stream, int32_t span, float* params) {
  const double bound = 1 / std::sqrt(static_cast<double>(shape.units));
  for (size_t i = 0; i < shape.num_params(); ++i)
    params[i] = static_cast<float>(bound * stream.signed_unit());
  float* const keep = params + shape.input_bias_offset() + shape.units;
  for (int32_t i = 0; i < shape.units; ++i)
    keep[i] = static_cast<float>(elementary::log(1 + std::max(span - 2, 0) * stream.uniform()));
}

RecurrentShape with_gru(const MlpShape& mlp, int32_t units) {
  return {mlp, {units ? mlp.layer_in(mlp.num_hidden) : 0, units}};
}

RecurrentScratch carve_recurrent_scratch(Arena& arena, const RecurrentShape& shape, int32_t rows,
                                         bool tangents) {
  RecurrentScratch s;
  const size_t n = sz(rows) * sz(shape.gru.units);
  s.gru = carve_gru_scratch(arena, shape.gru, rows, tangents);
  s.h = arena.make<float>(n);
  s.dh = arena.make<float>(n);
  s.pack_head = arena.make<float>(backward_pack_floats(shape.gru.units, shape.mlp.out));
  return s;
}

RecurrentScratch cut_recurrent_scratch(ScratchCutter& cutter, const RecurrentShape& shape, int32_t rows) {
  RecurrentScratch s;
  const GruShape& gru = shape.gru;
  if (!gru.units) return s;
  const size_t n = sz(rows), units = sz(gru.units);
  const auto pack = [&](int32_t out, int32_t in) {
    return cutter.make(rows > kSkinnyRows ? gemm_pack_floats(out, in) : 0);
  };
  s.gru.gates = cutter.make(n * 3 * units);
  s.gru.state_part = cutter.make(n * 3 * units);
  s.gru.before = cutter.make(n * units);
  s.h = cutter.make(n * units);
  s.gru.pack_input = pack(3 * gru.units, gru.in);
  s.gru.pack_state = pack(3 * gru.units, gru.units);
  s.pack_head = pack(shape.mlp.out, gru.units);
  return s;
}

void recurrent_forward(const RecurrentShape& shape, const float* params, const float* x, int32_t steps,
                       int32_t rows, const float* h0, const uint8_t* clear, const MlpScratch& layers,
                       const RecurrentScratch& scratch, float* y) {
  const int32_t hidden = shape.mlp.num_hidden;
  mlp_forward(shape.mlp, params, x, steps * rows, layers, nullptr);
  const float* seen = hidden ? layers.activation[hidden - 1] : x;
  gru_forward(shape.gru, params + shape.gru_offset(), seen, steps, rows, h0, clear, scratch.gru, scratch.h);
  const MlpShape head = shape.head();
  const float* weights = params + shape.head_offset();
  kernels().gemm(layer_product(scratch.h, steps * rows, head.in, weights, weights + head.bias_offset(0),
                               head.out, y, scratch.pack_head));
}

void recurrent_backward(const RecurrentShape& shape, const float* params, const float* x, int32_t steps,
                        int32_t rows, const uint8_t* clear, const MlpScratch& layers,
                        const RecurrentScratch& scratch, const float* dy, float* grad) {
  if (rows == 0) return std::fill_n(grad, shape.num_params(), 0.0f), void();
  const Kernels& kernel = kernels();
  const int32_t hidden = shape.mlp.num_hidden, all = steps * rows;
  const MlpShape head = shape.head();
  const float* weights = params + shape.head_offset();
  float* const head_grad = grad + shape.head_offset();
  kernel.column_sums(dy, all, head.out, head_grad + head.bias_offset(0));
  weight_gradient(dy, all, head.out, scratch.h, head.in, scratch.pack_head, head_grad);
  kernel.gemm(input_gradient(dy, all, head.out, weights, head.in, scratch.dh, scratch.pack_head));
  float* const dx = hidden ? layers.delta[hidden & 1] : nullptr;
  gru_backward(shape.gru, params + shape.gru_offset(), hidden ? layers.activation[hidden - 1] : x, steps,
               rows, clear, scratch.gru, scratch.dh, grad + shape.gru_offset(), dx);
  mlp_backward_hidden(shape.mlp, params, x, all, layers, dx, grad);
}

void recurrent_tangent(const RecurrentShape& shape, const float* params, const float* direction,
                       const float* x, int32_t steps, int32_t rows, const uint8_t* clear,
                       const MlpScratch& layers, const RecurrentScratch& scratch, float* dy) {
  const int32_t hidden = shape.mlp.num_hidden, all = steps * rows;
  mlp_tangent(shape.mlp, params, direction, x, all, layers, nullptr);
  gru_tangent(shape.gru, params + shape.gru_offset(), direction + shape.gru_offset(),
              hidden ? layers.activation[hidden - 1] : x, hidden ? layers.delta[(hidden - 1) & 1] : nullptr,
              steps, rows, clear, scratch.gru, scratch.dh);
  const MlpShape head = shape.head();
  const float *weights = params + shape.head_offset(), *to = direction + shape.head_offset();
  GemmArgs g = layer_product(scratch.h, all, head.in, to, nullptr, head.out, dy, scratch.pack_head);
  kernels().gemm(g);
  g = layer_product(scratch.dh, all, head.in, weights, to + head.bias_offset(0), head.out, dy,
                    scratch.pack_head);
  g.add = true;
  kernels().gemm(g);
}

void recurrent_init(const RecurrentShape& shape, Stream& stream, float last_layer_scale, int32_t span,
                    float* params) {
  if (!shape.gru.units) return mlp_init(shape.mlp, stream, last_layer_scale, params);
  for (int32_t l = 0; l < shape.mlp.num_hidden; ++l) {
    const double bound = 1 / std::sqrt(static_cast<double>(shape.mlp.layer_in(l)));
    for (size_t i = shape.mlp.weight_offset(l); i < shape.mlp.weight_offset(l + 1); ++i)
      params[i] = static_cast<float>(bound * stream.signed_unit());
  }
  gru_init(shape.gru, stream, span, params + shape.gru_offset());
  mlp_init(shape.head(), stream, last_layer_scale, params + shape.head_offset());
}

}  // namespace rdm
