// Helpers for tests of agents: a config with options, and toy worlds that are played through the interface.
#pragma once
#include <gtest/gtest.h>

#include <cstring>
#include <memory>
#include <string>
#include <vector>

#include "algos/agent/agent.hpp"
#include "algos/core/algo_row.hpp"
#include "base/bytes.hpp"
#include "base/error.hpp"
#include "base/rng.hpp"

namespace rdm::test {

struct AgentDeleter {
  void operator()(Agent* a) const { Agent::destroy(a); }
};
using AgentPtr = std::unique_ptr<Agent, AgentDeleter>;

// Owns what an AgentConfig points to.
struct AgentSetup {
  AgentConfig config;
  std::vector<OptionInput> options;

  AgentSetup(const char* algo, int32_t obs_dim, int32_t action_dim, int32_t num_envs,
             std::vector<OptionInput> given = {})
      : options(std::move(given)) {
    config.algo = algo;
    config.obs_dim = obs_dim;
    config.action_dim = action_dim;
    config.num_envs = num_envs;
  }
  AgentSetup& with(const char* key, const char* text) {
    options.push_back({key, text, 0});
    return *this;
  }
  bool knows(const char* key) const {
    const AlgoInfo& info = algo_at(algo_find(config.algo));
    for (int32_t i = 0; i < info.num_options; ++i)
      if (same_name(info.options[i].key, key)) return true;
    return false;
  }
  // Where the algorithm has such an option.
  AgentSetup& with_known(const char* key, const char* text) { return knows(key) ? with(key, text) : *this; }
  bool off_policy() const { return algo_row(algo_find(config.algo)).off_policy; }
  const AgentConfig& ready() {
    config.options = options.data();
    config.num_options = static_cast<int32_t>(options.size());
    return config;
  }
  AgentPtr make() { return AgentPtr(Agent::create(ready())); }
};

// The algorithms that learn from what they just did: those of which encoders, memories, imitation and ranks are.
inline std::vector<int32_t> on_policy_algos() {
  std::vector<int32_t> list;
  for (int32_t i = 0; i < algo_count(); ++i)
    if (!algo_row(i).off_policy) list.push_back(i);
  return list;
}

// A learner from a replay memory learns from the first epoch on, in a few steps of its own.
inline void few_updates(AgentSetup& s) {
  s.with_known("start_steps", "0").with_known("batch_rows", "16").with_known("updates_per_step", "0.05");
  s.with_known("replay_rows", "1000");
}

// With most of what crosses rows and epochs switched on, and two costs with limits, the worst of which counts
// where an algorithm takes one.
inline AgentSetup busy_setup(const char* algo, const char* std_mode, int32_t num_envs) {
  static const double limits[] = {1, 0.5};
  AgentSetup s(algo, 6, 3, num_envs);
  s.config.cost_dim = 2;
  s.config.max_steps = 30;
  s.config.seed = 11;
  s.config.cost_limits = limits;
  s.with("hidden", "16,8").with("horizon", "12").with_known("passes", "3").with_known("minibatches", "2");
  s.with("noise_correlation", "0.3").with_known("lr_schedule", "kl").with("learning_rate", "2e-3");
  s.with("terminal_cost", "on").with_known("normalize_reward", "on").with_known("normalize_cost", "on");
  s.with("reward_factor", "0.5").with("average", "0.6");
  s.with_known("std_mode", std_mode);
  // A ring that is full after three epochs, batches of two parts.
  if (s.off_policy())
    s.with("activation", "tanh")
        .with("replay_rows", "1200")
        .with("batch_rows", "300")
        .with("start_steps", "40")
        .with("updates_per_step", "0.01");
  if (algo_row(algo_find(algo)).costs == Costs::kOne) s.with("several_costs", "worst");
  return s;
}

inline size_t size_of(int32_t n) {
  return static_cast<size_t>(n);
}

// A world of noise: observations, rewards and costs from a stream, ends with small probability. Good for
// anything that only needs an agent to run.
class NoiseWorld {
 public:
  explicit NoiseWorld(const AgentConfig& c, uint64_t seed = 1)
      : config_(c),
        stream_(seed, 0, Purpose::kTest),
        obs_(size_of(c.num_envs) * size_of(c.obs_dim)),
        final_(obs_.size()),
        action_(size_of(c.num_envs) * size_of(c.action_dim)),
        reward_(size_of(c.num_envs)),
        cost_(size_of(c.num_envs) * size_of(c.cost_dim)),
        terminated_(reward_.size()),
        truncated_(reward_.size()),
        success_(reward_.size()),
        valid_(reward_.size()) {
    fill(obs_);
  }
  void epoch(Agent& a, Epoch* out = nullptr) {
    while (a.missing() > 0) decide(a);
    a.update(obs_.data(), out);
  }
  void decide(Agent& a) {
    a.act(obs_.data(), true, action_.data());
    draw();
    a.record(transition());
  }
  void draw() {
    fill(reward_);
    for (auto& c : cost_) c = static_cast<float>(stream_.uniform());
    fill(final_);
    fill(obs_);
    for (size_t i = 0; i < reward_.size(); ++i) {
      const double u = stream_.uniform();
      terminated_[i] = u < 0.05;
      truncated_[i] = u > 0.9;
      success_[i] = u > 0.7;
      valid_[i] = stream_.uniform() > 0.1;
    }
  }
  Transition transition() const {
    Transition t;
    t.reward = reward_.data();
    t.cost = cost_.data();
    t.terminated = terminated_.data();
    t.truncated = truncated_.data();
    t.final_obs = final_.data();
    t.success = success_.data();
    t.valid = valid_.data();
    return t;
  }
  const float* obs() const { return obs_.data(); }
  float* action() { return action_.data(); }

 private:
  void fill(std::vector<float>& v) {
    for (auto& x : v) x = static_cast<float>(stream_.signed_unit());
  }
  AgentConfig config_;
  Stream stream_;
  std::vector<float> obs_, final_, action_, reward_, cost_;
  std::vector<uint8_t> terminated_, truncated_, success_, valid_;
};

// All parameters, tensor after tensor.
inline std::vector<float> parameters(Agent& a) {
  std::vector<float> all;
  TensorInfo t;
  for (int32_t i = 0; a.tensor(i, &t); ++i)
    all.insert(all.end(), t.data, t.data + size_of(t.rows) * size_of(t.cols));
  return all;
}

// What write(Writer&) writes.
template <class F>
std::vector<unsigned char> written(F&& write) {
  Writer count(nullptr, 0);
  write(count);
  std::vector<unsigned char> bytes(count.size());
  Writer out(bytes.data(), bytes.size());
  write(out);
  return bytes;
}
inline std::vector<unsigned char> saved(const Agent& a) {
  return written([&](Writer& w) { a.save(w); });
}
inline std::vector<unsigned char> policy_file(Agent& a) {
  return written([&](Writer& w) { a.write_policy_file(w); });
}

// The code and text of the Error that f throws; kOk when it throws none.
struct Thrown {
  Code code = Code::kOk;
  std::string text;
};
template <class F>
Thrown thrown(F&& f) {
  try {
    f();
  } catch (const Error& e) {
    return {e.code, e.text};
  }
  return {};
}

}  // namespace rdm::test
