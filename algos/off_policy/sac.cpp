#include "algos/off_policy/sac.hpp"

#include <algorithm>
#include <cmath>

#include "algos/algo_registry.hpp"
#include "algos/lagrange/cppo_pid.hpp"
#include "algos/lagrange/lagrange.hpp"
#include "base/elementary.hpp"

namespace rdm {
namespace {

constexpr double kHalfLogTwoPi = 0.9189385332046727;
constexpr double kLeastLog = -27, kMostLog = 27;  // of the temperature

}  // namespace

SharedOptions Sac::shared(const Options& options) {
  SharedOptions o = with_replay(kSacSharedRows.read(options));
  o.state_std = o.learn_std = true;
  return o;
}

void Sac::carve(Arena& arena) {
  OffPolicy::carve(arena);
  const size_t n = kRows * resolved().action_dim();
  for (float** rows : {&z_, &std_, &sampled_}) *rows = arena.make<float>(n);
  log_prob_ = arena.make<float>(kRows);
}

void Sac::opened() {
  OffPolicy::opened();
  log_alpha_ = elementary::log(std::max(kSacOwnRows.read(options()).temperature, 1e-12));
}

void Sac::read_live() {
  OffPolicy::read_live();
  own_ = kSacOwnRows.read(options());
}

double Sac::temperature() const {
  const bool none = own_.temperature == 0 && own_.temperature_learning_rate == 0;
  return none ? 0 : elementary::exp(log_alpha_);
}

void Sac::sample(const float* seen, int32_t rows, float* action) {
  const size_t dim = resolved().action_dim(), out = 2 * dim;
  mlp_forward(actor_shape(), nets().net(Networks::kActor), seen, rows, actor_scratch(), head());
  noise().normals(z_, static_cast<int>(static_cast<size_t>(rows) * dim));
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i) {
    const float* const y = head() + i * out;
    float log_std[kMaxActions];
    for (size_t j = 0; j < dim; ++j) log_std[j] = std::clamp(y[dim + j], nets().std_low, nets().std_high);
    float* const std = std_ + i * dim;
    kernels().map_exp(log_std, dim, std);
    double sum = 0;
    for (size_t j = 0; j < dim; ++j) {
      const float z = z_[i * dim + j], u = y[j] + std[j] * z;
      action[i * dim + j] = u;
      sum -= 0.5 * static_cast<double>(z * z) + static_cast<double>(log_std[j]) + kHalfLogTwoPi +
             log_slope_of_tanh(static_cast<double>(u));
    }
    log_prob_[i] = static_cast<float>(sum);
  }
  squash(Squash::kSample, action, static_cast<size_t>(rows) * dim);
}

void Sac::next_actions(const float* seen, int32_t rows, float* action, float* bonus) {
  const auto alpha = static_cast<float>(temperature());
  sample(seen, rows, action);
  for (int32_t i = 0; i < rows; ++i) bonus[i] = -alpha * log_prob_[i];
}

void Sac::own_actions(const float* seen, int32_t rows, float* action) {
  sample(seen, rows, action);
  std::copy_n(action, static_cast<size_t>(rows) * resolved().action_dim(), sampled_);
}

// With u = m + std z: d log pi / du = 2 a, d log pi / d log std = 2 a std z - 1.
double Sac::learn_actions(const float* seen, int32_t rows, float* slope, float share, float* grad) {
  const size_t dim = resolved().action_dim(), out = 2 * dim;
  const auto alpha = share * static_cast<float>(temperature());
  double loss = 0;
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i) {
    float* const d = dhead() + i * out;
    for (size_t j = 0; j < dim; ++j) {
      const size_t at = i * dim + j;
      const float a = sampled_[at], l = head()[i * out + dim + j];
      const float du = slope[at] * (1 - a * a) + alpha * 2 * a;
      d[j] = du;
      d[dim + j] = l > nets().std_low && l < nets().std_high ? du * std_[at] * z_[at] - alpha : 0;
    }
    loss += static_cast<double>(alpha) * static_cast<double>(log_prob_[i]);
    gap_ += static_cast<double>(log_prob_[i]) + own_.target_entropy * static_cast<double>(dim);
  }
  mlp_backward(actor_shape(), nets().net(Networks::kActor), seen, rows, actor_scratch(), dhead(), grad);
  return loss;
}

void Sac::end_actor_step() {
  const double slope = -gap_ / off_options().batch_rows;
  gap_ = 0;
  if (own_.temperature_learning_rate == 0 || !std::isfinite(slope)) return;
  ++t_;
  m_ = 0.9 * m_ + 0.1 * slope;
  v_ = 0.999 * v_ + 0.001 * slope * slope;
  const double m = m_ / (1 - elementary::pow(0.9, t_)), v = v_ / (1 - elementary::pow(0.999, t_));
  log_alpha_ = std::clamp(log_alpha_ - own_.temperature_learning_rate * m / (std::sqrt(v) + 1e-8), kLeastLog,
                          kMostLog);
}

void Sac::visit_state(StateIo& io) {
  OffPolicy::visit_state(io);
  io.section("SACT");
  io.number(log_alpha_, kLeastLog - 1, kMostLog + 1);
  const StateView<double> m = io.number(m_, -1e100, 1e100), v = io.number(v_, 0, 1e200);
  if (m) io.require(std::abs(m[0]) <= 8 * std::sqrt(v[0]) + 1e-100, "moments that no gradients can give");
  io.counter(t_);
}

namespace {

struct SacLagOptions : SacOptions, LagrangeOptions, WindowOptions {};
constexpr auto kSacLagRows = option_rows<SacLagOptions>(kSacRows, kLagrangeRows, kReplayWindowRows);
struct SacPidOptions : SacOptions, PidRuleOptions, WindowOptions {};
constexpr auto kSacPidRows = option_rows<SacPidOptions>(kSacRows, kPidRows, kReplayWindowRows);

}  // namespace

constinit const AlgoRow kSac = replay_row<Sac>(
    "sac", "Soft actor-critic from a replay memory (Haarnoja et al. 2018); costs are only recorded", kSacRows,
    Costs::kNone);
constinit const AlgoRow kSacLag = replay_row<Weighed<Sac, Lagrange>>(
    "sac_lag", "SAC with pessimistic cost critics and a multiplier for each limit, by dual ascent",
    kSacLagRows, Costs::kAny);
constinit const AlgoRow kSacPid = replay_row<Weighed<Sac, PidRule>>(
    "sac_pid", "SAC with pessimistic cost critics and a PID-controlled multiplier for each limit",
    kSacPidRows, Costs::kAny);

}  // namespace rdm
