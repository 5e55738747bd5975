#include "text_scene.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "base/chars.hpp"
#include "base/names.hpp"

namespace rdm::import {
namespace {

std::atomic<uint32_t> g_mounted{0};

struct Listed {  // a robot that is in the process's list for a while
  int32_t robot = -1;
  ~Listed() {
    if (robot >= 0) rdm_robot_destroy(robot);
  }
};

}  // namespace

void SceneText::read_scene() {
  const Table task = top_.section("task");
  if (const toml::node* n = task.find("gravity")) {
    const auto g = task.list(*n, "gravity", 3, 3);
    check(task, line_of(*n), rdm_scene_set_gravity(scene_, g.data()));
  }
  materials();
  for (const Table& t : top_.rows("robot")) add_robot(t);
  for (const Table& t : top_.rows("tree")) add_tree(t);
  for (const Table& t : top_.rows("body")) add_body(t);
  for (const Table& t : top_.rows("static")) add_static(t);
  if (compensated_) check(top_, 1, rdm_scene_set_feedforward(scene_));
  const auto draws = top_.rows("draw");
  if (!draws.empty()) check(draws[0], line_of(draws[0].t), rdm_scene_set_adjustable(scene_));
  if (!joint_names_.empty()) {  // the first look at the whole scene: what is wrong then is no robot's fault
    rdm_joint_info first = RDM_INIT(rdm_joint_info);
    if (const rdm_result r = rdm_scene_joint_at(scene_, 0, &first)) refuse(r, "%s", rdm_last_error());
  }
}

Span SceneText::span(const Table& t, const toml::node& n, const char* key) const {
  if (const auto* x = n.as_string()) {
    const std::string& text = x->get();
    if (text.size() > 1 && text[0] == '$') {
      try {
        return options_.range(text.substr(1));
      } catch (const Refusal& r) {
        t.bad(r.code, line_of(n), "%s: %s", key, r.text.c_str());
      }
    }
    const size_t dots = text.find("..");
    Span s{};
    const auto read = [&](size_t from, size_t to, double* out) {
      const char* end = text.data() + to;
      const auto r = from_chars(text.data() + from, end, *out);
      return r.ec == std::errc() && r.ptr == end && std::isfinite(*out);
    };
    if (dots == std::string::npos || !read(0, dots, &s.low) || !read(dots + 2, text.size(), &s.high) ||
        !(s.low <= s.high))
      t.bad(RDM_ERROR_FORMAT, line_of(n), "%s: %s is not a range \"a..b\" with a <= b", key,
            clean(text).c_str());
    return s;
  }
  const double x = t.as_number(n, key);
  return {x, x};
}

bool SceneText::spans(const Table& t, const char* key, Span* out, size_t count) const {
  const toml::node* n = t.find(key);
  if (!n) return false;
  const toml::array* a = n->as_array();
  if (!a || a->size() != count)
    t.bad(RDM_ERROR_FORMAT, line_of(*n), "%s is not a list of %zu numbers", key, count);
  for (size_t k = 0; k < count; ++k) out[k] = span(t, *a->get(k), key);
  return true;
}

bool SceneText::drawn(const Span* s, size_t count) {
  return std::any_of(s, s + count, [](const Span& x) { return x.low != x.high; });
}

void SceneText::middle(const Span* s, size_t count, double* out) {
  for (size_t k = 0; k < count; ++k) out[k] = s[k].low + 0.5 * (s[k].high - s[k].low);
}

void SceneText::read_turn(const Table& t, double q[4]) const {
  const toml::node *given = t.find("q"), *rpy = t.find("rpy");
  if (given && rpy) t.bad(RDM_ERROR_FORMAT, line_of(*rpy), "it has both q and rpy; give one of them");
  if (given) {
    t.numbers("q", q, 4);
    const double n = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(n > 1e-9 && n < 1e9)) t.bad(RDM_ERROR_RANGE, line_of(*given), "q is not a rotation");
    for (int k = 0; k < 4; ++k) q[k] /= n;
  } else if (rpy) {
    const auto angles = t.list(*rpy, "rpy", 3, 3);
    check(t, line_of(*rpy), turn_of(angles.data(), q));
  }
}

bool SceneText::read_drawn(const Table& t, Span* ps, Span* turns, double* fixed, double* p, double* q) const {
  for (int k = 0; k < 3; ++k) ps[k] = turns[k] = {0, 0};
  spans(t, "p", ps, 3);
  middle(ps, 3, p);
  fixed[0] = fixed[1] = fixed[2] = 0, fixed[3] = 1;
  std::copy_n(fixed, 4, q);
  if (t.find("rpy") && !t.find("q") && spans(t, "rpy", turns, 3)) {
    double rpy[3];
    middle(turns, 3, rpy);
    check(t, line_of(*t.find("rpy")), turn_of(rpy, q));
  } else {
    read_turn(t, q);
    std::copy_n(q, 4, fixed);
  }
  return drawn(ps, 3) || drawn(turns, 3);
}

void SceneText::materials() {
  for (const Table& t : top_.rows("material")) {
    t.only({"name"});
    const toml::node& n = t.need("name");
    check(t, line_of(n), rdm_scene_add_material(scene_, t.as_text(n, "name").c_str()));
  }
  for (const Table& t : top_.rows("friction")) {
    t.only({"between", "mu"});
    const auto pair = texts(t, "between", 2, 2);
    const toml::node& n = t.need("mu");
    double mu = RDM_FRICTION_PASSES;
    if (!n.is_string() || n.as_string()->get() != "passes") mu = t.as_number(n, "mu");
    check(t, line_of(n), rdm_scene_set_friction(scene_, pair[0].c_str(), pair[1].c_str(), mu));
  }
}

std::vector<std::string> SceneText::texts(const Table& t, const char* key, size_t least, size_t most) const {
  const toml::node& n = t.need(key);
  std::vector<std::string> out;
  if (const toml::array* a = n.as_array())
    for (const toml::node& x : *a) out.push_back(t.as_text(x, key));
  else
    out.push_back(t.as_text(n, key));
  if (out.size() < least || out.size() > most)
    t.bad(RDM_ERROR_FORMAT, line_of(n), "%s: it has %zu names, but needs %zu to %zu", key, out.size(), least,
          most);
  return out;
}

void SceneText::add_robot(const Table& t) {
  t.only({"name",  "robot",     "hand",         "arm",     "yaw",        "adapter",  "left",  "p",     "q",
          "rpy",   "free_base", "base_damping", "gravity", "compensate", "material", "start", "noise", "rest",
          "reach", "control",   "drive",        "step",    "speed",      "smooth",   "push"});
  Part part(t);
  part.name = t.as_text(t.need("name"), "name");
  part.left = t.flag("left");
  Listed mounted;
  const auto find = [&](const char* key) {
    const toml::node& n = t.need(key);
    int32_t robot = -1;
    check(t, line_of(n), rdm_robot_find(t.as_text(n, key).c_str(), &robot));
    return robot;
  };
  const bool on_arm = t.find("arm") != nullptr && t.text("arm", "") != "none";
  if (t.find("robot")) {
    if (t.find("hand") || t.find("arm"))
      t.bad(RDM_ERROR_FORMAT, line_of(*t.find("robot")),
            "it has robot, and hand or arm too; give one of them");
    part.listed = find("robot");
  } else if (t.find("hand") && on_arm) {
    double yaw = 0, adapter = 0;
    t.number("yaw", &yaw);
    t.number("adapter", &adapter);
    const std::string name = format("text-%u", g_mounted.fetch_add(1));
    check(t, line_of(*t.find("hand")),
          rdm_robot_create_mounted(&mounted.robot, name.c_str(), find("arm"), find("hand"), yaw, adapter,
                                   part.left));
    part.left = false;  // it is in the rows
  } else if (t.find("hand")) {
    part.listed = find("hand");
  } else if (on_arm) {
    part.listed = find("arm");
  } else {
    t.bad(RDM_ERROR_FORMAT, line_of(t.t), "it needs a robot, a hand or an arm");
  }
  try {
    read_built(mounted.robot >= 0 ? mounted.robot : part.listed, part.draft.get());
  } catch (const Refusal& r) {
    t.bad(r.code, line_of(t.t), "%s", r.text.c_str());
  }
  if (mounted.robot >= 0) part.draft->def.name = "mounted";
  add_part(std::move(part), "robot");
  if (t.find("reach")) reach(&parts_.back(), on_arm ? find("arm") : parts_.back().listed);
}

void SceneText::add_tree(const Table& t) {
  Part part(t);
  part.name = t.as_text(t.need("name"), "name");
  read_robot_table(t,
                   {"p", "q", "rpy", "free_base", "base_damping", "gravity", "material", "start", "noise",
                    "rest", "control", "drive", "step", "speed", "smooth", "push"},
                   {}, part.draft.get());
  part.draft->def.name = "tree";  // a robot's name is shorter than a scene's may be
  add_part(std::move(part), "tree");
}

void SceneText::add_part(Part part, const char* kind) {
  const Table& t = part.t;
  if (parts_.size() == kMostPlayers)
    t.bad(RDM_ERROR_RANGE, line_of(t.t), "there are more than %d robots and trees", kMostPlayers);
  rdm_scene_robot r;
  rdm_scene_robot_init(&r, sizeof r);
  r.robot = part.listed;
  if (part.listed < 0) r.own = &part.draft->def;
  r.name = part.name.c_str();
  const std::string material = t.text("material", "default");
  r.material = material.c_str();
  r.free_base = t.flag("free_base");
  r.left = part.left;
  r.gravity = t.flag("gravity");
  t.number("base_damping", &r.base_damping);
  Span ps[3], turns[3];
  double fixed[4];
  if (read_drawn(t, ps, turns, fixed, part.p, part.q) && !r.free_base)
    t.bad(RDM_ERROR_RANGE, line_of(t.t),
          "p, rpy: a %s with a fixed base cannot be moved at a reset, so no range is allowed", kind);
  std::copy_n(part.p, 3, r.pose.p);
  std::copy_n(part.q, 4, r.pose.q);
  if (t.flag("compensate")) {
    if (!r.gravity)
      t.bad(RDM_ERROR_FORMAT, line_of(*t.find("compensate")), "compensate needs gravity = true");
    compensated_ = true;
  }
  check(t, line_of(t.t), rdm_scene_add_robot(scene_, &r, nullptr));
  const Draft& d = *part.draft;
  names_.push_back(part.name);
  if (d.def.palm_link != RDM_LINK_NONE) names_.push_back(part.name + ".palm");
  for (const rdm_robot_finger& f : d.fingers) names_.push_back(part.name + '.' + f.name);
  for (const rdm_robot_link& l : d.links) names_.push_back(part.name + '_' + l.name);
  for (const rdm_robot_shape& s : d.shapes) names_.push_back(part.name + '_' + s.name);
  for (const rdm_robot_link& l : d.links) joint_names_.push_back(part.name + '_' + l.joint);
  parts_.push_back(std::move(part));
}

void SceneText::reach(Part* part, int32_t arm) {
  const Table t = part->t.section("reach");
  t.only({"p", "q", "rpy"});
  double p[3] = {}, q[4] = {0, 0, 0, 1}, d[3];
  rdm_pose flange;
  t.need("p");
  t.numbers("p", p, 3);
  read_turn(t, q);
  const double back[4] = {-part->q[0], -part->q[1], -part->q[2], part->q[3]};
  for (int k = 0; k < 3; ++k) d[k] = p[k] - part->p[k];
  rotate(back, d, flange.p);
  multiply(back, q, flange.q);
  Draft of_arm;
  read_built(arm, &of_arm);
  part->start = of_arm.home;
  int32_t found = 0;
  check(t, line_of(t.t), rdm_robot_reach(arm, &flange, part->start.data(), &found));
  if (!found) t.bad(RDM_ERROR_RANGE, line_of(t.t), "the arm cannot reach this place");
}

void SceneText::read_shape(const Table& t, const std::string* name, Shapes* out) const {
  rdm_shape_def s{};
  const auto keep = [&](const std::string& text) {
    out->texts.push_back(text);
    return out->texts.back().c_str();
  };
  if (name) s.name = keep(*name);
  if (t.find("material")) s.material = keep(t.text("material", ""));
  s.kind = shape_kind(t, static_cast<int32_t>(std::size(kShapes)));
  if (s.kind == RDM_SHAPE_HULL) {
    const toml::node& n = t.need("points");
    const toml::array* a = n.as_array();
    if (!a) t.bad(RDM_ERROR_FORMAT, line_of(n), "points is not a list of [x, y, z]");
    out->points.emplace_back();
    for (const toml::node& x : *a)
      for (const double c : t.list(x, "points", 3, 3)) out->points.back().push_back(c);
    s.points = out->points.back().data();
    s.num_points = static_cast<int32_t>(out->points.back().size() / 3);
  }
  read_size(t, s.kind, s.size);
  s.pose.q[3] = 1;
  read_color(t, s.color);
  s.seen_only = t.flag("seen_only");
  out->rows.push_back(s);
}

void SceneText::place_shape(const Table& t, rdm_shape_def* s) const {
  t.numbers("p", s->pose.p, 3);
  read_turn(t, s->pose.q);
}

void SceneText::add_object(const Table& t) {
  t.only({"name", "object", "scale", "p", "q", "rpy", "v", "w", "apart"});
  const std::string name = t.as_text(t.need("name"), "name");
  const toml::node& word = t.need("object");
  int32_t object = -1;
  check(t, line_of(word), rdm_object_find(t.as_text(word, "object").c_str(), &object));
  double scale = 1;
  t.number("scale", &scale);
  place_body(t, [&](const rdm_pose& pose, int32_t* index) {
    return rdm_scene_add_object(scene_, object, name.c_str(), &pose, scale, index);
  });
  names_.push_back(name);
}

void SceneText::add_body(const Table& t) {
  if (t.find("object")) return add_object(t);
  t.only({"name", "mass", "moment", "p", "q", "rpy", "v", "w", "apart", "linear_damping", "angular_damping",
          "weightless", "shape", "kind", "size", "points", "material", "color", "seen_only"});
  rdm_body_def b{};
  b.struct_size = sizeof b;
  const std::string name = t.as_text(t.need("name"), "name");
  b.name = name.c_str();
  b.mass = t.as_number(t.need("mass"), "mass");
  t.numbers("moment", b.moment, 6);
  t.number("linear_damping", &b.linear_damping);
  t.number("angular_damping", &b.angular_damping);
  b.weightless = t.flag("weightless");
  Shapes shapes;
  if (t.find("kind")) {
    if (t.find("shape"))
      t.bad(RDM_ERROR_FORMAT, line_of(*t.find("kind")),
            "it has kind, and [[body.shape]] too; give one of them");
    read_shape(t, nullptr, &shapes);
    names_.push_back(name);
  } else {
    for (const Table& s : t.rows("shape")) {
      s.only({"name", "kind", "size", "points", "p", "q", "rpy", "material", "color", "seen_only"});
      const std::string own = s.find("name") ? s.as_text(*s.find("name"), "name") : name;
      read_shape(s, &own, &shapes);
      place_shape(s, &shapes.rows.back());
      names_.push_back(own);
    }
    if (shapes.rows.empty()) t.bad(RDM_ERROR_FORMAT, line_of(t.t), "it needs kind, or a [[body.shape]]");
    names_.push_back(name);
  }
  b.shapes = shapes.rows.data();
  b.num_shapes = static_cast<int32_t>(shapes.rows.size());
  place_body(t, [&](const rdm_pose& pose, int32_t* index) {
    b.pose = pose;
    return rdm_scene_add_body(scene_, &b, index);
  });
}

void SceneText::add_static(const Table& t) {
  t.only({"name", "kind", "size", "points", "p", "q", "rpy", "material", "color", "seen_only"});
  Shapes shapes;
  const std::string name = t.as_text(t.need("name"), "name");
  read_shape(t, &name, &shapes);
  place_shape(t, &shapes.rows.back());
  check(t, line_of(t.t), rdm_scene_add_static(scene_, shapes.rows.data()));
  names_.push_back(name);
}

int32_t SceneText::find(const Table& t, const char* key, int32_t part, const std::string& name) const {
  int32_t index = -1;
  const rdm_result r = rdm_scene_find(scene_, part, name.c_str(), &index);
  if (r != RDM_OK) t.bad(r, line_of(t.need(key)), "%s: %s", key, rdm_last_error());
  return index;
}

}  // namespace rdm::import
