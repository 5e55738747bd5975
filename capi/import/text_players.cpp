#include "text_players.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/names.hpp"

namespace rdm::import {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

}  // namespace

void PlayerText::read_players() {
  for (size_t i = 0; i < parts_.size(); ++i) add_player(i);
  if (p_.num_actions == 0)
    top_.bad(RDM_ERROR_FORMAT, 1, "nothing is moved by actions; add a [[robot]] with a control");
  check(top_, 1, rdm_scene_set_actions(scene_, hold_.size(), hold_.data(), hold_.data()));
  for (const Table& t : top_.rows("draw")) add_factor(t);
}

int32_t PlayerText::row_of(const Part& part, const Table& t, int line, const std::string& name) const {
  std::vector<std::string> names;
  const auto& links = part.draft->links;
  for (size_t i = 0; i < links.size(); ++i) {
    if (name == links[i].joint || name == part.name + '_' + links[i].joint) return static_cast<int32_t>(i);
    names.emplace_back(links[i].joint);
  }
  t.bad(RDM_ERROR_NOT_FOUND, line, "there is no joint %s%s", clean(name).c_str(),
        nearest_hint(name, names).c_str());
}

void PlayerText::read_joints(const Part& part, const char* key, Span* out) const {
  const toml::node* n = part.t.find(key);
  if (!n) return;
  if (const toml::table* some = n->as_table()) {
    for (const auto& [joint, value] : *some)
      out[row_of(part, part.t, line_of(joint.source()), std::string(joint.str()))] = span(part.t, value, key);
  } else {
    spans(part.t, key, out, part.draft->links.size());
  }
}

void PlayerText::add_player(size_t index) {
  const Part& part = parts_[index];
  const Table& t = part.t;
  const Draft& d = *part.draft;
  const auto joints = static_cast<int32_t>(d.links.size());
  Player& player = *take(t, p_.players, &p_.num_players, kMostPlayers, "robots and trees");
  player.robot = static_cast<int32_t>(index);
  player.joint = num_joints_;
  player.joints = joints;
  num_joints_ += joints;
  if (num_joints_ > kMostTaskJoints)
    t.bad(RDM_ERROR_RANGE, line_of(t.t), "there are more than %d joints in all", kMostTaskJoints);
  // where the joints begin
  Span* start = p_.start + player.joint;
  for (int32_t i = 0; i < joints; ++i) {
    const auto at = static_cast<size_t>(i);
    double q = std::clamp(0.0, d.links[at].lower, d.links[at].upper);
    if (at < d.home.size()) q = d.home[at];
    if (const toml::node* n = t.find("start"); n && n->is_string() && n->as_string()->get() == "folded") {
      if (d.folded.empty()) t.bad(RDM_ERROR_FORMAT, line_of(*n), "start: the robot has no folded pose");
      q = d.folded[at];
    }
    if (at < part.start.size()) q = part.start[at];
    start[i] = {q, q};
  }
  if (const toml::node* n = t.find("start"); n && n->is_string()) {
    static constexpr const char* kPoses[] = {"home", "folded"};
    t.choice("start", kPoses, 2, 0);
  } else {
    read_joints(part, "start", start);
  }
  Span* noise = p_.noise + player.joint;
  if (const toml::node* n = t.find("noise"); n && !n->is_table() && !n->is_array()) {
    const double x = t.as_number(*n, "noise");
    if (!(x >= 0 && x <= 10)) t.bad(RDM_ERROR_RANGE, line_of(*n), "noise: %g is outside [0, 10]", x);
    std::fill_n(noise, joints, Span{-x, x});
  } else {
    read_joints(part, "noise", noise);
  }
  std::vector<Span> rest(d.links.size(), {kNone, kNone});
  read_joints(part, "rest", rest.data());
  for (int32_t i = 0; i < joints; ++i) {
    const int32_t j = player.joint + i;
    rdm_joint_info info = RDM_INIT(rdm_joint_info);
    check(t, line_of(t.t), rdm_scene_joint_at(scene_, j, &info));
    p_.rest[j] = rest[static_cast<size_t>(i)].low;
    const double beyond = 0.1 * (info.upper - info.lower);  // against a stop
    if (!(start[i].low >= info.lower - beyond && start[i].high <= info.upper + beyond))
      t.bad(RDM_ERROR_RANGE, line_of(t.t), "start: %g..%g of %s is outside [%g, %g]", start[i].low,
            start[i].high, info.name, info.lower, info.upper);
    p_.lower[j] = std::min(info.lower, start[i].low);
    p_.upper[j] = std::max(info.upper, start[i].high);
  }
  controls(part, index < num_robots(), &player);
  // a free base
  if (t.flag("free_base")) {
    double p[3], q[4];
    player.placed = read_drawn(t, player.p, player.turn, player.q, p, q);
  }
  player.compensated = t.flag("compensate");
  player.push_action = -1;
  if (const toml::node* n = t.find("push")) {
    if (!t.flag("free_base")) t.bad(RDM_ERROR_FORMAT, line_of(*n), "push needs free_base = true");
    t.numbers("push", player.push, 2);
    player.push_action = p_.num_actions;
    add_actions(t, 6, 0);
  }
}

void PlayerText::add_actions(const Table& t, int32_t count, float hold) {
  p_.num_actions += count;
  if (p_.num_actions > kMostTaskActions)
    t.bad(RDM_ERROR_RANGE, line_of(t.t), "there are more than %d actions in all", kMostTaskActions);
  hold_.insert(hold_.end(), static_cast<size_t>(count), hold);
}

void PlayerText::controls(const Part& part, bool robot, Player* player) {
  const Table& t = part.t;
  const Draft& d = *part.draft;
  static constexpr const char* kControls[] = {"none", "position", "delta", "velocity"};
  const int32_t control = t.choice("control", kControls, 4, robot ? 1 : 0);
  player->control = control == 0 ? Control::kNone : control == 1 ? Control::kPosition : Control::kDelta;
  double step = 0.05, speed = 0, frequency = 60;
  t.number("step", &step);
  t.number("speed", &speed);
  t.number("smooth", &player->keep);
  if (!(player->keep >= 0 && player->keep < 1))
    t.bad(RDM_ERROR_RANGE, line_of(*t.find("smooth")), "smooth: %g is outside [0, 1)", player->keep);
  check(t, line_of(t.t), rdm_scene_get_number(scene_, "frequency", &frequency));
  player->command = p_.num_commands;
  player->action = p_.num_actions;
  std::vector<std::string> drive{"*"};
  if (t.find("drive")) drive = texts(t, "drive", 1, kMostTaskJoints);
  for (int32_t i = 0; i < player->joints; ++i) {
    const int32_t j = player->joint + i;
    rdm_joint_info info = RDM_INIT(rdm_joint_info);
    check(t, line_of(t.t), rdm_scene_joint_at(scene_, j, &info));
    if (info.action < 0) continue;
    if (player->command + info.action >= kMostTaskActions)
      t.bad(RDM_ERROR_RANGE, line_of(t.t), "there are more than %d commands in all", kMostTaskActions);
    Command& c = p_.commands[player->command + info.action];
    c.joint = j;
    c.lower = info.lower, c.upper = info.upper;
    const auto at = static_cast<size_t>(i);
    for (const rdm_robot_curve& curve : d.curves)
      if (curve.link == i && curve.driver == i) {
        c.knots = curve.num_knots;
        std::copy_n(curve.command, 4, c.x);
        std::copy_n(curve.angle, 4, c.y);
      }
    const double rate = speed > 0 ? speed : d.links[at].velocity > 0 ? d.links[at].velocity : 1;
    c.step = 2 * (control == 3 ? rate / frequency : step) / (info.upper - info.lower);
    const bool driven =
        player->control != Control::kNone &&
        std::any_of(drive.begin(), drive.end(), [&](const std::string& pattern) {
          return name_matches(pattern.c_str(), d.links[at].joint) || name_matches(pattern.c_str(), info.name);
        });
    c.action = driven ? 0 : -1;
    player->commands = std::max(player->commands, info.action + 1);
  }
  p_.num_commands += player->commands;
  for (int32_t k = 0; k < player->commands; ++k) {
    Command& c = p_.commands[player->command + k];
    if (c.action < 0) continue;
    c.action = player->actions++;
    double q = 0;
    middle(p_.start + c.joint, 1, &q);
    add_actions(t, 1, player->control == Control::kPosition ? static_cast<float>(command_at(c, q)) : 0.0f);
  }
  if (t.find("drive") && player->actions == 0)
    t.bad(RDM_ERROR_NOT_FOUND, line_of(*t.find("drive")),
          "drive: there is no joint with a command of this name%s",
          nearest_hint(drive[0], joint_names_).c_str());
}

void PlayerText::add_factor(const Table& t) {
  static constexpr const char* kWhat[] = {
      "gravity",   "link_mass",    "link_kp",   "link_kd",   "link_effort",         "link_friction",
      "base_mass", "base_damping", "body_mass", "body_size", "body_linear_damping", "body_angular_damping",
      "friction"};
  t.only({"what", "of", "between", "factor", "each"});
  t.need("what");
  const int32_t what = t.choice("what", kWhat, 13, 0);
  Factor f{};
  f.what = what;
  f.factor = span(t, t.need("factor"), "factor");
  const bool each = t.flag("each");
  bool first = true;
  const auto add = [&](int32_t index, int32_t other) {
    f.index = index, f.other = other;
    f.with_last = !first && !each;
    first = false;
    *take(t, p_.factors, &p_.num_factors, kMostFactors, "factors") = f;
  };
  if (what == RDM_SCALE_GRAVITY) return add(0, 0);
  if (what == RDM_SCALE_FRICTION) {
    const auto pair = texts(t, "between", 2, 2);
    return add(find(t, "between", RDM_SCENE_MATERIAL, pair[0]),
               find(t, "between", RDM_SCENE_MATERIAL, pair[1]));
  }
  for (const std::string& pattern : texts(t, "of", 1, kMostListed)) {
    if (what == RDM_SCALE_BASE_MASS || what == RDM_SCALE_BASE_DAMPING) {
      add(find(t, "of", RDM_SCENE_ROBOT, pattern), 0);
    } else if (what >= RDM_SCALE_BODY_MASS) {
      add(find(t, "of", RDM_SCENE_BODY, pattern), 0);
    } else {
      int32_t j = 0;
      bool any = false;
      for (const Part& part : parts_)
        for (const rdm_robot_link& l : part.draft->links) {
          const std::string link = part.name + '_' + l.name;
          if (pattern == part.name || name_matches(pattern.c_str(), link.c_str())) add(j, 0), any = true;
          ++j;
        }
      if (!any)
        t.bad(RDM_ERROR_NOT_FOUND, line_of(t.need("of")), "of: there is no link %s%s", clean(pattern).c_str(),
              nearest_hint(pattern, names_).c_str());
    }
  }
}

}  // namespace rdm::import
