#include "common/plugin.hpp"

#include <dlfcn.h>
#include <redman/redman.h>

#include "common/report.hpp"
#include "common/task_files.hpp"

namespace tool {
namespace {

constexpr const char kFlag[] = "--plugin";

using Plugin = rdm_result (*)();
using Count = int32_t (*)();

std::string last_dl_error() {
  const char* text = dlerror();
  return text ? text : "it cannot be opened";
}

void load_plugin(const std::string& file) {
  const std::string owner = std::string(kFlag) + " " + file + ": ";
  // a name without a slash would be looked for in the system's folders
  const std::string path = file.find('/') == std::string::npos ? "./" + file : file;
  void* library = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!library) throw Usage(owner + last_dl_error());
  // a library that carries redman in itself would register with that one
  const auto count = reinterpret_cast<Count>(dlsym(library, "rdm_task_count"));
  if (count && count != &rdm_task_count) throw Usage(owner + "it uses another libredman than this tool");
  const auto plugin = reinterpret_cast<Plugin>(dlsym(library, "redman_plugin"));
  if (!plugin) throw Usage(owner + "it has no function redman_plugin");
  if (const rdm_result r = plugin(); r != RDM_OK)
    throw Usage(owner + "redman_plugin: " + rdm_result_string(r) + ": " + rdm_last_error());
  remember_plugin(path);
}

}  // namespace

std::vector<std::string> take_plugins(std::vector<std::string>& words) {
  std::vector<std::string> files, rest;
  for (size_t i = 0; i < words.size(); ++i) {
    const std::string assigned = std::string(kFlag) + "=";
    if (words[i] == kFlag) {
      if (++i == words.size()) throw Usage(std::string(kFlag) + ": a file is missing");
      files.push_back(words[i]);
    } else if (words[i].rfind(assigned, 0) == 0) {
      files.push_back(words[i].substr(assigned.size()));
    } else {
      rest.push_back(words[i]);
    }
  }
  words = rest;
  return files;
}

void load_plugins(const std::vector<std::string>& files) {
  for (const std::string& file : files) load_plugin(file);
}

}  // namespace tool
