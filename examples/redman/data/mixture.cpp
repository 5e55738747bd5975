#include "data/mixture.hpp"

#include <algorithm>

#include "common/scatter.hpp"

namespace tool {
namespace {

constexpr float kSlow = 0.9f, kSlowFresh = 0.43588989f;

}  // namespace

const std::vector<Source>& mixture_of(bool has_policy) {
  static const std::vector<Source> with = {
      {"policy", 6, Base::kPolicy, 1, 0, 0, 0, 1},
      {"policy, noise 0.1", 4, Base::kPolicy, 1, 0, 0.1f, 0, 1},
      {"policy, noise 0.3", 5, Base::kPolicy, 1, 0, 0.3f, 0, 1},
      {"policy, noise 0.6", 4, Base::kPolicy, 1, 0, 0.6f, 0, 1},
      {"policy, slow noise 0.4", 4, Base::kPolicy, 1, 0, 0.4f, kSlow, kSlowFresh},
      {"policy, drift 0.3", 4, Base::kPolicy, 1, 0.3f, 0.1f, 0, 1},
      {"policy x 0.5", 2, Base::kPolicy, 0.5f, 0, 0.1f, 0, 1},
      {"policy x 1.5", 3, Base::kPolicy, 1.5f, 0, 0.1f, 0, 1},
      {"policy x 3", 3, Base::kPolicy, 3, 0, 0.1f, 0, 1},
      {"uniform", 2, Base::kUniform, 0, 0, 0, 0, 1},
      {"slow noise", 1, Base::kZero, 0, 0, 0.7f, kSlow, kSlowFresh},
      {"hold", 1, Base::kHold, 1, 0, 0, 0, 1},
      {"zero", 1, Base::kZero, 0, 0, 0, 0, 1}};
  static const std::vector<Source> without = {{"uniform", 10, Base::kUniform, 0, 0, 0, 0, 1},
                                              {"slow noise", 10, Base::kZero, 0, 0, 0.7f, kSlow, kSlowFresh},
                                              {"drift", 8, Base::kZero, 0, 0.7f, 0.2f, 0, 1},
                                              {"hold, noise 0.3", 6, Base::kHold, 1, 0, 0.3f, 0, 1},
                                              {"hold", 3, Base::kHold, 1, 0, 0, 0, 1},
                                              {"zero", 3, Base::kZero, 0, 0, 0, 0, 1}};
  return has_policy ? with : without;
}

size_t source_of(const std::vector<Source>& mixture, uint64_t episode) {
  auto place = static_cast<int32_t>(17 * (episode % kPlaces) % kPlaces);
  size_t at = 0;
  while (place >= mixture[at].places) place -= mixture[at++].places;
  return at;
}

size_t policy_of(uint64_t episode, size_t policies) {
  return policies ? static_cast<size_t>(episode / kPlaces % policies) : 0;
}

uint64_t EpisodeNoise::bits() {
  return scattered(counter_++);
}

// The sum of twelve whole numbers of 16 bits.
float EpisodeNoise::normal() {
  int32_t sum = 0;
  for (int i = 0; i < 3; ++i)
    for (uint64_t b = bits(), k = 0; k < 4; ++k) sum += static_cast<int32_t>(b >> (16 * k) & 0xffff);
  return static_cast<float>(sum - 6 * 65535) / 65536.0f;
}

float EpisodeNoise::uniform() {
  return static_cast<float>(static_cast<int32_t>(bits() >> 40) - (1 << 23)) / 8388608.0f;
}

void EpisodeNoise::begin(uint64_t seed, uint64_t episode, const Source& source, size_t width) {
  counter_ = scattered(scattered(seed) ^ episode);
  source_ = source;
  drift_.assign(width, 0.0f);
  noise_.assign(width, 0.0f);
  if (source.drift > 0)
    for (float& d : drift_) d = source.drift * normal();
  if (source.keep > 0)
    for (float& n : noise_) n = normal();
}

void EpisodeNoise::apply(float* row, float* label) {
  for (size_t j = 0; j < drift_.size(); ++j) {
    const float base = source_.base == Base::kUniform ? uniform() : row[j];
    const float meant = source_.base == Base::kUniform ? base : source_.gain * base;
    label[j] = std::clamp(meant, -1.0f, 1.0f);
    if (source_.std > 0) noise_[j] = source_.keep * noise_[j] + source_.fresh * normal();
    row[j] = std::clamp(label[j] + drift_[j] + source_.std * noise_[j], -1.0f, 1.0f);
  }
}

}  // namespace tool
