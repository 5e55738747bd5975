#include "urdf_table.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

namespace rdm::import {
namespace {

using Words = std::set<std::string>;
Words words(const char* text) {
  std::istringstream in(text);
  Words out;
  for (std::string word; in >> word;) out.insert(word);
  return out;
}

// What may stand in an element; each text is words with blanks between them.
struct Row {
  Row(const char* children, const char* other_children, const char* own, const char* other_attributes,
      const char* one_of)
      : read(words(children)),
        dropped(words(other_children)),
        attributes(words(own)),
        unused(words(other_attributes)),
        once(words(one_of)) {}
  Words read;        // children that are walked too
  Words dropped;     // children without meaning for a robot
  Words attributes;  // read
  Words unused;      // without meaning for a robot
  Words once;        // children of which there is one
};

const std::map<std::string, Row>& rows() {
  static const std::map<std::string, Row> all{
      {"robot",
       {"link joint",
        "material transmission gazebo sensor ros2_control mujoco bullet frame force_element cable parameter "
        "properties velocity collision_filter_group RefLink schedule_topic_creator_file self_collision "
        "disable_collisions group group_state",
        "name", "version", ""}},
      {"link",
       {"inertial collision",
        "visual contact gravity kinematic self_collision_checking collision_checking self_filter surface "
        "gazebo "
        "audio_source bullet sensor material verbose velocity_decay",
        "name", "type concave", ""}},  // of several inertials the first counts
      {"inertial", {"origin mass inertia", "density friction", "", "name", "origin mass inertia density"}},
      {"mass", {"", "", "value", "", ""}},
      {"inertia", {"", "", "ixx iyy izz ixy ixz iyz iyx izx izy", "", ""}},
      {"collision",
       {"origin geometry", "material verbose sdf surface max_contacts contact_coefficients", "name",
        "group mask concave type", "origin geometry"}},
      {"geometry", {"box sphere cylinder capsule mesh", "", "", "name", ""}},
      {"box", {"", "", "size", "", ""}},
      {"sphere", {"", "", "radius", "", ""}},
      {"cylinder", {"", "", "radius length", "", ""}},
      {"capsule", {"", "", "radius length", "", ""}},
      {"mesh", {"", "", "filename scale", "convex", ""}},
      {"joint",
       {"parent child origin axis limit dynamics mimic",
        "calibration safety_controller controller_gains joint_properties traits", "name type",
        "dont_collapse", "parent child origin axis limit dynamics mimic"}},
      {"parent", {"", "", "link", "", ""}},
      {"child", {"", "", "link", "", ""}},
      {"origin", {"", "", "xyz rpy quat_xyzw", "", ""}},
      {"axis", {"", "", "xyz", "", ""}},
      {"limit",
       {"", "", "lower upper effort velocity",
        "acceleration deceleration jerk command_effort current gear_velocity k_velocity stepSize", ""}},
      {"dynamics",
       {"", "", "damping friction", "D K mu_coulomb mu_viscous spring_stiffness spring_reference", ""}},
      {"mimic", {"", "", "joint multiplier offset", "", ""}},
  };
  return all;
}

struct Refused {
  const char *elements, *why;
};
constexpr Refused kRefused[] = {
    {"loop_joint drake:ball_constraint drake:linear_bushing_rpy",
     "it closes a loop of links, but a robot must be a tree"},
    {"drake:joint", "it would join links, and is not read"},
    {"drake:mimic", "it couples joints, and is not read; write it as mimic"},
    {"fem deformable reduced_deformable", "deformable bodies are not read"},
};

std::string nearest(const std::string& word, const Words& known) {
  return nearest_hint(word, {known.begin(), known.end()});
}

// An attribute or a pose that says nothing: 0 throughout.
bool is_zero(const std::string& text) {
  return !text.empty() && text.find_first_not_of("0. -+\t,") == std::string::npos;
}
bool is_identity(const Element& e) {
  return !e.attributes.empty() && e.children.empty() &&
         std::all_of(e.attributes.begin(), e.attributes.end(), [](const Attribute& a) {
           return (a.name == "xyz" || a.name == "rpy") && is_zero(a.value);
         });
}
// Of a namespace: another program's own.
bool is_foreign(const std::string& name) {
  return name.find(':') != std::string::npos || name == "xmlns";
}

void check_child(const Element& e, const Row& row, const Element& c) {
  for (const Refused& r : kRefused)
    if (words(r.elements).count(c.tag)) refuse_at(RDM_ERROR_UNSUPPORTED, c, "%s", r.why);
  if (row.read.count(c.tag) || row.dropped.count(c.tag) || is_foreign(c.tag) || is_identity(c)) return;
  for (const auto& [other, others] : rows())
    if (others.read.count(c.tag))
      refuse_at(RDM_ERROR_FORMAT, c, "it must be in %s, not in %s", other.c_str(), e.tag.c_str());
  if (e.tag != "geometry")  // its reader says what shapes there are
    refuse_at(RDM_ERROR_UNSUPPORTED, c, "this is not a known element in %s, and it could change the robot%s",
              e.tag.c_str(), nearest(c.tag, row.read).c_str());
}

bool same(const Element& a, const Element& b) {
  return std::equal(a.attributes.begin(), a.attributes.end(), b.attributes.begin(), b.attributes.end(),
                    [](const auto& x, const auto& y) { return x.name == y.name && x.value == y.value; }) &&
         std::equal(a.children.begin(), a.children.end(), b.children.begin(), b.children.end(),
                    [](const auto& x, const auto& y) { return x->tag == y->tag && same(*x, *y); });
}

void check_element(const Element& e, const Row& row) {
  for (const Attribute& a : e.attributes) {
    if (row.attributes.count(a.name) || row.unused.count(a.name) || is_foreign(a.name) || is_zero(a.value))
      continue;
    refuse_at(RDM_ERROR_UNSUPPORTED, e, "%s is not a known attribute here, and it could change the robot%s",
              clean(a.name).c_str(), nearest(a.name, row.attributes).c_str());
  }
  std::map<std::string, const Element*> found;
  for (const auto& child : e.children) {
    check_child(e, row, *child);
    if (row.once.count(child->tag)) {
      const auto [first, is_new] = found.emplace(child->tag, child.get());
      if (!is_new && !same(*first->second, *child))
        refuse_at(RDM_ERROR_FORMAT, *child,
                  "there is already one in line %d, and it is not clear which counts", first->second->line);
    }
    const auto known = rows().find(child->tag);
    if (row.read.count(child->tag) && known != rows().end()) check_element(*child, known->second);
  }
}

// <mujoco><compiler>: what would change masses in that simulator, and is no part of URDF.
void check_mujoco(const Element& robot) {
  for (const auto& m : robot.children)
    for (const auto& c : m->children) {
      if (m->tag != "mujoco" || c->tag != "compiler") continue;
      for (const Attribute& a : c->attributes)
        if (words("inertiafromgeom inertiagrouprange settotalmass boundmass boundinertia").count(a.name) &&
            !words("auto false 0 -1").count(a.value))
          refuse_at(RDM_ERROR_UNSUPPORTED, *c, "%s=\"%s\" would change masses, and is not read in URDF",
                    clean(a.name).c_str(), clean(a.value).c_str());
    }
}

}  // namespace

void check_urdf(const Element& robot) {
  check_element(robot, rows().at("robot"));
  check_mujoco(robot);
}

}  // namespace rdm::import
