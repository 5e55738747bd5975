// Losses, gradients and a Fisher product against torch's autograd, and CUP's projection against complex steps:
// tests/oracle/losses.py and projection.py make the vectors.
#include "algos/lagrange/cup.hpp"
#include "algos/lagrange/focops.hpp"
#include "algos/penalty/p3o.hpp"
#include "algos/trust_region/trust_region.hpp"
#include "learner_bench.hpp"
#include "oracle_losses.hpp"
#include "oracle_projection.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

constexpr size_t kObs = 5, kHidden = 7, kAct = 3, kRows = 24;
constexpr size_t kSizes[] = {kAct, kHidden* kObs, kHidden, kAct* kHidden, kAct};
constexpr double kScales[] = {0.5, 0.5, 0.25, 0.5, 0.25};

double wave(size_t i, size_t k) {
  const auto n = static_cast<long>((i * (2 * k + 3) * 37 + k * 101 + i * i * 11) % 129);
  return static_cast<double>(n - 64) / 64;
}
void put(float* x, size_t n, size_t k, double scale = 1) {
  for (size_t i = 0; i < n; ++i) x[i] = static_cast<float>(scale * wave(i, k));
}

struct Oracle : Bench {
  static AgentSetup setup() {
    static const double limits[] = {1, 1};
    AgentSetup s("p3o", kObs, kAct, kRows);
    s.config.cost_dim = 2;
    s.config.cost_limits = limits;
    s.with("hidden", "7").with("horizon", "1").with("minibatches", "1");
    return s;
  }
  Oracle() : Bench(setup()) {
    float* net = nets.params + nets.std_size;
    put(nets.params, kAct, 0, kScales[0]);
    for (size_t k = 1; k < 5; ++k) {
      put(net, kSizes[k], k, kScales[k]);
      net += kSizes[k];
    }
    put(rollout.obs, kRows * kObs, 5);
    put(rollout.action, kRows * kAct, 6);
    put(rollout.gain, kRows, 7);
    std::fill_n(rollout.linear, kRows, 0.0f);
    const float shift[] = {0.0625f, -0.03125f, 0.015625f};
    for (size_t j = 0; j < kAct; ++j) rollout.log_std[j] = nets.params[j] + shift[j];
    for (size_t i = 0; i < kRows; ++i) {
      rollout.cost_advantage[2 * i] = static_cast<float>(wave(i, 8));
      rollout.cost_advantage[2 * i + 1] = static_cast<float>(wave(i, 9));
      const std::vector<double> now = network(params(), Networks::kActor, i);
      double old = 0;
      for (size_t j = 0; j < kAct; ++j) {
        const double mean = now[j] + 0.125 * wave(i * kAct + j, 10);
        const auto log_std = static_cast<double>(rollout.log_std[j]);
        const double z = (static_cast<double>(rollout.action[i * kAct + j]) - mean) / std::exp(log_std);
        rollout.mean[i * kAct + j] = static_cast<float>(mean);
        old -= z * z / 2 + log_std + 0.9189385332046727;
      }
      rollout.log_prob[i] = static_cast<float>(old + 0.25 * wave(i, 11));
    }
  }
  // gain = reward a + cost b, linear = cost c.
  void mix(double a, double b, double c) {
    for (size_t i = 0; i < kRows; ++i) {
      rollout.gain[i] = static_cast<float>(a * wave(i, 7) + b * wave(i, 8));
      rollout.linear[i] = static_cast<float>(c * wave(i, 8));
    }
  }
  void expect(const PolicyLoss& loss, const double* wanted, const char* name) {
    const BatchSums sums = learner.gradient(&loss, false, {order.data(), kRows});
    EXPECT_NEAR(sums.loss / kRows, wanted[0], 2e-6) << name;
    double largest = 0;
    for (size_t j = 0; j < size(); ++j) {
      const double w = wanted[1 + j];
      EXPECT_NEAR(static_cast<double>(learner.gradient()[place(j)]), w, 3e-6) << name << " " << j;
      largest = std::max(largest, std::abs(w));
    }
    EXPECT_GT(largest, 0.05) << name;
  }
  static size_t size() { return kAct + kHidden * kObs + kHidden + kAct * kHidden + kAct; }
  size_t place(size_t j) const { return j < kAct ? j : nets.std_size + j - kAct; }
};

}  // namespace

TEST(Oracle, LossesAndGradients) {
  Oracle o;
  constexpr double kNu = 0.3;
  ClippedSurrogate clip;
  o.expect(clip, oracle::kPpo, "ppo");
  o.expect(GainLoss(), oracle::kTrust, "trust");
  o.expect(CostLoss(0), oracle::kCost, "cost");
  PenalizedSurrogate penalty;
  penalty.weight[0] = 3, penalty.weight[1] = 0.5f;
  o.expect(penalty, oracle::kP3o, "p3o");
  o.mix(1, -kNu, 0);
  o.expect(FocopsLoss(), oracle::kFocops, "focops");
  o.mix(1 / (1 + kNu), -kNu / (1 + kNu), 0);
  o.expect(clip, oracle::kPpoLag, "ppo_lag");
  o.mix(1 / (1 + kNu), 0, -kNu / (1 + kNu));
  o.expect(clip, oracle::kSplit, "split");
}

TEST(Oracle, Projection) {
  Oracle o;
  std::vector<float> half(kRows * kAct), half_std(kAct);
  const float shift[] = {-0.125f, 0.0625f, 0.03125f};
  for (size_t i = 0; i < kRows; ++i) {
    const std::vector<double> now = o.network(o.params(), Networks::kActor, i);
    for (size_t j = 0; j < kAct; ++j)
      half[i * kAct + j] = static_cast<float>(now[j] + 0.25 * wave(i * kAct + j, 13));
  }
  for (size_t j = 0; j < kAct; ++j) half_std[j] = o.nets.params[j] + shift[j];
  ProjectionLoss loss;
  loss.weight[0] = 0.6f, loss.weight[1] = 0.25f;
  loss.mean = half.data(), loss.mean_step = kAct, loss.log_std = half_std.data();
  o.expect(loss, oracle::kProjection, "projection");
}

TEST(Oracle, FisherProduct) {
  Oracle o;
  AgentSetup s("cpo", kObs, kAct, kRows);
  s.with("hidden", "7").with("cg_damping", "0");
  const ResolvedAgentConfig resolved = resolve_config(s.ready());
  Fisher f;
  Arena measure;
  f.carve(measure, resolved);
  Arena arena(HostHooks(), measure.used());
  f.carve(arena, resolved);
  f.open(resolved, o.rollout, o.nets, o.workers);
  f.read_live(kTrustRows.read(resolved.options));
  f.set_rows({o.order.data(), kRows});
  std::vector<float> v(o.nets.block[Networks::kActor].size), out(v.size());
  for (size_t j = 0; j < Oracle::size(); ++j) v[o.place(j)] = static_cast<float>(wave(j, 12));
  f.multiply(v.data(), out.data());
  for (size_t j = 0; j < Oracle::size(); ++j)
    EXPECT_NEAR(static_cast<double>(out[o.place(j)]), oracle::kFisher[j], 1e-5) << j;
}
