#include "algos/lagrange/cppo_pid.hpp"

#include <cstring>

#include "algos/algo_registry.hpp"
#include "algos/core/option_tables.hpp"
#include "algos/first_order/ppo.hpp"
#include "algos/lagrange/cost_weighted.hpp"

namespace rdm {

PidRule::PidRule(const ResolvedAgentConfig& resolved) : count_(resolved.num_limited) {
  const Options& o = resolved.options;
  const char* mix = o.text("pid_norm");
  mix_ = std::strcmp(mix, "sum") == 0    ? Mix::kSum
         : std::strcmp(mix, "diff") == 0 ? Mix::kDifference
                                         : Mix::kPlain;
  options_.delay = o.integer("pid_delay");
  options_.init = o.number("pid_init");
  options_.smooth_p = o.number("pid_smooth_p");
  options_.smooth_d = o.number("pid_smooth_d");
  read_live(o);
  for (Pid& p : pid_) p.reset(options_);
}

void PidRule::read_live(const Options& o) {
  options_.kp = o.number("pid_kp");
  options_.ki = o.number("pid_ki");
  options_.kd = o.number("pid_kd");
  // Weights of a difference share 1.
  const double share = 1.0 / count_;
  options_.integral_max = mix_ == Mix::kDifference ? share : 1e300;
  options_.max = mix_ == Mix::kDifference ? share : o.number("pid_max");
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
constexpr std::array kPidOptions = {
    basic(number_option("pid_kp", 0.1, 0, 1e6, "multiplier per smoothed violation", true)),
    basic(number_option("pid_ki", 0.01, 0, 1e6, "multiplier per summed violation", true)),
    basic(number_option("pid_kd", 0.01, 0, 1e6,
                        "multiplier per rise of the smoothed cost over pid_delay epochs", true)),
    number_option("pid_smooth_p", 0.95, 0, 0.9999, "EMA factor of the violation; 0: none"),
    number_option("pid_smooth_d", 0.95, 0, 0.9999, "EMA factor of the cost that is derived; 0: none"),
    integer_option("pid_delay", 10, 1, kMaxPidDelay, "epochs that the derivative looks back"),
    number_option("pid_init", 0.001, 0, 1e6, "initial integral"),
    number_option("pid_max", 1e6, 0, kMaxMultiplier, "upper bound on the multiplier", true),
    text_option("pid_norm", "sum", "sum|diff|none",
                "advantage (A_r - l A_c)/(1 + l), (1 - l) A_r - l A_c with l <= 1, or A_r - l A_c"),
};
constexpr auto kCppoPidTable = join_options(kSharedOptions, kClipOptions, kPidOptions, kWindowOptions);
}  // namespace
constinit const AlgoRow kCppoPid = make_algo_row<CostWeighted<Ppo, PidRule>>(
    "cppo_pid", "PPO with a PID-controlled multiplier for each cost limit (Stooke et al. 2020)",
    kCppoPidTable, Costs::kAny);

}  // namespace rdm
