#include "algos/rollout/rollout.hpp"

#include <cstring>

#include "base/elementary.hpp"
#include "nn/gaussian.hpp"

namespace rdm {
namespace {

// Rows of a shuffled list lie anywhere in a rollout that no cache holds, and a copy of one row ends before the
// processor has foreseen the next: so some rows are asked for ahead.
constexpr size_t kAhead = 4;
inline void fetch(const float* row, size_t n) {
  constexpr size_t kLine = 16;
  for (size_t j = 0; j < n; j += kLine) __builtin_prefetch(row + j);
}

void carve_memory(Arena& arena, const ResolvedAgentConfig& resolved, Rollout& r) {
  if (!resolved.remembers()) return;
  r.age = arena.make<int32_t>(static_cast<size_t>(resolved.samples));
  if (resolved.history > 1) {
    r.depth = resolved.history - 1, r.width = resolved.history_width;
    r.columns = resolved.history_columns.empty() ? nullptr : resolved.history_columns.data();
    r.before = arena.make<float>(resolved.num_envs() * resolved.state_dim());
  }
  if (resolved.gru.units) {
    r.path = resolved.memory_chunk(), r.units = resolved.state_units();
    const size_t count = static_cast<size_t>(r.paths()) * resolved.num_envs();
    r.state = arena.make<float>(count * static_cast<size_t>(r.units));
    r.sequence = arena.make<int32_t>(count);
  }
}

// The history of row `at`: what decisions before it saw, newest first, zeros where the memory had been cleared.
void gather_history(const Rollout& r, int32_t at, float* x) {
  const int32_t t = at / r.num_envs, env = at % r.num_envs, age = r.age[at];
  const auto width = static_cast<size_t>(r.width);
  for (int32_t j = 1; j <= r.depth; ++j, x += width) {
    if (j > age) {
      std::memset(x, 0, width * sizeof(float));
    } else if (j > t) {
      const size_t kept =
          static_cast<size_t>(env) * static_cast<size_t>(r.depth) + static_cast<size_t>(j - t - 1);
      std::memcpy(x, r.before + kept * width, width * sizeof(float));
    } else {
      const float* row = r.obs + static_cast<size_t>(at - j * r.num_envs) * r.obs_dim;
      for (size_t i = 0; i < width; ++i) x[i] = row[r.columns ? static_cast<size_t>(r.columns[i]) : i];
    }
  }
}

}  // namespace

Rollout carve_rollout(Arena& arena, const ResolvedAgentConfig& resolved) {
  Rollout r;
  r.horizon = resolved.shared.horizon;
  r.num_envs = resolved.config.num_envs;
  r.num_costs = resolved.num_limited;
  r.obs_dim = resolved.obs_dim();
  r.action_dim = resolved.action_dim();
  const auto n = static_cast<size_t>(resolved.samples), k = static_cast<size_t>(r.num_costs);
  r.obs = arena.make<float>(n * r.obs_dim);
  r.row_points = static_cast<size_t>(resolved.eyes.points);
  r.row_features = static_cast<size_t>(resolved.eyes.features());
  if (resolved.sees() && resolved.frozen) {
    r.features = arena.make<float>(n * r.row_features);
  } else if (resolved.sees()) {
    r.points = arena.make<int16_t>(n * r.row_points * 3);
    r.point_class = resolved.eyes.classes ? arena.make<uint8_t>(n * r.row_points) : nullptr;
    r.point_color = resolved.eyes.color ? arena.make<uint8_t>(n * r.row_points * 3) : nullptr;
  }
  r.action = arena.make<float>(n * r.action_dim);
  r.mean = arena.make<float>(n * r.action_dim);
  r.num_groups = resolved.num_groups();
  r.group = r.num_groups ? resolved.groups.data() : nullptr;
  r.log_prob = arena.make<float>(n * r.parts());
  r.critics = static_cast<size_t>(resolved.num_critics());
  for (float** column : {&r.reward, &r.value, &r.advantage, &r.target, &r.gain, &r.linear})
    *column = arena.make<float>(n * r.critics);
  r.discount = arena.make<float>(n);
  for (float** column : {&r.cost, &r.cost_value, &r.cost_advantage, &r.cost_target})
    *column = arena.make<float>(n * r.critics * k);
  r.valid = arena.make<uint8_t>(n);
  r.last_value = arena.make<float>(resolved.num_envs() * r.critics);
  r.last_cost_value = arena.make<float>(resolved.num_envs() * r.critics * k);
  r.std_step = resolved.state_std() ? r.action_dim : 0;
  r.log_std = arena.make<float>(resolved.state_std() ? n * r.action_dim : r.action_dim);
  r.order = arena.make<int32_t>(n);
  r.replayed = resolved.off_policy();
  r.over = arena.make<uint8_t>(r.replayed ? n : 0);
  r.final_obs = arena.make<float>(r.replayed ? n * r.obs_dim : 0);
  carve_memory(arena, resolved, r);
  return r;
}

void estimate_advantage(const Rollout& r, int32_t k, const AdvantageOptions& options, Ranks& ranks) {
  const auto critics = static_cast<int32_t>(r.critics);
  if (k < 0) {
    const int32_t v = k + critics;
    gae({r.reward + v, r.value + v, r.last_value + v, r.advantage + v, r.target + v, critics}, r.discount,
        r.valid, r.horizon, r.num_envs, options.lambda);
    if (options.standardize_reward) standardize(r.rows(), r.advantage + v, critics, true, ranks);
    return;
  }
  const int32_t width = critics * r.num_costs;
  gae({r.cost + k, r.cost_value + k, r.last_cost_value + k, r.cost_advantage + k, r.cost_target + k, width},
      r.discount, r.valid, r.horizon, r.num_envs, options.cost_lambda);
  standardize(r.rows(), r.cost_advantage + k, width, options.standardize_cost, ranks);
}

void estimate_advantages(const Rollout& r, const AdvantageOptions& options, Ranks& ranks) {
  const auto critics = static_cast<int32_t>(r.critics);
  for (int32_t k = -critics; k < critics * r.num_costs; ++k) estimate_advantage(r, k, options, ranks);
}

namespace {

float part_log_prob(const Rollout& r, size_t at, size_t part, const float* mean, const float* log_std) {
  const auto [first, count] = r.part(part);
  return gaussian_log_prob(mean + first, log_std + first, r.action + at * r.action_dim + first,
                           static_cast<int32_t>(count));
}

double ratio_of(float gain) {
  return elementary::exp(static_cast<double>(std::min(gain, 20.0f)));
}

}  // namespace

void keep_log_prob(const Rollout& r, size_t at, const float* mean, const float* log_std) {
  for (size_t g = 0; g < r.parts(); ++g)
    r.log_prob[at * r.parts() + g] = part_log_prob(r, at, g, mean, log_std);
}

double part_ratio(const Rollout& r, size_t at, size_t part, const float* mean, const float* log_std) {
  return ratio_of(part_log_prob(r, at, part, mean, log_std) - r.log_prob[at * r.parts() + part]);
}

double sample_ratio(const Rollout& r, size_t at, size_t first, size_t last, const float* mean,
                    const float* log_std) {
  float gain = 0;
  for (size_t g = first; g < last; ++g)
    gain += part_log_prob(r, at, g, mean, log_std) - r.log_prob[at * r.parts() + g];
  return ratio_of(gain);
}

double sample_kl(const Rollout& r, size_t at, size_t first, size_t last, const float* mean,
                 const float* log_std) {
  double sum = 0;
  for (size_t g = first; g < last; ++g) {
    const auto [entry, count] = r.part(g);
    sum += static_cast<double>(gaussian_kl(r.mean + at * r.action_dim + entry, r.log_std_of(at) + entry,
                                           mean + entry, log_std + entry, static_cast<int32_t>(count)));
  }
  return sum;
}

void gather_obs(const Rollout& r, const int32_t* order, int32_t stride, int32_t n, float* x) {
  const auto row = [&](size_t i) {
    return r.obs + static_cast<size_t>(order[i * static_cast<size_t>(stride)]) * r.obs_dim;
  };
  const auto rows = static_cast<size_t>(n);
  const size_t seen = r.seen_dim();
  for (size_t i = 0; i < rows; ++i) {
    if (i + kAhead < rows) fetch(row(i + kAhead), r.obs_dim);
    std::memcpy(x + i * seen, row(i), r.obs_dim * sizeof(float));
    if (r.depth) gather_history(r, order[i * static_cast<size_t>(stride)], x + i * seen + r.obs_dim);
  }
}

void expect_actions(const Rollout& r, const int32_t* order, int32_t n) {
  for (size_t i = 0; i < static_cast<size_t>(n); ++i) {
    const size_t at = static_cast<size_t>(order[i]) * r.action_dim;
    fetch(r.action + at, r.action_dim);
    fetch(r.mean + at, r.action_dim);
  }
}

void combine_advantages(const Rollout& r, const double* weights, Mix mix, bool split) {
  const auto costs = static_cast<size_t>(r.num_costs);
  double sum = 0;
  for (size_t k = 0; k < costs; ++k) sum += weights[k];
  const double total = mix == Mix::kSum ? 1 + sum : 1, share = mix == Mix::kDifference ? 1 - sum : 1;
  for (size_t i = 0; i < r.valued_rows(); ++i) {
    double cost = 0;
    for (size_t k = 0; k < costs; ++k)
      cost += weights[k] * static_cast<double>(r.cost_advantage[i * costs + k]);
    const auto reward = share * static_cast<double>(r.advantage[i]);
    r.gain[i] = static_cast<float>((split ? reward : reward - cost) / total);
    r.linear[i] = static_cast<float>(split ? -cost / total : 0);
  }
}

int32_t list_valid(const Rollout& r, int32_t first, int32_t count, int32_t at) {
  const int32_t begin = at;
  r.rows().each(first, count, [&](int32_t row) { r.order[at++] = row; });
  return at - begin;
}

}  // namespace rdm
