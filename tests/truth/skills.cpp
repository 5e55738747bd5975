// Skills do not depend on the step: the shipped policies of the hand tasks, trained at 2 substeps, by the
// tool at 2, 4, 8 and 16:
//   redman eval --policy P --task T --set substeps=S --episodes 100 --seed 777 --json
// At 4, 8 and 16 at most 5 points of the success at 2 are lost; of tasks without a success, 5 % of their
// return.
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>

#include "table.hpp"

namespace truth {
namespace {

const char* const kTasks[] = {"hand_over_safe_finger",
                              "hand_over_safe_joint",
                              "hand_over_wall",
                              "catch_underarm_safe_finger",
                              "catch_underarm_safe_joint",
                              "grasp",
                              "reorient",
                              "jenga",
                              "pick_bottles",
                              "clean_house"};

struct Score {
  double success = 0;  // %
  double ret = 0;
};

double number_of(const std::string& json, const std::string& key) {
  const size_t at = json.find("\"" + key + "\":");
  if (at == std::string::npos) throw std::runtime_error("redman eval says no " + key);
  return std::strtod(json.c_str() + at + key.size() + 3, nullptr);
}

Score score(const std::string& tool, const std::string& policies, const char* task,
            const std::string& settings) {
  std::string command = "'" + tool + "' eval --policy '" + policies + "/" + task + ".rdm' --task " + task;
  command += " --episodes 100 --seed 777 --threads 1 --json " + settings + " 2>&1";
  FILE* pipe = popen(command.c_str(), "r");
  if (!pipe) throw std::runtime_error("cannot run " + tool);
  std::string json;
  char part[4096];
  for (size_t n; (n = std::fread(part, 1, sizeof part, pipe)) > 0;) json.append(part, n);
  if (pclose(pipe) != 0) throw std::runtime_error(json.substr(0, 200));
  return {100 * number_of(json, "success_rate"), number_of(json, "return_mean")};
}

void skill(Rows& rows, const std::string& tool, const std::string& policies, const char* task) {
  const auto at = [&](int sub) { return score(tool, policies, task, text("--set substeps=%d", sub)); };
  const Score trained = at(2);
  for (const int sub : {4, 8, 16}) {
    const Score other = at(sub);
    if (trained.success > 0) {
      rows.add({text("%s, policy of 2 substeps at %d: success lost, of %g %%", task, sub, trained.success), 0,
                5, "%"},
               std::max(0.0, trained.success - other.success));
    } else {
      rows.add({text("%s, policy of 2 substeps at %d: return / at 2", task, sub), 1, 0.05},
               other.ret / trained.ret);
    }
  }
}

}  // namespace

void add_skills(Checks& checks, const std::string& tool, const std::string& policies) {
  const char* group = "Skills at other substeps";
  for (const char* task : kTasks)
    checks.push_back({group, task, false, [=](Rows& rows) { skill(rows, tool, policies, task); }});
  checks.push_back(
      {group, "engine ode", false, [=](Rows& rows) {
         const double ours = score(tool, policies, "grasp", "").ret;
         rows.add({"grasp, policy of engine articulated in engine ode: return / in articulated", 1, 0.1},
                  score(tool, policies, "grasp", "--set engine=ode").ret / ours);
       }});
}

}  // namespace truth
