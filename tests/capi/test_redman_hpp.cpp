// redman.hpp: owners, views and exceptions over the C ABI.
#include <gtest/gtest.h>

#include <cstring>
#include <redman/redman.hpp>
#include <type_traits>
#include <utility>
#include <vector>

namespace {

constexpr const char* kTask = "hand_over_safe_finger";

TEST(RedmanHpp, OwnersMoveAndDoNotCopy) {
  EXPECT_FALSE(std::is_copy_constructible_v<redman::Pool>);
  EXPECT_FALSE(std::is_copy_constructible_v<redman::Agent>);
  EXPECT_FALSE(std::is_copy_constructible_v<redman::Policy>);
  redman::Pool a(redman::pool_config(kTask, 2));
  rdm_pool* handle = a.get();
  redman::Pool b = std::move(a);
  EXPECT_EQ(b.get(), handle);
  EXPECT_EQ(a.get(), nullptr);
  b.reset();
  b.step();
}

TEST(RedmanHpp, ErrorsCarryCodeAndText) {
  try {
    redman::Pool pool(redman::pool_config("hand_over_safe_fingr"));
    FAIL() << "a pool of an unknown task";
  } catch (const redman::Error& e) {
    EXPECT_EQ(e.code(), RDM_ERROR_NOT_FOUND);
    EXPECT_NE(std::string(e.what()).find(kTask), std::string::npos) << e.what();
  }
  redman::Pool pool(redman::pool_config(kTask));
  try {
    pool.step();
    FAIL() << "a step before the first reset";
  } catch (const redman::Error& e) {
    EXPECT_EQ(e.code(), RDM_ERROR_STATE);
    EXPECT_STREQ(e.what(), rdm_pool_error(pool.get()));
  }
  EXPECT_THROW(redman::Policy(redman::Bytes(10)), redman::Error);
}

TEST(RedmanHpp, PicturesOfNoSizeAreErrorsOfTheLibrary) {
  redman::Pool pool(redman::pool_config(kTask));
  const int32_t sizes[][2] = {
      {-1, 8}, {8, -1}, {0, 8}, {8, 0}, {INT32_MIN, INT32_MIN}, {8193, 1}, {INT32_MAX, INT32_MAX}};
  for (const auto& s : sizes) {
    try {
      pool.render(0, "front", s[0], s[1]);
      FAIL() << s[0] << ' ' << s[1];
    } catch (const redman::Error& e) {
      EXPECT_EQ(e.code(), RDM_ERROR_RANGE) << e.what();
    }
  }
  EXPECT_EQ(pool.render(0, "front", 4, 3).size(), 36u);
}

TEST(RedmanHpp, ViewsAreTheBuffers) {
  redman::Pool pool(redman::pool_config(kTask, 3));
  pool.reset();
  const rdm_buffers& b = pool.buffers();
  const auto width = static_cast<size_t>(pool.spec().obs_dim);
  EXPECT_EQ(pool.num_envs(), 3u);
  EXPECT_EQ(pool.obs().width(), width);
  EXPECT_EQ(pool.obs()[2].data(), b.obs + 2 * width);
  EXPECT_EQ(pool.obs()[2].size(), width);
  EXPECT_EQ(pool.reward().size(), 3u);
  EXPECT_EQ(pool.cost()[1].data(), b.cost + pool.spec().cost_dim);
  for (float& a : pool.action()[1]) a = 0.25f;
  EXPECT_EQ(b.action[pool.spec().action_dim], 0.25f);
}

TEST(RedmanHpp, BoundMemoryShowsInTheViews) {
  redman::Pool pool(redman::pool_config(kTask));
  std::vector<float> reward(1);
  auto b = redman::sized<rdm_buffers>();
  b.reward = reward.data();
  pool.bind(b);
  EXPECT_EQ(pool.reward().data(), reward.data());
}

TEST(RedmanHpp, StatesOfOneWorldAndOfAllGoRound) {
  redman::Pool pool(redman::pool_config(kTask, 2));
  pool.reset();
  const redman::Bytes all = pool.state(), one = pool.state(1);
  const uint64_t hash = pool.hash(), hash_of_one = pool.hash(1);
  pool.baseline(RDM_BASELINE_RANDOM);
  pool.step();
  EXPECT_NE(pool.hash(1), hash_of_one);
  pool.set_state(one, 1);
  EXPECT_EQ(pool.hash(1), hash_of_one);
  EXPECT_NE(pool.hash(), hash);
  pool.set_state(all);
  EXPECT_EQ(pool.hash(), hash);
}

TEST(RedmanHpp, PoolLiesInMemoryThatIsLent) {
  const rdm_pool_config config = redman::pool_config(kTask, 2);
  std::vector<unsigned char> memory(redman::Pool::memory(config));
  EXPECT_THROW(redman::Pool(config, memory.data(), memory.size() - 1), redman::Error);
  redman::Pool pool(config, memory.data(), memory.size()), other(config);
  for (redman::Pool* each : {&pool, &other}) {
    each->reset();
    each->step();
  }
  EXPECT_EQ(pool.hash(), other.hash());
}

TEST(RedmanHpp, PoolShowsAndSetsJoints) {
  redman::Pool pool(redman::pool_config("hand_over_safe_finger", 2));
  pool.reset();
  EXPECT_STREQ(pool.joint(0).name, "right_WRJ1");
  std::vector<double> q = pool.joint_positions(1), qd = pool.joint_velocities(1);
  ASSERT_EQ(q.size(), 48u);
  q[5] = pool.joint(5).lower;
  qd[5] = 0.5;
  pool.set_joints(1, q, qd);
  EXPECT_NEAR(pool.joint_positions(1)[5], q[5], 1e-6);
  pool.set_joints(1, {}, std::vector<double>(48));
  EXPECT_EQ(pool.joint_velocities(1)[5], 0);
  EXPECT_THROW(pool.set_joints(1, q, {0.5}), redman::Error);
  EXPECT_THROW(pool.set_joints(1, {0.5}, qd), redman::Error);
  for (const auto& [given_q, given_qd] : {std::pair(q, std::vector{0.5}), std::pair(std::vector{0.5}, qd)})
    try {
      pool.set_joints(1, given_q, given_qd);
    } catch (const redman::Error& e) {
      EXPECT_EQ(e.code(), RDM_ERROR_RANGE);
      EXPECT_NE(std::strstr(e.what(), "count: it is 1, "), nullptr) << e.what();
    }
  EXPECT_THROW(pool.joint(48), redman::Error);
}

TEST(RedmanHpp, PoolCastsRays) {
  redman::Pool pool(redman::pool_config("hand_over_safe_finger"));
  pool.reset();
  const rdm_ray_hit hit = pool.raycast(0, {0, 0, 50}, {0, 0, -1}, 100);
  EXPECT_GE(hit.shape, 0);
  EXPECT_NEAR(hit.point[2], 50 - hit.distance, 1e-9);
  EXPECT_EQ(pool.raycast(0, {0, 0, 50}, {0, 0, 1}, 100).shape, -1);
}

TEST(RedmanHpp, AgentLearnsFromAPoolAndItsPolicyActs) {
  redman::Pool pool(redman::pool_config(kTask, 2));
  pool.reset();
  auto config = redman::agent_config(pool);
  const rdm_option options[] = {{"hidden", "8,8", 0}, {"horizon", "4", 0}};
  config.options = options;
  config.num_options = 2;
  redman::Agent agent(config);
  EXPECT_EQ(agent.rollout(pool).epoch, 1);
  const redman::Bytes state = agent.save(), file = agent.policy();
  agent.rollout(pool);
  EXPECT_NE(agent.policy(), file);
  agent.load(state);
  EXPECT_EQ(agent.policy(), file);
  EXPECT_NE(agent.settings().find("hidden=8,8\n"), std::string::npos);
  EXPECT_EQ(pool.initial_mean(),
            std::vector<float>(config.initial_mean, config.initial_mean + config.action_dim));
  const std::string settings = pool.settings();
  const redman::Pool same(redman::pool_config(kTask, 1, settings.c_str()));
  EXPECT_EQ(same.settings(), settings);

  const redman::Policy policy(file);
  float novelty = 0;
  EXPECT_EQ(policy.info().novelty, 0);
  EXPECT_THROW(policy.novelty(pool.obs().data(), 1, &novelty), redman::Error);
  policy.check_fits(pool.spec());
  EXPECT_STREQ(policy.info().task, kTask);
  std::vector<float> by_policy(2 * pool.action().width()), by_agent(by_policy.size());
  policy.act(pool.obs().data(), 2, nullptr, by_policy.data());
  std::vector<float> again(by_policy.size());
  redman::Bytes scratch(policy.scratch_bytes(2));
  policy.act(pool.obs().data(), 2, nullptr, again.data(), scratch.data(), scratch.size());
  EXPECT_EQ(again, by_policy);
  agent.act(pool.obs().data(), RDM_ACT_MEAN, by_agent.data());
  for (size_t i = 0; i < by_agent.size(); ++i)
    EXPECT_NEAR(by_policy[i], std::min(1.0f, std::max(-1.0f, by_agent[i])), 1e-5f) << i;

  auto t = redman::sized<rdm_transition>();
  t.reward = pool.reward().data();
  t.cost = pool.cost().data();
  const auto begin = [&] {
    for (int i = 0; i < 4; ++i) {
      agent.act(pool.obs().data(), RDM_ACT_SAMPLE, by_agent.data());
      agent.record(t);
    }
    agent.update_begin(pool.obs().data());
  };
  auto epoch = redman::sized<rdm_epoch>();
  begin();
  int slices = 1;
  for (; !agent.update_slice(1, &epoch); ++slices) EXPECT_EQ(epoch.epoch, 0);
  EXPECT_GT(slices, 1);
  EXPECT_EQ(epoch.epoch, 2);
  begin();
  EXPECT_THROW(agent.save(), redman::Error);
  EXPECT_THROW(agent.put(pool.obs().data(), by_agent.data(), t), redman::Error);
  agent.discard();
  agent.put(pool.obs().data(), by_agent.data(), t);
  agent.discard();
  agent.save();
}

}  // namespace
