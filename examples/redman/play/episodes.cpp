#include "play/episodes.hpp"

#include <algorithm>
#include <cmath>
#include <tuple>

namespace tool {
namespace {

// Mean and standard deviation of value(episode).
template <class Value>
std::pair<double, double> spread(const std::vector<Episode>& episodes, Value value) {
  if (episodes.empty()) return {std::nan(""), std::nan("")};
  double sum = 0, squares = 0;
  for (const Episode& e : episodes) sum += value(e);
  const double mean = sum / static_cast<double>(episodes.size());
  for (const Episode& e : episodes) squares += (value(e) - mean) * (value(e) - mean);
  return {mean, std::sqrt(squares / static_cast<double>(episodes.size()))};
}

// Of the mean, from the deviation of the population of so many.
double standard_error(double deviation, size_t count) {
  return count > 1 ? deviation / std::sqrt(static_cast<double>(count - 1)) : std::nan("");
}

template <class Row>
void add_magnitudes(const Row& raw, std::vector<double>& sums) {
  sums.resize(raw.size());
  for (size_t k = 0; k < sums.size(); ++k) sums[k] += std::max(static_cast<double>(raw[k]), 0.0);
}

}  // namespace

std::vector<Episode> play_episodes(redman::Pool& pool, Actor& actor, size_t count, const StepObserver& after,
                                   const StepObserver& before, bool magnitudes) {
  const size_t n = pool.num_envs();
  std::vector<Episode> episodes(count);
  std::vector<uint8_t> playing(n), ended(n);
  std::vector<size_t> episode(n);
  for (size_t i = 0; i < n; ++i) {
    episode[i] = i;
    playing[i] = i < count;
  }
  const auto any = [](const std::vector<uint8_t>& mask) {
    return std::find(mask.begin(), mask.end(), 1) != mask.end();
  };
  const auto note_starts = [&](const std::vector<uint8_t>& begun) {
    for (size_t i = 0; i < n; ++i)
      if (begun[i]) episodes[episode[i]].trouble.add(pool.status()[i]);
  };
  note_starts(playing);
  actor.restart();
  while (any(playing)) {
    actor.act(pool, playing.data());
    for (size_t i = 0; before && i < n; ++i)
      if (playing[i]) before(i, episode[i]);
    actor.step(pool, playing.data());
    for (size_t i = 0; i < n; ++i) {
      ended[i] = 0;
      if (!playing[i]) continue;
      Episode& e = episodes[episode[i]];
      e.success_steps += pool.success()[i] != 0;
      e.trouble.add(pool.status()[i]);
      if (magnitudes) add_magnitudes(pool.cost_raw()[i], e.cost);
      if (after) after(i, episode[i]);
      if (!pool.terminated()[i] && !pool.truncated()[i]) continue;
      e.ret = static_cast<double>(pool.episode_return()[i]);
      if (!magnitudes) e.cost.assign(pool.episode_cost()[i].begin(), pool.episode_cost()[i].end());
      e.length = pool.buffers().episode_step[i];
      e.terminated = pool.terminated()[i] != 0;
      episode[i] += n;
      playing[i] = ended[i] = episode[i] < count;
    }
    if (!any(ended)) continue;
    pool.reset(nullptr, ended.data());
    note_starts(ended);
    actor.restart(ended.data());
  }
  return episodes;
}

Summary summarise(const std::vector<Episode>& all, const std::vector<double>& limits) {
  Summary s;
  if (all.empty()) return s;
  std::vector<Episode> episodes;  // those that are measurements
  for (const Episode& e : all) {
    s.trouble.add(e.trouble);
    if (!e.trouble.lost()) episodes.push_back(e);
  }
  std::tie(s.return_mean, s.return_std) = spread(episodes, [](const Episode& e) { return e.ret; });
  s.return_stderr = standard_error(s.return_std, episodes.size());
  s.length_mean = spread(episodes, [](const Episode& e) { return e.length; }).first;
  s.fall_rate = spread(episodes, [](const Episode& e) { return e.terminated ? 1 : 0; }).first;
  s.success_rate =
      spread(all, [](const Episode& e) { return e.success_steps > 0 && !e.trouble.lost() ? 1 : 0; }).first;
  s.success_steps = spread(episodes, [](const Episode& e) { return e.success_steps; }).first;
  for (size_t k = 0; k < limits.size(); ++k) {
    const auto [mean, std] = spread(episodes, [k](const Episode& e) { return e.cost[k]; });
    s.cost_mean.push_back(mean);
    s.cost_std.push_back(std);
    s.cost_stderr.push_back(standard_error(std, episodes.size()));
  }
  s.violation_rate = spread(all, [&](const Episode& e) {
                       if (e.trouble.lost()) return 1;
                       for (size_t k = 0; k < limits.size(); ++k)
                         if (limits[k] >= 0 && e.cost[k] > limits[k]) return 1;
                       return 0;
                     }).first;
  if (!s.cost_mean.empty()) s.cost_per_step = s.cost_mean[0] / s.length_mean;
  return s;
}

bool feasible(const Summary& summary, const std::vector<double>& limits) {
  if (summary.trouble.lost()) return false;
  for (size_t k = 0; k < limits.size(); ++k)
    if (limits[k] >= 0 && summary.cost_mean[k] > limits[k]) return false;
  return true;
}

}  // namespace tool
