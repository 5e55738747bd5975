#include "run/progress.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "common/report.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

struct Row {
  rdm_epoch e{};
  int64_t steps = 0;
  LastEvaluation evaluation{};
  EpochTimes times;
};

// Every column in order: add(name, value).
template <class Add>
void visit(const std::vector<CostColumn>& columns, const Row& row, Add add) {
  const rdm_epoch& e = row.e;
  const auto episodic = [&](double v) { return e.episodes > 0 ? v : std::nan(""); };
  const auto counted = [](int64_t n) { return n < 0 ? std::nan("") : static_cast<double>(n); };
  const auto name = [&](const char* text, size_t k) {
    return k == 0 ? text : text + ("/" + columns[k].name);
  };
  add("Train/Epoch", e.epoch);
  add("Train/TotalSteps", static_cast<double>(e.env_steps));
  add("TotalEnvSteps", static_cast<double>(e.env_steps));
  add("Metrics/EpRet", episodic(e.ret));
  for (size_t k = 0; k < columns.size(); ++k) add(name("Metrics/EpCost", k), episodic(e.cost[k]));
  add("Metrics/EpLen", episodic(e.length));
  add("Metrics/FallRate", episodic(e.fall_rate));
  add("Metrics/SuccessRate", episodic(e.success_rate));
  add("Metrics/CostPerStep", e.cost_per_step);
  add("Metrics/Episodes", static_cast<double>(e.episodes));
  add("Metrics/Violations", counted(e.violations));
  for (size_t k = 0; k < columns.size(); ++k)
    if (k == 0 || columns[k].limited) add(name("Metrics/LagrangeMultiplier", k), e.multiplier[k]);
  add("Train/KL", e.kl);
  add("Train/LR", e.learning_rate);
  add("Train/Entropy", e.entropy);
  add("Train/PolicyStd", e.action_std);
  add("Train/ClipFraction", e.clip_fraction);
  add("Train/StopIter", e.passes);
  add("Loss/Loss_pi", e.loss_policy);
  add("Loss/Loss_reward_critic", e.loss_reward_value);
  add("Loss/Loss_cost_critic", e.loss_cost_value);
  add("Value/reward", e.value_reward);
  add("Value/cost", e.value_cost);
  add("Metrics/TestEpRet", row.evaluation.ret);
  add("Metrics/TestEpCost", row.evaluation.cost);
  add("Shield/Refused", counted(e.refused));
  add("Shield/Unproven", counted(e.unproven));
  add("Shield/Inevitable", counted(e.inevitable));
  add("Shield/Copied", counted(e.copied));
  add("Time/Epoch", row.times.epoch);
  add("Time/Evaluation", row.times.evaluation);
  add("Time/FPS", static_cast<double>(row.steps) / row.times.epoch);
  add("Time/Total", row.times.total);
  add("Trouble/Diverged", static_cast<double>(e.diverged));
  add("Trouble/ContactsLeftOut", static_cast<double>(e.contacts_left_out));
  add("Trouble/Unconverged", static_cast<double>(e.unconverged));
  add("Trouble/Slowed", static_cast<double>(e.slowed));
  add("Trouble/BadActions", static_cast<double>(e.bad_actions));
  add("Trouble/TaskFailed", static_cast<double>(e.task_failed));
  add("Trouble/InvalidRows", static_cast<double>(e.invalid_rows));
  add("Trouble/SkippedGradients", static_cast<double>(e.skipped_gradients));
}

constexpr size_t kMostColumns = 1000;

double number(const std::string& cell) {
  constexpr double kMost = 1e100;  // sums and squares of such numbers are finite
  char* end = nullptr;
  const double value = std::strtod(cell.c_str(), &end);
  return end == cell.c_str() || !(std::abs(value) <= kMost) ? std::nan("") : value;
}

}  // namespace

std::string curve_header(const std::vector<CostColumn>& costs) {
  std::string out;
  visit(costs, Row{}, [&](const std::string& name, double) { out += (out.empty() ? "" : ",") + name; });
  return out;
}

std::string curve_row(const std::string& header, const std::vector<CostColumn>& costs, const rdm_epoch& e,
                      int64_t steps_in_epoch, const LastEvaluation& evaluation, const EpochTimes& times) {
  std::map<std::string, double> values;
  visit(costs, Row{e, steps_in_epoch, evaluation, times},
        [&](const std::string& name, double value) { values[name] = value; });
  std::string out;
  for (const std::string& name : cells_of(header, kMostColumns)) {
    const auto found = values.find(name);
    out += out.empty() ? "" : ",";
    out += found == values.end() || std::isnan(found->second) ? "nan" : format("%.9g", found->second);
  }
  return out;
}

Columns parse_progress(const char* text, size_t size) {
  Columns out;
  std::vector<std::vector<double>*> columns;
  for (size_t at = 0; at < size;) {
    const void* found = std::memchr(text + at, '\n', size - at);
    const size_t end = found ? static_cast<size_t>(static_cast<const char*>(found) - text) : size;
    const bool first = at == 0;
    const auto cells = cells_of(std::string(text + at, end - at), first ? kMostColumns : columns.size());
    at = end + 1;
    if (first && cells.size() > kMostColumns)
      throw Failure("more than " + std::to_string(kMostColumns) + " columns");
    for (size_t i = 0; first && i < cells.size(); ++i) {
      const auto [column, fresh] = out.try_emplace(cells[i]);
      if (!fresh) throw Failure("two columns have the name '" + cells[i] + "'");
      columns.push_back(&column->second);
    }
    if (first || cells.size() != columns.size()) continue;
    for (size_t i = 0; i < cells.size(); ++i) columns[i]->push_back(number(cells[i]));
  }
  return out;
}

}  // namespace tool
