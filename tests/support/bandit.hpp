// Gaussian bandit: one step per episode, constant observation, r = -(a - 2)^2, c = 5 + a (ten
// deviations above 0), sigma fixed at 0.5, the mean 0 at first. Best mean: 2, and 1 under the limit 6, where
// the multiplier is 2 / std(r) = 1.8856.
#pragma once
#include "agents.hpp"

namespace rdm::test {

inline AgentSetup bandit(const char* algo) {
  AgentSetup s(algo, 1, 1, 50);
  s.with("horizon", "40").with("hidden", "16").with("init_std", "0.5").with("learn_std", "false");
  s.with("learning_rate", "3e-3").with("passes", "5").with("minibatches", "8");
  s.with("lr_schedule", "linear").with("total_epochs", "140");
  s.config.seed = 3;
  return s;
}

// Plays `epochs` updates of 2000 samples; returns the mean action.
inline float play_bandit(AgentSetup& setup, int epochs, Epoch* last) {
  const AgentPtr a = setup.make();
  const auto n = size_of(setup.config.num_envs);
  std::vector<float> obs(n, 1.0f), action(n), reward(n), cost(n);
  const std::vector<uint8_t> over(n, 1);
  Transition t;
  t.reward = reward.data();
  t.cost = cost.data();
  t.terminated = over.data();
  for (int e = 0; e < epochs; ++e) {
    while (a->missing() > 0) {
      a->act(obs.data(), true, action.data());
      for (size_t i = 0; i < n; ++i) {
        reward[i] = -(action[i] - 2) * (action[i] - 2);
        cost[i] = 5 + action[i];
      }
      a->record(t);
    }
    a->update(obs.data(), last);
  }
  a->act(obs.data(), false, action.data());
  return action[0];
}

}  // namespace rdm::test
