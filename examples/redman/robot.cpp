// `robots` and `robot`: what there is, and files that become robots.
#include <redman/redman.hpp>

#include "commands.hpp"
#include "common/files.hpp"
#include "common/robots.hpp"
#include "common/setup.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

constexpr const char* kKinds[] = {"other", "hand", "arm"};

struct RobotsFlags {
  bool markdown = false;
};

Report list_robots(const RobotsFlags& flags) {
  Json all = Json::array();
  Table table({"robot", "kind", "joints", "driven joints", "mass, kg", "summary"});
  for (int32_t i = 0; i < rdm_robot_count(); ++i) {
    auto robot = redman::sized<rdm_robot>();
    rdm_robot_def def;
    rdm_robot_def_init(&def, sizeof def);
    // A robot that was destroyed leaves its number.
    if (rdm_robot_at(i, &robot) != RDM_OK || rdm_robot_get_def(i, &def) != RDM_OK) continue;
    double mass = def.root_mass;
    for (int32_t k = 0; k < def.num_links; ++k) {
      rdm_robot_link link;
      redman::check(rdm_robot_link_at(i, k, &link));
      mass += link.mass;
    }
    all.push_back({{"name", robot.name},
                   {"alias", def.alias ? Json(def.alias) : Json()},
                   {"kind", kKinds[def.kind]},
                   {"joints", robot.num_joints},
                   {"driven", robot.num_actuated},
                   {"mass", mass},
                   {"summary", robot.summary}});
    table.add({flags.markdown ? format("`%s`", robot.name) : robot.name, kKinds[def.kind],
               std::to_string(robot.num_joints), std::to_string(robot.num_actuated), format("%.3g", mass),
               robot.summary});
  }
  return {{{"robots", all}}, flags.markdown ? table.markdown() : table.text()};
}

struct RobotFlags {
  std::string file, out;
  ImportFlags import;
  bool check = false;
};

Report report_robot(const RobotFlags& flags) {
#ifdef REDMAN_IMPORT
  check_outputs({{"--out", flags.out, ".robot"}}, {{"the robot that is read", flags.file}});
  const Import import = import_robot(flags.file, flags.import);
  const rdm_robot_def def = def_of(import);
  double mass = def.root_mass;
  for (int32_t i = 0; i < def.num_links; ++i) mass += def.links[i].mass;
  if (flags.check && rdm_import_check(import.get()) != RDM_OK)
    throw Failure(flags.file + ": " + rdm_import_error());
  static constexpr const char* kLists[] = {"dropped", "changed", "guessed", "check"};
  Json lists[4] = {Json::array(), Json::array(), Json::array(), Json::array()};
  std::string text;
  Table table({"link", "joint", "parent", "range, rad or m", "kp, N m/rad or N/m", "kd, N m s/rad or N s/m",
               "effort, N m or N", "mass, kg"});
  for (int32_t i = 0; i < def.num_links; ++i) {
    const rdm_robot_link& l = def.links[i];
    table.add({l.name, l.joint, l.parent < 0 ? "root" : def.links[l.parent].name,
               format("%.4g .. %.4g", l.lower, l.upper), format("%.4g", l.kp), format("%.4g", l.kd),
               format("%.4g", l.effort), format("%.4g", l.mass)});
  }
  int32_t driven = def.num_commands;
  if (driven < 0)
    driven = 0;
  else if (driven == 0)
    driven = def.num_links - def.num_couplings;
  for (int32_t i = 0; i < def.num_curves && def.num_commands == 0; ++i)
    if (def.curves[i].driver != def.curves[i].link) --driven;
  text += format("%s: %s, %d joints, %d driven, %d shapes, %.4g kg\n\n", def.name,
                 def.kind ? kKinds[def.kind] : "neither hand nor arm", def.num_links, driven, def.num_shapes,
                 mass) +
          table.text();
  for (int32_t kind = RDM_NOTE_DROPPED; kind <= (flags.check ? RDM_NOTE_CHECK : RDM_NOTE_GUESSED); ++kind) {
    std::string part;
    for (int32_t i = 0; i < rdm_import_note_count(import.get()); ++i) {
      rdm_import_note note;
      if (rdm_import_note_at(import.get(), i, &note) != RDM_OK) throw Failure(rdm_import_error());
      if (note.kind != kind) continue;
      const std::string line = (note.line > 0 ? format("line %d: ", note.line) : "") + with_flags(note.text);
      lists[kind].push_back(line);
      part += "  " + line + '\n';
    }
    if (!part.empty()) text += format("\n%s:\n", kLists[kind]) + part;
  }
  if (flags.check && lists[3].empty())
    text += "\ncheck: it holds its home pose, reaches the ends of its ranges and does not touch itself\n";
  Json fingers = Json::array();
  for (int32_t i = 0; i < def.num_fingers; ++i) fingers.push_back(def.fingers[i].name);
  Json json = {
      {"name", def.name},    {"kind", kKinds[def.kind]}, {"links", def.num_links}, {"joints", def.num_links},
      {"driven", driven},    {"shapes", def.num_shapes}, {"mass", mass},           {"fingers", fingers},
      {"dropped", lists[0]}, {"changed", lists[1]},      {"guessed", lists[2]}};
  if (flags.check) json["check"] = lists[3];
  if (!flags.out.empty()) {
    replace_file(flags.out, robot_text(def));
    json["file"] = flags.out;
    text += "\nwritten to " + flags.out + '\n';
  }
  return {json, text};
#else
  import_robot(flags.file, flags.import);
  return {};
#endif
}

}  // namespace

void add_robots(CLI::App& app, Run& run) {
  auto flags = std::make_shared<RobotsFlags>();
  CLI::App* command = app.add_subcommand("robots", "List the robots for --set hand=NAME and arm=NAME");
  command->add_flag("--markdown", flags->markdown, "print the table of the manual's pages");
  add_robot_flag(*command);
  command->callback([&run, flags] { run = [flags] { return list_robots(*flags); }; });
}

void add_robot(CLI::App& app, Run& run) {
  auto flags = std::make_shared<RobotFlags>();
  CLI::App* command = app.add_subcommand(
      "robot", "Read the file of a robot (URDF, MJCF, .robot) and list what is dropped, changed and guessed");
  ImportFlags& f = flags->import;
  command->add_option("file", flags->file, "file to read, or the name of a robot")->required();
  command->add_flag("--check", flags->check,
                    "simulate the robot alone and report shapes that touch, and joints that do not settle or "
                    "reach their limits");
  command->add_option("--out", flags->out, "write the robot to this .robot file");
  command->add_option("--format", f.format, "format of the file: auto, urdf, mjcf or robot");
  command->add_option("--name", f.name, "name of the robot; default: the name in the file");
  command->add_option("--kind", f.kind, "kind of robot: hand, arm or other; default: guessed");
  command->add_flag("--skip-meshes", f.skip_meshes, "drop meshes that cannot be read");
  command->add_flag("--mend-inertia", f.mend_inertia,
                    "raise moments of inertia that violate the triangle inequality");
  command->add_option(
      "--density", f.density,
      "density of URDF links without <inertial>, kg/m3; default: they weigh nothing; for URDF only");
  command->add_option("--slide-range", f.slide_range,
                      "range to either side of a sliding joint without limits, m; default: 2 pi");
  command->add_option("--packages", f.packages,
                      "folder that package:// refers to; default: searched above the file");
  command->add_option("--root", f.root, "link (body) whose subtree is read; world: all of an MJCF file");
  command->add_option("--palm", f.palm, "link that is the palm; default: guessed");
  command->add_option("--tips", f.tips, "links or sites of the fingertips: a,b,c; default: guessed");
  command->add_option("--mount", f.mount, "link, site or \"x y z roll pitch yaw\" that is mounted on an arm");
  command->add_option("--flange", f.flange, "link or site that carries a hand; none: no hand");
  command->callback([&run, flags] { run = [flags] { return report_robot(*flags); }; });
}

}  // namespace tool
