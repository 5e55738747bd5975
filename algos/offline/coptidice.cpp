// COptiDICE (Lee et al. 2022, "COptiDICE: offline constrained reinforcement learning via stationary distribution correction
// estimation"): recorded actions, weighed by w, how often a better policy comes to a row over how often the recording does.
// With means over recorded rows (s, a, r, c, d, s'), rewards in units of their standard deviation, s_0 first rows of
// episodes, and D the sum of the discounts that a value is over,
//
//   max over w >= 0 of the mean of  w r - alpha f(w),  w d_D visited by a policy,  such that the mean of w c_k <= c_k*
//
//   e       r - sum l_k c_k + d nu(s') - nu(s)
//   w       max(0, (f')^-1(e / alpha))
//   nu      min of  mean of nu(s_0) / D + mean of (w e - alpha f(w)),  whose slope by e is w
//   actor   max of the mean of  w log N(a; tanh m(s), std(s))
//   c_k*    the limit as a value of a first observation (off_policy/replay_agent.hpp) over D
//   l_k     min of  l_k (c_k* - mean of w c_k),  by its logarithm
//
// The recording is a sample. With eps = cost_bound > 0 the mean of w c_k is that of p w c_k, an upper bound over all p whose
// KL to the recording is at most eps:
//
//   z       chi_k(s_0) / D + w (c_k + d chi_k(s') - chi_k(s))
//   p       e^(z / tau_k) over its mean
//   chi_k   min of  tau_k log mean of e^(z / tau_k),  whose slope by z is p;  w fixed
//   tau_k   min of the same + tau_k eps, by its logarithm:  slope eps - mean of p log p by tau_k
//
// All follow Adam, on the same rows. 1 / D is 1 - d where no episode terminates, as in the paper. Where they do, what they
// leave to the time behind them is spread over their rows, so the mean of w stays 1. Where the discount is 1, d is 1 - 1 / n
// for n decisions of an episode, but 0 at terminations.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "algos/algo_registry.hpp"
#include "algos/off_policy/replay_agent.hpp"
#include "algos/offline/side_net.hpp"
#include "base/elementary.hpp"
#include "nn/squash.hpp"

namespace rdm {
namespace {

constexpr uint32_t kNuStream = 67, kChiStream = 68;  // of initial weights, behind those of other networks
constexpr double kMostExponent = 30;                 // of kl
constexpr double kMostLogarithm = 20;
constexpr double kHalfLog = 0.9189385332046727;  // of 2 pi

enum class Divergence : int32_t { kSoftChi2, kChi2, kKl };

struct DiceOwnOptions {
  double alpha;
  Divergence divergence;
  double cost_bound, multiplier_init, multiplier_rate;
};
constexpr auto kDiceOwnRows = option_rows<DiceOwnOptions>(
    row<&DiceOwnOptions::alpha>(basic(
        number_option("dice_alpha", 0.1, 1e-6, 1e6,
                      "weight of the divergence from the recording, in deviations of the reward", true))),
    row<&DiceOwnOptions::divergence, Divergence::kSoftChi2, Divergence::kChi2, Divergence::kKl>(
        text_option("divergence", "soft_chi2", "soft_chi2|chi2|kl",
                    "f-divergence between the rows of the policy and the recorded ones")),
    row<&DiceOwnOptions::cost_bound>(
        basic(number_option("cost_bound", 0.01, 0, 10,
                            "KL divergence from the recording in the upper bound of a cost; 0: no bound"))),
    row<&DiceOwnOptions::multiplier_init>(basic(
        number_option("multiplier_init", 1, 1e-3, 1e6,
                      "initial value of the multiplier, in deviations of the reward per unit of cost"))),
    row<&DiceOwnOptions::multiplier_rate>(basic(number_option(
        "multiplier_lr", 1e-3, 0, 10, "learning rate of the multiplier's logarithm (Adam)", true))));

constexpr auto kDiceSharedRows = kReplaySharedRows.with<&SharedOptions::std_min>(0.05)
                                     .with<&SharedOptions::std_max>(2.0)
                                     .with<&SharedOptions::init_std>(0.5);
struct DiceOptions : SharedOptions, ReplayOptions, DiceOwnOptions {};
constexpr auto kDiceRows = option_rows<DiceOptions>(kDiceSharedRows, kReplayRows, kDiceOwnRows);

// A number above 0 by its logarithm, with Adam.
struct Positive {
  double log = 0, m = 0, v = 0;
  int64_t steps = 0;

  double value() const { return elementary::exp(log); }
  // slope: of what becomes smaller, by the number.
  void step(double slope, double rate) {
    const double by_log = slope * value();
    if (!std::isfinite(by_log)) return;
    ++steps;
    m = 0.9 * m + 0.1 * by_log;
    v = 0.999 * v + 0.001 * by_log * by_log;
    const double mean = m / (1 - elementary::pow(0.9, steps)),
                 square = v / (1 - elementary::pow(0.999, steps));
    log = std::clamp(log - rate * mean / (std::sqrt(square) + 1e-8), -kMostLogarithm, kMostLogarithm);
  }
  void visit(StateIo& io) {
    io.number(log, -kMostLogarithm, kMostLogarithm);
    const StateView<double> mean = io.number(m, -1e100, 1e100), square = io.number(v, 0, 1e200);
    if (mean)
      io.require(std::abs(mean[0]) <= 8 * std::sqrt(square[0]) + 1e-100,
                 "moments that no gradients can give");
    io.counter(steps);
  }
};

class COptiDice : public ReplayAgent {
 public:
  explicit COptiDice(ResolvedAgentConfig&& resolved)
      : ReplayAgent(std::move(resolved)), own_(kDiceOwnRows.read(options())) {}
  static constexpr Squash kSquash = Squash::kMean;
  static SharedOptions shared(const Options& options) {
    SharedOptions o = with_replay(kDiceSharedRows.read(options));
    o.state_std = o.learn_std = true;
    return o;
  }

  void carve(Arena& arena) override {
    ReplayAgent::carve(arena);
    MlpShape shape = resolved().reward_critic;
    shape.out = 1;
    nu_.carve(arena, shape, kSeen);
    const size_t seen = count_of(kSeen), rows = count_of(replay_options().batch_rows);
    for (int32_t k = 0; k < bounds(); ++k) {
      chi_[k].carve(arena, shape, kSeen);
      chi_of_[k] = arena.make<float>(seen);
      z_[k] = arena.make<double>(rows);
    }
    starts_ = arena.make<int32_t>(count_of(replay().capacity()));
    start_ = arena.make<int32_t>(rows);
    rows_ = arena.make<float>(seen * count_of(shape.in));
    for (float** x : {&nu_of_, &slope_}) *x = arena.make<float>(seen);
    chi_slope_ = arena.make<float>(seen * count_of(bounds()));
    for (double** x : {&w_, &discount_}) *x = arena.make<double>(rows);
  }

 protected:
  void opened() override {
    ReplayAgent::opened();
    nu_.open(config().seed, kNuStream, 1);
    for (int32_t k = 0; k < bounds(); ++k)
      chi_[k].open(config().seed, kChiStream + static_cast<uint32_t>(k), 1);
    for (int32_t k = 0; k < resolved().num_limited; ++k)
      multiplier_[k].log = elementary::log(own_.multiplier_init);
  }
  void read_live() override {
    ReplayAgent::read_live();
    own_ = kDiceOwnRows.read(options());
  }
  void visit_networks(StateIo& io) override {
    io.section("DICE");
    nu_.visit(io, nets().input_bound);
    for (int32_t k = 0; k < bounds(); ++k) {
      chi_[k].visit(io, nets().input_bound);
      tau_[k].visit(io);
    }
    for (int32_t k = 0; k < resolved().num_limited; ++k) multiplier_[k].visit(io);
    io.integer(judged_, 0, static_cast<int32_t>(kStepsOfWeights));
    io.numbers(paid_, count_of(resolved().num_limited), -1e100, 1e100);
  }
  int64_t skipped() const override {
    int64_t sum = ReplayAgent::skipped() + nu_.skipped;
    for (int32_t k = 0; k < bounds(); ++k) sum += chi_[k].skipped;
    return sum;
  }
  int32_t num_own_tensors() const override {
    return (1 + bounds()) * 2 * resolved().reward_critic.num_layers();
  }
  bool own_tensor(int32_t index, char* name, TensorInfo* out) const override {
    const int32_t each = 2 * resolved().reward_critic.num_layers(), net = index / each;
    if (index < 0 || net > bounds()) return false;
    char prefix[16] = "nu";
    if (net > 0) std::snprintf(prefix, sizeof prefix, "chi%d", resolved().column[net - 1]);
    return (net > 0 ? chi_[net - 1] : nu_).tensor(index % each, prefix, name, out);
  }

  double cost_weight(int32_t k) const override { return unit_ * multiplier_[k].value(); }

  void rows_changed() override {
    num_starts_ = replay().first_rows(starts_);
    double n = 0, sum = 0, squares = 0;
    const auto each = [&](auto&& body) {
      for (int32_t i = 0; i < replay().capacity(); ++i)
        if (replay().drawable(i)) body(static_cast<double>(replay().reward(i)));
    };
    each([&](double r) { n += 1, sum += r; });
    each([&](double r) { squares += (r - sum / n) * (r - sum / n); });
    unit_ = squares > 0 ? std::sqrt(squares / n) : 1;
  }

  // First rows beside those that were drawn; where the memory has none, the drawn ones.
  void begin_rows() override {
    const Horizons h = horizons();
    begins_ = 1 / h.values;
    const double most = resolved().shared.discount < 1 ? 1 : 1 - 1 / h.length;
    const int32_t rows = replay_options().batch_rows;
    for (int32_t i = 0; i < rows; ++i) {
      discount_[i] = std::min(static_cast<double>(replay().discount(drawn()[i])), most);
      start_[i] = num_starts_ > 0 ? starts_[draws().below(static_cast<uint32_t>(num_starts_))] : drawn()[i];
    }
    stage_ = Stage::kNu;
    first_ = net_ = 0;
    std::fill_n(cost_, kMaxCosts, 0.0);
  }

  // nu and w of a part of the rows; then the actor and each chi of it; of all parts the bounds; the steps.
  bool step_on_rows(bool whole) override {
    const int32_t rows = std::min(kPartRows, replay_options().batch_rows - first_), nets = 1 + bounds();
    const bool last_part = first_ + rows == replay_options().batch_rows;
    switch (stage_) {
      case Stage::kNu:
        gather(rows);
        learn_nu(rows);
        stage_ = Stage::kOthers;
        break;
      case Stage::kOthers: {
        const int32_t to = whole ? nets : std::min(net_ + workers().count(), nets);
        workers().spread(to - net_, [&](int32_t i) {
          if (net_ + i == 0)
            learn_actor(rows);
          else
            see_chi(net_ + i - 1, rows);
        });
        net_ = to == nets ? 0 : to;
        if (net_ > 0) break;
        add_actor_gradient(first_ == 0);
        sums().policy_loss += actor_loss_;
        first_ = last_part ? 0 : first_ + rows;
        stage_ = !last_part ? Stage::kNu : bounds() > 0 ? Stage::kBounds : Stage::kSteps;
        break;
      }
      case Stage::kBounds:
        for (int32_t k = 0; first_ == 0 && k < bounds(); ++k) bound(k);
        if (!last_part || first_ > 0) gather(rows);
        workers().spread(bounds(), [&](int32_t k) { learn_chi(k, rows, last_part && first_ == 0); });
        first_ = last_part ? 0 : first_ + rows;
        stage_ = last_part ? Stage::kSteps : Stage::kBounds;
        break;
      case Stage::kSteps:
        take_steps();
        return true;
    }
    return false;
  }

  // What the rows cost by their weights, over the steps since weights of costs moved last.
  void judge_policy(JudgedCosts& out) override {
    out.count = resolved().num_limited;
    for (int32_t k = 0; k < out.count; ++k)
      judge_cost(k, judged_ > 0 ? paid_[k] / judged_ * horizons().values * sum_of_values(k) : kNothing, out);
  }

 private:
  enum class Stage { kNu, kOthers, kBounds, kSteps };
  // Rows that nu and chi see at a time: those of a part, what they led to, and first rows.
  static constexpr int32_t kSeen = 3 * kPartRows;

  int32_t bounds() const { return own_.cost_bound > 0 ? resolved().num_limited : 0; }

  void gather(int32_t rows) {
    const ResolvedAgentConfig& r = resolved();
    const Vector<int32_t>& columns = r.critic_columns;
    const auto dim = static_cast<int32_t>(r.obs_dim()), in = nu_.shape.in;
    const int32_t* const lists[] = {drawn(), drawn(), start_};
    for (int32_t part = 0; part < 3; ++part) {
      load(lists[part] + first_, part == 1, rows, obs());
      float* const to = rows_ + count_of(part * rows) * count_of(in);
      if (columns.empty())
        std::copy_n(obs(), count_of(rows) * count_of(in), to);
      else
        pick_columns(obs(), rows, dim, columns.data(), in, to);
    }
  }

  // (f')^-1, not below 0.
  double ratio(double x) const {
    if (own_.divergence == Divergence::kChi2) return std::max(x + 1, 0.0);
    const bool exponential = own_.divergence == Divergence::kKl || x < 0;
    return exponential ? elementary::exp(std::min(x, kMostExponent)) : x + 1;
  }

  void learn_nu(int32_t rows) {
    nu_.forward(rows_, 3 * rows, nu_of_);
    double weight[kMaxCosts];
    for (int32_t k = 0; k < resolved().num_limited; ++k) weight[k] = multiplier_[k].value();
    const double share = 1.0 / replay_options().batch_rows;
    const float *now = nu_of_, *next = now + rows;
    for (int32_t i = 0; i < rows; ++i) {
      const int32_t at = drawn()[first_ + i];
      const double d = discount_[first_ + i], r = static_cast<double>(replay().reward(at)) / unit_;
      const float* const c = replay().cost(at);
      double e = r + d * static_cast<double>(next[i]) - static_cast<double>(now[i]);
      for (int32_t k = 0; k < resolved().num_limited; ++k) e -= weight[k] * static_cast<double>(c[k]);
      const double x = e / own_.alpha, w = ratio(x);
      w_[first_ + i] = w;
      slope_[i] = static_cast<float>(-share * w);
      slope_[rows + i] = static_cast<float>(share * d * w);
      slope_[2 * rows + i] = static_cast<float>(share * begins_);
      sums().reward_loss += share * e * e;
      sums().value += share * w * r * unit_ / begins_;
      for (int32_t k = 0; k < resolved().num_limited; ++k) cost_[k] += share * w * static_cast<double>(c[k]);
    }
    nu_.backward(rows_, 3 * rows, slope_, first_ == 0);
  }

  void learn_actor(int32_t rows) {
    const size_t dim = resolved().action_dim();
    const double share = 1.0 / replay_options().batch_rows;
    const auto low = static_cast<double>(nets().std_low), high = static_cast<double>(nets().std_high);
    load(drawn() + first_, false, rows, obs());
    see(obs(), rows, seen());
    mlp_forward(actor_shape(), nets().net(Networks::kActor), seen(), rows, actor_scratch(), head());
    actor_loss_ = 0;
    for (size_t i = 0; i < count_of(rows); ++i) {
      float *const y = head() + 2 * i * dim, *const dy = dhead() + 2 * i * dim;
      const float* const done = replay().action(drawn()[count_of(first_) + i]);
      const double w = share * w_[count_of(first_) + i];
      squash(kSquash, y, dim);
      for (size_t j = 0; j < dim; ++j) {
        const auto a = static_cast<double>(y[j]), given = static_cast<double>(y[dim + j]),
                   log_std = std::clamp(given, low, high), std = elementary::exp(log_std);
        const double z = (static_cast<double>(done[j]) - a) / std, down = 1 - z * z;
        const bool leaves = (given <= low && down > 0) || (given >= high && down < 0);
        dy[j] = static_cast<float>(-w * z / std * (1 - a * a));
        dy[dim + j] = leaves ? 0 : static_cast<float>(w * down);
        actor_loss_ += w * (0.5 * z * z + log_std + kHalfLog);
      }
    }
    mlp_backward(actor_shape(), nets().net(Networks::kActor), seen(), rows, actor_scratch(), dhead(),
                 actor_gradient(first_ == 0));
  }

  void see_chi(int32_t k, int32_t rows) {
    chi_[k].forward(rows_, 3 * rows, chi_of_[k]);
    const float *now = chi_of_[k], *next = now + rows, *first = next + rows;
    if (first_ == 0) chi_loss_[k] = 0;
    for (int32_t i = 0; i < rows; ++i) {
      const int32_t at = drawn()[first_ + i];
      const double e = static_cast<double>(replay().cost(at)[k] - now[i]) +
                       discount_[first_ + i] * static_cast<double>(next[i]);
      chi_loss_[k] += e * e;
      z_[k][first_ + i] = begins_ * static_cast<double>(first[i]) + w_[first_ + i] * e;
    }
  }

  // z becomes p; the cost, its upper bound; tau moves.
  void bound(int32_t k) {
    const int32_t rows = replay_options().batch_rows;
    double* const p = z_[k];
    const double tau = tau_[k].value(), most = *std::max_element(p, p + rows);
    double sum = 0, kl = 0, cost = 0;
    for (int32_t i = 0; i < rows; ++i) sum += p[i] = elementary::exp((p[i] - most) / tau);
    for (int32_t i = 0; i < rows; ++i) {
      p[i] *= rows / sum;
      kl += p[i] > 0 ? p[i] * elementary::log(p[i]) / rows : 0;
      cost += p[i] * w_[i] * static_cast<double>(replay().cost(drawn()[i])[k]) / rows;
    }
    cost_[k] = cost;
    slope_of_tau_[k] = own_.cost_bound - kl;
  }

  void learn_chi(int32_t k, int32_t rows, bool seen_last) {
    if (!seen_last) chi_[k].forward(rows_, 3 * rows, chi_of_[k]);
    float* const slope = chi_slope_ + count_of(k) * count_of(kSeen);
    const double share = 1.0 / replay_options().batch_rows;
    for (int32_t i = 0; i < rows; ++i) {
      const double p = share * z_[k][first_ + i], w = w_[first_ + i];
      slope[i] = static_cast<float>(-p * w);
      slope[rows + i] = static_cast<float>(p * w * discount_[first_ + i]);
      slope[2 * rows + i] = static_cast<float>(p * begins_);
    }
    chi_[k].backward(rows_, 3 * rows, slope, first_ == 0);
  }

  void take_steps() {
    nu_.step(critics_rate(), most_norm());
    for (int32_t k = 0; k < bounds(); ++k) {
      chi_[k].step(critics_rate(), most_norm());
      tau_[k].step(slope_of_tau_[k], critics_rate());
      sums().cost_loss += chi_loss_[k] / (replay_options().batch_rows * bounds());
    }
    step_actor();
    count_step();
    if (steps() % kStepsOfWeights == 1) {
      judged_ = 0;
      std::fill_n(paid_, kMaxCosts, 0.0);
    }
    ++judged_;
    for (int32_t k = 0; k < resolved().num_limited; ++k) {
      if (std::isfinite(cost_[k])) paid_[k] += cost_[k];
      multiplier_[k].step(begins_ * limit_in_values(k) - cost_[k], own_.multiplier_rate);
    }
    if (resolved().num_limited > 0) sums().cost_value += cost_[0] / begins_;
  }

  DiceOwnOptions own_;
  double begins_ = 0;  // 1 / D
  SideNet nu_, chi_[kMaxCosts];
  Positive tau_[kMaxCosts], multiplier_[kMaxCosts];
  int32_t *starts_ = nullptr,
          *start_ = nullptr;  // [capacity], first rows of the memory; [batch_rows], those drawn
  int32_t num_starts_ = 0;
  double unit_ = 1;                            // standard deviation of the memory's rewards
  float* rows_ = nullptr;                      // [kSeen][inputs]
  float *nu_of_ = nullptr, *slope_ = nullptr;  // [kSeen]
  float *chi_of_[kMaxCosts] = {}, *chi_slope_ = nullptr;
  double *w_ = nullptr, *discount_ = nullptr, *z_[kMaxCosts] = {};  // [batch_rows]
  // Of the gradient step at hand.
  Stage stage_ = Stage::kNu;
  int32_t first_ = 0, net_ = 0;
  double actor_loss_ = 0, cost_[kMaxCosts] = {}, slope_of_tau_[kMaxCosts] = {}, chi_loss_[kMaxCosts] = {};
  // Sum of costs over the steps since weights of costs moved last, and how many these are.
  double paid_[kMaxCosts] = {};
  int32_t judged_ = 0;
};

}  // namespace

constinit const AlgoRow kCOptiDice = replay_row<COptiDice>(
    "coptidice",
    "Cloning of recorded actions, weighted by how often a better policy visits them (Lee et al. 2022)",
    kDiceRows, Costs::kAny);

}  // namespace rdm
