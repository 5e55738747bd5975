// The shield, in two layers. It projects: what is proposed goes to the nearest action that keeps the guards, half
// spaces (project.hpp). It predicts: that goes through only where a copy of its world, going on by a known plan,
// keeps within the budget of every cost until its episode ends. Either can be left out. Mirrors rdm_shield_*.
//
// Guards of a task hold where the budget of their cost is 0; a host adds its own. All that is tried in copies keeps
// them too, what is foreseen, backups and noise. A guard that changes takes its world's plan with it.
//
// A plan is the decisions of a world from now to its episode's end, as actions, that were run in a copy. Copies
// are exact, so what was clean there is clean here, and after each decision the rest of the plan is a plan: by
// induction no cost ever goes beyond its budget, whatever is proposed, once there is a first plan.
//
// For each world, with the action a that is proposed for it, projected:
//   follow    a is the plan's next action to the bit, or the decision is of a block: nothing is tried
//   inquire   a, the decisions that a foresight sees behind it (B together), then the first backup: run in a
//             copy, with the state before each decision kept. Clean: this is the plan, and the B are a block
//   branch    the cost came in decision f: from the state before decision j, for j = f, f-1, f-2, f-4, ... 0,
//             each backup, or a noisy action and then the first backup. The first that is clean, with the
//             latest j: decisions 0..j-1 as they were and then this are the plan; decision j is refused
//   plan      nothing is clean: what is left of the plan before goes on; decision 0 is refused
//   unproven  nor is there a plan, which only a start can bring, or a finite `look`: an error, or with
//             unproven=least the way that exceeds the budgets least
// Asking for 16 decisions at once takes an eleventh of the copied steps that asking for each of them does.
//
// Worlds that are not known, as a robot or one that draws its dynamics: with option copies=K each way is tried in K
// copies, which draw dynamics and noise of their own, and is clean where it is in all of them; every decision is
// asked about alone, as no plan of actions holds for certain. Then there is no proof, but an estimate.
//
// A budget is of an episode. What was spent beyond it before the shield could help stays spent: the bound is
// then what was spent.
#pragma once
#include <algorithm>

#include "base/rng.hpp"
#include "env/moment.hpp"
#include "shield/copies_tried.hpp"
#include "shield/guards.hpp"
#include "shield/remembered.hpp"

namespace rdm {

const OptionSpec* shield_options(int32_t* count);

// What will be proposed in the decisions to come, by the one who proposed the first.
class Foresight {
 public:
  // Numbers that it remembers of a world, at most those that Shield::expect was told of.
  virtual int32_t state_dim() const = 0;
  // Noise of world `env` behind the decision that was proposed: its stream and offset [action_dim]; and what it
  // remembers of the world before that decision, [state_dim].
  virtual void begin(int32_t env, Stream* noise, float* offset, float* state) = 0;
  // The next decision of worlds env [rows], of obs [rows][obs_dim]: action [rows][action_dim]. noise
  // [num_envs] and offset [num_envs][action_dim] are those of begin, and go on; null: without noise. state
  // [rows][state_dim] is what it remembers before, and becomes that after.
  virtual void act(const int32_t* env, const float* obs, int32_t rows, float* state, Stream* noise,
                   float* offset, float* action) = 0;

 protected:
  ~Foresight() = default;
};

struct ShieldConfig {
  const Pool* pool = nullptr;       // whose task, options and number of worlds the copies have; not kept
  int32_t num_threads = 0;          // of the copies; 0: as many as the pool's
  uint64_t seed = 0;                // of noisy branches
  int32_t steps = 1;                // of the pool, that a decision is held
  const double* budgets = nullptr;  // [cost_dim] of an episode, < 0: not looked at; null: 0 for column 0
  const OptionInput* options = nullptr;
  int32_t num_options = 0;
  const char* settings = nullptr;
  HostHooks hooks;
};

enum class ShieldKind : int32_t {
  kOwn = 0,        // what was proposed
  kChanged = 1,    // refused: another action, from which the way is clean
  kPlan = 2,       // refused: the next action of the plan before
  kUnproven = 3,   // nothing that was tried is clean
  kProjected = 4,  // the nearest one that keeps the guards
};

// What the shield says of a world's last decision.
struct ShieldRow {
  ShieldKind kind = ShieldKind::kOwn;
  // Cost that the refused way would have met, -1: nothing was refused, or it diverged; of kProjected the broken
  // guard's, -1: a host's own.
  int32_t column = -1;
  int32_t ahead = 0;  // control steps until then
  // That the plan goes on by: policies, then zero, then hold, then what the foresight would do without noise; -1: no
  // branch.
  int32_t backup = -1;
};

struct ShieldCounts {
  int64_t decisions = 0, inquiries = 0, failed = 0;  // failed: those whose first way was not clean
  int64_t changed = 0, planned = 0, unproven = 0;    // decisions of each kind
  int64_t copied = 0;                                // control steps of copies
  int64_t projected = 0;
};

struct ShieldOptions {
  int32_t block, look, tries, rounds, copies;
  double noise;
  bool best, zero, hold, least, project, predict;
};

class Shield {
 public:
  static constexpr int32_t kMostPolicies = 6;

  static Shield* create(const ShieldConfig& config);
  static void destroy(Shield* s);
  void add_policy(MeanPolicy* policy);  // a backup behind those that it has; it outlives the shield
  void expect(int32_t state_dim);       // of whoever will foresee
  // As Guards::add and Guards::set.
  void add_guard(const float* normal, float bound);
  void set_guard(int32_t env, int32_t i, const float* normal, float bound);

  // What the worlds of `pool` whose mask is not 0 (null: all) are to do in this decision: action
  // [num_envs][action_dim], which may be `proposed`. With a foresight the decisions of a block are as it
  // foresaw them, and what it would do without noise is the first backup. Error(kState) for a world without an
  // episode, or that has nothing clean, which it names: no action is written then. With `unneeded` the host
  // does not run what is refused: with unproven=error nothing clean is no error then, and the action is what
  // was proposed. No heap use. What backups remember of a world goes on with its decisions, which are all to be
  // asked about.
  void act(const Pool& pool, const uint8_t* mask, const float* proposed, Foresight* foresight, float* action,
           bool unneeded = false);
  // Actions [count][action_dim] become the plan of world env where they, and then a backup, are clean in a copy; else
  // Error(kState) says what would come, and its plan stays. No heap use.
  void set_plan(const Pool& pool, int32_t env, const float* actions, int32_t count);
  void forget(const uint8_t* mask);         // plans and memories of worlds whose mask is not 0 (null: all)
  void skip(int32_t env);                   // a world without an episode: its last decision is its own
  void forget_blocks();                     // only what was foreseen: its policy has changed
  void check_pool(const Pool& pool) const;  // Error(kArgument) for one that act does not take
  const ShieldRow& row(int32_t env) const { return rows_[env]; }
  // What counts as proposed in the last decision, [action_dim]: of a block, what was foreseen.
  const float* own(int32_t env) const { return own_ + row_of(env); }
  bool own_moved(int32_t env) const { return moved_[env] != 0; }  // it is not what was proposed, to the bit
  // No plan has decided: what was proposed is unproven, and so is all else.
  bool without_plan(int32_t env) const { return plans_[env].length == 0; }
  // The plan of a world from now on: *count decisions of [action_dim]; 0: there is none.
  const float* plan(const Pool& pool, int32_t env, int32_t* count) const;
  const ShieldCounts& counts() const { return counts_; }

  int32_t num_envs() const { return n_; }
  int32_t action_dim() const { return dim_; }
  int32_t steps() const { return steps_; }
  bool predicts() const { return set_.predict; }
  const Options& options() const { return options_; }

  // Plans, memories, streams and counts: a shield of the same config that reads them goes on with the same bytes, beside
  // a pool that was set to the state of that moment.
  void write_state(Writer& out) const;
  void read_state(const void* bytes, size_t size);  // Error(kFormat): unchanged

  explicit Shield(const ShieldConfig& config);
  ~Shield();

 private:
  struct Plan {
    uint32_t course;          // Pool::course of its world
    int32_t begin;            // the episode's control step before its first decision
    int32_t length;           // decisions; 0: there is none
    int32_t block;            // of these, that are not asked about again while the same one foresees them
    int32_t refused;          // of these, in the place of what was proposed; -1: none
    int32_t backup;           // that it goes on by, as in ShieldRow
    int32_t column, cost_in;  // what the refused way met, and the episode's control step
    uint8_t dirty;            // it exceeds budgets
    uint8_t kept;             // the refusal is of a plan that was there before
    uint8_t adopt;            // it came from a state: its course is the one that its world has then
    uint8_t unused;
  };
  // Of a world that is asked about: its first way, and where that branches.
  struct Inquiry {
    int32_t env;
    int32_t way, samples;     // decisions of the first way; those that were proposed or foreseen
    int32_t tail;             // of the winner, behind its first `from`
    int32_t fail;             // decision in which it met a cost; -1: clean
    int32_t column, cost_in;  // which, and in which control step
    int32_t reserve;          // branches at the front that are taken only where no other is clean
    int32_t next;             // branch that is tried next
    int32_t winner;           // -1: none so far
    int32_t from, backup;     // of the winner
    double ret;               // and its episode's return
    bool least;               // the winner exceeds budgets
  };
  struct Branch {
    int32_t from = 0, backup = -1;  // -1: there are no more
    double noise = 0;               // of its first action, in units of option noise
  };

  static size_t sz(int32_t n) { return static_cast<size_t>(n); }
  void read_options(const ShieldConfig& config);
  void read_budgets(const double* budgets);
  void declare_guards(const Pool& pool);
  void make_copies_of(const Pool& pool, int32_t threads);
  void end_copies();
  void need_tries(int32_t backups) const;
  void carve(Arena& arena);
  uint64_t fingerprint() const;
  size_t row_of(int32_t i) const { return static_cast<size_t>(i) * static_cast<size_t>(dim_); }
  size_t plan_of(int32_t i) const { return row_of(i) * static_cast<size_t>(length_); }
  int32_t kept_of(int32_t copy, int32_t d) const { return copy * (set_.block + 1) + d; }
  int32_t ways() const { return n_ * worlds_; }
  int32_t branches() const { return ways() * set_.tries; }
  Remembered* memory_of(int32_t backup);  // null: it has none
  void make_memory(Remembered* memory, int32_t dim);
  // Of worlds for which named(env) is true: what backups remember of its decisions up to this one.
  template <class F>
  void notice(const Pool& pool, F&& named);
  template <class F>
  void notice_by(int32_t policy, const Pool& pool, F&& named);
  // Backup b sees what the copies that go show, and its action is none of theirs.
  void look_on(int32_t b, const CopiesTried& copies);
  void look_on_first(int32_t decides);
  void keep_way(int32_t i, int32_t d);
  void ask_foresight(const CopiesTried& copies, int32_t rows, bool with_noise);
  void gather(const Remembered& m, const CopiesTried& copies, int32_t rows);
  void scatter(const Remembered& m, const CopiesTried& copies, int32_t rows);
  void forget_plans();

  // The decision of its plan that a world is at; -1: the plan is none of its episode as it is.
  int32_t place(const Pool& pool, int32_t env) const;
  bool follows(const Pool& pool, int32_t env, const float* proposed, bool foreseen);
  void predict(const Pool& pool, const uint8_t* mask, const float* proposed, Foresight* foresight,
               bool unneeded);
  void give(const Pool& pool, int32_t env, const float* proposed, bool asked, bool foreseen, float* action);
  // What a foresight had for decision `at` of a block.
  float* foreseen_own(int32_t env, int32_t at) const {
    return foreseen_own_ + row_of(env * set_.block + std::min(at, set_.block - 1));
  }
  void count(const ShieldRow& row);
  void order_backups(Foresight* foresight);
  void inquire(const Pool& pool, const float* proposed, bool unneeded);
  // A host's plan in a copy, with backup order_[b] behind it: the decisions that it went on for, in way_.
  int32_t run_plan(const Pool& pool, int32_t env, const float* actions, int32_t count, int32_t b);
  int32_t plan_end(int32_t count) const;  // decisions of it and its backup that are looked at
  void adopt_plan(const Pool& pool, int32_t env, int32_t decisions);
  const double* bound_of(const Pool& pool, int32_t env);  // what its episode's costs may come to, [costs]
  void run_first(const Pool& pool, const float* proposed);
  void foresee(int32_t d);
  // Of the copies of its first way that went into decision d, which the proposer made or the backup.
  void read_fates(Inquiry* q, int32_t d, bool proposed);
  int32_t first_of(int32_t env) const { return env * worlds_; }  // of its copies
  int32_t branch_first(int32_t env, int32_t x) const { return (env * set_.tries + x) * worlds_; }
  bool clean(int32_t i) const;  // of a branch, by the first of its copies
  Branch branch_of(const Inquiry& q, int32_t number) const;
  void try_branches(const Pool& pool);
  void start_branch(int32_t env, int32_t i, const Branch& b);
  void run_branches(bool stop_at_cost);
  void add_noise(int32_t i);
  template <class F>
  void each_going(F&& f) {  // f(i) for the first ways that go
    for (int32_t i = 0; i < first_.count(); ++i)
      if (first_.going(i)) f(i);
  }
  void choose(Inquiry* q, int32_t i);
  void take(Inquiry* q, int32_t i);
  bool worse(int32_t a, int32_t b) const;
  void try_least(const Pool& pool, bool unneeded);
  void adopt(const Pool& pool, const Inquiry& q);
  // Of the copies that go, the actions of backup[i] into their rows.
  void back_up(CopiesTried* copies, const int32_t* backup);
  void ask_backup(int32_t backup, const CopiesTried& copies, int32_t rows);
  float* states_of(const Remembered& memory, const CopiesTried& copies) const {
    return &copies == &first_ ? memory.way : memory.branch;
  }
  // The actions of copies that go, `each` of them for a world, to the guards' side.
  void keep_guards(CopiesTried* copies, int32_t each) const;

  HostHooks hooks_;
  Options options_;
  ShieldOptions set_{};
  MeanPolicy* policies_[kMostPolicies] = {};
  int32_t num_policies_ = 0, num_own_ = 0;  // backups that the shield has whoever proposes
  Remembered memory_[kMostPolicies], foreseen_memory_;
  // Of this call: who foresees, and the backups in the order in which they are tried.
  Foresight* foresight_ = nullptr;
  int32_t order_[kMostPolicies + 3] = {}, num_order_ = 0;
  int32_t n_ = 0, dim_ = 0, obs_ = 0, costs_ = 0, steps_ = 1, stride_ = 1, length_ = 0;
  double budget_[kMaxTaskCosts] = {};
  uint64_t options_hash_ = 0, layout_ = 0;  // of the pool
  Guards guards_;
  ShieldCounts counts_;
  int32_t worlds_ = 1;         // copies of a world in which each way is tried
  CopiesTried first_, tried_;  // [n][worlds] the first ways; [n][tries][worlds] branches
  Pool* kept_ = nullptr;       // [n][worlds][block + 1] states before each decision of a first way

  Arena arena_;
  float *zero_ = nullptr, *hold_ = nullptr;  // [dim]
  float* aim_ = nullptr;                     // [n][dim] what is proposed, projected
  Plan* plans_ = nullptr;                    // [n]
  ShieldRow* rows_ = nullptr;                // [n]
  Moment* seen_ = nullptr;                   // [n] of the last decision
  Inquiry* inquiries_ = nullptr;             // [n], of which num_asked_, by rising env
  int32_t num_asked_ = 0;
  float *own_ = nullptr, *refused_ = nullptr;  // [n][dim] as proposed
  float* foreseen_own_ = nullptr;              // [n][block][dim] likewise, of the last inquiry
  uint8_t* moved_ = nullptr;                   // [n]
  uint8_t* went_ = nullptr;                    // [n worlds] of the first ways, before the last step
  float *plan_ = nullptr, *way_ = nullptr, *tail_ = nullptr;  // [n][length][dim]
  double* bound_ = nullptr;                                   // [n][costs]
  // [n] of branches, of copies that draw for themselves, and of what a foresight draws
  Stream *noise_ = nullptr, *drawn_ = nullptr, *foreseen_ = nullptr;
  float* offset_ = nullptr;  // [n][dim] likewise
  // Branches, [n tries]: their decisions [length][dim], backups, first decisions, numbers, how many decisions
  // they went on for, noise of the first one.
  float* branch_ = nullptr;
  int32_t *backup_ = nullptr, *from_ = nullptr, *number_ = nullptr, *lived_ = nullptr;
  double* width_ = nullptr;
  int32_t* list_ = nullptr;                          // [n tries]
  float *obs_rows_ = nullptr, *act_rows_ = nullptr;  // [n tries][obs], [n tries][dim]
};

}  // namespace rdm
