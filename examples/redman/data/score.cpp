#include "data/score.hpp"

#include "common/names.hpp"
#include "common/text.hpp"
#include "data/summary.hpp"

namespace tool {

void need_same_worlds(const DataSet& set, const std::string& file, const rdm_spec& spec) {
  const std::string task = task_at(spec.task).name;
  if (!set.task.empty() && !same_name(set.task, task))
    throw Usage("--data " + printable(file) + ": it is a set of task " + printable(set.task) + ", not of " +
                task);
  const auto steps = set.metadata.find("max_steps");
  if (steps != set.metadata.end() && steps->is_number_integer() && *steps != spec.max_steps)
    throw Usage(format(
        "--data %s: an episode of the set has at most %s control steps, and here %d; give --set max_steps=%s",
        printable(file).c_str(), steps->dump().c_str(), spec.max_steps, steps->dump().c_str()));
}

Json score_json(const DataSet& set, const Evaluation& e) {
  const ReturnRange range = return_range(set);
  const double width = range.most - range.least;
  const bool counted = !e.summary.cost_mean.empty();
  Json costs = Json::array();
  for (const double limit : limits_of(set))
    costs.push_back(
        {{"limit", limit}, {"cost", counted && limit > 0 ? Json(e.summary.cost_mean[0] / limit) : Json()}});
  return {{"return", width > 0 ? Json((e.summary.return_mean - range.least) / width) : Json()},
          {"return_min", range.least},
          {"return_max", range.most},
          {"costs", costs}};
}

std::string score_text(const Json& score) {
  std::string text = "normalised return " +
                     (score["return"].is_number() ? format("%.3f", score["return"].get<double>()) : "-");
  for (const Json& c : score["costs"])
    text += format(", cost %s of the limit %s",
                   c["cost"].is_number() ? format("%.2f", c["cost"].get<double>()).c_str() : "-",
                   number_text(c["limit"].get<double>()).c_str());
  return text + '\n';
}

}  // namespace tool
