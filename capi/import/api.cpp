// redman/import.h, carried out: one barrier, handles with a tag, texts of the thread.
#include <algorithm>
#include <cstddef>
#include <cstring>
#include <memory>
#include <new>

#include "import.hpp"
#include "toml_text.hpp"

using namespace rdm::import;

struct rdm_import {
  static constexpr uint32_t kTag = 0x6f706d69;
  uint32_t tag = kTag;
  Draft draft;
  std::unique_ptr<ObjectDraft> object;  // in the place of a robot
};

namespace {

constexpr size_t kMostXml = kCostLimits[static_cast<size_t>(Cost::kTextBytes)].most;
constexpr size_t kTextSize = 512;
constexpr size_t kMaxStruct = 4096;
thread_local char t_error[kTextSize] = "";

void keep_error(const std::string& text) {
  const std::string line = clean(text, kTextSize - 4);
  std::memcpy(t_error, line.c_str(), line.size() + 1);
}

template <class F>
rdm_result call(const rdm_import_config* c, F&& f) noexcept {
  rdm_result code = RDM_OK;
  try {
    try {
      f();
      return RDM_OK;
    } catch (const Refusal& r) {
      code = r.code;
      keep_error(r.text);
    }
  } catch (const std::bad_alloc&) {
    code = RDM_ERROR_MEMORY;
    std::strcpy(t_error, "out of memory");
  } catch (...) {
    code = RDM_ERROR_INTERNAL;
    std::strcpy(t_error, "internal error: unexpected exception");
  }
  constexpr size_t end = offsetof(rdm_import_config, error_size) + sizeof c->error_size;
  if (c && c->struct_size >= end && c->struct_size <= kMaxStruct && c->error && c->error_size > 0) {
    const size_t size = std::min(std::strlen(t_error), static_cast<size_t>(c->error_size) - 1);
    std::memcpy(c->error, t_error, size);
    c->error[size] = 0;
  }
  return code;
}

void need(const void* p, const char* name) {
  if (!p) refuse(RDM_ERROR_ARGUMENT, "%s is NULL", name);
}
void need_handle(const rdm_import* i) {
  need(i, "import");
  if (i->tag != rdm_import::kTag)
    refuse(RDM_ERROR_ARGUMENT, "import: it is not a handle of this kind, or it was destroyed");
}

void need_robot(const rdm_import* i) {
  need_handle(i);
  if (i->object) refuse(RDM_ERROR_ARGUMENT, "import: it is an object, not a robot");
}

rdm_import_config defaults() {
  rdm_import_config o{};
  o.kind = -1;
  return o;
}

Options read_options(const rdm_import_config* in) {
  rdm_import_config o = defaults();
  if (in) {
    // What the first version of the struct ended with.
    constexpr size_t first = offsetof(rdm_import_config, mend_inertia) + sizeof o.mend_inertia;
    if (in->struct_size < first || in->struct_size > kMaxStruct)
      refuse(RDM_ERROR_ARGUMENT,
             "config.struct_size: %u is outside [%zu, %zu]; set it by rdm_import_config_init",
             in->struct_size, first, kMaxStruct);
    std::memcpy(&o, in, std::min<size_t>(in->struct_size, sizeof o));
    if (o.error && o.error_size < 1)
      refuse(RDM_ERROR_RANGE, "config.error_size: %d is less than 1, but error is not NULL", o.error_size);
    if (o.format < RDM_IMPORT_AUTO || o.format > RDM_IMPORT_ROBOT)
      refuse(RDM_ERROR_RANGE, "config.format: %d is outside [0, 3]", o.format);
    if (o.kind < -1 || o.kind > RDM_ROBOT_ARM)
      refuse(RDM_ERROR_RANGE, "config.kind: %d is outside [-1, 2]", o.kind);
    if (o.skip_meshes != 0 && o.skip_meshes != 1)
      refuse(RDM_ERROR_RANGE, "config.skip_meshes: %d is outside [0, 1]", o.skip_meshes);
    if (o.mend_inertia != 0 && o.mend_inertia != 1)
      refuse(RDM_ERROR_RANGE, "config.mend_inertia: %d is outside [0, 1]", o.mend_inertia);
    if (!(o.density >= 0 && o.density <= 1e5))
      refuse(RDM_ERROR_RANGE, "config.density: %g is outside [0, 1e5]", o.density);
    if (!(o.slide_range >= 0 && o.slide_range <= 1e6))
      refuse(RDM_ERROR_RANGE, "config.slide_range: %g is outside [0, 1e6]", o.slide_range);
  }
  Options out;
  const auto text = [](const char* t) { return std::string(t ? t : ""); };
  out.format = o.format;
  out.kind = o.kind;
  out.skip_meshes = o.skip_meshes != 0;
  out.mend_inertia = o.mend_inertia != 0;
  out.density = o.density;
  out.slide_range = o.slide_range;
  out.name = text(o.name);
  out.folder = text(o.folder);
  if (!out.folder.empty() && out.folder.back() != '/') out.folder += '/';
  out.has_folder = o.folder != nullptr;
  out.packages = text(o.packages);
  out.root = text(o.root);
  out.palm = text(o.palm);
  out.tips = text(o.tips);
  out.mount = text(o.mount);
  out.flange = text(o.flange);
  return out;
}

// What rdm_robot_create says of it, but that nothing is added: under a name that is taken the robot is looked
// at, and then refused for its name alone.
void try_create(rdm_robot_def def) {
  rdm_robot taken{};
  taken.struct_size = sizeof taken;
  if (const rdm_result r = rdm_robot_at(0, &taken)) refuse(r, "%s", rdm_last_error());
  const std::string name = def.name ? def.name : "";
  const rdm_robot_def asked = def;
  def.name = taken.name;
  def.alias = nullptr;
  int32_t robot = -1;
  const rdm_result r = rdm_robot_create(&robot, &def);
  std::string text = rdm_last_error();
  const std::string head = std::string("robot ") + taken.name + ": ";
  if (text != head + "the name is already used") {
    if (text.compare(0, head.size(), head) == 0) text.replace(0, head.size(), "robot " + clean(name) + ": ");
    refuse(r ? r : RDM_ERROR_INTERNAL, "%s", text.c_str());
  }
  // Names are looked at before the rows are, so that a wrong one is told first.
  def.name = asked.name;
  def.num_links = 0;
  (void)rdm_robot_create(&robot, &def);
  text = rdm_last_error();
  if (text.find("the name is") != std::string::npos || text.find("a name is made of") != std::string::npos)
    refuse(RDM_ERROR_ARGUMENT, "%s", text.c_str());
}

// An option that would change the robot, in a format that does not take it.
void need_taken(const Options& o, int32_t format) {
  if (format == RDM_IMPORT_MJCF && o.density > 0)
    refuse(RDM_ERROR_ARGUMENT,
           "config.density: it is for URDF only; a geom of MJCF has its own mass or density, or 1000 kg/m3");
  if (format != RDM_IMPORT_ROBOT) return;
  const std::pair<const char*, bool> said[] = {
      {"density", o.density > 0},    {"slide_range", o.slide_range > 0}, {"root", !o.root.empty()},
      {"palm", !o.palm.empty()},     {"tips", !o.tips.empty()},          {"mount", !o.mount.empty()},
      {"flange", !o.flange.empty()},
  };
  for (const auto& [name, given] : said)
    if (given)
      refuse(RDM_ERROR_ARGUMENT, "config.%s: it is for URDF and MJCF only; a .robot file contains it", name);
}

// XML that is not well-formed up to its first element too.
bool begins_as_xml(const std::string& bytes) {
  const size_t at = bytes.find_first_not_of(" \t\r\n\xef\xbb\xbf");
  return at != std::string::npos && bytes[at] == '<';
}

bool names_xml(const std::string& path) {
  const std::string ending = path.substr(std::min(path.rfind('.'), path.size()));
  return ending == ".urdf" || ending == ".xml" || ending == ".mjcf" || ending == ".xacro";
}

void read(const std::string& bytes, const Options& options, Draft* out) {
  int32_t format = options.format;
  if (format == RDM_IMPORT_AUTO) {
    const std::string element = first_element(bytes);
    format = element == "mujoco" || element == "mujocoinclude" ? RDM_IMPORT_MJCF
             : !element.empty()                                ? RDM_IMPORT_URDF
             : !begins_as_xml(bytes)                           ? RDM_IMPORT_ROBOT
             : bytes.find("<mujoco") != std::string::npos      ? RDM_IMPORT_MJCF
                                                               : RDM_IMPORT_URDF;
  }
  need_taken(options, format);
  if (format == RDM_IMPORT_MJCF)
    read_mjcf(bytes, options, out);
  else if (format == RDM_IMPORT_URDF)
    read_urdf(bytes, options, out);
  else
    read_robot(bytes, options, out);
  try_create(out->def);
}

void give(rdm_import** out, std::unique_ptr<rdm_import> made) {
  *out = made.release();
}

constexpr size_t kLongestPath = 120;  // of a name in a text

int32_t read_named_task(const std::string& bytes, const std::string& file) {
  try {
    return read_task(bytes, file);
  } catch (const Refusal& r) {
    if (file.empty()) throw;
    throw Refusal{r.code, file + ": " + r.text};
  }
}

}  // namespace

rdm_result rdm_import_config_init(rdm_import_config* c, size_t size) {
  return call(nullptr, [&] {
    need(c, "config");
    if (size < sizeof *c || size > kMaxStruct)
      refuse(RDM_ERROR_ARGUMENT, "size: %zu is outside [%zu, %zu]", size, sizeof *c, kMaxStruct);
    std::memset(static_cast<void*>(c), 0, size);
    rdm_import_config o = defaults();
    o.struct_size = static_cast<uint32_t>(size);
    std::memcpy(c, &o, sizeof o);
  });
}

rdm_result rdm_import_read_file(rdm_import** out, const char* path, const rdm_import_config* c) {
  return call(c, [&] {
    need(out, "out");
    need(path, "path");
    Options o = read_options(c);
    if (!o.has_folder) o.folder = folder_of(path), o.has_folder = true;
    const std::string bytes = read_file(path, kMostXml);
    auto made = std::make_unique<rdm_import>();
    try {
      if (o.format == RDM_IMPORT_AUTO && names_xml(path) && !begins_as_xml(bytes))
        refuse(RDM_ERROR_FORMAT, "line 1: this is not XML: it does not begin with <");
      read(bytes, o, &made->draft);
    } catch (const Refusal& r) {
      refuse(r.code, "%s: %s", clean(path, 160).c_str(), r.text.c_str());
    }
    give(out, std::move(made));
  });
}

rdm_result rdm_import_read(rdm_import** out, const void* bytes, size_t size, const rdm_import_config* c) {
  return call(c, [&] {
    need(out, "out");
    if (size > 0) need(bytes, "bytes");
    if (size > kMostXml) refuse(RDM_ERROR_RANGE, "size: %zu is outside [0, %zu]", size, kMostXml);
    const Options o = read_options(c);
    auto made = std::make_unique<rdm_import>();
    read(std::string(static_cast<const char*>(bytes), size), o, &made->draft);
    give(out, std::move(made));
  });
}

rdm_result rdm_import_create_robot(rdm_import** out, int32_t robot) {
  return call(nullptr, [&] {
    need(out, "out");
    auto made = std::make_unique<rdm_import>();
    read_built(robot, &made->draft);
    give(out, std::move(made));
  });
}

void rdm_import_destroy(rdm_import* i) {
  if (!i || i->tag != rdm_import::kTag) return;
  *const_cast<volatile uint32_t*>(&i->tag) = 0;
  delete i;
}

rdm_result rdm_import_get_robot_def(const rdm_import* i, rdm_robot_def* io) {
  return call(nullptr, [&] {
    need_robot(i);
    need(io, "io");
    if (io->struct_size < sizeof *io || io->struct_size > kMaxStruct)
      refuse(RDM_ERROR_ARGUMENT, "io.struct_size: %u is outside [%zu, %zu]; set it by rdm_robot_def_init",
             io->struct_size, sizeof *io, kMaxStruct);
    const uint32_t size = io->struct_size;
    std::memset(static_cast<void*>(io), 0, size);
    *io = i->draft.def;
    io->struct_size = size;
  });
}

int32_t rdm_import_note_count(const rdm_import* i) {
  return i && i->tag == rdm_import::kTag ? static_cast<int32_t>(i->draft.notes.size()) : 0;
}

rdm_result rdm_import_note_at(const rdm_import* i, int32_t n, rdm_import_note* out) {
  return call(nullptr, [&] {
    need_handle(i);
    need(out, "out");
    const int32_t count = rdm_import_note_count(i);
    if (n < 0 || n >= count) refuse(RDM_ERROR_RANGE, "n: %d is outside [0, %d)", n, count);
    const Note& note = i->draft.notes[static_cast<size_t>(n)];
    *out = {note.kind, note.line, note.text.c_str()};
  });
}

rdm_result rdm_import_check(rdm_import* i) {
  return call(nullptr, [&] {
    need_robot(i);
    try_create(i->draft.def);
    check_robot(&i->draft);
  });
}

rdm_result rdm_import_write_robot(const rdm_robot_def* def, char* text, size_t capacity, size_t* size) {
  return call(nullptr, [&] {
    need(def, "def");
    need(size, "size");
    if (def->struct_size < sizeof *def || def->struct_size > kMaxStruct)
      refuse(RDM_ERROR_ARGUMENT, "def.struct_size: %u is outside [%zu, %zu]; set it by rdm_robot_def_init",
             def->struct_size, sizeof *def, kMaxStruct);
    const std::string out = write_robot(*def);
    if (text && capacity < out.size() + 1)
      refuse(RDM_ERROR_RANGE, "capacity: %zu is outside [%zu, ...]", capacity, out.size() + 1);
    *size = out.size();
    if (text) std::memcpy(text, out.c_str(), out.size() + 1);
  });
}

rdm_result rdm_import_read_task_file(int32_t* task, const char* path) {
  return call(nullptr, [&] {
    need(task, "task");
    need(path, "path");
    *task = read_named_task(read_file(path, kMostToml), clean(path, kLongestPath));
  });
}

rdm_result rdm_import_read_task(int32_t* task, const void* bytes, size_t size, const char* file) {
  return call(nullptr, [&] {
    need(task, "task");
    if (size > 0) need(bytes, "bytes");
    if (size > kMostToml) refuse(RDM_ERROR_RANGE, "size: %zu is outside [0, %zu]", size, kMostToml);
    *task = read_named_task(std::string(static_cast<const char*>(bytes), size),
                            file ? clean(file, kLongestPath) : "");
  });
}

namespace {

rdm_import* made_object(const std::string& bytes) {
  auto made = std::make_unique<rdm_import>();
  made->object = std::make_unique<ObjectDraft>();
  read_object(bytes, made->object.get());
  if (const rdm_result r = rdm_object_check(&made->object->def)) refuse(r, "%s", rdm_last_error());
  return made.release();
}

}  // namespace

rdm_result rdm_import_read_object_file(rdm_import** out, const char* path) {
  return call(nullptr, [&] {
    need(out, "out");
    need(path, "path");
    const std::string bytes = read_file(path, kMostToml);
    try {
      *out = made_object(bytes);
    } catch (const Refusal& r) {
      refuse(r.code, "%s: %s", clean(path, 160).c_str(), r.text.c_str());
    }
  });
}

rdm_result rdm_import_read_object(rdm_import** out, const void* bytes, size_t size) {
  return call(nullptr, [&] {
    need(out, "out");
    if (size > 0) need(bytes, "bytes");
    if (size > kMostToml) refuse(RDM_ERROR_RANGE, "size: %zu is outside [0, %zu]", size, kMostToml);
    *out = made_object(std::string(static_cast<const char*>(bytes), size));
  });
}

rdm_result rdm_import_create_object(rdm_import** out, int32_t object) {
  return call(nullptr, [&] {
    need(out, "out");
    auto made = std::make_unique<rdm_import>();
    made->object = std::make_unique<ObjectDraft>();
    read_built_object(object, made->object.get());
    *out = made.release();
  });
}

rdm_result rdm_import_get_object_def(const rdm_import* i, rdm_object_def* io) {
  return call(nullptr, [&] {
    need_handle(i);
    if (!i->object) refuse(RDM_ERROR_ARGUMENT, "import: it is a robot, not an object");
    need(io, "io");
    if (io->struct_size < sizeof *io || io->struct_size > kMaxStruct)
      refuse(RDM_ERROR_ARGUMENT, "io.struct_size: %u is outside [%zu, %zu]; set it by rdm_object_def_init",
             io->struct_size, sizeof *io, kMaxStruct);
    const uint32_t size = io->struct_size;
    std::memset(static_cast<void*>(io), 0, size);
    *io = i->object->def;
    io->struct_size = size;
  });
}

rdm_result rdm_import_write_object(const rdm_object_def* def, char* text, size_t capacity, size_t* size) {
  return call(nullptr, [&] {
    need(def, "def");
    need(size, "size");
    if (def->struct_size < sizeof *def || def->struct_size > kMaxStruct)
      refuse(RDM_ERROR_ARGUMENT, "def.struct_size: %u is outside [%zu, %zu]; set it by rdm_object_def_init",
             def->struct_size, sizeof *def, kMaxStruct);
    const std::string out = write_object(*def);
    if (text && capacity < out.size() + 1)
      refuse(RDM_ERROR_RANGE, "capacity: %zu is outside [%zu, ...]", capacity, out.size() + 1);
    *size = out.size();
    if (text) std::memcpy(text, out.c_str(), out.size() + 1);
  });
}

const char* rdm_import_error(void) {
  return t_error;
}
