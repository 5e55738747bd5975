// The agent: an algorithm's networks, rollout memory and update behind one handle. Mirrors rdm_agent_*. All
// algorithms derive from it.
//
// An epoch, in the order of its calls:
//   act, record  `horizon` times: the collector samples a ~ pi_old(. | s) and keeps what followed
//   update       advantages and targets (collector, gae)
//                begin_epoch  the algorithm's multipliers, penalties or barriers, from the episodes' costs
//                             J_c against their limits; writes the combined advantage, which the
//                             actor's loss uses, into the rollout
//                a trust region's step of the policy (begin_step, step_on)
//                passes over shuffled minibatches (learner), which move the critics and, but after such a
//                step, the policy (policy_loss)
//                the Epoch, the schedules, an empty rollout
// It is a sequence of jobs that can be left anywhere (agent_update.cpp). An algorithm overrides what it does
// differently: the loss of the policy (policy_loss), what happens before the policy step (begin_epoch), or the
// step itself.
//
// Memory: one arena of the agent holds all arrays. It is allocated at creation, and each part takes its arrays from
// it in carve(), so act, record and update allocate nothing. The part that took an array owns it; others get
// pointers:
//   Networks      parameters and Adam's moments
//   BatchWorkers  scratch of the chunks in flight: activations, a gradient each
//   Collector     the Rollout, normalisers, noise, episodes; only it writes them, except gain and linear (the
//                 clipped and the unclipped advantage, by the algorithm) and order (by the passes)
//   Learner       the gradient that a step follows
//   Imitation     the demonstration that regularises the policy: a recording's rows, copied when it is set,
//                 outside of the arena
//   TrustRegion, rules of an algorithm: what they carve or hold themselves
// A part is made in four steps: carve (take arrays from the arena; called twice, first to measure), open (bind
// pointers to other parts, read the options that are fixed), opened (the same for an algorithm's own parts),
// read_live (read the options that may change; called again after every change).
//
// Work on a minibatch is cut into chunks of fixed size that are reduced in a fixed order, so any number of
// threads gives the same bytes; and, over blocks of worlds, any number of processes (ranks.hpp).
#pragma once
#include "algos/agent/learn.hpp"
#include "algos/agent/learner.hpp"
#include "algos/core/schedule.hpp"
#include "algos/imitation/clone.hpp"
#include "algos/imitation/imitation.hpp"
#include "algos/imitation/pretrain.hpp"
#include "algos/rollout/collector.hpp"
#include "base/cancel.hpp"

namespace rdm {

struct PolicyView;
class Policy;

class Agent {
 public:
  static size_t memory(const AgentConfig& config);  // bytes of create, exact
  static Agent* create(const AgentConfig& config);
  static void destroy(Agent* a);

  explicit Agent(ResolvedAgentConfig&& resolved) : resolved_(std::move(resolved)) {}
  virtual ~Agent() = default;
  // Takes memory from the hooks and draws the first weights.
  void open(const AgentConfig& config);
  // Adds what this algorithm needs to an arena, measuring or real.
  virtual void carve(Arena& arena);

  // clouds [num_envs], in metres: of an agent with eyes.
  void act(const float* obs, bool sample, float* action, const PointRows& clouds = {});
  const PointNetShape& eyes() const { return resolved_.eyes; }
  void record(const Transition& t);
  // What it remembers of environments, as Collector::forget.
  void forget(bool by_mean, const uint8_t* mask);
  // Error(kUnsupported) for a learner from a replay memory.
  void need_on_policy(const char* call) const;
  // A decision that the policy of this generation took elsewhere, in the place of act and record. As act draws
  // nothing for it, the streams of noise stay where they are; all else is as if it had acted.
  void put(const float* obs, const float* action, const Transition& t);
  // As Collector's of the same names: what is recorded in the place of a sample, and what will be sampled.
  void replace(int32_t env, const float* action) { collector_.replace(env, action); }
  void peek(int32_t env, Stream* noise, float* offset, float* state) const {
    collector_.peek(env, noise, offset, state);
  }
  void foresee(const int32_t* env, const float* obs, int32_t rows, float* state, Stream* noise, float* offset,
               float* action) const {
    collector_.foresee(env, obs, rows, state, noise, offset, action);
  }
  int32_t state_dim() const { return static_cast<int32_t>(resolved_.state_dim()); }
  // As the critics see any rows, in the units of rewards and costs: value [rows] and cost
  // [rows][num_limited()], of the cost columns limited_column(i). With a history the decisions before are state
  // [rows][history_dim()], which `see` moves on by a decision. Error(kUnsupported) where values are scaled by what was
  // seen.
  void values(const float* obs, const float* state, int32_t rows, float* value, float* cost) const;
  void see(const float* obs, int32_t rows, float* state) const { collector_.see(obs, rows, state); }
  int32_t history_dim() const { return resolved_.history_inputs(); }
  int32_t num_limited() const { return resolved_.num_limited; }
  int32_t limited_column(int32_t i) const { return resolved_.column[i]; }
  double discount() const { return resolved_.shared.discount; }
  // An update; in slices begin_update, then update_on with some units of work at a time until it is true, to
  // the same bytes. Until then the actor of before acts without noise and goes into policy files. A failure, a
  // cancel and discard leave the actor as it was; critics keep what finished minibatches taught them.
  void update(const float* last_obs, Epoch* out);
  void begin_update(const float* last_obs);
  bool update_on(int32_t units, Epoch* out);
  static constexpr int32_t kWhole = -1;  // units: all that are left, as large as they are fastest
  bool updating() const { return phase_ != Phase::kIdle; }
  void need_no_update(const char* call) const;  // Error(kState) between begin_update and its end
  // Decisions still missing in this horizon; 0: update is due.
  int32_t missing() const { return collector_.missing(); }
  int32_t horizon() const { return resolved_.shared.horizon; }
  int32_t action_repeat() const { return resolved_.shared.action_repeat; }
  // Rollouts take magnitudes in the place of costs: option cost_signal.
  bool raw_costs() const { return resolved_.shared.raw_costs; }
  void drop_horizon();  // after a cancel: forget what was collected, and an update that has begun
  // From any state back to between epochs: without a begun horizon, and without a cancel that waits.
  void discard();
  void cancel() { cancel_.set(); }  // from any thread or signal handler
  // Error(kCancelled) once after cancel().
  void check_cancel() { cancel_.check(); }

  void set_option(const OptionInput& option);
  const Options& options() const { return resolved_.options; }
  ShieldLearn shield_learn() const { return resolved_.shared.shield_learn; }
  double shield_penalty() const { return resolved_.shared.shield_penalty; }
  bool tensor(int32_t index, TensorInfo* out);  // false past the end
  // After a write through TensorInfo::data. The actor's average begins again.
  void tensors_changed() {
    clamp_log_std(nets_);
    restart_average(nets_);
    actor_replaced();
    sampler_ = 0;
  }

  // Between epochs; Error(kState) inside a horizon.
  CloneReport clone(const DemoRows& demo, const CloneOptions& how);
  // Gradient steps on recorded rows, without a world. Error(kUnsupported) for an algorithm that learns from its own
  // decisions alone; Error(kState) inside a horizon.
  virtual LearnReport learn(const LearnRows& rows, int64_t steps);
  // clouds [rows] in metres, label [rows][points]. Error(kState) inside a horizon or without eyes.
  PretrainReport pretrain(const PointRows& clouds, const uint8_t* label, int32_t rows,
                          const PretrainOptions& how);
  // Copies the rows for the imitation term; mark: their fingerprint. rows 0: none.
  void set_recording(const DemoRows& demo, uint64_t mark);
  // Actor and statistics become a frozen policy's, which count for so many samples; Error(kArgument) names
  // what differs, and nothing changes.
  void load_policy(const PolicyView& policy, double samples);

  void write_policy_file(Writer& out);  // const but for scratch
  // The policy becomes what that file would be, without memory; Error(kArgument) names what differs.
  void update_policy(Policy& policy);  // const but for scratch
  // What samples: a checksum of the actor, then the epoch. With option average policies are of another one.
  uint64_t generation() const { return generation_of(nets_.params); }
  void save(Writer& out) const;  // Error(kState) inside a horizon
  // Error(kFormat, kVersion) unless load would take these bytes; changes nothing.
  void check_state(const void* bytes, size_t size);
  void load(const void* bytes, size_t size);  // changes nothing when it fails
  Ranks& ranks() { return workers_.ranks(); }
  const AgentConfig& config() const { return resolved_.config; }  // pointers inside are not valid any more

 protected:
  // After open has made everything.
  virtual void opened() {}
  // What the passes minimise; null: they move the critics alone.
  virtual const PolicyLoss* policy_loss() const = 0;
  // After advantages were estimated, before the policy step: moves multipliers, sets gain and linear of the
  // rollout. Default: the reward advantage. epoch counts from 1.
  virtual void begin_epoch(const JudgedCosts& costs, int32_t epoch);
  // gain becomes the reward advantage, linear 0.
  void follow_reward();
  // A step of the policy over the whole batch, before the passes: job after job until there is none.
  virtual void begin_step() {}
  virtual Job step_on() { return {}; }
  // Of learners from a replay memory (off_policy/). The full horizon, before an update begins.
  virtual void take_horizon(const float*) {}
  // Samples are uniform, whatever the policy.
  virtual bool explores_blindly() const { return false; }
  // Tensors behind those of the networks; name [kTensorNameSize].
  virtual int32_t num_own_tensors() const { return 0; }
  virtual bool own_tensor(int32_t, char*, TensorInfo*) const { return false; }
  // After somebody else wrote into the networks, and after a state was read.
  virtual void actor_replaced() {}
  virtual void after_load() {}
  virtual double mean_value(bool of_cost) const { return collector_.mean_value(of_cost); }
  virtual int64_t skipped() const { return learner_.skipped(); }
  // Rounds of all passes, in which the policy learns: each of one group where the groups of a team learn in turn. The
  // critics learn in the first.
  virtual int32_t turns() const { return 1; }
  // Before the passes of a turn, the first included; a job that they wait for.
  virtual Job begin_turn(int32_t) { return {}; }
  // What is measured of each minibatch of the policy's passes before its gradient, and what follows from it.
  virtual Job measure_minibatch(const Batch&) { return {}; }
  virtual void begin_minibatch(const Surrogate&) {}
  // So many passes of the policy alone follow the passes of all networks, and this job comes before them;
  // policy_loss() is what they minimise then.
  virtual int32_t second_passes() const { return 0; }
  virtual Job begin_second() { return {}; }
  void need_idle(const char* call) const;  // Error(kState) inside a horizon
  // For learn: statistics of observations become those of the rows.
  void take_statistics(const LearnRows& rows);
  // Likewise: the actor has learned. Until its first mean is taken, policy files have it as it is.
  void end_learning();
  // Multiplier of limited cost i.
  virtual double cost_weight(int32_t) const { return 0; }
  // Copies live options to where they are used.
  virtual void read_live();
  virtual void visit_state(StateIo& io);
  // Checks a saved state, or with `apply` takes one that was checked.
  void read_state(const void* bytes, size_t size, bool apply);

  // For the Epoch: means over samples.
  struct Learned {
    int32_t passes = 0;
    double last_kl = 0;  // KL(old || new) over the last pass, each minibatch's before its step
    BatchSums mean;      // over all passes
  };
  // What a step of the policy has to say beside the passes.
  virtual void report(Learned&) const {}

  const ResolvedAgentConfig& resolved() const { return resolved_; }
  Networks& nets() { return nets_; }
  const Networks& nets() const { return nets_; }
  BatchWorkers& workers() { return workers_; }
  const Normalizer& normalizer() const { return collector_.normalizer(); }
  bool normalizes() const { return collector_.normalizes(); }
  Learner& learner() { return learner_; }
  // Share of a linear schedule that is left in this epoch.
  double schedule_share() const { return schedule_.share(epoch_); }
  // Of all ranks.
  int32_t valid_rows() const { return collector_.listed().rows; }
  const Batch& whole_batch() const { return collector_.listed(); }
  // J_c - limit of limited cost i in the units of a mean over decisions (option violation_scale); 0, at the
  // limit, while J_c is not known.
  double violation(const JudgedCosts& costs, int32_t i) const;
  const Rollout& rollout() const { return collector_.rollout(); }

 private:
  // What an update comes to next; behind a job, what it has left.
  enum class Phase {
    kIdle,
    kEstimate,
    kJudge,
    kStep,
    kPass,
    kMinibatch,
    kGradient,
    kAdam,
    kStop,
    kSpread,
    kEnd
  };
  // Of the update that runs.
  struct Run {
    EpisodeStats stats;
    EpochTotals totals;
    bool warm = false;                   // one of the first epochs, in which the critics learn alone
    int64_t skipped = 0;                 // gradients, before it
    int32_t turn = -1, turn_passes = 0;  // -1: before the first
    bool second = false;                 // passes of the policy alone
    int32_t minibatch = 0;               // that comes next
    Batch batch;
    int32_t block = 0, row = 0;  // that spread_on comes to next
    BatchSums last, all;         // of this pass so far, of those before
    bool clips = false;          // all.clipped was counted
    Epoch epoch;
  };
  void unit(bool whole);
  void judge_epoch();
  void begin_pass();
  bool next_minibatch();
  void end_pass(const PolicyLoss* policy);
  void end_update();
  void end_run();
  uint64_t generation_of(const float* actor) const;
  // Of the actor that others get to see, valid until statistics move.
  PolicyView policy_view();
  // Error(kArgument) names what differs. own: from the agent's files; else from what it may begin with, which of a
  // student is its teacher's.
  void need_same_shape(const PolicyView& policy, bool own) const;
  uint64_t learned_hash() const;
  void begin_decision(const char* call);
  // Error(kState) for what another policy sampled.
  void need_generation(const char* call, const Transition& t);
  void need_clouds(const DemoRows& demo) const;
  void find_history_entries();
  void find_latent_entries();
  void need_same_latent(const PolicyView& policy, bool own) const;
  // action_std and entropy: of the policy now, or with std_mode=state as it was on the epoch's data.
  bool spread_on();
  void add_spread(const float* log_std, double share, double count, double* out) const;
  void fill_spread(Epoch& e);
  void fill_episodes(const EpisodeStats& stats, const EpochTotals& totals, Epoch& e) const;
  void fill_counts(const EpochTotals& totals, int64_t skipped, Epoch& e) const;
  void fill_learned(double rate, Epoch& e);
  void hear_cancel();
  void warn_of_limits(const EpisodeStats& stats);

  ResolvedAgentConfig resolved_;
  CancelFlag cancel_;
  Arena arena_;
  BatchWorkers workers_;
  Networks nets_;
  StillLoss still_;  // of a student's policy
  Collector collector_;
  Learner learner_;
  RateSchedule schedule_;
  Stream* shuffle_ = nullptr;  // [this rank's blocks]
  double* spread_ = nullptr;   // [this rank's blocks][2], with std_mode=state
  Phase phase_ = Phase::kIdle;
  Job job_;
  Run run_;
  Learned learned_;
  uint64_t sampler_ = 0;  // generation() in this horizon, 0: nothing has asked yet
  int32_t epoch_ = 0;
  bool warned_ = false;  // that a limit cannot be judged
  Regression regression_;
  Imitation imitation_;
  char (*names_)[kTensorNameSize] = nullptr;  // of the tensors
  const ObsField* fields_ = nullptr;          // [num_fields] for policy files
  // What an encoder of a latent and the network behind it read, of the entries that the actor sees with their history.
  int32_t *latent_entries_ = nullptr, *own_entries_ = nullptr;
  int32_t* history_entries_ = nullptr;  // [history_width] of those that the actor sees; null: the first
  float* seen_statistics_ = nullptr;    // [2][actor_entries], where the actor sees a part of a row
};

}  // namespace rdm
