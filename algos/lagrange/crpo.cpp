// CRPO (Xu, Liang and Lan 2021, "CRPO: a new approach for safe reinforcement learning with convergence
// guarantee", algorithm 1): natural policy gradient, without dual variables. In each epoch
//
//   J_ck <= d_k + tolerance for every k:   the step raises the reward
//   else:                                  the step lowers one cost that is above, and nothing else
//
// Departures: the step is TRPO's, of a given KL, where the paper's has a given rate; of several costs that are
// above the one with the largest excess is lowered, where the paper takes any; the paper puts out one of the
// iterates that kept the limits, here the last one is the policy. J_c is a mean over finished episodes
// (multiplier_window); with a long window the policy goes on past the limit before it turns.
#include "algos/algo_registry.hpp"
#include "algos/core/option_tables.hpp"
#include "algos/lagrange/cost_weighted.hpp"
#include "algos/trust_region/trpo.hpp"

namespace rdm {
namespace {

struct CrpoOwnOptions {
  double tolerance;
};
constexpr auto kCrpoOwnRows = option_rows<CrpoOwnOptions>(row<&CrpoOwnOptions::tolerance>(
    basic(number_option("crpo_tolerance", 0, 0, kHuge,
                        "amount by which J_c may exceed its limit before the cost is lowered", true))));

// 1 for the cost that the step serves; with Mix::kDifference the advantage is then -A_c, else A_r.
class Rectify {
 public:
  explicit Rectify(const ResolvedAgentConfig& resolved) { read_live(resolved.options); }
  void step(const JudgedCosts& costs, int32_t) {
    if (!costs.any_known()) return;
    served_ = -1;
    double most = tolerance_;
    for (int32_t i = 0; i < costs.count; ++i)
      if (costs.known[i] && costs.excess(i) > most) served_ = i, most = costs.excess(i);
  }
  double weight(int32_t i) const { return i == served_ ? 1 : 0; }
  Mix mix() const { return Mix::kDifference; }
  bool split() const { return false; }
  void read_live(const Options& options) { tolerance_ = kCrpoOwnRows.read(options).tolerance; }
  void visit(StateIo& io) {
    io.section("CRPO");
    io.integer(served_, -1, kMaxCosts - 1);
  }

 private:
  double tolerance_ = 0;
  int32_t served_ = -1;  // the limited cost, -1: the reward
};

struct CrpoOptions : TrpoOptions, CrpoOwnOptions, WindowOptions {};
constexpr auto kCrpoRows = option_rows<CrpoOptions>(kTrpoRows, kCrpoOwnRows, kWindowRows);

}  // namespace

constinit const AlgoRow kCrpo = make_algo_row<CostWeighted<Trpo, Rectify>>(
    "crpo", "TRPO that lowers a cost alone while it is above its limit, without multipliers (Xu et al. 2021)",
    kCrpoRows, Costs::kAny);

}  // namespace rdm
