#include "common/task_files.hpp"

#include <redman/import.h>

#include "common/files.hpp"
#include "common/names.hpp"
#include "common/objects.hpp"
#include "common/robots.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

constexpr size_t kMostBytes = size_t{1} << 18;  // several fit into a config.json

struct Loaded {
  std::vector<std::string> plugins;
  std::map<std::string, std::string> tasks;    // text by name
  std::map<std::string, std::string> files;    // name by path
  std::map<std::string, std::string> robots;   // text by name
  std::map<std::string, std::string> objects;  // text by name
};
Loaded& loaded() {
  static Loaded all;
  return all;
}

// Registers the task; its name.
std::string add_task(const std::string& text, const std::string& file) {
#ifdef REDMAN_IMPORT
  int32_t index = -1;
  if (rdm_import_read_task(&index, text.data(), text.size(), file.c_str()) != RDM_OK)
    throw Failure(rdm_import_error());
  const std::string name = task_at(index).name;
  loaded().tasks[name] = text;
  return name;
#else
  (void)text;
  throw Failure(file +
                ": this tool was built without the reader of tasks; install libtinyxml2-dev and "
                "libtomlplusplus-dev and configure with -DREDMAN_IMPORT=ON");
#endif
}

}  // namespace

bool is_task_file(const std::string& word) {
  const std::string ending = ".task";
  return word.size() > ending.size() && word.compare(word.size() - ending.size(), ending.size(), ending) == 0;
}

std::string task_of_file(const std::string& file) {
  const auto known = loaded().files.find(file);
  if (known != loaded().files.end()) return known->second;
  const std::string name = add_task(read_file(file, kMostBytes), file);
  loaded().files[file] = name;
  return name;
}

std::string task_name(const std::string& word) {
  return is_task_file(word) ? task_of_file(word) : word;
}

void remember_plugin(const std::string& path) {
  loaded().plugins.push_back(path);
}

void remember_robot(const std::string& name, const std::string& text) {
  loaded().robots[name] = text;
}

void remember_object(const std::string& name, const std::string& text) {
  loaded().objects[name] = text;
}

OwnFiles own_files(const std::string& task) {
  const auto found = loaded().tasks.find(task);
  return {loaded().plugins, found == loaded().tasks.end() ? "" : found->second, loaded().robots,
          loaded().objects};
}

void load_own_files(const std::string& task, const OwnFiles& files, const std::string& where) {
  int32_t index = -1;
  if (files.task.empty() && !files.plugins.empty() && rdm_task_find(task.c_str(), &index) != RDM_OK)
    throw Failure(where + ": task " + task + " comes from a plugin: give --plugin " + files.plugins.back());
  for (const auto& [name, text] : files.robots) {
    const auto known = loaded().robots.find(name);
    if (known != loaded().robots.end() && known->second == text) continue;
    if (rdm_robot_find(name.c_str(), &index) == RDM_OK)
      throw Failure(where + ": its robot " + name +
                    " differs from the one of that name that is loaded; leave out --robot");
    load_robot_text(text, where);
  }
  for (const auto& [name, text] : files.objects) {
    const auto known = loaded().objects.find(name);
    if (known != loaded().objects.end() && known->second == text) continue;
    if (rdm_object_find(name.c_str(), &index) == RDM_OK)
      throw Failure(where + ": its object " + name +
                    " differs from the one of that name that is loaded; leave out --object");
    load_object_text(text, where);
  }
  if (files.task.empty()) return;
  const auto known = loaded().tasks.find(task);
  if (known != loaded().tasks.end() && known->second == files.task) return;
  if (rdm_task_find(task.c_str(), &index) == RDM_OK)
    throw Failure(where + ": its task " + task + " differs from the one of that name that is loaded");
  const std::string name = add_task(files.task, where);
  if (!same_name(name, task)) throw Failure(where + ": it trained task " + task + ", and holds " + name);
}

}  // namespace tool
