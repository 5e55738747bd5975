// BCQ with limits (Fujimoto, Meger and Precup 2019, "Off-policy deep reinforcement learning without exploration"): only
// actions like recorded ones are compared, so that no error of the critics elsewhere is climbed.
//
//   candidate  clip(b + perturb tanh(xi(s, b)), +-1), b the decoded action (vae.hpp) of a latent vector clip(N(0, 1), +-0.5)
//   targets    a' = the best of `candidates` candidates at s' by  min Q' - sum l_k Q'_k  of the slow copies;
//              y = r + d min Q'(s', a'),  y_k = c_k + d max(Q'_k(s', a'), 0); Q_k: the larger one of a cost's two critics
//   xi         climbs  (Q_1 - sum l_k Q_k)(s, candidate) / (1 + sum l_k)
//   actor      min of the mean of (pi(s') - a')^2: the choice as one network, which acts and is written to policy files
//   l_k        dual ascent on J_c of the actor (off_policy/learn.cpp)
#include <algorithm>
#include <cmath>

#include "algos/algo_registry.hpp"
#include "algos/lagrange/lagrange.hpp"
#include "algos/off_policy/off_policy.hpp"
#include "algos/offline/vae.hpp"

namespace rdm {
namespace {

constexpr float kMostLatent = 0.5f;
constexpr uint32_t kPerturbStream = 66;  // of initial weights, behind those of the model of actions

struct BcqOwnOptions {
  int32_t candidates;
  double perturb, explore_std;
};
constexpr auto kBcqOwnRows = option_rows<BcqOwnOptions>(
    row<&BcqOwnOptions::candidates>(basic(integer_option(
        "candidates", 10, 1, 1000, "actions like recorded ones that are compared at each next row", true))),
    row<&BcqOwnOptions::perturb>(basic(number_option(
        "perturb", 0.05, 0, 2, "bound of what is added to such an action, in units of it", true))),
    row<&BcqOwnOptions::explore_std>(number_option(
        "explore_std", 0.2, 1e-6, 10,
        "standard deviation of the noise on actions while it collects, in units of the action")));

constexpr auto kBcqSharedRows =
    kReplaySharedRows.without<&SharedOptions::init_std, &SharedOptions::std_min, &SharedOptions::std_max>();
struct BcqOptions : SharedOptions, OffPolicyOptions, BcqOwnOptions, LagrangeOptions, WindowOptions {};
constexpr auto kBcqRows =
    option_rows<BcqOptions>(kBcqSharedRows, kOffPolicyRows.with<&OffPolicyOptions::policy_delay>(1),
                            kBcqOwnRows, kLagrangeRows, kReplayWindowRows);

class Bcq : public OffPolicy {
 public:
  explicit Bcq(ResolvedAgentConfig&& resolved) : OffPolicy(std::move(resolved)) {}
  static constexpr Squash kSquash = Squash::kMean;
  static SharedOptions shared(const Options& options) {
    SharedOptions o = with_replay(kBcqSharedRows.read(options));
    o.init_std = kBcqOwnRows.read(options).explore_std;
    o.std_min = 1e-6, o.std_max = 1e3;
    return o;
  }

  void carve(Arena& arena) override {
    OffPolicy::carve(arena);
    const size_t dim = resolved().action_dim();
    model_.carve(arena, resolved(), critics().row_inputs(), kPartRows);
    MlpShape shape = resolved().reward_critic;
    shape.in = critics().inputs(), shape.out = resolved().config.action_dim;
    perturb_.carve(arena, shape, kPartRows);
    latent_ = arena.make<float>(kRows * 2 * dim);
    row_ = arena.make<float>(kRows * count_of(critics().inputs()));
    for (float** rows : {&candidate_, &added_, &slope_}) *rows = arena.make<float>(kRows * dim);
    best_ = arena.make<double>(kRows);
    for (float** all : {&fit_, &fit_part_}) *all = arena.make<float>(actor_shape().num_params());
  }

 protected:
  void opened() override {
    OffPolicy::opened();
    model_.open(resolved());
    perturb_.open(config().seed, kPerturbStream, 1);
  }
  void read_live() override {
    OffPolicy::read_live();
    own_ = kBcqOwnRows.read(options());
  }
  void visit_state(StateIo& io) override {
    OffPolicy::visit_state(io);
    model_.visit(io, nets().input_bound);
    io.section("BCQP");
    perturb_.visit(io, nets().input_bound);
  }
  int64_t skipped() const override { return OffPolicy::skipped() + model_.skipped() + perturb_.skipped; }

  int32_t num_own_tensors() const override {
    return OffPolicy::num_own_tensors() + ActionVae::num_tensors(resolved()) +
           2 * resolved().reward_critic.num_layers();
  }
  bool own_tensor(int32_t index, char* name, TensorInfo* out) const override {
    const int32_t of_model = index - OffPolicy::num_own_tensors(),
                  behind = of_model - ActionVae::num_tensors(resolved());
    if (of_model < 0) return OffPolicy::own_tensor(index, name, out);
    return behind < 0 ? model_.tensor(of_model, name, out) : perturb_.tensor(behind, "perturb", name, out);
  }

  bool climbs_smaller() const override { return false; }

  void next_actions(const float* seen, int32_t rows, float* action, float* bonus) override {
    const size_t dim = resolved().action_dim();
    for (int32_t n = 0; n < own_.candidates; ++n) {
      make_candidates(rows);
      critics().gather(obs(), candidate_, rows, row_);
      critics().values(0, critics().count(), true, row_, rows);
      for (int32_t i = 0; i < rows; ++i) {
        const double worth = worth_of(i);
        if (n > 0 && !(worth > best_[i])) continue;
        best_[i] = worth;
        std::copy_n(candidate_ + count_of(i) * dim, dim, action + count_of(i) * dim);
      }
    }
    std::fill_n(bonus, rows, 0.0f);
    fit(seen, rows, action);
  }

  void own_actions(const float*, int32_t rows, float* action) override {
    make_candidates(rows);
    std::copy_n(candidate_, count_of(rows) * resolved().action_dim(), action);
  }
  // Costs are those of what acts.
  void judged_actions(const float* seen, int32_t rows, float* action) override { act(seen, rows, action); }

  // Behind own_actions: the slope of a candidate goes on to what was added, where no bound cut it.
  double learn_actions(const float*, int32_t rows, float* slope, float, float* grad) override {
    const size_t count = count_of(rows) * resolved().action_dim();
    const auto most = static_cast<float>(own_.perturb);
    for (size_t j = 0; j < count; ++j) {
      const bool cut = std::abs(candidate_[j]) >= 1;
      slope[j] = cut ? 0 : slope[j] * most * (1 - added_[j] * added_[j]);
    }
    perturb_.backward(row_, rows, slope, first_part());
    const size_t size = actor_shape().num_params();
    if (first_part())
      std::copy_n(fit_, size, grad);
    else
      std::fill_n(grad, size, 0.0f);
    return first_part() ? fit_loss_ : 0;
  }

  void add_to_critics(const float*, const float* x, int32_t rows) override {
    model_.gradient(x, rows, 1.0 / off_options().batch_rows, noise(), first_part());
  }
  void end_critics_step(double rate, double max_norm) override {
    model_.step(rate, max_norm);
    rate_ = rate, max_norm_ = max_norm;
  }
  void end_actor_step() override { perturb_.step(rate_, max_norm_); }

 private:
  // To candidate_, and tanh of what perturb_ says of them to added_.
  void make_candidates(int32_t rows) {
    const size_t dim = resolved().action_dim(), count = count_of(rows) * dim;
    const auto most = static_cast<float>(own_.perturb);
    noise().normals(latent_, static_cast<int>(2 * count));
    for (size_t j = 0; j < 2 * count; ++j) latent_[j] = std::clamp(latent_[j], -kMostLatent, kMostLatent);
    std::fill_n(candidate_, count, 0.0f);
    critics().gather(obs(), candidate_, rows, row_);
    model_.decode(row_, latent_, rows, candidate_);
    critics().gather(obs(), candidate_, rows, row_);
    perturb_.forward(row_, rows, added_);
    squash(Squash::kMean, added_, count);
    for (size_t j = 0; j < count; ++j)
      candidate_[j] = std::clamp(candidate_[j] + most * added_[j], -1.0f, 1.0f);
  }

  double worth_of(int32_t i) {
    const QCritics& q = critics();
    auto worth = static_cast<double>(std::min(q.out(0)[i], q.out(1)[i]));
    for (int32_t k = 0; k < resolved().num_limited; ++k)
      worth -= cost_weight(k) * static_cast<double>(std::max(q.out(2 * k + 2)[i], q.out(2 * k + 3)[i]));
    return worth;
  }

  void act(const float* seen, int32_t rows, float* action) {
    mlp_forward(actor_shape(), nets().net(Networks::kActor), seen, rows, actor_scratch(), action);
    squash(Squash::kMean, action, count_of(rows) * resolved().action_dim());
  }

  void fit(const float* seen, int32_t rows, const float* chosen) {
    const size_t count = count_of(rows) * resolved().action_dim(), size = actor_shape().num_params();
    const double share = 1.0 / (off_options().batch_rows * static_cast<double>(resolved().action_dim()));
    act(seen, rows, head());
    if (first_part()) fit_loss_ = 0;
    for (size_t j = 0; j < count; ++j) {
      const float a = head()[j], away = a - chosen[j];
      slope_[j] = static_cast<float>(2 * share) * away * (1 - a * a);
      fit_loss_ += share * static_cast<double>(away) * static_cast<double>(away);
    }
    mlp_backward(actor_shape(), nets().net(Networks::kActor), seen, rows, actor_scratch(), slope_,
                 first_part() ? fit_ : fit_part_);
    for (size_t j = 0; !first_part() && j < size; ++j) fit_[j] += fit_part_[j];
  }

  BcqOwnOptions own_{};
  ActionVae model_;
  SideNet perturb_;
  // [kRows] latent vectors, rows of critics, candidates, what is added to them, slopes; worth of the best one so far
  float *latent_ = nullptr, *row_ = nullptr, *candidate_ = nullptr, *added_ = nullptr, *slope_ = nullptr;
  double* best_ = nullptr;
  float *fit_ = nullptr, *fit_part_ = nullptr;  // gradient of the actor's distance to what was chosen
  double fit_loss_ = 0, rate_ = 0, max_norm_ = 0;
};

}  // namespace

constinit const AlgoRow kBcqLag = replay_row<Weighed<Bcq, Lagrange>>(
    "bcq_lag",
    "Q-learning among actions like recorded ones, with a multiplier for each limit (Fujimoto et al. 2019)",
    kBcqRows, Costs::kAny);

}  // namespace rdm
