// What learners from a replay memory have in common, whatever they make of it.
//
// An epoch is `horizon` decisions of each world, as of any agent: act, record (or put), update. The update appends
// them to the replay memory (replay.hpp) and takes updates_per_step gradient steps for each decision, each on batch_rows
// rows (s, a, r, c, d, s') that are drawn uniformly and normalised by the statistics of now. What a step is, is the
// algorithm's (step_on_rows). Rows may be recorded ones too (learn.cpp).
//
// So memory, limits, statistics of episodes, drops, cancels and slices are those of every agent.
//
// Before start_steps decisions are in the memory actions are uniform and nothing is learned.
#pragma once
#include "algos/agent/agent.hpp"
#include "algos/core/option_tables.hpp"
#include "algos/off_policy/feed.hpp"
#include "algos/off_policy/replay.hpp"

namespace rdm {

struct ReplayOptions {
  int32_t replay_rows, batch_rows, start_steps;
  double updates_per_step;
};
inline constexpr auto kReplayRows = option_rows<ReplayOptions>(
    row<&ReplayOptions::replay_rows>(
        basic(integer_option("replay_rows", 100000, 1, 1 << 28,
                             "decisions that the replay memory holds, of all worlds together"))),
    row<&ReplayOptions::batch_rows>(
        basic(integer_option("batch_rows", 256, 1, 1 << 20, "rows drawn for each gradient step"))),
    row<&ReplayOptions::updates_per_step>(
        basic(number_option("updates_per_step", 1, 0, 1000,
                            "gradient steps per decision of one world; below 1 for many worlds"))),
    row<&ReplayOptions::start_steps>(basic(
        integer_option("start_steps", 1000, 0, 1 << 28,
                       "decisions in the memory before learning begins; until then actions are uniform"))));

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

class ReplayAgent : public Agent {
 public:
  explicit ReplayAgent(ResolvedAgentConfig&& resolved);
  void carve(Arena& arena) override;

  // learn.cpp. The weights of costs move every kStepsOfWeights steps, by what `judge_policy` makes of the policy.
  LearnReport learn(const LearnRows& rows, int64_t steps) override;
  static constexpr int64_t kStepsOfWeights = 100;

  Replay& replay() { return replay_; }
  const Replay& replay() const { return replay_; }

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
  int64_t skipped() const override { return skipped_; }
  void after_load() override;

  // The memory has rows that it had not: gradient steps on them follow.
  virtual void rows_changed() {}
  // A gradient step begins: its rows are drawn.
  virtual void begin_rows() {}
  // One unit of it, a network or some over a part of the rows; whole: as many as are fastest. True: it was the last one.
  virtual bool step_on_rows(bool whole) = 0;
  // The networks of the algorithm, of a saved state.
  virtual void visit_networks(StateIo&) {}
  // What the limited costs of the policy are expected to be, by the recording that is learned from.
  virtual void judge_policy(JudgedCosts& out) = 0;

  // Of an episode of the recording that is learned from: mean number of decisions, mean sum of their discounts, and of the
  // discounts that a value is over. In worlds by the length of an episode, with values that go on beyond it.
  struct Horizons {
    double length, discounts, values;
  };
  Horizons horizons() const;
  // How many times the mean value of the first observations the sum that limit i is on is.
  double sum_of_values(int32_t i) const;
  // What judge_policy says of limited cost i: its sum over an episode, kNothing where that is not known.
  void judge_cost(int32_t i, double sum, JudgedCosts& out) const;
  // Limit i as a value of a first observation.
  double limit_in_values(int32_t i) const { return resolved().limit[i] / sum_of_values(i); }
  const Feed& feed() const { return feed_; }  // of learn

  const ReplayOptions& replay_options() const { return options_; }
  double critics_rate() const;              // learning rate
  double most_norm() const;                 // bound on the norm of a network's gradient
  int64_t steps() const { return steps_; }  // gradient steps so far
  void count_step() { ++steps_; }
  const MlpShape& actor_shape() const { return resolved().actor; }
  const MlpScratch& actor_scratch() const { return scratch_; }
  Stream& draws() { return *draws_; }
  Stream& noise() { return *noise_; }
  const int32_t* drawn() const { return drawn_; }  // [batch_rows] of the memory
  // Observations of listed rows of the memory, or of what they led to, normalised, to out [rows][obs_dim].
  void load(const int32_t* list, bool next, int32_t rows, float* out) const;
  // What the actor sees of normalised observations.
  void see(const float* obs, int32_t rows, float* seen) const;
  // [kPartRows] rows of: normalised observations, what the actor sees, actions.
  float* obs() { return obs_; }
  float* seen() { return seen_; }
  float* action() { return action_; }
  // [kPartRows][outputs of the actor]: what it gives, and d(loss)/d(that).
  float* head() { return head_; }
  float* dhead() { return dhead_; }
  static constexpr size_t kRows = kPartRows;
  // Where a part's gradient of the actor's network goes; behind it add_actor_gradient.
  float* actor_gradient(bool begins);
  void add_actor_gradient(bool begins);
  void step_actor();  // of Adam

  // Means of what was learned since the update or `learn` began.
  struct Sums {
    int64_t steps = 0, actor_steps = 0;
    double reward_loss = 0, cost_loss = 0, policy_loss = 0, value = 0, cost_value = 0, kl = 0;
  };
  Sums& sums() { return sums_; }

 private:
  void feed_rows(const LearnRows& rows);
  void learn_steps(int64_t steps);
  LearnReport learn_report(int64_t steps, int64_t skipped_before);
  enum class Stage { kDraw, kStep, kMeasure, kOver };
  bool advance(bool whole);
  void measure_part();

  ReplayOptions options_;
  Replay replay_;
  MlpScratch scratch_;  // of the actor
  Stream *draws_ = nullptr, *noise_ = nullptr;
  int32_t* drawn_ = nullptr;
  float *obs_ = nullptr, *seen_ = nullptr, *action_ = nullptr;
  float *head_ = nullptr, *dhead_ = nullptr;
  float *grad_ = nullptr, *part_ = nullptr;  // of the actor's block
  int64_t decisions_ = 0, fed_ = 0;          // that came into the memory: taken here, and of recordings
  int64_t before_ = 0;                       // decisions_ before this horizon
  int64_t steps_ = 0;
  // Of the update that runs.
  Stage stage_ = Stage::kOver;
  int32_t row_at_ = 0;
  int64_t left_ = 0;
  Sums sums_;
  int64_t skipped_ = 0;
  Feed feed_;
};

// The row of one of them. T::kSquash: what bounds its actions; T::shared: options that its table leaves out.
template <class T, class Rows>
constexpr AlgoRow replay_row(const char* name, const char* summary, const Rows& rows, Costs costs) {
  AlgoRow row = make_algo_row<T>(name, summary, rows, costs);
  row.off_policy = true;
  row.squash = T::kSquash;
  row.shared = T::shared;
  return row;
}

}  // namespace rdm
