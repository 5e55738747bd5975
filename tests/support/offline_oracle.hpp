// A learner from recorded rows written again in double, plainly: losses are functions of all parameters, gradients are
// central differences of them. Networks have one hidden layer of tanh. Recordings of noise to learn from.
#pragma once
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <utility>

#include "agents.hpp"
#include "algos/off_policy/off_policy.hpp"

namespace rdm::test {

using Numbers = std::vector<double>;

struct PlainNet {
  size_t in = 0, hidden = 0, out = 0;
  Numbers p;  // weights of the hidden layer, its biases, those of the last layer
  Numbers operator()(const Numbers& x) const {
    Numbers h(hidden), y(out);
    const double* w = p.data();
    for (size_t i = 0; i < hidden; ++i) {
      h[i] = w[hidden * in + i];
      for (size_t j = 0; j < in; ++j) h[i] += w[i * in + j] * x[j];
      h[i] = std::tanh(h[i]);
    }
    w += hidden * in + hidden;
    for (size_t i = 0; i < out; ++i) {
      y[i] = w[out * hidden + i];
      for (size_t j = 0; j < hidden; ++j) y[i] += w[i * hidden + j] * h[j];
    }
    return y;
  }
};

// Adam over the parameters of a network.
struct PlainAdam {
  Numbers m, v;
  int t = 0;
  void step(Numbers& p, const Numbers& g, double rate) {
    m.resize(p.size()), v.resize(p.size());
    ++t;
    for (size_t i = 0; i < p.size(); ++i) {
      m[i] = 0.9 * m[i] + 0.1 * g[i];
      v[i] = 0.999 * v[i] + 0.001 * g[i] * g[i];
      p[i] -= rate * m[i] / (1 - std::pow(0.9, t)) / (std::sqrt(v[i] / (1 - std::pow(0.999, t))) + 1e-8);
    }
  }
};

inline Numbers differences(Numbers& p, const std::function<double()>& loss) {
  Numbers g(p.size());
  for (size_t i = 0; i < p.size(); ++i) {
    const double before = p[i], h = 1e-5;
    p[i] = before + h;
    const double high = loss();
    p[i] = before - h;
    g[i] = (high - loss()) / (2 * h);
    p[i] = before;
  }
  return g;
}

inline Numbers joined(const Numbers& a, const Numbers& b) {
  Numbers out = a;
  out.insert(out.end(), b.begin(), b.end());
  return out;
}

// The network whose tensors are PREFIX.0.weight and so on.
inline PlainNet net_of(Agent& a, const std::string& prefix) {
  PlainNet net;
  TensorInfo t;
  for (int32_t i = 0; a.tensor(i, &t); ++i) {
    const std::string name = t.name;
    if (name.compare(0, prefix.size() + 1, prefix + ".") != 0 || name == prefix + ".log_std") continue;
    if (name == prefix + ".0.weight") net.in = size_of(t.cols), net.hidden = size_of(t.rows);
    if (name == prefix + ".1.weight") net.out = size_of(t.rows);
    for (size_t k = 0; k < size_of(t.rows) * size_of(t.cols); ++k)
      net.p.push_back(static_cast<double>(t.data[k]));
  }
  return net;
}

inline Numbers numbers(const float* x, size_t n) {
  return Numbers(x, x + n);
}

inline Numbers normals(Stream& stream, size_t n) {
  std::vector<float> z(n);
  stream.normals(z.data(), static_cast<int>(n));
  return Numbers(z.begin(), z.end());
}

inline Numbers with_tanh(Numbers y) {
  for (double& v : y) v = std::tanh(v);
  return y;
}

// What a pair of critics says of a cost.
inline double larger(const PlainNet& one, const PlainNet& other, const Numbers& x) {
  return std::max(one(x)[0], other(x)[0]);
}

// KL of a latent vector, means and then log deviations, to N(0, 1), over its entries.
inline double kl_of(const Numbers& code) {
  const size_t n = code.size() / 2;
  double sum = 0;
  for (size_t j = 0; j < n; ++j)
    sum += 0.5 * (code[j] * code[j] + std::exp(2 * code[n + j]) - 1 - 2 * code[n + j]);
  return sum / static_cast<double>(n);
}

// Loss of a model of actions over rows, with noise z.
inline double model_loss_of(const PlainNet& encoder, const PlainNet& decoder, const std::vector<Numbers>& obs,
                            const std::vector<Numbers>& taken, const Numbers& z) {
  double sum = 0;
  const auto rows = static_cast<double>(obs.size());
  for (size_t i = 0; i < obs.size(); ++i) {
    const Numbers code = encoder(joined(obs[i], taken[i]));
    const size_t n = code.size() / 2;
    Numbers latent(n);
    for (size_t j = 0; j < n; ++j) latent[j] = code[j] + std::exp(code[n + j]) * z[i * n + j];
    const Numbers again = decoder(joined(obs[i], latent));
    for (size_t j = 0; j < again.size(); ++j)
      sum += std::pow(std::tanh(again[j]) - taken[i][j], 2) / (rows * static_cast<double>(again.size()));
    sum += 0.5 * kl_of(code) / rows;
  }
  return sum;
}

// Rows that were recorded, with episodes of several lengths.
struct Recorded {
  int32_t obs_dim, action_dim, cost_dim;
  std::vector<float> obs, action, reward, cost;
  std::vector<uint8_t> terminated, truncated;
  std::vector<int64_t> episode;
  Recorded(int32_t obs_dim, int32_t action_dim, int32_t cost_dim = 1)
      : obs_dim(obs_dim), action_dim(action_dim), cost_dim(cost_dim) {}

  LearnRows rows() const {
    return {static_cast<int64_t>(reward.size()),
            cost_dim,
            obs.data(),
            action.data(),
            reward.data(),
            cost.data(),
            terminated.data(),
            truncated.data(),
            episode.data()};
  }
  void add(int64_t of_episode, Stream& stream, bool ends = false, bool by_time = false) {
    for (int32_t j = 0; j < obs_dim; ++j) obs.push_back(static_cast<float>(stream.signed_unit()));
    for (int32_t j = 0; j < action_dim; ++j) action.push_back(static_cast<float>(stream.signed_unit()));
    for (int32_t j = 0; j < cost_dim; ++j) cost.push_back(static_cast<float>(stream.uniform()));
    reward.push_back(static_cast<float>(stream.signed_unit()));
    terminated.push_back(ends && !by_time);
    truncated.push_back(ends && by_time);
    episode.push_back(of_episode);
  }
};

// Episodes of noise, every third one cut by time, every fifth one unfinished.
inline Recorded noise(int32_t episodes, int32_t obs_dim, int32_t action_dim, int32_t cost_dim = 1,
                      uint64_t seed = 1) {
  Recorded r(obs_dim, action_dim, cost_dim);
  Stream stream(seed, 0, Purpose::kTest);
  for (int32_t e = 0; e < episodes; ++e) {
    const int32_t length = 1 + static_cast<int32_t>(stream.below(12));
    for (int32_t t = 0; t < length; ++t) r.add(e, stream, t + 1 == length && e % 5 != 4, e % 3 == 2);
  }
  return r;
}

// The limit on an episode's sum as a value of its first decision, where costs are spread evenly: values go on for ever
// where nothing terminated an episode.
inline double as_value(double limit, const Recorded& r, double discount) {
  double length = 0, values = 0;
  for (size_t i = 0, n = 0; i < r.reward.size(); ++i) {
    ++n;
    if (i + 1 < r.reward.size() && r.episode[i + 1] == r.episode[i]) continue;
    length += static_cast<double>(n);
    values += (r.terminated[i] ? 1 - std::pow(discount, n) : 1) / (1 - discount);
    n = 0;
  }
  return limit * values / length;
}

inline AgentSetup learner(const char* algo, const Recorded& r, const char* replay_rows, int32_t envs = 1) {
  AgentSetup s(
      algo, r.obs_dim, r.action_dim, envs,
      {{"hidden", "8", 0}, {"replay_rows", replay_rows, 0}, {"batch_rows", "16", 0}, {"cost_limit", "1", 0}});
  s.config.cost_dim = r.cost_dim;
  s.config.max_steps = 12;
  s.config.seed = 5;
  return s;
}

inline const Replay& memory_of(Agent& a) {
  return static_cast<ReplayAgent&>(a).replay();
}

// A learner of one small hidden layer and large steps, whose every step is told beside the same in double.
inline AgentSetup step_by_step(const char* algo, int32_t obs_dim, int32_t action_dim, const char* batch_rows,
                               const std::vector<OptionInput>& more) {
  AgentSetup s(algo, obs_dim, action_dim, 1,
               {{"hidden", "5", 0},
                {"activation", "tanh", 0},
                {"replay_rows", "200", 0},
                {"batch_rows", batch_rows, 0},
                {"learning_rate", "1e-2", 0},
                {"tau", "0.2", 0},
                {"discount", "0.9", 0},
                {"normalize_obs", "off", 0},
                {"last_layer_scale", "1", 0}});
  s.options.insert(s.options.end(), more.begin(), more.end());
  s.config.max_steps = 12;
  return s;
}

// The agent's networks are those that were computed, by the prefixes of their tensors.
inline void expect_nets(Agent& a, const std::vector<std::pair<const char*, const PlainNet*>>& nets,
                        double tolerance) {
  for (const auto& [name, wanted] : nets) {
    const PlainNet now = net_of(a, name);
    ASSERT_EQ(now.p.size(), wanted->p.size()) << name;
    for (size_t i = 0; i < now.p.size(); ++i)
      EXPECT_NEAR(now.p[i], wanted->p[i], tolerance) << name << ' ' << i;
  }
}

// The pairs of critics of the reward and of cost 0.
using PlainCritics = std::array<PlainNet, 4>;
inline constexpr const char* kCriticNames[] = {"reward_q1", "reward_q2", "cost0_q1", "cost0_q2"};
inline PlainCritics critics_of(Agent& a) {
  PlainCritics q;
  for (size_t k = 0; k < q.size(); ++k) q[k] = net_of(a, kCriticNames[k]);
  return q;
}
inline void expect_critics(Agent& a, const PlainCritics& q, double tolerance) {
  for (size_t k = 0; k < q.size(); ++k) expect_nets(a, {{kCriticNames[k], &q[k]}}, tolerance);
}

}  // namespace rdm::test
