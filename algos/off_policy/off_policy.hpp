// Learners from a replay memory with critics of rows and actions: what TD3 and SAC have in common.
//
// A gradient step (replay_agent.hpp) is
//
//   critics   targets by the next action a' (next_actions), then a step of each (q_critic.hpp)
//   actor     every policy_delay-th step: a = pi(s), along the slopes of its critics
//
//               max over pi of the mean of  (Q(s, a) - sum l_k Q_k(s, a)) / (1 + sum l_k)
//
//             Q_k: the larger one of the pair of limited cost k
//
// The weights l_k are a rule's, once an epoch, by the sums J_c of episodes that finished lately (Weighed below), which
// are of policies near this one; what lies in the memory is of older ones. A discounted limit is not needed: J_c is
// compared, never Q_k.
#pragma once
#include "algos/lagrange/cost_weighted.hpp"
#include "algos/off_policy/q_critic.hpp"
#include "algos/off_policy/replay_agent.hpp"

namespace rdm {

struct OffPolicyOptions : ReplayOptions {
  int32_t policy_delay;
  double tau;
  bool layer_norm;
};
inline constexpr auto kOffPolicyRows = option_rows<OffPolicyOptions>(
    kReplayRows,
    row<&OffPolicyOptions::policy_delay>(integer_option(
        "policy_delay", 2, 1, 1000, "gradient steps of the critics for each one of the actor")),
    row<&OffPolicyOptions::tau>(number_option(
        "tau", 0.005, 1e-6, 1, "share by which the critics' slow copies follow at each step", true)),
    row<&OffPolicyOptions::layer_norm>(flag_option(
        "layer_norm", false, "normalise the critics' hidden layers; for several updates per step")));

class OffPolicy : public ReplayAgent {
 public:
  explicit OffPolicy(ResolvedAgentConfig&& resolved)
      : ReplayAgent(std::move(resolved)), options_(kOffPolicyRows.read(this->resolved().options)) {}
  void carve(Arena& arena) override;

  QCritics& critics() { return critics_; }
  const QCritics& critics() const { return critics_; }

 protected:
  void opened() override;
  void read_live() override;
  void visit_networks(StateIo& io) override { critics_.visit(io); }
  void begin_rows() override;
  bool step_on_rows(bool whole) override;
  // J_c as what the critics make of the first observations of the recorded episodes. With s_0 those (at most 256 of them,
  // evenly), over the discounts D that a value is over and n decisions of an episode:
  //
  //   J_c = n / D  mean of max(Q_c1, Q_c2, 0)(s_0, pi(s_0))
  //
  // which is the sum over an episode whose costs are spread evenly. With option discounted_limit n is the sum of an
  // episode's discounts, with cost_limit_per_step it is the steps that the limit is over.
  void judge_policy(JudgedCosts& out) override;
  int32_t num_own_tensors() const override { return QCritics::num_tensors(resolved()); }
  bool own_tensor(int32_t index, char* name, TensorInfo* out) const override {
    return critics_.tensor(index, name, out);
  }
  void actor_replaced() override { critics_.restart_targets(); }
  int64_t skipped() const override { return ReplayAgent::skipped() + critics_.skipped(); }

  // Of one part of a batch, `rows` rows of what the actor sees, normalised. The actions of the next rows that targets
  // are made of, and what is added to the next value of the reward.
  virtual void next_actions(const float* seen, int32_t rows, float* action, float* bonus) = 0;
  // The actions whose costs limits are held against where no episode is seen.
  virtual void judged_actions(const float* seen, int32_t rows, float* action) {
    own_actions(seen, rows, action);
  }
  // The policy's actions, and the gradient that follows from slope = d(loss)/d(action), which may be overwritten; share:
  // of the other terms of the loss, over the batch's rows.
  virtual void own_actions(const float* seen, int32_t rows, float* action) = 0;
  virtual double learn_actions(const float* seen, int32_t rows, float* slope, float share, float* grad) = 0;
  virtual bool climbs_smaller() const = 0;  // of the reward's pair; else the first
  virtual void end_actor_step() {}
  // Factor on what the critics say in the actor's loss, by their values of the policy's actions.
  virtual double critics_share(int32_t) { return 1; }
  // Whether what the critics have just said of next actions counts for the reward's targets at row i of a part; if not,
  // only what is below 0 does.
  virtual bool counts(int32_t) const { return true; }
  // The weight of a pair of critics at row i in the actor's loss; usual: that of every row.
  virtual double weight_at(int32_t, int32_t, double usual) const { return usual; }
  // What is added to the critics' gradients of a part; seen: what the actor sees of its rows, x: they as critics see them,
  // with the actions that were taken.
  virtual void add_to_critics(const float*, const float*, int32_t) {}
  bool first_part() const { return first_ == 0; }
  virtual void end_critics_step(double, double) {}  // learning rate, and bound of a gradient's norm
  virtual Mix mix() const { return Mix::kSum; }

  const OffPolicyOptions& off_options() const { return options_; }
  static constexpr double kLeastScale = 1e-3;  // of a mean of values that a loss is divided by
  // Row i of the part that is learned from, as a row of the memory.
  int32_t drawn(int32_t i) const { return ReplayAgent::drawn()[first_ + i]; }

 private:
  enum class Stage { kNext, kTargets, kGradients, kCritics, kOwn, kValues, kSlopes, kActor };
  int32_t group_end(bool whole);
  int32_t part_rows() const { return std::min(kPartRows, options_.batch_rows - first_); }
  void gather_next(int32_t rows);
  void gather_own(int32_t rows);
  void make_targets(int32_t rows);
  void weigh(int32_t rows);
  void learn_part(int32_t rows);
  void end_gradient_step();

  OffPolicyOptions options_;
  QCritics critics_;
  // [kPartRows] rows and next rows of critics, slopes
  float *row_ = nullptr, *next_ = nullptr, *slope_ = nullptr;
  float* bonus_ = nullptr;
  Stage stage_ = Stage::kNext;
  int32_t first_ = 0, net_ = 0;
};

// Base: an OffPolicy. Rule: of lagrange/, that says what costs weigh.
template <class Base, class Rule>
class Weighed : public WithRule<Base, Rule> {
 public:
  using WithRule<Base, Rule>::WithRule;

 protected:
  Mix mix() const override { return this->rule().mix(); }
};

}  // namespace rdm
