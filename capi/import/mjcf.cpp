// The kinematic subset of MJCF: bodies, hinges and slides, primitives and meshes, default classes, couplings
// by equalities and fixed tendons, position actuators, the first keyframe. The rest is dropped and listed;
// what would change the robot (closed loops, ball joints, replicated bodies) is refused.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <set>

#include "meshes.hpp"
#include "xml.hpp"

namespace rdm::import {
namespace {

using Values = std::map<std::string, const Attribute*>;  // of one element kind in one class
using Class = std::map<std::string, Values>;             // by element kind

struct Compiler {
  bool degrees = true, autolimits = true, balance = false;
  std::string sequence = "xyz", meshes, inertia_from = "auto";
  bool strip = false;
  double least_mass = 0, least_moment = 0;
};

struct Reader {
  Reader(const Element& file, const Options& given, Draft* draft)
      : mujoco(file), options(given), out(draft), mesh_options(given) {}
  const Element& mujoco;
  const Options& options;
  Draft* out;
  Options mesh_options;  // with the folder of the compiler
  Meshes meshes{mesh_options, out};
  Model model;
  Compiler compiler;
  std::map<std::string, Class> classes;
  std::map<std::string, const Element*> assets;  // meshes by name
  std::map<std::string, JointIn*> joint_by;      // after the bodies are read
  std::vector<std::string> order;                // joints as qpos has them, "" of a free joint
  struct Tendon {
    const Element* element;
    std::vector<std::pair<std::string, double>> joints;
  };
  std::map<std::string, Tendon> tendons;
  bool free_joint = false;

  // ---- values: of the element, else of its class ----
  const std::string* value(const Element& e, const char* key, const std::string& childclass,
                           const char* kind = nullptr) const {
    if (const std::string* own = e.get(key)) return own;
    const std::string* named = e.get("class");
    const std::string& c = named ? *named : childclass;
    const auto in = classes.find(c.empty() ? "main" : c);
    if (in == classes.end()) {
      if (c.empty()) return nullptr;
      std::vector<std::string> names;
      for (const auto& [name, values] : classes) names.push_back(name);
      refuse_at(RDM_NOT_FOUND, e, "there is no class %s%s", clean(c).c_str(), nearest_hint(c, names).c_str());
    }
    const auto of = in->second.find(kind ? kind : e.tag);
    if (of == in->second.end()) return nullptr;
    const auto found = of->second.find(key);
    if (found == of->second.end()) return nullptr;
    found->second->read = true;
    return &found->second->value;
  }
  double number_of(const Element& e, const char* key, const std::string& c, double otherwise) const {
    const std::string* text = value(e, key, c);
    return text ? number(e, key, *text) : otherwise;
  }
  bool flag(const Element& e, const char* key, const std::string& text) const {
    if (text == "true") return true;
    if (text == "false") return false;
    refuse_at(RDM_FORMAT, e, "%s: %s is neither true nor false", key, clean(text).c_str());
  }
  double angle(double x) const { return compiler.degrees ? x * M_PI / 180 : x; }

  void read_classes(const Element& e, const Class& parent, bool top) {
    const std::string* name = e.get("class");
    const std::string key = name ? *name : top ? "main" : "";
    if (key.empty()) refuse_at(RDM_FORMAT, e, "a class in a class needs a name");
    Class c = parent;
    const auto before = classes.find(key);
    if (before != classes.end() && top) c = before->second;
    for (const auto& child : e.children) {
      if (child->tag == "default") continue;
      child->seen = true;
      Values& values = c[child->tag];
      for (const Attribute& a : child->attributes) values[a.name] = &a;
    }
    classes[key] = c;
    for (const Element* child : e.all("default")) read_classes(*child, c, false);
  }

  void read_compiler() {
    for (const Element* e : mujoco.all("compiler")) {
      if (const auto* t = e->get("angle")) {
        if (*t != "degree" && *t != "radian")
          refuse_at(RDM_FORMAT, *e, "angle: %s is neither degree nor radian", clean(*t).c_str());
        compiler.degrees = *t == "degree";
      }
      if (const auto* t = e->get("autolimits")) compiler.autolimits = flag(*e, "autolimits", *t);
      if (const auto* t = e->get("balanceinertia")) compiler.balance = flag(*e, "balanceinertia", *t);
      if (const auto* t = e->get("strippath")) compiler.strip = flag(*e, "strippath", *t);
      if (const auto* t = e->get("eulerseq")) {
        compiler.sequence = *t;
        if (t->size() != 3 || t->find_first_not_of("xyzXYZ") != std::string::npos)
          refuse_at(RDM_FORMAT, *e, "eulerseq: %s is not three of x, y, z", clean(*t).c_str());
      }
      if (const auto* t = e->get("assetdir")) compiler.meshes = *t;
      if (const auto* t = e->get("meshdir")) compiler.meshes = *t;
      if (const auto* t = e->get("inertiafromgeom")) compiler.inertia_from = *t;
      if (const auto* t = e->get("boundmass")) compiler.least_mass = number(*e, "boundmass", *t);
      if (const auto* t = e->get("boundinertia")) compiler.least_moment = number(*e, "boundinertia", *t);
      if (const auto* t = e->get("coordinate"))
        if (*t != "local") refuse_at(RDM_UNSUPPORTED, *e, "coordinate: only local is read");
    }
    mesh_options = options;
    if (!compiler.meshes.empty()) {
      std::string folder = compiler.meshes;
      if (folder.back() != '/') folder += '/';
      mesh_options.folder = folder[0] == '/' ? folder : options.folder + folder;
    }
  }

  void read_assets() {
    for (const Element* a : mujoco.all("asset"))
      for (const Element* m : a->all("mesh")) {
        const std::string *name = m->get("name"), *file = m->get("file");
        std::string key = name ? *name : "";
        if (key.empty() && file) {
          key = file->substr(file->rfind('/') == std::string::npos ? 0 : file->rfind('/') + 1);
          key = key.substr(0, key.rfind('.'));
        }
        if (key.empty()) refuse_at(RDM_FORMAT, *m, "neither a name nor a file");
        if (!assets.emplace(key, m).second)
          refuse_at(RDM_ARGUMENT, *m, "mesh %s stands twice", clean(key).c_str());
      }
  }

  // ---- poses ----
  Turn turn_at(const Element& e, const std::string& c) const {
    if (const auto* t = value(e, "quat", c)) {
      const auto n = numbers(e, "quat", *t, 4, 4);
      const double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] + n[3] * n[3]);
      if (length < 1e-9) refuse_at(RDM_ARGUMENT, e, "quat: its length is 0");
      return normalized({n[1], n[2], n[3], n[0]});
    }
    if (const auto* t = value(e, "axisangle", c)) {
      const auto n = numbers(e, "axisangle", *t, 4, 4);
      if (norm({n[0], n[1], n[2]}) < 1e-9) refuse_at(RDM_ARGUMENT, e, "axisangle: its axis is 0");
      return turn_about(unit({n[0], n[1], n[2]}), angle(n[3]));
    }
    if (const auto* t = value(e, "euler", c)) {
      const auto n = numbers(e, "euler", *t, 3, 3);
      Turn q;
      for (size_t k = 0; k < 3; ++k) {
        const char letter = compiler.sequence[k];
        V3 axis;
        axis[std::tolower(letter) - 'x'] = 1;
        const Turn one = turn_about(axis, angle(n[k]));
        q = std::islower(letter) ? q * one : one * q;  // small letters turn with the body
      }
      return q;
    }
    if (const auto* t = value(e, "xyaxes", c)) {
      const auto n = numbers(e, "xyaxes", *t, 6, 6);
      const V3 x = unit({n[0], n[1], n[2]}, {1, 0, 0}), raw{n[3], n[4], n[5]};
      const V3 y = unit(raw - dot(raw, x) * x, unit(cross({0, 0, 1}, x), {0, 1, 0})), z = cross(x, y);
      return turn_of({{{x.x, y.x, z.x}, {x.y, y.y, z.y}, {x.z, y.z, z.z}}});
    }
    if (const auto* t = value(e, "zaxis", c)) return turn_between({0, 0, 1}, unit(vector3(e, "zaxis", *t)));
    return {};
  }
  Pose pose_at(const Element& e, const std::string& c = "") const {
    Pose X;
    if (const auto* t = value(e, "pos", c)) X.p = vector3(e, "pos", *t);
    X.q = turn_at(e, c);
    return X;
  }

  // ---- shapes ----
  void add_geom(const Element& e, const Pose& frame, const std::string& c, BodyIn* body, Mass* from_geoms) {
    const std::string* type = value(e, "type", c);
    const std::string* mesh_name = value(e, "mesh", c);
    const std::string kind = type ? *type : "sphere";
    const double contype = number_of(e, "contype", c, 1), conaffinity = number_of(e, "conaffinity", c, 1);
    const std::string *mass = value(e, "mass", c), *density = value(e, "density", c);
    const bool visual = contype == 0 && conaffinity == 0,
               counts = from_geoms && !(mass && number(e, "mass", *mass) == 0);
    const char* name = e.find("name") ? e.find("name")->value.c_str() : "";
    if (visual) {
      for (const Attribute& a : e.attributes) a.read = true;
      out->note(RDM_NOTE_DROPPED, e.line, "geom%s%s%s: seen alone (contype and conaffinity 0)%s",
                *name ? " " : "", clean(name).c_str(),
                mesh_name ? (" mesh " + clean(*mesh_name)).c_str() : "", in_file(e).c_str());
      if (!counts) return;
    }
    if (kind == "plane" || kind == "hfield" || kind == "sdf") {
      out->note(RDM_NOTE_DROPPED, e.line, "geom%s%s: type %s%s", *name ? " " : "", clean(name).c_str(),
                clean(kind).c_str(), in_file(e).c_str());
      return;
    }
    Primitive p;
    Mass solid_of;
    p.X = frame * pose_at(e, c);
    if (mesh_name) {
      const auto asset = assets.find(*mesh_name);
      if (asset == assets.end()) {
        std::vector<std::string> names;
        for (const auto& [known, m] : assets) names.push_back(known);
        refuse_at(RDM_NOT_FOUND, e, "there is no mesh %s%s", clean(*mesh_name).c_str(),
                  nearest_hint(*mesh_name, names).c_str());
      }
      const auto fitted = fit(*asset->second, e);
      if (!fitted) return;
      solid_of = p.X * fitted->second;
      p = {fitted->first.kind, fitted->first.size, p.X * fitted->first.X};
      if (!visual)
        out->note(RDM_NOTE_CHANGED, e.line, "mesh %s is %s%s", clean(*mesh_name).c_str(),
                  p.kind == RDM_BOX       ? "a box"
                  : p.kind == RDM_CAPSULE ? "a capsule"
                                          : "a sphere",
                  in_file(e).c_str());
    } else {
      p = primitive(e, kind, c, p.X, frame);
      solid_of = solid(p);
    }
    if (counts && solid_of.mass > 0) {
      const double m =
          mass ? number(e, "mass", *mass) : solid_of.mass * (density ? number(e, "density", *density) : 1000);
      const double factor = m / solid_of.mass;
      solid_of.mass = m;
      for (auto& row : solid_of.moment)
        for (double& x : row) x *= factor;
      *from_geoms = *from_geoms + solid_of;
    }
    if (visual) return;
    ShapeIn s;
    s.name = name;
    s.element = &e;
    s.shape = p;
    s.contype = static_cast<int>(contype);
    s.conaffinity = static_cast<int>(conaffinity);
    if (const auto* t = value(e, "rgba", c)) {
      const auto n = numbers(e, "rgba", *t, 4, 4);
      for (size_t k = 0; k < 3; ++k)
        s.color[k] = static_cast<uint8_t>(std::lround(255 * std::clamp(n[k], 0.0, 1.0)));
    }
    body->shapes.push_back(s);
  }
  static std::string in_file(const Element& e) { return e.file.empty() ? "" : " (in " + clean(e.file) + ")"; }

  const std::pair<Primitive, Mass>* fit(const Element& asset, const Element& geom) {
    const auto known = fits.find(&asset);
    if (known != fits.end()) return &known->second;
    const std::string* file = asset.get("file");
    std::vector<V3> points;
    Mesh mesh;
    if (file) {
      std::string path = *file;
      if (compiler.strip) path = path.substr(path.rfind('/') == std::string::npos ? 0 : path.rfind('/') + 1);
      const Mesh* found = meshes.find(geom, path);
      if (!found) return nullptr;
      mesh = *found;
    } else if (const auto* t = asset.get("vertex")) {
      const auto n = numbers(asset, "vertex", *t, 12, 300000);
      for (size_t k = 0; k + 2 < n.size(); k += 3) mesh.points.push_back({n[k], n[k + 1], n[k + 2]});
    } else {
      refuse_at(RDM_FORMAT, asset, "neither a file nor vertices");
    }
    V3 scale{1, 1, 1};
    if (const auto* t = value(asset, "scale", "")) scale = vector3(asset, "scale", *t);
    Pose back_to;  // refpos and refquat are taken off
    if (const auto* t = asset.get("refpos")) back_to.p = vector3(asset, "refpos", *t);
    if (const auto* t = asset.get("refquat")) {
      const auto n = numbers(asset, "refquat", *t, 4, 4);
      back_to.q = normalized({n[1], n[2], n[3], n[0]});
    }
    for (V3& v : mesh.points) v = back(back_to) * V3{scale.x * v.x, scale.y * v.y, scale.z * v.z};
    const Primitive hull = around(mesh.points);
    const Mass filled = solid(mesh);
    return &(fits[&asset] = {hull, filled.mass > 0 ? filled : solid(hull)});
  }
  std::map<const Element*, std::pair<Primitive, Mass>> fits;

  Primitive primitive(const Element& e, const std::string& kind, const std::string& c, const Pose& X,
                      const Pose& frame) const {
    const bool box = kind == "box", ellipsoid = kind == "ellipsoid", cylinder = kind == "cylinder",
               capsule = kind == "capsule";
    if (!box && !ellipsoid && !cylinder && !capsule && kind != "sphere")
      refuse_at(RDM_UNSUPPORTED, e, "type %s: neither sphere, capsule, cylinder, box, ellipsoid nor mesh",
                clean(kind).c_str());
    const std::string* text = value(e, "size", c);
    auto n = text ? numbers(e, "size", *text, 1, 3) : std::vector<double>();
    Pose at = X;
    const std::string* ends = value(e, "fromto", c);
    double half = 0;
    if (ends && kind != "sphere") {
      const auto f = numbers(e, "fromto", *ends, 6, 6);
      const V3 a{f[0], f[1], f[2]}, b{f[3], f[4], f[5]};
      half = norm(b - a) / 2;
      // The compiler's own way: z from the second end to the first.
      at = frame * Pose{0.5 * (a + b), turn_between({0, 0, 1}, unit(a - b))};
    }
    const size_t needed = kind == "sphere" ? 1 : box || ellipsoid ? 3 : 2;
    if (ends && needed > 1) {
      if (n.empty()) refuse_at(RDM_FORMAT, e, "no size");
      if (needed == 2)
        n = {n[0], half};
      else
        n = {n[0], n.size() > 1 ? n[1] : n[0], half};
    }
    if (n.size() < needed) refuse_at(RDM_FORMAT, e, "size: a %s needs %zu", kind.c_str(), needed);
    for (size_t k = 0; k < needed; ++k)
      if (!(n[k] > 0)) refuse_at(RDM_RANGE, e, "size: %g is not above 0", n[k]);
    n.resize(3, 0);
    const int32_t k = box         ? RDM_BOX
                      : ellipsoid ? RDM_ELLIPSOID
                      : cylinder  ? RDM_CYLINDER
                      : capsule   ? RDM_CAPSULE
                                  : RDM_SPHERE;
    return {k, {n[0], needed > 1 ? n[1] : 0, needed > 2 ? n[2] : 0}, at};
  }

  // ---- bodies ----
  void add_joint(const Element& e, const std::string& c, BodyIn* body) {
    const std::string* type = value(e, "type", c);
    const std::string kind = type ? *type : "hinge";
    if (kind == "free") return drop_free(e);
    if (kind != "hinge" && kind != "slide")
      refuse_at(RDM_UNSUPPORTED, e, "type %s: neither hinge nor slide", clean(kind).c_str());
    JointIn j;
    j.element = &e;
    if (const auto* t = e.get("name")) j.name = *t;
    if (j.name.empty())
      j.name = body->name + "_joint" + (body->joints.empty() ? "" : std::to_string(body->joints.size() + 1));
    j.slides = kind == "slide";
    if (const auto* t = value(e, "pos", c)) j.at = vector3(e, "pos", *t);
    if (const auto* t = value(e, "axis", c)) j.axis = vector3(e, "axis", *t);
    if (norm(j.axis) < 1e-6) refuse_at(RDM_ARGUMENT, e, "its axis is 0");
    j.axis = unit(j.axis);
    const std::string *range = value(e, "range", c), *limited = value(e, "limited", c);
    const bool has =
        limited && *limited != "auto" ? flag(e, "limited", *limited) : range && compiler.autolimits;
    const auto scaled = [&](double x) { return j.slides ? x : angle(x); };
    if (has) {
      const auto n = range ? numbers(e, "range", *range, 2, 2) : std::vector<double>{0, 0};
      j.lower = scaled(n[0]), j.upper = scaled(n[1]);
      if (!(j.lower < j.upper)) refuse_at(RDM_RANGE, e, "the range [%g, %g] is empty", n[0], n[1]);
    } else if (j.slides) {
      refuse_at(RDM_RANGE, e, "it slides without a range");
    } else {
      j.lower = -2 * M_PI, j.upper = 2 * M_PI;
      out->note(RDM_NOTE_CHANGED, e.line, "joint %s turns without end: its range is +-2 pi%s",
                clean(j.name).c_str(), in_file(e).c_str());
    }
    j.turned = scaled(number_of(e, "ref", c, 0));
    j.armature = number_of(e, "armature", c, 0);
    j.damping = number_of(e, "damping", c, 0);
    j.friction = number_of(e, "frictionloss", c, 0);
    for (const double x : {j.armature, j.damping, j.friction})
      if (x < 0) refuse_at(RDM_RANGE, e, "armature, damping or frictionloss is %g", x);
    body->joints.push_back(j);
    order.push_back(j.name);
  }
  void drop_free(const Element& e) {
    out->note(RDM_NOTE_DROPPED, e.line, "%s: the root stands still%s", clean(e.tag).c_str(),
              in_file(e).c_str());
    free_joint = true;
    order.push_back("");
  }

  Mass inertial(const Element& e, const BodyIn& body) {
    const std::string name = clean(body.name);
    Mass m;
    const std::string *mass = e.get("mass"), *diagonal = e.get("diaginertia"), *full = e.get("fullinertia");
    if (!mass) refuse_at(RDM_FORMAT, e, "body %s: no mass", name.c_str());
    m.mass = number(e, "mass", *mass);
    Pose X = pose_at(e);
    if (full) {
      const auto n = numbers(e, "fullinertia", *full, 6, 6);
      m.moment = {{{n[0], n[3], n[4]}, {n[3], n[1], n[5]}, {n[4], n[5], n[2]}}};
    } else if (diagonal) {
      const auto n = numbers(e, "diaginertia", *diagonal, 3, 3);
      for (size_t k = 0; k < 3; ++k) m.moment[k][k] = n[k];
    } else {
      refuse_at(RDM_FORMAT, e, "body %s: neither diaginertia nor fullinertia", name.c_str());
    }
    if (compiler.balance) {
      const auto p = principal(m.moment, nullptr);
      if (p[0] + p[1] < p[2] || p[1] + p[2] < p[0] || p[2] + p[0] < p[1]) {
        const double mean = (p[0] + p[1] + p[2]) / 3;
        m.moment = {{{mean, 0, 0}, {0, mean, 0}, {0, 0, mean}}};
        out->note(RDM_NOTE_CHANGED, e.line, "body %s: its moments are their mean (balanceinertia)",
                  name.c_str());
      }
    }
    bounded(&m);
    check_mass(e, "body " + name, options.mend_inertia, &m, out);
    return X * m;
  }
  void bounded(Mass* m) const {
    m->mass = std::max(m->mass, compiler.least_mass);
    for (size_t k = 0; k < 3; ++k) m->moment[k][k] = std::max(m->moment[k][k], compiler.least_moment);
  }

  // What stands in a body, or in a frame of it.
  void read_parts(const Element& e, const Pose& frame, const std::string& c, int self, Mass* from_geoms,
                  bool* has_inertial, int depth) {
    if (depth > 200) refuse_at(RDM_RANGE, e, "more than 200 bodies in a chain");
    for (const auto& child : e.children) {
      const Element& x = *child;
      const auto body = [&]() -> BodyIn* { return &model.bodies[static_cast<size_t>(self)]; };
      if (x.tag == "frame") {
        x.seen = true;
        const std::string* own = x.get("childclass");
        read_parts(x, frame * pose_at(x), own ? *own : c, self, from_geoms, has_inertial, depth + 1);
      } else if (x.tag == "body") {
        x.seen = true;
        add_body(x, self, frame, c, depth + 1);
      } else if (x.tag == "replicate" || x.tag == "composite" || x.tag == "flexcomp" || x.tag == "attach") {
        refuse_at(RDM_UNSUPPORTED, x, "it would make bodies, and is not read");
      } else if (x.tag == "inertial") {
        x.seen = true;
        if (compiler.inertia_from == "true") continue;
        body()->mass = inertial(x, *body());
        *has_inertial = true;
      } else if (x.tag == "joint") {
        x.seen = true;
        if (self == 0) {
          const std::string* type = value(x, "type", c);
          if (type && *type == "free") {
            drop_free(x);
            continue;
          }
        }
        add_joint(x, c, body());
      } else if (x.tag == "freejoint") {
        x.seen = true;
        drop_free(x);
      } else if (x.tag == "geom") {
        x.seen = true;
        add_geom(x, frame, c, body(), from_geoms);
      } else if (x.tag == "site") {
        if (const Attribute* name = x.find("name")) {
          model.frames.push_back({name->value, self, frame * pose_at(x, c)});
          out->note(RDM_NOTE_DROPPED, x.line, "site %s: its frame can be named in options%s",
                    clean(name->value).c_str(), in_file(x).c_str());
          x.seen = true;
          for (const Attribute& a : x.attributes) a.read = true;
        }
      }
    }
  }

  void add_body(const Element& e, int parent, const Pose& frame, const std::string& c, int depth) {
    BodyIn body;
    if (const auto* t = e.get("name")) body.name = *t;
    if (body.name.empty()) body.name = format("body_%zu", model.bodies.size());
    body.element = &e;
    body.parent = parent;
    body.X = frame * pose_at(e);
    const std::string* own = e.get("childclass");
    model.bodies.push_back(body);
    const size_t self = model.bodies.size() - 1;
    Mass from_geoms;
    bool has_inertial = false;
    // With inertia from geoms only where there is no inertial: found before the shapes are read.
    const bool has =
        compiler.inertia_from != "true" &&
        std::any_of(e.children.begin(), e.children.end(), [](const auto& x) { return x->tag == "inertial"; });
    if (!has && compiler.inertia_from == "false") {
      const bool moves =
          std::any_of(e.children.begin(), e.children.end(), [](const auto& x) { return x->tag == "joint"; });
      if (moves) refuse_at(RDM_RANGE, e, "it moves and has no inertial, and inertiafromgeom is false");
    }
    read_parts(e, {}, own ? *own : c, static_cast<int>(self),
               has || compiler.inertia_from == "false" ? nullptr : &from_geoms, &has_inertial, depth);
    BodyIn& read = model.bodies[self];
    if (!has_inertial && from_geoms.mass > 0) {
      bounded(&from_geoms);
      read.mass = from_geoms;
      out->note(RDM_NOTE_GUESSED, e.line, "body %s: mass %.4g from its shapes%s", clean(read.name).c_str(),
                from_geoms.mass, in_file(e).c_str());
    }
  }

  static void mark(const Element& e) {
    e.seen = true;
    for (const Attribute& a : e.attributes) a.read = true;
    for (const auto& c : e.children) mark(*c);
  }
  static const Element* below(const Element& e, const std::string& name) {
    for (const auto& c : e.children) {
      if (c->tag == "body" && c->find("name") && c->find("name")->value == name) return c.get();
      if (const Element* found = below(*c, name)) return found;
    }
    return nullptr;
  }

  void read_worlds() {
    std::vector<const Element*> top;
    const Element* first = nullptr;
    std::string none;
    for (const Element* w : mujoco.all("worldbody")) {
      if (!first) first = w;
      for (const auto& c : w->children)
        if (c->tag == "body" || c->tag == "frame") top.push_back(c.get());
    }
    if (top.empty()) refuse_at(RDM_FORMAT, mujoco, "no body in the world");
    const auto add_root = [&](const Element& e, const std::string& c) {
      e.seen = true;
      const bool moves = std::any_of(e.children.begin(), e.children.end(), [&](const auto& x) {
        const std::string* type =
            x->tag == "joint" ? value(*x, "type", e.find("childclass") ? e.find("childclass")->value : c)
                              : nullptr;
        return x->tag == "joint" && !(type && *type == "free");
      });
      if (moves) {  // the world carries it
        BodyIn world;
        world.name = "world";
        world.element = &e;
        model.bodies.push_back(world);
        add_body(e, 0, {}, c, 1);
        return;
      }
      add_body(e, -1, {}, c, 0);
      const Pose X = model.bodies[0].X;
      if (norm(X.p) > 1e-9 || std::abs(X.q.w) < 1 - 1e-12)
        out->note(RDM_NOTE_DROPPED, e.line,
                  "body %s: where it stands in the world; its own frame is the root",
                  clean(model.bodies[0].name).c_str());
      model.bodies[0].X = {};
    };
    if (options.root == "world") {
      BodyIn world;
      world.name = "world";
      world.element = first;
      model.bodies.push_back(world);
      for (const Element* w : mujoco.all("worldbody")) {
        Mass mass;
        bool has = false;
        read_parts(*w, {}, "", 0, &mass, &has, 0);
      }
      return;
    }
    if (!options.root.empty()) {
      for (const Element* w : mujoco.all("worldbody"))
        if (const Element* found = below(*w, options.root)) {
          std::string c;
          class_above(*w, found, "", &c);
          add_root(*found, c);
          return;
        }
      refuse(RDM_NOT_FOUND, "options.root: there is no body %s", clean(options.root).c_str());
    }
    if (top.size() > 1 || top[0]->tag == "frame")
      refuse_at(RDM_ARGUMENT, *top.back(),
                "%zu bodies or frames stand in the world: options.root says which is taken, or \"world\"",
                top.size());
    add_root(*top[0], "");
  }
  bool class_above(const Element& e, const Element* wanted, const std::string& c, std::string* found) const {
    for (const auto& x : e.children) {
      if (x.get() == wanted) {
        *found = c;
        return true;
      }
      const Attribute* own = x->tag == "body" || x->tag == "frame" ? x->find("childclass") : nullptr;
      if (class_above(*x, wanted, own ? own->value : c, found)) return true;
    }
    return false;
  }

  // ---- what couples and drives ----
  bool known(const std::string& joint) const { return joint_by.count(joint) > 0; }
  void need_joint(const Element& e, const std::string& joint) const {
    if (known(joint)) return;
    std::vector<std::string> names;
    for (const auto& [name, j] : joint_by) names.push_back(name);
    refuse_at(RDM_NOT_FOUND, e, "there is no joint %s%s", clean(joint).c_str(),
              nearest_hint(joint, names).c_str());
  }
  // With options.root a part of the file's joints is not there.
  bool elsewhere(const Element& e, const std::string& joint) const {
    if (known(joint) || options.root.empty() || options.root == "world") {
      need_joint(e, joint);
      return false;
    }
    return true;
  }

  void read_tendons() {
    for (const Element* t : mujoco.all("tendon"))
      for (const Element* f : t->all("fixed")) {
        Tendon o{f, {}};
        bool here = true;
        for (const Element* j : f->all("joint")) {
          const std::string *name = j->get("joint"), *coef = j->get("coef");
          if (!name || !coef) refuse_at(RDM_FORMAT, *j, "no joint or no coef");
          here = here && !elsewhere(*j, *name);
          o.joints.emplace_back(*name, number(*j, "coef", *coef));
          if (o.joints.back().second == 0) refuse_at(RDM_RANGE, *j, "coef: 0");
        }
        const Attribute* name = f->find("name");
        if (here && !o.joints.empty()) tendons[name ? name->value : format("line %d", f->line)] = o;
      }
  }

  void read_equalities() {
    for (const Element* all : mujoco.all("equality")) {
      for (const auto& child : all->children) {
        const Element& e = *child;
        if (const auto* active = value(e, "active", ""))
          if (*active == "false") continue;
        if (e.tag == "connect" || e.tag == "weld") {
          if (!options.root.empty()) {
            bool here = false;
            for (const char* key : {"body1", "body2"})
              if (const auto* b = e.get(key))
                for (const BodyIn& body : model.bodies) here = here || body.name == *b;
            if (!here) continue;
          }
          refuse_at(RDM_UNSUPPORTED, e, "%s closes a loop of bodies: a robot is a tree", e.tag.c_str());
        }
        if (e.tag != "joint" && e.tag != "tendon") continue;
        e.seen = true;
        std::vector<double> coefficients{0, 1, 0, 0, 0};
        if (const auto* t = value(e, "polycoef", "")) {
          const auto n = numbers(e, "polycoef", *t, 1, 5);
          std::copy(n.begin(), n.end(), coefficients.begin());
        }
        for (size_t k = 2; k < 5; ++k)
          if (coefficients[k] != 0)
            refuse_at(RDM_UNSUPPORTED, e, "polycoef: a coupling is linear, not of power %zu", k);
        if (e.tag == "joint") {
          const std::string *one = e.get("joint1"), *two = e.get("joint2");
          if (!one) refuse_at(RDM_FORMAT, e, "no joint1");
          if (elsewhere(e, *one)) continue;
          if (!two) refuse_at(RDM_UNSUPPORTED, e, "a joint held at one place: make it fixed");
          if (elsewhere(e, *two)) continue;
          // Both angles count from where the file's pose is.
          const double r1 = joint_by[*one]->turned, r2 = joint_by[*two]->turned;
          model.couplings.push_back(
              {*one, *two, coefficients[1], coefficients[0] + r1 - coefficients[1] * r2, 0, &e});
        } else {
          e.seen = false;
        }
      }
    }
    // A tendon whose length has limits holds its second joint to its first.
    for (const auto& [name, t] : tendons) {
      const std::string *range = value(*t.element, "range", ""), *limited = value(*t.element, "limited", "");
      const bool has = limited && *limited != "auto" ? flag(*t.element, "limited", *limited)
                                                     : range && compiler.autolimits;
      if (!has || !range) continue;
      if (t.joints.size() != 2) continue;
      const auto n = numbers(*t.element, "range", *range, 2, 2);
      if (!(n[0] <= n[1])) refuse_at(RDM_RANGE, *t.element, "the range [%g, %g] is empty", n[0], n[1]);
      // The joint that has an actuator leads.
      const auto& [a, ca] = t.joints[0];
      const auto& [b, cb] = t.joints[1];
      const bool a_leads = driven.count(a) && !driven.count(b);
      const std::string &leader = a_leads ? a : b, &follower = a_leads ? b : a;
      const double cl = a_leads ? ca : cb, cf = a_leads ? cb : ca;
      model.couplings.push_back(
          {follower, leader, -cl / cf, (n[0] + n[1]) / 2 / cf, (n[1] - n[0]) / 2 / std::abs(cf), t.element});
      out->note(RDM_NOTE_CHANGED, t.element->line, "tendon %s: joint %s follows %s", clean(name).c_str(),
                clean(follower).c_str(), clean(leader).c_str());
    }
  }
  std::set<std::string> driven;  // joints with an actuator of their own

  void find_driven() {
    for (const Element* all : mujoco.all("actuator"))
      for (const auto& e : all->children)
        if (const Attribute* j = e->find("joint")) driven.insert(j->value);
  }

  void read_actuators() {
    for (const Element* all : mujoco.all("actuator"))
      for (const auto& child : all->children) read_actuator(*child);
  }
  void read_actuator(const Element& e) {
    const bool position = e.tag == "position" || e.tag == "intvelocity", general = e.tag == "general";
    if (!position && !general && e.tag != "motor" && e.tag != "velocity") return;
    const std::string *joint = e.get("joint"), *tendon = e.get("tendon");
    if (!joint && !tendon) return;
    const auto get = [&](const char* key) {
      const std::string* own = value(e, key, "");
      return own || general ? own : value(e, key, "", "general");
    };
    JointIn* j = nullptr;
    double share = 1, per = 1;  // of a tendon's force to the joint; its length per angle of the leader
    std::vector<std::pair<JointIn*, double>> others;  // that it pulls, and their shares
    if (tendon) {
      const auto found = tendons.find(*tendon);
      if (found == tendons.end()) {
        if (options.root.empty())
          refuse_at(RDM_NOT_FOUND, e, "there is no fixed tendon %s", clean(*tendon).c_str());
        return;
      }
      const Tendon& t = found->second;
      const std::string& leader = t.joints[0].first;
      share = t.joints[0].second;
      j = joint_by[leader];
      // The shares that spend least motion on the tendon's length are as its coefficients.
      double squares = 0;
      for (const auto& [name, c] : t.joints) squares += c * c;
      for (size_t k = 1; k < t.joints.size(); ++k) {
        const auto& [name, c] = t.joints[k];
        others.emplace_back(joint_by[name], c);
        const bool coupled =
            std::any_of(model.couplings.begin(), model.couplings.end(), [&](const CouplingIn& x) {
              return x.follower == name || (x.follower == leader && x.leader == name);
            });
        if (coupled) continue;
        model.couplings.push_back({name, leader, c / share, 0, 0, &e});
        out->note(RDM_NOTE_CHANGED, e.line, "tendon %s: joint %s follows %s", clean(*tendon).c_str(),
                  clean(name).c_str(), clean(leader).c_str());
      }
      per = squares / share;
    } else {
      if (elsewhere(e, *joint)) return;
      j = joint_by[*joint];
    }
    e.seen = true;
    e.get("name");
    double gear = 1;
    if (const auto* t = get("gear")) gear = numbers(e, "gear", *t, 1, 6)[0];
    if (gear == 0) refuse_at(RDM_RANGE, e, "gear: 0");
    per *= gear;
    double effort = -1;
    if (const auto* t = get("forcerange")) {
      const auto n = numbers(e, "forcerange", *t, 2, 2);
      effort = std::max(std::abs(n[0]), std::abs(n[1])) * std::abs(gear);
    }
    const std::string* range = get("ctrlrange");
    auto limits = range ? numbers(e, "ctrlrange", *range, 2, 2) : std::vector<double>();
    double kp = 0, kv = 0;
    if (position) {
      kp = 1;
      if (const auto* t = get("kp")) kp = number(e, "kp", *t);
      if (const auto* t = get("kv")) kv = number(e, "kv", *t);
    } else if (general) {
      const std::string *bias = get("biastype"), *gain = get("gainprm"), *prm = get("biasprm");
      get("dyntype"), get("gaintype");
      if (bias && *bias == "affine" && prm) {
        const auto b = numbers(e, "biasprm", *prm, 1, 10);
        const auto g = gain ? numbers(e, "gainprm", *gain, 1, 10) : std::vector<double>{1};
        kp = b.size() > 1 ? -b[1] : 0;
        kv = b.size() > 2 ? -b[2] : 0;
        // Commands in another unit than the joint's: the gain takes them there.
        if (kp > 0)
          for (double& x : limits) x *= g[0] / kp;
      }
    }
    if (kp < 0 || kv < 0) refuse_at(RDM_RANGE, e, "kp %g or kv %g is below 0", kp, kv);
    if (kp == 0) {
      if (!limits.empty() && effort <= 0)
        effort = std::max(std::abs(limits[0]), std::abs(limits[1])) * std::abs(gear);
      out->note(RDM_NOTE_CHANGED, e.line, "%s %s: no position actuator; its effort alone is taken",
                e.tag.c_str(), clean(e.find("name") ? e.find("name")->value : "").c_str());
    } else if (limits.size() == 2 && limits[0] < limits[1]) {
      j->has_command = true;
      j->command_low = std::min(limits[0] / per, limits[1] / per);
      j->command_high = std::max(limits[0] / per, limits[1] / per);
    }
    // A joint feels its share of the force; all gains are those of the leader's angle, in each one's own.
    others.insert(others.begin(), {j, share});
    for (const auto& [joint_in, part] : others) {
      if (effort > 0) joint_in->effort = effort * std::abs(part);
      if (kp == 0) continue;
      joint_in->kp = kp * std::abs(share * gear * per);
      joint_in->kd = kv * std::abs(share * gear * per);
    }
  }

  void read_keyframe() {
    for (const Element* all : mujoco.all("keyframe")) {
      const Element* k = all->child("key");
      if (!k) continue;
      const std::string* qpos = k->get("qpos");
      if (!qpos) continue;
      const auto n = numbers(*k, "qpos", *qpos, 0, 100000);
      size_t needed = 0;
      for (const std::string& name : order) needed += name.empty() ? 7 : 1;
      if (n.size() != needed) {
        out->note(RDM_NOTE_DROPPED, k->line, "key: qpos has %zu numbers, these joints %zu", n.size(), needed);
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

  void read() {
    mujoco.get("model");
    if (const Attribute* name = mujoco.find("model")) model.name = name->value;
    read_compiler();
    for (const Element* d : mujoco.all("default")) read_classes(*d, {}, true);
    read_assets();
    read_worlds();
    for (BodyIn& b : model.bodies)
      for (JointIn& j : b.joints)
        if (!joint_by.emplace(j.name, &j).second)
          refuse_at(RDM_ARGUMENT, *j.element, "joint %s stands twice", clean(j.name).c_str());
    find_driven();
    read_tendons();
    read_equalities();
    read_actuators();
    if (const Element* c = mujoco.child("contact"))
      for (const Element* x : c->all("exclude")) {
        const std::string *a = x->get("body1"), *b = x->get("body2");
        if (a && b) model.excluded.emplace_back(*a, *b);
      }
    read_keyframe();
    if (!options.root.empty())  // the other bodies are not news one by one
      for (const Element* w : mujoco.all("worldbody")) mark(*w);
  }
};

}  // namespace

void read_mjcf(const std::string& bytes, const Options& options, Draft* out) {
  const auto mujoco = parse_xml(bytes, options, true);
  if (mujoco->tag != "mujoco") refuse_at(RDM_FORMAT, *mujoco, "no MJCF: the first element is not mujoco");
  Reader reader(*mujoco, options, out);
  reader.read();
  list_dropped(*mujoco, out);
  build(reader.model, options, out);
}

}  // namespace rdm::import
