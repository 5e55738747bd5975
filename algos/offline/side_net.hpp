// A network of an algorithm's own.
#pragma once
#include "algos/core/resolved_config.hpp"
#include "algos/core/state_io.hpp"
#include "nn/adam.hpp"
#include "nn/mlp.hpp"

namespace rdm {

// Parameters with their gradient and Adam.
struct SideNet {
  MlpShape shape;
  float *params = nullptr, *grad = nullptr, *part = nullptr;
  Adam adam;
  MlpScratch scratch;
  int64_t skipped = 0;

  void carve(Arena& arena, const MlpShape& of, int32_t rows);
  void open(uint64_t seed, uint32_t stream, float scale);
  void forward(const float* x, int32_t rows, float* y) { mlp_forward(shape, params, x, rows, scratch, y); }
  // Behind `forward` of the same x: begins the gradient or adds to it; dx of inputs from dx_first on, or null.
  void backward(const float* x, int32_t rows, const float* dy, bool begins, int32_t dx_first = 0,
                float* dx = nullptr);
  void step(double rate, double max_norm);
  void visit(StateIo& io, double bound);
  int32_t num_tensors() const { return 2 * shape.num_layers(); }
  // PREFIX.0.weight, PREFIX.0.bias, ...; name [kTensorNameSize].
  bool tensor(int32_t index, const char* prefix, char* name, TensorInfo* out) const;
};

}  // namespace rdm
