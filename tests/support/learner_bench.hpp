// A learner with a rollout of random numbers, and its formulas again in double.
#pragma once
#include <algorithm>
#include <cmath>
#include <numeric>

#include "agents.hpp"
#include "algos/agent/learner.hpp"
#include "algos/first_order/ppo.hpp"

namespace rdm::test {

inline constexpr double kClip = 0.2;

// Half of the ratios are pushed out of the clip.
struct Bench {
  AgentSetup setup;
  ResolvedAgentConfig resolved;
  Arena arena;
  Networks nets;
  BatchWorkers workers;
  Rollout rollout;
  Learner learner;
  ClippedSurrogate loss;
  std::vector<int32_t> order;

  explicit Bench(AgentSetup s) : setup(std::move(s)), resolved(resolve_config(setup.ready())) {
    Arena measure;
    carve(measure);
    arena = Arena(host(), measure.used());
    carve(arena);
    workers.open(host(), setup.config.num_threads);
    init_networks(nets, resolved);
    learner.open(resolved, rollout, nets, workers);
    loss.clip = static_cast<float>(kClip);
    order.resize(size_of(resolved.samples));
    std::iota(order.begin(), order.end(), 0);
    fill();
  }
  void carve(Arena& a) {
    nets = carve_networks(a, resolved);
    workers.carve(a, resolved, nets.size);
    rollout = carve_rollout(a, resolved);
    learner.carve(a, resolved, nets.size);
  }
  void fill() {
    Stream s(5, 0, Purpose::kTest);
    const size_t n = size_of(resolved.samples), a = resolved.action_dim();
    const auto draw = [&](float* x, size_t count) {
      for (size_t i = 0; i < count; ++i) x[i] = static_cast<float>(s.signed_unit());
    };
    draw(rollout.obs, n * resolved.obs_dim());
    draw(rollout.action, n * a);
    draw(rollout.gain, n);
    draw(rollout.linear, n);
    draw(rollout.cost_advantage, n * size_of(resolved.num_limited));
    std::fill_n(rollout.valid, n, uint8_t{1});
    draw(rollout.target, n);
    draw(rollout.cost_target, n * size_of(resolved.num_limited));
    for (size_t i = 0; i < n; ++i) {
      const Head now = head(params(), i);
      for (size_t j = 0; j < a; ++j)
        rollout.mean[i * a + j] = static_cast<float>(now.mean[j] + 0.1 * s.signed_unit());
      for (size_t j = 0; j < a; ++j)
        rollout.log_std_of(i)[j] =
            static_cast<float>(now.log_std[j] + (resolved.state_std() ? 0.1 * s.signed_unit() : 0));
      const double push = i % 2 ? 0.1 * s.signed_unit() : std::log(1.5) * (i % 4 ? 1 : -1);
      rollout.log_prob[i] = static_cast<float>(log_prob(params(), i) - push);
    }
  }

  std::vector<double> params() const { return {nets.params, nets.params + nets.size}; }
  const float* obs(size_t i) const { return rollout.obs + i * resolved.obs_dim(); }

  // The formulas again, in double.
  std::vector<double> network(const std::vector<double>& p, int32_t net, size_t row) const {
    const MlpShape& shape = nets.shape[net];
    std::vector<double> h(obs(row), obs(row) + resolved.obs_dim());
    for (int32_t l = 0; l < shape.num_layers(); ++l) {
      const double* w = &p[nets.net_offset(net) + shape.weight_offset(l)];
      const double* b = &p[nets.net_offset(net) + shape.bias_offset(l)];
      std::vector<double> z(size_of(shape.layer_out(l)));
      for (size_t o = 0; o < z.size(); ++o) {
        z[o] = b[o];
        for (size_t i = 0; i < h.size(); ++i) z[o] += w[o * h.size() + i] * h[i];
        if (l == shape.num_hidden) continue;
        if (shape.activation == Activation::kTanh) z[o] = std::tanh(z[o]);
        if (shape.activation == Activation::kElu && z[o] < 0) z[o] = std::expm1(z[o]);
        if (shape.activation == Activation::kRelu && z[o] < 0) z[o] = 0;
      }
      h = z;
    }
    return h;
  }
  // The policy at a row: means and log deviations of the innovation.
  struct Head {
    std::vector<double> mean, log_std;
  };
  Head head(const std::vector<double>& p, size_t row) const {
    const size_t a = resolved.action_dim();
    Head h{network(p, Networks::kActor, row), {p.begin(), p.begin() + static_cast<long>(a)}};
    for (size_t j = 0; j < a; ++j) {
      if (resolved.state_std())
        h.log_std[j] =
            std::clamp(h.mean[a + j], static_cast<double>(nets.std_low), static_cast<double>(nets.std_high));
      h.log_std[j] += static_cast<double>(resolved.log_share);
    }
    h.mean.resize(a);
    return h;
  }
  double log_prob(const std::vector<double>& p, size_t row) const {
    const Head h = head(p, row);
    double sum = 0;
    for (size_t j = 0; j < h.mean.size(); ++j) {
      const double gap = static_cast<double>(rollout.action[row * h.mean.size() + j]) - h.mean[j];
      const double z = gap / std::exp(h.log_std[j]);
      sum += -z * z / 2 - h.log_std[j] - 0.9189385332046727;
    }
    return sum;
  }
  double ratio(const std::vector<double>& p, size_t row) const {
    return std::exp(log_prob(p, row) - static_cast<double>(rollout.log_prob[row]));
  }
  // KL(one || other) at a row.
  static double kl_of(const Head& one, const Head& other) {
    double sum = 0;
    for (size_t j = 0; j < one.mean.size(); ++j) {
      const double d = one.mean[j] - other.mean[j], l = other.log_std[j];
      sum += l - one.log_std[j] + (std::exp(2 * one.log_std[j]) + d * d) / (2 * std::exp(2 * l)) - 0.5;
    }
    return sum;
  }
  // The policy that acted at a row.
  Head acted(size_t row) const {
    const size_t a = resolved.action_dim();
    const float *mean = rollout.mean + row * a, *log_std = rollout.log_std_of(row);
    return {{mean, mean + a}, {log_std, log_std + a}};
  }
  // Share of the rows and dimensions whose deviation is at a bound.
  double share_at_bound() const {
    size_t count = 0;
    for (size_t i = 0; i < order.size(); ++i) {
      const std::vector<double> y = network(params(), Networks::kActor, i);
      for (size_t j = resolved.action_dim(); j < y.size(); ++j)
        count += y[j] <= static_cast<double>(nets.std_low) || y[j] >= static_cast<double>(nets.std_high);
    }
    return static_cast<double>(count) / static_cast<double>(order.size() * resolved.action_dim());
  }
  double clipped_gain(double rho, size_t row) const {
    const auto gain = static_cast<double>(rollout.gain[row]);
    return std::min(rho * gain, std::clamp(rho, 1 - kClip, 1 + kClip) * gain);
  }
  double total_loss(const std::vector<double>& p) const {
    const double n = resolved.samples;
    double sum = 0;
    for (size_t i = 0; i < size_of(resolved.samples); ++i) {
      const double rho = ratio(p, i), linear = static_cast<double>(rollout.linear[i]);
      sum -= clipped_gain(rho, i) + rho * linear;
      for (const double l : head(p, i).log_std) sum -= resolved.shared.entropy * l;
      const double v = network(p, Networks::kReward, i)[0] - static_cast<double>(rollout.target[i]);
      sum += v * v;
      const std::vector<double> c = network(p, Networks::kCost, i);
      for (size_t k = 0; k < c.size(); ++k) {
        const double e = c[k] - static_cast<double>(rollout.cost_target[i * c.size() + k]);
        sum += e * e;
      }
    }
    double penalty = 0;
    for (size_t j = nets.block[Networks::kReward].offset; j < nets.size; ++j)
      penalty += resolved.shared.critic_l2 * p[j] * p[j];
    return sum / n + penalty;
  }
};

// A small net and one minibatch of 160 rows with two limited costs.
inline AgentSetup two_costs(AgentSetup s) {
  static const double limits[] = {1, 2};
  s.config.cost_dim = 2;
  s.config.cost_limits = limits;
  s.with("hidden", "5,4").with("horizon", "10").with("minibatches", "1").with("last_layer_scale", "1");
  return s;
}

// With std_mode=state and bounds so near that some deviations are at them.
inline AgentSetup with_state_std(AgentSetup s) {
  s.with("std_mode", "state").with("std_min", "0.57").with("init_std", "0.6").with("std_max", "0.63");
  return s;
}

// The learner's last gradient of the actor is the central difference of total(params).
template <class Total>
void expect_gradient(const Bench& b, Total&& total, double tolerance) {
  std::vector<double> p = b.params();
  double largest = 0;
  for (size_t j = 0; j < b.nets.block[Networks::kActor].size; ++j) {
    const double kept = p[j], h = 1e-6 * (1 + std::abs(kept));
    p[j] = kept + h;
    const double up = total(p);
    p[j] = kept - h;
    const double down = total(p);
    p[j] = kept;
    const double wanted = (up - down) / (2 * h);
    largest = std::max(largest, std::abs(wanted));
    EXPECT_NEAR(static_cast<double>(b.learner.gradient()[j]), wanted, tolerance) << j;
  }
  EXPECT_GT(largest, 0.01);
}

}  // namespace rdm::test
