// The agent that all algorithms derive from: acting, recording, advantages, passes of minibatches.
//
// An algorithm overrides what it does differently: the loss of a sample (policy_loss), what happens with
// the multipliers before the policy step (begin_epoch), or the whole step (learn).
#pragma once
#include <optional>

#include "algos/episodes.hpp"
#include "algos/lanes.hpp"
#include "algos/noise.hpp"
#include "algos/rollout.hpp"
#include "algos/schedule.hpp"
#include "nn/normalizer.hpp"

namespace rdm {

// A piece of a minibatch as the policy loss sees it.
struct PolicyPiece {
  const int32_t* order = nullptr;  // [rows] rows of the rollout
  int32_t rows = 0;
  const float* mean = nullptr;         // [rows][action_dim] of the policy being learned
  const float* log_std = nullptr;      // [action_dim] of the innovation
  const float* old_log_std = nullptr;  // [action_dim] of the policy that acted
  float scale = 1;                     // 1 / rows of the minibatch
  float* dmean = nullptr;              // out: scale d(loss)/d(mean) [rows][action_dim]
  float* dlog_std = nullptr;           // in and out: scale d(loss)/d(log_std), added
  BatchSums* sums = nullptr;           // in and out: loss, kl, clipped
};

// Error(kArgument) naming the first row of x [rows][dim] that is not finite; rows whose mask is 0 are
// skipped.
void check_rows(const char* name, const float* x, const uint8_t* mask, int32_t rows, size_t dim);

class PolicyGradient : public Agent {
 public:
  explicit PolicyGradient(Plan&& plan) : plan_(std::move(plan)) {}
  // Takes memory from the hooks and draws the first weights.
  void open(const AgentConfig& config);
  virtual void carve(Arena& arena);
  const AlgoRow& row() const { return *plan_.row; }

  void act(const float* obs, bool sample, float* action) override;
  void record(const Transition& t) override;
  void update(const float* last_obs, Epoch* out) override;
  int32_t missing() const override { return plan_.horizon - rollout_.filled; }
  int32_t horizon() const override { return plan_.horizon; }
  int32_t action_repeat() const override { return plan_.action_repeat; }
  void drop_horizon() override;

  void set_option(const OptionInput& option) override;
  const Options& options() const override { return plan_.options; }
  bool tensor(int32_t index, TensorInfo* out) override;
  void tensors_changed() override { clamp_log_std(nets_, plan_.options); }

  void write_policy_file(Writer& out) override;
  void save(Writer& out) const override;
  void load(const void* bytes, size_t size) override;
  const AgentConfig& config() const override { return plan_.config; }

 protected:
  // Adds loss and gradient of a piece. Runs on any thread, must not throw.
  virtual void policy_loss(const PolicyPiece& piece) const = 0;
  // After advantages were estimated, before the policy step: moves multipliers, sets gain and linear of the
  // rollout. Default: the reward advantage. epoch counts from 1.
  virtual void begin_epoch(const EpisodeStats& stats, int32_t epoch);
  // The policy and critic steps of an epoch. Default: passes over shuffled minibatches.
  virtual void learn();
  virtual double cost_weight(int32_t) const { return 0; }
  // Copies live options into what is used.
  virtual void read_live();
  virtual void visit_state(StateIo& io);

  const Plan& plan() const { return plan_; }
  const Rollout& rollout() const { return rollout_; }

 private:
  struct Live {
    double critic_rate, entropy, max_grad_norm, critic_l2, early_stop_kl;
  };
  // What learn leaves for the Epoch.
  struct Learned {
    int32_t passes = 0;
    double pass_kl = 0, mean_kl = 0;  // of the last pass, of all
    double clip_fraction = 0, loss_policy = 0, loss_reward = 0, loss_cost = 0;
  };

  void read_log_std(float* log_std) const;
  const float* normalized(const float* obs, int32_t rows, float* memory) const;
  void forward_critics(const Lane& lane, const float* x, int32_t rows, float* value, float* cost_value) const;
  void act_rows(const Lane& lane, const float* obs, int32_t first, int32_t rows, float* action);
  void mean_rows(const Lane& lane, const float* obs, int32_t rows, float* action) const;
  void value_truncated(const Transition& t);
  void record_row(const Transition& t, int32_t env);
  void charge_fall(int32_t env, float discount, float* sample_cost, double* charge) const;
  void check_transition(const Transition& t) const;
  void estimate(const float* last_obs);
  void shuffle(int32_t count);
  BatchSums step_minibatch(const int32_t* order, int32_t rows, double rate);
  void piece_gradient(Lane& lane, const int32_t* order, int32_t rows, int32_t batch_rows, float* grad) const;
  double critic_gradient(Lane& lane, Networks::Index net, const int32_t* order, int32_t rows,
                         int32_t batch_rows, float* grad) const;
  void fold_gradients(int32_t first, int32_t n);
  void apply_gradients(double rate);
  double batch_kl(int32_t count);
  void fill_epoch(const EpisodeStats& stats, double rate, Epoch* out) const;
  void write_config(Writer& out) const;
  void read_config(Reader& in, bool apply);

  Plan plan_;
  Arena arena_;
  std::optional<Workers> workers_;
  Networks nets_;
  Rollout rollout_;
  Normalizer normalizer_;
  Noise noise_;
  Episodes episodes_;
  RateSchedule schedule_;
  Stream shuffle_;
  Live live_{};
  Learned learned_;
  Lane* lanes_ = nullptr;         // [plan.lanes]
  float* grad_ = nullptr;         // [Networks::size] of the minibatch
  float* log_std_ = nullptr;      // [action_dim] of the innovation, now
  float* old_log_std_ = nullptr;  // and when the epoch was collected
  float* std_ = nullptr;          // exp of log_std_
  float* final_value_ = nullptr;  // [num_envs] after truncation
  float* final_cost_ = nullptr;   // [num_envs][num_limited]
  int32_t* listed_ = nullptr;     // [num_envs] environments that were truncated
  char (*names_)[kTensorNameSize] = nullptr;

  bool pending_ = false;  // a sampled act waits for its record
  bool normalize_ = true, learn_std_ = true, terminal_cost_ = false;
  AdvantageOptions advantage_;
  double discount_ = 0;  // per control step
  int32_t epoch_ = 0, valid_rows_ = 0;
  int64_t env_steps_ = 0, skipped_ = 0;
};

}  // namespace rdm
