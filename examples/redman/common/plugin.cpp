#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include "common/plugin.hpp"

#include <redman/redman.h>
#if defined(_WIN32)
#include <windows.h>
#else
#include <dlfcn.h>
#endif

#include <exception>
#include <system_error>

#include "common/files.hpp"
#include "common/report.hpp"
#include "common/task_files.hpp"

namespace tool {
namespace {

constexpr const char kFlag[] = "--plugin";

using Plugin = rdm_result (*)();
using Count = int32_t (*)();

#if defined(_WIN32)
void* open_library(const std::string& path) {
  return LoadLibraryA(path.c_str());
}
std::string last_error() {
  return std::system_category().message(static_cast<int>(GetLastError()));
}
template <class F>
F symbol(void* library, const char* name) {
  return reinterpret_cast<F>(reinterpret_cast<void*>(GetProcAddress(static_cast<HMODULE>(library), name)));
}
// A library's own names alone are found in it.
bool is_other(Count) {
  return true;
}
#else
void* open_library(const std::string& path) {
  return dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
}
std::string last_error() {
  const char* text = dlerror();
  return text ? text : "it cannot be opened";
}
template <class F>
F symbol(void* library, const char* name) {
  return reinterpret_cast<F>(dlsym(library, name));
}
bool is_other(Count count) {
  return count != &rdm_task_count;
}
#endif

// What the plugin answers; the error's text is its own, not that of an earlier call.
rdm_result call(Plugin plugin, const std::string& owner) {
  rdm_fail(RDM_ERROR_ARGUMENT, "it gave no error text");
  try {
    return plugin();
  } catch (const std::exception& e) {
    throw Usage(owner + "redman_plugin threw an exception: " + e.what());
  } catch (...) {
    throw Usage(owner + "redman_plugin threw something that is not a std::exception");
  }
}

void load_plugin(const std::string& file) {
  const std::string owner = std::string(kFlag) + " " + file + ": ";
  // a name without a slash would be looked for in the system's folders
  const std::string path = file.find('/') == std::string::npos ? "./" + file : file;
  if (!file_exists(path)) throw Usage(owner + why_no_file(path));
  void* library = open_library(path);
  if (!library) throw Usage(owner + last_error());
  // a library that carries redman in itself would register with that one
  const auto count = symbol<Count>(library, "rdm_task_count");
  if (count && is_other(count)) throw Usage(owner + "it uses another libredman than this tool");
  const auto plugin = symbol<Plugin>(library, "redman_plugin");
  if (!plugin) throw Usage(owner + "it has no function redman_plugin");
  if (const rdm_result r = call(plugin, owner); r != RDM_OK)
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
