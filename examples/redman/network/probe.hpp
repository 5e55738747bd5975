// What a policy does on random observations: the measure of every other form of it.
#pragma once
#include "network/network.hpp"

namespace tool {

// [rows][obs_dim] in the normaliser's range, two deviations to each side, and every tenth row far outside it.
std::vector<float> probe_observations(const Network& network, size_t rows, uint64_t seed);

// Clouds beside rows, of a policy with eyes; else empty.
struct Clouds {
  std::vector<float> points;     // [rows][eyes.points][3] m
  std::vector<uint8_t> classes;  // [rows][eyes.points]
  std::vector<uint8_t> colors;   // [rows][eyes.points][3]
};
// As many as rows, within twice the encoder's range about its origin.
Clouds probe_clouds(const Network& network, size_t rows, uint64_t seed);

// Decisions in a row of a policy with a memory: at every row whose number is a multiple of this it begins anew.
inline constexpr size_t kProbeEpisode = 1000;

// [rows][action_dim] mean actions.
std::vector<float> mean_actions(const redman::Policy& policy, const std::vector<float>& obs,
                                const Clouds& clouds);

}  // namespace tool
