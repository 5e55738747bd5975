#include "algos/trust_region/conjugate_gradient.hpp"
#include "algos/trust_region/trust_region.hpp"
#include "golden_net.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

struct FisherBench {
  Bench& b;
  Arena arena;
  Fisher fisher;
  size_t size;
  explicit FisherBench(Bench& bench) : b(bench), size(bench.nets.block[Networks::kActor].size) {
    Arena measure;
    fisher.carve(measure, b.resolved);
    arena = Arena(HostHooks(), measure.used());
    fisher.carve(arena, b.resolved);
    fisher.open(b.resolved, b.rollout, b.nets, b.workers);
    fisher.read_live(kTrustRows.read(b.resolved.options));
    fisher.set_rows({b.order.data(), b.resolved.samples});
  }
  std::vector<float> times(const std::vector<float>& v) {
    std::vector<float> out(size);
    fisher.multiply(v.data(), out.data());
    return out;
  }
};

AgentSetup wide(const char* activation, int32_t threads = 0) {
  AgentSetup s("cpo", 7, 3, 50);
  s.with("hidden", "20,13").with("activation", activation).with("horizon", "9").with("last_layer_scale", "1");
  s.with("init_std", "0.7");
  s.config.num_threads = threads;
  return s;
}

std::vector<float> random_direction(const Bench& b, uint64_t seed) {
  std::vector<float> v(b.nets.block[Networks::kActor].size);
  Stream s(seed, 0, Purpose::kTest);
  for (float& x : v) x = static_cast<float>(s.signed_unit());
  for (size_t j = b.resolved.action_dim(); j < b.nets.std_size; ++j) v[j] = 0;
  return v;
}

// Mean KL(old || new) with the mean and deviation of `p` against those of the parameters.
double mean_kl(const Bench& b, const std::vector<double>& p) {
  double sum = 0;
  const std::vector<double> old = b.params();
  for (size_t i = 0; i < b.order.size(); ++i) sum += Bench::kl_of(b.head(old, i), b.head(p, i));
  return sum / static_cast<double>(b.order.size());
}

}  // namespace

TEST(Fisher, GoldenProduct) {
  AgentSetup s = GoldenNet::setup("cpo");
  s.with("cg_damping", "0");
  GoldenNet net(std::move(s));
  FisherBench f(net);
  std::vector<float> v(f.size);
  net.put(kGoldenV, v.data());
  expect_near(net.get(f.times(v).data()), kGoldenFv, 2e-7);
  EXPECT_NEAR(dot(v.data(), f.times(v).data(), f.size), 0.7355736709, 2e-7);
  std::vector<double> p = net.params();
  for (size_t i = 0; i < f.size; ++i) p[i] += 1e-3 * static_cast<double>(v[i]);
  EXPECT_NEAR(2e6 * mean_kl(net, p), 0.7358341476, 1e-6);
}

// A regression test: the peers average the KL over action dimensions, which halves F here and doubles the
// weight of the damping.
TEST(Fisher, MeanOverDimensionsIsAnOptionAndNotTheDefault) {
  AgentSetup s = GoldenNet::setup("cpo");
  s.with("cg_damping", "0.1").with("kl_mean_over_dims", "true");
  GoldenNet net(std::move(s));
  FisherBench f(net);
  std::vector<float> v(f.size);
  net.put(kGoldenV, v.data());
  std::vector<double> wanted(14);
  for (size_t i = 0; i < 14; ++i) wanted[i] = kGoldenFv[i] / 2 + 0.1 * kGoldenV[i];
  expect_near(net.get(f.times(v).data()), wanted.data(), 2e-7);
  const GoldenNet usual;
  EXPECT_FALSE(usual.resolved.options.flag("kl_mean_over_dims"));
}

TEST(Fisher, IsTheSecondDerivativeOfTheMeanKl) {
  for (const char* activation : {"tanh", "elu", "relu", "state"}) {
    const bool state = std::strcmp(activation, "state") == 0;
    Bench b(state ? with_state_std(wide("tanh")) : wide(activation));
    if (state) {
      EXPECT_GT(b.share_at_bound(), 0.1);
      EXPECT_LT(b.share_at_bound(), 0.9);
    }
    FisherBench f(b);
    const std::vector<float> v = random_direction(b, 3);
    const double damping = b.resolved.options.number("cg_damping");
    const double vfv = dot(v.data(), f.times(v).data(), f.size) - damping * dot(v.data(), v.data(), f.size);
    std::vector<double> p = b.params();
    const double h = 1e-5;
    for (size_t i = 0; i < v.size(); ++i) p[i] += h * static_cast<double>(v[i]);
    const double up = mean_kl(b, p);
    for (size_t i = 0; i < v.size(); ++i) p[i] -= 2 * h * static_cast<double>(v[i]);
    EXPECT_NEAR((up + mean_kl(b, p)) / (h * h), vfv, 2e-4 * vfv) << activation;
  }
}

namespace {

void expect_symmetric(AgentSetup s) {
  Bench b(std::move(s));
  FisherBench f(b);
  for (uint64_t seed = 0; seed < 10; ++seed) {
    const auto u = random_direction(b, 2 * seed), v = random_direction(b, 2 * seed + 1);
    const double uv = dot(u.data(), f.times(v).data(), f.size), vu = dot(v.data(), f.times(u).data(), f.size);
    EXPECT_NEAR(uv, vu, 1e-5 * std::max(1.0, std::abs(uv)));
    EXPECT_GT(dot(v.data(), f.times(v).data(), f.size), 0);
  }
}

}  // namespace

TEST(Fisher, IsSymmetricAndPositive) {
  expect_symmetric(wide("tanh"));
  expect_symmetric(with_state_std(wide("tanh")));
}

// v'F is the derivative along v of the gradient of the KL: here each of its entries by itself.
TEST(Fisher, ProductWithStateDeviationsIsTheDifferenceOfKlGradients) {
  AgentSetup s = with_state_std(wide("tanh"));
  s.with("cg_damping", "0").with("hidden", "6");
  Bench b(std::move(s));
  FisherBench f(b);
  const std::vector<float> v = random_direction(b, 5), fv = f.times(v);
  const double h = 1e-5;
  const auto slope = [&](double along, size_t j) {  // of the KL by parameter j, a step along v away
    std::vector<double> p = b.params();
    for (size_t i = 0; i < v.size(); ++i) p[i] += along * static_cast<double>(v[i]);
    p[j] += h;
    const double up = mean_kl(b, p);
    p[j] -= 2 * h;
    return (up - mean_kl(b, p)) / (2 * h);
  };
  double largest = 0;
  for (size_t j = 0; j < v.size(); ++j) {
    const double wanted = (slope(h, j) - slope(-h, j)) / (2 * h);
    largest = std::max(largest, std::abs(wanted));
    EXPECT_NEAR(static_cast<double>(fv[j]), wanted, 3e-4) << j;
  }
  EXPECT_GT(largest, 1);
}

TEST(Fisher, AnyNumberOfWorkersGivesTheSameBytes) {
  std::vector<float> wanted;
  for (const int32_t threads : {0, 2, 3, 4}) {
    Bench b(wide("tanh", threads));
    FisherBench f(b);
    const std::vector<float> got = f.times(random_direction(b, 5));
    if (threads == 0) wanted = got;
    EXPECT_EQ(0, std::memcmp(got.data(), wanted.data(), got.size() * sizeof(float))) << threads;
  }
}

TEST(Fisher, StrideTakesEveryNthRow) {
  AgentSetup s = wide("tanh");
  s.with("fisher_stride", "4");
  Bench b(std::move(s)), c(wide("tanh"));
  FisherBench f(b), g(c);
  std::vector<int32_t> fourth;
  for (size_t i = 0; i < c.order.size(); i += 4) fourth.push_back(c.order[i]);
  g.fisher.set_rows({fourth.data(), static_cast<int32_t>(fourth.size())});
  const auto v = random_direction(b, 7);
  EXPECT_EQ(f.times(v), g.times(v));
}
