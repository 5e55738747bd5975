// A million control steps of random actions in each hand task under a shield, and not one that costs in an episode for whose
// start a plan was found. Starts without one are reorient's alone: its egg may be about to roll off.
#include <string>
#include <vector>

#include "policies.hpp"
#include "shields.hpp"

namespace {

constexpr int64_t kSteps = 1'000'000;
constexpr int32_t kEnvs = 64, kHeld = 8;  // control steps for which an action is held, so that it has effects

class ShieldedTask : public testing::TestWithParam<const char*> {};

TEST_P(ShieldedTask, NeverCostsUnderRandomActions) {
  const std::string task = GetParam();
  // what never moves drops reorient's egg: there the shipped policy, at its own pace, is the backup
  const bool needs_policy = task == "reorient";
  const std::string settings = "action_repeat=" + std::to_string(needs_policy ? 3 : kHeld);
  rdm_pool_config c = pool_config(kEnvs);
  c.task = task.c_str();
  c.settings = settings.c_str();
  c.num_threads = 2;
  const Pool pool(make_pool(c));
  ASSERT_EQ(rdm_pool_reset(pool.get(), nullptr, nullptr), RDM_OK);
  const Policy policy = needs_policy ? shipped(task) : Policy();
  rdm_shield_config s = shield_config(pool, "unproven=least");
  s.policy = policy.get();
  const Shield shield = shield_of(s);
  const rdm_buffers b = buffers_of(pool.get());
  const auto costs = static_cast<size_t>(spec_of(pool.get()).cost_dim);
  std::vector<int32_t> kinds(kEnvs);
  std::vector<uint8_t> planned(kEnvs, 1);  // in all decisions of the episode so far
  int64_t episodes = 0, without = 0;
  auto stats = RDM_INIT(rdm_pool_stats);
  while (stats.steps < kSteps) {
    ASSERT_EQ(rdm_pool_baseline(pool.get(), RDM_BASELINE_RANDOM), RDM_OK);
    ASSERT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, b.action, b.action), RDM_OK)
        << rdm_shield_error(shield.get());
    ASSERT_EQ(rdm_shield_get_kinds(shield.get(), kinds.data()), RDM_OK);
    ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
    ASSERT_EQ(rdm_pool_get_stats(pool.get(), &stats), RDM_OK);
    for (size_t i = 0; i < kEnvs; ++i) {
      planned[i] = planned[i] && kinds[i] != RDM_SHIELD_UNPROVEN;
      ASSERT_FALSE(planned[i] && b.cost[i * costs] > 0) << "world " << i << ", " << stats.steps << " steps";
      if (!b.terminated[i] && !b.truncated[i]) continue;
      ++episodes;
      without += !planned[i];
      planned[i] = 1;
    }
  }
  const rdm_shield_stats done = stats_of(shield);
  if (!needs_policy) {
    EXPECT_EQ(done.unproven, 0);
    EXPECT_EQ(stats.violations, 0);
  }
  EXPECT_LT(static_cast<double>(without), 0.05 * static_cast<double>(episodes));
  std::printf("%s: %lld of %lld episodes without a plan, %lld violating steps\n", task.c_str(),
              static_cast<long long>(without), static_cast<long long>(episodes),
              static_cast<long long>(stats.violations));
  std::printf("%s: %lld control steps, %lld decisions, %lld refused, %.1f copied a step\n", task.c_str(),
              static_cast<long long>(stats.steps), static_cast<long long>(done.decisions),
              static_cast<long long>(done.changed + done.planned),
              static_cast<double>(done.copied) / static_cast<double>(stats.steps));
}

INSTANTIATE_TEST_SUITE_P(Hands, ShieldedTask,
                         testing::Values("hand_over_safe_finger", "hand_over_safe_joint",
                                         "catch_underarm_safe_finger", "catch_underarm_safe_joint", "grasp",
                                         "reorient", "hand_over_wall", "jenga", "pick_bottles",
                                         "clean_house"),
                         [](const auto& i) { return std::string(i.param); });

}  // namespace
