// Learners from a replay memory: what TD3 and SAC have in common.
//
// An epoch is `horizon` decisions of each world, as of any agent: act, record (or put), update. The update appends
// them to the replay memory (replay.hpp) and takes updates_per_step gradient steps for each decision; a step is
//
//   draw      batch_rows rows (s, a, r, c, d, s'), uniformly, normalised by the statistics of now
//   critics   targets by the next action a' (next_actions), then a step of each (q_critic.hpp)
//   actor     every policy_delay-th step: a = pi(s), along the slopes of its critics
//
//               max over pi of the mean of  (Q(s, a) - sum l_k Q_k(s, a)) / (1 + sum l_k)
//
//             Q_k: the larger one of the pair of limited cost k
//
// The weights l_k are a rule's, once an epoch, by the sums J_c of episodes that finished lately (Weighed below), which
// are of policies near this one; what lies in the memory is of older ones.
//
// So memory, limits, statistics of episodes, drops, cancels and slices are those of every agent. A discounted limit
// is not needed: J_c is compared, never Q_k.
//
// Before start_steps decisions are in the memory actions are uniform and nothing is learned.
#pragma once
#include "algos/agent/agent.hpp"
#include "algos/core/option_tables.hpp"
#include "algos/lagrange/cost_weighted.hpp"
#include "algos/off_policy/feed.hpp"
#include "algos/off_policy/q_critic.hpp"
#include "algos/off_policy/replay.hpp"

namespace rdm {

struct OffPolicyOptions {
  int32_t replay_rows, batch_rows, start_steps, policy_delay;
  double updates_per_step, tau;
  bool layer_norm;
};
inline constexpr auto kOffPolicyRows = option_rows<OffPolicyOptions>(
    row<&OffPolicyOptions::replay_rows>(
        basic(integer_option("replay_rows", 100000, 1, 1 << 28,
                             "decisions that the replay memory holds, of all worlds together"))),
    row<&OffPolicyOptions::batch_rows>(
        basic(integer_option("batch_rows", 256, 1, 1 << 20, "rows drawn for each gradient step"))),
    row<&OffPolicyOptions::updates_per_step>(
        basic(number_option("updates_per_step", 1, 0, 1000,
                            "gradient steps per decision of one world; below 1 for many worlds"))),
    row<&OffPolicyOptions::start_steps>(basic(
        integer_option("start_steps", 1000, 0, 1 << 28,
                       "decisions in the memory before learning begins; until then actions are uniform"))),
    row<&OffPolicyOptions::policy_delay>(integer_option(
        "policy_delay", 2, 1, 1000, "gradient steps of the critics for each one of the actor")),
    row<&OffPolicyOptions::tau>(number_option(
        "tau", 0.005, 1e-6, 1, "share by which the critics' slow copies follow at each step", true)),
    row<&OffPolicyOptions::layer_norm>(flag_option(
        "layer_norm", false, "normalise the critics' hidden layers; for several updates per step")));

// Shared options that make sense here.
inline constexpr auto kReplaySharedRows =
    kSharedRows
        .without<&SharedOptions::encoder, &SharedOptions::encoder_activation, &SharedOptions::encoder_frozen,
                 &SharedOptions::encoder_points, &SharedOptions::encoder_classes,
                 &SharedOptions::encoder_color, &SharedOptions::encoder_origin, &SharedOptions::encoder_range,
                 &SharedOptions::learn_std, &SharedOptions::state_std, &SharedOptions::linear_std,
                 &SharedOptions::normalize_reward, &SharedOptions::normalize_cost, &SharedOptions::lambda,
                 &SharedOptions::cost_lambda, &SharedOptions::standardize_reward_adv,
                 &SharedOptions::standardize_cost_adv, &SharedOptions::passes, &SharedOptions::minibatches,
                 &SharedOptions::blocks, &SharedOptions::rate_kind, &SharedOptions::critics_follow,
                 &SharedOptions::total_epochs, &SharedOptions::kl_target, &SharedOptions::kl_target_end,
                 &SharedOptions::kl_factor, &SharedOptions::lr_min, &SharedOptions::lr_max,
                 &SharedOptions::early_stop_kl, &SharedOptions::entropy, &SharedOptions::joint_grad_norm,
                 &SharedOptions::value_clip, &SharedOptions::critic_l2, &SharedOptions::warm_epochs,
                 &SharedOptions::imitation, &SharedOptions::imitation_decay, &SharedOptions::history,
                 &SharedOptions::history_fields, &SharedOptions::memory, &SharedOptions::memory_chunk,
                 &SharedOptions::latent, &SharedOptions::latent_fields, &SharedOptions::latent_hidden,
                 &SharedOptions::latent_student>()
        .with<&SharedOptions::horizon>(64)
        .with<&SharedOptions::hidden>("256,256")
        .with<&SharedOptions::activation>("relu")
        .with<&SharedOptions::max_grad_norm>(0.0);
// The others, as they are then.
inline SharedOptions with_replay(SharedOptions o) {
  o.encoder = o.memory = o.history_fields = o.latent_fields = o.latent_hidden = "";
  o.encoder_origin = "0,0,0", o.encoder_range = 1;
  o.minibatches = o.blocks = o.history = o.memory_chunk = o.total_epochs = 1;
  return o;
}

// How many episodes J_c is over: fewer than in algorithms that forget what they did.
inline constexpr auto kReplayWindowRows = kWindowRows.with<&WindowOptions::window>(20);

class OffPolicy : public Agent {
 public:
  explicit OffPolicy(ResolvedAgentConfig&& resolved);
  void carve(Arena& arena) override;

  // learn.cpp. The weights of costs move every kStepsOfWeights steps, by what the critics make of the first observations
  // of the recorded episodes.
  LearnReport learn(const LearnRows& rows, int64_t steps) override;
  static constexpr int64_t kStepsOfWeights = 100;

  Replay& replay() { return replay_; }
  const Replay& replay() const { return replay_; }
  QCritics& critics() { return critics_; }
  const QCritics& critics() const { return critics_; }

 protected:
  const PolicyLoss* policy_loss() const override { return nullptr; }
  void opened() override;
  void read_live() override;
  void visit_state(StateIo& io) override;
  void begin_epoch(const JudgedCosts&, int32_t) override {}
  void take_horizon(const float* last_obs) override;
  bool explores_blindly() const override { return decisions_ + fed_ < options_.start_steps; }
  void begin_step() override;
  Job step_on() override;
  void report(Learned& learned) const override;
  double mean_value(bool of_cost) const override;
  int32_t num_own_tensors() const override { return QCritics::num_tensors(resolved()); }
  bool own_tensor(int32_t index, char* name, TensorInfo* out) const override {
    return critics_.tensor(index, name, out);
  }
  void actor_replaced() override { critics_.restart_targets(); }
  int64_t skipped() const override { return skipped_ + critics_.skipped(); }
  void after_load() override;

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
  // Limit i as a value of a first observation: by the recording that is learned from, and in worlds by the length of an
  // episode, with values that go on beyond it.
  double limit_in_values(int32_t i) const;
  virtual Mix mix() const { return Mix::kSum; }

  const OffPolicyOptions& off_options() const { return options_; }
  const MlpShape& actor_shape() const { return resolved().actor; }
  const MlpScratch& actor_scratch() const { return scratch_; }
  Stream& noise() { return *noise_; }
  // Normalised observations of the rows at hand, [kPartRows][obs_dim].
  const float* obs() const { return obs_; }
  // [kPartRows][outputs of the actor]: what it gives, and d(loss)/d(that).
  float* head() { return head_; }
  float* dhead() { return dhead_; }
  static constexpr size_t kRows = kPartRows;
  static constexpr double kLeastScale = 1e-3;  // of a mean of values that a loss is divided by
  // Row i of the part that is learned from, as a row of the memory.
  int32_t drawn(int32_t i) const { return drawn_[first_ + i]; }

 private:
  void feed(const LearnRows& rows);
  void learn_steps(int64_t steps);
  double sum_of_values(int32_t i) const;
  void judge_starts(JudgedCosts& out);
  LearnReport learn_report(int64_t steps, int64_t skipped_before);
  enum class Stage {
    kDraw,
    kNext,
    kTargets,
    kGradients,
    kCritics,
    kOwn,
    kValues,
    kSlopes,
    kActor,
    kMeasure,
    kOver
  };
  bool advance(bool whole);
  int32_t group_end(bool whole);
  int32_t part_rows() const { return std::min(kPartRows, options_.batch_rows - first_); }
  void draw();
  void gather_next(int32_t rows);
  void gather_own(int32_t rows);
  void make_targets(int32_t rows);
  void weigh(int32_t rows);
  void learn_part(int32_t rows);
  void step_actor();
  void end_gradient_step();
  void measure_part();
  // Rows of the memory, normalised, to obs_; what the actor sees of them to seen.
  void load(bool next, int32_t rows);
  void see(int32_t rows, float* seen) const;

  OffPolicyOptions options_;
  Replay replay_;
  QCritics critics_;
  MlpScratch scratch_;  // of the actor
  Stream *draws_ = nullptr, *noise_ = nullptr;
  int32_t* drawn_ = nullptr;  // [batch_rows]
  // [kPartRows] rows of: normalised observations, what the actor sees, rows and next rows of critics, actions, slopes
  float *obs_ = nullptr, *seen_ = nullptr, *row_ = nullptr, *next_ = nullptr, *action_ = nullptr,
        *slope_ = nullptr;
  float* bonus_ = nullptr;
  float *head_ = nullptr, *dhead_ = nullptr;  // [kPartRows][outputs of the actor]
  float *grad_ = nullptr, *part_ = nullptr;   // of the actor's block
  int64_t decisions_ = 0, fed_ = 0;           // that came into the memory: taken here, and of recordings
  int64_t before_ = 0;                        // decisions_ before this horizon
  int64_t steps_ = 0;                         // gradient steps so far
  // Of the update that runs.
  Stage stage_ = Stage::kOver;
  int32_t first_ = 0, net_ = 0, row_at_ = 0;
  int64_t left_ = 0;
  struct Sums {
    int64_t steps = 0, actor_steps = 0;
    double reward_loss = 0, cost_loss = 0, policy_loss = 0, value = 0, cost_value = 0, kl = 0;
  } sums_;
  int64_t skipped_ = 0;
  Feed feed_;  // of learn
};

// Base: an OffPolicy. Rule: of lagrange/, that says what costs weigh.
template <class Base, class Rule>
class Weighed : public WithRule<Base, Rule> {
 public:
  using WithRule<Base, Rule>::WithRule;

 protected:
  Mix mix() const override { return this->rule().mix(); }
};

// The row of one of them. T::kSquash: what bounds its actions; T::shared: options that its table leaves out.
template <class T, class Rows>
constexpr AlgoRow off_policy_row(const char* name, const char* summary, const Rows& rows, Costs costs) {
  AlgoRow row = make_algo_row<T>(name, summary, rows, costs);
  row.off_policy = true;
  row.squash = T::kSquash;
  row.shared = T::shared;
  return row;
}

}  // namespace rdm
