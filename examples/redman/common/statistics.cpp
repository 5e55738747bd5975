#include "common/statistics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "common/text.hpp"

namespace tool {
namespace {

constexpr size_t kResamples = 10'000;
constexpr size_t kDrawnTogether = size_t{1} << 17;  // rows, as Python does; a stratum's come in one piece

// `count` numbers below `size`, as numpy's RandomState.randint draws them: what is masked and too large is
// drawn again.
void draw_rows(std::mt19937& random, size_t size, size_t count, uint32_t* out) {
  const auto most = static_cast<uint32_t>(size - 1);
  uint32_t mask = most;
  for (const int shift : {1, 2, 4, 8, 16}) mask |= mask >> shift;
  for (size_t i = 0; i < count; ++i) {
    uint32_t row = 0;
    while (most > 0 && (row = static_cast<uint32_t>(random()) & mask) > most) {
    }
    out[i] = row;
  }
}

double at_quantile(const Sample& sorted, double at) {
  const double place = at * static_cast<double>(sorted.size() - 1);
  const auto below = std::min(static_cast<size_t>(place), sorted.size() - 1);
  const double part = place - static_cast<double>(below);
  return part > 0 ? sorted[below] + part * (sorted[below + 1] - sorted[below]) : sorted[below];
}

double iqm_of_sorted(Sample& values) {
  std::sort(values.begin(), values.end());
  const size_t cut = values.size() / 4, count = values.size() - 2 * cut;
  double sum = 0;
  for (size_t i = cut; i < cut + count; ++i) sum += values[i];
  return sum / static_cast<double>(count);
}

Sample pooled(const Strata& strata) {
  Sample out;
  for (const Sample& s : strata) out.insert(out.end(), s.begin(), s.end());
  return out;
}

bool finite(const Sample& values) {
  return std::all_of(values.begin(), values.end(), [](double v) { return std::isfinite(v); });
}

// Whether there is an interval.
bool several_each(const Strata& strata) {
  return !strata.empty() &&
         std::all_of(strata.begin(), strata.end(), [](const Sample& s) { return s.size() > 1 && finite(s); });
}

std::vector<size_t> sizes_of(const Strata& a, const Strata& b = {}) {
  std::vector<size_t> out;
  for (const Strata* strata : {&a, &b})
    for (const Sample& s : *strata) out.push_back(s.size());
  return out;
}

// The interquartile mean of rows that were drawn from the strata, whose first has number `first`.
double iqm_of_drawn(const Strata& strata, const Draw& rows, size_t first, Sample& room) {
  room.clear();
  for (size_t s = 0; s < strata.size(); ++s)
    for (size_t i = 0; i < strata[s].size(); ++i) room.push_back(strata[s][rows[first + s][i]]);
  return iqm_of_sorted(room);
}

constexpr Interval kNoInterval{std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::quiet_NaN()};

}  // namespace

std::string interval_text(const Interval& i) {
  return i.known() ? format("%.4g .. %.4g", i.low, i.high) : "-";
}

Json interval_json(const Interval& i) {
  return Json::array({i.low, i.high});
}

double mean_of(const Sample& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

double quantile_of(Sample values, double at) {
  if (values.empty() || !finite(values)) return std::nan("");
  std::sort(values.begin(), values.end());
  return at_quantile(values, at);
}

double iqm_of(Sample values) {
  return values.empty() || !finite(values) ? std::nan("") : iqm_of_sorted(values);
}

double iqm_of(const Strata& strata) {
  return iqm_of(pooled(strata));
}

double cvar_of(Sample values, double share) {
  if (values.empty() || !finite(values)) return std::nan("");
  std::sort(values.begin(), values.end(), std::greater<>());
  const double count = share * static_cast<double>(values.size());
  double sum = 0, left = count;
  for (size_t i = 0; i < values.size() && left > 0; ++i, left -= 1) sum += std::min(left, 1.0) * values[i];
  return count < 1 ? values[0] : sum / count;
}

double deviation_of(const Sample& values) {
  if (values.size() < 2) return std::nan("");
  const double mean = mean_of(values);
  double squares = 0;
  for (const double v : values) squares += (v - mean) * (v - mean);
  return std::sqrt(squares / static_cast<double>(values.size() - 1));
}

double standard_error_of(const Sample& values) {
  return deviation_of(values) / std::sqrt(static_cast<double>(values.size()));
}

std::vector<Interval> bootstrap(const std::vector<size_t>& sizes, size_t numbers, const Statistic& statistic,
                                double level) {
  const size_t all = std::accumulate(sizes.begin(), sizes.end(), size_t{0});
  const size_t together = std::clamp<size_t>(kDrawnTogether / all, 1, kResamples);
  std::mt19937 random(0);
  std::vector<uint32_t> drawn(together * all);
  std::vector<Sample> found(numbers);
  Sample out(numbers);
  Draw rows(sizes.size());
  for (size_t first = 0; first < kResamples; first += together) {
    const size_t count = std::min(together, kResamples - first);
    uint32_t* at = drawn.data();
    for (const size_t size : sizes) {
      draw_rows(random, size, count * size, at);
      at += count * size;
    }
    for (size_t i = 0; i < count; ++i) {
      at = drawn.data();
      for (size_t s = 0; s < sizes.size(); ++s) {
        rows[s] = at + i * sizes[s];
        at += count * sizes[s];
      }
      statistic(rows, out.data());
      for (size_t k = 0; k < numbers; ++k) found[k].push_back(out[k]);
    }
  }
  std::vector<Interval> ends;
  for (Sample& of_one : found) {
    std::sort(of_one.begin(), of_one.end());
    ends.push_back({at_quantile(of_one, (1 - level) / 2), at_quantile(of_one, (1 + level) / 2)});
  }
  return ends;
}

Interval iqm_interval(const Strata& runs, double level) {
  if (!several_each(runs)) return kNoInterval;
  Sample room;
  return bootstrap(
      sizes_of(runs), 1, [&](const Draw& rows, double* out) { *out = iqm_of_drawn(runs, rows, 0, room); },
      level)[0];
}

Interval difference_interval(const Strata& a, const Strata& b, double level) {
  if (!several_each(a) || !several_each(b)) return kNoInterval;
  Sample room;
  return bootstrap(
      sizes_of(a, b), 1,
      [&](const Draw& rows, double* out) {
        *out = iqm_of_drawn(a, rows, 0, room) - iqm_of_drawn(b, rows, a.size(), room);
      },
      level)[0];
}

Improvement improvement_of(const Strata& a, const Strata& b, double level) {
  const auto won = [&](size_t task, size_t i, size_t j) {
    return a[task][i] > b[task][j] ? 1.0 : a[task][i] < b[task][j] ? 0.0 : 0.5;
  };
  // mean over tasks of the share of pairs that a wins; row_a and row_b give the runs
  const auto share = [&](auto row_a, auto row_b) {
    double sum = 0;
    for (size_t t = 0; t < a.size(); ++t) {
      double wins = 0;
      for (size_t i = 0; i < a[t].size(); ++i)
        for (size_t j = 0; j < b[t].size(); ++j) wins += won(t, row_a(t, i), row_b(t, j));
      sum += wins / static_cast<double>(a[t].size() * b[t].size());
    }
    return sum / static_cast<double>(a.size());
  };
  const auto itself = [](size_t, size_t i) { return i; };
  Improvement out{share(itself, itself), kNoInterval};
  if (!several_each(a) || !several_each(b)) return out;
  out.interval = bootstrap(
      sizes_of(a, b), 1,
      [&](const Draw& rows, double* of_draw) {
        *of_draw = share([&](size_t t, size_t i) { return size_t{rows[t][i]}; },
                         [&](size_t t, size_t j) { return size_t{rows[a.size() + t][j]}; });
      },
      level)[0];
  return out;
}

std::vector<std::string> group_letters(size_t count, const std::function<bool(size_t, size_t)>& apart) {
  constexpr size_t kMostGroups = 1000;
  std::vector<std::string> letters(count);
  if (count == 0 || count > kMostGrouped) return letters;
  // All in one; a group that holds two that are told apart becomes two, without the one and without the
  // other; what is part of another group goes.
  std::vector<std::vector<bool>> groups{std::vector<bool>(count, true)};
  const auto within = [](const std::vector<bool>& part, const std::vector<bool>& whole) {
    for (size_t i = 0; i < part.size(); ++i)
      if (part[i] && !whole[i]) return false;
    return true;
  };
  for (size_t i = 0; i < count; ++i)
    for (size_t j = i + 1; j < count; ++j) {
      if (!apart(i, j)) continue;
      std::vector<std::vector<bool>> kept, split;
      for (std::vector<bool>& group : groups) {
        if (!group[i] || !group[j]) {
          kept.push_back(std::move(group));
          continue;
        }
        split.push_back(group);
        split.back()[j] = false;
        group[i] = false;
        split.push_back(std::move(group));
      }
      const auto size = [](const std::vector<bool>& g) { return std::count(g.begin(), g.end(), true); };
      std::stable_sort(split.begin(), split.end(),
                       [&](const auto& x, const auto& y) { return size(x) > size(y); });
      for (std::vector<bool>& group : split)
        if (std::none_of(kept.begin(), kept.end(), [&](const auto& other) { return within(group, other); }))
          kept.push_back(std::move(group));
      groups = std::move(kept);
      if (groups.size() > kMostGroups) return letters;
    }
  std::sort(groups.begin(), groups.end(), std::greater<>());
  for (size_t g = 0; g < groups.size(); ++g)
    for (size_t i = 0; i < count; ++i)
      if (groups[g][i])
        letters[i] += g < 26 ? std::string(1, static_cast<char>('a' + g)) : '(' + std::to_string(g + 1) + ')';
  return letters;
}

std::vector<std::string> group_letters(const std::vector<Strata>& rows, double level) {
  return group_letters(rows,
                       [&](size_t i, size_t j) { return difference_interval(rows[i], rows[j], level); });
}

std::vector<std::string> group_letters(const std::vector<Strata>& rows,
                                       const std::function<Interval(size_t, size_t)>& difference) {
  std::vector<size_t> known;  // rows that have an interval
  for (size_t i = 0; i < rows.size(); ++i)
    if (several_each(rows[i])) known.push_back(i);
  const std::vector<std::string> of_known =
      group_letters(known.size(), [&](size_t i, size_t j) { return !difference(known[i], known[j]).has(0); });
  std::vector<std::string> letters(rows.size());
  for (size_t k = 0; k < known.size(); ++k) letters[known[k]] = of_known[k];
  return letters;
}

}  // namespace tool
