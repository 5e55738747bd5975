#include "play/plan_word.hpp"

#include <redman/plan.h>
#include <redman/sense.h>

#include "common/names.hpp"
#include "common/numbers.hpp"
#include "common/setting.hpp"
#include "common/setup.hpp"
#include "common/text.hpp"

namespace tool {

std::vector<rdm_option_spec> planner_options() {
  std::vector<rdm_option_spec> out;
  rdm_option_spec row = RDM_INIT(rdm_option_spec);
  for (int32_t i = 0; rdm_planner_option_at(i, &row) == RDM_OK; ++i) out.push_back(row);
  return out;
}

std::string planner_hint(const std::string& key) {
  std::vector<std::string> keys = {"policy", "critic"};
  for (const rdm_option_spec& row : planner_options()) keys.push_back(row.key);
  return nearest_hint(key, keys);
}

bool read_plan_word(const std::string& word, PlanWord* out) {
  const size_t colon = word.find(':');
  if (!same_name(word.substr(0, colon), "plan")) return false;
  const auto table = planner_options();
  GivenOnce keys;
  for (size_t at = colon; at != std::string::npos;) {
    const size_t end = word.find(',', at + 1);
    const std::string item = word.substr(at + 1, end == std::string::npos ? end : end - at - 1);
    const auto [key, value] = split_pair(item, "--policy plan:");
    keys.add(key, "--policy " + word);
    if (same_name(key, "policy")) {
      out->policy = value;
    } else if (same_name(key, "critic")) {
      out->critic = value;
    } else if (has_option(table, key)) {
      out->settings += key + '=' + value + '\n';
    } else {
      throw Usage("--policy " + word + ": planners have no option " + key + planner_hint(key));
    }
    at = end;
  }
  double knots = 0, horizon = 0;
  for (const rdm_option_spec& row : table)
    if (same_name(row.key, "horizon")) horizon = row.number;
  for (const auto& [key, value] : read_settings(out->settings)) {
    if (same_name(key, "knots")) read_number(value, &knots);
    if (same_name(key, "horizon")) read_number(value, &horizon);
  }
  if (knots > horizon)
    throw Usage("--policy " + word + ": knots " + number_text(knots) + " is above the horizon, " +
                number_text(horizon));
  return true;
}

std::string plan_word(const std::vector<std::pair<std::string, std::string>>& options,
                      const std::string& policy, const std::string& critic) {
  std::string word = "plan", between = ":";
  const auto add = [&](const std::string& key, const std::string& value) {
    word += between + key + '=' + value;
    between = ",";
  };
  for (const auto& [key, value] : options) add(key, value);
  if (!policy.empty()) add("policy", policy);
  if (!critic.empty()) add("critic", critic);
  return word;
}

}  // namespace tool
