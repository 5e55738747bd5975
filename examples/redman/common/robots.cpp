#include "common/robots.hpp"

#include <CLI/CLI.hpp>
#include <redman/redman.hpp>

#include "common/added.hpp"
#include "common/files.hpp"
#include "common/names.hpp"
#include "common/report.hpp"
#include "common/task_files.hpp"
#include "common/text.hpp"

namespace tool {

#ifdef REDMAN_IMPORT
namespace {

int32_t place_of(const std::string& word, const std::vector<std::string>& words, const char* flag) {
  for (size_t i = 0; i < words.size(); ++i)
    if (same_name(word, words[i])) return static_cast<int32_t>(i);
  throw Usage(std::string(flag) + ' ' + word + ": it is not one of " + joined(words, ", ") +
              nearest_hint(word, words));
}

}  // namespace

void ImportDelete::operator()(rdm_import* i) const {
  rdm_import_destroy(i);
}

Import import_robot(const std::string& file, const ImportFlags& flags) {
  rdm_import_config o;
  rdm_import_config_init(&o, sizeof o);
  o.format = place_of(flags.format, {"auto", "urdf", "mjcf", "robot"}, "--format");
  if (!flags.kind.empty()) o.kind = place_of(flags.kind, {"other", "hand", "arm"}, "--kind");
  o.skip_meshes = flags.skip_meshes;
  o.mend_inertia = flags.mend_inertia;
  o.density = flags.density;
  o.slide_range = flags.slide_range;
  const auto text = [](const std::string& s) { return s.empty() ? nullptr : s.c_str(); };
  o.name = text(flags.name);
  o.packages = text(flags.packages);
  o.root = text(flags.root);
  o.palm = text(flags.palm);
  o.tips = text(flags.tips);
  o.mount = text(flags.mount);
  o.flange = text(flags.flange);
  rdm_import* made = nullptr;
  int32_t known = -1;
  if (!file_exists(file) && file.find('/') == std::string::npos &&
      rdm_robot_find(file.c_str(), &known) == RDM_OK) {
    if (rdm_import_create_robot(&made, known) != RDM_OK) throw Failure(rdm_import_error());
    // Flags mean the same as for its own .robot file.
    const std::string written = robot_text(def_of(Import(made)));
    if (rdm_import_read(&made, written.data(), written.size(), &o) != RDM_OK)
      throw Failure(file + ": " + rdm_import_error());
    return Import(made);
  }
  const rdm_result r = rdm_import_read_file(&made, file.c_str(), &o);
  if (r == RDM_ERROR_NOT_FOUND && !file_exists(file)) {
    std::vector<std::string> names;
    for (int32_t i = 0; i < rdm_robot_count(); ++i) {
      auto robot = redman::sized<rdm_robot>();
      if (rdm_robot_at(i, &robot) == RDM_OK) names.emplace_back(robot.name);
    }
    const std::string hint = nearest_hint(file, names);
    throw Failure(file + ": there is no such file, and no robot of that name" +
                  (hint.empty() ? missing_file_hint(file) : hint));
  }
  if (r != RDM_OK) throw Failure(rdm_import_error());
  return Import(made);
}

rdm_robot_def def_of(const Import& import) {
  rdm_robot_def def;
  rdm_robot_def_init(&def, sizeof def);
  if (rdm_import_get_robot_def(import.get(), &def) != RDM_OK) throw Failure(rdm_import_error());
  return def;
}

namespace {
constexpr AddedKind<rdm_robot_def> kRobot = {"robot", rdm_import_write_robot, rdm_robot_create,
                                             rdm_robot_find, remember_robot};
}  // namespace

int32_t load_robot(const std::string& file) {
  return add(kRobot, def_of(import_robot(file, {})), file);
}

int32_t load_robot_text(const std::string& text, const std::string& where) {
  rdm_import_config o;
  rdm_import_config_init(&o, sizeof o);
  o.format = RDM_IMPORT_ROBOT;
  rdm_import* made = nullptr;
  if (rdm_import_read(&made, text.data(), text.size(), &o) != RDM_OK)
    throw Failure(where + ": " + rdm_import_error());
  return add(kRobot, def_of(Import(made)), where);
}

std::string robot_text(const rdm_robot_def& def) {
  return text_of(kRobot, def);
}
#else
void without_readers() {
  throw Failure(
      "this tool was built without the readers of robots and objects; install libtinyxml2-dev and "
      "libtomlplusplus-dev and configure with -DREDMAN_IMPORT=ON");
}
void ImportDelete::operator()(rdm_import*) const {}
Import import_robot(const std::string&, const ImportFlags&) {
  without_readers();
}
rdm_robot_def def_of(const Import&) {
  without_readers();
}
int32_t load_robot(const std::string&) {
  without_readers();
}
int32_t load_robot_text(const std::string&, const std::string&) {
  without_readers();
}
std::string robot_text(const rdm_robot_def&) {
  without_readers();
}
#endif

namespace {
std::vector<std::pair<std::string, int32_t>> g_given;  // as the list of robots itself, of the process
}  // namespace

const std::vector<std::pair<std::string, int32_t>>& given_robots() {
  return g_given;
}

void add_robot_flag(CLI::App& command) {
  command
      .add_option_function<std::vector<std::string>>(
          "--robot",
          [](const std::vector<std::string>& files) {
            for (const std::string& file : files) g_given.emplace_back(file, load_robot(file));
          },
          "file of a robot (.robot, URDF, MJCF) for --set hand=NAME or arm=NAME; repeatable")
      ->allow_extra_args(false)
      ->type_name("FILE")
      ->group(kOwnGroup);
}

}  // namespace tool
