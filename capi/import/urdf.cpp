// URDF. Links are bodies, joints hang them together; what is fixed is merged by build().
#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "fill.hpp"
#include "meshes.hpp"
#include "urdf_table.hpp"
#include "xml.hpp"

namespace rdm::import {
namespace {

struct Reader {
  Reader(const Element& file, const Options& given, Draft* draft) : robot(file), options(given), out(draft) {}
  const Element& robot;
  const Options& options;
  Draft* out;
  Meshes meshes{options, out};
  Model model;
  std::map<std::string, const Element*> links;
  struct Joint {
    const Element* element;
    std::string name, type, parent, child;
  };
  std::vector<Joint> joints;
  std::map<std::string, size_t> above;               // joint whose child the link is
  std::map<std::string, std::vector<size_t>> below;  // joints whose parent it is
  std::set<std::string> taken;                       // links that became bodies

  static std::string needed(const Element& e, const char* attribute) {
    const std::string* text = e.get(attribute);
    if (!text || text->empty()) refuse_at(RDM_ERROR_FORMAT, e, "%s is missing", attribute);
    refuse_xacro(e, attribute, *text);
    return *text;
  }
  static double given(const Element& e, const char* attribute, double otherwise) {
    const std::string* text = e.get(attribute);
    return text ? number(e, attribute, *text) : otherwise;
  }
  static Pose origin_of(const Element& e) {
    Pose X;
    if (const Element* o = e.child("origin")) {
      if (const std::string* xyz = o->get("xyz")) X.p = vector3(*o, "xyz", *xyz);
      if (const std::string* rpy = o->get("rpy")) X.q = from_rpy(vector3(*o, "rpy", *rpy));
      if (const std::string* quat = o->get("quat_xyzw")) {
        if (o->find("rpy")) refuse_at(RDM_ERROR_FORMAT, *o, "it has both rpy and quat_xyzw");
        const auto n = numbers(*o, "quat_xyzw", *quat, 4, 4);
        if (n[0] * n[0] + n[1] * n[1] + n[2] * n[2] + n[3] * n[3] < 1e-18)
          refuse_at(RDM_ERROR_ARGUMENT, *o, "quat_xyzw: its length is 0");
        X.q = normalized(Turn{n[3], n[0], n[1], n[2]});
      }
    }
    return X;
  }

  void find_links() {
    for (const Element* e : robot.all("link")) {
      if (!links.emplace(needed(*e, "name"), e).second) refuse_at(RDM_ERROR_ARGUMENT, *e, "it occurs twice");
    }
    if (links.empty()) refuse_at(RDM_ERROR_FORMAT, robot, "there is no link");
  }
  const Element& link(const Element& joint, const char* which, const std::string& name) const {
    const auto found = links.find(name);
    if (found != links.end()) return *found->second;
    std::vector<std::string> names;
    for (const auto& [known, e] : links) names.push_back(known);
    refuse_at(RDM_ERROR_NOT_FOUND, joint, "%s %s: there is no link of this name%s", which,
              clean(name).c_str(), nearest_hint(name, names).c_str());
  }

  void find_joints() {
    std::map<std::string, const Element*> names;
    for (const Element* e : robot.all("joint")) {
      Joint j{e, needed(*e, "name"), needed(*e, "type"), "", ""};
      for (const char* which : {"parent", "child"}) {
        const Element* end = e->child(which);
        if (!end) refuse_at(RDM_ERROR_FORMAT, *e, "%s is missing", which);
        const std::string name = needed(*end, "link");
        link(*e, which, name);
        (which[0] == 'p' ? j.parent : j.child) = name;
      }
      if (!names.emplace(j.name, e).second) refuse_at(RDM_ERROR_ARGUMENT, *e, "it occurs twice");
      const auto [other, first] = above.emplace(j.child, joints.size());
      if (!first)
        refuse_at(RDM_ERROR_ARGUMENT, *e, "link %s has two parents: this joint and joint %s of line %d",
                  clean(j.child).c_str(), clean(joints[other->second].name).c_str(),
                  joints[other->second].element->line);
      below[j.parent].push_back(joints.size());
      joints.push_back(j);
    }
  }

  std::string find_root() const {
    if (!options.root.empty()) {
      if (links.count(options.root)) return options.root;
      std::vector<std::string> names;
      for (const auto& [known, e] : links) names.push_back(known);
      refuse(RDM_ERROR_NOT_FOUND, "config.root: there is no link %s%s", clean(options.root).c_str(),
             nearest_hint(options.root, names).c_str());
    }
    const Element* root = nullptr;
    for (const auto& child : robot.children)
      if (child->tag == "link" && !above.count(child->find("name")->value)) {
        if (root)
          refuse_at(RDM_ERROR_ARGUMENT, *child,
                    "it has no parent joint, and neither has %s of line %d; set config.root to one of them",
                    where(*root).substr(where(*root).find(": ") + 2).c_str(), root->line);
        root = child.get();
      }
    if (!root)
      refuse_at(RDM_ERROR_ARGUMENT, *joints[0].element, "the joints form a loop: every link has a parent");
    return root->find("name")->value;
  }

  // `moves`: by a joint of its own. What is fixed may have moments alone, which what carries it takes.
  Mass mass_of(const Element& l, bool moves) {
    Mass out_mass;
    const Element* inertial = l.child("inertial");
    if (!inertial) return out_mass;
    const std::string what = "link " + clean(l.find("name")->value);
    const Element *mass = inertial->child("mass"), *inertia = inertial->child("inertia");
    if (!mass) refuse_at(RDM_ERROR_FORMAT, *inertial, "%s has no mass", what.c_str());
    if (!inertia) refuse_at(RDM_ERROR_FORMAT, *inertial, "%s has no inertia", what.c_str());
    const Pose X = origin_of(*inertial);
    const double m = number(*mass, "value", needed(*mass, "value"));
    double i[6];
    const char* const keys[6] = {"ixx", "iyy", "izz", "ixy", "ixz", "iyz"};
    for (int k = 0; k < 6; ++k) i[k] = given(*inertia, keys[k], 0);
    const char* const mirrored[3] = {"iyx", "izx", "izy"};
    for (int k = 0; k < 3; ++k)
      if (given(*inertia, mirrored[k], i[3 + k]) != i[3 + k])
        refuse_at(RDM_ERROR_FORMAT, *inertia, "%s: %s is not %s", what.c_str(), mirrored[k], keys[3 + k]);
    const M3 moment{{{i[0], i[3], i[4]}, {i[3], i[1], i[5]}, {i[4], i[5], i[2]}}};
    const bool point = std::all_of(i, i + 6, [](double x) { return x == 0; });
    if (m == 0 && (point || !moves)) {
      Mass one{1, {}, moment};
      if (!point) check_mass(*inertia, what, options.mend_inertia, &one, out);
      out->note(RDM_NOTE_CHANGED, mass->line, "%s has no mass%s", what.c_str(),
                point ? "" : "; its moments of inertia were added to its parent's");
      return X * Mass{0, {}, one.moment};
    }
    if (!(m > 0)) refuse_at(RDM_ERROR_RANGE, *mass, "%s: the mass %g is not above 0", what.c_str(), m);
    Mass read{m, {}, moment};
    check_mass(*inertia, what, options.mend_inertia, &read, out);
    return X * read;
  }

  // ROS reads the first of them, and so do the simulators that read URDF.
  void note_more_inertials(const Element& l) {
    const auto all = l.all("inertial");
    for (size_t k = 1; k < all.size(); ++k) {
      mark(*all[k]);
      out->note(RDM_NOTE_CHANGED, all[k]->line,
                "link %s: its second inertial was ignored, as in ROS; the one of line %d counts",
                clean(l.find("name")->value).c_str(), all[0]->line);
    }
  }
  // At the density that options say for links without inertial, or an inertial's own (Isaac Gym's way).
  double density_of(const Element& l) const {
    const Element* inertial = l.child("inertial");
    if (!inertial) return options.density;
    const Element* density = inertial->child("density");
    return density && !inertial->child("mass") ? number(*density, "value", needed(*density, "value")) : 0;
  }
  // Of density 1: inside a closed surface, else (open, or both sides of a sheet) of its hull, else of the
  // shape that stands for it.
  Mass mass_of(const Mesh& mesh, const Primitive& shape) const {
    constexpr double kLeast = 1e-6;  // of the shape, for a surface with an inside
    Mass one = is_closed(mesh) ? filled(mesh, Fill::kExact, &out->budget) : Mass{};
    if (one.mass > kLeast * volume_of(shape)) return one;
    const std::vector<V3> corners = corners_of(mesh.points);
    if (corners.size() <= kMostOfHull) one = filled(Mesh{corners, {}}, Fill::kConvex, &out->budget);
    return one.mass > kLeast * volume_of(shape) ? one : solid(shape);
  }
  void weigh(const Element& l, double density, BodyIn* body) {
    for (const Mass& m : weighed) body->mass = body->mass + scaled(density, m);
    if (body->mass.mass > 0)
      out->note(RDM_NOTE_GUESSED, l.line, "link %s: mass %.4g kg, from its shapes at %g kg/m3",
                clean(body->name).c_str(), body->mass.mass, density);
  }
  std::vector<Mass> weighed;  // shapes of the link at hand, of density 1

  // A mark of a place, as of contacts: nothing can touch it.
  static bool is_point(const Element& shape) {
    const std::string* size = shape.tag == "box" ? shape.get("size") : nullptr;
    if (shape.tag == "sphere") size = shape.get("radius");
    if (!size) return false;
    const auto n = numbers(shape, shape.tag == "box" ? "size" : "radius", *size, 1, 3);
    return std::all_of(n.begin(), n.end(), [](double x) { return x == 0; });
  }

  void add_shapes(const Element& l, BodyIn* body, bool weighs) {
    weighed.clear();
    for (const Element* c : l.all("collision")) {
      ShapeIn s;
      s.element = c;
      if (const std::string* name = c->get("name")) s.name = *name;
      const Pose X = origin_of(*c);
      const Element* geometry = c->child("geometry");
      if (!geometry) refuse_at(RDM_ERROR_FORMAT, *c, "link %s has no geometry", clean(body->name).c_str());
      const Element* g = nullptr;
      for (const char* kind : {"box", "cylinder", "sphere", "capsule", "mesh"})
        if (!g) g = geometry->child(kind);
      if (!g)
        refuse_at(RDM_ERROR_UNSUPPORTED, *geometry,
                  "link %s: its geometry must be a box, cylinder, sphere, capsule or mesh",
                  clean(body->name).c_str());
      if (is_point(*g)) {
        out->note(RDM_NOTE_DROPPED, g->line, "link %s: a %s without a size", clean(body->name).c_str(),
                  g->tag.c_str());
        continue;
      }
      Primitive& p = s.shape;
      const auto size = [&](const char* key) {
        const double x = number(*g, key, needed(*g, key));
        if (!(x > 0))
          refuse_at(RDM_ERROR_RANGE, *g, "link %s: %s %g is not above 0", clean(body->name).c_str(), key, x);
        return x;
      };
      if (g->tag == "box") {
        const V3 sides = vector3(*g, "size", needed(*g, "size"));
        for (int k = 0; k < 3; ++k)
          if (!(sides[k] > 0))
            refuse_at(RDM_ERROR_RANGE, *g, "link %s: size %g is not above 0", clean(body->name).c_str(),
                      sides[k]);
        p = {RDM_SHAPE_BOX, 0.5 * sides, X};
      } else if (g->tag == "mesh") {
        const std::string file = needed(*g, "filename");
        V3 scale{1, 1, 1};
        if (const std::string* text = g->get("scale")) scale = vector3(*g, "scale", *text);
        const Mesh* mesh = meshes.find(*g, file);
        if (!mesh) continue;
        std::vector<V3> points = mesh->points;
        for (V3& v : points) v = {scale.x * v.x, scale.y * v.y, scale.z * v.z};
        p = around(points);
        if (weighs) weighed.push_back(X * mass_of(Mesh{points, mesh->faces}, p));
        p.X = X * p.X;
        out->note(RDM_NOTE_CHANGED, g->line, "mesh %s is %s", clean(file).c_str(),
                  p.kind == RDM_SHAPE_BOX       ? "a box"
                  : p.kind == RDM_SHAPE_CAPSULE ? "a capsule"
                                                : "a sphere");
      } else {
        p = {RDM_SHAPE_SPHERE, {size("radius"), 0, 0}, X};
        if (g->tag != "sphere")
          p = {g->tag == "cylinder" ? RDM_SHAPE_CYLINDER : RDM_SHAPE_CAPSULE,
               {p.size.x, size("length") / 2, 0},
               X};
      }
      if (weighs && g->tag != "mesh") weighed.push_back(solid(p));
      body->shapes.push_back(s);
    }
  }

  JointIn moving(const Joint& j) {
    JointIn o;
    o.name = j.name;
    o.element = j.element;
    o.slides = j.type == "prismatic";
    o.axis = {1, 0, 0};
    if (const Element* axis = j.element->child("axis")) {
      o.axis = vector3(*axis, "xyz", needed(*axis, "xyz"));
      if (norm(o.axis) < 1e-6) refuse_at(RDM_ERROR_ARGUMENT, *j.element, "its axis is 0");
      o.axis = unit(o.axis);
    }
    const Element* limit = j.element->child("limit");
    const bool continuous = j.type == "continuous";
    if (!limit && !continuous) refuse_at(RDM_ERROR_FORMAT, *j.element, "it has no limit");
    if (continuous) {
      o.lower = -2 * M_PI, o.upper = 2 * M_PI;
      out->note(RDM_NOTE_CHANGED, j.element->line, "joint %s has no limits: its range is set to +-2 pi",
                clean(j.name).c_str());
    } else {
      const double most = most_of(options, o.slides);
      const auto end = [&](const char* key) {
        const std::string* text = limit->get(key);
        const double x = text ? bound(*limit, key, *text) : 0;
        if (std::isfinite(x)) return x;
        out->note(RDM_NOTE_CHANGED, limit->line, "joint %s: %s %s means no limit, and was replaced by %g",
                  clean(j.name).c_str(), key, clean(*text).c_str(), std::copysign(most, x));
        return std::copysign(most, x);
      };
      o.lower = end("lower");
      o.upper = end("upper");
      if (!(o.lower < o.upper))
        refuse_at(RDM_ERROR_RANGE, *limit, "joint %s: the range [%g, %g] is empty", clean(j.name).c_str(),
                  o.lower, o.upper);
    }
    if (limit) {
      const auto most = [&](const char* key, double otherwise) {  // infinite: not said
        const std::string* text = limit->get(key);
        const double x = text ? bound(*limit, key, *text) : otherwise;
        if (std::isfinite(x)) return x;
        out->note(RDM_NOTE_CHANGED, limit->line, "joint %s: %s %s is not a bound, and was ignored",
                  clean(j.name).c_str(), key, clean(*text).c_str());
        return otherwise;
      };
      o.effort = most("effort", -1);
      if (o.effort == 0)
        out->note(RDM_NOTE_CHANGED, limit->line, "joint %s: effort 0 means none, so the effort is guessed",
                  clean(j.name).c_str());
      o.velocity = most("velocity", 0);
      if (o.velocity < 0)
        out->note(RDM_NOTE_CHANGED, limit->line, "joint %s: velocity %g is not a bound, and was ignored",
                  clean(j.name).c_str(), std::exchange(o.velocity, 0));
    }
    if (const Element* dynamics = j.element->child("dynamics")) {
      if (const auto* t = dynamics->get("damping"))
        o.damping = numbers(*dynamics, "damping", *t, 1, 1, kMostDamping)[0];
      o.friction = given(*dynamics, "friction", 0);
      if (o.damping < 0 || o.friction < 0)
        refuse_at(RDM_ERROR_RANGE, *dynamics, "joint %s: damping %g or friction %g is below 0",
                  clean(j.name).c_str(), o.damping, o.friction);
    }
    if (const Element* mimic = j.element->child("mimic"))
      model.couplings.push_back({j.name, needed(*mimic, "joint"), given(*mimic, "multiplier", 1),
                                 given(*mimic, "offset", 0), 0, mimic});
    return o;
  }

  // The link and what hangs on it, in the order of the joints.
  void add(const std::string& name, int parent, const Joint* joint, int depth) {
    if (depth > 200) refuse_at(RDM_ERROR_RANGE, *joint->element, "there are more than 200 links in a chain");
    const Element& l = *links.at(name);
    BodyIn body;
    body.name = name;
    body.element = &l;
    body.parent = parent;
    if (joint) {
      body.X = origin_of(*joint->element);
      if (joint->type == "revolute" || joint->type == "continuous" || joint->type == "prismatic") {
        body.joints.push_back(moving(*joint));
      } else if (joint->type == "floating" && parent == 0) {
        out->note(RDM_NOTE_DROPPED, joint->element->line,
                  "joint %s is floating: it was replaced by a fixed one", clean(joint->name).c_str());
      } else if (joint->type != "fixed") {
        refuse_at(RDM_ERROR_UNSUPPORTED, *joint->element,
                  "type %s is not supported: it must be revolute, continuous, prismatic or fixed",
                  clean(joint->type).c_str());
      } else {  // said of fixed joints without a meaning
        for (const char* tag : {"axis", "limit", "dynamics"})
          if (const Element* e = joint->element->child(tag)) mark(*e);
      }
    }
    note_more_inertials(l);
    const double density = density_of(l);
    if (density < 0) refuse_at(RDM_ERROR_RANGE, l, "density: %g is below 0", density);
    if (density == 0) body.mass = mass_of(l, !body.joints.empty());
    add_shapes(l, &body, density > 0);
    if (density > 0) weigh(l, density, &body);
    model.bodies.push_back(std::move(body));
    const int self = static_cast<int>(model.bodies.size()) - 1;
    taken.insert(name);
    for (const size_t j : below[name]) add(joints[j].child, self, &joints[j], depth + 1);
  }
  void mark(const Element& e) {
    for (const Attribute& a : e.attributes) a.read = true;
    for (const auto& c : e.children) c->seen = true, mark(*c);
  }

  void read() {
    robot.get("name");
    if (options.density == 0)
      model.massless_hint =
          "; set config.density to compute masses of links without inertial from their collision shapes";
    model.name = robot.find("name") ? robot.find("name")->value : "";
    find_links();
    find_joints();
    const std::string root = find_root();
    add(root, -1, nullptr, 0);
    if (options.root.empty() && model.bodies.size() != links.size()) {
      for (const auto& [name, e] : links)
        if (!taken.count(name))
          refuse_at(RDM_ERROR_ARGUMENT, *e, "it is in a loop of joints, and not below the root %s",
                    clean(root).c_str());
    }
    if (!options.root.empty())
      for (const auto& [name, e] : links)
        if (!taken.count(name)) {
          out->note(RDM_NOTE_DROPPED, e->line, "link %s is not below config.root", clean(name).c_str());
          mark(*e);
        }
  }
};

}  // namespace

void read_urdf(const std::string& bytes, const Options& options, Draft* out) {
  const auto robot = parse_xml(bytes, options, false, out);
  if (robot->tag != "robot")
    refuse_at(RDM_ERROR_FORMAT, *robot, "this is not URDF: the first element is not robot");
  check_urdf(*robot);
  Reader reader(*robot, options, out);
  reader.read();
  list_dropped(*robot, out);
  build(reader.model, options, out);
}

}  // namespace rdm::import
