#include <cmath>

#include "agents.hpp"
#include "algos/rollout/noise.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

struct Source {
  AgentSetup setup;
  ResolvedAgentConfig resolved;
  Arena arena;
  Noise noise;
  explicit Source(const char* correlation, uint64_t seed = 1)
      : setup("ppo", 3, 4, 3),
        resolved(resolve_config(setup.with("noise_correlation", correlation).ready())) {
    Arena measure;
    noise.carve(measure, resolved);
    arena = Arena(host(), measure.used());
    noise.carve(arena, resolved);
    noise.reset(seed);
  }
};

}  // namespace

TEST(Noise, StationaryDeviationAndCorrelation) {
  Source s("0.6");
  const float share = std::exp(s.resolved.log_share), mean[4] = {1, -2, 0, 3};
  EXPECT_FLOAT_EQ(share, 0.8f);
  float std[4];
  for (int j = 0; j < 4; ++j) std[j] = 0.5f * share;
  const int count = 20000;
  double sum = 0, squares = 0, products = 0, n = 0;
  float action[4], centered[4], before[4] = {};
  for (int i = 0; i < count; ++i) {
    s.noise.sample(0, mean, std, action, centered);
    for (int j = 0; j < 4; ++j) {
      const float noise = action[j] - mean[j];
      // What is left after the offset is the innovation.
      EXPECT_NEAR(centered[j], action[j] - 0.6f * before[j], 1e-5);
      if (i > 50) {
        sum += static_cast<double>(noise), squares += static_cast<double>(noise * noise);
        products += static_cast<double>(noise * before[j]), n += 1;
      }
      before[j] = noise;
    }
  }
  // Standard errors with correlation 0.6 at n = 80,000: mean 0.0035, variance 0.0018.
  EXPECT_NEAR(sum / n, 0, 0.014);
  EXPECT_NEAR(squares / n, 0.25, 0.008);
  EXPECT_NEAR(products / squares, 0.6, 0.02);
}

TEST(Noise, EpisodesBeginWithoutOffset) {
  Source s("0.9");
  const float mean[4] = {}, std[4] = {1, 1, 1, 1};
  float action[4], centered[4];
  s.noise.sample(1, mean, std, action, centered);
  s.noise.sample(1, mean, std, action, centered);
  EXPECT_NE(action[0], centered[0]);
  s.noise.end_episode(1);
  s.noise.sample(1, mean, std, action, centered);
  for (int j = 0; j < 4; ++j) EXPECT_EQ(action[j], centered[j]);
}

TEST(Noise, EnvironmentsAndSeedsDiffer) {
  Source a("0"), b("0"), c("0", 2);
  const float mean[4] = {}, std[4] = {1, 1, 1, 1};
  float first[4], second[4], other[4], seed[4], scratch[4];
  a.noise.sample(0, mean, std, first, scratch);
  b.noise.sample(0, mean, std, second, scratch);
  a.noise.sample(1, mean, std, other, scratch);
  c.noise.sample(0, mean, std, seed, scratch);
  for (int j = 0; j < 4; ++j) {
    EXPECT_EQ(first[j], second[j]);
    EXPECT_NE(first[j], other[j]);
    EXPECT_NE(first[j], seed[j]);
  }
}
