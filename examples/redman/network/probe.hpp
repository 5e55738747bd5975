// What a policy does on random observations: the measure of every other form of it.
#pragma once
#include "network/network.hpp"

namespace tool {

// [rows][obs_dim] in the normaliser's range, two deviations to each side, and every tenth row far outside it.
std::vector<float> probe_observations(const Network& network, size_t rows, uint64_t seed);
// [rows][action_dim] mean actions.
std::vector<float> mean_actions(const redman::Policy& policy, const std::vector<float>& obs);

}  // namespace tool
