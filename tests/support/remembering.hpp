// Policies with a memory whose actions hang on it, for tests: drawn weights, and what they do by public calls alone.
#pragma once
#include "base/rng.hpp"
#include "contract.hpp"
#include "policies.hpp"

// An agent for a pool's task whose actor's weights are drawn, wide enough that a state moves the actions.
inline Agent drawn_agent(const Pool& pool, const std::string& settings, uint64_t seed, float width = 0.7f) {
  rdm_agent_config c;
  EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  EXPECT_EQ(rdm_agent_config_for_pool(&c, pool.get()), RDM_OK);
  c.algo = "ppo";
  c.settings = settings.c_str();
  Agent agent(make_agent(c));
  rdm::Stream stream(seed, 0, rdm::Purpose::kTest);
  rdm_tensor t;
  for (int32_t i = 0; rdm_agent_tensor_at(agent.get(), i, &t) == RDM_OK; ++i) {
    const std::string name = t.name;
    if (name.rfind("actor.", 0) != 0 || name.find("std") != std::string::npos) continue;
    std::vector<float> values(static_cast<size_t>(t.rows) * static_cast<size_t>(t.cols));
    for (float& x : values) x = width * static_cast<float>(stream.signed_unit());
    EXPECT_EQ(rdm_agent_set_tensor(agent.get(), name.c_str(), values.data(), values.size()), RDM_OK)
        << rdm_agent_error(agent.get());
  }
  return agent;
}

// A policy with the states of its rows, which a test keeps.
struct Remembering {
  Policy policy;
  rdm_policy_info info;
  std::vector<unsigned char> scratch;

  explicit Remembering(const Agent& agent) : policy(read_policy(policy_bytes(agent.get()))) {
    info = RDM_INIT(rdm_policy_info);
    EXPECT_EQ(rdm_policy_get_info(policy.get(), &info), RDM_OK);
    scratch.resize(rdm_policy_scratch(policy.get(), 1));
  }
  std::vector<float> fresh() const { return std::vector<float>(static_cast<size_t>(info.state_dim)); }
  // The mean action of one row; the state becomes that after the decision.
  std::vector<float> act(const float* obs, std::vector<float>& state) {
    std::vector<float> action(static_cast<size_t>(info.action_dim));
    EXPECT_EQ(rdm_policy_act_state(policy.get(), obs, state.empty() ? nullptr : state.data(), 1, nullptr,
                                   action.data(), scratch.data(), scratch.size()),
              RDM_OK)
        << rdm_last_error();
    return action;
  }
};
