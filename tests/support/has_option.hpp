// Whether the algorithm with this place in the list, or of this name, has an option. A list that cannot be read ends the test.
#pragma once
#include <redman/redman.h>

#include <cstdlib>
#include <cstring>

inline bool has_option(int32_t algo, const char* key) {
  rdm_algo info{};
  info.struct_size = sizeof info;
  if (rdm_algo_at(algo, &info) != RDM_OK) std::abort();
  for (int32_t i = 0; i < info.num_options; ++i) {
    rdm_option_spec o{};
    o.struct_size = sizeof o;
    if (rdm_algo_option_at(algo, i, &o) != RDM_OK) std::abort();
    if (std::strcmp(o.key, key) == 0) return true;
  }
  return false;
}

inline bool has_option(const char* algo, const char* key) {
  int32_t index = 0;
  if (rdm_algo_find(algo, &index) != RDM_OK) std::abort();
  return has_option(index, key);
}
