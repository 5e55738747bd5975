#include "plan/planner.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <new>

#include "base/error.hpp"
#include "base/fpmode.hpp"
#include "base/hash.hpp"
#include "base/option_rows.hpp"
#include "env/copies.hpp"

namespace rdm {
namespace {

constexpr char kMagic[8] = {'R', 'D', 'M', 'P', 'L', 'A', 'N', 'R'};
constexpr uint32_t kVersion = 1;
constexpr int32_t kMaxSamples = 65536, kMaxHorizon = 10000;
constexpr double kMaxNoise = 10;
constexpr int64_t kMaxNumbers = int64_t{1} << 28;  // of an array

constexpr auto kRows = option_rows<PlanOptions>(
    row<&PlanOptions::method, PlanMethod::kPredictive, PlanMethod::kCem, PlanMethod::kMppi>(
        text_option("method", "predictive", "predictive|cem|mppi",
                    "how a plan improves: predictive: best sample; cem: mean of the elites; mppi: mean "
                    "weighted by return")),
    row<&PlanOptions::samples>(integer_option("samples", 64, 1, kMaxSamples,
                                              "number of action sequences simulated in each iteration")),
    row<&PlanOptions::horizon>(
        basic(integer_option("horizon", 32, 1, kMaxHorizon, "number of pool steps that a plan looks ahead"))),
    row<&PlanOptions::knots>(integer_option(
        "knots", 5, 1, kMaxHorizon, "number of points in time at which noise is drawn; at most the horizon")),
    row<&PlanOptions::interpolation, Interpolation::kZero, Interpolation::kLinear, Interpolation::kCubic>(
        text_option("interpolation", "linear", "zero|linear|cubic",
                    "interpolation of the noise between knots")),
    row<&PlanOptions::noise>(basic(number_option(
        "noise", 0.2, 0, kMaxNoise, "standard deviation of the noise on the plan, in units of the action"))),
    row<&PlanOptions::noise_min>(number_option(
        "noise_min", 0.02, 0, kMaxNoise, "cem: lower bound of the standard deviation that the elites give")),
    row<&PlanOptions::elites>(integer_option("elites", 8, 1, kMaxSamples,
                                             "cem: number of best samples whose mean is the new plan")),
    row<&PlanOptions::temperature>(
        number_option("temperature", 0.2, 1e-6, 1e6,
                      "mppi: temperature of the weights, in standard deviations of the samples' returns")),
    row<&PlanOptions::iterations>(
        integer_option("iterations", 1, 1, 1000, "number of improvements of the plan in each call")),
    row<&PlanOptions::warm_start>(
        flag_option("warm_start", true, "the next plan starts from this one, shifted by one step")),
    row<&PlanOptions::replan>(integer_option(
        "replan", 1, 1, kMaxHorizon, "calls from one plan to the next; the plan is followed in between")),
    row<&PlanOptions::best_only, false, true>(
        text_option("choice", "mean", "mean|best",
                    "cem, mppi: act on the mean, or on the best sample of the last iteration")),
    row<&PlanOptions::discount>(
        basic(number_option("discount", 1, 0, 1, "discount factor of rewards per pool step"))),
    row<&PlanOptions::costs, CostRule::kFeasible, CostRule::kMultiplier, CostRule::kIgnore>(text_option(
        "costs", "feasible", "feasible|multiplier|ignore",
        "ranking: feasible: plans within the budgets first; multiplier: return minus costs; ignore: return")),
    row<&PlanOptions::multiplier>(
        number_option("multiplier", 1, 0, 1e9, "weight of each limited cost with costs=multiplier")),
    row<&PlanOptions::share, false, true>(text_option(
        "budget", "rest", "rest|share",
        "what one plan may cost: rest: all that the episode has left; share: the horizon's share of it")),
    row<&PlanOptions::terminal_cost>(flag_option(
        "terminal_cost", false, "add the cost critic's values at the end of a plan to its costs")));

size_t sz(int32_t n) {
  return static_cast<size_t>(n);
}
float clip_unit(float x) {
  return std::clamp(x, -1.0f, 1.0f);
}

}  // namespace

const OptionSpec* planner_options(int32_t* count) {
  *count = static_cast<int32_t>(kRows.size());
  return kRows.specs;
}

void Planner::read_options(const PlannerConfig& c) {
  options_.add_table(kRows.specs, static_cast<int32_t>(kRows.size()));
  options_.set_all(c.options, c.num_options, c.settings, "planner");
  settings_ = kRows.read(options_);
  settings_.knots = std::min(settings_.knots, settings_.horizon);
  settings_.elites = std::min(settings_.elites, settings_.samples);
  if (settings_.replan > settings_.horizon)
    fail(Code::kRange, "replan: %d is above the horizon, %d", settings_.replan, settings_.horizon);
  settings_.best_only = settings_.best_only || settings_.method == PlanMethod::kPredictive;
  rule_.rule = settings_.costs;
  rule_.multiplier = settings_.multiplier;
}

void Planner::make_rollouts(const PlannerConfig& c) {
  const Pool& pool = *c.pool;
  const TaskInfo& info = task_at(pool.task_index());
  rollouts_ = make_copies(pool, settings_.samples, c.num_threads, hooks_);
  action_dim_ = pool.task().action_dim();
  cost_dim_ = pool.cost_dim();
  rule_.num_costs = cost_dim_;
  pools_limit_ = !c.cost_limits;
  for (int32_t k = 0; k < cost_dim_; ++k) {
    limit_[k] = c.cost_limits ? c.cost_limits[k] : info.costs[k].limit;
    if (std::isnan(limit_[k])) fail(Code::kArgument, "cost_limits: entry %d is not a number", k);
  }
}

void Planner::carve(Arena& arena) {
  if (int64_t{settings_.samples} * settings_.knots * action_dim_ > kMaxNumbers ||
      int64_t{settings_.horizon} * action_dim_ > kMaxNumbers)
    fail(Code::kRange, "samples: %d times %d knots times %d actions is above %lld", settings_.samples,
         settings_.knots, action_dim_, static_cast<long long>(kMaxNumbers));
  if (int64_t{settings_.samples} * critic_dim_ > kMaxNumbers)
    fail(Code::kRange, "samples: %d times %d numbers of the critic's history is above %lld",
         settings_.samples, critic_dim_, static_cast<long long>(kMaxNumbers));
  // plan [horizon][action_dim], width: knots of one sample's noise
  const size_t n = sz(settings_.samples), dim = sz(action_dim_), plan = sz(settings_.horizon) * dim,
               width = sz(settings_.knots) * dim;
  rows_ = arena.make<KnotRow>(sz(settings_.horizon));
  start_ = arena.make<float>(dim);
  noise_std_ = arena.make<float>(dim);
  floor_ = arena.make<float>(width);
  sigma_ = arena.make<float>(width);
  plan_ = arena.make<float>(plan);
  centre_ = arena.make<float>(plan);
  next_ = arena.make<float>(plan);
  noise_ = arena.make<float>(n * width);
  weights_ = arena.make<double>(n);
  sum_ = arena.make<double>(dim);
  value_ = arena.make<float>(critic_ ? n : 0);
  cost_value_ = arena.make<float>(critic_ ? n * sz(critic_->num_costs()) : 0);
  last_ = arena.make<float>(dim);
  row_ = arena.make<float>(dim);
  alive_ = arena.make<uint8_t>(n);
  courses_ = arena.make<Course>(n);
  standings_ = arena.make<Standing>(n);
  order_ = arena.make<int32_t>(n);
  for (float** state : {&before_, &after_, &recalled_, &next_state_})
    *state = arena.make<float>(sz(state_dim_));
  walked_ = arena.make<float>(sz(policy_dim_));
  critic_state_ = arena.make<float>(n * sz(critic_dim_));
}

Planner::Planner(const PlannerConfig& c)
    : hooks_(c.hooks),
      policy_(c.policy),
      critic_(c.critic),
      stop_(c.stop),
      user_(c.user),
      stream_(c.seed, 0, Purpose::kPolicyNoise) {
  const HostScope scope(hooks_);
  read_options(c);
  if (policy_) policy_dim_ = policy_->state_dim();
  if (critic_) critic_dim_ = critic_->state_dim();
  state_dim_ = policy_dim_ + critic_dim_;
  try {
    make_rollouts(c);
    Arena measure;
    carve(measure);
    arena_ = Arena(hooks_, measure.used());
    carve(arena_);
    for (int32_t j = 0; j < action_dim_; ++j) {
      const double noise = c.noise ? static_cast<double>(c.noise[j]) : settings_.noise;
      if (!(noise >= 0 && noise <= kMaxNoise))
        fail(Code::kRange, "noise: entry %d is outside [0, %g]", j, kMaxNoise);
      noise_std_[j] = static_cast<float>(noise);
      for (int32_t k = 0; k < settings_.knots; ++k)
        floor_[sz(k) * sz(action_dim_) + sz(j)] = static_cast<float>(std::min(settings_.noise_min, noise));
    }
  } catch (...) {
    Pool::destroy(rollouts_);
    throw;
  }
  for (int32_t t = 0; t < settings_.horizon; ++t)
    rows_[t] = knot_row(settings_.interpolation, settings_.knots, settings_.horizon, t);
  rollouts_->task().initial_mean(start_);
  for (int32_t j = 0; j < action_dim_; ++j) start_[j] = clip_unit(start_[j]);
  forget();  // the first plan repeats the start action
}

Planner::~Planner() {
  Pool::destroy(rollouts_);
}

Planner* Planner::create(const PlannerConfig& config) {
  const FpMode mode;
  return host_new<Planner>(config.hooks, config);
}

void Planner::destroy(Planner* p) {
  if (!p) return;
  const HostHooks hooks = p->hooks_;
  const HostScope scope(hooks);
  host_delete(hooks, p);
}

void Planner::start_plan(float* plan) const {
  for (int32_t t = 0; t < settings_.horizon; ++t)
    std::copy_n(start_, action_dim_, plan + sz(t) * sz(action_dim_));
}

void Planner::forget() {
  planned_ = given_ = false;
  since_ = 0;
  seen_ = {};
  start_plan(plan_);
  std::fill_n(last_, action_dim_, 0.0f);
}

void Planner::set_plan(const float* plan) {
  const size_t count = sz(settings_.horizon) * sz(action_dim_);
  for (size_t i = 0; i < count; ++i)
    if (!std::isfinite(plan[i])) fail(Code::kArgument, "plan: entry %zu is not finite", i);
  for (size_t i = 0; i < count; ++i) plan_[i] = clip_unit(plan[i]);
  planned_ = true;
  given_ = false;
}

// Shifts the plan by one step and repeats its last action at the end.
void Planner::shift_plan() {
  const size_t dim = sz(action_dim_);
  std::memmove(plan_, plan_ + dim, (sz(settings_.horizon) - 1) * dim * sizeof *plan_);
}

void Planner::set_budgets(const Pool& pool, int32_t env) {
  // budget=share: of the budget that is left, the part that the horizon has of the steps that are left
  const double left = pool.task().max_steps() - pool.episode_step(env);
  const double share = settings_.share ? std::min(1.0, settings_.horizon * pool.repeat() / left) : 1.0;
  for (int32_t k = 0; k < cost_dim_; ++k) {
    const double own = k == 0 && pools_limit_ ? pool.limit(env) : -1;  // of the episode, by option limit
    const double limit = own < 0 ? limit_[k] : own;
    rule_.budget[k] = limit < 0 ? -1 : share * std::max(limit - pool.spent(env, k), 0.0);
  }
}

bool Planner::stopped() {
  cancel_.check();
  return stop_ && stop_(user_, steps_) != 0;
}

// In the steps in which they would decide without the planner.
bool Planner::decides(const Pool& pool, int32_t env, int32_t repeat, int32_t t) const {
  const int32_t steps = std::max(1, repeat / pool.repeat());
  return (pool.episode_step(env) / pool.repeat() + t) % steps == 0 || (t == 0 && !planned_);
}

void Planner::recall(const Pool& pool, int32_t env) {
  const Passed passed = passed_since(seen_, pool, env);
  if (passed == Passed::kEpisode)
    std::fill_n(recalled_, state_dim_, 0.0f);
  else
    std::copy_n(passed == Passed::kSteps ? after_ : before_, state_dim_, recalled_);
  std::copy_n(recalled_, state_dim_, next_state_);
  const float* obs = pool.buffers().obs + sz(env) * sz(pool.obs_dim());
  if (policy_dim_ && decides(pool, env, policy_->repeat(), 0)) {
    policy_->act(obs, 1, next_state_, row_);
    if (!sound_state(next_state_, policy_dim_)) std::copy_n(recalled_, policy_dim_, next_state_);
  }
  if (critic_dim_ && decides(pool, env, critic_->repeat(), 0))
    critic_->see(obs, 1, next_state_ + policy_dim_);
}

void Planner::remember(const Pool& pool, int32_t env) {
  seen_ = moment_of(pool, env);
  std::copy_n(recalled_, state_dim_, before_);
  std::copy_n(next_state_, state_dim_, after_);
}

bool Planner::propose(const Pool& pool, int32_t env) {
  rollouts_->copy(0, pool, env);
  const Buffers& b = rollouts_->buffers();
  std::copy_n(recalled_, policy_dim_, walked_);
  std::fill_n(alive_, settings_.samples, uint8_t{0});
  alive_[0] = 1;
  bool whole = true;
  for (int32_t t = 0; t < settings_.horizon; ++t) {
    float* action = centre_ + sz(t) * sz(action_dim_);
    const float* before = t > 0 ? action - action_dim_ : last_;
    if (!alive_[0] || !decides(pool, env, policy_->repeat(), t))
      std::copy_n(before, action_dim_, action);
    else
      policy_->act(b.obs, 1, walked_, action);
    for (int32_t j = 0; j < action_dim_; ++j)  // the last plan replaces what an overflow made infinite
      action[j] = std::isfinite(action[j]) ? clip_unit(action[j]) : before[j];
    if (!alive_[0] || t + 1 == settings_.horizon) continue;
    if (stopped()) {
      whole = false;
      alive_[0] = 0;  // the episode is over: the rest of the proposal repeats the last action
      continue;
    }
    std::copy_n(action, action_dim_, b.action);
    rollouts_->step(alive_);
    steps_ += rollouts_->taken(0);
    alive_[0] = !b.terminated[0] && !b.truncated[0];
  }
  return whole;
}

void Planner::draw_noise() {
  const int32_t width = settings_.knots * action_dim_;
  stream_.normals(noise_, settings_.samples * width);
  for (int32_t i = 0; i < settings_.samples; ++i) {
    float* e = noise_ + sz(i) * sz(width);
    if (i == 0 || (i == 1 && foreign_))  // no noise: the centre, and the last plan beside a policy's
      std::fill_n(e, width, 0.0f);
    else
      for (int32_t j = 0; j < width; ++j) e[j] *= sigma_[j];
  }
}

const float* Planner::plan_row(int32_t step) const {
  return plan_ + sz(std::min(step + ahead_, settings_.horizon - 1)) * sz(action_dim_);
}

void Planner::sample_action(int32_t sample, int32_t step, float* action) const {
  const size_t dim = sz(action_dim_), at = sz(step) * dim;
  if (sample == 1 && foreign_) {
    std::copy_n(plan_row(step), dim, action);
    return;
  }
  const KnotRow& row = rows_[step];
  std::copy_n(centre_ + at, dim, action);
  for (int32_t k = 0; sample > 0 && k < row.count; ++k) {
    const float* e = noise_ + (sz(sample) * sz(settings_.knots) + sz(row.first + k)) * dim;
    for (size_t j = 0; j < dim; ++j) action[j] += row.weight[k] * e[j];
  }
  for (size_t j = 0; j < dim; ++j) action[j] = clip_unit(action[j]);
}

bool Planner::roll_out(const Pool& pool, int32_t env) {
  rollouts_->copy(-1, pool, env);  // into all worlds
  const Buffers& b = rollouts_->buffers();
  std::fill_n(alive_, settings_.samples, uint8_t{1});
  std::fill_n(courses_, settings_.samples, Course{});
  for (int32_t i = 0; i < settings_.samples; ++i)
    std::copy_n(next_state_ + policy_dim_, critic_dim_, critic_state_ + sz(i) * sz(critic_dim_));
  double discount = 1;
  int32_t alive = settings_.samples;
  for (int32_t t = 0; t < settings_.horizon && alive > 0; ++t, discount *= settings_.discount) {
    if (stopped()) return false;
    if (t > 0 && critic_dim_ && decides(pool, env, critic_->repeat(), t))
      critic_->see(b.obs, settings_.samples, critic_state_);
    for (int32_t i = 0; i < settings_.samples; ++i)
      if (alive_[i]) sample_action(i, t, b.action + sz(i) * sz(action_dim_));
    rollouts_->step(alive_);
    for (int32_t i = 0; i < settings_.samples; ++i) {
      if (!alive_[i]) continue;
      Course& c = courses_[i];
      steps_ += rollouts_->taken(i);
      c.ret += discount * static_cast<double>(b.reward[i]);
      for (int32_t k = 0; k < cost_dim_; ++k)
        c.cost[k] += static_cast<double>(b.cost[sz(i) * sz(cost_dim_) + sz(k)]);
      if (!b.terminated[i] && !b.truncated[i]) continue;
      // a trajectory on which the world fails must never be chosen, whatever its return
      c.lost = (b.status[i] & (kStatusDiverged | kStatusBadAction | kStatusTask)) != 0;
      alive_[i] = 0;
      --alive;
    }
  }
  if (critic_ && alive > 0) add_terminal(discount);
  return true;
}

void Planner::add_terminal(double discount) {
  critic_->values(rollouts_->buffers().obs, critic_state_, settings_.samples, value_, cost_value_);
  const int32_t costs = critic_->num_costs();
  for (int32_t i = 0; i < settings_.samples; ++i) {
    if (!alive_[i]) continue;
    courses_[i].ret += discount * static_cast<double>(value_[i]);
    for (int32_t k = 0; settings_.terminal_cost && k < costs; ++k)
      courses_[i].cost[critic_->column(k)] +=
          std::max(0.0, static_cast<double>(cost_value_[sz(i) * sz(costs) + sz(k)]));
  }
}

void Planner::move_centre() {
  for (int32_t i = 0; i < settings_.samples; ++i) standings_[i] = standing(courses_[i], rule_);
  rank_courses(standings_, settings_.samples, order_);
  // The new centre is a weighted mean of samples: the best one alone, all by e^(return / temperature), or the elites
  // with equal weights.
  std::fill_n(weights_, settings_.samples, 0.0);
  if (settings_.best_only)
    weights_[order_[0]] = 1;
  else if (settings_.method == PlanMethod::kMppi)
    path_integral_weights(standings_, settings_.samples, settings_.temperature, weights_);
  else
    for (int32_t e = 0; e < settings_.elites; ++e) weights_[order_[e]] = 1.0 / settings_.elites;
  if (settings_.method == PlanMethod::kCem)
    elite_deviation(noise_, order_, settings_.elites, settings_.knots * action_dim_, floor_, sigma_);
  for (int32_t t = 0; t < settings_.horizon; ++t) {
    std::fill_n(sum_, action_dim_, 0.0);
    for (int32_t i = 0; i < settings_.samples; ++i) {
      if (weights_[i] == 0) continue;
      sample_action(i, t, row_);
      for (int32_t j = 0; j < action_dim_; ++j) sum_[j] += weights_[i] * static_cast<double>(row_[j]);
    }
    for (int32_t j = 0; j < action_dim_; ++j)
      next_[sz(t) * sz(action_dim_) + sz(j)] = clip_unit(static_cast<float>(sum_[j]));
  }
  std::swap(centre_, next_);
}

void Planner::describe_iteration(PlanInfo* out) const {
  out->best_sample = order_[0];
  out->best = courses_[order_[0]];
  int32_t feasible = 0;
  for (int32_t i = 0; i < settings_.samples; ++i) feasible += !courses_[i].lost && within(courses_[i], rule_);
  out->feasible_share = static_cast<double>(feasible) / settings_.samples;
}

void Planner::make_plan(const Pool& pool, int32_t env, PlanInfo* out) {
  rollouts_->copy(0, pool, env);  // refuses a pool that does not fit
  steps_ = 0;
  ahead_ = given_ ? 1 : 0;  // the first action of the old plan has been executed
  set_budgets(pool, env);
  for (int32_t k = 0; k < settings_.knots; ++k)
    std::copy_n(noise_std_, action_dim_, sigma_ + sz(k) * sz(action_dim_));
  foreign_ = policy_ && planned_ && settings_.warm_start;
  const Stream first = stream_;
  try {
    if (policy_)
      out->cut = !propose(pool, env);
    else if (!settings_.warm_start)
      start_plan(centre_);
    else
      for (int32_t t = 0; t < settings_.horizon; ++t)
        std::copy_n(plan_row(t), action_dim_, centre_ + sz(t) * sz(action_dim_));
    while (!out->cut && out->iterations < settings_.iterations) {
      const Stream before = stream_;
      draw_noise();
      if (!roll_out(pool, env)) {
        stream_ = before;  // an unfinished iteration must not change the noise of the next call
        out->cut = true;
        break;
      }
      move_centre();
      ++out->iterations;
      describe_iteration(out);
      foreign_ = false;  // the last plan was a sample of this iteration: if it was good, it is the centre
    }
  } catch (...) {
    stream_ = first;
    throw;
  }
  out->steps = steps_;
}

void Planner::act(const Pool& pool, int32_t env, float* action, PlanInfo* info) {
  const FpMode mode;
  rollouts_->need_same(pool, "pool", "the planner");
  if (!pool.running(env)) fail(Code::kState, "act: no episode runs in world %d; reset it first", env);
  cancel_.check();
  if (state_dim_) recall(pool, env);
  const bool follow = planned_ && given_ && since_ + 1 < settings_.replan;
  PlanInfo out;
  if (!follow) make_plan(pool, env, &out);
  if (out.iterations > 0 || !planned_)
    std::copy_n(centre_, sz(settings_.horizon) * sz(action_dim_), plan_);
  else if (given_)
    shift_plan();
  // a plan that was not made is made in the next call
  since_ = out.iterations > 0 ? 0 : follow ? since_ + 1 : settings_.replan - 1;
  planned_ = given_ = true;
  if (state_dim_) remember(pool, env);
  std::copy_n(plan_, action_dim_, last_);
  std::copy_n(plan_, action_dim_, action);
  if (info) *info = out;
}

// The settings that must agree before a saved state can be continued.
uint64_t Planner::fingerprint() const {
  const Vector<char> lines = options_.lines();
  uint64_t hash = hash_bytes(lines.data(), lines.size() - 1);
  hash = hash_bytes(noise_std_, sz(action_dim_) * sizeof *noise_std_, hash);
  hash = hash_bytes(limit_, sz(cost_dim_) * sizeof *limit_, hash);
  for (const int32_t dim : {policy_dim_, critic_dim_})
    if (dim) hash = hash_bytes(&dim, sizeof dim, hash);
  const uint64_t layout = layout_hash(rollouts_->task());
  return hash_bytes(&layout, sizeof layout, hash);
}

void Planner::write_state(Writer& out) const {
  const HostScope scope(hooks_);
  const size_t dim = sz(action_dim_);
  out.begin_file(kMagic, kVersion);
  out.begin_section("HEAD");
  out.value(fingerprint());
  out.end_section();
  out.begin_section("PLAN");
  out.value(stream_);
  out.value(static_cast<uint8_t>(planned_));
  out.value(static_cast<uint8_t>(given_));
  out.value(since_);
  out.bytes(last_, dim * sizeof *last_);
  out.bytes(plan_, sz(settings_.horizon) * dim * sizeof *plan_);
  out.end_section();
  if (state_dim_) {
    out.begin_section("MEMO");
    out.value(seen_.episode);
    out.value(seen_.step);
    for (const float* state : {before_, after_}) out.bytes(state, sz(state_dim_) * sizeof *state);
    out.end_section();
  }
  out.end_file();
}

void Planner::read_state(const void* bytes, size_t size) {
  const HostScope scope(hooks_);
  const size_t dim = sz(action_dim_);
  Reader in(bytes, size, "planner state");
  in.begin_file(kMagic, kVersion);
  in.need_section("HEAD");
  if (in.value<uint64_t>() != fingerprint())
    fail(Code::kFormat, "planner state: it belongs to a planner with another task or other options");
  in.expect_end();
  in.need_section("PLAN");
  const auto stream = in.value<Stream>();
  const auto planned = in.value<uint8_t>(), given = in.value<uint8_t>();
  const auto since = in.value<int32_t>();
  bool good = planned <= 1 && given <= planned && since >= 0 && since < settings_.replan;
  Reader rows = in;
  for (size_t i = 0; i < (1 + sz(settings_.horizon)) * dim; ++i) good &= std::abs(rows.value<float>()) <= 1;
  rows.expect_end();
  Reader memory = in;
  Moment seen;
  if (state_dim_) {
    memory.need_section("MEMO");
    seen.episode = memory.value<uint64_t>();
    seen.step = memory.value<int32_t>();
    good &= seen.step >= -1;
    Reader states = memory;
    for (size_t i = 0; i < 2 * sz(state_dim_); ++i) good &= std::isfinite(states.value<float>());
    states.expect_end();
  }
  if (!good) fail(Code::kFormat, "planner state: a number is out of range");
  seen_ = seen;
  for (float* state : {before_, after_})
    if (state_dim_) memory.bytes(state, sz(state_dim_) * sizeof *state);
  in.bytes(last_, dim * sizeof *last_);
  in.bytes(plan_, sz(settings_.horizon) * dim * sizeof *plan_);
  stream_ = stream;
  planned_ = planned != 0;
  given_ = given != 0;
  since_ = since;
}

}  // namespace rdm
