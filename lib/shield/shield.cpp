#include "shield/shield.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "base/fpmode.hpp"
#include "base/hash.hpp"
#include "base/option_rows.hpp"
#include "base/text.hpp"
#include "env/copies.hpp"

namespace rdm {
namespace {

constexpr char kMagic[8] = {'R', 'D', 'M', 'S', 'H', 'L', 'D', '1'};
constexpr uint32_t kVersion = 1;
constexpr int32_t kMostBlock = 256, kMostLook = 100000, kMostTries = 64, kMostRounds = 64, kMostCopies = 64;
constexpr int64_t kMostNumbers = int64_t{1} << 28;  // of an array
// The last branches: noise about the first decision that is wider each time.
constexpr int32_t kWide = 4;
constexpr double kWider = 0.75;

constexpr auto kRows = option_rows<ShieldOptions>(
    row<&ShieldOptions::block>(basic(integer_option(
        "block", 16, 1, kMostBlock, "decisions that are asked for at once, where they can be foreseen"))),
    row<&ShieldOptions::look>(basic(integer_option("look", 0, 0, kMostLook,
                                                   "decisions of the backup that are looked at; 0: to the "
                                                   "episode's end, the only ones that prove anything"))),
    row<&ShieldOptions::tries>(
        integer_option("tries", 8, 1, kMostTries, "branches that are tried together for a world")),
    row<&ShieldOptions::rounds>(
        integer_option("rounds", 8, 1, kMostRounds, "times that so many branches are tried, at most")),
    row<&ShieldOptions::copies>(basic(integer_option(
        "copies", 0, 0, kMostCopies,
        "of worlds that are not known: copies with dynamics of their own that agree; 0: one exact copy"))),
    row<&ShieldOptions::noise>(
        basic(number_option("noise", 0.2, 0, 2, "deviation of a noisy branch's first action"))),
    row<&ShieldOptions::best, false, true>(basic(
        text_option("choose", "latest", "latest|best",
                    "of clean branches: the first one, which leaves most as it was; or, of all that were "
                    "tried, the one with the highest return"))),
    row<&ShieldOptions::zero>(flag_option("zero", true, "action 0 for ever is a backup")),
    row<&ShieldOptions::hold>(flag_option("hold", true, "the hold action for ever is a backup")),
    row<&ShieldOptions::least, false, true>(
        basic(text_option("unproven", "error", "error|least",
                          "a world in which nothing is clean: an error, or what exceeds budgets least"))),
    row<&ShieldOptions::project>(flag_option(
        "project", true, "what is proposed goes to the nearest action that keeps the task's guards first")),
    row<&ShieldOptions::predict>(
        basic(flag_option("predict", true, "actions are tried in copies; false: guards alone are kept"))));

size_t sz(int32_t n) {
  return static_cast<size_t>(n);
}

bool same(const float* a, const float* b, int32_t count) {
  return std::memcmp(a, b, sz(count) * sizeof *a) == 0;
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
        fail(Code::kNotFound, "task %s: shields have no option \"%s\"", task.name, key);
      options_.set_default(key, task.defaults[i].value);
    }
  options_.set_all(c.options, c.num_options, c.settings, "shield");
  set_ = kRows.read(options_);
  if (set_.copies == 0) return;
  worlds_ = set_.copies;
  set_.block = 1;  // what is foreseen in one of them does not come in another
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

// What may be spent is not to be kept at 0.
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
    fail(Code::kRange, "shield: %d worlds with blocks of %d, and %d tries of %d decisions, are too many", n_,
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
    fail(Code::kRange, "tries: %d are fewer than the backups, %d with who proposes", set_.tries, backups + 1);
}

void Shield::add_policy(MeanPolicy* policy) {
  if (!set_.predict)
    fail(Code::kArgument, "policy: with predict=false nothing is tried, so there is no backup");
  if (num_policies_ == kMostPolicies) fail(Code::kRange, "shield: it has %d policies already", kMostPolicies);
  need_tries(num_own_ + 1);
  policies_[num_policies_++] = policy;
  ++num_own_;
}

void Shield::add_guard(const float* normal, float bound) {
  const FpMode fp;
  const HostScope scope(hooks_);
  guards_.add(-1, normal, bound);
  forget(nullptr);
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
  for (int32_t i = 0; i < n_; ++i)
    if (!mask || mask[i]) plans_[i].length = 0;
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
    fail(Code::kArgument, "pool: it has %d worlds, the shield is for %d", pool.config().num_envs, n_);
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
  if (set_.predict) predict(pool, mask, proposed, foresight, unneeded);
  for (int32_t asked = 0, env = 0; env < n_; ++env) {
    if (!named(env)) continue;
    const bool now = asked < num_asked_ && inquiries_[asked].env == env;
    asked += now;
    give(pool, env, proposed, now, foresight != nullptr, action);
  }
}

void Shield::predict(const Pool& pool, const uint8_t* mask, const float* proposed, Foresight* foresight,
                     bool unneeded) {
  order_backups(foresight);
  if (num_order_ == 0) fail(Code::kState, "shield: it has no backup: a policy, zero=true or hold=true");
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
    // what was foreseen stands for what is proposed, which statistics that have moved since make another
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

// ---- an inquiry: all worlds that ask, together

void Shield::inquire(const Pool& pool, const float* proposed, bool unneeded) {
  counts_.inquiries += num_asked_;
  run_first(pool, proposed);
  try_branches(pool);
  try_least(pool, unneeded);
  for (int32_t x = 0; x < num_asked_; ++x) adopt(pool, inquiries_[x]);
}

const double* Shield::bound_of(const Pool& pool, int32_t env) {
  double* bound = bound_ + sz(env) * sz(costs_);
  for (int32_t k = 0; k < costs_; ++k)
    bound[k] = budget_[k] < 0 ? -1 : std::max(budget_[k], pool.spent(env, k));
  return bound;
}

void Shield::run_first(const Pool& pool, const float* proposed) {
  first_.stop_all();
  std::fill_n(backup_, first_.count(), order_[0]);
  for (int32_t x = 0; x < num_asked_; ++x) {
    Inquiry& q = inquiries_[x];
    const int32_t env = q.env;
    q = {};
    q.env = env;
    q.fail = q.winner = q.column = -1;
    const double* bound = bound_of(pool, env);
    for (int32_t i = first_of(env); i < first_of(env + 1); ++i) {
      first_.start(i, pool, env, bound);
      if (set_.copies > 0) first_.redraw(i, drawn_[env]);
    }
    std::copy_n(proposed + row_of(env), dim_, foreseen_own(env, 0));
    if (foresight_) foresight_->begin(env, &foreseen_[env], offset_ + row_of(env));
  }
  // The way is that of what is proposed, then of the backup; the states before its first decisions are kept.
  const int32_t foreseen = foresight_ ? set_.block : 1;
  for (int32_t d = 0; first_.any_going() && (set_.look == 0 || d < foreseen + set_.look); ++d) {
    for (int32_t i = 0; d <= set_.block && i < first_.count(); ++i)
      if (first_.going(i)) kept_->copy(kept_of(i, d), first_.pool(), i);
    if (d == 0)
      each_going([&](int32_t i) { std::copy_n(aim_ + row_of(i / worlds_), dim_, first_.action(i)); });
    else if (d < foreseen)
      foresee(d);
    else
      back_up(&first_, backup_);
    if (d > 0) keep_guards(&first_, worlds_);
    for (int32_t x = 0; x < num_asked_; ++x)
      if (const int32_t env = inquiries_[x].env; first_.going(first_of(env)))
        std::copy_n(first_.action(first_of(env)), dim_, way_ + plan_of(env) + row_of(d));
    std::copy_n(first_.goers(), first_.count(), went_);
    counts_.copied += first_.step(steps_, true);
    for (int32_t x = 0; x < num_asked_; ++x) read_fates(&inquiries_[x], d, d < foreseen);
  }
}

// Decision d of those who propose; there is one copy of a world then.
void Shield::foresee(int32_t d) {
  int32_t rows = 0;
  each_going([&](int32_t i) {
    std::copy_n(first_.obs(i), obs_, obs_rows_ + sz(rows) * sz(obs_));
    list_[rows++] = i;
  });
  foresight_->act(list_, obs_rows_, rows, foreseen_, offset_, act_rows_);
  for (int32_t i = 0; i < rows; ++i) {
    std::copy_n(act_rows_ + row_of(i), dim_, foreseen_own(list_[i], d));
    std::copy_n(act_rows_ + row_of(i), dim_, first_.action(list_[i]));
  }
}

void Shield::read_fates(Inquiry* q, int32_t d, bool proposed) {
  using Fate = CopiesTried::Fate;
  const int32_t first = first_of(q->env), end = first_of(q->env + 1);
  if (went_[first]) {
    ++q->way;
    q->samples += proposed;
  }
  for (int32_t i = first; i < end && q->fail < 0; ++i) {
    const Fate fate = first_.fate(i);
    if (!went_[i] || (fate != Fate::kCost && fate != Fate::kLost)) continue;
    q->fail = d;
    q->column = first_.column(i);
    q->cost_in = first_.ended_in(i);
    ++counts_.failed;
  }
  for (int32_t i = first; i < end && q->fail >= 0; ++i) first_.stop(i);
}

Shield::Branch Shield::branch_of(const Inquiry& q, int32_t number) const {
  if (number < q.reserve) return {0, num_policies_ + number, 0};
  const int32_t kinds = num_order_ + 1, top = std::min(q.fail, set_.block);
  int32_t back = 0, at = number - q.reserve;
  while (at >= kinds) {
    if (back >= top) {  // all that begin at the first decision were listed
      at -= kinds;
      return at < kWide ? Branch{0, order_[0], 1 + kWider * (at + 1)} : Branch{};
    }
    at -= kinds;
    back = back == 0 ? 1 : 2 * back;
  }
  const int32_t from = std::max(top - back, 0);
  return at < num_order_ ? Branch{from, order_[at], 0} : Branch{from, order_[0], 1};
}

void Shield::try_branches(const Pool& pool) {
  for (int32_t x = 0; x < num_asked_; ++x) {
    Inquiry& q = inquiries_[x];
    // Without a plan to go on with, what never moves is tried first and taken last.
    if (q.fail >= 0 && place(pool, q.env) < 0) q.reserve = num_own_ - num_policies_;
  }
  for (int32_t round = 0; round < set_.rounds; ++round) {
    tried_.stop_all();
    bool any = false;
    for (int32_t x = 0; x < num_asked_; ++x) {
      Inquiry& q = inquiries_[x];
      if (q.fail < 0 || (q.winner >= q.reserve && !set_.best)) continue;
      for (int32_t t = 0; t < set_.tries; ++t) {
        const Branch b = branch_of(q, q.next);
        if (b.backup < 0) break;
        start_branch(q.env, branch_first(q.env, t), b);
        number_[branch_first(q.env, t)] = q.next++;
        any = true;
      }
    }
    if (!any) return;
    run_branches(true);
    for (int32_t x = 0; x < num_asked_; ++x) {
      Inquiry& q = inquiries_[x];
      for (int32_t t = 0; t < set_.tries; ++t)
        if (lived_[branch_first(q.env, t)] > 0) choose(&q, branch_first(q.env, t));
    }
  }
}

void Shield::start_branch(int32_t env, int32_t i, const Branch& b) {
  for (int32_t c = 0; c < worlds_; ++c) {
    tried_.start(i + c, *kept_, kept_of(first_of(env) + c, b.from), bound_ + sz(env) * sz(costs_));
    backup_[i + c] = b.backup;
  }
  width_[i] = b.noise;
  from_[i] = b.from;
}

bool Shield::clean(int32_t i) const {
  using Fate = CopiesTried::Fate;
  for (int32_t c = i; c < i + worlds_; ++c)
    if (tried_.fate(c) != Fate::kOver && tried_.fate(c) != Fate::kGoing) return false;
  return true;
}

// A branch that is clean becomes the winner where there is none, or only one of the reserve; with choose=best
// wherever its return is higher.
void Shield::choose(Inquiry* q, int32_t i) {
  if (!clean(i)) return;
  double ret = 0;
  for (int32_t c = i; c < i + worlds_; ++c) ret += tried_.pool().gained(c);
  const bool first = q->winner < 0 || (q->winner < q->reserve && number_[i] >= q->reserve);
  if (!first && !(set_.best && ret > q->ret)) return;
  q->winner = number_[i];
  q->ret = ret;
  take(q, i);
}

void Shield::take(Inquiry* q, int32_t i) {
  q->from = from_[i];
  q->backup = backup_[i];
  q->tail = lived_[i];
  std::copy_n(branch_ + plan_of(i), row_of(lived_[i]), tail_ + plan_of(q->env));
}

void Shield::run_branches(bool stop_at_cost) {
  std::fill_n(lived_, tried_.count(), 0);
  for (int32_t h = 0; tried_.any_going() && (set_.look == 0 || h <= set_.look); ++h) {
    back_up(&tried_, backup_);
    for (int32_t i = 0; h == 0 && i < tried_.count(); i += worlds_)
      if (tried_.going(i) && width_[i] > 0) add_noise(i);
    keep_guards(&tried_, set_.tries * worlds_);
    for (int32_t i = 0; i < tried_.count(); i += worlds_) {
      if (!tried_.going(i)) continue;  // the first copy's way is the plan
      std::copy_n(tried_.action(i), dim_, branch_ + plan_of(i) + row_of(h));
      lived_[i] = h + 1;
    }
    counts_.copied += tried_.step(steps_, stop_at_cost);
    for (int32_t i = 0; worlds_ > 1 && stop_at_cost && i < tried_.count(); i += worlds_)
      if (!clean(i))
        for (int32_t c = i; c < i + worlds_; ++c) tried_.stop(c);
  }
}

// The same to the actions of all copies of a branch.
void Shield::add_noise(int32_t i) {
  float* z = act_rows_;
  noise_[i / worlds_ / set_.tries].normals(z, dim_);
  for (int32_t c = i; c < i + worlds_; ++c) {
    float* a = tried_.action(c);
    for (int32_t j = 0; j < dim_; ++j)
      a[j] = std::clamp(a[j] + static_cast<float>(width_[i] * set_.noise) * z[j], -1.0f, 1.0f);
  }
}

// Whether branch a exceeds budgets by more than b does; what is lost, by most.
bool Shield::worse(int32_t a, int32_t b) const {
  double lost = 0, excess = 0;
  for (int32_t c = 0; c < worlds_; ++c) {
    lost += tried_.fate(a + c) == CopiesTried::Fate::kLost;
    lost -= tried_.fate(b + c) == CopiesTried::Fate::kLost;
    excess += tried_.excess(a + c) - tried_.excess(b + c);
  }
  return lost != 0 ? lost > 0 : excess > 0;
}

// Where nothing was clean and there is no plan: what exceeds the budgets least, if that will do.
void Shield::try_least(const Pool& pool, bool unneeded) {
  if (unneeded && !set_.least) return;
  tried_.stop_all();
  bool any = false;
  for (int32_t x = 0; x < num_asked_; ++x) {
    Inquiry& q = inquiries_[x];
    if (q.fail < 0 || q.winner >= 0 || place(pool, q.env) >= 0) continue;
    if (!set_.least) {
      const int32_t ahead = q.cost_in - pool.episode_step(q.env);
      if (q.column < 0)
        fail(Code::kState, "world %d: the copies diverge in %d control steps by every plan that was tried",
             q.env, ahead);
      fail(Code::kState,
           "world %d: every plan that was tried exceeds the budget of cost column %d, %s; what was proposed "
           "does in %d control steps. Give a backup that does not, or unproven=least",
           q.env, q.column, Quoted(task_at(pool.task_index()).costs[q.column].name).text, ahead);
    }
    for (int32_t b = 0; b < num_order_; ++b) start_branch(q.env, branch_first(q.env, b), {0, order_[b], 0});
    any = q.least = true;
  }
  if (!any) return;
  run_branches(false);
  for (int32_t x = 0; x < num_asked_; ++x) {
    Inquiry& q = inquiries_[x];
    if (!q.least) continue;
    int32_t best = branch_first(q.env, 0);
    for (int32_t b = 1; b < num_order_; ++b)
      if (const int32_t i = branch_first(q.env, b); worse(best, i)) best = i;
    q.winner = 0;
    take(&q, best);
  }
}

void Shield::adopt(const Pool& pool, const Inquiry& q) {
  Plan& p = plans_[q.env];
  const float* way = way_ + plan_of(q.env);
  const bool clean = q.fail < 0;
  if (!clean) {
    p.column = q.column;
    p.cost_in = q.cost_in;
  }
  if (!clean && q.winner < 0) {
    const int32_t at = place(pool, q.env);
    if (at < 0) return;  // nothing is clean
    // the plan goes on
    p.refused = at;
    p.block = at + 1;
    p.kept = 1;
    std::copy_n(foreseen_own(q.env, 0), dim_, refused_ + row_of(q.env));
    return;
  }
  const int32_t first = clean ? q.way : q.from;
  p.course = pool.course(q.env);
  p.begin = pool.episode_step(q.env);
  p.length = clean ? first : first + q.tail;
  p.refused = first < q.samples ? first : -1;
  p.block = p.refused >= 0 ? first + 1 : q.samples;
  p.backup = clean ? -1 : q.backup;
  p.dirty = q.least;
  p.adopt = p.kept = 0;
  float* to = plan_ + plan_of(q.env);
  std::copy_n(way, row_of(first), to);
  if (!clean) std::copy_n(tail_ + plan_of(q.env), row_of(q.tail), to + row_of(first));
  if (p.refused >= 0) std::copy_n(foreseen_own(q.env, p.refused), dim_, refused_ + row_of(q.env));
}

// ---- plans of a host

void Shield::set_plan(const Pool& pool, int32_t env, const float* actions, int32_t count) {
  const FpMode fp;
  check_pool(pool);
  if (!set_.predict)
    fail(Code::kArgument, "plan: with predict=false nothing is tried, so there are no plans");
  if (set_.copies > 0)
    fail(Code::kUnsupported, "plan: with copies=%d no plan of actions holds for certain", set_.copies);
  if (!pool.running(env)) fail(Code::kState, "plan: no episode runs in world %d; reset it first", env);
  if (count < 1 || count > length_)
    fail(Code::kRange, "plan: %d decisions are outside [1, %d]", count, length_);
  for (size_t j = 0; j < row_of(count); ++j)
    if (!std::isfinite(actions[j])) fail(Code::kArgument, "plan: entry %zu is not finite", j);
  order_backups(nullptr);
  const double* bound = bound_of(pool, env);
  const int32_t i = first_of(env), end = set_.look > 0 ? std::min(count + set_.look, length_) : length_;
  // It is tried with each backup behind its end, until one is clean.
  for (int32_t b = 0;; ++b) {
    first_.stop_all();
    first_.start(i, pool, env, bound);
    int32_t d = 0;
    for (; first_.going(i) && d < end && (d < count || b < num_order_); ++d) {
      if (d < count) {
        guards_.project(env, actions + row_of(d), first_.action(i));
      } else {
        backup_[i] = order_[b];
        back_up(&first_, backup_);
        keep_guards(&first_, worlds_);
      }
      std::copy_n(first_.action(i), dim_, way_ + plan_of(env) + row_of(d));
      counts_.copied += first_.step(steps_, true);
    }
    const auto fate = first_.fate(i);
    if (fate == CopiesTried::Fate::kOver || (fate == CopiesTried::Fate::kGoing && d == end)) {
      Plan& p = plans_[env];
      p = {};
      p.course = pool.course(env);
      p.begin = pool.episode_step(env);
      p.length = d;
      p.refused = p.backup = p.column = -1;
      std::copy_n(way_ + plan_of(env), row_of(d), plan_ + plan_of(env));
      return;
    }
    if (fate != CopiesTried::Fate::kGoing && d > count && b + 1 < num_order_) continue;
    if (fate == CopiesTried::Fate::kGoing)
      fail(Code::kState, "world %d: the plan ends before the episode, and there is no backup", env);
    const int32_t ahead = first_.ended_in(i) - pool.episode_step(env), column = first_.column(i);
    if (column < 0) fail(Code::kState, "world %d: by the plan it diverges in %d control steps", env, ahead);
    fail(Code::kState, "world %d: by the plan cost column %d, %s, exceeds its budget in %d control steps",
         env, column, Quoted(task_at(pool.task_index()).costs[column].name).text, ahead);
  }
}

void Shield::back_up(CopiesTried* copies, const int32_t* backup) {
  for (int32_t x = 0; x < num_order_; ++x) {
    const int32_t b = order_[x];
    int32_t rows = 0;
    for (int32_t i = 0; i < copies->count(); ++i)
      if (copies->going(i) && backup[i] == b) list_[rows++] = i;
    if (rows == 0) continue;
    const bool still = b >= num_policies_ && b < num_own_;
    if (!still) ask_backup(b, *copies, rows);
    const float* held = set_.zero && b == num_policies_ ? zero_ : hold_;
    for (int32_t i = 0; i < rows; ++i)
      std::copy_n(still ? held : act_rows_ + row_of(i), dim_, copies->action(list_[i]));
  }
}

// act_rows_ of the copies list_ [rows].
void Shield::ask_backup(int32_t b, const CopiesTried& copies, int32_t rows) {
  for (int32_t i = 0; i < rows; ++i) std::copy_n(copies.obs(list_[i]), obs_, obs_rows_ + sz(i) * sz(obs_));
  if (b < num_policies_)
    policies_[b]->act(obs_rows_, rows, act_rows_);
  else
    foresight_->act(nullptr, obs_rows_, rows, nullptr, nullptr, act_rows_);
}

void Shield::keep_guards(CopiesTried* copies, int32_t each) const {
  if (guards_.count() == 0) return;
  for (int32_t i = 0; i < copies->count(); ++i)
    if (copies->going(i)) guards_.project(i / each, copies->action(i), copies->action(i));
}

// ---- state

uint64_t Shield::fingerprint() const {
  const Vector<char> lines = options_.lines();
  uint64_t hash = hash_bytes(lines.data(), lines.size() - 1);
  hash = hash_bytes(budget_, sz(costs_) * sizeof *budget_, hash);
  const int32_t sizes[] = {n_, dim_, stride_, length_, num_policies_};
  hash = hash_bytes(sizes, sizeof sizes, hash);
  hash = guards_.hash(hash);
  return hash_bytes(&layout_, sizeof layout_, hash);
}

void Shield::write_state(Writer& out) const {
  const HostScope scope(hooks_);
  out.begin_file(kMagic, kVersion);
  out.begin_section("HEAD");
  out.value(fingerprint());
  out.end_section();
  out.begin_section("GARD");
  guards_.write(out);
  out.end_section();
  out.begin_section("PLAN");
  out.value(counts_);
  for (int32_t i = 0; i < n_; ++i) {
    Plan p = plans_[i];
    p.course = 0;  // of this process's pool
    p.adopt = 0;
    out.value(p);
    out.value(rows_[i]);
    out.value(noise_[i]);
    out.value(drawn_[i]);
    out.bytes(own_ + row_of(i), row_of(1) * sizeof *own_);
    out.bytes(refused_ + row_of(i), row_of(1) * sizeof *refused_);
    out.bytes(plan_ + plan_of(i), row_of(p.length) * sizeof *plan_);
  }
  out.end_section();
  out.end_file();
}

void Shield::read_state(const void* bytes, size_t size) {
  const HostScope scope(hooks_);
  Reader in(bytes, size, "shield state");
  in.begin_file(kMagic, kVersion);
  in.need_section("HEAD");
  if (in.value<uint64_t>() != fingerprint())
    fail(Code::kFormat, "shield state: of a shield of another task, other sizes or options");
  in.expect_end();
  in.need_section("GARD");
  Reader guards = in;
  bool good = guards_.check(in);
  in.expect_end();
  in.need_section("PLAN");
  Reader look = in;
  const auto count = look.value<ShieldCounts>();
  for (const int64_t x : {count.decisions, count.inquiries, count.failed, count.changed, count.planned,
                          count.unproven, count.copied, count.projected})
    good &= x >= 0;
  const auto numbers = [&](int32_t rows) {
    for (size_t j = 0; j < row_of(rows); ++j) good &= std::isfinite(look.value<float>());
  };
  for (int32_t i = 0; i < n_; ++i) {
    const auto p = look.value<Plan>();
    good &= p.length >= 0 && p.length <= length_ && p.begin >= 0 && p.block >= 0 && p.block <= length_ &&
            p.refused >= -1 && p.refused < std::max(p.length, 1) && p.backup >= -1 && p.backup <= num_own_ &&
            p.column >= -1 && p.column < costs_ && p.dirty <= 1 && p.kept <= 1 && p.adopt == 0 &&
            p.course == 0;
    const auto r = look.value<ShieldRow>();
    good &= r.kind >= ShieldKind::kOwn && r.kind <= ShieldKind::kProjected && r.column >= -1 &&
            r.column < costs_ && r.backup >= -1 && r.backup <= num_own_;
    look.value<Stream>();
    look.value<Stream>();
    if (!good) break;
    numbers(2 + p.length);
  }
  if (!good) fail(Code::kFormat, "shield state: a number is out of range");
  look.expect_end();
  guards_.read(guards);
  counts_ = in.value<ShieldCounts>();
  for (int32_t i = 0; i < n_; ++i) {
    plans_[i] = in.value<Plan>();
    plans_[i].adopt = 1;
    rows_[i] = in.value<ShieldRow>();
    noise_[i] = in.value<Stream>();
    drawn_[i] = in.value<Stream>();
    in.bytes(own_ + row_of(i), row_of(1) * sizeof *own_);
    in.bytes(refused_ + row_of(i), row_of(1) * sizeof *refused_);
    in.bytes(plan_ + plan_of(i), row_of(plans_[i].length) * sizeof *plan_);
  }
}

}  // namespace rdm
