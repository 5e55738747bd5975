// Learners with a memory where it decides: recall, by the first order and in a trust region, and two_state with the state
// shown in every fourth step, whose optimum with and without a memory is known.
#include <cstdio>

#include "base/rng.hpp"
#include "contract.hpp"
#include "policies.hpp"

namespace {

struct Judged {
  double ret = 0, cost = 0;  // means over the episodes of the learned policy, which still explores
};

// 64 worlds, the policy frozen, its noise drawn here.
Judged judge(const Pool& pool, const Agent& agent, int32_t episodes) {
  const Policy policy = read_policy(policy_bytes(agent.get()));
  auto info = RDM_INIT(rdm_policy_info);
  EXPECT_EQ(rdm_policy_get_info(policy.get(), &info), RDM_OK);
  const auto dim = static_cast<size_t>(info.state_dim);
  std::vector<float> state(64 * dim), noise(64);
  std::vector<unsigned char> scratch(rdm_policy_scratch(policy.get(), 64));
  const rdm_buffers b = buffers_of(pool.get());
  rdm::Stream stream(7, 0, rdm::Purpose::kTest);
  Judged sum;
  int32_t ended = 0;
  EXPECT_EQ(rdm_pool_reset(pool.get(), nullptr, nullptr), RDM_OK);
  while (ended < episodes && !testing::Test::HasFatalFailure()) {
    stream.normals(noise.data(), 64);
    EXPECT_EQ(rdm_policy_act_state(policy.get(), b.obs, dim ? state.data() : nullptr, 64, noise.data(),
                                   b.action, scratch.data(), scratch.size()),
              RDM_OK);
    if (rdm_pool_step(pool.get()) != RDM_OK) break;
    for (size_t i = 0; i < 64; ++i) {
      sum.ret += static_cast<double>(b.reward[i]);
      sum.cost += static_cast<double>(b.cost[i]);
      if (!b.terminated[i] && !b.truncated[i]) continue;
      std::fill_n(state.begin() + static_cast<long>(i * dim), dim, 0.0f);
      ++ended;
    }
  }
  return {sum.ret / ended, sum.cost / ended};
}

Judged learn(const char* task, const char* task_options, const char* algo, const std::string& settings,
             uint64_t seed, int64_t steps) {
  rdm_pool_config c = pool_config(64);
  c.task = task;
  c.settings = task_options;
  c.seed = seed;
  const Pool pool(make_pool(c));
  EXPECT_EQ(rdm_pool_reset(pool.get(), nullptr, nullptr), RDM_OK);
  rdm_agent_config a;
  EXPECT_EQ(rdm_agent_config_init(&a, sizeof a), RDM_OK);
  EXPECT_EQ(rdm_agent_config_for_pool(&a, pool.get()), RDM_OK);
  const std::string all =
      settings + "\ntotal_epochs=" + std::to_string(steps / 64 / (*task == 'r' ? 80 : 256));
  a.algo = algo;
  a.settings = all.c_str();
  a.seed = seed;
  const Agent agent(make_agent(a));
  for (auto e = RDM_INIT(rdm_epoch); e.env_steps < steps;)
    if (rdm_agent_rollout(agent.get(), pool.get(), &e) != RDM_OK) {
      ADD_FAILURE() << rdm_agent_error(agent.get());
      return {};
    }
  const Judged out = judge(pool, agent, 20000);
  std::printf("%-10s %-10s %-16s seed %d: return %.4f cost %.4f\n", task, algo, settings.c_str(),
              static_cast<int>(seed), out.ret, out.cost);
  std::fflush(stdout);
  return out;
}

}  // namespace

// The choice is 20 steps away, so each seed shows that gradients reach back over a memory that has learned nothing yet.
TEST(SlowMemory, RecallsTheCue) {
  for (const char* algo : {"ppo", "trpo", "cpo"})
    for (uint64_t seed = 1; seed <= 4; ++seed)
      EXPECT_GE(learn("recall", "", algo, "memory=gru:16", seed, 600000).ret, 0.99) << algo << " " << seed;
  EXPECT_GE(learn("recall", "", "ppo", "history=20", 1, 600000).ret, 0.99);
  EXPECT_LE(learn("recall", "", "ppo", "", 1, 600000).ret,
            0.53);  // what a choice without the cue gives, and luck
}

// At the multiplier of the optimum no policy has a higher return less cost; the best without a memory has 8.8882.
TEST(SlowMemory, KnowsTheHiddenState) {
  constexpr double kMultiplier = 1.673477, kLimit = 2.5, kBest = 9.453685, kForgetful = 8.888150;
  const auto gap = [&](const char* algo, const char* settings, uint64_t seed) {
    const Judged l = learn("two_state", "show_every=4", algo, settings, seed, 1000000);
    EXPECT_LE(l.cost, 1.05 * kLimit);
    const double value = l.ret - kMultiplier * (l.cost - kLimit);
    EXPECT_LE(value, 1.01 * kBest);  // of the mean over 20,000 episodes
    return value - kForgetful;
  };
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    EXPECT_GE(gap("ppo_lag", "memory=gru:16", seed), 0.25);
    EXPECT_GE(gap("trpo_lag", "memory=gru:16", seed), 0.25);
    EXPECT_GE(gap("ppo_lag", "history=4", seed), 0.25);
    EXPECT_LE(gap("ppo_lag", "", seed), 0.05);
  }
}
