// Critics of rows and actions: gradients against differences, layer normalisation, targets that follow.
#include <cmath>

#include "agents.hpp"
#include "algos/off_policy/q_critic.hpp"

namespace rdm::test {
namespace {

constexpr int32_t kObs = 5, kAction = 2, kRows = 40;

struct Critics {
  AgentSetup setup;
  ResolvedAgentConfig resolved;
  Arena arena;
  BatchWorkers workers;
  QCritics q;
  std::vector<float> x = std::vector<float>(kRows * (kObs + kAction));
  Critics(bool layer_norm, const char* activation, int32_t threads = 1)
      : setup("td3_lag", kObs, kAction, 1,
              {{"cost_limit", "1", 0}, {"hidden", "9,7", 0}, {"activation", activation, 0}}),
        resolved(resolve_config(setup.ready())) {
    Arena measure;
    workers.carve(measure, resolved, 16);
    q.carve(measure, resolved, layer_norm);
    arena = Arena(HostHooks(), measure.used());
    workers.carve(arena, resolved, 16);
    q.carve(arena, resolved, layer_norm);
    workers.open(HostHooks(), threads);
    q.open(resolved, workers);
    Stream stream(3, 0, Purpose::kTest);
    for (float& v : x) v = static_cast<float>(stream.signed_unit());
    for (int32_t pair = 0; pair < q.pairs(); ++pair)
      for (int32_t i = 0; i < kRows; ++i) q.y(pair)[i] = static_cast<float>(stream.signed_unit());
  }
  TensorInfo tensor(int32_t i) const {
    static char name[kTensorNameSize];
    TensorInfo t;
    EXPECT_TRUE(q.tensor(i, name, &t));
    return t;
  }
  double loss(int32_t net) {
    q.values(net, net + 1, false, x.data(), kRows);
    double sum = 0;
    for (int32_t i = 0; i < kRows; ++i) {
      const double e = static_cast<double>(q.out(net)[i]) - static_cast<double>(q.y(net / 2)[i]);
      sum += e * e / kRows;
    }
    return sum;
  }
};

}  // namespace

TEST(QCritic, TensorsHaveNamesOfTheirPairs) {
  Critics c(false, "tanh");
  char name[kTensorNameSize];
  TensorInfo t;
  std::string all;
  for (int32_t i = 0; c.q.tensor(i, name, &t); ++i) all += std::string(name) + ' ';
  EXPECT_EQ(all.substr(0, 54), "reward_q1.0.weight reward_q1.0.bias reward_q1.1.weight");
  EXPECT_NE(all.find("reward_q2.2.bias cost0_q1.0.weight"), std::string::npos) << all;
  EXPECT_NE(all.find("cost0_q2.2.bias"), std::string::npos) << all;
  EXPECT_FALSE(c.q.tensor(-1, name, &t));
}

// Of each network, with and without normalised layers: (f(p + h) - f(p - h)) / 2h of every seventh parameter.
TEST(QCritic, GradientIsThatOfTheSquaredError) {
  for (const bool norm : {false, true})
    for (const char* activation : {"tanh", "elu"}) {
      Critics c(norm, activation);
      c.q.gradients(0, c.q.count(), c.x.data(), kRows, 1.0f / kRows, true);
      double largest = 0;
      for (int32_t net = 0; net < c.q.count(); ++net) {
        EXPECT_NEAR(c.q.loss(net) / kRows, c.loss(net), 1e-6);
        const TensorInfo first = c.tensor(net * 6);
        for (size_t i = 0; i < 9 * 7 + 9 + 9 * 7; i += 7) {
          constexpr float kStep = 2e-3f;
          float& p = first.data[i];
          const float before = p;
          p = before + kStep;
          const double up = c.loss(net);
          p = before - kStep;
          const double down = c.loss(net);
          p = before;
          // Floats of a loss near 1 leave 1e-7 / 4e-3 of rounding; the third derivative h^2.
          EXPECT_NEAR(static_cast<double>(c.q.gradient(net)[i]),
                      (up - down) / (2.0 * static_cast<double>(kStep)), 3e-4)
              << net << ' ' << i << ' ' << activation << ' ' << norm;
          largest = std::max(largest, std::abs(up - down) / (2.0 * static_cast<double>(kStep)));
        }
      }
      EXPECT_GT(largest, 0.02);
    }
}

TEST(QCritic, PartsOfABatchAddUp) {
  Critics c(true, "tanh");
  c.q.gradients(0, c.q.count(), c.x.data(), kRows, 1.0f / kRows, true);
  const std::vector<float> whole(c.q.gradient(1), c.q.gradient(1) + 100);
  const int32_t half = kRows / 2;
  c.q.gradients(0, c.q.count(), c.x.data(), half, 1.0f / kRows, true);
  for (int32_t pair = 0; pair < c.q.pairs(); ++pair) std::copy_n(c.q.y(pair) + half, half, c.q.y(pair));
  c.q.gradients(0, c.q.count(), c.x.data() + half * (kObs + kAction), half, 1.0f / kRows, false);
  for (size_t i = 0; i < whole.size(); ++i) EXPECT_NEAR(c.q.gradient(1)[i], whole[i], 1e-6f);
}

TEST(QCritic, SlopesAreThoseByTheAction) {
  for (const bool norm : {false, true}) {
    Critics c(norm, "tanh");
    for (int32_t net = 0; net < c.q.count(); ++net)
      for (int32_t i = 0; i < kRows; ++i) c.q.weight(net)[i] = net == 1 ? 0.0f : 0.5f;
    c.q.values(0, c.q.count(), false, c.x.data(), kRows);
    c.q.slopes(0, c.q.count(), c.x.data(), kRows);
    for (const int32_t net : {0, 1, 2})
      for (size_t j = 0; j < kAction; ++j) {
        constexpr float kStep = 1e-2f;
        const float slope = c.q.slopes(net)[3 * kAction + j];
        float& a = c.x[3 * (kObs + kAction) + kObs + j];
        const float before = a;
        a = before + kStep;
        c.q.values(net, net + 1, false, c.x.data(), kRows);
        const float up = c.q.out(net)[3];
        a = before - kStep;
        c.q.values(net, net + 1, false, c.x.data(), kRows);
        const float down = c.q.out(net)[3];
        a = before;
        EXPECT_NEAR(slope, net == 1 ? 0 : 0.5f * (up - down) / (2 * kStep), 2e-4f) << net << ' ' << norm;
      }
  }
}

TEST(QCritic, NormalisedLayersDoNotHearTheScaleOfTheirInput) {
  Critics c(true, "tanh");
  for (const size_t i : {0u, 1u, 2u, 3u}) c.tensor(static_cast<int32_t>(i));
  const TensorInfo weight = c.tensor(0), bias = c.tensor(1);
  std::fill_n(bias.data, 9, 0.0f);
  c.q.values(0, 1, false, c.x.data(), kRows);
  const std::vector<float> before(c.q.out(0), c.q.out(0) + kRows);
  for (int32_t i = 0; i < weight.rows * weight.cols; ++i) weight.data[i] *= 64;
  c.q.values(0, 1, false, c.x.data(), kRows);
  for (size_t i = 0; i < before.size(); ++i) EXPECT_NEAR(c.q.out(0)[i], before[i], 1e-3f);
}

TEST(QCritic, SlowCopiesFollowByTheirShare) {
  Critics c(false, "tanh");
  const TensorInfo last = c.tensor(5);  // the output's bias of the first network
  c.q.values(0, 1, true, c.x.data(), kRows);
  const float before = c.q.out(0)[0];
  *last.data += 1;
  for (int k = 0; k < 2; ++k) {
    c.q.gradients(0, 1, c.x.data(), kRows, 0, true);  // no gradient: the networks stay
    c.q.step(0, 1, 1e-3, 0, 0.25);
  }
  c.q.values(0, 1, true, c.x.data(), kRows);
  EXPECT_NEAR(c.q.out(0)[0] - before, 1 - 0.75f * 0.75f, 1e-6f);
}

TEST(QCritic, AnyThreadsGiveTheSameBytes) {
  std::vector<float> wanted;
  for (const int32_t threads : {1, 3}) {
    Critics c(true, "relu", threads);
    for (int k = 0; k < 5; ++k) {
      c.q.gradients(0, c.q.count(), c.x.data(), kRows, 1.0f / kRows, true);
      c.q.step(0, c.q.count(), 1e-2, 1, 0.1);
    }
    c.q.values(0, c.q.count(), true, c.x.data(), kRows);
    const std::vector<float> out(c.q.out(0), c.q.out(0) + c.q.count() * kPartRows);
    if (wanted.empty()) wanted = out;
    EXPECT_EQ(out, wanted);
  }
}

}  // namespace rdm::test
