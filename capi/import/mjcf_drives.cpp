// What couples joints (equalities, narrow limits of tendons) and what drives them (position actuators).
//
// Coupled joints form groups; one joint of a group leads, all others follow it. Where only a follower has an
// actuator the group is turned about, so that the driven joint leads.
#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

#include "mjcf.hpp"

namespace rdm::import {
namespace {

constexpr double kNarrow = 0.2;  // rad or m of slack up to which a tendon's limit is a coupling

// Joints of a group as multiples of the one that leads: q = ratio q_leader + an offset.
struct Follows {
  std::string leader;
  double ratio = 1;
};
Follows leader_of(const Model& model, const std::string& joint, Budget* budget) {
  Follows out{joint, 1};
  for (size_t steps = 0; steps <= model.couplings.size(); ++steps) {
    budget->spend(Cost::kSteps, model.couplings.size());
    const auto next = std::find_if(model.couplings.begin(), model.couplings.end(),
                                   [&](const CouplingIn& x) { return x.follower == out.leader; });
    if (next == model.couplings.end()) return out;
    out.ratio *= next->ratio;
    out.leader = next->leader;
  }
  return out;  // a loop; build() refuses it
}

CouplingIn turned_about(const CouplingIn& c) {
  CouplingIn out = c;
  out.follower = c.leader, out.leader = c.follower;
  out.ratio = 1 / c.ratio;
  out.offset = -c.offset / c.ratio;
  out.slack = c.slack / std::abs(c.ratio);
  return out;
}

}  // namespace

// With config.root only a part of the file's joints is read; an element about other joints is left out.
bool MjcfReader::elsewhere(const Element& e, const std::string& joint) const {
  if (joint_by.count(joint)) return false;
  if (!options.root.empty() && options.root != "world") return true;
  std::vector<std::string> names;
  for (const auto& [name, j] : joint_by) names.push_back(name);
  refuse_at(RDM_ERROR_NOT_FOUND, e, "there is no joint %s%s", clean(joint).c_str(),
            nearest_hint(joint, names).c_str());
}

void MjcfReader::find_driven() {
  for (const Element* all : mujoco.all("actuator")) {
    check_children(*all, "actuator");
    for (const auto& e : all->children)
      for (const char* key : {"joint", "jointinparent"})
        if (const Attribute* j = e->find(key)) driven.insert(j->value);
  }
}

// ---- tendons ----
void MjcfReader::refuse_limited(const Element& spatial) const {
  const std::string* range = value(spatial, "range", "", "tendon");
  if (!range || !limited(spatial, "limited", value(spatial, "limited", "", "tendon"), range)) return;
  const bool whole = options.root.empty() || options.root == "world";
  for (const auto& c : spatial.children) {
    const Attribute* site = c->find("site");
    const bool here = site && std::any_of(model.frames.begin(), model.frames.end(),
                                          [&](const FrameIn& f) { return f.name == site->value; });
    if (whole || here)
      refuse_at(RDM_ERROR_UNSUPPORTED, spatial,
                "the range %s of its length would couple joints, and such ranges are not read",
                clean(*range).c_str());
  }
}

void MjcfReader::read_tendons() {
  for (const Element* t : mujoco.all("tendon")) {
    check_children(*t, "tendon");
    for (const auto& s : t->children)
      if (s->tag == "spatial") refuse_limited(*s);
    for (const Element* f : t->all("fixed")) {
      check_attributes(*f, "fixed");
      Tendon o{f, {}};
      bool here = true;
      for (const Element* j : f->all("joint")) {
        check_attributes(*j, "fixed/joint");
        const std::string *name = j->get("joint"), *coef = j->get("coef");
        if (!name || !coef) refuse_at(RDM_ERROR_FORMAT, *j, "it needs the attributes joint and coef");
        here = here && !elsewhere(*j, *name);
        const double c = number(*j, "coef", *coef);
        if (c != 0) o.joints.emplace_back(*name, c);
      }
      const Attribute* name = f->find("name");
      if (!here || o.joints.empty()) continue;
      tendon_order.push_back(name ? name->value : format("line %d", f->line));
      if (!tendons.emplace(tendon_order.back(), o).second)
        refuse_at(RDM_ERROR_ARGUMENT, *f, "it occurs twice");
    }
  }
}

// Adds the coupling cf q_follower + cl q_leader = length, in which the sum may be off by `slack` to either side.
void MjcfReader::couple_joints(const Element& e, const std::string& follower, double cf,
                               const std::string& leader, double cl, double length, double slack) {
  model.couplings.push_back({follower, leader, -cl / cf, length / cf, slack / std::abs(cf), &e});
  out->note(RDM_NOTE_CHANGED, e.line, "tendon %s: joint %s follows %s%s",
            clean(e.find("name") ? e.find("name")->value : "").c_str(), clean(follower).c_str(),
            clean(leader).c_str(), in_file(e).c_str());
}

// A tendon of one joint: its limit is the joint's.
void MjcfReader::narrow(const Element& e, const std::string& joint, double one, double other) {
  JointIn& j = *joint_by[joint];
  const double lower = std::max(j.lower, std::min(one, other)),
               upper = std::min(j.upper, std::max(one, other));
  if (!(lower < upper))
    refuse_at(RDM_ERROR_RANGE, e, "its range leaves joint %s [%g, %g]", clean(joint).c_str(), lower, upper);
  if (lower - j.lower > 1e-9 || j.upper - upper > 1e-9)
    out->note(RDM_NOTE_CHANGED, e.line, "tendon %s: it limits joint %s to %g to %g%s",
              clean(e.find("name") ? e.find("name")->value : "").c_str(), clean(joint).c_str(), lower, upper,
              in_file(e).c_str());
  j.lower = lower, j.upper = upper;
}

void MjcfReader::read_tendon_limits() {
  for (const std::string& name : tendon_order) {
    const Tendon& t = tendons.at(name);
    const Element& e = *t.element;
    const std::string* range = value(e, "range", "", "tendon");
    if (!limited(e, "limited", value(e, "limited", "", "tendon"), range) || !range) continue;
    const auto n = numbers(e, "range", *range, 2, 2);
    if (!(n[0] <= n[1])) refuse_at(RDM_ERROR_RANGE, e, "the range [%g, %g] is empty", n[0], n[1]);
    if (t.joints.size() == 1) {
      narrow(e, t.joints[0].first, n[0] / t.joints[0].second, n[1] / t.joints[0].second);
      continue;
    }
    const double slack = (n[1] - n[0]) / 2;
    // The joint that has an actuator leads.
    const bool two = t.joints.size() == 2;
    const bool first_leads = two && driven.count(t.joints[0].first) && !driven.count(t.joints[1].first);
    const auto& [leader, cl] = t.joints[two && !first_leads ? 1 : 0];
    const auto& [follower, cf] = t.joints[two && first_leads ? 1 : 0];
    if (!two || cl * cf > 0 || slack / std::abs(cf) > kNarrow) {
      out->note(
          RDM_NOTE_DROPPED, e.line,
          "tendon %s: its range [%g, %g] is dropped: it does not make one of two joints follow the other%s",
          clean(name).c_str(), n[0], n[1], in_file(e).c_str());
      continue;
    }
    couple_joints(e, follower, cf, leader, cl, (n[0] + n[1]) / 2, slack);
  }
}

// ---- equalities ----
bool MjcfReader::is_mocap(const std::string& body) const {
  const std::function<bool(const Element&)> in = [&](const Element& e) {
    out->budget.spend(Cost::kSteps, e.children.size());
    return std::any_of(e.children.begin(), e.children.end(), [&](const auto& c) {
      const Attribute *name = c->find("name"), *mocap = c->find("mocap");
      return (c->tag == "body" && name && name->value == body && mocap && mocap->value == "true") || in(*c);
    });
  };
  return in(mujoco);
}
// True: the body has no joint between it and the root, so it does not move relative to it.
bool MjcfReader::stands(const std::string& body) const {
  if (body == "world") return options.root.empty() || options.root == "world";
  out->budget.spend(Cost::kSteps, model.bodies.size());
  for (size_t b = 0; b < model.bodies.size(); ++b) {
    if (model.bodies[b].name != body) continue;
    for (int at = static_cast<int>(b); at >= 0; at = model.bodies[static_cast<size_t>(at)].parent)
      if (!model.bodies[static_cast<size_t>(at)].joints.empty()) return false;
    return true;
  }
  return is_mocap(body);  // it was dropped
}
bool MjcfReader::ties_nothing(const Element& e) const {
  const std::string *one = e.get("body1"), *two = e.get("body2");
  return one && stands(*one) && stands(two ? *two : "world");
}
void MjcfReader::read_equalities() {
  for (const Element* all : mujoco.all("equality"))
    for (const auto& child : all->children) {
      const Element& e = *child;
      const ElementRow& row = row_of(e, "equality");
      if (const auto* active = value(e, "active", "", "equality"))
        if (!flag(e, "active", *active)) continue;
      if (row.use == Use::kRead) {
        read_equality(e);
        continue;
      }
      bool here = options.root.empty() || options.root == "world";
      out->budget.spend(Cost::kSteps, model.bodies.size() + model.frames.size());
      for (const char* key : {"body1", "body2", "site1", "site2"})
        if (const auto* end = e.get(key)) {
          for (const BodyIn& body : model.bodies) here = here || body.name == *end;
          for (const FrameIn& frame : model.frames) here = here || frame.name == *end;
        }
      if (!here) continue;
      if (ties_nothing(e)) {
        note_left_out(e, "neither of its bodies moves");
        continue;
      }
      for (const char* key : {"body1", "body2"})
        if (const auto* body = e.get(key); body && is_mocap(*body))
          refuse_at(RDM_ERROR_UNSUPPORTED, e,
                    "%s ties a body to %s, which the host moves (mocap), and is not read; remove the %s, and "
                    "the robot's own joints move the body",
                    e.tag.c_str(), clean(*body).c_str(), e.tag.c_str());
      refuse_at(RDM_ERROR_UNSUPPORTED, e, "%s %s", e.tag.c_str(), row.why);
    }
}

void MjcfReader::read_equality(const Element& e) {
  e.seen = true;
  const bool joint = e.tag == "joint";
  check_attributes(e, joint ? "equality/joint" : "equality/tendon");
  double poly[5]{0, 1, 0, 0, 0};
  if (const auto* t = value(e, "polycoef", "", "equality")) {
    const auto n = numbers(e, "polycoef", *t, 1, 5);
    std::copy(n.begin(), n.end(), poly);
  }
  for (size_t k = 2; k < 5; ++k)
    if (poly[k] != 0)
      refuse_at(RDM_ERROR_UNSUPPORTED, e, "polycoef: only linear couplings are read, not those of power %zu",
                k);
  const std::string *one = e.get(joint ? "joint1" : "tendon1"), *two = e.get(joint ? "joint2" : "tendon2");
  if (!one) refuse_at(RDM_ERROR_FORMAT, e, "no %s1", e.tag.c_str());
  if (!joint) {
    // Of a tendon of two joints whose length stays: they follow each other.
    const auto found = tendons.find(*one);
    if (found == tendons.end() && !options.root.empty()) return;
    if (two || found == tendons.end() || found->second.joints.size() != 2)
      refuse_at(RDM_ERROR_UNSUPPORTED, e,
                "only a fixed tendon of two joints that is held at one length is read");
    const auto& [a, ca] = found->second.joints[0];
    const auto& [b, cb] = found->second.joints[1];
    const double length = poly[0] + ca * joint_by[a]->turned + cb * joint_by[b]->turned;
    couple_joints(e, a, ca, b, cb, length, 0);
    return;
  }
  if (elsewhere(e, *one) || (two && elsewhere(e, *two))) {
    out->note(RDM_NOTE_DROPPED, e.line, "equality: not all of its joints are below config.root%s",
              in_file(e).c_str());
    return;
  }
  if (!two || poly[1] == 0)
    refuse_at(RDM_ERROR_UNSUPPORTED, e, "it holds a joint at one position; remove the joint instead");
  // Both angles count from where the file's pose is.
  const double r1 = joint_by[*one]->turned, r2 = joint_by[*two]->turned;
  model.couplings.push_back({*one, *two, poly[1], poly[0] + r1 - poly[1] * r2, 0, &e});
}

// Chooses another leader for groups in which only a follower has an actuator, and for groups in which a joint
// follows two others.
void MjcfReader::lead_by_driven() {
  std::vector<CouplingIn> all;
  std::set<std::string> placed;
  const auto has = [](const CouplingIn& c, const std::string& joint) {
    return c.follower == joint || c.leader == joint;
  };
  for (const std::string& start : order) {
    if (start.empty() || placed.count(start)) continue;
    // The group of this joint, breadth first.
    std::vector<std::string> group{start};
    std::set<std::string> in{start};
    for (size_t k = 0; k < group.size(); ++k) {
      out->budget.spend(Cost::kSteps, 2 * model.couplings.size());
      for (const CouplingIn& c : model.couplings) {
        if (!has(c, group[k])) continue;
        const std::string& other = c.follower == group[k] ? c.leader : c.follower;
        if (in.insert(other).second) group.push_back(other);
      }
    }
    placed.insert(in.begin(), in.end());
    std::vector<CouplingIn> own;
    for (const CouplingIn& c : model.couplings)
      if (in.count(c.follower)) own.push_back(c);
    if (own.size() + 1 != group.size()) {  // a loop: build() says which
      all.insert(all.end(), own.begin(), own.end());
      continue;
    }
    const auto follows = [&](const std::string& j) {
      return std::any_of(own.begin(), own.end(), [&](const CouplingIn& c) { return c.follower == j; });
    };
    out->budget.spend(Cost::kSteps, group.size() * own.size());
    std::string leader;
    for (const bool must_be_driven : {true, false})
      for (const bool must_lead : {true, false})
        for (const std::string& j : group)
          if (leader.empty() && (!must_be_driven || driven.count(j)) && (!must_lead || !follows(j)))
            leader = j;
    std::vector<std::string> reached{leader};
    std::vector<bool> used(own.size());
    for (size_t k = 0; k < reached.size(); ++k)
      for (size_t i = 0; i < own.size(); ++i) {
        if (used[i] || !has(own[i], reached[k])) continue;
        used[i] = true;
        CouplingIn c = own[i];
        if (c.leader != reached[k]) {
          c = turned_about(c);
          out->note(RDM_NOTE_CHANGED, c.element->line, "joint %s follows %s, not the other way round",
                    clean(c.follower).c_str(), clean(c.leader).c_str());
        }
        reached.push_back(c.follower);
        all.push_back(c);
      }
  }
  // Those of the file's order first, as they stood.
  const auto key = [](const CouplingIn& c) {
    return std::make_tuple(c.element, std::min(c.follower, c.leader), std::max(c.follower, c.leader));
  };
  std::map<decltype(key(all[0])), size_t> place;
  for (size_t k = 0; k < model.couplings.size(); ++k) place.emplace(key(model.couplings[k]), k);
  std::stable_sort(all.begin(), all.end(), [&](const CouplingIn& a, const CouplingIn& b) {
    return place.at(key(a)) < place.at(key(b));
  });
  model.couplings = all;
}

// ---- actuators ----
void MjcfReader::note_left_out(const Element& e, const char* why) {
  out->note(RDM_NOTE_DROPPED, e.line, "%s %s: %s%s", e.tag.c_str(),
            clean(e.find("name") ? e.find("name")->value : "").c_str(), why, in_file(e).c_str());
  e.seen = true;
  for (const Attribute& a : e.attributes) a.read = true;
}

void MjcfReader::read_actuators() {
  for (const bool position : {true, false})  // a joint takes its first position actuator, if it has any
    for (const Element* all : mujoco.all("actuator"))
      for (const auto& e : all->children) {
        if (row_of(*e, "actuator").use != Use::kRead) continue;
        const bool may_hold = e->tag == "position" || e->tag == "intvelocity" || e->tag == "general";
        if (may_hold == position) read_actuator(*e);
      }
  for (auto& [name, j] : joint_by)
    if (j->most_effort > 0) j->effort = j->effort > 0 ? std::min(j->effort, j->most_effort) : j->most_effort;
}

void MjcfReader::read_actuator(const Element& e) {
  check_attributes(e, "actuator");
  const auto get = [&](const char* key) { return value(e, key, "", "actuator"); };
  const auto get_range = [&](const char* key, const char* limit) {
    const std::string* t = get(key);
    if (!t || !limited(e, limit, get(limit), t)) return std::vector<double>();
    return numbers(e, key, *t, 2, 2);
  };
  const std::string *tendon = e.get("tendon"), *joint = e.get("joint");
  if (!joint) joint = e.get("jointinparent");
  if (!joint && !tendon) return note_left_out(e, "it drives neither a joint nor a tendon");

  // The parts: joints that it pulls, with their shares of the force.
  std::vector<std::pair<std::string, double>> parts;
  double bound_of_tendon = -1;
  if (joint) {
    if (elsewhere(e, *joint)) return note_left_out(e, "its joint is not below config.root");
    parts = {{*joint, 1}};
  } else {
    const auto found = tendons.find(*tendon);
    if (found == tendons.end()) {
      bool there = false;  // a spatial one, or one of other bodies
      for (const Element* t : mujoco.all("tendon"))
        for (const auto& x : t->children) {
          out->budget.spend(Cost::kSteps, 1);
          there = there || (x->find("name") && x->find("name")->value == *tendon);
        }
      if (!there) refuse_at(RDM_ERROR_NOT_FOUND, e, "there is no tendon %s", clean(*tendon).c_str());
      return note_left_out(e, "its tendon has no joints of this robot");
    }
    out->budget.spend(Cost::kSteps, 8 * found->second.joints.size());
    parts = found->second.joints;
    const Element& t = *found->second.element;
    const std::string* most = value(t, "actuatorfrcrange", "", "tendon");
    if (most && limited(t, "actuatorfrclimited", value(t, "actuatorfrclimited", "", "tendon"), most)) {
      const auto n = numbers(t, "actuatorfrcrange", *most, 2, 2);
      bound_of_tendon = std::max(std::abs(n[0]), std::abs(n[1]));
    }
  }
  e.seen = true;
  e.get("name");
  double gear = 1;
  if (const auto* t = get("gear")) gear = numbers(e, "gear", *t, 1, 6)[0];
  if (gear == 0) refuse_at(RDM_ERROR_RANGE, e, "gear is 0");

  // Change of the tendon's length per angle of each leader. Groups that only this tendon connects follow the first.
  std::vector<std::pair<std::string, double>> groups;  // leaders, and length per angle of each
  for (const auto& [name, share] : parts) {
    const Follows f = leader_of(model, name, &out->budget);
    out->budget.spend(Cost::kSteps, groups.size());
    const auto known =
        std::find_if(groups.begin(), groups.end(), [&](const auto& g) { return g.first == f.leader; });
    if (known != groups.end())
      known->second += share * f.ratio;
    else
      groups.emplace_back(f.leader, share * f.ratio);
  }
  if (joint && groups[0].first != *joint)
    out->note(RDM_NOTE_CHANGED, e.line, "%s %s: its joint follows %s, which takes the commands",
              e.tag.c_str(), clean(e.find("name") ? e.find("name")->value : "").c_str(),
              clean(groups[0].first).c_str());
  for (const auto& [leader, per] : groups)
    if (std::abs(per) < 1e-12) return note_left_out(e, "its length does not change with its joints");
  const auto& [leader, first] = groups[0];
  double per = first;
  for (size_t k = 1; k < groups.size(); ++k) {
    const auto& [other, length] = groups[k];
    if (driven.count(other)) return note_left_out(e, "its joints have actuators of their own");
    model.couplings.push_back({other, leader, length / first, 0, 0, &e});
    out->note(RDM_NOTE_CHANGED, e.line, "tendon %s: joint %s follows %s", clean(*tendon).c_str(),
              clean(other).c_str(), clean(leader).c_str());
    per += length * length / first;
  }
  per *= gear;
  JointIn* lead = joint_by[leader];

  double effort = -1;
  const auto forces = get_range("forcerange", "forcelimited");
  if (!forces.empty()) effort = std::max(std::abs(forces[0]), std::abs(forces[1])) * std::abs(gear);
  const bool integrates = e.tag == "intvelocity" || (get("dyntype") && *get("dyntype") == "integrator");
  auto limits = integrates ? get_range("actrange", "actlimited") : get_range("ctrlrange", "ctrllimited");
  double kp = 0, kv = 0, damping_ratio = 0;
  const std::string *bias = get("biastype"), *gain = get("gainprm"), *prm = get("biasprm");
  const std::string* gaintype = get("gaintype");
  if (e.tag == "position" || e.tag == "intvelocity" || (e.tag == "general" && !bias && get("kp"))) {
    const auto* t = get("kp");
    kp = t ? number(e, "kp", *t) : gain ? numbers(e, "gainprm", *gain, 1, 10)[0] : 1;
    if (const auto* v = get("kv")) kv = number(e, "kv", *v);
    if (const auto* r = get("dampratio")) damping_ratio = number(e, "dampratio", *r);
  } else if (e.tag == "general" && bias && *bias == "affine" && prm && (!gaintype || *gaintype == "fixed")) {
    auto b = numbers(e, "biasprm", *prm, 1, 10);
    b.resize(3, 0);
    const double g = gain ? numbers(e, "gainprm", *gain, 1, 10)[0] : 1;
    kp = -b[1];
    if (b[2] > 0 && g == kp)
      damping_ratio = b[2];  // as `dampratio` writes it
    else
      kv = -b[2];
    // Commands in another unit than the joint's: the gain takes them there.
    if (kp > 0)
      for (double& x : limits) x = (g * x + b[0]) / kp;
    if (limits.size() == 2 && limits[0] > limits[1]) std::swap(limits[0], limits[1]);
  }
  if (kp < 0 || kv < 0 || damping_ratio < 0)
    refuse_at(RDM_ERROR_RANGE, e, "kp %g, kv %g or dampratio %g is below 0", kp, kv, damping_ratio);
  if (kp == 0) {
    if (lead->kp >= 0) return note_left_out(e, "its joint is held by another actuator");
    const auto commands = get_range("ctrlrange", "ctrllimited");
    if (!commands.empty() && effort <= 0 && e.tag != "velocity")
      effort = std::max(std::abs(commands[0]), std::abs(commands[1])) *
               (gain && e.tag == "general" ? std::abs(numbers(e, "gainprm", *gain, 1, 10)[0]) : 1) *
               std::abs(gear);
    out->note(RDM_NOTE_CHANGED, e.line, "%s %s: it is not a position actuator; only its effort limit is used",
              e.tag.c_str(), clean(e.find("name") ? e.find("name")->value : "").c_str());
  } else {
    if (joint ? joint_by[*joint]->kp >= 0 : lead->kp >= 0)
      return note_left_out(e, "its joint is held by another actuator");
    if (const auto* t = get("inheritrange")) {
      const double share = number(e, "inheritrange", *t);
      const std::string* range = tendon ? value(*tendons[*tendon].element, "range", "", "tendon") : nullptr;
      auto whole = range ? numbers(e, "range", *range, 2, 2) : std::vector<double>();
      if (joint) whole = {joint_by[*joint]->lower, joint_by[*joint]->upper};
      if (share > 0 && whole.size() == 2) {
        const double mean = (whole[0] + whole[1]) / 2, half = (whole[1] - whole[0]) / 2 * share;
        limits = {mean - half, mean + half};
      }
    }
    if (limits.size() == 2 && limits[0] < limits[1] && (!joint || leader == *joint)) {
      lead->has_command = true;
      lead->command_low = std::min(limits[0] / per, limits[1] / per);
      lead->command_high = std::max(limits[0] / per, limits[1] / per);
    }
  }
  if (bound_of_tendon > 0) effort = effort > 0 ? std::min(effort, bound_of_tendon) : bound_of_tendon;
  // A joint feels its share of the force. The stiffness along the leader's way is spread over all that move.
  if (!joint &&
      std::none_of(parts.begin(), parts.end(), [&, l = leader](const auto& p) { return p.first == l; }))
    parts.insert(parts.begin(), {leader, per / gear});
  double squares = 0;
  for (const auto& [name, share] : parts) {
    const double ratio = joint ? 1 : leader_of(model, name, &out->budget).ratio;
    squares += ratio * ratio;
  }
  const double along = joint ? gear : per;
  for (const auto& [name, share] : parts) {
    JointIn& j = *joint_by[name];
    if (effort > 0) j.effort = effort * std::abs(share);
    if (kp == 0) continue;
    j.kp = kp * along * along / squares;
    j.kd = kv * along * along / squares;
    j.damping_ratio = damping_ratio;
  }
}

}  // namespace rdm::import
