// TD3+BC with limits (Fujimoto and Gu 2021, "A minimalist approach to offline reinforcement learning"): TD3 whose policy
// stays near what was done, for the critics know nothing of other actions.
//
//   actor   -bc_alpha G / N + mean of (pi(s) - a)^2
//     G     mean of (Q_1 - sum l_k max Q_k)(s, pi(s)) / (1 + sum l_k), what td3_lag climbs
//     N     mean of (|Q_1| + sum l_k |max Q_k|) / (1 + sum l_k), without a gradient: bc_alpha has no unit
//     a     the recorded action
//
// Rows are of a recording (off_policy/learn.cpp) or of worlds: then it goes on from what was recorded.
#include <algorithm>

#include "algos/algo_registry.hpp"
#include "algos/lagrange/lagrange.hpp"
#include "algos/off_policy/td3.hpp"

namespace rdm {
namespace {

struct BcOptions {
  double bc_alpha;
};
constexpr auto kBcRows = option_rows<BcOptions>(row<&BcOptions::bc_alpha>(basic(
    number_option("bc_alpha", 2.5, 0, 1e6,
                  "weight of the critics beside the distance to the recorded actions; 0: cloning", true))));

class Td3Bc : public Td3 {
 public:
  explicit Td3Bc(ResolvedAgentConfig&& resolved) : Td3(std::move(resolved)) {}

 protected:
  void read_live() override {
    Td3::read_live();
    own_ = kBcRows.read(options());
  }

  double critics_share(int32_t rows) override {
    double sum = 0, weights = 1;
    for (int32_t pair = 0; pair < critics().pairs(); ++pair) {
      const float *one = critics().out(2 * pair), *other = critics().out(2 * pair + 1);
      const double weight = pair == 0 ? 1 : cost_weight(pair - 1);
      for (int32_t i = 0; i < rows; ++i)
        sum += weight * std::abs(static_cast<double>(pair == 0 ? one[i] : std::max(one[i], other[i])));
      weights += pair == 0 ? 0 : weight;
    }
    return own_.bc_alpha / std::max(sum / (rows * weights), kLeastScale);
  }

  double learn_actions(const float* seen, int32_t rows, float* slope, float, float* grad) override {
    const size_t dim = resolved().action_dim();
    const double share = 1.0 / (off_options().batch_rows * static_cast<double>(dim));
    double loss = 0;
    for (int32_t i = 0; i < rows; ++i) {
      const float* const done = replay().action(drawn(i));
      for (size_t j = 0; j < dim; ++j) {
        const size_t at = count_of(i) * dim + j;
        const auto away = static_cast<double>(head()[at] - done[j]);
        slope[at] += static_cast<float>(2 * share * away);
        loss += share * away * away;
      }
    }
    return loss + Td3::learn_actions(seen, rows, slope, 0, grad);
  }

 private:
  BcOptions own_{};
};

struct Td3BcLagOptions : Td3Options, BcOptions, LagrangeOptions, WindowOptions {};
constexpr auto kTd3BcLagRows =
    option_rows<Td3BcLagOptions>(kTd3Rows, kBcRows, kLagrangeRows, kReplayWindowRows);

}  // namespace

constinit const AlgoRow kTd3BcLag = replay_row<Weighed<Td3Bc, Lagrange>>(
    "td3_bc_lag",
    "TD3 near recorded actions, from a data set alone, with a multiplier for each limit (Fujimoto, Gu 2021)",
    kTd3BcLagRows, Costs::kAny);

}  // namespace rdm
