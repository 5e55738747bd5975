#include "nn/mlp.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "nn/scratch.hpp"

namespace rdm {
namespace {

float activate(Activation a, float z) {
  switch (a) {
    case Activation::kTanh:
      return std::tanh(z);
    case Activation::kElu:
      return z > 0 ? z : std::expm1(z);
    case Activation::kRelu:
      return z > 0 ? z : 0;
  }
  return z;
}

// Derivative by the activation's own value h.
float slope(Activation a, float h) {
  switch (a) {
    case Activation::kTanh:
      return 1 - h * h;
    case Activation::kElu:
      return h > 0 ? 1 : h + 1;
    case Activation::kRelu:
      return h > 0 ? 1 : 0;
  }
  return 1;
}

size_t sz(int32_t n) {
  return static_cast<size_t>(n);
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
  s.packed = arena.make<float>(16);
  return s;
}

MlpScratch cut_forward_scratch(ScratchCutter& cutter, const MlpShape& shape, int32_t rows) {
  MlpScratch s;
  s.rows = rows;
  int32_t widest[2] = {0, 0};
  for (int32_t l = 0; l < shape.num_hidden; ++l) widest[l & 1] = std::max(widest[l & 1], shape.hidden[l]);
  float* const rows_of[2] = {cutter.make(sz(rows) * sz(widest[0])), cutter.make(sz(rows) * sz(widest[1]))};
  for (int32_t l = 0; l < shape.num_hidden; ++l) s.activation[l] = rows_of[l & 1];
  s.packed = cutter.make(16);
  return s;
}

void mlp_forward(const MlpShape& shape, const float* params, const float* x, int32_t rows,
                 const MlpScratch& scratch, float* y) {
  const float* h = x;
  for (int32_t l = 0; l < shape.num_layers(); ++l) {
    const int32_t in = shape.layer_in(l), out = shape.layer_out(l);
    const bool last = l == shape.num_hidden;
    float* z = last ? y : scratch.activation[l];
    const float *w = params + shape.weight_offset(l), *b = params + shape.bias_offset(l);
    for (int32_t r = 0; r < rows; ++r)
      for (int32_t o = 0; o < out; ++o) {
        float sum = b[o];
        for (int32_t i = 0; i < in; ++i) sum += h[sz(r) * sz(in) + sz(i)] * w[sz(o) * sz(in) + sz(i)];
        z[sz(r) * sz(out) + sz(o)] = last ? sum : activate(shape.activation, sum);
      }
    h = z;
  }
}

void mlp_tangent(const MlpShape& shape, const float* params, const float* direction, const float* x,
                 int32_t rows, const MlpScratch& scratch, float* dy) {
  const float *h = x, *dh = nullptr;
  for (int32_t l = 0; l < shape.num_layers(); ++l) {
    const int32_t in = shape.layer_in(l), out = shape.layer_out(l);
    const bool last = l == shape.num_hidden;
    float* dz = last ? dy : scratch.delta[l & 1];
    const float *w = params + shape.weight_offset(l), *v = direction + shape.weight_offset(l),
                *c = direction + shape.bias_offset(l);
    for (int32_t r = 0; r < rows; ++r)
      for (int32_t o = 0; o < out; ++o) {
        float sum = c[o];
        for (int32_t i = 0; i < in; ++i) {
          sum += h[sz(r) * sz(in) + sz(i)] * v[sz(o) * sz(in) + sz(i)];
          if (dh) sum += dh[sz(r) * sz(in) + sz(i)] * w[sz(o) * sz(in) + sz(i)];
        }
        const size_t at = sz(r) * sz(out) + sz(o);
        dz[at] = last ? sum : sum * slope(shape.activation, scratch.activation[l][at]);
      }
    h = last ? nullptr : scratch.activation[l];
    dh = dz;
  }
}

void mlp_backward(const MlpShape& shape, const float* params, const float* x, int32_t rows,
                  const MlpScratch& scratch, const float* dy, float* grad) {
  const float* delta = dy;
  std::memset(grad, 0, shape.num_params() * sizeof(float));
  for (int32_t l = shape.num_hidden; l >= 0; --l) {
    const int32_t in = shape.layer_in(l), out = shape.layer_out(l);
    const float* h = l == 0 ? x : scratch.activation[l - 1];
    const float* w = params + shape.weight_offset(l);
    float *dw = grad + shape.weight_offset(l), *db = grad + shape.bias_offset(l);
    float* next = l == 0 ? nullptr : scratch.delta[l & 1];
    for (int32_t r = 0; r < rows; ++r) {
      const float* d = delta + sz(r) * sz(out);
      for (int32_t o = 0; o < out; ++o) {
        db[o] += d[o];
        for (int32_t i = 0; i < in; ++i) dw[sz(o) * sz(in) + sz(i)] += d[o] * h[sz(r) * sz(in) + sz(i)];
      }
      for (int32_t i = 0; next && i < in; ++i) {
        float sum = 0;
        for (int32_t o = 0; o < out; ++o) sum += d[o] * w[sz(o) * sz(in) + sz(i)];
        next[sz(r) * sz(in) + sz(i)] = sum * slope(shape.activation, h[sz(r) * sz(in) + sz(i)]);
      }
    }
    delta = next;
  }
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
    fail(Code::kRange, "hidden: %d layers, 0 to %d are allowed", shape.num_hidden, kMaxHidden);
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

const char* kernel_isa() {
  return "x86-64-v2";
}
bool set_kernel_isa(const char* name) {
  return std::strcmp(name, "x86-64-v2") == 0;
}

}  // namespace rdm
