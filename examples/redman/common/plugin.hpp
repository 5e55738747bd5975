// Libraries with tasks of one's own: --plugin FILE, on every command.
#pragma once
#include <string>
#include <vector>

namespace tool {

inline constexpr const char* kPluginHelp =
    "shared library with additional tasks, which its function redman_plugin() registers; repeatable";

// Takes `--plugin FILE` and `--plugin=FILE` out of the words, wherever they stand; Usage without a file.
std::vector<std::string> take_plugins(std::vector<std::string>& words);

// Opens each and calls its redman_plugin(). It stays open. Usage with the file and what is wrong.
void load_plugins(const std::vector<std::string>& files);

}  // namespace tool
