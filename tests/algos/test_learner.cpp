#include <limits>

#include "learner_bench.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

AgentSetup small() {
  AgentSetup s("ppo_lag", 3, 2, 16);
  s.with("hidden", "5,4").with("horizon", "10").with("minibatches", "1").with("noise_correlation", "0.3");
  s.with("entropy", "0.01").with("critic_l2", "0.003").with("last_layer_scale", "1");
  return s;
}

}  // namespace

TEST(Learner, GradientIsTheFiniteDifferenceOfTheWholeLoss) {
  for (const int32_t costs : {1, 3, -1}) {  // -1: one, with deviations that depend on the state
    AgentSetup s = costs < 0 ? with_state_std(small()) : small();
    const double limits[] = {1, 2, 3};
    s.config.cost_dim = std::abs(costs);
    s.config.cost_limits = limits;
    Bench b(std::move(s));
    ASSERT_EQ(b.resolved.chunk_rows, 64);  // 160 rows in 3 chunks
    const BatchSums sums = b.learner.gradient(&b.loss, true, {b.order.data(), b.resolved.samples});
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
    for (size_t i = 0; i < b.order.size(); ++i) kl += Bench::kl_of(b.acted(i), b.head(p, i));
    if (costs < 0) {
      EXPECT_GT(b.share_at_bound(), 0.1);
      EXPECT_LT(b.share_at_bound(), 0.9);
    }
    EXPECT_NEAR(sums.kl, kl, 1e-4 * kl);
    EXPECT_NEAR(b.learner.kl({b.order.data(), b.resolved.samples}), kl / b.resolved.samples,
                1e-4 * kl / b.resolved.samples);
  }
}

TEST(Learner, CriticsAlone) {
  Bench b(small());
  b.learner.gradient(&b.loss, true, {b.order.data(), b.resolved.samples});
  const std::vector<float> both(b.learner.gradient(), b.learner.gradient() + b.nets.size);
  const std::vector<float> before(b.nets.params, b.nets.params + b.nets.size);
  b.learner.gradient(nullptr, true, {b.order.data(), b.resolved.samples});
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
  b.learner.gradient(&b.loss, false, {b.order.data(), b.resolved.samples});
  b.learner.step(1e-3);
  const size_t critics = b.nets.block[Networks::kReward].offset;
  EXPECT_NE(b.nets.params[0], before[0]);
  for (size_t j = critics; j < b.nets.size; ++j) EXPECT_EQ(b.nets.params[j], before[j]);
}

TEST(Learner, AnyNumberOfWorkersGivesTheSameBytes) {
  std::vector<float> wanted;
  for (const int32_t threads : {0, 2, 3, 4}) {
    AgentSetup s = small();
    s.config.num_threads = threads;
    Bench b(std::move(s));
    b.learner.gradient(&b.loss, true, {b.order.data(), b.resolved.samples});
    const std::vector<float> got(b.learner.gradient(), b.learner.gradient() + b.nets.size);
    if (threads == 0) wanted = got;
    EXPECT_EQ(0, std::memcmp(got.data(), wanted.data(), got.size() * sizeof(float))) << threads;
  }
}

TEST(Learner, FixedDeviationHasNoGradient) {
  AgentSetup s = small();
  Bench b(std::move(s.with("learn_std", "false")));
  b.learner.gradient(&b.loss, true, {b.order.data(), b.resolved.samples});
  EXPECT_EQ(b.learner.gradient()[0], 0);
  EXPECT_EQ(b.learner.gradient()[1], 0);
}

TEST(Learner, GradientThatIsNotFiniteLeavesItsNetworkAlone) {
  Bench b(small());
  b.rollout.target[7] = std::numeric_limits<float>::infinity();
  const std::vector<float> before(b.nets.params, b.nets.params + b.nets.size);
  b.learner.gradient(&b.loss, true, {b.order.data(), b.resolved.samples});
  b.learner.step(1e-3);
  EXPECT_EQ(b.learner.skipped(), 1);
  const Block& reward = b.nets.block[Networks::kReward];
  for (size_t j = reward.offset; j < reward.offset + reward.size; ++j) EXPECT_EQ(b.nets.params[j], before[j]);
  EXPECT_NE(b.nets.params[0], before[0]);
  EXPECT_NE(*b.nets.net(Networks::kCost), before[b.nets.net_offset(Networks::kCost)]);
}

TEST(Learner, ClippedValuesAreTheLargerError) {
  AgentSetup s = small();
  Bench b(std::move(s.with("value_clip", "0.05").with("critic_l2", "0")));
  Stream stream(9, 0, Purpose::kTest);
  for (size_t i = 0; i < b.order.size(); ++i) {
    b.rollout.value[i] =
        static_cast<float>(b.network(b.params(), Networks::kReward, i)[0] + 0.1 * stream.signed_unit());
    b.rollout.cost_value[i] = static_cast<float>(stream.signed_unit());
  }
  b.learner.gradient(nullptr, true, {b.order.data(), b.resolved.samples});
  const auto total = [&](const std::vector<double>& p) {
    double sum = 0;
    for (size_t i = 0; i < b.order.size(); ++i)
      for (const int32_t net : {Networks::kReward, Networks::kCost}) {
        const bool reward = net == Networks::kReward;
        const double v = b.network(p, net, i)[0];
        const auto old = static_cast<double>((reward ? b.rollout.value : b.rollout.cost_value)[i]);
        const auto target = static_cast<double>((reward ? b.rollout.target : b.rollout.cost_target)[i]);
        const double held = old + std::clamp(v - old, -0.05, 0.05);
        sum += std::max((v - target) * (v - target), (held - target) * (held - target));
      }
    return sum / b.resolved.samples;
  };
  std::vector<double> p = b.params();
  for (size_t j = b.nets.block[Networks::kReward].offset; j < b.nets.size; ++j) {
    const double kept = p[j], h = 1e-6 * (1 + std::abs(kept));
    p[j] = kept + h;
    const double up = total(p);
    p[j] = kept - h;
    const double down = total(p);
    p[j] = kept;
    EXPECT_NEAR(static_cast<double>(b.learner.gradient()[j]), (up - down) / (2 * h), 5e-6) << j;
  }
}

TEST(Learner, JointNormBoundsAllNetworksTogether) {
  AgentSetup s = small();
  Bench b(std::move(s.with("joint_grad_norm", "on").with("max_grad_norm", "0.1")));
  b.learner.gradient(&b.loss, true, {b.order.data(), b.resolved.samples});
  std::vector<double> before(b.learner.gradient(), b.learner.gradient() + b.nets.size);
  double norm = 0;
  for (const double x : before) norm += x * x;
  norm = std::sqrt(norm);
  ASSERT_GT(norm, 0.1);
  b.learner.step(1e-3);
  for (size_t j = 0; j < before.size(); ++j)
    EXPECT_NEAR(static_cast<double>(b.learner.gradient()[j]), before[j] * 0.1 / norm, 1e-6);
}

TEST(Learner, CriticsMayFollowTheActorsRate) {
  for (const char* schedule : {"constant", "actor"}) {
    AgentSetup s = small();
    Bench b(std::move(s.with("critic_lr_schedule", schedule)));
    const std::vector<double> before = b.params();
    b.learner.gradient(nullptr, true, {b.order.data(), b.resolved.samples});
    b.learner.step(1e-3, 0);
    EXPECT_EQ(b.params() == before, std::string(schedule) == "actor");
  }
}
