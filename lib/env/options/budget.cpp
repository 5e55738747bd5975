#include "env/options/budget.hpp"

#include <cstring>

#include "base/error.hpp"
#include "base/hash.hpp"

namespace rdm {
namespace {

constexpr double kMostLimit = 1e12;
constexpr double kLeastDrawn = 1e-6;  // of a limit that z is divided by

constexpr auto kBudgetRows = option_rows<BudgetOptions>(
    row<&BudgetOptions::kind, BudgetKind::kNone, BudgetKind::kShow, BudgetKind::kSaute, BudgetKind::kSimmer,
        BudgetKind::kEnd>(
        basic(text_option("budget", "none", "none|show|saute|simmer|end",
                          "what is left of the limit is observed; once it is spent: saute, simmer: "
                          "unsafe_reward; end: the episode ends"))),
    row<&BudgetOptions::limit>(
        basic(number_option("limit", -1, -1, kMostLimit,
                            "limit of the budget on column 0; -1: drawn from limit_range, else the task's"))),
    row<&BudgetOptions::range>(basic(drawable(
        number_option("limit_range", -1, -1, kMostLimit,
                      "the limit is drawn from A..B at each reset and observed too; -1: not drawn")))),
    row<&BudgetOptions::discount>(
        number_option("budget_discount", 1, 0.5, 1,
                      "discount factor of the budget per control step; 1: the plain sum of costs")),
    row<&BudgetOptions::unsafe_reward>(number_option(
        "unsafe_reward", -1, -1e6, 1e6, "reward of a control step after which the budget is overspent")),
    row<&BudgetOptions::simmer_start>(
        number_option("simmer_start", 0.2, 0, 1, "share of the limit that budget=simmer begins with")),
    row<&BudgetOptions::simmer_steps>(integer_option(
        "simmer_steps", 50000, 1, 1 << 30, "control steps of a world in which that share grows to 1")));

}  // namespace

const OptionSpec* budget_options(int32_t* count) {
  *count = static_cast<int32_t>(kBudgetRows.size());
  return kBudgetRows.specs;
}

Budget budget_from(const Options& options, const TaskInfo& task) {
  Budget b;
  static_cast<BudgetOptions&>(b) = kBudgetRows.read(options);
  if (b.ranged() && b.kind == BudgetKind::kNone) b.kind = BudgetKind::kShow;
  if (b.ranged() && b.range.low < kLeastDrawn)
    fail(Code::kRange, "%s option limit_range: its lower end, %g, is not above 0", task.name, b.range.low);
  if (!b.any()) {
    if (b.limit >= 0)
      fail(Code::kArgument, "%s option limit: it is that of a budget; set budget=show, or another one",
           task.name);
    return b;
  }
  if (b.limit < 0 && !b.ranged()) b.limit = task.costs[0].limit;
  if (b.limit < 0 && !b.ranged())
    fail(Code::kArgument, "%s option budget: the task has no limit on column 0; give option limit",
         task.name);
  return b;
}

uint64_t hash_budget(const Options& options, uint64_t hash) {
  for (int32_t i = 0; i < options.count(); ++i) {
    const OptionSpec& spec = options.spec(i);
    if (&spec < kBudgetRows.specs || &spec >= kBudgetRows.specs + kBudgetRows.size()) continue;
    const bool text = spec.kind == OptionKind::kText;
    const OptionRange value = text ? OptionRange{} : options.range(i);
    const bool changed = text ? std::strcmp(options.text(spec.key), spec.text) != 0
                              : value.low != spec.number || value.drawn();
    if (!changed) continue;
    hash = hash_bytes(spec.key, std::strlen(spec.key) + 1, hash);
    if (text) hash = hash_bytes(options.text(spec.key), std::strlen(options.text(spec.key)) + 1, hash);
    hash = hash_bytes(&value.low, sizeof value.low, hash);
    hash = hash_bytes(&value.high, sizeof value.high, hash);
  }
  return hash;
}

}  // namespace rdm
