// Cutting of workspaces out of memory that is not an arena's: the caller's scratch of a policy.
#pragma once
#include <cstdint>

#include "base/arena.hpp"
#include "nn/mlp.hpp"

namespace rdm {

// Hands out 64-byte aligned pieces; with null memory it only counts.
class ScratchCutter {
 public:
  explicit ScratchCutter(void* memory) : memory_(static_cast<unsigned char*>(memory)) {}

  float* make(size_t count) {
    const size_t at = used_;
    used_ += Arena::padded(count * sizeof(float));
    return memory_ ? reinterpret_cast<float*>(memory_ + at) : nullptr;
  }
  size_t used() const { return used_; }

 private:
  unsigned char* memory_;
  size_t used_ = 0;
};

// Scratch that is enough for mlp_forward alone: layers two apart share their rows, and few rows pack little.
MlpScratch cut_forward_scratch(ScratchCutter& cutter, const MlpShape& shape, int32_t rows);

// The first 64-byte boundary at or after p.
inline float* align_scratch(float* p) {
  const auto at = reinterpret_cast<uintptr_t>(p);
  return p + (Arena::kAlign - at % Arena::kAlign) % Arena::kAlign / sizeof(float);
}

}  // namespace rdm
