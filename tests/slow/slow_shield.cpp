// A million control steps of random actions in each hand task, and not one that costs: under a shield.
#include <string>

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
  rdm_shield_config s = shield_config(pool);
  s.policy = policy.get();
  const Shield shield = shield_of(s);
  const rdm_buffers b = buffers_of(pool.get());
  auto stats = RDM_INIT(rdm_pool_stats);
  while (stats.steps < kSteps) {
    ASSERT_EQ(rdm_pool_baseline(pool.get(), RDM_BASELINE_RANDOM), RDM_OK);
    ASSERT_EQ(rdm_shield_act(shield.get(), pool.get(), nullptr, b.action, b.action), RDM_OK)
        << rdm_shield_error(shield.get());
    ASSERT_EQ(rdm_pool_step(pool.get()), RDM_OK);
    ASSERT_EQ(rdm_pool_get_stats(pool.get(), &stats), RDM_OK);
    ASSERT_EQ(stats.violations, 0) << "after " << stats.steps << " control steps";
  }
  const rdm_shield_stats done = stats_of(shield);
  EXPECT_EQ(done.unproven, 0);
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
