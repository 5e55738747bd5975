#include "play/trained.hpp"

#include <filesystem>

#include "common/files.hpp"
#include "common/names.hpp"
#include "common/posix.hpp"

namespace tool {
namespace {

std::filesystem::path policies_folder() {
  const std::filesystem::path program = path_of_program();
  return program.parent_path().parent_path() / "share/redman/policies";
}

std::string file_of(const std::string& task) {
  return (policies_folder() / (task + ".rdm")).string();
}

}  // namespace

bool read_trained_word(const std::string& word, std::string* task) {
  const size_t colon = word.find(':');
  if (!same_name(word.substr(0, colon), "trained")) return false;
  if (colon != std::string::npos) *task = word.substr(colon + 1);
  return true;
}

bool has_trained_policy(const std::string& task) {
  return file_exists(file_of(task));
}

std::string trained_policy(const std::string& task) {
  const std::string name = task_at(find_task(task)).name;
  if (has_trained_policy(name)) return file_of(name);
  std::string all;
  for (int32_t i = 0, n = rdm_task_count(); i < n; ++i)
    if (const std::string other = task_at(i).name; has_trained_policy(other))
      all += (all.empty() ? "" : ", ") + other;
  throw Failure("policy trained: there is none for task " + name + " in " + policies_folder().string() +
                (all.empty() ? ", and none for any other task" : "; there is one for " + all));
}

}  // namespace tool
