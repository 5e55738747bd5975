#include "run/seeds.hpp"

#include <algorithm>
#include <cmath>

namespace tool {
namespace {

Sample returns_of(const Configuration& c) {
  Sample out;
  for (const Outcome& o : c.outcomes) out.push_back(o.ret);
  return out;
}

// Of the runs of PPO that nothing holds back; NaN without any.
double unconstrained_return(const std::vector<Configuration>& configurations) {
  Sample all;
  for (const Configuration& c : configurations) {
    const RunData& run = *c.runs[0];
    if (run.algo != "ppo" || run.config.count("train_cfgs.shield")) continue;
    const Sample returns = returns_of(c);
    all.insert(all.end(), returns.begin(), returns.end());
  }
  return mean_of(all);
}

// Of column 0 per control step, in all episodes of a training. A row of the curve has means of the last 100:
// from the last row backwards each speaks for those since the row that is 100 or more before it.
double cost_rate(const RunData& run) {
  constexpr double kWindow = 100;
  const std::vector<double>&episodes = run.column("Metrics/Episodes"), &costs = run.column("Metrics/EpCost"),
        &lengths = run.column("Metrics/EpLen");
  if (episodes.empty() || costs.empty() || lengths.empty()) return std::nan("");
  double cost = 0, steps = 0;
  for (size_t i = episodes.size(); i-- > 0;) {
    size_t before = i;
    while (before > 0 && episodes[before] > episodes[i] - kWindow) --before;
    const bool first = !(episodes[before] <= episodes[i] - kWindow);
    const double count = episodes[i] - (first ? 0 : episodes[before]);
    if (count > 0) {  // a row before the first episode has no numbers
      cost += count * costs[i];
      steps += count * lengths[i];
    }
    if (first) break;
    i = before + 1;
  }
  return cost / steps;
}

double total(const std::vector<double>& values) {
  double sum = values.empty() ? std::nan("") : 0;
  for (const double v : values) sum += v;
  return sum;
}

// Of one configuration, without what others say of it.
Seeds alone(const Configuration& c) {
  const Sample returns = returns_of(c);
  Seeds out{mean_of(returns),
            deviation_of(returns),
            iqm_of(returns),
            iqm_interval({returns}),
            std::nan(""),
            {},
            {},
            0,
            0,
            ""};
  Sample rates, violations;
  for (const RunData* run : c.runs) {
    rates.push_back(cost_rate(*run));
    violations.push_back(total(run->column("Metrics/Violations")));
  }
  out.training_cost_rate = mean_of(rates);
  out.training_violating_steps = mean_of(violations);
  const Outcome mean = c.mean();
  for (size_t k = 0; k < mean.costs.size(); ++k) {
    Sample costs;
    for (const Outcome& o : c.outcomes) costs.push_back(k < o.costs.size() ? o.costs[k].mean : std::nan(""));
    out.cost_sd.push_back(deviation_of(costs));
    const double limit = mean.costs[k].limit;
    out.cost_ratio.push_back(limit > 0 ? mean.costs[k].mean / limit : std::nan(""));
  }
  return out;
}

}  // namespace

std::vector<Seeds> seeds_of(const std::vector<Configuration>& configurations) {
  std::vector<Seeds> out;
  std::vector<Strata> returns;
  for (const Configuration& c : configurations) {
    out.push_back(alone(c));
    returns.push_back({returns_of(c)});
  }
  const double free = unconstrained_return(configurations);
  // letters are to begin with the most return, whatever the order of the rows
  std::vector<size_t> order(out.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  const auto place = [&](size_t i) { return std::isnan(out[i].return_iqm) ? -HUGE_VAL : out[i].return_iqm; };
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return place(a) > place(b); });
  std::vector<Strata> sorted;
  for (const size_t i : order) sorted.push_back(returns[i]);
  const std::vector<std::string> groups = group_letters(sorted);
  for (size_t i = 0; i < order.size(); ++i) out[order[i]].group = groups[i];
  for (Seeds& s : out)
    if (free > 0) s.normalised_return = s.return_mean / free;
  return out;
}

}  // namespace tool
