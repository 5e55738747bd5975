// Planning by sampling: from a world's present state many worlds are rolled out under noisy plans, and the
// plan moves to what went best. Mirrors rdm_planner_*.
//
// A plan is an action for each of the next H steps of the pool. One call of act, with sample i's actions
//   a_i(t) = clip(c(t) + sum_k B_k(t) e_ik, -1, 1),   e_ik ~ N(0, s_k), e_0 = 0     B: knots.hpp
// about the centre c: the plan of the call before, shifted by one step, or with a policy the actions of that
// policy's rollout, where the shifted plan is sample 1. Each iteration rolls all samples out and moves c:
//   predictive   the actions of the best (predictive sampling, Howell et al. 2022)
//   mppi         sum_i w_i a_i(t), w by return (ranking.hpp)
//   cem          the mean of the elites' a_i(t); s_k becomes the deviation of their e_ik
// The world is its own model: rollouts know what it will draw. The sum of a rollout ends where its episode
// does; one that is still running at H adds the critic's value.
//
// A policy with a memory, and a critic with a history: the states go along in their rollouts, and the planner keeps
// those of its world. As a state hangs on the observations of the decisions so far alone, it is enough that a call sees
// each step of the world, as calls do: in the steps in which policy or critic decide, they see what the world shows,
// whether the call plans or follows the plan. Another episode, another world and forget begin anew.
//
// A call ends early, between two steps of its rollouts, by cancel(): an error, and nothing has changed; or by
// config.stop: what the finished iterations made of the plan is the plan, as if there were no more of them.
#pragma once
#include "base/cancel.hpp"
#include "env/mean_policy.hpp"
#include "env/moment.hpp"
#include "plan/knots.hpp"
#include "plan/ranking.hpp"

namespace rdm {

enum class PlanMethod : int32_t { kPredictive = 0, kCem = 1, kMppi = 2 };

const OptionSpec* planner_options(int32_t* count);
struct PlanOptions {
  PlanMethod method;
  int32_t samples, horizon, knots;  // worlds, steps of the pool, of the noise over a plan
  Interpolation interpolation;
  double noise, noise_min;  // deviations, in units of the action
  int32_t elites;
  double temperature;
  int32_t iterations;
  bool warm_start;
  int32_t replan;  // calls
  bool best_only;  // choice
  double discount;
  CostRule costs;
  double multiplier;
  bool share;  // budget
  bool terminal_cost;
};

// How good a state is; a view of what somebody else owns.
class PlanCritic {
 public:
  // value [rows] and cost [rows][num_costs()] of obs [rows][obs_dim], before whose decisions the states are state
  // [rows][state_dim()].
  virtual void values(const float* obs, const float* state, int32_t rows, float* value, float* cost) = 0;
  // The states after decisions that saw obs; as MeanPolicy's.
  virtual void see(const float* obs, int32_t rows, float* state) = 0;
  virtual int32_t state_dim() const = 0;
  virtual int32_t repeat() const = 0;
  virtual int32_t num_costs() const = 0;
  virtual int32_t column(int32_t i) const = 0;

 protected:
  ~PlanCritic() = default;
};

struct PlannerConfig {
  const Pool* pool = nullptr;           // whose task and options the rollouts have; not kept
  int32_t num_threads = 0;              // of the rollouts; 0: as many as the pool's
  uint64_t seed = 0;                    // of the noise
  const float* noise = nullptr;         // [action_dim] deviations; null: option noise
  const double* cost_limits = nullptr;  // [cost_dim] of an episode, < 0: none; null: the task's
  const OptionInput* options = nullptr;
  int32_t num_options = 0;
  const char* settings = nullptr;
  MeanPolicy* policy = nullptr;  // both outlive the planner; null: none
  PlanCritic* critic = nullptr;
  int32_t (*stop)(void* user, int64_t steps) = nullptr;  // not 0: no more of this plan; null: never
  void* user = nullptr;                                  // given to stop
  HostHooks hooks;
};

struct PlanInfo {
  Course best;                // of the last iteration that was finished, as the two below
  int32_t best_sample = 0;    // its number
  double feasible_share = 0;  // of its samples
  int32_t iterations = 0;     // finished; 0: the plan of before was followed
  bool cut = false;           // config.stop ended it
  int64_t steps = 0;          // that the rollouts took, those of an unfinished iteration too
};

class Planner {
 public:
  static Planner* create(const PlannerConfig& config);
  static void destroy(Planner* p);

  // Plans from the present state of a world and gives the first action of the plan. Error(kState) where no
  // episode runs, Error(kCancelled), else as Pool::copy: nothing has changed then. No heap use.
  void act(const Pool& pool, int32_t env, float* action, PlanInfo* info);
  void cancel() { cancel_.set(); }  // from any thread or signal handler
  void forget();                    // the plan: the next call starts anew; the noise goes on
  // [horizon][action_dim]; row 0 is the action that act gave. What set_plan takes is the next call's own, not
  // shifted; entries are clipped. Error(kArgument) for one that is not finite.
  const float* plan() const { return plan_; }
  void set_plan(const float* plan);

  int32_t horizon() const { return settings_.horizon; }
  int32_t samples() const { return settings_.samples; }
  int32_t knots() const { return settings_.knots; }
  int32_t action_dim() const { return action_dim_; }
  int32_t cost_dim() const { return cost_dim_; }
  const Options& options() const { return options_; }

  // Plan, noise and counters: a planner of the same options that reads them goes on with the same bytes.
  void write_state(Writer& out) const;
  void read_state(const void* bytes, size_t size);  // Error(kFormat): unchanged

  ~Planner();
  Planner(const PlannerConfig& config);

 private:
  void read_options(const PlannerConfig& config);
  void make_rollouts(const PlannerConfig& config);
  void carve(Arena& arena);
  uint64_t fingerprint() const;

  void start_plan(float* plan) const;
  void shift_plan();
  void set_budgets(const Pool& pool, int32_t env);
  void make_plan(const Pool& pool, int32_t env, PlanInfo* out);  // as the centre
  bool stopped();                                                // asked between two steps; Error(kCancelled)
  void recall(const Pool& pool, int32_t env);                    // recalled_ and next_state_ of this call
  void remember(const Pool& pool, int32_t env);
  // In step t of the plan, who holds an action for so many control steps.
  bool decides(const Pool& pool, int32_t env, int32_t repeat, int32_t t) const;
  // The policy's rollout from the state of `env`: its actions become the centre. False: stopped on the way.
  bool propose(const Pool& pool, int32_t env);
  void draw_noise();
  const float* plan_row(int32_t step) const;  // of the plan as this call finds it
  void sample_action(int32_t sample, int32_t step, float* action) const;
  bool roll_out(const Pool& pool, int32_t env);  // false: stopped on the way
  void add_terminal(double discount);
  void move_centre();
  void describe_iteration(PlanInfo* out) const;

  HostHooks hooks_;
  Options options_;
  PlanOptions settings_;  // what options_ say, within each other's bounds
  CourseRule rule_;
  double limit_[kMaxTaskCosts] = {};  // of an episode, < 0: none
  bool pools_limit_ = false;          // of column 0 the limit that the pool's episode has, where it has one
  MeanPolicy* policy_ = nullptr;
  PlanCritic* critic_ = nullptr;
  int32_t (*stop_)(void*, int64_t) = nullptr;
  void* user_ = nullptr;
  CancelFlag cancel_;

  Pool* rollouts_ = nullptr;  // [samples] worlds
  int32_t action_dim_ = 0, cost_dim_ = 0;
  int64_t steps_ = 0;

  Arena arena_;
  KnotRow* rows_ = nullptr;                                      // [horizon]
  float *start_ = nullptr, *noise_std_ = nullptr;                // [action_dim]
  float *floor_ = nullptr, *sigma_ = nullptr;                    // [knots][action_dim]
  float *plan_ = nullptr, *centre_ = nullptr, *next_ = nullptr;  // [horizon][action_dim]
  float* noise_ = nullptr;                                       // [samples][knots][action_dim]
  double *weights_ = nullptr, *sum_ = nullptr;                   // [samples], [action_dim]
  float *value_ = nullptr, *cost_value_ = nullptr;               // [samples], [samples][critic's costs]
  float *last_ = nullptr, *row_ = nullptr;                       // [action_dim] given last; scratch
  uint8_t* alive_ = nullptr;                                     // [samples]
  Course* courses_ = nullptr;                                    // [samples]
  Standing* standings_ = nullptr;                                // [samples]
  int32_t* order_ = nullptr;                                     // [samples]

  // What the policy remembers of the world, and behind it the critic: before and behind the step of the last call, and
  // the same of this call until it can no more fail; [state_dim].
  int32_t policy_dim_ = 0, critic_dim_ = 0, state_dim_ = 0;
  Moment seen_;
  float *before_ = nullptr, *after_ = nullptr, *recalled_ = nullptr, *next_state_ = nullptr;
  float* walked_ = nullptr;        // [policy_dim] in the policy's rollout
  float* critic_state_ = nullptr;  // [samples][critic_dim] in those of the samples

  Stream stream_;
  bool planned_ = false, given_ = false;  // there is a plan; its first row was given, so it is shifted next
  bool foreign_ = false;                  // sample 1 is the plan, not noise about the centre
  int32_t ahead_ = 0;                     // rows of the plan that were given
  int32_t since_ = 0;                     // calls since it was made
};

}  // namespace rdm
