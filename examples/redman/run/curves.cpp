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

Series line_of(const RunData& run, const std::string& column, size_t color, size_t points) {
  Series s{color, run.column("TotalEnvSteps"), run.column(column), {}, {}};
  const size_t count = s.y.size();
  if (count <= points) return s;
  for (size_t i = 0; i < points; ++i) {
    const size_t from = i * (count - 1) / (points - 1);  // the first and the last stay
    s.x[i] = s.x[from];
    s.y[i] = s.y[from];
  }
  s.x.resize(points);
  s.y.resize(points);
  return s;
}

}  // namespace

Series curve_of(const std::vector<const RunData*>& runs, const std::string& column, size_t color,
                size_t points) {
  constexpr size_t kPoints = 120;
  if (runs.size() == 1) return line_of(*runs[0], column, color, points);
  double last = runs[0]->column("TotalEnvSteps").back();
  for (const RunData* run : runs) last = std::min(last, run->column("TotalEnvSteps").back());
  Series s;
  s.color = color;
  for (size_t i = 1; i <= std::min(kPoints, points); ++i) {
    const double x = last * static_cast<double>(i) / static_cast<double>(std::min(kPoints, points));
    double sum = 0, squares = 0, n = 0;
    for (const RunData* run : runs) {
      if (run->column(column).empty()) continue;
      const double y = interpolate(run->column("TotalEnvSteps"), run->column(column), x);
      if (!std::isfinite(y)) continue;
      sum += y;
      squares += y * y;
      n += 1;
    }
    const double mean = n > 0 ? sum / n : std::nan(""),
                 std = std::sqrt(std::max(0.0, squares / n - mean * mean) * n / (n - 1));  // NaN of one
    s.x.push_back(x);
    s.y.push_back(mean);
    s.low.push_back(mean - std);
    s.high.push_back(mean + std);
  }
  return s;
}

}  // namespace tool
