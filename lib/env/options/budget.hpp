// How much an episode may cost, as something that the agent sees: options that every task has.
//
//   left' = (left - c) / g,   z = left / d        c: cost of column 0, g: budget_discount, d: the limit
//
// left begins at d, in simmer at a share of it that grows. With g < 1 the sum that a discounted budget bounds is
// sum g^t c_t, so d becomes d (1 - g^T) / ((1 - g) T), T the control steps of an episode: what an even cost of d
// comes to. z goes into the observation (budget.left), and a limit that is drawn too (budget.limit, over the upper
// end of its range). After a step that leaves less than nothing
//   show     nothing happens: a learner with multipliers keeps the limit
//   saute    the reward is unsafe_reward, in every step from there on (Sootla et al. 2022, arXiv 2202.06558)
//   simmer   the same, of a budget that grows (Sootla et al. 2022, arXiv 2206.02675)
//   end      the reward is unsafe_reward, and the episode ends (Sun et al. 2021, arXiv 2107.04200)
#pragma once
#include "base/option_rows.hpp"
#include "env/task.hpp"

namespace rdm {

enum class BudgetKind : int32_t { kNone, kShow, kSaute, kSimmer, kEnd };

struct BudgetOptions {
  BudgetKind kind;
  double limit;       // < 0: not given
  OptionRange range;  // < 0: none
  double discount, unsafe_reward, simmer_start;
  int32_t simmer_steps;
};
struct Budget : BudgetOptions {
  bool any() const { return kind != BudgetKind::kNone; }
  bool ranged() const { return range.high >= 0; }
};

// The rows, static.
const OptionSpec* budget_options(int32_t* count);

// With the limit found: given, or the task's. Error(kArgument) where there is none.
Budget budget_from(const Options& options, const TaskInfo& task);

// Joins the rows that were given another value than their default; all at their defaults: the hash as it was.
uint64_t hash_budget(const Options& options, uint64_t hash);

}  // namespace rdm
