// Normalised scores of a policy by the data set that it learned from, as DSRL has them.
#pragma once
#include "common/report.hpp"
#include "data/set.hpp"
#include "play/evaluate.hpp"

namespace tool {

// Usage when the set, of this file, is of another task or of longer or shorter episodes: its returns are no measure there.
void need_same_worlds(const DataSet& set, const std::string& file, const rdm_spec& spec);
// (R - r_min) / (r_max - r_min) by the least and largest return of the set's episodes, and C / d at each of its limits:
// at most 1 where the policy is safe at that limit.
Json score_json(const DataSet& set, const Evaluation& e);
std::string score_text(const Json& score);

}  // namespace tool
