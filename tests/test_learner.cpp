#include <cmath>
#include <limits>
#include <numeric>

#include "agents.hpp"
#include "algos/learner.hpp"
#include "algos/ppo.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

constexpr double kClip = 0.2;

// A learner with a rollout of random numbers; half of the ratios are pushed out of the clip.
struct Bench {
  AgentSetup setup;
  Plan plan;
  Arena arena;
  Networks nets;
  Lanes lanes;
  Rollout rollout;
  Learner learner;
  ClippedSurrogate loss;
  std::vector<int32_t> order;

  explicit Bench(AgentSetup s) : setup(std::move(s)), plan(make_plan(setup.ready())) {
    Arena measure;
    carve(measure);
    arena = Arena(host(), measure.used());
    carve(arena);
    lanes.open(host(), setup.config.num_threads);
    init_networks(nets, plan);
    learner.open(plan, rollout, nets, lanes);
    learner.read_live(plan.options);
    loss.clip = static_cast<float>(kClip);
    order.resize(size_of(plan.samples));
    std::iota(order.begin(), order.end(), 0);
    fill();
  }
  void carve(Arena& a) {
    nets = carve_networks(a, plan);
    lanes.carve(a, plan, nets.size);
    rollout = carve_rollout(a, plan);
    learner.carve(a, plan, nets.size);
  }
  void fill() {
    Stream s(5, 0, Purpose::kTest);
    const size_t n = size_of(plan.samples), a = plan.action_dim();
    const auto draw = [&](float* x, size_t count) {
      for (size_t i = 0; i < count; ++i) x[i] = static_cast<float>(s.signed_unit());
    };
    draw(rollout.obs, n * plan.obs_dim());
    draw(rollout.action, n * a);
    draw(rollout.gain, n);
    draw(rollout.linear, n);
    draw(rollout.target, n);
    draw(rollout.cost_target, n * size_of(plan.num_limited));
    for (size_t j = 0; j < a; ++j) rollout.log_std[j] = nets.log_std()[j] + plan.log_share;
    for (size_t i = 0; i < n; ++i) {
      const std::vector<double> m = network(params(), Networks::kActor, i);
      for (size_t j = 0; j < a; ++j)
        rollout.mean[i * a + j] = static_cast<float>(m[j] + 0.1 * s.signed_unit());
      const double push = i % 2 ? 0.1 * s.signed_unit() : std::log(1.5) * (i % 4 ? 1 : -1);
      rollout.log_prob[i] = static_cast<float>(log_prob(params(), i) - push);
    }
  }

  std::vector<double> params() const { return {nets.params, nets.params + nets.size}; }
  const float* obs(size_t i) const { return rollout.obs + i * plan.obs_dim(); }

  // The formulas again, in double.
  std::vector<double> network(const std::vector<double>& p, int32_t net, size_t row) const {
    const MlpShape& shape = nets.shape[net];
    std::vector<double> h(obs(row), obs(row) + plan.obs_dim());
    for (int32_t l = 0; l < shape.num_layers(); ++l) {
      const double* w = &p[nets.net_offset(net) + shape.weight_offset(l)];
      const double* b = &p[nets.net_offset(net) + shape.bias_offset(l)];
      std::vector<double> z(size_of(shape.layer_out(l)));
      for (size_t o = 0; o < z.size(); ++o) {
        z[o] = b[o];
        for (size_t i = 0; i < h.size(); ++i) z[o] += w[o * h.size() + i] * h[i];
        if (l < shape.num_hidden) z[o] = std::tanh(z[o]);
      }
      h = z;
    }
    return h;
  }
  double log_prob(const std::vector<double>& p, size_t row) const {
    const std::vector<double> m = network(p, Networks::kActor, row);
    double sum = 0;
    for (size_t j = 0; j < m.size(); ++j) {
      const double log_std = p[j] + static_cast<double>(plan.log_share);
      const double z = (static_cast<double>(rollout.action[row * m.size() + j]) - m[j]) / std::exp(log_std);
      sum += -z * z / 2 - log_std - 0.9189385332046727;
    }
    return sum;
  }
  double total_loss(const std::vector<double>& p) const {
    const double n = plan.samples;
    double sum = 0;
    for (size_t i = 0; i < size_of(plan.samples); ++i) {
      const double ratio = std::exp(log_prob(p, i) - static_cast<double>(rollout.log_prob[i]));
      const auto gain = static_cast<double>(rollout.gain[i]), linear = static_cast<double>(rollout.linear[i]);
      sum -= std::min(ratio * gain, std::clamp(ratio, 1 - kClip, 1 + kClip) * gain) + ratio * linear;
      const double v = network(p, Networks::kReward, i)[0] - static_cast<double>(rollout.target[i]);
      sum += v * v;
      const std::vector<double> c = network(p, Networks::kCost, i);
      for (size_t k = 0; k < c.size(); ++k) {
        const double e = c[k] - static_cast<double>(rollout.cost_target[i * c.size() + k]);
        sum += e * e;
      }
    }
    double penalty = 0;
    for (size_t j = 0; j < plan.action_dim(); ++j) penalty -= plan.options.number("entropy") * p[j];
    for (size_t j = nets.block[Networks::kReward].offset; j < nets.size; ++j)
      penalty += plan.options.number("critic_l2") * p[j] * p[j];
    return sum / n + penalty;
  }
};

AgentSetup small() {
  AgentSetup s("ppo_lag", 3, 2, 16);
  s.with("hidden", "5,4").with("horizon", "10").with("minibatches", "1").with("noise_correlation", "0.3");
  s.with("entropy", "0.01").with("critic_l2", "0.003").with("last_layer_scale", "1");
  return s;
}

}  // namespace

TEST(Learner, GradientIsTheFiniteDifferenceOfTheWholeLoss) {
  for (const int32_t costs : {1, 3}) {
    AgentSetup s = small();
    const double limits[] = {1, 2, 3};
    s.config.cost_dim = costs;
    s.config.cost_limits = limits;
    Bench b(std::move(s));
    ASSERT_EQ(b.plan.piece_rows, 64);  // 160 rows in 3 pieces
    const BatchSums sums = b.learner.gradient(&b.loss, true, b.order.data(), b.plan.samples);
    std::vector<double> p = b.params();
    double largest = 0;
    for (size_t j = 0; j < p.size(); ++j) {
      const double kept = p[j], h = 1e-6 * (1 + std::abs(kept));
      p[j] = kept + h;
      const double up = b.total_loss(p);
      p[j] = kept - h;
      const double down = b.total_loss(p);
      p[j] = kept;
      const double wanted = (up - down) / (2 * h);
      largest = std::max(largest, std::abs(wanted));
      EXPECT_NEAR(static_cast<double>(b.learner.gradient()[j]), wanted, 3e-6) << j;
    }
    EXPECT_GT(largest, 0.1);
    EXPECT_GT(sums.clipped, 20);
    EXPECT_LT(sums.clipped, 140);
    double kl = 0;
    for (size_t i = 0; i < b.order.size(); ++i) {
      const std::vector<double> m = b.network(p, Networks::kActor, i);
      for (size_t j = 0; j < m.size(); ++j) {
        const double d = static_cast<double>(b.rollout.mean[i * m.size() + j]) - m[j];
        kl += d * d / (2 * std::exp(2 * static_cast<double>(b.rollout.log_std[j])));
      }
    }
    EXPECT_NEAR(sums.kl, kl, 1e-4 * kl);
    EXPECT_NEAR(b.learner.kl(b.order.data(), b.plan.samples), kl / b.plan.samples,
                1e-4 * kl / b.plan.samples);
  }
}

TEST(Learner, CriticsAlone) {
  Bench b(small());
  b.learner.gradient(&b.loss, true, b.order.data(), b.plan.samples);
  const std::vector<float> both(b.learner.gradient(), b.learner.gradient() + b.nets.size);
  const std::vector<float> before(b.nets.params, b.nets.params + b.nets.size);
  b.learner.gradient(nullptr, true, b.order.data(), b.plan.samples);
  const size_t critics = b.nets.block[Networks::kReward].offset;
  for (size_t j = critics; j < b.nets.size; ++j) EXPECT_EQ(b.learner.gradient()[j], both[j]);
  b.learner.step(1e-3);
  size_t changed = 0;
  for (size_t j = 0; j < b.nets.size; ++j) {
    if (j < critics)
      EXPECT_EQ(b.nets.params[j], before[j]);
    else
      changed += b.nets.params[j] != before[j];
  }
  EXPECT_GT(changed, (b.nets.size - critics) / 2);
}

TEST(Learner, PolicyAlone) {
  Bench b(small());
  const std::vector<float> before(b.nets.params, b.nets.params + b.nets.size);
  b.learner.gradient(&b.loss, false, b.order.data(), b.plan.samples);
  b.learner.step(1e-3);
  const size_t critics = b.nets.block[Networks::kReward].offset;
  EXPECT_NE(b.nets.params[0], before[0]);
  for (size_t j = critics; j < b.nets.size; ++j) EXPECT_EQ(b.nets.params[j], before[j]);
}

TEST(Learner, AnyNumberOfLanesGivesTheSameBytes) {
  std::vector<float> wanted;
  for (const int32_t threads : {0, 2, 3, 4}) {
    AgentSetup s = small();
    s.config.num_threads = threads;
    Bench b(std::move(s));
    b.learner.gradient(&b.loss, true, b.order.data(), b.plan.samples);
    const std::vector<float> got(b.learner.gradient(), b.learner.gradient() + b.nets.size);
    if (threads == 0) wanted = got;
    EXPECT_EQ(0, std::memcmp(got.data(), wanted.data(), got.size() * sizeof(float))) << threads;
  }
}

TEST(Learner, FixedDeviationHasNoGradient) {
  AgentSetup s = small();
  Bench b(std::move(s.with("learn_std", "false")));
  b.learner.gradient(&b.loss, true, b.order.data(), b.plan.samples);
  EXPECT_EQ(b.learner.gradient()[0], 0);
  EXPECT_EQ(b.learner.gradient()[1], 0);
}

TEST(Learner, GradientThatIsNotFiniteLeavesItsNetworkAlone) {
  Bench b(small());
  b.rollout.target[7] = std::numeric_limits<float>::infinity();
  const std::vector<float> before(b.nets.params, b.nets.params + b.nets.size);
  b.learner.gradient(&b.loss, true, b.order.data(), b.plan.samples);
  b.learner.step(1e-3);
  EXPECT_EQ(b.learner.skipped(), 1);
  const Block& reward = b.nets.block[Networks::kReward];
  for (size_t j = reward.offset; j < reward.offset + reward.size; ++j) EXPECT_EQ(b.nets.params[j], before[j]);
  EXPECT_NE(b.nets.params[0], before[0]);
  EXPECT_NE(*b.nets.net(Networks::kCost), before[b.nets.net_offset(Networks::kCost)]);
}
