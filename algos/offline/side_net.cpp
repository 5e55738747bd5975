#include "algos/offline/side_net.hpp"

#include <cmath>
#include <cstdio>

#include "algos/off_policy/q_critic.hpp"

namespace rdm {

void SideNet::carve(Arena& arena, const MlpShape& of, int32_t rows) {
  shape = of;
  const size_t size = shape.num_params();
  for (float** all : {&params, &grad, &part}) *all = arena.make<float>(size);
  adam = carve_adam(arena, size);
  scratch = carve_mlp_scratch(arena, shape, rows);
}

void SideNet::open(uint64_t seed, uint32_t stream, float scale) {
  Stream first(seed, stream, Purpose::kInit);
  mlp_init(shape, first, scale, params);
}

void SideNet::backward(const float* x, int32_t rows, const float* dy, bool begins, int32_t dx_first,
                       float* dx) {
  mlp_backward(shape, params, x, rows, scratch, dy, begins ? grad : part, dx_first, dx);
  const size_t size = begins ? 0 : adam.size;
  for (size_t i = 0; i < size; ++i) grad[i] += part[i];
}

void SideNet::step(double rate, double max_norm) {
  skipped += !std::isfinite(adam_step(adam, params, grad, rate, max_norm));
}

void SideNet::visit(StateIo& io, double bound) {
  io.counter(skipped);
  const StateView<float> p = io.numbers(params, adam.size, -kMaxQOutput, kMaxQOutput);
  if (p)
    io.require(mlp_bound(shape, StateNumbers{p}, bound) <= 1e9, "a network whose outputs may be too large");
  io.counter(adam.t);
  const StateView<float> m = io.numbers(adam.m, adam.size, -1e20, 1e20),
                         v = io.numbers(adam.v, adam.size, 0, 1e38);
  if (m) io.require(moments_agree(m, v, adam.size), "moments that no gradients can give");
}

bool SideNet::tensor(int32_t index, const char* prefix, char* name, TensorInfo* out) const {
  if (index < 0 || index >= num_tensors()) return false;
  const int32_t l = index / 2;
  const bool weight = index % 2 == 0;
  std::snprintf(name, kTensorNameSize, "%s.%d.%s", prefix, l, weight ? "weight" : "bias");
  *out = {name, shape.layer_out(l), weight ? shape.layer_in(l) : 1,
          params + (weight ? shape.weight_offset(l) : shape.bias_offset(l))};
  return true;
}

}  // namespace rdm
