#include "robot/mounted.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/error.hpp"
#include "base/option.hpp"
#include "physics/model/inertia.hpp"
#include "robot/kinematics.hpp"

namespace rdm {
namespace {

Inertia inertia_of(const RobotLink& l) {
  Inertia out;
  out.mass = l.mass;
  out.com = l.com;
  std::copy_n(l.moment, 6, out.moment);
  return out;
}

void set_inertia(RobotLink* l, const Inertia& inertia) {
  l->mass = inertia.mass;
  l->com = inertia.com;
  std::copy_n(inertia.moment, 6, l->moment);
}

// The mirror image of a frame is left-handed; of a mount z must stay what it is, out of the arm, so that of x
// and y the one is turned back that lies more along the mirror's normal.
Quat mirrored_mount(const Quat& q, int32_t axis) {
  Vec3 normal;
  normal[axis] = 1;
  const Vec3 n = rotate(conjugate(q), normal);
  const Quat back = std::fabs(n.x) > std::fabs(n.y) ? Quat{0, 1, 0, 0} : Quat{0, 0, 1, 0};
  Quat half = {0, 0, 0, 0};  // a reflection is a half turn and an inversion; two inversions are nothing
  (axis == 0 ? half.x : axis == 1 ? half.y : half.z) = 1;
  return half * q * back;
}

// As many joints as `robot` has: its own or zeros within the limits.
void add_pose(const Robot& robot, const Table<double>& q, Vector<double>* out) {
  for (int32_t i = 0; i < robot.links.count; ++i) out->push_back(start_angle(robot, q, i));
}

// Joins two robots' rows: those of the second get other numbers, parents and perhaps names.
class Joiner {
 public:
  Joiner(const Robot& arm, const Robot& hand, const Pose& X_LR)
      : arm_(arm), hand_(hand), X_LR_(X_LR), out_(arm), first_(arm.links.count) {}

  RobotCopy join() {
    if (arm_.root.mass == 0 && arm_.flange == kRootLink) out_.bind().root = transformed(hand_.root, X_LR_);
    add_links();
    add_shapes();
    add_drives();
    add_parts();
    return std::move(out_);
  }

 private:
  int32_t link(int32_t row) const { return row < 0 ? arm_.flange : first_ + row; }
  // A pose or point of the hand's root frame as the flange's link has it.
  Pose pose(int32_t row, const Pose& X) const { return row < 0 ? X_LR_ * X : X; }

  template <class Rows, class Text>
  const char* name(const Rows& rows, Text&& text, const char* own) {
    for (const auto& row : rows)
      if (same_name(text(row), own)) {
        char longer[2 * kNameSize];
        std::snprintf(longer, sizeof longer, "hand_%s", own);
        return out_.keep(longer);
      }
    return out_.keep(own);
  }

  void add_links() {
    if (arm_.flange >= 0) {
      RobotLink& carrier = out_.links[static_cast<size_t>(arm_.flange)];
      set_inertia(&carrier, combined(inertia_of(carrier), transformed(hand_.root, X_LR_)));
    }
    for (RobotLink row : hand_.links) {
      if (row.parent < 0) {
        const Pose X = X_LR_ * link_frame(row);
        row.p_PL = X.p;
        row.rpy_PL = {};
        row.q_PL = X.q;
      }
      row.parent = link(row.parent);
      row.name = name(
          arm_.links, [](const RobotLink& l) { return l.name; }, row.name);
      row.joint = name(
          arm_.links, [](const RobotLink& l) { return l.joint; }, row.joint);
      out_.links.push_back(row);
    }
  }

  void add_shapes() {
    const int32_t arm_shapes = arm_.shapes.count;
    for (RobotShape s : hand_.shapes) {
      const Pose X = pose(s.link, {s.p, s.q});
      s.p = X.p;
      s.q = X.q;
      s.link = link(s.link);
      s.name = name(
          arm_.shapes, [](const RobotShape& a) { return a.name; }, s.name);
      out_.shapes.push_back(s);
    }
    for (const RobotPair& p : hand_.self_pairs)
      out_.self_pairs.push_back({arm_shapes + p.a, arm_shapes + p.b});
    const int32_t last = arm_.flange, before = last >= 0 ? arm_.links[last].parent : kNoLink;
    for (int32_t h = 0; h < hand_.shapes.count; ++h)
      for (int32_t a = 0; a < arm_shapes; ++a) {
        const int32_t carrier = arm_.shapes[a].link;
        if (hand_.shapes[h].link < 0 && (carrier == last || carrier == before)) continue;
        if (carrier == last && hand_.links[hand_.shapes[h].link].parent < 0) continue;  // neighbours
        out_.self_pairs.push_back({arm_shapes + h, a});
      }
  }

  void add_drives() {
    for (RobotCoupling c : hand_.couplings)
      out_.couplings.push_back({link(c.link), link(c.other), c.ratio, c.slack});
    for (RobotCurve c : hand_.curves) {
      c.link = link(c.link);
      c.driver = link(c.driver);
      out_.curves.push_back(c);
    }
    out_.commands.clear();
    for (int32_t i = 0; i < arm_.num_actuated(); ++i) out_.commands.push_back(arm_.actuated(i));
    for (int32_t i = 0; i < hand_.num_actuated(); ++i) out_.commands.push_back(link(hand_.actuated(i)));
    out_.home.clear();
    add_pose(arm_, arm_.home, &out_.home);
    add_pose(hand_, hand_.home, &out_.home);
    if (hand_.poses.folded.count) {
      add_pose(arm_, arm_.home, &out_.folded);
      add_pose(hand_, hand_.poses.folded, &out_.folded);
    }
    if (hand_.poses.closed.count) {
      out_.closed.assign(static_cast<size_t>(arm_.num_actuated()), 0.0f);
      out_.closed.insert(out_.closed.end(), hand_.poses.closed.begin(), hand_.poses.closed.end());
    }
  }

  void add_parts() {
    for (RobotTip t : hand_.tips) out_.tips.push_back({link(t.link), t.p_L});
    for (RobotFinger f : hand_.fingers) {
      f.name = out_.keep(f.name);
      for (int32_t* row : {&f.first, &f.lateral, &f.proximal, &f.middle})
        if (*row >= 0) *row = link(*row);
      out_.fingers.push_back(f);
    }
    char text[4 * kNameSize];
    std::snprintf(text, sizeof text, "%s+%s", arm_.alias ? arm_.alias : arm_.name,
                  hand_.alias ? hand_.alias : hand_.name);
    const char* own = out_.keep(text);
    std::snprintf(text, sizeof text, "%s on %s", hand_.name, arm_.name);
    const char* help = out_.keep(text);
    Robot& r = out_.bind();
    r.name = own;
    r.help = help;
    r.alias = nullptr;
    r.kind = RobotKind::kHand;
    r.mirror = -1;
    r.arm_links = first_;
    r.arm_commands = arm_.num_actuated();
    r.palm = link(hand_.palm);
    const bool rooted = hand_.palm == kRootLink;
    const auto point = [&](const Vec3& p) { return rooted ? X_LR_ * p : p; };
    const auto direction = [&](const Vec3& v) { return rooted ? rotate(X_LR_.q, v) : v; };
    r.p_palm = point(hand_.p_palm);
    r.n_palm = direction(hand_.n_palm);
    r.z_palm = direction(hand_.z_palm);
    r.p_hold = point(hand_.p_hold);
  }

  const Robot &arm_, &hand_;
  const Pose X_LR_;  // of the hand's root in the flange's link
  RobotCopy out_;
  const int32_t first_;
};

}  // namespace

Pose mounted_root(const Robot& hand, const Mounting& mounting) {
  return Pose{{0, 0, mounting.adapter}, axis_angle({0, 0, 1}, mounting.yaw)} * inverse(hand.X_RM);
}

RobotCopy make_mounted(const Robot& arm, const Robot& hand, const Mounting& mounting) {
  if (arm.flange == kNoLink || arm.kind != RobotKind::kArm)
    fail(Code::kUnsupported, "robot %s is not an arm: it has no flange", arm.name);
  if (hand.kind != RobotKind::kHand || hand.palm == kNoLink)
    fail(Code::kUnsupported, "robot %s is not a hand", hand.name);
  if (arm.links.count + hand.links.count > kMaxRobotLinks)
    fail(Code::kUnsupported, "%s on %s: together they have %d links, but at most %d are allowed", hand.name,
         arm.name, arm.links.count + hand.links.count, kMaxRobotLinks);
  return Joiner(arm, hand, arm.X_LF * mounted_root(hand, mounting)).join();
}

RobotCopy make_mirrored(const Robot& robot) {
  const int32_t axis = robot.mirror;
  if (axis < 0) fail(Code::kUnsupported, "%s: this robot has no left side", robot.name);
  RobotCopy out(robot);
  const auto mirror = [axis](const Pose& X) {
    return Pose{mirrored_point(X.p, axis), mirrored_turn(X.q, axis)};
  };
  for (RobotLink& l : out.links) {
    const Pose X = mirror(link_frame(l));
    l.p_PL = X.p;
    l.rpy_PL = {};
    l.q_PL = X.q;
    set_inertia(&l, mirrored_inertia(inertia_of(l), axis));
    l.axis = l.kind == JointKind::kPrismatic ? mirrored_point(l.axis, axis) : mirrored_axis(l.axis, axis);
  }
  for (RobotShape& s : out.shapes) {
    const Pose X = mirror({s.p, s.q});
    s.p = X.p;
    s.q = X.q;
  }
  for (RobotTip& t : out.tips) t.p_L = mirrored_point(t.p_L, axis);
  Robot& r = out.bind();
  r.root = mirrored_inertia(robot.root, axis);
  r.p_palm = mirrored_point(robot.p_palm, axis);
  r.n_palm = mirrored_point(robot.n_palm, axis);
  r.z_palm = mirrored_point(robot.z_palm, axis);
  r.p_hold = mirrored_point(robot.p_hold, axis);
  r.X_RM = {mirrored_point(robot.X_RM.p, axis), mirrored_mount(robot.X_RM.q, axis)};
  r.X_LF = mirror(robot.X_LF);
  return out;
}

}  // namespace rdm
