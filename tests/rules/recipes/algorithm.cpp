// CRPO on PPO's step (Xu, Liang and Lan 2021, algorithm 1): while an episode's cost is above its limit the
// policy step lowers that cost alone, else it raises the reward.
#include "algos/algo_registry.hpp"
#include "algos/first_order/ppo.hpp"
#include "algos/lagrange/cost_weighted.hpp"

namespace rdm {
namespace {

class Rectify {
 public:
  explicit Rectify(const ResolvedAgentConfig&) {}
  void step(const JudgedCosts& costs, int32_t) {
    if (!costs.any_known()) return;
    violated_ = -1;
    for (int32_t i = 0; i < costs.count && violated_ < 0; ++i)
      if (costs.known[i] && costs.excess(i) > 0) violated_ = i;
  }
  double weight(int32_t i) const { return i == violated_ ? 1 : 0; }
  Mix mix() const { return Mix::kDifference; }  // (1 - sum w) A_r - sum w A_c
  bool split() const { return false; }
  void read_live(const Options&) {}
  void visit(StateIo& io) {
    io.section("RECT");
    io.integer(violated_, -1, kMaxCosts - 1);
  }

 private:
  int32_t violated_ = -1;  // the limit that the policy step serves, -1: none
};

}  // namespace

constinit const AlgoRow kCrpo = make_algo_row<CostWeighted<Ppo, Rectify>>(
    "crpo", "PPO that lowers a cost alone while it is over its limit (Xu et al. 2021)", kPpoRows,
    Costs::kAny);

}  // namespace rdm
