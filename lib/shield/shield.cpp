#include "shield/shield.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "base/fpmode.hpp"
#include "base/option_rows.hpp"
#include "base/text.hpp"
#include "env/copies.hpp"

namespace rdm {
namespace {

constexpr int32_t kMostBlock = 256, kMostLook = 100000, kMostTries = 64, kMostRounds = 64, kMostCopies = 64;
constexpr int64_t kMostNumbers = int64_t{1} << 28;  // of an array

constexpr auto kRows = option_rows<ShieldOptions>(
    row<&ShieldOptions::block>(basic(integer_option("block", 16, 1, kMostBlock,
                                                    "decisions of a rollout that are checked together, where "
                                                    "the policy's next actions can be predicted"))),
    row<&ShieldOptions::look>(basic(integer_option(
        "look", 0, 0, kMostLook,
        "backup decisions to simulate; 0: to the episode's end (any other number proves nothing)"))),
    row<&ShieldOptions::tries>(integer_option(
        "tries", 8, 1, kMostTries, "number of alternatives that are simulated together for a world")),
    row<&ShieldOptions::rounds>(integer_option(
        "rounds", 8, 1, kMostRounds, "largest number of times that `tries` alternatives are simulated")),
    row<&ShieldOptions::copies>(basic(integer_option(
        "copies", 0, 0, kMostCopies,
        "0: one exact copy; K: an action must be clean in K copies with drawn dynamics (uncertain worlds)"))),
    row<&ShieldOptions::noise>(basic(number_option(
        "noise", 0.2, 0, 2, "standard deviation of the noise on the first action of an alternative"))),
    row<&ShieldOptions::best, false, true>(
        basic(text_option("choose", "latest", "latest|best",
                          "clean alternative to take: latest: the one that changes least; best: the one with "
                          "the highest return"))),
    row<&ShieldOptions::zero>(flag_option("zero", true, "use the constant action 0 as a backup")),
    row<&ShieldOptions::hold>(flag_option("hold", true, "use the constant hold action as a backup")),
    row<&ShieldOptions::least, false, true>(basic(text_option(
        "unproven", "error", "error|least",
        "if no clean way is found: error: the call fails; least: run what exceeds the budgets least"))),
    row<&ShieldOptions::project>(flag_option(
        "project", true, "first move the proposed action to the nearest one that keeps the task's guards")),
    row<&ShieldOptions::predict>(basic(
        flag_option("predict", true, "try actions in copies of the world; false: keep the guards only"))));

bool same(const float* a, const float* b, int32_t count) {
  return std::memcmp(a, b, static_cast<size_t>(count) * sizeof *a) == 0;
}

}  // namespace

const OptionSpec* shield_options(int32_t* count) {
  *count = static_cast<int32_t>(kRows.size());
  return kRows.specs;
}

void Shield::read_options(const ShieldConfig& c) {
  options_.add_table(kRows.specs, static_cast<int32_t>(kRows.size()));
  const TaskInfo& task = task_at(c.pool->task_index());
  for (int32_t i = 0; i < task.num_defaults; ++i)
    if (const char* key = shield_key(task.defaults[i].key)) {
      if (!options_.knows(key))
        fail(Code::kNotFound, "task %s: its default for option \"%s\" is wrong: shields have no such option",
             task.name, key);
      options_.set_default(key, task.defaults[i].value);
    }
  options_.set_all(c.options, c.num_options, c.settings, "shield");
  set_ = kRows.read(options_);
  if (set_.copies == 0) return;
  worlds_ = set_.copies;
  set_.block = 1;  // the copies draw different dynamics, so the actions foreseen in one do not fit another
}

Shield::Shield(const ShieldConfig& c) : hooks_(c.hooks), steps_(c.steps) {
  const HostScope scope(hooks_);
  read_options(c);
  const Pool& pool = *c.pool;
  n_ = pool.config().num_envs;
  dim_ = pool.task().action_dim();
  obs_ = pool.obs_dim();
  costs_ = pool.cost_dim();
  options_hash_ = pool.options_hash();
  layout_ = layout_hash(pool.task());
  num_own_ = set_.zero + set_.hold;
  read_budgets(c.budgets);
  guards_ = Guards(n_, dim_);
  if (set_.project) declare_guards(pool);
  stride_ = steps_ * pool.repeat();
  if (set_.predict) make_copies_of(pool, c.num_threads);
  try {
    Arena measure;
    carve(measure);
    arena_ = Arena(hooks_, measure.used());
    carve(arena_);
  } catch (...) {
    end_copies();
    throw;
  }
  pool.task().hold_action(hold_);
  for (int32_t i = 0; i < n_; ++i) {
    noise_[i] = Stream(c.seed, static_cast<uint32_t>(i), Purpose::kShield);
    drawn_[i] = Stream(c.seed, static_cast<uint32_t>(i), Purpose::kShieldDraw);
  }
  std::fill_n(rows_, n_, ShieldRow{});
  std::fill_n(seen_, n_, Moment{});
}

void Shield::read_budgets(const double* budgets) {
  bool any = false;
  for (int32_t k = 0; k < costs_; ++k) {
    budget_[k] = budgets ? budgets[k] : k == 0 ? 0 : -1;
    if (std::isnan(budget_[k])) fail(Code::kArgument, "budgets: entry %d is not a number", k);
    any |= budget_[k] >= 0;
  }
  if (!any) fail(Code::kArgument, "shield: no cost has a budget");
}

// A guard keeps a cost at 0, so only guards of costs with a budget of 0 are added.
void Shield::declare_guards(const Pool& pool) {
  Vector<float> normal(sz(dim_));
  Guard g;
  for (int32_t i = 0; pool.guard_at(i, &g, normal.data()); ++i)
    if (budget_[g.column] == 0) guards_.add(g.column, normal.data(), g.bound);
}

void Shield::make_copies_of(const Pool& pool, int32_t threads) {
  need_tries(num_own_);
  const int32_t whole = (pool.task().max_steps() + stride_ - 1) / stride_;
  length_ = set_.look > 0 ? std::min(whole, set_.block + set_.look + 1) : whole;
  const int64_t ways = int64_t{n_} * worlds_, branches = ways * set_.tries;
  if (branches * length_ * dim_ > kMostNumbers || ways * (set_.block + 1) > 65536 || branches > 65536)
    fail(Code::kRange,
         "shield: %d worlds with blocks of %d and %d tries of %d decisions need too much memory", n_,
         set_.block, set_.tries, length_);
  try {
    first_.make(pool, n_ * worlds_, threads, hooks_);
    tried_.make(pool, n_ * set_.tries * worlds_, threads, hooks_);
    kept_ = make_copies(pool, n_ * worlds_ * (set_.block + 1), threads, hooks_);
  } catch (...) {
    end_copies();
    throw;
  }
}

void Shield::end_copies() {
  first_.end();
  tried_.end();
  Pool::destroy(kept_);
}

void Shield::need_tries(int32_t backups) const {
  if (backups + 1 > set_.tries)
    fail(Code::kRange, "tries: %d is less than the number of backups, %d with the proposing policy",
         set_.tries, backups + 1);
}

void Shield::add_policy(MeanPolicy* policy) {
  if (!set_.predict)
    fail(Code::kArgument, "policy: with predict=false no action is tried, so a backup is not used");
  if (num_policies_ == kMostPolicies)
    fail(Code::kRange, "shield: it already has %d policies, the most that are allowed", kMostPolicies);
  need_tries(num_own_ + 1);
  make_memory(&memory_[num_policies_], policy->state_dim());
  policies_[num_policies_++] = policy;
  ++num_own_;
}

void Shield::make_memory(Remembered* memory, int32_t dim) {
  const HostScope scope(hooks_);
  memory->make(hooks_, dim, n_, ways(), ways() * (set_.block + 1), branches());
}

void Shield::expect(int32_t state_dim) {
  if (set_.predict && state_dim != foreseen_memory_.dim()) make_memory(&foreseen_memory_, state_dim);
}

void Shield::add_guard(const float* normal, float bound) {
  const FpMode fp;
  const HostScope scope(hooks_);
  guards_.add(-1, normal, bound);
  forget_plans();
}

void Shield::set_guard(int32_t env, int32_t i, const float* normal, float bound) {
  const FpMode fp;
  if (guards_.set(env, i, normal, bound)) plans_[env].length = 0;
}

Shield::~Shield() {
  end_copies();
}

Shield* Shield::create(const ShieldConfig& config) {
  return host_new<Shield>(config.hooks, config);
}

void Shield::destroy(Shield* s) {
  if (!s) return;
  const HostHooks hooks = s->hooks_;
  const HostScope scope(hooks);
  host_delete(hooks, s);
}

void Shield::carve(Arena& arena) {
  const size_t n = sz(n_), dim = sz(dim_), length = sz(length_), branches = n * sz(set_.tries) * sz(worlds_);
  zero_ = arena.make<float>(dim);
  hold_ = arena.make<float>(dim);
  aim_ = arena.make<float>(n * dim);
  plans_ = arena.make<Plan>(n);
  rows_ = arena.make<ShieldRow>(n);
  seen_ = arena.make<Moment>(n);
  own_ = arena.make<float>(n * dim);
  refused_ = arena.make<float>(n * dim);
  moved_ = arena.make<uint8_t>(n);
  noise_ = arena.make<Stream>(n);
  drawn_ = arena.make<Stream>(n);
  if (!set_.predict) return;
  first_.carve(arena);
  tried_.carve(arena);
  inquiries_ = arena.make<Inquiry>(n);
  foreseen_own_ = arena.make<float>(n * sz(set_.block) * dim);
  went_ = arena.make<uint8_t>(n * sz(worlds_));
  plan_ = arena.make<float>(n * length * dim);
  way_ = arena.make<float>(n * length * dim);
  tail_ = arena.make<float>(n * length * dim);
  branch_ = arena.make<float>(branches * length * dim);
  bound_ = arena.make<double>(n * sz(costs_));
  foreseen_ = arena.make<Stream>(n);
  offset_ = arena.make<float>(n * dim);
  obs_rows_ = arena.make<float>(branches * sz(obs_));
  act_rows_ = arena.make<float>(branches * dim);
  list_ = arena.make<int32_t>(branches);
  backup_ = arena.make<int32_t>(branches);
  number_ = arena.make<int32_t>(branches);
  lived_ = arena.make<int32_t>(branches);
  from_ = arena.make<int32_t>(branches);
  width_ = arena.make<double>(branches);
}

void Shield::forget(const uint8_t* mask) {
  for (int32_t i = 0; i < n_; ++i) {
    if (mask && !mask[i]) continue;
    plans_[i].length = 0;
    seen_[i] = {};
  }
}

void Shield::forget_plans() {
  for (int32_t i = 0; i < n_; ++i) plans_[i].length = 0;
}

void Shield::skip(int32_t env) {
  rows_[env] = {};
  moved_[env] = 0;
}

void Shield::forget_blocks() {
  for (int32_t i = 0; i < n_; ++i) {
    plans_[i].block = 0;
    plans_[i].refused = -1;
  }
}

int32_t Shield::place(const Pool& pool, int32_t env) const {
  const Plan& p = plans_[env];
  if (p.length == 0 || (!p.adopt && p.course != pool.course(env))) return -1;
  if (p.adopt && seen_[env].step >= 0 && passed_since(seen_[env], pool, env) == Passed::kEpisode) return -1;
  const int32_t steps = pool.episode_step(env) - p.begin;
  return steps >= 0 && steps % stride_ == 0 && steps / stride_ < p.length ? steps / stride_ : -1;
}

const float* Shield::plan(const Pool& pool, int32_t env, int32_t* count) const {
  const int32_t at = place(pool, env);
  *count = at < 0 ? 0 : plans_[env].length - at;
  return plan_ + plan_of(env) + row_of(std::max(at, 0));
}

bool Shield::follows(const Pool& pool, int32_t env, const float* proposed, bool foreseen) {
  Plan& p = plans_[env];
  const int32_t at = place(pool, env);
  if (at < 0) {
    p.length = 0;
    return false;
  }
  p.course = pool.course(env);
  p.adopt = 0;
  if (set_.copies > 0) return false;
  return (foreseen && at < p.block) || same(aim_ + row_of(env), plan_ + plan_of(env) + row_of(at), dim_) ||
         (at == p.refused && same(proposed + row_of(env), refused_ + row_of(env), dim_));
}

void Shield::check_pool(const Pool& pool) const {
  if (set_.predict)
    first_.pool().need_same(pool, "pool", "the shield");
  else if (pool.options_hash() != options_hash_ || pool.task().action_dim() != dim_)
    fail(Code::kArgument, "pool: its task or options are not those that the shield was made for");
  if (pool.config().num_envs != n_)
    fail(Code::kArgument, "pool: it has %d worlds, but the shield is for %d", pool.config().num_envs, n_);
}

template <class F>
void Shield::notice_by(int32_t policy, const Pool& pool, F&& named) {
  const Remembered& m = memory_[policy];
  int32_t rows = 0;
  for (int32_t env = 0; env < n_; ++env) {
    if (!named(env)) continue;
    const Passed passed = passed_since(seen_[env], pool, env);
    if (passed == Passed::kEpisode) m.clear(m.before, env);
    if (passed == Passed::kSteps) m.copy(m.before, env, m.after, env);
    m.copy(m.after, env, m.before, env);  // where the network overflows it stays so
    m.copy(m.asked, rows, m.before, env);
    std::copy_n(pool.buffers().obs + sz(env) * sz(obs_), obs_, obs_rows_ + sz(rows) * sz(obs_));
    list_[rows++] = env;
  }
  policies_[policy]->act(obs_rows_, rows, m.asked, act_rows_);
  for (int32_t i = 0; i < rows; ++i) m.take(m.after, list_[i], i);
}

// It may be called again in the same decision, as after an error: the states before it stay then.
template <class F>
void Shield::notice(const Pool& pool, F&& named) {
  for (int32_t p = 0; p < num_policies_; ++p)
    if (memory_[p]) notice_by(p, pool, named);
  for (int32_t env = 0; env < n_; ++env) {
    if (!named(env)) continue;
    if (plans_[env].adopt && place(pool, env) < 0) plans_[env].length = 0;
    seen_[env] = moment_of(pool, env);
  }
}

void Shield::act(const Pool& pool, const uint8_t* mask, const float* proposed, Foresight* foresight,
                 float* action, bool unneeded) {
  const FpMode fp;
  check_pool(pool);
  const auto named = [&](int32_t env) { return !mask || mask[env]; };
  for (int32_t env = 0; env < n_; ++env) {
    if (!named(env)) continue;
    if (!pool.running(env)) fail(Code::kState, "act: no episode runs in world %d; reset it first", env);
    const float* row = proposed + row_of(env);
    for (int32_t j = 0; j < dim_; ++j)
      if (!std::isfinite(row[j])) fail(Code::kArgument, "proposed: row %d, entry %d is not finite", env, j);
  }
  if (!set_.predict && guards_.count() == 0)
    fail(Code::kState,
         "shield: with predict=false it has nothing to keep: task %s declares no guards for these "
         "options and budgets, and none was added",
         task_at(pool.task_index()).name);
  for (int32_t env = 0; env < n_; ++env)
    if (named(env)) guards_.project(env, proposed + row_of(env), aim_ + row_of(env));
  num_asked_ = 0;
  if (set_.predict) notice(pool, named);
  if (set_.predict) predict(pool, mask, proposed, foresight, unneeded);
  for (int32_t asked = 0, env = 0; env < n_; ++env) {
    if (!named(env)) continue;
    const bool now = asked < num_asked_ && inquiries_[asked].env == env;
    asked += now;
    give(pool, env, proposed, now, foresight != nullptr, action);
  }
}

Remembered* Shield::memory_of(int32_t backup) {
  Remembered* m = backup < num_policies_             ? &memory_[backup]
                  : backup == num_own_ && foresight_ ? &foreseen_memory_
                                                     : nullptr;
  return m && *m ? m : nullptr;
}

void Shield::predict(const Pool& pool, const uint8_t* mask, const float* proposed, Foresight* foresight,
                     bool unneeded) {
  order_backups(foresight);
  if (num_order_ == 0)
    fail(Code::kState, "shield: it has no backup; give a policy, or set zero=true or hold=true");
  for (int32_t env = 0; env < n_; ++env)
    if ((!mask || mask[env]) && !follows(pool, env, proposed, foresight != nullptr))
      inquiries_[num_asked_++].env = env;
  if (num_asked_ > 0) inquire(pool, proposed, unneeded);
}

void Shield::order_backups(Foresight* foresight) {
  foresight_ = foresight;
  num_order_ = 0;
  if (foresight) order_[num_order_++] = num_own_;
  for (int32_t b = 0; b < num_own_; ++b) order_[num_order_++] = b;
}

void Shield::give(const Pool& pool, int32_t env, const float* proposed, bool asked, bool foreseen,
                  float* action) {
  ShieldRow r;
  const float *own = proposed + row_of(env), *done = aim_ + row_of(env);
  if (set_.predict) {
    const Plan& p = plans_[env];
    const int32_t at = place(pool, env);
    // where nothing is clean, and nothing has to be, there is no plan
    if (at >= 0) done = plan_ + plan_of(env) + row_of(at);
    const bool refused = at < 0 || at == p.refused;
    // the foreseen action runs, not the proposed one: if the normaliser has changed since, the two differ
    if (foreseen && !asked && at < p.block) own = refused ? refused_ + row_of(env) : foreseen_own(env, at);
    if (at < 0 || p.dirty)
      r.kind = ShieldKind::kUnproven;
    else if (refused)
      r.kind = p.kept ? ShieldKind::kPlan : ShieldKind::kChanged;
    if (refused) {
      r.column = p.column;
      r.ahead = p.cost_in - pool.episode_step(env);
      r.backup = p.backup;
    }
  }
  if (r.kind == ShieldKind::kOwn)
    if (const int32_t row = guards_.broken(env, own); row >= 0) {
      r.kind = ShieldKind::kProjected;
      r.column = guards_.column(row);
    }
  count(r);
  rows_[env] = r;
  moved_[env] = own != proposed + row_of(env) && !same(own, proposed + row_of(env), dim_);
  std::copy_n(own, dim_, own_ + row_of(env));
  std::copy_n(done, dim_, action + row_of(env));
}

void Shield::count(const ShieldRow& row) {
  ++counts_.decisions;
  counts_.changed += row.kind == ShieldKind::kChanged;
  counts_.planned += row.kind == ShieldKind::kPlan;
  counts_.unproven += row.kind == ShieldKind::kUnproven;
  counts_.projected += row.kind == ShieldKind::kProjected;
}

// ---- plans of a host

void Shield::set_plan(const Pool& pool, int32_t env, const float* actions, int32_t count) {
  const FpMode fp;
  check_pool(pool);
  if (!set_.predict)
    fail(Code::kArgument, "plan: with predict=false no action is tried, so there are no plans");
  if (set_.copies > 0)
    fail(Code::kUnsupported, "plan: with copies=%d no plan can be proven, so none can be set", set_.copies);
  if (!pool.running(env)) fail(Code::kState, "plan: no episode runs in world %d; reset it first", env);
  if (count < 1 || count > length_)
    fail(Code::kRange, "plan: the number of decisions, %d, is outside [1, %d]", count, length_);
  for (size_t j = 0; j < row_of(count); ++j)
    if (!std::isfinite(actions[j])) fail(Code::kArgument, "plan: entry %zu is not finite", j);
  notice(pool, [&](int32_t i) { return i == env; });
  order_backups(nullptr);
  // It is tried with each backup behind its end, until one is clean.
  for (int32_t b = 0;; ++b) {
    const int32_t ran = run_plan(pool, env, actions, count, b);
    const int32_t i = first_of(env), ahead = first_.ended_in(i) - pool.episode_step(env),
                  column = first_.column(i);
    switch (first_.fate(i)) {
      case CopiesTried::Fate::kGoing:  // to the end of what is looked at, or there is nothing behind it
        if (ran == plan_end(count)) return adopt_plan(pool, env, ran);
        fail(Code::kState, "world %d: the plan ends before the episode, and there is no backup", env);
      case CopiesTried::Fate::kOver:
        return adopt_plan(pool, env, ran);
      case CopiesTried::Fate::kCost:
      case CopiesTried::Fate::kLost:
        if (ran > count && b + 1 < num_order_) break;
        if (column < 0)
          fail(Code::kState, "world %d: under the plan it diverges in %d control steps", env, ahead);
        fail(Code::kState,
             "world %d: under the plan cost column %d, %s, exceeds its budget in %d control steps", env,
             column, Quoted(task_at(pool.task_index()).costs[column].name).text, ahead);
    }
  }
}

int32_t Shield::plan_end(int32_t count) const {
  return set_.look > 0 ? std::min(count + set_.look, length_) : length_;
}

int32_t Shield::run_plan(const Pool& pool, int32_t env, const float* actions, int32_t count, int32_t b) {
  const int32_t i = first_of(env), end = plan_end(count);
  first_.stop_all();
  first_.start(i, pool, env, bound_of(pool, env));
  Remembered* const m = b < num_order_ ? memory_of(order_[b]) : nullptr;
  if (m) m->copy(m->way, i, m->before, env);
  int32_t d = 0;
  for (; first_.going(i) && d < end && (d < count || b < num_order_); ++d) {
    if (d < count) {
      guards_.project(env, actions + row_of(d), first_.action(i));
      if (m) look_on(order_[b], first_);
    } else {
      backup_[i] = order_[b];
      back_up(&first_, backup_);
      keep_guards(&first_, worlds_);
    }
    std::copy_n(first_.action(i), dim_, way_ + plan_of(env) + row_of(d));
    counts_.copied += first_.step(steps_, true);
  }
  return d;
}

void Shield::adopt_plan(const Pool& pool, int32_t env, int32_t decisions) {
  Plan& p = plans_[env];
  p = {};
  p.course = pool.course(env);
  p.begin = pool.episode_step(env);
  p.length = decisions;
  p.refused = p.backup = p.column = -1;
  std::copy_n(way_ + plan_of(env), row_of(decisions), plan_ + plan_of(env));
}

}  // namespace rdm
