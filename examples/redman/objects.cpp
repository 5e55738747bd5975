// `objects` and `object`: the catalogue, and meshes and files that become objects.
#include "common/objects.hpp"

#include <redman/import.h>

#include <cmath>
#include <memory>
#include <redman/redman.hpp>

#include "commands.hpp"
#include "common/files.hpp"
#include "common/numbers.hpp"
#include "common/text.hpp"
#include "draw/sheet.hpp"
#include "mesh/hulls.hpp"
#include "mesh/parts.hpp"

namespace tool {
namespace {

constexpr double kFarthest = 100;  // m, what rdm_object_create takes

struct ObjectsFlags {
  bool markdown = false;
  std::string sheet;
  int32_t side = 180, columns = 10;
};

Report list_objects(const ObjectsFlags& flags) {
  check_outputs({{"--sheet", flags.sheet, ".png"}});
  Json all = Json::array();
  Table table({"object", "shape", "mass, kg", "friction coefficient", "surface", "summary"});
  for (int32_t i = 0; i < rdm_object_count(); ++i) {
    rdm_object_info object = RDM_INIT(rdm_object_info);
    rdm_object_def def;
    rdm_object_def_init(&def, sizeof def);
    // An object that was destroyed leaves its number.
    if (rdm_object_info_at(i, &object) != RDM_OK || rdm_object_get_def(i, &def) != RDM_OK) continue;
    all.push_back({{"name", object.name},
                   {"alias", def.alias ? Json(def.alias) : Json()},
                   {"shape", object.shape},
                   {"shapes", def.num_shapes},
                   {"mass", object.mass},
                   {"moment", std::vector<double>(def.moment, def.moment + 6)},
                   {"friction", def.friction},
                   {"material", def.material},
                   {"summary", def.summary}});
    table.add({flags.markdown ? format("`%s`", object.name) : object.name, object.shape,
               format("%.4g", object.mass), format("%.3g", def.friction), def.material, def.summary});
  }
  Json json = {{"objects", all}};
  std::string text = flags.markdown ? table.markdown() : table.text();
  if (!flags.sheet.empty()) {
    const Sheet sheet = draw_sheet(flags.side, flags.columns);
    write_png(flags.sheet, sheet.image);
    json["file"] = flags.sheet;
    json["columns"] = sheet.columns;
    json["pictures"] = sheet.names;
    text = "";
    for (size_t i = 0; i < sheet.names.size(); ++i)
      text += sheet.names[i] + ((i + 1) % static_cast<size_t>(sheet.columns) ? "  " : "\n");
    text += "\nwrote " + flags.sheet + '\n';
  }
  return {json, text};
}

struct ObjectFlags {
  std::string file, out, name, material = "plastic";
  int32_t parts = 1, points = 32;
  double mass = 0, friction = 0.5, scale = 1;
  bool given = false;  // one of those that are of a mesh alone
};

bool is_mesh(const std::string& file) {
  for (const char* ending : {".stl", ".STL", ".obj", ".OBJ"})
    if (file.size() > 4 && file.compare(file.size() - 4, 4, ending) == 0) return true;
  return false;
}

// "cup" of "/tmp/my cup.stl" becomes "my_cup".
std::string name_of(const std::string& file) {
  const size_t slash = file.find_last_of('/');
  std::string name = file.substr(slash == std::string::npos ? 0 : slash + 1);
  name.erase(name.find_last_of('.'));
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c)) && c != '_' && c != '-' && c != '+') c = '_';
  return name.substr(0, 25);
}

std::string size_text(const rdm_shape_def& s) {
  if (s.kind == RDM_SHAPE_HULL) return format("%d points", s.num_points);
  const int count = s.kind == RDM_SHAPE_SPHERE                                    ? 1
                    : s.kind == RDM_SHAPE_CAPSULE || s.kind == RDM_SHAPE_CYLINDER ? 2
                                                                                  : 3;
  std::string text;
  for (int i = 0; i < count; ++i) text += format(i ? " x %.4g" : "%.4g", s.size[i]);
  return text;
}

// Writes it where it is asked for, and says what it is.
Report show(const rdm_object_def& def, const ObjectFlags& flags, Json json, const std::string& how) {
  static constexpr const char* kKinds[] = {"sphere", "capsule",   "box", "cylinder",
                                           "plane",  "ellipsoid", "hull"};
  Table table({"shape", "size", "place"});
  for (int32_t i = 0; i < def.num_shapes; ++i) {
    const rdm_shape_def& s = def.shapes[i];
    table.add(
        {kKinds[s.kind], size_text(s), format("%.4f %.4f %.4f", s.pose.p[0], s.pose.p[1], s.pose.p[2])});
  }
  std::string text = format("%s: %.4g kg, %s, friction %.3g\n", def.name, def.mass,
                            def.material ? def.material : "object", def.friction) +
                     how + '\n' + table.text();
  json["name"] = def.name;
  json["mass"] = def.mass;
  json["moment"] = std::vector<double>(def.moment, def.moment + 6);
  json["friction"] = def.friction;
  json["shapes"] = def.num_shapes;
  if (!flags.out.empty()) {
    const std::string written = object_text(def);
    import_object_text(written, flags.file);  // nothing is written that could not be read
    replace_file(flags.out, written);
    json["file"] = flags.out;
    text += "\nwritten to " + flags.out + '\n';
  }
  return {json, text};
}

// Hulls of the parts, in the mesh's own frame; mass and moments of the mesh where it is closed.
Report object_of_mesh(const ObjectFlags& flags) {
  if (!(flags.mass > 0)) throw Usage("--mass: an object from a mesh needs a mass above 0 kg");
  Mesh mesh = mesh_of(flags.file);
  for (Point& p : mesh.points)
    for (double& x : p) {
      x *= flags.scale;
      if (!(std::abs(x) <= kFarthest))
        throw Failure(flags.file +
                      format(": with --scale a vertex is farther than %g m from the origin", kFarthest));
    }
  const MeshMass whole = mass_of(mesh);
  const bool closed = whole.volume > 0;
  std::vector<std::vector<double>> points;
  std::vector<rdm_shape_def> shapes;
  std::vector<Hull> hulls;
  double volume = 0;
  const auto parts = parts_of(mesh, flags.parts, flags.file);
  for (const auto& part : parts) {
    try {
      hulls.push_back(few_hull(part, static_cast<size_t>(flags.points), flags.file).hull);
    } catch (const Failure&) {  // a flat patch belongs to its neighbours
      if (parts.size() == 1) throw;
      continue;
    }
    std::vector<double>& out = points.emplace_back();
    for (const Point& p : hulls.back().corners)
      for (size_t k = 0; k < 3; ++k) out.push_back(p[k] - (closed ? whole.centre[k] : 0));
    volume += hulls.back().volume;
  }
  if (hulls.empty()) throw Failure(flags.file + ": its parts are flat");
  if (hulls.size() > RDM_MAX_SHAPES)
    throw Failure(flags.file +
                  format(": it was cut into %zu parts, which is more than %d", hulls.size(), RDM_MAX_SHAPES));
  double error = 0;  // how far the mesh stands out of all parts
  for (const Point& p : mesh.points) {
    double least = kFarthest;
    for (const Hull& hull : hulls) {
      double out = 0;
      for (const Plane& plane : hull.planes) out = std::max(out, beyond(plane, p));
      least = std::min(least, out);
    }
    error = std::max(error, least);
  }
  for (const auto& p : points) {
    rdm_shape_def s{};
    s.kind = RDM_SHAPE_HULL;
    s.points = p.data();
    s.num_points = static_cast<int32_t>(p.size() / 3);
    s.pose.q[3] = 1;
    shapes.push_back(s);
  }
  const std::string name = flags.name.empty() ? name_of(flags.file) : flags.name;
  const std::string summary =
      format("%zu convex part%s of a mesh", shapes.size(), shapes.size() == 1 ? "" : "s");
  rdm_object_def def;
  rdm_object_def_init(&def, sizeof def);
  def.name = name.c_str();
  def.summary = summary.c_str();
  def.material = flags.material.c_str();
  def.friction = flags.friction;
  def.mass = flags.mass;
  def.shapes = shapes.data();
  def.num_shapes = static_cast<int32_t>(shapes.size());
  if (closed)
    for (size_t k = 0; k < 6; ++k) def.moment[k] = whole.moment[k] * flags.mass / whole.volume;
  int32_t object = -1;  // what the library says of it
  if (rdm_object_create(&object, &def) != RDM_OK) throw Failure(flags.file + ": " + rdm_last_error());
  const std::string how =
      closed ? format("moments of the closed mesh, %.6g m3; the parts have %.6g m3", whole.volume, volume)
             : format("moments of the parts, %.6g m3: the mesh is not closed", volume);
  const Json json = {{"closed", closed},
                     {"volume_m3", closed ? whole.volume : volume},
                     {"parts_m3", volume},
                     {"error_m", error},
                     {"parts", shapes.size()}};
  return show(def, flags, json, how + format("; the mesh extends beyond them by up to %.3g m\n", error));
}

Report run_object(const ObjectFlags& flags) {
  check_outputs({{"--out", flags.out, ".object"}}, {{"the object or mesh that is read", flags.file}});
  if (is_mesh(flags.file)) return object_of_mesh(flags);
  if (flags.given)
    throw Usage(
        flags.file +
        ": --parts, --points, --mass, --friction, --material and --scale are for a mesh (.stl, .obj) only");
  const Import import = import_object(flags.file);
  rdm_object_def def = object_def_of(import);
  std::string how;
  if (!flags.name.empty()) {
    if (def.alias) how = std::string("without its alias ") + def.alias + '\n';
    def.name = flags.name.c_str();
    def.alias = nullptr;
  }
  return show(def, flags, Json::object(), how);
}

}  // namespace

void add_objects(CLI::App& app, Run& run) {
  auto flags = std::make_shared<ObjectsFlags>();
  CLI::App* command = app.add_subcommand("objects", "List the objects for --set object=NAME");
  command->add_flag("--markdown", flags->markdown, "print the table of the manual's pages");
  CLI::Option* sheet = command->add_option(
      "--sheet", flags->sheet, "PNG file to write: a picture of each object, articulated ones included");
  command->add_option("--side", flags->side, "side of each picture, pixels")
      ->check(between(16, 1024))
      ->needs(sheet);
  command->add_option("--columns", flags->columns, "number of pictures in a row")
      ->check(between(1, 100))
      ->needs(sheet);
  add_object_flag(*command);
  command->callback([&run, flags] { run = [flags] { return list_objects(*flags); }; });
}

void add_object(CLI::App& app, Run& run) {
  auto flags = std::make_shared<ObjectFlags>();
  CLI::App* command = app.add_subcommand(
      "object", "Make an object from a mesh, or show one: its shapes, mass and moments of inertia");
  command->add_option("file", flags->file, ".stl, .obj or .object file to read, or the name of an object")
      ->required();
  std::vector<CLI::Option*> of_mesh = {
      command->add_option("--parts", flags->parts, "largest number of convex parts; 1: one convex hull")
          ->check(between(1, RDM_MAX_SHAPES)),
      command->add_option("--points", flags->points, "largest number of corners of each part")
          ->check(between(4, 32)),
      command->add_option("--mass", flags->mass, "mass of the object, kg")->check(above_zero()),
      command->add_option("--friction", flags->friction, "friction coefficient of its surface")
          ->check(between(0.0, 10.0)),
      command->add_option("--material", flags->material, "name of its surface"),
      command->add_option("--scale", flags->scale, "length of one unit of the file, m")->check(above_zero()),
  };
  command->add_option("--name", flags->name, "name of the object; default: the file's name");
  command->add_option("--out", flags->out, "write the object to this .object file");
  command->callback([&run, flags, of_mesh] {
    for (const CLI::Option* option : of_mesh) flags->given = flags->given || option->count() > 0;
    run = [flags] { return run_object(*flags); };
  });
}

}  // namespace tool
