// `--policy plan`: a planner as who acts, in one word: "plan", or "plan:" and options of planners with commas
// between, among them policy=FILE, which proposes, and critic=FOLDER, whose critic values where a plan ends:
// "plan:method=cem,samples=128,policy=runs/first,critic=runs/first".
#pragma once
#include <redman/redman.h>

#include <string>
#include <utility>
#include <vector>

namespace tool {

struct PlanWord {
  std::string settings;  // lines key=value
  std::string policy;    // a file or a run folder, "" none
  std::string critic;    // a run folder, "" none
};
// False when the word is of another kind; Usage for one that is a plan's and malformed, or has an unknown
// option.
bool read_plan_word(const std::string& word, PlanWord* out);
std::string plan_word(const std::vector<std::pair<std::string, std::string>>& options,
                      const std::string& policy, const std::string& critic);
std::vector<rdm_option_spec> planner_options();
// "; nearest is samples" for what is no option of planners, "" when none is near.
std::string planner_hint(const std::string& key);

}  // namespace tool
