// The collecting half of an agent: acts, records what followed, estimates advantages.
//
//   act       x = clip((obs - shift) scale, +-obs_clip), shift and scale of all observations so far, this one
//             included; mean = actor(x); action = mean + noise (noise.hpp); V and V_c of x for the advantages
//   memory    what networks see beside a row of the decisions before (memory.hpp)
//   put       the same for an action that was sampled elsewhere, and record
//   record    r_t, c_t and d_t = discount^steps of the decision; at a truncation the value of the final
//             observation is added, discounted; at a termination costs may be charged on (terminal_cost)
//   estimate  V of the last observation closes the paths that still run, then gae.hpp
//
// The cost that is learned from differs from the cost that a limit is on. The cost advantage uses costs that are
// discounted like rewards; J_c is an episode's plain sum (Achiam et al. 2017 discount both; the tables of ReDMan and
// Safety Gym count plain sums). With discount 0.96 a step and four steps a decision, the hands' settings, the
// gradient looks 7 decisions ahead, the limit over the whole episode. discounted_limit=true discounts both.
#pragma once
#include "algos/core/batch_workers.hpp"
#include "algos/core/networks.hpp"
#include "algos/rollout/limits.hpp"
#include "algos/rollout/memory.hpp"
#include "algos/rollout/noise.hpp"
#include "algos/rollout/rollout.hpp"
#include "algos/rollout/usual.hpp"
#include "nn/normalizer.hpp"

namespace rdm {

class Collector {
 public:
  void carve(Arena& arena, const ResolvedAgentConfig& resolved);
  // The three must outlive the collector.
  void open(const ResolvedAgentConfig& resolved, const Networks& nets, BatchWorkers& workers);

  // clouds [num_envs], in metres: needed with a point-cloud encoder, not allowed without.
  void act(const float* obs, bool sample, float* action, const PointRows& clouds = {});
  void record(const Transition& t);
  // A decision that was taken elsewhere by this policy: act and record, with its action in the place of a
  // sample. Changes nothing where it fails on what it is given.
  void put(const float* obs, const float* action, const Transition& t);
  // Between act and record: the sample of an environment becomes another action, [action_dim] within
  // +-Noise::kMaxAction, with its own density.
  void replace(int32_t env, const float* action);
  // What act will do next in worlds that show obs [rows][obs_dim], after a sampled act: of environments
  // env [rows], by copies noise [num_envs] and offset [num_envs][action_dim] of their noise, which go on; null
  // noise: the means. action [rows][action_dim]. state [rows][state_dim] is what is remembered of them, and goes on
  // too. Not for an agent with a point-cloud encoder.
  void foresee(const int32_t* env, const float* obs, int32_t rows, float* state, Stream* noise, float* offset,
               float* action) const;
  // Noise behind the last sampled act, and what was remembered before it: it is an act that waits for its record.
  void peek(int32_t env, Stream* noise, float* offset, float* state) const {
    noise_.peek(env, noise, offset);
    std::copy_n(memory_.state(env, false), memory_.dim(), state);
  }
  // What the critics say of any rows obs [rows][obs_dim]: value [rows], cost_value [rows][num_limited]. With a history
  // state [rows][state_dim] is what was seen before; see puts the rows in front of it.
  void value_rows(const float* obs, const float* state, int32_t rows, float* value, float* cost_value) const;
  void see(const float* obs, int32_t rows, float* state) const;
  // Decisions still missing in this horizon.
  int32_t missing() const { return rollout_.horizon - rollout_.filled; }
  // Nothing is collected and no act waits for its record.
  bool idle() const { return rollout_.filled == 0 && !pending_; }
  void drop();
  // The memory of environments begins anew where mask [num_envs] is not 0 (null: of all), of sampling or of acting by
  // the mean. Error(kState) while a sample waits for its record.
  void forget(bool by_mean, const uint8_t* mask);

  // Brings in what other ranks counted since.
  void settle();
  // Of the horizon so far, over all ranks.
  EpochTotals totals() const;
  // Advantages and targets of a full horizon, in the rollout, whose order then lists the valid rows by
  // blocks: after the values of the last observations a column at a time, until estimate_on says that it is
  // done.
  void begin_estimate(const float* last_obs);
  bool estimate_on();
  void estimate(const float* last_obs) {
    begin_estimate(last_obs);
    while (!estimate_on()) {
    }
  }
  // The listed rows, those of all ranks counted.
  const Batch& listed() const { return listed_rows_; }
  // Minibatch i of `parts`: of each block's list the part of that number.
  Batch minibatch(int32_t i, int32_t parts) const;
  // Of the values that acted, over all ranks' rows; column 0 of the costs'.
  double mean_value(bool of_cost) const;

  // What a unit of limited cost i takes off the reward of the rows to come, where costs have no critic.
  void set_charge(int32_t i, double weight) { charge_[i] = static_cast<float>(weight); }

  // Of a replayed rollout: samples are uniform in [-1, 1], whatever the policy.
  void set_uniform(bool uniform) { uniform_ = uniform; }

  const Rollout& rollout() const { return rollout_; }
  Episodes& episodes() { return episodes_; }
  const Episodes& episodes() const { return episodes_; }
  const Normalizer& normalizer() const { return normalizer_; }
  Normalizer& normalizer() { return normalizer_; }
  // The rows as networks see them: obs, or with normalize_obs memory [rows][obs_dim], which may be obs.
  const float* normalized(const float* obs, int32_t rows, float* memory) const;
  bool normalizes() const { return shared().normalize_obs; }
  // How far rows of an epoch usually are from what the statistics say; with normalize_obs.
  UsualRows& usual() { return usual_; }
  void close_usual() {
    if (normalizes()) usual_.close(workers_->ranks());
  }
  // What is usual is that of these rows, a recording's, not of an epoch's.
  void measure_usual(const float* obs, int32_t rows);
  int64_t env_steps() const { return env_steps_ + own_steps_; }  // of others: those that settle has counted
  void visit(StateIo& io);
  void after_load() {
    own_steps_ = 0;
    episodes_.forget();
    for (Normalizer* n : {&normalizer_, &reward_scale_, &cost_scale_}) normalizer_refresh(*n);
  }

 private:
  const SharedOptions& shared() const { return resolved_->shared; }
  bool limits_first() const { return resolved_->num_limited > 0 && resolved_->column[0] == 0; }
  void values(const Workspace& workspace, const float* x, int32_t rows, float* value,
              float* cost_value) const;
  // A decision for action, or with the actions `given`; the other one is null.
  void decide(const float* obs, const PointRows& clouds, float* action, const float* given);
  void act_rows(const Workspace& workspace, const float* obs, const PointRows& clouds, int32_t first,
                int32_t rows, float* action, const float* given);
  void decide_replayed(int32_t env, const float* mean, const float* std, const float* given, float* action,
                       float* kept);
  void keep_final(const Transition& t, int32_t env, size_t at, float discount);
  void need_turn(const char* call) const;
  int32_t share(int32_t rows) const;  // of a worker's chunk
  // What a network with std_mode=state gives, taken apart: means, log deviations (null: not wanted).
  void split_head(const float* y, int32_t rows, float* mean, float* log_std) const;
  void mean_rows(const Workspace& workspace, const float* obs, const PointRows& clouds, int32_t first,
                 int32_t rows, float* action);
  // Rows x, normalised, as the networks see them: with a history in the workspace's obs.
  const float* stacked(const Workspace& workspace, const float* x, int32_t first, int32_t rows,
                       bool by_mean) const {
    if (!memory_ || !memory_.stacks()) return x;
    memory_.stack(x, first, rows, by_mean, workspace.obs);
    return workspace.obs;
  }
  void check_clouds(const PointRows& clouds) const;
  // Keeps what is learned from of a row's clouds; what the actor is to see.
  PointRows keep_points(const PointRows& clouds, size_t at, int32_t rows) const;
  void check(const Transition& t) const;
  void check_actions(const float* action) const;
  void follow(const Transition& t);
  void value_truncated(const Transition& t);
  void list_rows();
  Novelty novelty(const float* row) const;
  void scale_rewards(const Transition& t);
  void merge(Normalizer& n, const float* x, const uint8_t* mask, double count_max);
  void check_flags(const char* name, const uint8_t* flags) const;
  void record_row(const Transition& t, int32_t env);
  bool resets(const Transition& t, int32_t env) const;
  void count_row(const Transition& t, int32_t env, const float* cost, int32_t steps);
  void end_row(const Transition& t, int32_t env, float discount, float* sample_cost);
  void charge_fall(int32_t env, float discount, float* sample_cost, double* charge) const;

  const ResolvedAgentConfig* resolved_ = nullptr;
  const Networks* nets_ = nullptr;
  BatchWorkers* workers_ = nullptr;
  Rollout rollout_;
  Normalizer normalizer_, reward_scale_, cost_scale_;
  Noise noise_;
  UsualRows usual_;
  AgentMemory memory_;
  Episodes episodes_;
  float* std_ = nullptr;          // [action_dim] of the innovation; none with std_mode=state
  float* final_value_ = nullptr;  // [num_envs] V of the final observation after truncation, else 0
  float* final_cost_ = nullptr;   // [num_envs][num_limited]
  int32_t* listed_ = nullptr;     // [num_envs] environments that were truncated
  // What is learned from: [num_envs] and [num_envs][cost_dim], the transition's own or scaled in scaled_*.
  const float *reward_ = nullptr, *cost_ = nullptr;
  float *scaled_reward_ = nullptr, *scaled_cost_ = nullptr;
  float charge_[kMaxCosts] = {};
  int64_t env_steps_ = 0, own_steps_ = 0;  // of all ranks, and this one's since they were counted
  double* moments_ = nullptr;              // [this rank's blocks][1 + 2 widest row]; none for one block alone
  size_t moments_step_ = 0;
  int32_t* block_rows_ = nullptr;  // [all blocks] valid rows
  Segment* segments_ = nullptr;    // [this rank's blocks]
  Segment* part_ = nullptr;        // likewise, of the last minibatch
  Batch listed_rows_;
  int32_t column_ = -1;  // that estimate_on comes to next
  // Of this horizon: [num_envs][cost_dim], [num_envs], and counts that need no order.
  double *epoch_cost_ = nullptr, *epoch_steps_ = nullptr;
  int64_t invalid_ = 0, cut_ = 0, status_[EpochTotals::kStatusKinds] = {};
  bool uniform_ = false;
  bool pending_ = false;  // a sampled act waits for its record
};

// Error(kArgument) naming the first row of x [rows][dim] that is not finite; rows whose mask is 0 are
// skipped.
void check_rows(const char* name, const float* x, const uint8_t* mask, int32_t rows, size_t dim);

// Error(kArgument) naming the first entry of x [rows][columns] that no cost can be: not finite, below 0.
void check_costs(const char* name, const float* x, int32_t rows, int32_t columns);

}  // namespace rdm
