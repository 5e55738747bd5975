#include "algos/lagrange/cppo_pid.hpp"

#include "algos/algo_registry.hpp"
#include "algos/core/option_tables.hpp"
#include "algos/first_order/ppo.hpp"
#include "algos/lagrange/cost_weighted.hpp"

namespace rdm {
namespace {

constexpr auto kRows = option_rows<PidRuleOptions>(
    row<&PidOptions::kp>(basic(number_option(
        "pid_kp", 0.1, 0, 1e6, "proportional gain: multiplier per unit of the smoothed violation", true))),
    row<&PidOptions::ki>(basic(number_option(
        "pid_ki", 0.01, 0, 1e6, "integral gain: multiplier per unit of the summed violation", true))),
    row<&PidOptions::kd>(basic(number_option(
        "pid_kd", 0.01, 0, 1e6,
        "derivative gain: multiplier per unit that the smoothed cost rises over pid_delay epochs", true))),
    row<&PidOptions::smooth_p>(
        number_option("pid_smooth_p", 0.95, 0, 0.9999,
                      "smoothing factor of the violation (exponential mean); 0: no smoothing")),
    row<&PidOptions::smooth_d>(
        number_option("pid_smooth_d", 0.95, 0, 0.9999,
                      "smoothing factor of the cost in the derivative (exponential mean); 0: no smoothing")),
    row<&PidOptions::delay>(integer_option("pid_delay", 10, 1, kMaxPidDelay,
                                           "number of epochs over which the derivative is taken")),
    row<&PidOptions::init>(number_option("pid_init", 0.001, 0, 1e6, "initial value of the integral")),
    row<&PidOptions::max>(
        number_option("pid_max", 1e6, 0, kMaxMultiplier, "upper bound of the multiplier", true)),
    row<&PidRuleOptions::mix, Mix::kSum, Mix::kDifference, Mix::kPlain>(text_option(
        "pid_norm", "sum", "sum|diff|none",
        "advantage: sum: (A_r - l A_c)/(1 + l); diff: (1 - l) A_r - l A_c with l <= 1; none: A_r - l A_c")));

}  // namespace

PidRule::PidRule(const ResolvedAgentConfig& resolved) : count_(resolved.num_limited) {
  read_live(resolved.options);
  for (Pid& p : pid_) p.reset(options_);
}

void PidRule::read_live(const Options& o) {
  options_ = kRows.read(o);
  // Weights of a difference share 1.
  if (options_.mix == Mix::kDifference) options_.integral_max = options_.max = 1.0 / count_;
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
constexpr auto kCppoPidRows = option_rows<CppoPidOptions>(kPpoRows, kRows, kWindowRows);
}  // namespace
constinit const AlgoRow kCppoPid = make_algo_row<CostWeighted<Ppo, PidRule>>(
    "cppo_pid", "PPO with a PID-controlled multiplier for each cost limit (Stooke et al. 2020)", kCppoPidRows,
    Costs::kAny);

}  // namespace rdm
