// Bodies, their joints and what they weigh.
#include <algorithm>
#include <cmath>
#include <functional>

#include "mjcf.hpp"

namespace rdm::import {
namespace {

// A body that stands in the world or in frames of it.
struct Top {
  const Element* body;
  Pose frame;
  std::string childclass;
};

const Element* below(const Element& e, const std::string& name) {
  for (const auto& c : e.children) {
    if (c->tag == "body" && c->find("name") && c->find("name")->value == name) return c.get();
    if (const Element* found = below(*c, name)) return found;
  }
  return nullptr;
}

}  // namespace

// ---- joints ----
void MjcfReader::add_joint(const Element& e, const Pose& frame, const std::string& c, BodyIn* body) {
  check_attributes(e, "joint");
  const std::string* type = value(e, "type", c);
  const std::string kind = type ? *type : "hinge";
  if (kind == "free") return drop_free(e);
  if (kind != "hinge" && kind != "slide")
    refuse_at(RDM_ERROR_UNSUPPORTED, e, "type %s is not supported: it must be hinge or slide",
              clean(kind).c_str());
  JointIn j;
  j.element = &e;
  if (const auto* t = e.get("name")) j.name = *t;
  if (j.name.empty())
    j.name = body->name + "_joint" + (body->joints.empty() ? "" : std::to_string(body->joints.size() + 1));
  j.slides = kind == "slide";
  if (const auto* t = value(e, "pos", c)) j.at = vector3(e, "pos", *t);
  if (const auto* t = value(e, "axis", c)) j.axis = vector3(e, "axis", *t);
  if (norm(j.axis) < 1e-6) refuse_at(RDM_ERROR_ARGUMENT, e, "its axis is 0");
  j.at = frame * j.at;
  j.axis = frame.q * unit(j.axis);
  const std::string* range = value(e, "range", c);
  const auto scaled = [&](double x) { return j.slides ? x : angle(x); };
  if (limited(e, "limited", value(e, "limited", c), range)) {
    const auto n = range ? numbers(e, "range", *range, 2, 2) : std::vector<double>{0, 0};
    j.lower = scaled(n[0]), j.upper = scaled(n[1]);
    if (!(j.lower < j.upper)) refuse_at(RDM_ERROR_RANGE, e, "the range [%g, %g] is empty", n[0], n[1]);
  } else {
    j.upper = most_of(options, j.slides);
    j.lower = -j.upper;
    const std::string end = j.slides && options.slide_range > 0 ? format("%g", j.upper) : "2 pi";
    out->note(RDM_NOTE_CHANGED, e.line, "joint %s %s without limits: its range is set to +-%s%s%s",
              clean(j.name).c_str(), j.slides ? "slides" : "turns", end.c_str(), j.slides ? " m" : "",
              in_file(e).c_str());
  }
  j.turned = scaled(number_of(e, "ref", c, 0));
  j.armature = number_of(e, "armature", c, 0);
  const auto coefficient = [&](const char* key) {
    const auto* t = value(e, key, c);
    const auto n = t ? numbers(e, key, *t, 1, 3, kMostDamping) : std::vector<double>{0};
    if (std::any_of(n.begin() + 1, n.end(), [](double x) { return x != 0; }))
      refuse_at(RDM_ERROR_UNSUPPORTED, e, "%s: only the first number of a polynomial is read", key);
    return n[0];
  };
  j.damping = coefficient("damping");
  j.friction = number_of(e, "frictionloss", c, 0);
  for (const double x : {j.armature, j.damping, j.friction})
    if (x < 0) refuse_at(RDM_ERROR_RANGE, e, "armature, damping or frictionloss is %g", x);
  if (!compiler.damping) j.damping = 0;
  if (!compiler.friction) j.friction = 0;
  const std::string* most = value(e, "actuatorfrcrange", c);
  if (most && limited(e, "actuatorfrclimited", value(e, "actuatorfrclimited", c), most)) {
    const auto n = numbers(e, "actuatorfrcrange", *most, 2, 2);
    j.most_effort = std::max(std::abs(n[0]), std::abs(n[1]));
  }
  body->joints.push_back(j);
  order.push_back(j.name);
}

void MjcfReader::drop_free(const Element& e) {
  if (e.tag == "freejoint") check_attributes(e, "freejoint");
  out->note(RDM_NOTE_DROPPED, e.line, "%s: the root is fixed%s", clean(e.tag).c_str(), in_file(e).c_str());
  order.emplace_back();
}

// ---- masses ----
Mass MjcfReader::inertial(const Element& e, const BodyIn& body, bool moves) {
  check_attributes(e, "inertial");
  const std::string name = clean(body.name);
  Mass m;
  const std::string *mass = e.get("mass"), *diagonal = e.get("diaginertia"), *full = e.get("fullinertia");
  if (!mass) refuse_at(RDM_ERROR_FORMAT, e, "body %s has no mass", name.c_str());
  m.mass = number(e, "mass", *mass);
  const Pose X = pose_at(e);
  if (full) {
    for (const char* other : {"diaginertia", "quat", "axisangle", "euler", "xyaxes", "zaxis"})
      if (e.find(other)) refuse_at(RDM_ERROR_FORMAT, e, "body %s: fullinertia and %s", name.c_str(), other);
    const auto n = numbers(e, "fullinertia", *full, 6, 6);
    m.moment = {{{n[0], n[3], n[4]}, {n[3], n[1], n[5]}, {n[4], n[5], n[2]}}};
  } else if (diagonal) {
    const auto n = numbers(e, "diaginertia", *diagonal, 3, 3);
    for (size_t k = 0; k < 3; ++k) m.moment[k][k] = n[k];
  }
  // Neither: a point, which does for what is fixed to another body.
  bound(e, name, &m);
  const auto p = principal(m.moment, nullptr);
  const bool point = p[0] == 0 && p[1] == 0 && p[2] == 0;
  if (m.mass == 0 && (point || !moves)) {  // a frame alone, or moments that what carries it takes
    Mass one = m;
    one.mass = 1;
    if (!point) check_mass(e, "body " + name, options.mend_inertia, &one, out);
    m.moment = one.moment;
    out->note(RDM_NOTE_CHANGED, e.line, "body %s has no mass%s", name.c_str(), in_file(e).c_str());
    return X * m;
  }
  check_mass(e, "body " + name, options.mend_inertia, &m, out);
  return X * m;
}

// boundmass, boundinertia and balanceinertia, in this order.
void MjcfReader::bound(const Element& e, const std::string& name, Mass* m) {
  m->mass = std::max(m->mass, compiler.least_mass);
  M3 axes;
  auto p = principal(m->moment, &axes);
  bool changed = false;
  for (double& x : p) {
    if (!(compiler.least_moment > 0 && x < compiler.least_moment)) continue;
    changed = true;
    x = compiler.least_moment;
  }
  const double sum = p[0] + p[1] + p[2];
  if (compiler.balance && std::any_of(p.begin(), p.end(), [&](double x) { return sum - x < x; })) {
    p = {sum / 3, sum / 3, sum / 3};
    changed = true;
    out->note(RDM_NOTE_CHANGED, e.line,
              "body %s: its moments of inertia were replaced by their mean (balanceinertia)", name.c_str());
  }
  if (changed) m->moment = turned(turn_of(axes), {{{p[0], 0, 0}, {0, p[1], 0}, {0, 0, p[2]}}});
}

// ---- bodies ----
bool MjcfReader::moves(const Element& e, const std::string& c) const {
  const Attribute* own = e.find("childclass");
  const std::string& inner = own ? own->value : c;
  return std::any_of(e.children.begin(), e.children.end(), [&](const auto& x) {
    if (x->tag == "frame") return moves(*x, inner);
    const std::string* type = x->tag == "joint" ? value(*x, "type", inner) : nullptr;
    return x->tag == "joint" && !(type && *type == "free");
  });
}

// A body that its host moves (mocap) is no part of a robot; where nothing of it touches it is dropped.
bool MjcfReader::drops_mocap(const Element& e, const std::string& c) const {
  const Attribute *mocap = e.find("mocap"), *own = e.find("childclass");
  if (!mocap || mocap->value != "true") return false;
  const std::string& inner = own ? own->value : c;
  return std::all_of(e.children.begin(), e.children.end(), [&](const auto& x) {
    if (x->tag == "geom")
      return number_of(*x, "contype", inner, 1) == 0 && number_of(*x, "conaffinity", inner, 1) == 0;
    return x->tag != "body" && x->tag != "frame" && x->tag != "joint" && x->tag != "freejoint";
  });
}

// What stands in a body, or in a frame of it.
void MjcfReader::read_parts(const Element& e, const Pose& frame, const std::string& c, int self,
                            Mass* from_geoms, int depth) {
  if (depth > 200) refuse_at(RDM_ERROR_RANGE, e, "there are more than 200 bodies in a chain");
  check_children(e, "body");
  for (const auto& child : e.children) {
    const Element& x = *child;
    const auto body = [&]() -> BodyIn* { return &model.bodies[static_cast<size_t>(self)]; };
    if (x.tag == "frame") {
      x.seen = true;
      check_attributes(x, "frame");
      if (std::any_of(x.children.begin(), x.children.end(),
                      [](const auto& y) { return y->tag == "inertial"; }))
        refuse_at(RDM_ERROR_FORMAT, x, "an inertial must be in a body, not in a frame");
      const std::string* own = x.get("childclass");
      read_parts(x, frame * pose_at(x), own ? *own : c, self, from_geoms, depth + 1);
    } else if (x.tag == "body") {
      x.seen = true;
      add_body(x, self, frame, c, depth + 1);
    } else if (x.tag == "inertial") {
      x.seen = true;  // read by add_body
    } else if (x.tag == "joint") {
      x.seen = true;
      if (self == 0) {
        const std::string* type = value(x, "type", c);
        if (type && *type == "free") {
          drop_free(x);
          continue;
        }
      }
      add_joint(x, frame, c, body());
    } else if (x.tag == "freejoint") {
      x.seen = true;
      drop_free(x);
    } else if (x.tag == "geom") {
      x.seen = true;
      add_geom(x, frame, c, body(), from_geoms);
    } else if (x.tag == "site") {
      if (const Attribute* name = x.find("name")) {
        model.frames.push_back({name->value, self, frame * pose_at(x, c)});
        out->note(RDM_NOTE_DROPPED, x.line,
                  "site %s: it is dropped, but options such as palm and tips can name it%s",
                  clean(name->value).c_str(), in_file(x).c_str());
        x.seen = true;
        for (const Attribute& a : x.attributes) a.read = true;
      }
    }
  }
}

void MjcfReader::add_body(const Element& e, int parent, const Pose& frame, const std::string& c, int depth) {
  check_attributes(e, "body");
  BodyIn body;
  if (const auto* t = e.get("name")) body.name = *t;
  if (body.name.empty()) body.name = format("body_%zu", model.bodies.size());
  if (const auto* t = e.get("mocap"))
    if (flag(e, "mocap", *t)) {
      if (model.bodies.empty() || !drops_mocap(e, c))
        refuse_at(RDM_ERROR_UNSUPPORTED, e,
                  "mocap: a body that the host moves is not read; set config.root to another body");
      out->note(RDM_NOTE_DROPPED, e.line,
                "body %s: the host moves it (mocap), and none of its geoms collides%s",
                clean(body.name).c_str(), in_file(e).c_str());
      for (const auto& x : e.children) {
        x->seen = true;
        for (const Attribute& a : x->attributes) a.read = true;
      }
      return;
    }
  body.element = &e;
  body.parent = parent;
  body.X = frame * pose_at(e);
  const std::string* own = e.get("childclass");
  const std::string inner = own ? *own : c;
  model.bodies.push_back(body);
  const size_t self = model.bodies.size() - 1;
  const bool moving = moves(e, c);
  if (const auto all = e.all("inertial"); all.size() > 1)
    refuse_at(RDM_ERROR_FORMAT, *all[1], "there is already one in line %d", all[0]->line);
  const Element* written = e.child("inertial");
  const Element* given = compiler.inertia_from == "true" ? nullptr : written;
  if (!given && compiler.inertia_from == "false" && compiler.least_mass == 0 && moving)
    refuse_at(RDM_ERROR_RANGE, e, "it moves but has no inertial, and inertiafromgeom is false");
  if (given) model.bodies[self].mass = inertial(*given, model.bodies[self], moving);
  Mass from_geoms;
  read_parts(e, {}, inner, static_cast<int>(self),
             given || compiler.inertia_from == "false" ? nullptr : &from_geoms, depth);
  BodyIn& read = model.bodies[self];
  if (given) return;
  if (written && !(from_geoms.mass > 0)) {  // no geom says it: also with inertiafromgeom="true" it stays
    read.mass = inertial(*written, read, moving);
    return;
  }
  const std::string name = clean(read.name);
  if (from_geoms.mass > 0) {
    bound(e, name, &from_geoms);
    check_mass(e, "body " + name, options.mend_inertia, &from_geoms, out);
    read.mass = from_geoms;
    out->note(RDM_NOTE_GUESSED, e.line, "body %s: mass %.4g kg, from its shapes%s", name.c_str(),
              from_geoms.mass, in_file(e).c_str());
  } else if (compiler.least_mass > 0) {
    // MuJoCo puts the centre of a body without mass where its frame stands in what carries it.
    bound(e, name, &read.mass);
    read.mass = pose_at(e) * read.mass;
    out->note(RDM_NOTE_GUESSED, e.line, "body %s: mass %.4g kg, the lower bound (boundmass)%s", name.c_str(),
              read.mass.mass, in_file(e).c_str());
  }
}

void MjcfReader::add_world(const Element& e) {
  BodyIn world;
  world.name = "world";
  world.element = &e;
  model.bodies.push_back(world);
}

void MjcfReader::read_worlds() {
  std::vector<Top> top;
  const Element* first = nullptr;
  size_t others = 0;  // that are dropped
  // Bodies of the world by where they stand; `wanted`: the one of that name alone, at any depth.
  const std::function<void(const Element&, const Pose&, const std::string&, const Element*)> find =
      [&](const Element& e, const Pose& frame, const std::string& c, const Element* wanted) {
        for (const auto& x : e.children) {
          const Attribute* own = x->find("childclass");
          if (x->tag == "frame") {
            x->seen = !wanted || x->seen;
            find(*x, frame * pose_at(*x), own ? own->value : c, wanted);
          }
          if (x->tag != "body") continue;
          if (!wanted && drops_mocap(*x, c)) {
            ++others;
            continue;
          }
          if (!wanted || x.get() == wanted) top.push_back({x.get(), frame, c});
          if (wanted) find(*x, {}, own ? own->value : c, wanted);
        }
      };
  const auto add_root = [&](const Top& t) {
    const Element& e = *t.body;
    e.seen = true;
    if (moves(e, t.childclass)) {  // the world carries it
      add_world(e);
      add_body(e, 0, t.frame, t.childclass, 1);
      return;
    }
    add_body(e, -1, t.frame, t.childclass, 0);
    const Pose X = model.bodies[0].X;
    if (norm(X.p) > 1e-9 || std::abs(X.q.w) < 1 - 1e-12)
      out->note(RDM_NOTE_DROPPED, e.line, "body %s: its position in the world; its own frame is the root",
                clean(model.bodies[0].name).c_str());
    model.bodies[0].X = {};
  };
  for (const Element* w : mujoco.all("worldbody")) {
    if (!first) first = w;
    check_children(*w, "body");
    const Attribute* own = w->find("childclass");
    const Element* wanted =
        options.root.empty() || options.root == "world" ? nullptr : below(*w, options.root);
    if (!options.root.empty() && options.root != "world" && !wanted) continue;
    if (top.empty() || !wanted) find(*w, {}, own ? own->value : "", wanted);
  }
  if (top.empty() && !options.root.empty() && options.root != "world" && first) {
    std::vector<std::string> names;
    const std::function<void(const Element&)> name_all = [&](const Element& e) {
      for (const auto& x : e.children) {
        if (x->tag == "body" && x->find("name")) names.push_back(x->find("name")->value);
        name_all(*x);
      }
    };
    for (const Element* w : mujoco.all("worldbody")) name_all(*w);
    refuse(RDM_ERROR_NOT_FOUND, "config.root: there is no body %s%s", clean(options.root).c_str(),
           nearest_hint(options.root, names).c_str());
  }
  if (top.empty() && others == 0) refuse_at(RDM_ERROR_FORMAT, mujoco, "there is no body in the world");
  if (top.empty())
    refuse_at(RDM_ERROR_UNSUPPORTED, *first, "the host moves every body (mocap), so none is a robot");
  if (options.root == "world") {
    add_world(*first);
    for (const Element* w : mujoco.all("worldbody")) {
      const Attribute* own = w->find("childclass");
      read_parts(*w, {}, own ? own->value : "", 0, nullptr, 0);
    }
    return;
  }
  if (top.size() > 1)
    refuse_at(RDM_ERROR_ARGUMENT, *top.back().body,
              "there are %zu bodies in the world: set config.root to one of them, or to \"world\"",
              top.size());
  add_root(top[0]);
}

// settotalmass: of all bodies of the file, also those that options.root leaves out.
void MjcfReader::scale_masses() {
  if (!(compiler.total_mass > 0)) return;
  double sum = 0;
  const auto add = [&](const Model& m) {
    for (const BodyIn& b : m.bodies) sum += b.mass.mass;
  };
  if (options.root.empty() || options.root == "world") {
    add(model);
  } else {
    Draft unused;
    Options all = options;
    all.root = "world";
    MjcfReader whole(mujoco, all, &unused);
    whole.read_compiler();
    whole.classes = classes;
    whole.assets = assets;
    whole.read_worlds();
    add(whole.model);
  }
  if (!(sum > 0)) refuse_at(RDM_ERROR_ARGUMENT, mujoco, "settotalmass: nothing in the model has mass");
  const double factor = compiler.total_mass / sum;
  for (BodyIn& b : model.bodies) {
    b.mass.mass *= factor;
    for (auto& row : b.mass.moment)
      for (double& x : row) x *= factor;
  }
  out->note(RDM_NOTE_CHANGED, mujoco.line,
            "all masses were scaled by %.6g to a total of %g kg (settotalmass)", factor, compiler.total_mass);
}

}  // namespace rdm::import
