// Built with either half switched off, too: every function is there, and those of the missing half say so.
#include <gtest/gtest.h>
#include <redman/redman.h>

#include <cstring>
#include <string>

namespace {

bool has(uint32_t half) {
  return (rdm_features() & half) != 0;
}

TEST(Halves, SimulationIsThereOrSaysThatItIsNot) {
  rdm_pool_config config;
  ASSERT_EQ(rdm_pool_config_init(&config, sizeof config), RDM_OK);
  if (has(RDM_FEATURE_SIM)) {
    EXPECT_GT(rdm_task_count(), 0);
    EXPECT_GT(rdm_robot_count(), 0);
    EXPECT_GT(rdm_object_count(), 0);
    return;
  }
  EXPECT_EQ(rdm_task_count(), 0);
  EXPECT_EQ(rdm_robot_count(), 0);
  EXPECT_EQ(rdm_object_count(), 0);
  config.task = "hand_over_safe_finger";
  config.num_envs = 1;
  rdm_pool* pool = nullptr;
  size_t ours = 0, engines = 0;
  EXPECT_EQ(rdm_pool_create(&pool, &config), RDM_ERROR_UNSUPPORTED);
  EXPECT_NE(std::string(rdm_last_error()).find("simulation"), std::string::npos) << rdm_last_error();
  EXPECT_EQ(pool, nullptr);
  EXPECT_EQ(rdm_pool_config_memory(&config, &ours, &engines), RDM_ERROR_UNSUPPORTED);
  char text[64] = "";
  config.error = text;
  config.error_size = sizeof text;
  EXPECT_EQ(rdm_pool_create(&pool, &config), RDM_ERROR_UNSUPPORTED);
  EXPECT_STREQ(text, "this build was made without the simulation half");
  EXPECT_EQ(rdm_pool_step(nullptr), RDM_ERROR_UNSUPPORTED);
  EXPECT_EQ(rdm_pool_render(nullptr, 0, "front", 8, 8, nullptr, nullptr, nullptr), RDM_ERROR_UNSUPPORTED);
  rdm_pool_destroy(nullptr);
}

TEST(Halves, LearningIsThereOrSaysThatItIsNot) {
  rdm_agent_config config;
  ASSERT_EQ(rdm_agent_config_init(&config, sizeof config), RDM_OK);
  if (has(RDM_FEATURE_LEARN)) {
    EXPECT_GT(rdm_algo_count(), 0);
    config.algo = "ppo";
    config.obs_dim = 3;
    config.action_dim = 1;
    config.num_envs = 2;
    rdm_agent* agent = nullptr;
    ASSERT_EQ(rdm_agent_create(&agent, &config), RDM_OK) << rdm_last_error();
    const float obs[6] = {};
    float action[2] = {9, 9};
    EXPECT_EQ(rdm_agent_act(agent, obs, RDM_ACT_MEAN, action), RDM_OK);
    EXPECT_LT(action[0], 9);
    rdm_agent_destroy(agent);
    return;
  }
  EXPECT_EQ(rdm_algo_count(), 0);
  rdm_policy* policy = nullptr;
  EXPECT_EQ(rdm_policy_read(&policy, "x", 1), RDM_ERROR_UNSUPPORTED);
  EXPECT_NE(std::string(rdm_last_error()).find("learning"), std::string::npos) << rdm_last_error();
  EXPECT_EQ(policy, nullptr);
  EXPECT_EQ(rdm_policy_scratch(nullptr, 1), 0u);
  EXPECT_EQ(rdm_agent_update(nullptr, nullptr, nullptr), RDM_ERROR_UNSUPPORTED);
  rdm_agent_cancel(nullptr);
  rdm_agent_destroy(nullptr);
  rdm_policy_destroy(nullptr);
}

TEST(Halves, TheBuildDescribesItself) {
  rdm_build build;
  build.struct_size = sizeof build;
  ASSERT_EQ(rdm_build_info(&build), RDM_OK);
  EXPECT_EQ(build.abi, static_cast<uint32_t>(RDM_ABI));
  EXPECT_EQ(std::strlen(build.ode) > 0, has(RDM_FEATURE_SIM));
  EXPECT_EQ(std::strlen(build.ccd) > 0, has(RDM_FEATURE_SIM));
  EXPECT_GT(std::strlen(build.eigen), 0u);
  EXPECT_GT(std::strlen(build.compiler), 0u);
}

}  // namespace
