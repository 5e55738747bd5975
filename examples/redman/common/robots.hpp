// Robots of the tool's user: files that become robots of the library (redman_import), by --robot or `redman
// robot`.
#pragma once
#include <redman/import.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace CLI {
class App;
}

namespace tool {

// The library's experimental part, where this tool was built with it.
struct ImportDelete {
  void operator()(rdm_import* i) const;
};
using Import = std::unique_ptr<rdm_import, ImportDelete>;

// How a file is read; "" is what the library takes by itself.
struct ImportFlags {
  std::string format = "auto", kind, name, packages, root, palm, tips, mount, flange;
  bool skip_meshes = false, mend_inertia = false;
  double density = 0, slide_range = 0;
};

#ifndef REDMAN_IMPORT
[[noreturn]] void without_readers();  // Failure: this tool has none
#endif
// Failure with line and element. Or, for the name of a robot that is there and no file, that robot.
Import import_robot(const std::string& file, const ImportFlags& flags);
rdm_robot_def def_of(const Import& import);
// The file's robot, added to those of the process; 0 and up.
int32_t load_robot(const std::string& file);
// The same of a .robot file's text; `where` begins what is wrong with it.
int32_t load_robot_text(const std::string& text, const std::string& where);
// As a .robot file.
std::string robot_text(const rdm_robot_def& def);

// The title in the help of --robot and --object.
constexpr char kOwnGroup[] = "Robots and objects of your own";

// --robot FILE, repeatable: loads them while the command line is read, before any task is made.
void add_robot_flag(CLI::App& command);
// The files that were given so, and the numbers of their robots.
const std::vector<std::pair<std::string, int32_t>>& given_robots();

}  // namespace tool
