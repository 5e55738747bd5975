#include "algos/policy_gradient.hpp"

#include <cmath>
#include <cstring>

#include "algos/registry.hpp"
#include "base/error.hpp"
#include "base/fpmode.hpp"

namespace rdm {

void Agent::check_cancel() {
  if (cancelled_.exchange(false, std::memory_order_relaxed)) fail(Code::kCancelled, "cancelled by the host");
}

void PolicyGradient::carve(Arena& arena) {
  const size_t envs = plan_.num_envs();
  nets_ = carve_networks(arena, plan_);
  rollout_ = carve_rollout(arena, plan_);
  normalizer_ = carve_normalizer(arena, plan_.config.obs_dim);
  noise_.carve(arena, plan_);
  const Options& o = plan_.options;
  episodes_.carve(arena, plan_.config.num_envs, plan_.config.cost_dim,
                  o.knows("multiplier_window") ? o.integer("multiplier_window") : kStatsWindow);
  lanes_ = arena.make<Lane>(static_cast<size_t>(plan_.lanes));
  for (int32_t i = 0; i < plan_.lanes; ++i) {
    const Lane lane = carve_lane(arena, plan_, nets_.size);
    if (lanes_) lanes_[i] = lane;
  }
  grad_ = arena.make<float>(nets_.size);
  log_std_ = arena.make<float>(plan_.action_dim());
  old_log_std_ = arena.make<float>(plan_.action_dim());
  std_ = arena.make<float>(plan_.action_dim());
  final_value_ = arena.make<float>(envs);
  final_cost_ = arena.make<float>(envs * static_cast<size_t>(plan_.num_limited));
  listed_ = arena.make<int32_t>(envs);
  int32_t tensors = 1;
  for (int32_t i = 0; i < nets_.count; ++i) tensors += 2 * nets_.shape[i].num_layers();
  names_ = static_cast<char(*)[kTensorNameSize]>(
      static_cast<void*>(arena.make<char>(static_cast<size_t>(tensors) * kTensorNameSize)));
}

void PolicyGradient::open(const AgentConfig& config) {
  Arena measure;
  carve(measure);
  arena_ = Arena(config.hooks, measure.used());
  carve(arena_);
  workers_.emplace(config.hooks, config.num_threads);
  const Options& o = plan_.options;
  normalize_ = o.flag("normalize_obs");
  normalizer_.clip = static_cast<float>(o.number("obs_clip"));
  learn_std_ = o.flag("learn_std");
  terminal_cost_ = o.flag("terminal_cost");
  discount_ = o.number("discount");
  advantage_ = {o.number("lambda"), o.number("cost_lambda"), o.flag("standardize_reward_adv"),
                std::strcmp(o.text("scale_cost_adv"), "std") == 0};
  schedule_.reset(o);
  read_live();
  shuffle_ = Stream(config.seed, 0, Purpose::kMinibatch);
  noise_.reset(config.seed);
  init_networks(nets_, plan_);
  clamp_log_std(nets_, o);
  plan_.config.task = plan_.task;
  plan_.config.defaults = plan_.config.options = nullptr;
  plan_.config.initial_mean = nullptr;
  plan_.config.cost_limits = nullptr;
}

void PolicyGradient::read_live() {
  const Options& o = plan_.options;
  live_.critic_rate = o.number("critic_learning_rate");
  if (live_.critic_rate == 0) live_.critic_rate = o.number("learning_rate");
  live_.entropy = o.number("entropy");
  live_.max_grad_norm = o.number("max_grad_norm");
  live_.critic_l2 = o.number("critic_l2");
  live_.early_stop_kl = o.number("early_stop_kl");
  schedule_.read_live(o);
  if (plan_.num_limited > 0 && plan_.column[0] == 0) plan_.limit[0] = o.number("cost_limit");
}

void PolicyGradient::set_option(const OptionInput& option) {
  if (!option.key) fail(Code::kArgument, "agent option: the key is NULL");
  Options& o = plan_.options;
  for (int32_t i = 0; i < o.count(); ++i)
    if (same_name(o.spec(i).key, option.key) && !o.spec(i).live)
      fail(Code::kState, "agent option %s: fixed at creation", o.spec(i).key);
  if (same_name(option.key, "cost_limit")) {
    const double before = o.number("cost_limit");
    o.set(option, "agent");
    if ((before < 0) != (o.number("cost_limit") < 0)) {
      o.set({option.key, nullptr, before}, "agent");
      fail(Code::kState, "agent option cost_limit: column 0 was created %s a limit",
           before < 0 ? "without" : "with");
    }
  }
  o.set(option, "agent");
  read_live();
}

void PolicyGradient::drop_horizon() {
  rollout_.filled = 0;
  pending_ = false;
}

void PolicyGradient::begin_epoch(const EpisodeStats&, int32_t) {
  const auto n = static_cast<size_t>(rollout_.samples());
  std::memcpy(rollout_.gain, rollout_.advantage, n * sizeof(float));
  std::memset(rollout_.linear, 0, n * sizeof(float));
}

void PolicyGradient::update(const float* last_obs, Epoch* out) {
  const FpMode mode;
  if (missing() > 0) fail(Code::kState, "update: %d decisions are missing in this horizon", missing());
  if (!last_obs) fail(Code::kArgument, "last_obs: NULL");
  check_rows("last_obs", last_obs, nullptr, plan_.config.num_envs, plan_.obs_dim());
  try {
    check_cancel();
    estimate(last_obs);
    const EpisodeStats stats = episodes_.stats();
    begin_epoch(stats, epoch_ + 1);
    learned_ = Learned();
    const double rate = schedule_.rate(epoch_);
    learn();
    schedule_.adapt(learned_.mean_kl);
    episodes_.mark();
    ++epoch_;
    if (out) fill_epoch(stats, rate, out);
  } catch (...) {
    drop_horizon();
    throw;
  }
  drop_horizon();
}

// Values after the horizon, then both kinds of advantage.
void PolicyGradient::estimate(const float* last_obs) {
  const int32_t envs = plan_.config.num_envs;
  sweep(
      *workers_, plan_.lanes, num_pieces(envs),
      [&](int32_t l, int32_t piece) {
        const Lane& lane = lanes_[l];
        const int32_t first = piece * kPieceRows, rows = std::min(kPieceRows, envs - first);
        const auto at = static_cast<size_t>(first);
        const float* x = normalized(last_obs + at * plan_.obs_dim(), rows, lane.obs);
        forward_critics(lane, x, rows, rollout_.last_value + at,
                        rollout_.last_cost_value + at * static_cast<size_t>(plan_.num_limited));
      },
      [](int32_t, int32_t) {});
  estimate_advantages(rollout_, advantage_);
  valid_rows_ = list_valid(rollout_);
}

void PolicyGradient::fill_epoch(const EpisodeStats& stats, double rate, Epoch* out) const {
  Epoch e;
  e.epoch = epoch_;
  e.env_steps = env_steps_;
  e.episodes = stats.finished;
  e.ret = stats.ret;
  for (int32_t k = 0; k < plan_.config.cost_dim; ++k) e.cost[k] = stats.cost[k];
  e.cost_per_step = stats.cost_per_step;
  e.length = stats.length;
  e.fall_rate = stats.fall_rate;
  e.success_rate = stats.success_rate;
  for (int32_t i = 0; i < plan_.num_limited; ++i) e.multiplier[plan_.column[i]] = cost_weight(i);
  e.kl = learned_.pass_kl;
  e.learning_rate = rate;
  const float* log_std = nets_.log_std();
  double sum = 0, entropy = 0;
  for (int32_t j = 0; j < plan_.config.action_dim; ++j) {
    sum += std::exp(static_cast<double>(log_std[j]));
    entropy += static_cast<double>(log_std[j] + noise_.log_share()) + 1.4189385332046727;
  }
  e.action_std = sum / plan_.config.action_dim;
  e.entropy = entropy;
  e.loss_policy = learned_.loss_policy;
  e.loss_reward_value = learned_.loss_reward;
  e.loss_cost_value = learned_.loss_cost;
  e.clip_fraction = learned_.clip_fraction;
  e.value_reward = masked_mean(rollout_.value, 1, rollout_.valid, rollout_.samples());
  if (plan_.num_limited > 0)
    e.value_cost = masked_mean(rollout_.cost_value, plan_.num_limited, rollout_.valid, rollout_.samples());
  e.passes = learned_.passes;
  *out = e;
}

bool PolicyGradient::tensor(int32_t index, TensorInfo* out) {
  char name[kTensorNameSize];
  if (!find_tensor(nets_, index, name, out)) return false;
  std::memcpy(names_[index], name, sizeof name);
  out->name = names_[index];
  return true;
}

}  // namespace rdm
