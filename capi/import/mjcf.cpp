// The kinematic subset of MJCF: bodies, hinges and slides, primitives and meshes, default classes, couplings
// by equalities and fixed tendons, position actuators, the first keyframe. What cannot change the robot is
// dropped and listed; the rest is refused (mjcf_table.cpp).
#include "mjcf.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>

namespace rdm::import {
namespace {

// The default that a tag takes: all kinds of actuators share one, and so do both kinds of tendons.
std::string kind_of_default(const std::string& tag) {
  for (const char* other :
       {"geom", "joint", "mesh", "site", "tendon", "equality", "material", "camera", "light", "pair"})
    if (tag == other) return tag;
  return "actuator";
}
const char* table_of_default(const std::string& kind) {
  if (kind == "tendon") return "fixed";
  if (kind == "equality") return "equality/joint";
  for (const char* known : {"joint", "geom", "mesh"})
    if (kind == known) return known;
  return nullptr;
}

void mark(const Element& e) {
  e.seen = true;
  for (const Attribute& a : e.attributes) a.read = true;
  for (const auto& c : e.children) mark(*c);
}

}  // namespace

std::string in_file(const Element& e) {
  return e.file.empty() ? "" : " (in " + clean(e.file) + ")";
}

const std::string* MjcfReader::value(const Element& e, const char* key, const std::string& childclass,
                                     const char* kind) const {
  if (const std::string* own = e.get(key)) return own;
  const std::string* named = e.get("class");
  const std::string& c = named ? *named : childclass;
  const auto in = classes.find(c.empty() ? "main" : c);
  if (in == classes.end()) {
    if (c.empty()) return nullptr;
    std::vector<std::string> names;
    for (const auto& [name, values] : classes) names.push_back(name);
    refuse_at(RDM_ERROR_NOT_FOUND, e, "there is no class %s%s", clean(c).c_str(),
              nearest_hint(c, names).c_str());
  }
  const std::string tag = kind ? kind : e.tag, name = key;
  for (const Class* at = in->second; at; at = at->parent) {
    out->budget.spend(Cost::kSteps, 1);
    const auto of = at->values.find(tag);
    if (of == at->values.end()) continue;
    const auto found = of->second.find(name);
    if (found == of->second.end()) continue;
    // a long text of a class may be parsed for every element, so it is charged by its length
    out->budget.spend(Cost::kSteps, found->second->value.size() / 16);
    found->second->read = true;
    return &found->second->value;
  }
  return nullptr;
}

double MjcfReader::number_of(const Element& e, const char* key, const std::string& c, double otherwise,
                             const char* kind) const {
  const std::string* text = value(e, key, c, kind);
  return text ? number(e, key, *text) : otherwise;
}

bool MjcfReader::flag(const Element& e, const char* key, const std::string& text) const {
  if (text == "true") return true;
  if (text == "false") return false;
  refuse_at(RDM_ERROR_FORMAT, e, "%s: %s is neither true nor false", key, clean(text).c_str());
}

bool MjcfReader::limited(const Element& e, const char* key, const std::string* limited,
                         const std::string* range) const {
  if (limited && *limited != "auto") return flag(e, key, *limited);
  if (!range) return false;
  const auto n = numbers(e, "range", *range, 2, 2);
  const bool has_range = n[0] != 0 || n[1] != 0;
  if (has_range && !compiler.autolimits)
    refuse_at(RDM_ERROR_FORMAT, e,
              "it has a range but no %s, and autolimits is false: it is not clear whether the range holds",
              key);
  return has_range;
}

// ---- poses ----
Turn MjcfReader::turn_at(const Element& e, const std::string& c) const {
  static constexpr const char* kWays[] = {"quat", "axisangle", "euler", "xyaxes", "zaxis"};
  // A rotation has one of five forms; a form on the element itself overrides any form of its class.
  const bool own = std::any_of(std::begin(kWays), std::end(kWays), [&](const char* w) { return e.find(w); });
  const auto said = [&](const char* key) { return own ? e.get(key) : value(e, key, c); };
  if (const auto* t = said("quat")) {
    const auto n = numbers(e, "quat", *t, 4, 4);
    const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] + n[3] * n[3]);
    if (length < 1e-9) refuse_at(RDM_ERROR_ARGUMENT, e, "quat: its length is 0");
    return normalized(Turn{n[0], n[1], n[2], n[3]});
  }
  if (const auto* t = said("axisangle")) {
    const auto n = numbers(e, "axisangle", *t, 4, 4);
    if (norm({n[0], n[1], n[2]}) < 1e-9) refuse_at(RDM_ERROR_ARGUMENT, e, "axisangle: its axis is 0");
    return axis_angle(unit({n[0], n[1], n[2]}), angle(n[3]));
  }
  if (const auto* t = said("euler")) {
    const auto n = numbers(e, "euler", *t, 3, 3);
    Turn q;
    for (size_t k = 0; k < 3; ++k) {
      const char letter = compiler.sequence[k];
      V3 axis;
      axis[std::tolower(letter) - 'x'] = 1;
      const Turn one = axis_angle(axis, angle(n[k]));
      q = std::islower(letter) ? q * one : one * q;  // small letters turn with the body
    }
    return q;
  }
  if (const auto* t = said("xyaxes")) {
    const auto n = numbers(e, "xyaxes", *t, 6, 6);
    const V3 raw_x{n[0], n[1], n[2]}, raw{n[3], n[4], n[5]};
    const V3 x = unit(raw_x), across = raw - dot(raw, x) * x;
    if (norm(raw_x) < 1e-9 || norm(across) < 1e-9)
      refuse_at(RDM_ERROR_ARGUMENT, e, "xyaxes: an axis is 0, or the two are parallel");
    const V3 y = unit(across), z = cross(x, y);
    return turn_of({{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}});
  }
  if (const auto* t = said("zaxis")) {
    const V3 raw = vector3(e, "zaxis", *t), z = unit(raw);
    if (norm(raw) < 1e-9) refuse_at(RDM_ERROR_ARGUMENT, e, "zaxis: its length is 0");
    if (z.z < 0 && norm(cross({0, 0, 1}, z)) < 1e-10) return {0, 1, 0, 0};  // half a turn about x
    return turn_between({0, 0, 1}, z);
  }
  return {};
}

Pose MjcfReader::pose_at(const Element& e, const std::string& c) const {
  Pose X;
  if (const auto* t = value(e, "pos", c)) X.p = vector3(e, "pos", *t);
  X.q = turn_at(e, c);
  return X;
}

// ---- sections ----
void MjcfReader::read_classes(const Element& e, const Class* parent, bool top) {
  const std::string* name = e.get("class");
  const std::string key = name ? *name : top ? "main" : "";
  if (key.empty()) refuse_at(RDM_ERROR_FORMAT, e, "a class within a class needs a name");
  check_children(e, "default");
  const Class*& row = classes[key];
  if (row && !top) refuse_at(RDM_ERROR_ARGUMENT, e, "class %s occurs twice", clean(key).c_str());
  // A second <default> of the file adds to the first one's class; classes read before do not change by it.
  Class& c = class_rows.emplace_back();
  c.parent = row ? row : parent;
  row = &c;
  for (const auto& child : e.children) {
    if (child->tag == "default") continue;
    const std::string kind = kind_of_default(child->tag);
    if (kind == "actuator")
      for (const char* known : {"general", "motor", "position", "velocity", "intvelocity"}) {
        if (child->tag == known) check_attributes(*child, kind);
      }
    if (const char* table = table_of_default(kind)) check_attributes(*child, table);
    child->seen = true;
    Values& values = c.values[kind];
    for (const Attribute& a : child->attributes) values[a.name] = &a;
  }
  for (const Element* child : e.all("default")) read_classes(*child, &c, false);
}

void MjcfReader::read_compiler() {
  for (const Element* e : mujoco.all("compiler")) {
    check_attributes(*e, "compiler");
    const auto read_flag = [&](const char* key, bool* into) {
      if (const auto* t = e->get(key)) *into = flag(*e, key, *t);
    };
    const auto read_number = [&](const char* key, double* into) {
      if (const auto* t = e->get(key)) *into = number(*e, key, *t);
    };
    if (const auto* t = e->get("angle")) {
      if (*t != "degree" && *t != "radian")
        refuse_at(RDM_ERROR_FORMAT, *e, "angle: %s is neither degree nor radian", clean(*t).c_str());
      compiler.degrees = *t == "degree";
    }
    read_flag("autolimits", &compiler.autolimits);
    read_flag("balanceinertia", &compiler.balance);
    read_flag("strippath", &compiler.strip);
    read_flag("exactmeshinertia", &compiler.exact);
    read_flag("fitaabb", &compiler.fit_box);
    if (const auto* t = e->get("eulerseq")) {
      compiler.sequence = *t;
      if (t->size() != 3 || t->find_first_not_of("xyzXYZ") != std::string::npos)
        refuse_at(RDM_ERROR_FORMAT, *e, "eulerseq: %s must be three letters out of x, y, z",
                  clean(*t).c_str());
    }
    if (const auto* t = e->get("assetdir")) compiler.meshes = *t;
    if (const auto* t = e->get("meshdir")) compiler.meshes = *t;
    if (const auto* t = e->get("inertiafromgeom")) {
      compiler.inertia_from = *t;
      if (*t != "auto") (void)flag(*e, "inertiafromgeom", *t);
    }
    if (const auto* t = e->get("inertiagrouprange")) {
      const auto n = numbers(*e, "inertiagrouprange", *t, 2, 2);
      compiler.first_group = static_cast<int>(n[0]), compiler.last_group = static_cast<int>(n[1]);
    }
    read_number("boundmass", &compiler.least_mass);
    read_number("boundinertia", &compiler.least_moment);
    read_number("settotalmass", &compiler.total_mass);
    if (const auto* t = e->get("coordinate"))
      if (*t != "local") refuse_at(RDM_ERROR_UNSUPPORTED, *e, "coordinate: only local is supported");
  }
  for (const auto& o : mujoco.children)
    for (const auto& f : o->children) {
      if (o->tag != "option" || f->tag != "flag") continue;
      check_attributes(*f, "flag");
      for (const Attribute& a : f->attributes) {
        if (a.name != "frictionloss" && a.name != "damper") continue;
        a.read = f->seen = true;
        (a.name == "damper" ? compiler.damping : compiler.friction) = a.value != "disable";
      }
    }
  mesh_options = options;
  if (!compiler.meshes.empty()) {
    std::string folder = compiler.meshes;
    if (folder.back() != '/') folder += '/';
    mesh_options.folder = folder[0] == '/' ? folder : options.folder + folder;
  }
}

void MjcfReader::read_assets() {
  for (const Element* a : mujoco.all("asset")) {
    check_children(*a, "asset");
    for (const Element* m : a->all("mesh")) {
      const std::string *name = m->get("name"), *file = m->get("file");
      std::string key = name ? *name : "";
      if (key.empty() && file) {
        key = file->substr(file->rfind('/') == std::string::npos ? 0 : file->rfind('/') + 1);
        key = key.substr(0, key.rfind('.'));
      }
      if (key.empty()) refuse_at(RDM_ERROR_FORMAT, *m, "it has neither a name nor a file");
      if (!assets.emplace(key, m).second)
        refuse_at(RDM_ERROR_ARGUMENT, *m, "mesh %s occurs twice", clean(key).c_str());
    }
  }
}

void MjcfReader::read_excluded() {
  for (const Element* c : mujoco.all("contact")) {
    check_children(*c, "contact");
    for (const Element* x : c->all("exclude")) {
      const std::string *a = x->get("body1"), *b = x->get("body2");
      if (a && b) model.excluded.emplace_back(*a, *b);
    }
  }
}

void MjcfReader::read_keyframe() {
  for (const Element* all : mujoco.all("keyframe")) {
    const Element* k = all->child("key");
    if (!k) continue;
    const std::string* qpos = k->get("qpos");
    if (!qpos) continue;
    const auto n = numbers(*k, "qpos", *qpos, 0, 100000);
    size_t needed = 0;
    for (const std::string& name : order) needed += name.empty() ? 7 : 1;
    if (n.size() != needed) {
      out->note(RDM_NOTE_DROPPED, k->line, "key: qpos has %zu numbers, but these joints need %zu", n.size(),
                needed);
      return;
    }
    size_t at = 0;
    for (const std::string& name : order) {
      if (!name.empty()) model.home[name] = n[at];
      at += name.empty() ? 7 : 1;
    }
    return;
  }
}

void MjcfReader::read() {
  mujoco.get("model");
  if (const Attribute* name = mujoco.find("model")) model.name = name->value;
  check_children(mujoco, "mujoco");
  for (const auto& d : mujoco.children)
    if (d->tag == "deformable") check_children(*d, "deformable");
  read_compiler();
  classes["main"] = &class_rows.emplace_back();
  for (const Element* d : mujoco.all("default")) read_classes(*d, classes["main"], true);
  read_assets();
  read_worlds();
  scale_masses();
  for (BodyIn& b : model.bodies)
    for (JointIn& j : b.joints)
      if (!joint_by.emplace(j.name, &j).second)
        refuse_at(RDM_ERROR_ARGUMENT, *j.element, "joint %s occurs twice", clean(j.name).c_str());
  find_driven();
  read_tendons();
  read_equalities();
  read_tendon_limits();
  lead_by_driven();
  read_actuators();
  read_excluded();
  read_keyframe();
  if (!options.root.empty())  // bodies outside of config.root are not listed one by one as dropped
    for (const Element* w : mujoco.all("worldbody")) mark(*w);
}

void read_mjcf(const std::string& bytes, const Options& options, Draft* out) {
  const auto mujoco = parse_xml(bytes, options, true, out);
  if (mujoco->tag == "mujocoinclude")
    refuse_at(RDM_ERROR_FORMAT, *mujoco, "this file is a part that other files include, not a model");
  if (mujoco->tag != "mujoco")
    refuse_at(RDM_ERROR_FORMAT, *mujoco, "this is not MJCF: the first element is not mujoco");
  MjcfReader reader(*mujoco, options, out);
  reader.read();
  list_dropped(*mujoco, out);
  build(reader.model, options, out);
}

}  // namespace rdm::import
