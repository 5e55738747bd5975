// A constrained Markov decision process of two states with a known optimum. Start in state 0; each step ends
// with probability 0.1; a = 1 where the action is positive; P(1 | s, a): 0.1, 0.8 in state 0, 0.2, 0.9 in
// state 1; reward 0, 1 and 0.5, 2; cost 0, 0.2 and 0, 1.
// Without a limit: always a = 1, return 17.912088 at cost 8.329670. Limit 2.5: return 9.687058 with
// P(a = 1 | 0) = 1 and P(a = 1 | 1) = 0.294079.
#pragma once
#include "agents.hpp"

namespace rdm::test {

class TwoState {
 public:
  explicit TwoState(int32_t envs) : state_(size_of(envs)), stream_(4, 0, Purpose::kTest) {
    obs_.resize(2 * state_.size());
    action_.resize(state_.size()), reward_ = cost_ = action_;
    over_.resize(state_.size());
    observe();
  }
  void epoch(Agent& a, Epoch* out) {
    while (a.missing() > 0) {
      a.act(obs_.data(), true, action_.data());
      for (size_t i = 0; i < state_.size(); ++i) step(i);
      observe();
      Transition t;
      t.reward = reward_.data(), t.cost = cost_.data(), t.terminated = over_.data();
      a.record(t);
    }
    a.update(obs_.data(), out);
  }

 private:
  void step(size_t i) {
    constexpr float kReward[2][2] = {{0, 1}, {0.5f, 2}}, kCost[2][2] = {{0, 0.2f}, {0, 1}};
    constexpr double kToOne[2][2] = {{0.1, 0.8}, {0.2, 0.9}};
    const int s = state_[i], a = action_[i] > 0;
    reward_[i] = kReward[s][a];
    cost_[i] = kCost[s][a];
    over_[i] = stream_.uniform() < 0.1;
    state_[i] = !over_[i] && stream_.uniform() < kToOne[s][a];
  }
  void observe() {
    for (size_t i = 0; i < state_.size(); ++i) obs_[2 * i] = state_[i] == 0, obs_[2 * i + 1] = state_[i] == 1;
  }
  std::vector<int> state_;
  std::vector<float> obs_, action_, reward_, cost_;
  std::vector<uint8_t> over_;
  Stream stream_;
};

// Means of return and cost over the last `tail` of `epochs` epochs.
struct Outcome {
  double ret = 0, cost = 0;
};
inline Outcome play_two_state(const char* algo, std::vector<OptionInput> extra, int epochs, int tail) {
  AgentSetup s(algo, 2, 1, 50, std::move(extra));
  s.with("horizon", "60").with("hidden", "16").with("init_std", "1").with("learn_std", "false");
  s.with("discount", "1").with("lambda", "0.95").with("cost_lambda", "0.95").with("passes", "5");
  s.with("learning_rate", "3e-3").with("critic_l2", "0");
  s.config.seed = 1;
  const AgentPtr a = s.make();
  TwoState world(50);
  Outcome out;
  Epoch e;
  for (int i = 0; i < epochs; ++i) {
    world.epoch(*a, &e);
    if (i < epochs - tail) continue;
    out.ret += e.ret / tail;
    out.cost += e.cost[0] / tail;
  }
  return out;
}

}  // namespace rdm::test
