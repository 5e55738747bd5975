// The policies that come with the tool, one of a task: `--policy trained`.
#pragma once
#include <string>

namespace tool {

// "trained", or "trained:TASK": true, and `task` becomes TASK where the word names one.
bool read_trained_word(const std::string& word, std::string* task);
// The task's file, in share/redman/policies beside the folder of the program. Failure, with the tasks that
// have one, when there is none.
std::string trained_policy(const std::string& task);
bool has_trained_policy(const std::string& task);

}  // namespace tool
