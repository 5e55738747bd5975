#include "play/spread.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include "common/text.hpp"

namespace tool {
namespace {

// Of the mean of each column; the columns are of the same episodes.
std::vector<Interval> mean_intervals(const std::vector<Sample>& columns) {
  constexpr double kNormal = 1.959963984540054;  // of 95 %
  const size_t count = columns[0].size();
  std::vector<Interval> out;
  if (count > kMostResampled) {
    for (const Sample& values : columns) {
      const double half = kNormal * standard_error_of(values), mean = mean_of(values);
      out.push_back({mean - half, mean + half});
    }
  } else if (count > 1) {
    out = bootstrap({count}, columns.size(), [&](const Draw& rows, double* means) {
      for (size_t k = 0; k < columns.size(); ++k) {
        double sum = 0;
        for (size_t i = 0; i < count; ++i) sum += columns[k][rows[0][i]];
        means[k] = sum / static_cast<double>(count);
      }
    });
  }
  const double none = std::nan("");
  out.resize(columns.size(), {none, none});
  for (size_t k = 0; k < columns.size(); ++k)
    if (!(deviation_of(columns[k]) > 0)) out[k] = {none, none};
  return out;
}

template <class Quantiles>
std::vector<double> quantiles_of(const Sample& values, const Quantiles& at) {
  std::vector<double> out;
  for (const double q : at) out.push_back(quantile_of(values, q));
  return out;
}

}  // namespace

Spread spread_of(const std::vector<Episode>& episodes, const std::vector<double>& limits) {
  std::vector<Sample> columns(1 + limits.size());  // returns, then each cost
  Sample successes;
  size_t lost = 0;
  for (const Episode& e : episodes) {
    successes.push_back(e.success_steps > 0 && !e.trouble.lost() ? 1 : 0);
    if (e.trouble.lost()) {
      ++lost;
      continue;
    }
    columns[0].push_back(e.ret);
    for (size_t k = 0; k < limits.size(); ++k) columns[1 + k].push_back(e.cost[k]);
  }
  const std::vector<Interval> intervals = mean_intervals(columns);
  Spread out{iqm_of(columns[0]),
             standard_error_of(successes),
             intervals[0],
             quantiles_of(columns[0], kReturnQuantiles),
             {}};
  for (size_t k = 0; k < limits.size(); ++k) {
    const Sample& values = columns[1 + k];
    const auto over = std::count_if(values.begin(), values.end(), [&](double c) { return c > limits[k]; });
    const double share =
        static_cast<double>(static_cast<size_t>(over) + lost) / static_cast<double>(episodes.size());
    out.costs.push_back({intervals[1 + k], quantiles_of(values, kCostQuantiles), cvar_of(values),
                         limits[k] < 0 ? std::nan("") : share});
  }
  return out;
}

std::vector<std::string> remarks_of(const Summary& s, const Spread& spread, const std::vector<double>& limits,
                                    const std::vector<std::string>& costs, int32_t episodes) {
  std::vector<std::string> out;
  if (std::isnan(s.return_mean)) return {"no episode could be measured"};
  if (std::isnan(s.return_stderr))
    return {"one episode has no standard error and no interval: --episodes 100"};
  std::string same;
  const auto note = [&](const std::string& name, const Interval& i) {
    if (!i.known()) same += (same.empty() ? "" : ", ") + name;
  };
  note("return", spread.return_interval);
  for (size_t k = 0; k < costs.size(); ++k) note(costs[k], spread.costs[k].interval);
  if (!same.empty()) out.push_back("the same in every episode, so without an interval: " + same);
  for (size_t k = 0; k < costs.size(); ++k)
    if (limits[k] >= 0 && s.cost_std[k] > limits[k] && episodes < kManyEpisodes)
      out.push_back(
          format("the deviation of %s, %.4g, is above its limit, %s: its mean is known to +- %s; use "
                 "--episodes %d for more precision",
                 costs[k].c_str(), s.cost_std[k], number_text(limits[k]).c_str(),
                 error_text(s.cost_stderr[k]).c_str(), kManyEpisodes));
  return out;
}

std::string measured(double mean, double error) {
  return std::isnan(error) ? format("%.3f", mean) : format("%.3f +- ", mean) + error_text(error);
}

void put_spread(Json& json, const Spread& s) {
  json["success_stderr"] = s.success_stderr;
  json["return_iqm"] = s.return_iqm;
  json["interval_level"] = kLevel;
  json["interval"] = interval_json(s.return_interval);
  Json intervals = Json::array(), cvars = Json::array(), over = Json::array(), of_return = Json::object(),
       of_costs = Json::object();
  for (const Spread::Cost& c : s.costs) {
    intervals.push_back(interval_json(c.interval));
    cvars.push_back(c.cvar);
    over.push_back(c.over);
  }
  for (size_t q = 0; q < s.return_quantiles.size(); ++q)
    of_return[number_text(kReturnQuantiles[q])] = s.return_quantiles[q];
  for (size_t q = 0; q < std::size(kCostQuantiles); ++q) {
    Json& each = of_costs[number_text(kCostQuantiles[q])] = Json::array();
    for (const Spread::Cost& c : s.costs) each.push_back(c.quantiles[q]);
  }
  json["return_quantiles"] = of_return;
  json["cost_interval"] = intervals;
  json["cost_quantiles"] = of_costs;
  json["cost_cvar"] = cvars;
  json["cvar_share"] = kTailShare;
  json["cost_over_rate"] = over;
}

}  // namespace tool
