// `data make`: plays a mixture of policies until there are enough rows, to the same bytes on any machine.
#pragma once
#include <string>
#include <vector>

#include "common/setup.hpp"
#include "data/set.hpp"

namespace tool {

struct MakeSettings {
  PoolSettings pool;
  std::vector<std::string> policies, sets;  // words of --policy; empty: the bundled one, where there is one
  const char* published = nullptr;          // the name of the published set that it is like
  std::vector<double> limits;               // at which its policies are judged; empty: from the task's
  uint64_t rows = 100000;
};
// Whole episodes, at least so many rows.
DataSet make_set(const MakeSettings& settings);

}  // namespace tool
