// Published data sets of safe learning from data whose tasks have worlds here: their names, and the lengths and limits
// that their figures are for.
#pragma once
#include <string>
#include <vector>

#include "common/setup.hpp"

namespace tool {

struct Published {
  const char *name, *task;
  int32_t max_steps;  // control steps, one a row
  double limits[3];   // at which policies are judged
};
// DSRL (Liu et al. 2024, "Datasets and benchmarks for offline safe reinforcement learning").
const std::vector<Published>& published_dsrl();
// By its name or by the name of its task; null: none.
const Published* find_published(const std::string& name);
Options options_of(const Published& set);

}  // namespace tool
