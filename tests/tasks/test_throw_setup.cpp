#include <algorithm>
#include <cmath>

#include "tasks/catalog.hpp"
#include "tasks/throw/throw_setup.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

// exp(-0.2 (50 d + theta)), ReDMan eq. (B1) with alpha = 50, worked out to four digits.
TEST(ThrowSetup, RewardTable) {
  const double theta[] = {0, 0.5, 1.57, 2.2, 3.14};
  const struct {
    double d, r[5];
  } rows[] = {{0, {1.0000, 0.9048, 0.7305, 0.6440, 0.5337}},
              {0.02, {0.8187, 0.7408, 0.5981, 0.5273, 0.4369}},
              {0.05, {0.6065, 0.5488, 0.4431, 0.3906, 0.3237}},
              {0.10, {0.3679, 0.3329, 0.2687, 0.2369, 0.1963}},
              {0.25, {0.0821, 0.0743, 0.0600, 0.0529, 0.0438}}};
  for (const auto& row : rows)
    for (int i = 0; i < 5; ++i)
      EXPECT_NEAR(throw_reward({row.d, theta[i]}), row.r[i], 1e-4) << row.d << theta[i];
  EXPECT_DOUBLE_EQ(throw_reward({0.1, 1}, 20, 5), 5 * std::exp(-0.2 * (20 * 0.1 + 1)));
}

TEST(ThrowSetup, SuccessNeedsConsecutiveSteps) {
  ThrowSetup g{};
  g.success_distance = 0.05;
  g.success_steps = 3;
  ThrowState s{};
  EXPECT_FALSE(count_success(g, 0.04, &s));
  EXPECT_FALSE(count_success(g, 0.05, &s));
  EXPECT_FALSE(count_success(g, 0.06, &s));
  EXPECT_FALSE(count_success(g, 0.01, &s));
  EXPECT_FALSE(count_success(g, 0.01, &s));
  EXPECT_TRUE(count_success(g, 0.01, &s));
  EXPECT_TRUE(count_success(g, 0.01, &s));
  EXPECT_FALSE(count_success(g, 0.2, &s));
}

class ThrowReset : public testing::Test {
 protected:
  void SetUp() override { register_builtin_tasks(); }
};

TEST_F(ThrowReset, RewardOptionsReachTheStep) {
  const auto reward = [](std::vector<OptionInput> options) {
    options.push_back({"start_rotation", "fixed", 0});
    TestPool p("hand_over_safe_finger", 1, options);
    p->reset(nullptr, nullptr);
    p->step(nullptr);
    return static_cast<double>(p.rows().reward[0]);
  };
  const double plain = reward({}), free = reward({{"ignore_rotation", "true", 0}});
  EXPECT_GT(free, plain);
  EXPECT_NEAR(reward({{"reward_scale", nullptr, 5}}), 5 * plain, 1e-6);
  EXPECT_NEAR(reward({{"ignore_rotation", "true", 0}, {"alpha", nullptr, 0}}), 1, 1e-6);
}

}  // namespace
}  // namespace rdm::test
