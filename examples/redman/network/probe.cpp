#include "network/probe.hpp"

#include <redman/memory.hpp>
#include <redman/sense.hpp>

#include "common/scatter.hpp"

namespace tool {
namespace {

// Plain uniform numbers: splitmix64.
float signed_unit(uint64_t& state) {
  const uint64_t bits = scattered(state);
  state += 0x9e3779b97f4a7c15u;
  return static_cast<float>(bits >> 40) * 0x1p-23f - 1;
}

}  // namespace

std::vector<float> probe_observations(const Network& network, size_t rows, uint64_t seed) {
  const auto in = static_cast<size_t>(network.obs_dim);
  const NamedTensor *shift = network.find("normalizer.shift"), *scale = network.find("normalizer.scale");
  std::vector<float> obs(rows * in);
  for (size_t i = 0; i < obs.size(); ++i) {
    const float x = signed_unit(seed) * (i / in % 10 == 9 ? 30.0f : 2.0f);
    obs[i] = shift ? shift->values[i % in] + x / scale->values[i % in] : x;
  }
  return obs;
}

Clouds probe_clouds(const Network& network, size_t rows, uint64_t seed) {
  const Eyes& eyes = network.eyes;
  Clouds clouds;
  const size_t count = rows * static_cast<size_t>(eyes.points);
  clouds.points.resize(3 * count);
  clouds.classes.resize(eyes.points ? count : 0);
  seed ^= 0x5851f42d4c957f2du;
  for (size_t i = 0; i < clouds.points.size(); ++i)
    clouds.points[i] = eyes.origin[i % 3] + 2 * eyes.range * signed_unit(seed);
  for (size_t i = 0; i < clouds.classes.size() && eyes.classes; ++i)
    clouds.classes[i] = static_cast<uint8_t>((i * 7 + i / 5) % static_cast<size_t>(eyes.classes));
  clouds.colors.resize(3 * clouds.classes.size());
  for (size_t i = 0; i < clouds.colors.size(); ++i) clouds.colors[i] = static_cast<uint8_t>(i * 89 % 256);
  return clouds;
}

std::vector<float> mean_actions(const redman::Policy& policy, const std::vector<float>& obs,
                                const Clouds& clouds) {
  const rdm_policy_info& info = policy.info();
  const size_t rows = obs.size() / static_cast<size_t>(info.obs_dim);
  const auto count = static_cast<int32_t>(rows);
  std::vector<float> action(rows * static_cast<size_t>(info.action_dim));
  struct alignas(64) Line {  // std::aligned_alloc is missing on Windows
    unsigned char bytes[64];
  };
  const size_t bytes = policy.scratch_bytes(count);
  std::vector<Line> scratch((bytes + sizeof(Line) - 1) / sizeof(Line));
  std::vector<float> state;
  for (size_t row = 0; info.state_dim > 0 && row < rows; ++row) {
    if (row % kProbeEpisode == 0) state = redman::start(policy, 1);
    const float* const seen = obs.data() + row * static_cast<size_t>(info.obs_dim);
    float* const to = action.data() + row * static_cast<size_t>(info.action_dim);
    const size_t first = row * static_cast<size_t>(info.num_points);
    if (info.num_points == 0)
      redman::act(policy, seen, state.data(), 1, nullptr, to, scratch.data(), bytes);
    else
      redman::act(policy, seen,
                  redman::points(clouds.points.data() + 3 * first, info.num_points,
                                 clouds.classes.data() + first, clouds.colors.data() + 3 * first),
                  state.data(), 1, nullptr, to);
  }
  if (info.state_dim > 0) return action;
  if (info.num_points == 0)
    policy.act(obs.data(), count, nullptr, action.data(), scratch.data(), bytes);
  else
    redman::act(
        policy, obs.data(),
        redman::points(clouds.points.data(), info.num_points, clouds.classes.data(), clouds.colors.data()),
        count, nullptr, action.data(), scratch.data(), bytes);
  return action;
}

}  // namespace tool
