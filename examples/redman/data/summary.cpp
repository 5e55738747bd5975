#include "data/summary.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "common/statistics.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

Json quantiles_json(const std::vector<double>& values) {
  Json out = Json::array();
  for (const double share : {0.0, 0.1, 0.5, 0.9, 1.0}) out.push_back(quantile_of(values, share));
  return out;
}

double share_of(const std::vector<double>& values, double above, double most) {
  const auto count =
      std::count_if(values.begin(), values.end(), [&](double v) { return v > above && v <= most; });
  return values.empty() ? kUnknown : static_cast<double>(count) / static_cast<double>(values.size());
}

// "-" of what is not known.
std::string known_text(const Json& v, const char* how) {
  const double x = v.get<double>();
  return std::isnan(x) ? "-" : format(how, x);
}

std::string source_name(const DataSet& set, size_t index) {
  const auto names = set.metadata.find("sources");
  if (names != set.metadata.end() && names->is_array() && index < names->size() &&
      (*names)[index].is_string())
    return (*names)[index].get<std::string>();
  return "source " + std::to_string(index);
}

// The limit of column 0: what the set says, below 0 when it says none.
double first_limit(const DataSet& set) {
  const auto costs = set.metadata.find("costs");
  if (costs == set.metadata.end() || !costs->is_array() || costs->empty()) return -1;
  const auto limit = (*costs)[0].find("limit");
  return limit != (*costs)[0].end() && limit->is_number() ? limit->get<double>() : -1;
}

}  // namespace

ReturnRange return_range(const DataSet& set) {
  ReturnRange range{kUnknown, kUnknown};
  for (const DataEpisode& e : set.episodes) {
    if (!e.ended()) continue;
    const double sum = e.sum_of_rewards();
    range.least = std::fmin(range.least, sum);  // of a number and of NaN: the number
    range.most = std::fmax(range.most, sum);
  }
  return range;
}

std::vector<double> limits_of(const DataSet& set) {
  std::vector<double> out;
  if (const auto limits = set.metadata.find("limits"); limits != set.metadata.end() && limits->is_array())
    for (const Json& limit : *limits)
      if (limit.is_number()) out.push_back(limit.get<double>());
  if (out.empty())
    if (const double limit = first_limit(set); limit >= 0) out = {0.5 * limit, limit, 2 * limit};
  return out;
}

Json summary_json(const DataSet& set) {
  struct Group {
    size_t episodes = 0;
    double rows = 0, ret = 0, cost = 0;
  };
  std::map<size_t, Group> groups;
  std::vector<double> returns, costs, lengths;
  size_t ended = 0, cut = 0, success = 0;
  Json unfinished = Json::array();
  for (size_t i = 0; i < set.episodes.size(); ++i) {
    const DataEpisode& e = set.episodes[i];
    if (!e.ended()) {
      unfinished.push_back(i);
      continue;
    }
    (e.terminated.back() ? ended : cut) += 1;
    success += std::find(e.success.begin(), e.success.end(), 1) != e.success.end();
    returns.push_back(e.sum_of_rewards());
    costs.push_back(set.cost_dim ? e.sum_of_costs(0, set.cost_dim) : kUnknown);
    lengths.push_back(static_cast<double>(e.rows()));
    Group& g = groups[e.source];
    ++g.episodes;
    g.rows += lengths.back(), g.ret += returns.back(), g.cost += costs.back();
  }
  const double limit = first_limit(set);
  Json sources = Json::array();
  for (const auto& [index, g] : groups) {
    if (!set.sources) break;
    const auto n = static_cast<double>(g.episodes);
    sources.push_back({{"name", source_name(set, index)},
                       {"episodes", g.episodes},
                       {"length", g.rows / n},
                       {"return", g.ret / n},
                       {"cost", g.cost / n}});
  }
  Json out = {
      {"task", set.task},
      {"rows", set.rows()},
      {"episodes", set.episodes.size()},
      {"terminated", ended},
      {"truncated", cut},
      {"unfinished", unfinished},
      {"success_rate",
       returns.empty() ? kUnknown : static_cast<double>(success) / static_cast<double>(returns.size())},
      {"obs_dim", set.obs_dim},
      {"action_dim", set.action_dim},
      {"cost_dim", set.cost_dim},
      {"final_obs", set.finals()},
      {"length", quantiles_json(lengths)},
      {"return", quantiles_json(returns)},
      {"cost", quantiles_json(costs)},
      {"limits", limits_of(set)},
      {"cost_limit", limit < 0 ? Json() : Json(limit)},
      {"sources", sources},
      {"hash", hash_text(set)}};
  if (limit >= 0)
    out["shares"] = {{"none", share_of(costs, -1, 0)},
                     {"within", share_of(costs, 0, limit)},
                     {"to_twice", share_of(costs, limit, 2 * limit)},
                     {"above_twice", share_of(costs, 2 * limit, 1e300)}};
  return out;
}

std::string summary_text(const Json& s) {
  const auto count = [&](const char* key) { return s[key].get<unsigned long long>(); };
  std::string text = format(
      "%s: %llu rows in %llu episodes; %llu terminated, %llu cut by time, %zu unfinished\n",
      s["task"].get<std::string>().empty() ? "no task" : s["task"].get<std::string>().c_str(), count("rows"),
      count("episodes"), count("terminated"), count("truncated"), s["unfinished"].size());
  text += format("a row: %llu observations, %llu actions, %llu costs\n", count("obs_dim"),
                 count("action_dim"), count("cost_dim"));
  Table spread({"of an episode", "least", "10 %", "median", "90 %", "most"});
  for (const char* key : {"length", "return", "cost"}) {
    std::vector<std::string> row = {key};
    for (const Json& v : s[key]) row.push_back(known_text(v, "%.4g"));
    spread.add(row);
  }
  text += spread.text();
  if (const auto shares = s.find("shares"); shares != s.end()) {
    const auto percent = [&](const char* key) {
      return known_text(100 * (*shares)[key].get<double>(), "%.0f %%");
    };
    text += "episodes by cost: " + percent("none") + " without any, " + percent("within") +
            " within the limit of " + number_text(s["cost_limit"].get<double>()) + ", " +
            percent("to_twice") + " up to twice that, " + percent("above_twice") + " above\n";
  }
  if (!s["sources"].empty()) {
    Table table({"played by", "episodes", "length", "return", "cost"});
    for (const Json& r : s["sources"])
      table.add({r["name"], std::to_string(r["episodes"].get<unsigned long long>()),
                 format("%.1f", r["length"].get<double>()), format("%.4g", r["return"].get<double>()),
                 known_text(r["cost"], "%.4g")});
    text += table.text();
  }
  if (!s["unfinished"].empty()) {
    text += "unfinished episodes, which have no end:";
    for (size_t i = 0; i < s["unfinished"].size() && i < 20; ++i)
      text += format(" %llu", s["unfinished"][i].get<unsigned long long>());
    text += s["unfinished"].size() > 20 ? " ...\n" : "\n";
  }
  return text + "hash " + s["hash"].get<std::string>() + '\n';
}

}  // namespace tool
