// COptiDICE: each step of its networks, multiplier and bound beside the same in double, and a problem whose weights have a
// closed form.
#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "offline_oracle.hpp"

namespace rdm::test {
namespace {

constexpr size_t kObs = 3, kAction = 2;
constexpr double kRate = 1e-2, kLambdaRate = 0.1, kAlpha = 0.7;
constexpr double kLeastStd = 0.4, kMostStd = 0.6;

AgentSetup dice(const Recorded& r, const std::vector<OptionInput>& more) {
  AgentSetup s("coptidice", r.obs_dim, r.action_dim, 1,
               {{"hidden", "5", 0},
                {"activation", "tanh", 0},
                {"replay_rows", "200", 0},
                {"learning_rate", "1e-2", 0},
                {"normalize_obs", "off", 0},
                {"last_layer_scale", "1", 0},
                {"dice_alpha", "0.7", 0},
                {"std_min", "0.4", 0},
                {"std_max", "0.6", 0},
                {"multiplier_init", "0.6", 0},
                {"multiplier_lr", "0.1", 0}});
  s.options.insert(s.options.end(), more.begin(), more.end());
  s.config.max_steps = 12;
  return s;
}

// f and the w at which w x - f(w) is largest, by their definitions.
struct Divergence {
  const char* name;
  double (*f)(double w);
  double (*best)(double x);
};
double entropy(double w) {
  return w > 0 ? w * std::log(w) - w + 1 : 1;
}
double square(double w) {
  return 0.5 * (w - 1) * (w - 1);
}
const Divergence kDivergences[] = {{"soft_chi2", [](double w) { return w < 1 ? entropy(w) : square(w); },
                                    [](double x) { return x < 0 ? std::exp(x) : x + 1; }},
                                   {"chi2", square, [](double x) { return std::max(x + 1, 0.0); }},
                                   {"kl", entropy, [](double x) { return std::exp(x); }}};

// A number by its logarithm.
struct PlainPositive {
  Numbers log;
  PlainAdam adam;
  double value() const { return std::exp(log[0]); }
  void step(double slope, double rate) { adam.step(log, {slope * value()}, rate); }
};

// Standard deviation of the rewards that can be drawn, which is their unit.
double deviation_of(const Replay& m) {
  Numbers rewards;
  for (int32_t i = 0; i < m.capacity(); ++i)
    if (m.drawable(i)) rewards.push_back(static_cast<double>(m.reward(i)));
  double sum = 0, squares = 0;
  for (const double r : rewards) sum += r / static_cast<double>(rewards.size());
  for (const double r : rewards) squares += (r - sum) * (r - sum) / static_cast<double>(rewards.size());
  return std::sqrt(squares);
}

struct Bounds {
  int within = 0, stood = 0, came_back = 0;
};

// Steps with rows by the same stream. bound: the option cost_bound. Counts deviations of the policy in bounds.
void compare(const Divergence& divergence, double bound, int32_t batch, int32_t steps, Bounds& bounds,
             const char* discount = "0.9") {
  SCOPED_TRACE(divergence.name);
  const Recorded r = noise(12, kObs, kAction);
  const std::string batch_rows = std::to_string(batch), cost_bound = std::to_string(bound);
  AgentSetup s = dice(r, {{"divergence", divergence.name, 0},
                          {"batch_rows", batch_rows.c_str(), 0},
                          {"cost_bound", cost_bound.c_str(), 0},
                          {"discount", discount, 0},
                          {"cost_limit", "1", 0}});
  const AgentPtr a = s.make();
  a->learn(r.rows(), 0);
  const auto count = static_cast<size_t>(batch);
  const auto n = static_cast<double>(batch);
  PlainNet actor = net_of(*a, "actor"), nu = net_of(*a, "nu"), chi = net_of(*a, "chi0");
  ASSERT_EQ(chi.p.empty(), bound == 0);
  PlainAdam actor_adam, nu_adam, chi_adam;
  PlainPositive tau{{0}, {}}, lambda{{std::log(0.6)}, {}};
  // Episodes have so many decisions, and a value is over discounts of this sum; the limit as a mean cost of rows.
  const double length = static_cast<double>(r.reward.size()) / static_cast<double>(r.episode.back() + 1),
               given = std::strtod(discount, nullptr),
               horizon = given < 1 ? as_value(length, r, given) : length, limit = 1 / length,
               longest = given < 1 ? 1 : 1 - 1 / length;
  const Replay& m = memory_of(*a);
  const double unit = deviation_of(m);
  // First rows of the episodes that can be drawn; the rewards of the recording tell rows apart.
  std::vector<int32_t> starts;
  for (int32_t i = 0; i < m.capacity(); ++i)
    for (size_t k = 0; m.drawable(i) && k < r.reward.size(); ++k)
      if (r.reward[k] == m.reward(i) && (k == 0 || r.episode[k] != r.episode[k - 1])) starts.push_back(i);
  Stream draws(s.config.seed, 1 << 20, Purpose::kMinibatch);
  for (int step = 0; step < steps; ++step) {
    SCOPED_TRACE("step " + std::to_string(step));
    std::vector<int32_t> rows(count);
    m.draw(draws, batch, rows.data());
    std::vector<Numbers> obs, next, first, taken;
    Numbers reward, cost, d;
    for (const int32_t i : rows) {
      obs.push_back(numbers(m.obs(i), kObs)), next.push_back(numbers(m.next_obs(i), kObs));
      taken.push_back(numbers(m.action(i), kAction));
      reward.push_back(static_cast<double>(m.reward(i)) / unit),
          cost.push_back(static_cast<double>(m.cost(i)[0]));
      d.push_back(std::min(static_cast<double>(m.discount(i)), longest));
      first.push_back(numbers(m.obs(starts[draws.below(static_cast<uint32_t>(starts.size()))]), kObs));
    }
    const auto e = [&](size_t i) {
      return reward[i] - lambda.value() * cost[i] + d[i] * nu(next[i])[0] - nu(obs[i])[0];
    };
    Numbers w;
    for (size_t i = 0; i < count; ++i) w.push_back(divergence.best(e(i) / kAlpha));
    const Numbers nu_slope = differences(nu.p, [&] {
      double sum = 0;
      for (size_t i = 0; i < count; ++i) {
        const double best = divergence.best(e(i) / kAlpha);
        sum += nu(first[i])[0] / horizon + best * e(i) - kAlpha * divergence.f(best);
      }
      return sum / n;
    });
    // A deviation beyond a bound is at it; it stands still there but where it would come back.
    Numbers log_std, moved;
    std::vector<bool> stands;
    for (size_t i = 0; i < count; ++i) {
      const Numbers y = actor(obs[i]);
      for (size_t j = 0; j < kAction; ++j) {
        const double given = y[kAction + j],
                     held = std::clamp(given, std::log(kLeastStd), std::log(kMostStd));
        const double z = (taken[i][j] - std::tanh(y[j])) / std::exp(held);
        const bool out = given != held, leaves = out && (given < held) == (z * z < 1);
        log_std.push_back(held), moved.push_back(held - given), stands.push_back(leaves);
        ++(leaves ? bounds.stood : out ? bounds.came_back : bounds.within);
      }
    }
    const Numbers actor_slope = differences(actor.p, [&] {
      double sum = 0;
      for (size_t i = 0; i < count; ++i) {
        const Numbers y = actor(obs[i]);
        for (size_t j = 0; j < kAction; ++j) {
          const size_t at = i * kAction + j;
          const double log = stands[at] ? log_std[at] : y[kAction + j] + moved[at],
                       z = (taken[i][j] - std::tanh(y[j])) / std::exp(log);
          sum += w[i] * (0.5 * z * z + log) / n;
        }
      }
      return sum;
    });
    double paid = 0;
    for (size_t i = 0; i < count; ++i) paid += w[i] * cost[i] / n;
    if (bound > 0) {
      const auto z = [&](size_t i) {
        return chi(first[i])[0] / horizon + w[i] * (cost[i] + d[i] * chi(next[i])[0] - chi(obs[i])[0]);
      };
      const auto mean = [&] {  // of e^(z / tau)
        double sum = 0;
        for (size_t i = 0; i < count; ++i) sum += std::exp(z(i) / tau.value()) / n;
        return sum;
      };
      const double whole = mean();
      paid = 0;
      for (size_t i = 0; i < count; ++i) paid += std::exp(z(i) / tau.value()) / whole * w[i] * cost[i] / n;
      const auto upper = [&] { return tau.value() * (std::log(mean()) + bound); };
      const Numbers chi_slope = differences(chi.p, upper), tau_slope = differences(tau.log, upper);
      chi_adam.step(chi.p, chi_slope, kRate);
      tau.adam.step(tau.log, tau_slope, kRate);
    }
    nu_adam.step(nu.p, nu_slope, kRate);
    actor_adam.step(actor.p, actor_slope, kRate);
    lambda.step(limit - paid, kLambdaRate);
    const LearnReport report = a->learn(r.rows(), 1);
    EXPECT_NEAR(report.multiplier[0], unit * lambda.value(), 1e-4);
    expect_nets(*a, {{"actor", &actor}, {"nu", &nu}}, 3e-4);
    if (bound > 0) expect_nets(*a, {{"chi0", &chi}}, 3e-4);
    ASSERT_FALSE(::testing::Test::HasFailure());
  }
}

}  // namespace

TEST(COptiDice, StepsAreThoseInDouble) {
  Bounds bounds;
  for (const Divergence& divergence : kDivergences)
    for (const double bound : {0.0, 0.05}) {
      compare(divergence, bound, 10, 8, bounds);
      ASSERT_FALSE(HasFailure()) << bound;
    }
  compare(kDivergences[0], 0.05, 300, 3, bounds);  // in two parts
  compare(kDivergences[0], 0.05, 10, 8, bounds, "1");
  EXPECT_GT(bounds.within, 100);
  EXPECT_GT(bounds.stood, 20);
  EXPECT_GT(bounds.came_back, 20);
}

// One state, episodes of one decision a in {-1, -0.9, .., 1} that pays a and, above 0, costs a. With chi2 and no weight at 0
//
//   w = 1 + (r - l c - mean of it) / alpha,  and l by mean of w c = limit
//
// so the multiplier, the cost and the policy's mean are known.
TEST(COptiDice, FindsTheWeightsOfAClosedForm) {
  Recorded r(1, 1);
  double mean_r = 0, mean_c = 0, rr = 0, rc = 0, cc = 0;
  constexpr int kRows = 21;
  const auto action = [](int i) { return 0.1 * (i - 10); };
  for (int i = 0; i < kRows; ++i) {
    const double a = action(i), c = std::max(a, 0.0);
    r.obs.push_back(0.5f), r.action.push_back(static_cast<float>(a)),
        r.reward.push_back(static_cast<float>(a));
    r.cost.push_back(static_cast<float>(c)), r.terminated.push_back(1), r.truncated.push_back(0);
    r.episode.push_back(i);
    mean_r += a / kRows, mean_c += c / kRows, rr += a * a / kRows, rc += a * c / kRows, cc += c * c / kRows;
  }
  // In units of the reward's deviation alpha is 2.
  const double unit = std::sqrt(rr - mean_r * mean_r), own_alpha = 2 * unit;
  constexpr double kLimit = 0.26;
  const double cov = rc - mean_r * mean_c, var = cc - mean_c * mean_c;
  const double lambda = (cov - own_alpha * (kLimit - mean_c)) / var;
  ASSERT_GT(lambda, 0.1);
  double whole = 0, mean = 0;
  for (int i = 0; i < kRows; ++i) {
    const double a = action(i);
    const double w = 1 + (a - lambda * std::max(a, 0.0) - mean_r + lambda * mean_c) / own_alpha;
    ASSERT_GT(w, 0);
    whole += w, mean += w * a;
  }
  AgentSetup s = dice(r, {{"divergence", "chi2", 0},
                          {"cost_bound", "0", 0},
                          {"batch_rows", "210", 0},
                          {"discount", "1", 0},
                          {"dice_alpha", "2", 0},
                          {"cost_limit", "0.26", 0},
                          {"learning_rate", "3e-3", 0},
                          {"multiplier_lr", "3e-3", 0}});
  const AgentPtr a = s.make();
  a->learn(r.rows(), 3000);
  const LearnReport report = a->learn(r.rows(), 100);
  EXPECT_NEAR(report.multiplier[0], lambda, 0.05 * lambda);
  EXPECT_NEAR(report.cost[0], kLimit, 0.02 * kLimit);
  const float obs = 0.5f;
  float act = 0;
  a->act(&obs, false, &act);
  EXPECT_NEAR(static_cast<double>(act), mean / whole, 0.02);
}

TEST(COptiDice, RefusesUnknownDivergences) {
  const Recorded r = noise(4, kObs, kAction);
  AgentSetup s = dice(r, {{"divergence", "soft_chi", 0}});
  EXPECT_NE(thrown([&] { s.make(); }).text.find("soft_chi2"), std::string::npos);
}

}  // namespace rdm::test
