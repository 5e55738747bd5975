// Whether the algorithm with this place in the list has an option of this name.
#pragma once
#include <redman/redman.h>

#include <cstring>

inline bool has_option(int32_t algo, const char* key) {
  rdm_option_spec o{};
  o.struct_size = sizeof o;
  for (int32_t i = 0; rdm_algo_option_at(algo, i, &o) == RDM_OK; ++i)
    if (std::strcmp(o.key, key) == 0) return true;
  return false;
}

inline bool has_option(const char* algo, const char* key) {
  int32_t index = 0;
  return rdm_algo_find(algo, &index) == RDM_OK && has_option(index, key);
}
