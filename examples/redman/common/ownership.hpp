// What in a folder redman has written, told by name and content: the rest is not redman's to replace or
// remove.
#pragma once
#include <string>

namespace tool {

// The files of a run that a training writes.
inline constexpr const char* kRunFiles[] = {"config.json", "progress.csv", "policy.rdm", "checkpoint.rdm"};

// Failure when one of a run's files stands in `folder` and redman did not write it. Reads what is there.
void check_run_files(const std::string& folder);
// The name of the first of a run's files that stands in `folder`, "" when none does.
std::string first_run_file(const std::string& folder);
// Failure when a file stands at `path`, a name that the user did not give, without `mark` in its first bytes:
// redman did not write it. `flag` would name another.
void check_default_output(const std::string& path, const std::string& mark, const char* flag);
// Whether `path` is one of the files of a run: no other command writes there.
bool is_run_file(const std::string& path);

}  // namespace tool
