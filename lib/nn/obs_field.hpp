// A part of an observation's row, by name.
#pragma once
#include <cstdint>

namespace rdm {

inline constexpr int32_t kMaxFields = 4096;

struct ObsField {
  const char* name;
  int32_t offset, count;
  const char* unit = "";
};

}  // namespace rdm
