#include "algos/lagrange/cppo_pid.hpp"

#include "algos/algo_registry.hpp"
#include "algos/core/option_tables.hpp"
#include "algos/first_order/ppo.hpp"
#include "algos/lagrange/cost_weighted.hpp"

namespace rdm {
PidRule::PidRule(const ResolvedAgentConfig& resolved) : count_(resolved.num_limited) {
  read_live(resolved.options);
  for (Pid& p : pid_) p.reset(options_);
}

void PidRule::read_live(const Options& o) {
  options_ = kPidRows.read(o);
  // Weights of a difference share 1.
  if (options_.mix == Mix::kDifference) options_.max = 1.0 / count_;
}

void PidRule::step(const JudgedCosts& costs, int32_t) {
  for (int32_t i = 0; i < count_; ++i)
    if (costs.fresh[i]) pid_[i].step(options_, costs.cost[i], costs.limit[i]);
}

void PidRule::visit(StateIo& io) {
  io.section("PID ");
  for (int32_t i = 0; i < count_; ++i) pid_[i].visit(io, options_);
}

namespace {
struct CppoPidOptions : PpoOptions, PidRuleOptions, WindowOptions {};
constexpr auto kCppoPidRows = option_rows<CppoPidOptions>(kPpoRows, kPidRows, kWindowRows);
}  // namespace
constinit const AlgoRow kCppoPid = make_algo_row<CostWeighted<Ppo, PidRule>>(
    "cppo_pid", "PPO with a PID-controlled multiplier for each cost limit (Stooke et al. 2020)", kCppoPidRows,
    Costs::kAny);

}  // namespace rdm
