// Three worlds whose constrained optimum is known in closed form or by a computed table, played through the
// interface of agents; the learned policy is then judged by formula, without noise.
#pragma once
#include <cmath>

#include "agents.hpp"

namespace rdm::test {

// Return and cost of an episode, as expectations.
struct Judged {
  double ret = 0, cost = 0;
};

// The mean action and the deviation for each row of obs [num_envs][obs_dim], by the agent's tensors.
inline double deviation(Agent& a) {
  TensorInfo t;
  a.tensor(0, &t);
  return std::exp(static_cast<double>(t.data[0]));
}

// One step per episode, r = -(a - 2)^2, c = a, deviation 0.5 fixed; limit 1: mean 1, return -1.25. As no cost may
// be below 0, the agent gets it, and its limit, with kShift more.
class BanditWorld {
 public:
  static constexpr int kObs = 1;
  static constexpr double kLimit = 1, kBest = -1.25, kFree = -0.25, kShift = 3;
  explicit BanditWorld(size_t envs, uint64_t) : envs_(envs) {}
  void start(float* obs) { std::fill_n(obs, envs_, 1.0f); }
  void step(const float* action, float* reward, float* cost, uint8_t* terminated, uint8_t*, float*) {
    for (size_t i = 0; i < envs_; ++i) {
      reward[i] = -(action[i] - 2) * (action[i] - 2);
      cost[i] = action[i] + static_cast<float>(kShift);
      terminated[i] = 1;
    }
  }
  static Judged judge(Agent& a, size_t envs) {
    const std::vector<float> obs(envs, 1.0f);
    std::vector<float> action(envs);
    a.act(obs.data(), false, action.data());
    const auto mu = static_cast<double>(action[0]), sigma = deviation(a);
    return {-(mu - 2) * (mu - 2) - sigma * sigma, mu};
  }

 private:
  size_t envs_;
};

// tests/support/two_state.hpp has the definition; limit 2.5: return 9.687058. a = 1 where the action is
// positive.
class TwoStateWorld {
 public:
  static constexpr int kObs = 2;
  static constexpr double kLimit = 2.5, kBest = 9.687058, kFree = 17.912088, kShift = 0;
  TwoStateWorld(size_t envs, uint64_t seed) : state_(envs), stream_(seed, 0, Purpose::kTest) {}
  void start(float* obs) { observe(obs); }
  void step(const float* action, float* reward, float* cost, uint8_t* terminated, uint8_t*, float* obs) {
    for (size_t i = 0; i < state_.size(); ++i) {
      const int s = state_[i], a = action[i] > 0;
      reward[i] = static_cast<float>(kReward[s][a]);
      cost[i] = static_cast<float>(kCost[s][a]);
      terminated[i] = stream_.uniform() < 0.1;
      state_[i] = !terminated[i] && stream_.uniform() < kToOne[s][a];
    }
    observe(obs);
  }
  // Expectations by the two linear equations of the states' values under P(a = 1 | s) = Phi(mu / sigma).
  static Judged judge(Agent& a, size_t envs) {
    std::vector<float> obs(2 * envs), action(envs);
    for (size_t i = 0; i < envs; ++i) obs[2 * i + i % 2] = 1;
    a.act(obs.data(), false, action.data());
    double up[2], r[2], c[2], to_one[2];
    for (size_t s = 0; s < 2; ++s) {
      up[s] = std::erfc(-static_cast<double>(action[s]) / deviation(a) / std::sqrt(2.0)) / 2;
      const auto mix = [&](const double* x) { return (1 - up[s]) * x[0] + up[s] * x[1]; };
      r[s] = mix(kReward[s]), c[s] = mix(kCost[s]), to_one[s] = 0.9 * mix(kToOne[s]);
    }
    const auto value = [&](const double* x) {
      // v0 = x0 + (.9 - p0) v0 + p0 v1, v1 = x1 + (.9 - p1) v0 + p1 v1
      const double a00 = 1 - (0.9 - to_one[0]), a01 = -to_one[0], a10 = -(0.9 - to_one[1]),
                   a11 = 1 - to_one[1];
      return (x[0] * a11 - a01 * x[1]) / (a00 * a11 - a01 * a10);
    };
    return {value(r), value(c)};
  }

 private:
  static constexpr double kReward[2][2] = {{0, 1}, {0.5, 2}}, kCost[2][2] = {{0, 0.2}, {0, 1}};
  static constexpr double kToOne[2][2] = {{0.1, 0.8}, {0.2, 0.9}};
  void observe(float* obs) const {
    for (size_t i = 0; i < state_.size(); ++i) {
      obs[2 * i] = state_[i] == 0;
      obs[2 * i + 1] = state_[i] == 1;
    }
  }
  std::vector<int> state_;
  Stream stream_;
};

// x0 ~ N(0, 1), x' = x + a + N(0, .1^2), 20 steps, deviation .1 fixed, r = -(x^2 + .1 a^2), c = a^2. Best
// linear gain under the limit 1: 0.734456, return -1.583058; without: 0.915, -1.52626 at cost 1.36366.
class LqrWorld {
 public:
  static constexpr int kObs = 1;
  static constexpr double kLimit = 1, kBest = -1.583058, kFree = -1.52626, kShift = 0;
  static constexpr int kSteps = 20;
  LqrWorld(size_t envs, uint64_t seed) : x_(envs), t_(envs), stream_(seed, 0, Purpose::kTest) {}
  void start(float* obs) {
    for (size_t i = 0; i < x_.size(); ++i) obs[i] = x_[i] = normal();
  }
  void step(const float* action, float* reward, float* cost, uint8_t* terminated, uint8_t*, float* obs) {
    for (size_t i = 0; i < x_.size(); ++i) {
      reward[i] = -(x_[i] * x_[i] + 0.1f * action[i] * action[i]);
      cost[i] = action[i] * action[i];
      terminated[i] = ++t_[i] == kSteps;
      x_[i] = terminated[i] ? normal() : x_[i] + action[i] + 0.1f * normal();
      if (terminated[i]) t_[i] = 0;
      obs[i] = x_[i];
    }
  }
  // The moments of x under a = w x + b + noise, from step to step: for a policy without hidden layers.
  static Judged judge(Agent& a, size_t envs) {
    std::vector<float> obs(envs), action(envs);
    obs[1] = 1, obs[2] = -3;
    a.act(obs.data(), false, action.data());
    const double b = action[0], w = action[1] - b, sigma = deviation(a);
    EXPECT_NEAR(action[2], b - 3 * w, 1e-5) << "not linear";
    Judged out;
    double mean = 0, square = 1;
    for (int t = 0; t < kSteps; ++t) {
      const double a2 = w * w * square + 2 * w * b * mean + b * b + sigma * sigma;
      out.ret -= square + 0.1 * a2;
      out.cost += a2;
      square = (1 + w) * (1 + w) * square + 2 * (1 + w) * b * mean + b * b + sigma * sigma + 0.01;
      mean = (1 + w) * mean + b;
    }
    return out;
  }

 private:
  float normal() {
    float z;
    stream_.normals(&z, 1);
    return z;
  }
  std::vector<float> x_;
  std::vector<int> t_;
  Stream stream_;
};

// The first and the last of them for policies whose actions are bounded, and whose mean alone is judged, as of learners
// from a replay memory: actions are 3 times the policy's. limit(noise): of costs while actions have a noise of that
// deviation, so that the mean keeps kLimit.
inline constexpr float kBound = 3;

class BoundedBandit {
 public:
  static constexpr int kObs = 1;
  static constexpr double kLimit = 1, kBest = -1;
  BoundedBandit(size_t envs, uint64_t seed) : world_(envs, seed) {}
  void start(float* obs) { world_.start(obs); }
  void step(const float* action, float* reward, float* cost, uint8_t* over, uint8_t*, float* obs) {
    world_.step(action, reward, cost, over, nullptr, obs);
  }
  static double limit(double) { return kLimit + BanditWorld::kShift; }
  static Judged judge(Agent& a, size_t envs) {
    const std::vector<float> obs(envs, 1.0f);
    std::vector<float> action(envs);
    a.act(obs.data(), false, action.data());
    const double mu = static_cast<double>(kBound * action[0]);
    return {-(mu - 2) * (mu - 2), mu};
  }

 private:
  BanditWorld world_;
};

// Best linear gain without noise under the limit 0.7: 0.741023, return -1.344780; without a limit 0.92, at 1.01.
class BoundedLqr {
 public:
  static constexpr int kObs = 1;
  static constexpr double kLimit = 0.7, kBest = -1.344780, kGain = 0.741023;
  BoundedLqr(size_t envs, uint64_t seed) : world_(envs, seed) {}
  void start(float* obs) { world_.start(obs); }
  void step(const float* action, float* reward, float* cost, uint8_t* over, uint8_t*, float* obs) {
    world_.step(action, reward, cost, over, nullptr, obs);
  }
  static double limit(double noise) {
    double cost = 0, square = 1;
    for (int t = 0; t < LqrWorld::kSteps; ++t) {
      cost += kGain * kGain * square + noise * noise;
      square = (1 - kGain) * (1 - kGain) * square + noise * noise + 0.01;
    }
    return cost;
  }
  // 20,000 episodes, beside the best gain's in the same ones.
  static Judged judge(Agent& a, size_t envs) {
    Judged sum[2];
    for (int which = 0; which < 2; ++which) {
      LqrWorld world(envs, 77);
      std::vector<float> obs(envs), action(envs), reward(envs), cost(envs);
      std::vector<uint8_t> over(envs);
      world.start(obs.data());
      const int episodes = 20000 / static_cast<int>(envs);
      for (int t = 0; t < episodes * LqrWorld::kSteps; ++t) {
        if (which == 0) a.act(obs.data(), false, action.data());
        for (size_t i = 0; i < envs; ++i)
          action[i] = which == 0 ? kBound * action[i] : -static_cast<float>(kGain) * obs[i];
        world.step(action.data(), reward.data(), cost.data(), over.data(), nullptr, obs.data());
        for (size_t i = 0; i < envs; ++i) {
          sum[which].ret += static_cast<double>(reward[i]) / 20000;
          sum[which].cost += static_cast<double>(cost[i]) / 20000;
        }
      }
    }
    return {kBest + sum[0].ret - sum[1].ret, kLimit + sum[0].cost - sum[1].cost};
  }

 private:
  LqrWorld world_;
};

// Trains and judges; env count 50. bound: factor on the agent's actions.
template <class World>
Judged learn_world(AgentSetup& s, int epochs, float bound = 1) {
  const AgentPtr a = s.make();
  const auto n = size_of(s.config.num_envs);
  World world(n, 100 + s.config.seed);
  std::vector<float> obs(n * World::kObs), action(n), reward(n), cost(n);
  std::vector<uint8_t> over(n);
  world.start(obs.data());
  Transition t;
  t.reward = reward.data(), t.cost = cost.data(), t.terminated = over.data();
  for (int e = 0; e < epochs; ++e) {
    while (a->missing() > 0) {
      a->act(obs.data(), true, action.data());
      for (float& x : action) x *= bound;
      world.step(action.data(), reward.data(), cost.data(), over.data(), nullptr, obs.data());
      a->record(t);
    }
    a->update(obs.data(), nullptr);
  }
  return World::judge(*a, n);
}

}  // namespace rdm::test
