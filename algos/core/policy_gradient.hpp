// The agent that all algorithms derive from: collector, learner, and the order of an epoch.
//
// An algorithm overrides what it does differently: the loss of the policy (policy_loss), what happens with
// multipliers before the policy step (begin_epoch), or the whole step (learn).
#pragma once
#include "algos/core/collector.hpp"
#include "algos/core/learner.hpp"
#include "algos/core/schedule.hpp"

namespace rdm {

class PolicyGradient : public Agent {
 public:
  explicit PolicyGradient(ResolvedAgentConfig&& plan) : plan_(std::move(plan)) {}
  // Takes memory from the hooks and draws the first weights.
  void open(const AgentConfig& config);
  // Adds what this algorithm needs to an arena, measuring or real.
  virtual void carve(Arena& arena);
  const AlgoRow& row() const { return *plan_.row; }

  void act(const float* obs, bool sample, float* action) override;
  void record(const Transition& t) override;
  // After a cancel the parameters are those of the last finished minibatch.
  void update(const float* last_obs, Epoch* out) override;
  int32_t missing() const override { return collector_.missing(); }
  int32_t horizon() const override { return plan_.horizon; }
  int32_t action_repeat() const override { return plan_.action_repeat; }
  void drop_horizon() override { collector_.drop(); }

  void set_option(const OptionInput& option) override;
  const Options& options() const override { return plan_.options; }
  bool tensor(int32_t index, TensorInfo* out) override;
  void tensors_changed() override { clamp_log_std(nets_); }

  void write_policy_file(Writer& out) override;
  void save(Writer& out) const override;
  void check_state(const void* bytes, size_t size) override;
  void load(const void* bytes, size_t size) override;
  const AgentConfig& config() const override { return plan_.config; }

 protected:
  // After open has made everything.
  virtual void opened() {}
  // What the passes of the default learn() minimise.
  virtual const PolicyLoss& policy_loss() const = 0;
  // After advantages were estimated, before the policy step: moves multipliers, sets gain and linear of the
  // rollout. Default: the reward advantage. epoch counts from 1.
  virtual void begin_epoch(const EpisodeStats& stats, int32_t epoch);
  // The steps of policy and critics. Default: passes over shuffled minibatches, stopped early by KL.
  virtual void learn();
  // Before the gradient of each minibatch of the default learn().
  virtual void begin_minibatch(const int32_t*, int32_t) {}
  // Multiplier of limited cost i.
  virtual double cost_weight(int32_t) const { return 0; }
  // One pass over the valid rows in shuffled minibatches: a step of the critics and, unless null, of the
  // policy for each.
  BatchSums pass(const PolicyLoss* policy);
  // Copies live options to where they are used.
  virtual void read_live();
  virtual void visit_state(StateIo& io);
  // Checks a saved state, or with `apply` takes one that was checked.
  void read_state(const void* bytes, size_t size, bool apply);

  // What learn() leaves for the Epoch: means over samples.
  struct Learned {
    int32_t passes = 0;
    double last_kl = 0;  // KL(old || new) over the last pass
    BatchSums mean;      // over all passes
  };

  const ResolvedAgentConfig& plan() const { return plan_; }
  Networks& nets() { return nets_; }
  BatchWorkers& lanes() { return lanes_; }
  Learner& learner() { return learner_; }
  Learned& learned() { return learned_; }
  // Share of a linear schedule that is left in this epoch.
  double schedule_share() const { return schedule_.share(epoch_); }
  int32_t valid_rows() const { return valid_rows_; }
  // J_c - limit of limited cost i in the units of a mean over decisions (option violation_scale).
  double violation(const EpisodeStats& stats, int32_t i) const;
  const Rollout& rollout() const { return collector_.rollout(); }

 private:
  // action_std and entropy: of the policy now, or with std_mode=state as it was on the epoch's data.
  void fill_spread(Epoch& e) const;
  void fill_epoch(const EpisodeStats& stats, double rate, Epoch* out) const;

  ResolvedAgentConfig plan_;
  Arena arena_;
  BatchWorkers lanes_;
  Networks nets_;
  Collector collector_;
  Learner learner_;
  RateSchedule schedule_;
  Stream shuffle_;
  Learned learned_;
  int32_t epoch_ = 0, valid_rows_ = 0;
  char (*names_)[kTensorNameSize] = nullptr;
};

}  // namespace rdm
