// CPQ (Xu, Zhan and Zhu 2022, "Constraints penalized Q-learning for safe offline reinforcement learning"): what is not
// safe is worth nothing, and what was not recorded is made to look unsafe. With Q_k the larger one of a cost's two critics,
// and safe(s, a) where Q_k(s, a) <= l_k for all k:
//
//   outside  a~ ~ pi(s) whose latent vector is farther from N(0, 1) (vae.hpp) than those of the share `outside` of recorded
//            actions
//   cost     mean of (Q - y_k)^2 - w_k times the mean of 1[outside] Q(s, a~), each critic: raised until it is l_k there,
//            w_k <- clip(w_k + lift_lr (l_k - mean over outside of the mean of the two), 0, lift_max)
//   reward   y = r + d v,  v = min Q'(s', a') where (s', a') is safe by the slow copies, else the smaller one of it and 0
//   actor    mean of  -1[safe] min Q(s, a) / N + sum over k of 1[Q_k > l_k] Q_k(s, a) / l_k,  a ~ pi(s)
//   N        mean of |Q_1|, without a gradient
//   l_k      the limit as a value of a first observation (off_policy/learn.cpp)
//
// All else is SAC's, without an entropy by default.
#include <algorithm>
#include <cmath>

#include "algos/algo_registry.hpp"
#include "algos/off_policy/sac.hpp"
#include "algos/offline/vae.hpp"

namespace rdm {
namespace {

struct CpqOwnOptions {
  double outside, lift_rate, lift_max;
};
constexpr auto kCpqOwnRows = option_rows<CpqOwnOptions>(
    row<&CpqOwnOptions::outside>(basic(
        number_option("outside", 0.9, 0, 1,
                      "share of recorded actions that count as inside when an action is compared", true))),
    row<&CpqOwnOptions::lift_rate>(basic(number_option(
        "lift_lr", 0.01, 0, 1e3, "learning rate of the weight that raises costs outside of the data", true))),
    row<&CpqOwnOptions::lift_max>(number_option("lift_max", 10, 0, 1e6, "upper bound of that weight", true)));

struct CpqOptions : SacOptions, CpqOwnOptions {};
constexpr auto kCpqRows = option_rows<CpqOptions>(
    kSacSharedRows.with<&SharedOptions::init_std>(0.2),
    kOffPolicyRows.with<&OffPolicyOptions::policy_delay>(1),
    kSacOwnRows.with<&SacOwnOptions::temperature>(0.0).with<&SacOwnOptions::temperature_learning_rate>(0.0),
    kCpqOwnRows);

class Cpq : public Sac {
 public:
  explicit Cpq(ResolvedAgentConfig&& resolved) : Sac(std::move(resolved)) {}

  void carve(Arena& arena) override {
    Sac::carve(arena);
    model_.carve(arena, resolved(), critics().row_inputs(), kPartRows);
    action_ = arena.make<float>(kRows * resolved().action_dim());
    away_ = arena.make<float>(kRows * count_of(critics().inputs()));
    for (float** rows : {&distance_, &sorted_}) *rows = arena.make<float>(kRows);
  }

 protected:
  void opened() override {
    Sac::opened();
    model_.open(resolved());
  }
  void read_live() override {
    Sac::read_live();
    own_ = kCpqOwnRows.read(options());
  }
  void visit_state(StateIo& io) override {
    Sac::visit_state(io);
    io.section("CPQL");
    for (int32_t k = 0; k < resolved().num_limited; ++k) {
      io.number(lift_[k], 0, 1e6);
      io.number(limit_[k], 0, 1e30);
    }
    model_.visit(io, nets().input_bound);
  }
  int64_t skipped() const override { return Sac::skipped() + model_.skipped(); }
  int32_t num_own_tensors() const override {
    return Sac::num_own_tensors() + ActionVae::num_tensors(resolved());
  }
  bool own_tensor(int32_t index, char* name, TensorInfo* out) const override {
    const int32_t behind = index - Sac::num_own_tensors();
    return behind < 0 ? Sac::own_tensor(index, name, out) : model_.tensor(behind, name, out);
  }

  void begin_epoch(const JudgedCosts&, int32_t) override {
    for (int32_t k = 0; k < resolved().num_limited; ++k) limit_[k] = limit_in_values(k);
  }

  bool within(int32_t k, int32_t i) const {
    return static_cast<double>(std::max(critics().out(2 * k + 2)[i], critics().out(2 * k + 3)[i])) <=
           limit_[k];
  }
  bool counts(int32_t i) const override {
    for (int32_t k = 0; k < resolved().num_limited; ++k)
      if (!within(k, i)) return false;
    return true;
  }

  // The actor's loss without units.
  double critics_share(int32_t rows) override {
    double sum = 0;
    for (int32_t i = 0; i < rows; ++i) sum += std::abs(static_cast<double>(critics().out(0)[i]));
    return 1 / std::max(sum / rows, kLeastScale);
  }
  double weight_at(int32_t pair, int32_t i, double usual) const override {
    if (pair == 0) return counts(i) ? usual : 0;
    const double scale = off_options().batch_rows * std::max(limit_[pair - 1], kLeastScale);
    return within(pair - 1, i) ? 0 : 1 / scale;
  }

  void add_to_critics(const float* seen, const float* x, int32_t rows) override {
    const double share = 1.0 / off_options().batch_rows;
    model_.gradient(x, rows, share, noise(), first_part());
    if (resolved().num_limited == 0) return;
    if (first_part()) {
      outside_ = 0;
      std::fill_n(sum_, kMaxCosts, 0.0);
    }
    own_actions(seen, rows, action_);
    critics().gather(obs(), action_, rows, away_);
    model_.distance(away_, rows, distance_);
    model_.distance(x, rows, sorted_);
    const auto at = std::min(static_cast<int32_t>(own_.outside * rows), rows - 1);
    std::nth_element(sorted_, sorted_ + at, sorted_ + rows);
    const float farthest = sorted_[at];
    const int32_t all = critics().count();
    for (int32_t net = 2; net < all; ++net)
      for (int32_t i = 0; i < rows; ++i)
        critics().weight(net)[i] =
            distance_[i] > farthest ? static_cast<float>(-lift_[net / 2 - 1] * share) : 0.0f;
    critics().lift(2, all, away_, rows);
    for (int32_t i = 0; i < rows; ++i) {
      if (!(distance_[i] > farthest)) continue;
      ++outside_;
      for (int32_t net = 2; net < all; ++net)
        sum_[net / 2 - 1] += 0.5 * static_cast<double>(critics().out(net)[i]);
    }
  }

  void end_critics_step(double rate, double max_norm) override {
    model_.step(rate, max_norm);
    for (int32_t k = 0; k < resolved().num_limited; ++k)
      if (outside_ > 0)
        lift_[k] =
            std::clamp(lift_[k] + own_.lift_rate * (limit_[k] - sum_[k] / outside_), 0.0, own_.lift_max);
  }

 private:
  CpqOwnOptions own_{};
  ActionVae model_;
  float *action_ = nullptr, *away_ = nullptr, *distance_ = nullptr, *sorted_ = nullptr;  // [kRows]
  double lift_[kMaxCosts] = {}, limit_[kMaxCosts] = {};
  double sum_[kMaxCosts] = {};  // of the batch at hand: values outside
  int32_t outside_ = 0;
};

}  // namespace

constinit const AlgoRow kCpq = replay_row<Cpq>(
    "cpq",
    "Q-learning from a data set that gives no value to unsafe and to unrecorded actions (Xu et al. 2022)",
    kCpqRows, Costs::kAny);

}  // namespace rdm
