// What a call is given, against its bounds.
#pragma once
#include "base/error.hpp"

namespace rdm {

// Error(kRange) with the name unless low <= value <= high.
inline void need(const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high))
    fail(Code::kRange, "%s: %g is outside [%g, %g]", name, value, low, high);
}

}  // namespace rdm
