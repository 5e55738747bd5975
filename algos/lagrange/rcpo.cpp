// RCPO (Tessler, Mankowitz and Mannor 2019, "Reward constrained policy optimization"): the actor and its only
// critic learn from the penalised reward
//
//   r - sum_k l_k c_k,     l_k <- clip(l_k + multiplier_lr (J_ck - d_k), 0, multiplier_max)
//
// where the actor is fast, the critic faster and l slow. So there is no critic of costs: what a cost is worth is
// found by the critic of the reward, which has to follow l. Within an epoch l stands still, so the values of its
// rows are of one reward.
//
// Departures: PPO's step (the paper's experiments on robots have it too), the multiplier by Adam as in the other
// methods here (multiplier_optimizer=sgd: the formula). l is in units of reward per cost, where PPO-Lag's is in
// deviations of the reward's advantage.
#include "algos/algo_registry.hpp"
#include "algos/first_order/ppo.hpp"
#include "algos/lagrange/lagrange.hpp"

namespace rdm {
namespace {

class Rcpo final : public Ppo {
 public:
  explicit Rcpo(ResolvedAgentConfig&& resolved) : Ppo(std::move(resolved)), lagrange_(this->resolved()) {}

 protected:
  void begin_epoch(const JudgedCosts& costs, int32_t epoch) override {
    lagrange_.step(costs, epoch);
    follow_reward();
  }
  double cost_weight(int32_t i) const override { return lagrange_.weight(i); }
  void read_live() override {
    Ppo::read_live();
    lagrange_.read_live(options());
  }
  void visit_state(StateIo& io) override {
    Ppo::visit_state(io);
    lagrange_.visit(io);
  }

 private:
  Lagrange lagrange_;
};

struct RcpoOptions : PpoOptions, LagrangeOptions, WindowOptions {};
constexpr auto kRcpoRows = option_rows<RcpoOptions>(kPpoRows, kLagrangeRows, kWindowRows);

}  // namespace

constinit const AlgoRow kRcpo = make_algo_row<Rcpo>(
    "rcpo", "PPO on the reward minus each cost times its multiplier, with one critic (Tessler et al. 2019)",
    kRcpoRows, Costs::kInReward);

}  // namespace rdm
