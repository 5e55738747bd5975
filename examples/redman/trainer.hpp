// One training run in its folder: epochs, evaluations, the best policy so far, checkpoints, resuming.
#pragma once
#include <optional>

#include "bench/meter.hpp"
#include "draw/curve.hpp"
#include "episodes.hpp"
#include "run_folder.hpp"

namespace tool {

// How good an evaluation was. Feasible before infeasible; feasible by return, infeasible by column costs.
struct Score {
  bool feasible = false;
  double ret = 0, excess = 0;  // excess: sum over limited columns of cost above the limit, as a share of it
  bool better_than(const Score& other) const;
};

class Trainer {
 public:
  static constexpr size_t kEvalEpisodes = 20;     // of an evaluation during training
  static constexpr uint64_t kEvalSeed = 1000000;  // evaluations use streams from seed + this

  // Makes worlds and agent; nothing is written yet.
  explicit Trainer(RunSettings settings);
  // Starts a run in the folder, or goes back to its checkpoint (to the start when it was killed before the
  // first).
  void begin(RunFolder folder);
  void resume(RunFolder folder);

  // Epochs until the steps are done or SIGINT; then the last checkpoint and policy.rdm.
  void run();

  const RunFolder& folder() const { return *folder_; }
  const RunSettings& settings() const { return settings_; }
  const std::vector<double>& limits() const { return limits_; }
  int64_t env_steps() const { return env_steps_; }
  bool interrupted() const { return interrupted_; }
  double seconds() const { return seconds_; }  // of this process, evaluations included
  double steps_per_second() const;             // of this process, collecting and learning

 private:
  void restore();
  void plan_schedule();
  int64_t steps_per_epoch() const;  // at most: worlds rest from an episode's end to the next decision
  void train_epoch(Meter& meter);
  Score evaluate(const redman::Bytes& policy, LastEvaluation* last);
  void save();
  void finish();

  std::optional<RunFolder> folder_;
  RunSettings settings_;
  redman::Pool pool_, eval_pool_;
  std::vector<double> limits_;
  redman::Agent agent_;
  std::vector<double> score_limits_;  // limits that rank policies: none for an algorithm without cost limits

  // What a checkpoint's note carries.
  int64_t env_steps_ = 0;
  int32_t epoch_ = 0;
  size_t progress_bytes_ = 0;
  std::optional<Score> best_;
  redman::Bytes best_policy_;
  LastEvaluation last_;
  double earlier_seconds_ = 0;  // Time/Total of the processes before this one

  int32_t saved_epoch_ = -1, scored_epoch_ = -1;
  int64_t own_steps_ = 0;
  double own_seconds_ = 0, seconds_ = 0;
  bool interrupted_ = false;
};

}  // namespace tool
