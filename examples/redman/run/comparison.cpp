#include "run/comparison.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

namespace tool {
namespace {

constexpr const char* kCostColumn = "Metrics/EpCost";

std::string column_of(const CostOutcome& cost, bool first) {
  return first ? kCostColumn : std::string(kCostColumn) + '/' + cost.name;
}

size_t tail_of(const RunData& run) {
  return run.column("TotalEnvSteps").size() * 9 / 10;
}

// Of the last tenth, without what is no number; 0 where nothing is.
double tail_mean(const RunData& run, const std::string& column) {
  const std::vector<double>& values = run.column(column);
  double sum = 0, n = 0;
  for (size_t i = tail_of(run); i < values.size(); ++i)
    if (std::isfinite(values[i])) {
      sum += values[i];
      n += 1;
    }
  return n > 0 ? sum / n : 0;
}

std::string value_of(const FlatConfig& config, const std::string& key) {
  const auto found = config.find(key);
  return found == config.end() ? "" : found->second;
}

// "learning_rate" of "algo_cfgs.learning_rate", "limit" of that of column 0, "drop limit" of "cost_limits.drop".
std::string short_key(const std::string& key, const std::string& first_limit) {
  if (key == first_limit) return "limit";
  const std::string name = key.substr(key.find('.') + 1);
  return key.starts_with("cost_limits.") ? name + " limit" : name;
}

}  // namespace

Score Outcome::score() const {
  if (trouble.lost()) return {false, ret, std::numeric_limits<double>::infinity()};
  Score s{true, ret, 0};
  for (const CostOutcome& c : costs) {
    if (c.limit < 0) continue;
    s.feasible = s.feasible && c.mean <= c.limit;
    s.excess += std::max(0.0, c.mean - c.limit) / std::max(c.limit, 1.0);
  }
  return s;
}

std::vector<CostOutcome> cost_columns_of(const RunData& run) {
  std::vector<CostOutcome> costs;
  const std::string head = std::string(kCostColumn) + '/';
  for (const auto& [name, values] : run.columns) {
    if (name == kCostColumn) costs.insert(costs.begin(), {"cost", -1, 0});
    if (name.compare(0, head.size(), head) == 0) costs.push_back({name.substr(head.size()), -1, 0});
  }
  for (CostOutcome& c : costs) {
    const bool first = &c == costs.data();
    const std::string limit = value_of(run.config, first ? run.first_limit : "cost_limits." + c.name);
    if (!limit.empty()) c.limit = std::strtod(limit.c_str(), nullptr);
    c.mean = tail_mean(run, column_of(c, first));
  }
  return costs;
}

Outcome training_outcome(const RunData& run) {
  return {false,
          tail_mean(run, "Metrics/EpRet"),
          tail_mean(run, "Metrics/SuccessRate"),
          tail_mean(run, "Metrics/FallRate"),
          tail_mean(run, "Metrics/EpLen"),
          cost_columns_of(run),
          {}};
}

TrainingEnd training_end(const RunData& run) {
  TrainingEnd end{tail_mean(run, "Metrics/EpRet"), tail_mean(run, kCostColumn), 0, 0, 0};
  const std::vector<CostOutcome> costs = cost_columns_of(run);
  const size_t count = run.column("TotalEnvSteps").size(), first = tail_of(run);
  for (size_t i = first; i < count; ++i)
    end.over += std::any_of(costs.begin(), costs.end(), [&](const CostOutcome& c) {
      const std::vector<double>& values = run.column(column_of(c, &c == costs.data()));
      return c.limit >= 0 && i < values.size() && values[i] > c.limit;
    });
  end.over /= static_cast<double>(count - first);
  end.steps = run.column("TotalEnvSteps").back();
  if (!run.column("Time/Total").empty()) end.seconds = run.column("Time/Total").back();
  return end;
}

Outcome Configuration::mean() const {
  Outcome m = outcomes.front();
  const auto n = static_cast<double>(outcomes.size());
  const auto average = [&](auto value) {
    double sum = 0;
    for (const Outcome& o : outcomes) sum += value(o);
    return sum / n;
  };
  m.evaluated = std::all_of(outcomes.begin(), outcomes.end(), [](const Outcome& o) { return o.evaluated; });
  m.ret = average([](const Outcome& o) { return o.ret; });
  m.success = average([](const Outcome& o) { return o.success; });
  m.falls = average([](const Outcome& o) { return o.falls; });
  m.length = average([](const Outcome& o) { return o.length; });
  for (size_t k = 0; k < m.costs.size(); ++k)
    m.costs[k].mean = average([&](const Outcome& o) { return k < o.costs.size() ? o.costs[k].mean : 0; });
  m.trouble = {};
  for (const Outcome& o : outcomes) m.trouble.add(o.trouble);
  return m;
}

std::vector<Configuration> group_runs(const std::vector<const RunData*>& runs) {
  std::vector<Configuration> out;
  for (const RunData* run : runs) {
    auto found = std::find_if(out.begin(), out.end(),
                              [&](const Configuration& c) { return c.runs[0]->config == run->config; });
    if (found == out.end()) found = out.insert(out.end(), Configuration{});
    found->runs.push_back(run);
  }
  constexpr size_t kMostNamed = 3;  // differences in a label
  for (Configuration& c : out) {
    std::vector<Configuration> rivals;  // of the same algorithm
    for (const Configuration& other : out)
      if (other.runs[0]->algo == c.runs[0]->algo) rivals.push_back(other);
    c.label = c.runs[0]->algo;
    const std::string& first_limit = c.runs[0]->first_limit;
    size_t named = 0;
    for (const Difference& d : differences(rivals)) {
      const std::string value = value_of(c.runs[0]->config, d.key);
      if (value.empty() || ++named > kMostNamed) continue;
      c.label += (named == 1 ? ": " : ", ") + short_key(d.key, first_limit) + ' ' + value;
      c.limit_named |= d.key == first_limit;
    }
    if (named > kMostNamed) c.label += ", ...";
  }
  for (size_t i = 0; i < out.size(); ++i) {  // the same words for two: numbered
    size_t same = 0;
    for (size_t k = 0; k < i; ++k) same += out[k].label == out[i].label;
    if (same > 0) out[i].label += " (" + std::to_string(same + 1) + ')';
  }
  return out;
}

void rank(std::vector<Configuration>& configurations) {
  std::stable_sort(configurations.begin(), configurations.end(),
                   [](const Configuration& a, const Configuration& b) {
                     return a.mean().score().better_than(b.mean().score());
                   });
  for (size_t i = 0; i < configurations.size(); ++i) configurations[i].color = i;
}

std::vector<Difference> differences(const std::vector<Configuration>& configurations) {
  std::set<std::string> keys;
  for (const Configuration& c : configurations)
    for (const auto& [key, value] : c.runs[0]->config) keys.insert(key);
  std::vector<Difference> out;
  for (const std::string& key : keys) {
    Difference d{key, {}};
    for (const Configuration& c : configurations) d.values.push_back(value_of(c.runs[0]->config, key));
    if (std::any_of(d.values.begin(), d.values.end(), [&](const std::string& v) { return v != d.values[0]; }))
      out.push_back(d);
  }
  return out;
}

}  // namespace tool
