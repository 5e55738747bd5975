// One training run in its folder: epochs, evaluations, the best policy so far, checkpoints, resuming.
#pragma once
#include <optional>

#include "play/episodes.hpp"
#include "run/folder.hpp"
#include "run/meter.hpp"
#include "run/note.hpp"
#include "run/progress.hpp"
#include "run/ranks.hpp"
#include "teach/teacher.hpp"

namespace tool {

class Trainer {
 public:
  static constexpr uint64_t kEvalSeed = 1000000;  // the report at the end uses streams of seed + this

  // Makes worlds and agent; nothing is written yet. ranks: this process is one of them, which must outlive
  // the trainer: it has its part of the worlds, and the first rank alone writes and evaluates.
  explicit Trainer(RunSettings settings, const Ranks* ranks = nullptr);
  // What a run needs from its first step on; throws where the settings do not go together.
  void prepare();
  // Starts a run in the folder, after prepare(), or goes back to its checkpoint (to the start when it was
  // killed before the first).
  void begin(RunFolder folder);
  void resume(RunFolder folder);
  // The same of a rank that is not the first, which has no folder of its own. Empty: the run begins.
  void follow(const std::string& checkpoint);

  // Epochs until the steps are done or SIGINT; then the last checkpoint and policy.rdm.
  void run();

  const RunFolder& folder() const { return *folder_; }
  const RunSettings& settings() const { return settings_; }
  int64_t steps_per_epoch() const;  // at most: worlds rest from an episode's end to the next decision
  const std::vector<double>& limits() const { return limits_; }
  int64_t env_steps() const { return env_steps_; }
  bool interrupted() const { return interrupted_; }
  double seconds() const { return seconds_; }  // of this process, evaluations included
  const Taught& taught() const { return taught_; }
  Trouble trouble() const { return trouble_of(pool_); }  // of training, in this process
  double steps_per_second() const;                       // of this process, collecting and learning
  // Sum over all epochs of the run of what a column of progress.csv counts; NaN where one does not tell.
  double total(const char* column) const;

 private:
  void add_shield();
  void take_rate();
  std::string config() const;
  void restore(const std::string& path);
  bool first() const { return !ranks_ || ranks_->first(); }
  bool stopped() const;  // by a signal to one of the ranks
  void plan_schedule();
  void learn_from_teacher();
  void draw_starts();
  bool wants_imitation() const;
  bool wants_starts() const;
  int64_t option(const char* key) const;  // of the agent, as it stands
  void train_epoch(Meter& meter);
  void train_to_the_end(Meter& meter);
  // Whether a policy is better than the best so far, which it then replaces; `last`: how it looked. One whose
  // episodes diverged is not.
  bool compete(const redman::Bytes& policy, LastEvaluation* last);
  std::vector<Episode> play(Actor& actor, size_t round);
  void save();
  void finish();

  const Ranks* ranks_;
  std::optional<RunFolder> folder_;  // of the first rank
  RunSettings settings_;
  redman::Pool pool_, eval_pool_;
  std::vector<double> limits_;
  std::optional<redman::Shield> shield_;  // of the agent's rollouts, which it outlives
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
  Taught taught_;
};

}  // namespace tool
