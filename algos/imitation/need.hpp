// What a call is given, against its bounds.
#pragma once
#include "base/error.hpp"
#include "base/text.hpp"

namespace rdm {

// Error(kRange) with the name unless low <= value <= high.
inline void need(const char* name, double value, double low, double high) {
  if (!(value >= low && value <= high))
    fail(Code::kRange, "%s: %s is outside [%s, %s]", name, Number(value).text, Number(low).text,
         Number(high).text);
}

}  // namespace rdm
