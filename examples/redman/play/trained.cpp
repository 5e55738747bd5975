#include "play/trained.hpp"

#include <filesystem>

#include "common/files.hpp"
#include "common/names.hpp"

namespace tool {
namespace {

std::filesystem::path policies_folder() {
  std::error_code none;
  const auto program = std::filesystem::read_symlink("/proc/self/exe", none);
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

std::vector<std::string> trained_tasks() {
  std::vector<std::string> out;
  for (int32_t i = 0, n = rdm_task_count(); i < n; ++i)
    if (file_exists(file_of(task_at(i).name))) out.push_back(task_at(i).name);
  return out;
}

std::string trained_policy(const std::string& task) {
  const std::string name = task_at(find_task(task)).name;
  const std::string file = file_of(name);
  if (file_exists(file)) return file;
  std::string all;
  for (const std::string& other : trained_tasks()) all += (all.empty() ? "" : ", ") + other;
  throw Failure("policy trained: none for task " + name + " in " + policies_folder().string() +
                (all.empty() ? ", nor for another" : "; there is one for " + all));
}

}  // namespace tool
