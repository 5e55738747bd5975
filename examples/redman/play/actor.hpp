// Who acts in a pool: a policy file, a planner, a demonstration, a recorded rollout, or one of the baselines
// zero, hold, random.
#pragma once
#include <functional>
#include <optional>
#include <redman/plan.hpp>
#include <redman/sense.hpp>
#include <string>

#include "common/setup.hpp"
#include "demo/player.hpp"
#include "play/shielded.hpp"

namespace tool {

struct Recording;

// What a `--policy` word stands for.
struct ActorChoice {
  std::string file;   // of a policy, else ""
  bool plan = false;  // a planner; `file` proposes, if there is one
  std::string plan_settings;
  std::string critic;     // of a planner: a run folder, else ""
  int32_t baseline = -1;  // RDM_BASELINE_*
  bool demo = false;      // the script, or without one the task's own
  std::optional<DemoScript> script;
  std::shared_ptr<const Recording> recording;
  bool alone = false;               // a policy file without its run's config.json
  std::string task;                 // that the policy learned; "" unknown
  Options options;                  // of the task, when the policy stands in a run folder
  std::vector<std::string> limits;  // --cost-limit of that run
  bool magnitudes = false;          // which are on magnitudes
  int32_t points = 0, repeat = 1;   // of a policy with eyes: that it sees, and control steps of a decision
  bool color = false;               // and whether in colour
  ShieldWord shield;                // --shield: who looks at what it does
  std::string run_shield;           // lines key=value of the run's, which lie under that
};
// zero, hold, random, demo, trained (of `task`, play/trained.hpp), plan (play/plan_word.hpp), a .demo file,
// an .npz file of a rollout, a policy file or a run folder. Failure when the file cannot be read as what it
// is.
ActorChoice choose_actor(const std::string& word, const std::string& task = "");

// Lays what the policy knows about its task under the flags: the task's name when `task_given` is false, and
// the options of its run when the tasks agree; says so of a policy whose run is not known. A recording brings its seed, and plays its own task alone.
// `sets` are those that will be laid over all that: they choose among the demonstrations of a task.
void adopt_task(const ActorChoice& choice, bool task_given, const std::vector<std::string>& sets,
                PoolSettings& pool);

// What planning took.
struct PlanningCost {
  double seconds = 0;
  int64_t calls = 0, steps = 0;  // actions; control steps of the rollouts
};

class Actor {
 public:
  // Failure when the policy does not fit the pool's observations and actions, Usage when its decision is no
  // whole number of the pool's steps. A recording's episode e is
  // played as the pool's episode e, each from its recorded start.
  Actor(const ActorChoice& choice, redman::Pool& pool, bool stochastic = false, uint64_t seed = 0);
  Actor(redman::Policy policy, const redman::Pool& pool);

  // Episodes begin anew in the worlds of the mask [num_envs] (null: all): a decision is due there.
  void restart(const uint8_t* mask = nullptr);
  // Fills the action rows of the worlds in the mask. A policy decides every action_repeat control steps of
  // its own, whatever the pool's step is. `change` may lay other rows over its own, before the shield looks at them.
  void act(redman::Pool& pool, const uint8_t* mask = nullptr, const std::function<void()>& change = {});
  // Steps the worlds in the mask by these rows; the shield counts what it could not prevent.
  void step(redman::Pool& pool, const uint8_t* mask = nullptr);
  // Failure when an episode of a recording did not end where it ended when it was recorded.
  void check_ends() const;
  const PlanningCost& planning() const { return planning_; }
  const Shielded* shielded() const { return shielded_ ? &*shielded_ : nullptr; }  // null: no shield

 private:
  void add_shield(const ActorChoice& choice, const redman::Pool& pool, uint64_t seed);
  void propose(redman::Pool& pool, const uint8_t* mask);
  void make_planners(const ActorChoice& choice, const redman::Pool& pool, uint64_t seed);
  void plan(redman::Pool& pool, const uint8_t* mask);
  void prepare(const redman::Pool& pool, bool stochastic, uint64_t seed);
  void replay(redman::Pool& pool, const uint8_t* mask);
  std::string went_elsewhere(size_t env) const;

  int32_t baseline_ = -1;
  std::optional<redman::Policy> policy_;
  std::optional<redman::Policy> proposer_;  // these two outlive the planners
  std::optional<redman::Agent> critic_;
  std::vector<redman::Planner> planners_;  // [num_envs]
  PlanningCost planning_;
  std::optional<Demo> demo_;
  std::shared_ptr<const Recording> recording_;
  std::string file_;                      // of the recording
  std::vector<size_t> episode_, played_;  // [num_envs] of the recording, and its steps so far
  std::optional<redman::Actor> player_;   // of policy_, which outlives it
  rdm_points seen_ = {};                  // clouds of all worlds, where it sees them
  std::optional<Shielded> shielded_;      // by policy_ or proposer_, which outlive it
};

}  // namespace tool
