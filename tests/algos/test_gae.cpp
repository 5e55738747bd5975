#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "algos/rollout/gae.hpp"
#include "ranks.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

// One column over horizon x envs with all rows valid and no ends, to be changed by the test.
struct Column {
  int32_t horizon, envs;
  std::vector<float> reward, value, discount, last, advantage, target;
  std::vector<uint8_t> valid;

  Column(int32_t h, int32_t n, float gamma)
      : horizon(h),
        envs(n),
        reward(static_cast<size_t>(h * n)),
        value(reward.size()),
        discount(reward.size(), gamma),
        last(static_cast<size_t>(n)),
        advantage(reward.size()),
        target(reward.size()),
        valid(reward.size(), 1) {}
  void run(double lambda) {
    gae({reward.data(), value.data(), last.data(), advantage.data(), target.data(), 1}, discount.data(),
        valid.data(), horizon, envs, lambda);
  }
};

Column golden(float last) {
  Column c(4, 1, 0.99f);
  c.reward = {1, 0, 2, -1};
  c.value = {.5f, .4f, .3f, .2f};
  c.last = {last};
  return c;
}

void expect_rows(const std::vector<float>& got, const std::vector<double>& wanted) {
  ASSERT_EQ(got.size(), wanted.size());
  for (size_t i = 0; i < got.size(); ++i) EXPECT_FLOAT_EQ(got[i], static_cast<float>(wanted[i])) << i;
}

}  // namespace

// Numbers of an independent double-precision script: gamma 0.99, lambda 0.95.
TEST(Gae, Golden) {
  Column c = golden(0);
  c.run(0.95);
  expect_rows(c.advantage, {1.4796937683, 0.6206207, 0.7694, -1.2});
  for (size_t i = 0; i < 4; ++i) EXPECT_FLOAT_EQ(c.target[i], c.advantage[i] + c.value[i]);
  c = golden(.6f);
  c.run(0.95);
  expect_rows(c.advantage, {1.9738483708, 1.1460376085, 1.328057, -0.606});
}

TEST(Gae, LambdaZeroIsOneStepAndLambdaOneIsTheDiscountedSum) {
  Column c = golden(0);
  c.run(0);
  expect_rows(c.advantage, {1 + .99 * .4 - .5, .99 * .3 - .4, 2 + .99 * .2 - .3, -1 - .2});
  c = golden(0);
  c.value = {0, 0, 0, 0};
  c.run(1);
  expect_rows(c.advantage, {1 + .99 * .99 * 2 - .99 * .99 * .99, .99 * 2 - .99 * .99, 2 - .99, -1});
}

// Two steps, r = (0, 0), V = (1, 1), gamma = lambda = 0.5: the end's value is 5 after a time limit (the
// collector adds gamma 5 to the reward) or at the cut of the epoch, 0 after termination.
TEST(Gae, TerminationTruncationAndCut) {
  Column terminated(2, 1, .5f);
  terminated.value = {1, 1};
  terminated.last = {7};
  terminated.discount = {.5f, 0};
  terminated.run(.5);
  expect_rows(terminated.advantage, {-.75, -1});

  Column truncated = terminated;
  truncated.reward = {0, .5f * 5};
  truncated.run(.5);
  expect_rows(truncated.advantage, {-.125, 1.5});

  Column cut(2, 1, .5f);
  cut.value = {1, 1};
  cut.last = {5};
  cut.run(.5);
  expect_rows(cut.advantage, {-.125, 1.5});
}

TEST(Gae, PathsAndEnvironmentsDoNotMix) {
  Column alone = golden(.6f);
  alone.run(0.95);
  // Environment 1 of 2 holds the golden path behind a terminated step; environment 0 holds large numbers.
  Column both(5, 2, 0.99f);
  for (size_t t = 0; t < 5; ++t) {
    both.reward[2 * t] = 100, both.value[2 * t] = -50;
    both.reward[2 * t + 1] = t ? alone.reward[t - 1] : 3;
    both.value[2 * t + 1] = t ? alone.value[t - 1] : 1;
  }
  both.discount[1] = 0;
  both.last = {1000, .6f};
  both.run(0.95);
  EXPECT_FLOAT_EQ(both.advantage[1], 2);
  for (size_t t = 0; t < 4; ++t) EXPECT_EQ(both.advantage[2 * t + 3], alone.advantage[t]) << t;
}

TEST(Gae, DeadRowsAreZeroAndEndThePathBefore) {
  Column c(3, 1, .5f);
  c.reward = {1, 99, 2};
  c.value = {0, 4, 3};
  c.valid = {1, 0, 1};
  c.run(1);
  expect_rows(c.advantage, {1 + .5 * 4, 0, 2 - 3});
}

TEST(Gae, ValueOfANumberThatIsNotStopsAtTheEndOfThePath) {
  Column c(2, 1, .5f);
  c.discount = {0, .5f};
  c.value = {1, std::numeric_limits<float>::quiet_NaN()};
  c.run(.9);
  EXPECT_FLOAT_EQ(c.advantage[0], -1);
}

TEST(Gae, StrideOfColumns) {
  Column c = golden(.6f);
  c.run(.95);
  std::vector<float> reward(12, 77), value(12, 77), last(3, 77), advantage(12, 77), target(12, 77);
  for (size_t i = 0; i < 4; ++i) reward[3 * i + 1] = c.reward[i], value[3 * i + 1] = c.value[i];
  last[1] = .6f;
  gae({&reward[1], &value[1], &last[1], &advantage[1], &target[1], 3}, c.discount.data(), c.valid.data(), 4,
      1, .95);
  for (size_t i = 0; i < 12; ++i) EXPECT_EQ(advantage[i], i % 3 == 1 ? c.advantage[i / 3] : 77) << i;
}

TEST(Standardize, Golden) {
  std::vector<float> x = {1.4796937683f, 0.6206207f, 0.7694f, -1.2f};
  const std::vector<uint8_t> valid(4, 1);
  std::vector<float> centred = x;
  AloneRanks alone(1);
  const BlockRows rows = {valid.data(), 4, 1};
  standardize(rows, x.data(), 1, true, alone.ranks);
  expect_rows(x, {1.0744687606, 0.2055264123, 0.3560149320, -1.6360101050});
  standardize(rows, centred.data(), 1, false, alone.ranks);
  expect_rows(centred, {1.4796937683 - .4174286171, 0.6206207 - .4174286171, 0.7694 - .4174286171,
                        -1.2 - .4174286171});
}

TEST(Standardize, DeadRowsNeitherCountNorChange) {
  std::vector<float> x = {1, 1000, 3};
  const std::vector<uint8_t> valid = {1, 0, 1};
  AloneRanks alone(1);
  const BlockRows rows = {valid.data(), 3, 1};
  EXPECT_EQ(masked_mean(rows, x.data(), 1, alone.ranks), 2);
  standardize(rows, x.data(), 1, true, alone.ranks);
  expect_rows(x, {-1, 1000, 1});
}

TEST(Standardize, ConstantsAndNothing) {
  std::vector<float> x = {4, 4};
  const std::vector<uint8_t> valid = {1, 1}, none = {0, 0};
  AloneRanks alone(1);
  standardize({valid.data(), 2, 1}, x.data(), 1, true, alone.ranks);
  expect_rows(x, {0, 0});
  x = {4, 5};
  standardize({none.data(), 2, 1}, x.data(), 1, true, alone.ranks);
  expect_rows(x, {4, 5});
  EXPECT_EQ(masked_mean({none.data(), 2, 1}, x.data(), 1, alone.ranks), 0);
}

// Rows of environments 0 and 1 are one block's, those of 2 and 3 the other's; the mean is of all.
TEST(Standardize, BlocksAreParts) {
  std::vector<float> x = {1, 2, 3, 4, 5, 6, 7, 8}, same = x;
  const std::vector<uint8_t> valid = {1, 1, 0, 1, 1, 1, 1, 1};
  const BlockRows rows = {valid.data(), 2, 4};
  AloneRanks one(4), two(4, 2);
  EXPECT_FLOAT_EQ(static_cast<float>(masked_mean(rows, x.data(), 1, two.ranks)), 33.0f / 7);
  standardize(rows, x.data(), 1, true, one.ranks);
  standardize(rows, same.data(), 1, true, two.ranks);
  for (size_t i = 0; i < x.size(); ++i) EXPECT_FLOAT_EQ(x[i], same[i]);
}
