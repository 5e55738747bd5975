// An inquiry of the shield: all worlds that ask, together. The first way of each runs in a copy, then branches from it, until
// one is clean and becomes the plan.
#include <algorithm>

#include "base/error.hpp"
#include "base/text.hpp"
#include "shield/shield.hpp"

namespace rdm {
namespace {

// The last branches: noise about the first decision that is wider each time.
constexpr int32_t kWide = 4;
constexpr double kWider = 0.75;

}  // namespace

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
      for (int32_t p = 0; p < num_policies_; ++p) memory_[p].copy(memory_[p].way, i, memory_[p].before, env);
    }
    std::copy_n(proposed + row_of(env), dim_, foreseen_own(env, 0));
    if (!foresight_) continue;
    Remembered& m = foreseen_memory_;
    foresight_->begin(env, &foreseen_[env], offset_ + row_of(env), m.row(m.before, env));
    for (int32_t i = first_of(env); i < first_of(env + 1); ++i) m.copy(m.way, i, m.before, env);
  }
  // The way is that of what is proposed, then of the backup; the states before its first decisions are kept.
  const int32_t foreseen = foresight_ ? set_.block : 1;
  for (int32_t d = 0; first_.any_going() && (set_.look == 0 || d < foreseen + set_.look); ++d) {
    for (int32_t i = 0; d <= set_.block && i < first_.count(); ++i)
      if (first_.going(i)) keep_way(i, d);
    if (d < set_.block) look_on_first(d == 0 ? -1 : d < foreseen ? num_own_ : order_[0]);
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

// The state of a copy on a first way before decision d, and what backups remember there.
void Shield::keep_way(int32_t i, int32_t d) {
  kept_->copy(kept_of(i, d), first_.pool(), i);
  for (int32_t x = 0; x < num_order_; ++x)
    if (const Remembered* m = memory_of(order_[x])) m->copy(m->keep, kept_of(i, d), m->way, i);
}

// In a decision of the first ways all backups that remember see what the copies show, but the one that decides, which sees
// it by deciding: each of them may be asked from there on.
void Shield::look_on_first(int32_t decides) {
  for (int32_t x = 0; x < num_order_; ++x)
    if (order_[x] != decides && memory_of(order_[x])) look_on(order_[x], first_);
}

void Shield::look_on(int32_t b, const CopiesTried& copies) {
  int32_t rows = 0;
  for (int32_t i = 0; i < copies.count(); ++i)
    if (copies.going(i)) list_[rows++] = i;
  ask_backup(b, copies, rows);
}

// Decision d of those who propose; there is one copy of a world then.
void Shield::foresee(int32_t d) {
  int32_t rows = 0;
  each_going([&](int32_t i) { list_[rows++] = i; });
  ask_foresight(first_, rows, true);
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
    const int32_t from = kept_of(first_of(env) + c, b.from);
    tried_.start(i + c, *kept_, from, bound_ + sz(env) * sz(costs_));
    if (const Remembered* m = memory_of(b.backup)) m->copy(m->branch, i + c, m->keep, from);
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
        fail(Code::kState,
             "world %d: under every plan that was tried the copies diverge within %d control steps", q.env,
             ahead);
      fail(Code::kState,
           "world %d: every plan that was tried exceeds the budget of cost column %d, %s; the proposed "
           "action does so in %d control steps. Give a backup policy that does not, or set unproven=least",
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
  if (b >= num_policies_) return ask_foresight(copies, rows, false);
  const Remembered& m = memory_[b];
  gather(m, copies, rows);
  policies_[b]->act(obs_rows_, rows, m.asked, act_rows_);
  scatter(m, copies, rows);
}

void Shield::ask_foresight(const CopiesTried& copies, int32_t rows, bool with_noise) {
  const Remembered& m = foreseen_memory_;
  gather(m, copies, rows);
  if (with_noise)
    foresight_->act(list_, obs_rows_, rows, m.asked, foreseen_, offset_, act_rows_);
  else
    foresight_->act(nullptr, obs_rows_, rows, m.asked, nullptr, nullptr, act_rows_);
  scatter(m, copies, rows);
}

// Rows of the copies list_ [rows], and what a backup remembers of them; and back.
void Shield::gather(const Remembered& m, const CopiesTried& copies, int32_t rows) {
  for (int32_t i = 0; i < rows; ++i) {
    std::copy_n(copies.obs(list_[i]), obs_, obs_rows_ + sz(i) * sz(obs_));
    m.copy(m.asked, i, states_of(m, copies), list_[i]);
  }
}

void Shield::scatter(const Remembered& m, const CopiesTried& copies, int32_t rows) {
  for (int32_t i = 0; i < rows; ++i) m.take(states_of(m, copies), list_[i], i);
}

void Shield::keep_guards(CopiesTried* copies, int32_t each) const {
  if (guards_.count() == 0) return;
  for (int32_t i = 0; i < copies->count(); ++i)
    if (copies->going(i)) guards_.project(i / each, copies->action(i), copies->action(i));
}

}  // namespace rdm
