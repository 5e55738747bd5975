// A list in an order drawn from a stream (Fisher and Yates; Durstenfeld 1964).
#pragma once
#include <cstdint>
#include <utility>

#include "base/rng.hpp"

namespace rdm {

inline void shuffle(Stream& stream, int32_t* list, int32_t count) {
  for (int32_t i = count - 1; i > 0; --i)
    std::swap(list[i], list[stream.below(static_cast<uint32_t>(i) + 1)]);
}

}  // namespace rdm
