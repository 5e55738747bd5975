#include "run/curves.hpp"

#include <algorithm>
#include <cmath>

namespace tool {
namespace {

// y at x on the line through the points; NaN outside of them.
double interpolate(const std::vector<double>& xs, const std::vector<double>& ys, double x) {
  const auto after = std::lower_bound(xs.begin(), xs.end(), x);
  if (after == xs.end()) return std::nan("");
  const auto i = static_cast<size_t>(after - xs.begin());
  if (xs[i] == x || i == 0) return xs[i] == x ? ys[i] : std::nan("");
  return ys[i - 1] + (ys[i] - ys[i - 1]) * (x - xs[i - 1]) / (xs[i] - xs[i - 1]);
}

// The mean of the rows in (from, to], or the line between rows where none lies there: an epoch by itself is noise.
double mean_between(const std::vector<double>& xs, const std::vector<double>& ys, double from, double to) {
  double sum = 0, n = 0;
  for (auto x = std::upper_bound(xs.begin(), xs.end(), from); x != xs.end() && *x <= to; ++x) {
    const double y = ys[static_cast<size_t>(x - xs.begin())];
    if (!std::isfinite(y)) continue;
    sum += y;
    n += 1;
  }
  return n > 0 ? sum / n : interpolate(xs, ys, to);
}

}  // namespace

Series curve_of(const std::vector<const RunData*>& runs, const std::string& column, size_t color,
                size_t points) {
  Series s{color, runs[0]->column("TotalEnvSteps"), runs[0]->column(column), {}, {}};
  const bool alone = runs.size() == 1;
  if (alone && s.y.size() <= points) return s;
  double last = s.x.back();
  for (const RunData* run : runs) last = std::min(last, run->column("TotalEnvSteps").back());
  s.x.clear();
  s.y.clear();
  for (size_t i = 0; i < points; ++i) {
    const double step = last / static_cast<double>(points), from = static_cast<double>(i) * step;
    const double to = i + 1 < points ? from + step : last;
    double sum = 0, squares = 0, n = 0;
    for (const RunData* run : runs) {
      if (run->column(column).empty()) continue;
      const double y = mean_between(run->column("TotalEnvSteps"), run->column(column), from, to);
      if (!std::isfinite(y)) continue;
      sum += y;
      squares += y * y;
      n += 1;
    }
    const double mean = n > 0 ? sum / n : std::nan(""),
                 std = std::sqrt(std::max(0.0, squares / n - mean * mean) * n / (n - 1));  // NaN of one
    s.x.push_back(to);
    s.y.push_back(mean);
    if (alone) continue;
    s.low.push_back(mean - std);
    s.high.push_back(mean + std);
  }
  return s;
}

}  // namespace tool
