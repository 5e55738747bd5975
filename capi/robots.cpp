// rdm_robot_*: robots that a host describes, and what it can ask of any.
#include "capi/handles.hpp"
#include "capi/pose.hpp"

#if RDM_WITH_SIM
#include <cmath>

#include "base/lasting.hpp"
#include "robot/kinematics.hpp"
#include "robot/mounted.hpp"
#include "robot/robots.hpp"

using namespace rdm;
using namespace rdm::capi;

static_assert(RDM_MAX_LINKS == kMaxRobotLinks && RDM_MAX_KNOTS == kMaxKnots);
static_assert(static_cast<int>(RDM_ROBOT_HAND) == static_cast<int>(RobotKind::kHand) &&
              static_cast<int>(RDM_ROBOT_ARM) == static_cast<int>(RobotKind::kArm));
static_assert(RDM_LINK_ROOT == kRootLink && RDM_LINK_NONE == kNoLink);

namespace {

constexpr size_t kFirstSize = sizeof(rdm_robot_def);
constexpr int32_t kMostRows = 4096;

rdm_robot_def default_def() {
  rdm_robot_def d{};
  d.mirror = -1;
  d.mount.q[3] = d.flange.q[3] = 1;
  d.flange_link = d.palm_link = RDM_LINK_NONE;
  d.palm_normal[1] = -1;
  d.palm_fingers[2] = 1;
  return d;
}

void need_rows(const void* rows, int32_t count, int32_t most, const char* name) {
  if (count < 0 || count > most) fail(Code::kRange, "def.num_%s: %d is outside [0, %d]", name, count, most);
  if (count > 0 && !rows) fail(Code::kArgument, "def.%s is NULL with num_%s %d", name, name, count);
}

RobotLink link_of(const rdm_robot_link& in) {
  RobotLink l{};
  l.name = in.name;
  l.joint = in.joint;
  l.parent = in.parent;
  const Pose X_PL = from_abi(in.pose);
  l.p_PL = X_PL.p;
  l.q_PL = X_PL.q;
  l.mass = in.mass;
  l.com = vec(in.com);
  std::copy_n(in.moment, 6, l.moment);
  l.kind = static_cast<JointKind>(in.kind);
  l.axis = vec(in.axis);
  l.lower = in.lower;
  l.upper = in.upper;
  l.kp = in.kp;
  l.kd = in.kd;
  l.effort = in.effort;
  l.armature = in.armature;
  l.friction = in.friction;
  l.velocity = in.velocity;
  return l;
}

RobotShape shape_of(const rdm_robot_shape& in) {
  check_reserved(in, "def.shapes");
  const Pose X_LS = from_abi(in.pose);
  RobotShape s{in.link, in.name, static_cast<ShapeKind>(in.kind), vec(in.size), X_LS.p, X_LS.q, {}};
  std::copy_n(in.color, 3, s.color);
  return s;
}

RobotCurve curve_of(const rdm_robot_curve& in) {
  check_reserved(in, "def.curves");
  RobotCurve c{in.link, in.driver, in.num_knots, {}, {}};
  std::copy_n(in.command, kMaxKnots, c.command);
  std::copy_n(in.angle, kMaxKnots, c.angle);
  return c;
}

// Every pair of shapes whose links are neither the same nor parent and child. Rows that are out of range are
// left for check_robot.
void add_all_pairs(RobotCopy* r) {
  const auto links = static_cast<int32_t>(r->links.size());
  const auto parent = [&](int32_t link) {
    return link >= 0 && link < links ? r->links[static_cast<size_t>(link)].parent : kNoLink;
  };
  for (int32_t b = 0; b < static_cast<int32_t>(r->shapes.size()); ++b)
    for (int32_t a = 0; a < b; ++a) {
      const int32_t la = r->shapes[static_cast<size_t>(a)].link, lb = r->shapes[static_cast<size_t>(b)].link;
      if (la != lb && parent(la) != lb && parent(lb) != la) r->self_pairs.push_back({a, b});
    }
}

const RobotLink& link_at(const Robot& r, int32_t i) {
  need_index(i, r.links.count, "i");
  return r.links[i];
}

// [links] `q`, or zeros within the limits.
void give_pose(const Robot& r, const Table<double>& q, bool or_zero, double* out) {
  for (int32_t i = 0; out && i < r.links.count; ++i)
    out[i] = or_zero && q.count == 0 ? 0 : start_angle(r, q, i);
}

void need_finite(const double* x, int32_t count, const char* name) {
  need(x, name);
  for (int32_t i = 0; i < count; ++i)
    if (!std::isfinite(x[i])) fail(Code::kArgument, "%s[%d] is not finite", name, i);
}

}  // namespace

RobotCopy rdm::capi::robot_from(const rdm_robot_def* def) {
  const auto in = read_struct(def, kFirstSize, default_def(), "def");
  need_rows(in.links, in.num_links, RDM_MAX_LINKS, "links");
  need_rows(in.shapes, in.num_shapes, kMostRows, "shapes");
  need_rows(in.pairs, std::max(in.num_pairs, 0), kMostRows, "pairs");
  if (in.num_pairs < -1) fail(Code::kRange, "def.num_pairs: %d is outside [-1, %d]", in.num_pairs, kMostRows);
  need_rows(in.couplings, in.num_couplings, RDM_MAX_LINKS, "couplings");
  need_rows(in.curves, in.num_curves, RDM_MAX_LINKS, "curves");
  if (in.num_commands < -1)
    fail(Code::kRange, "def.num_commands: %d is outside [-1, %d]", in.num_commands, RDM_MAX_LINKS);
  need_rows(in.commands, std::max(in.num_commands, 0), RDM_MAX_LINKS, "commands");
  need_rows(in.fingers, in.num_fingers, RDM_MAX_LINKS, "fingers");
  RobotCopy r;
  for (int32_t i = 0; i < in.num_links; ++i) r.links.push_back(link_of(in.links[i]));
  for (int32_t i = 0; i < in.num_shapes; ++i) r.shapes.push_back(shape_of(in.shapes[i]));
  for (int32_t i = 0; i < in.num_pairs; ++i) r.self_pairs.push_back({in.pairs[i].a, in.pairs[i].b});
  if (in.num_pairs < 0) add_all_pairs(&r);
  for (int32_t i = 0; i < in.num_couplings; ++i) {
    const rdm_robot_coupling& c = in.couplings[i];
    r.couplings.push_back({c.link, c.other, c.ratio, c.slack});
  }
  for (int32_t i = 0; i < in.num_curves; ++i) r.curves.push_back(curve_of(in.curves[i]));
  r.commands.assign(in.commands, in.commands + std::max(in.num_commands, 0));
  for (int32_t i = 0; i < in.num_fingers; ++i) {
    const rdm_robot_finger& f = in.fingers[i];
    r.tips.push_back({f.tip, vec(f.p_tip)});
    r.fingers.push_back({f.name, f.first, f.lateral, f.proximal, f.middle, f.thumb != 0});
  }
  if (in.home) r.home.assign(in.home, in.home + in.num_links);
  if (in.folded) r.folded.assign(in.folded, in.folded + in.num_links);
  Robot& o = r.bind();
  o.passive = in.num_commands < 0;
  if (in.closed) {
    r.closed.assign(in.closed, in.closed + std::clamp(o.num_actuated(), 0, RDM_MAX_LINKS));
    r.bind();
  }
  o.name = in.name;
  o.alias = in.alias;
  o.help = in.summary ? in.summary : "";
  if (in.kind < RDM_ROBOT_OTHER || in.kind > RDM_ROBOT_ARM)
    fail(Code::kRange, "def.kind: %d is outside [0, 2]", in.kind);
  o.kind = static_cast<RobotKind>(in.kind);
  o.root.mass = in.root_mass;
  o.root.com = vec(in.root_com);
  std::copy_n(in.root_moment, 6, o.root.moment);
  o.X_RM = from_abi(in.mount);
  o.flange = in.flange_link;
  o.X_LF = from_abi(in.flange);
  o.palm = in.palm_link;
  o.p_palm = vec(in.palm_p);
  o.n_palm = vec(in.palm_normal);
  o.z_palm = vec(in.palm_fingers);
  o.p_hold = vec(in.hold_p);
  o.mirror = in.mirror;
  return r;
}

rdm_result rdm_robot_def_init(rdm_robot_def* def, size_t size) {
  return call([&] { init_struct(def, size, kFirstSize, default_def(), "def"); });
}

rdm_result rdm_robot_create(int32_t* out, const rdm_robot_def* def) {
  return call([&] {
    need(out, "out");
    *out = add_robot(robot_from(def).robot());
  });
}

rdm_result rdm_robot_destroy(int32_t robot) {
  return call([&] { remove_robot(robot); });
}

rdm_result rdm_robot_find(const char* name, int32_t* index) {
  return call([&] {
    need(name, "name");
    need(index, "index");
    *index = find_robot(name);
  });
}

rdm_result rdm_robot_create_mounted(int32_t* out, const char* name, int32_t arm, int32_t hand, double yaw,
                                    double adapter, int32_t left) {
  return call([&] {
    need(out, "out");
    need(name, "name");
    if (!std::isfinite(yaw)) fail(Code::kArgument, "yaw is not finite");
    if (!(adapter >= 0 && adapter <= 1)) fail(Code::kRange, "adapter: %g is outside [0, 1]", adapter);
    if (left != 0 && left != 1) fail(Code::kRange, "left: %d is outside [0, 1]", left);
    const RobotRef a(arm), h(hand);
    RobotCopy both = left ? make_mounted(*a, make_mirrored(*h).robot(), {yaw, adapter})
                          : make_mounted(*a, *h, {yaw, adapter});
    both.bind().name = name;
    *out = add_robot(both.robot());
  });
}

rdm_result rdm_robot_get_def(int32_t robot, rdm_robot_def* io) {
  return call([&] {
    check_out(io, kFirstSize, "io");
    const RobotRef ref(robot);
    const Robot& r = *ref;
    rdm_robot_def d = default_def();
    d.kind = static_cast<int32_t>(r.kind);
    d.name = lasting(r.name);
    d.alias = lasting(r.alias);
    d.summary = lasting(r.help);
    d.num_links = r.links.count;
    d.num_shapes = r.shapes.count;
    d.num_pairs = r.self_pairs.count;
    d.num_couplings = r.couplings.count;
    d.num_curves = r.curves.count;
    d.num_commands = r.passive ? -1 : r.num_actuated();
    d.num_fingers = r.fingers.count;
    d.mirror = r.mirror;
    d.root_mass = r.root.mass;
    put(r.root.com, d.root_com);
    std::copy_n(r.root.moment, 6, d.root_moment);
    d.mount = to_abi(r.X_RM);
    d.flange = to_abi(r.X_LF);
    d.flange_link = r.flange;
    d.palm_link = r.palm;
    put(r.p_palm, d.palm_p);
    put(r.n_palm, d.palm_normal);
    put(r.z_palm, d.palm_fingers);
    put(r.p_hold, d.hold_p);
    write_struct(io, d, kFirstSize, "io");
  });
}

rdm_result rdm_robot_link_at(int32_t robot, int32_t i, rdm_robot_link* out) {
  return call([&] {
    need(out, "out");
    const RobotRef ref(robot);
    const RobotLink& l = link_at(*ref, i);
    rdm_robot_link o{};
    o.name = lasting(l.name);
    o.joint = lasting(l.joint);
    o.parent = l.parent;
    o.kind = static_cast<int32_t>(l.kind);
    o.pose = to_abi({l.p_PL, link_frame(l).q});
    put(l.axis, o.axis);
    o.lower = l.lower;
    o.upper = l.upper;
    o.velocity = l.velocity;
    o.kp = l.kp;
    o.kd = l.kd;
    o.effort = l.effort;
    o.armature = l.armature;
    o.friction = l.friction;
    o.mass = l.mass;
    put(l.com, o.com);
    std::copy_n(l.moment, 6, o.moment);
    *out = o;
  });
}

rdm_result rdm_robot_shape_at(int32_t robot, int32_t i, rdm_robot_shape* out) {
  return call([&] {
    need(out, "out");
    const RobotRef ref(robot);
    need_index(i, ref->shapes.count, "i");
    const RobotShape& s = ref->shapes[i];
    rdm_robot_shape o{};
    o.name = lasting(s.name);
    o.link = s.link;
    o.kind = static_cast<int32_t>(s.kind);
    put(s.size, o.size);
    o.pose = to_abi({s.p, s.q});
    std::copy_n(s.color, 3, o.color);
    o.color[3] = 255;
    *out = o;
  });
}

rdm_result rdm_robot_pair_at(int32_t robot, int32_t i, rdm_robot_pair* out) {
  return call([&] {
    need(out, "out");
    const RobotRef ref(robot);
    need_index(i, ref->self_pairs.count, "i");
    *out = {ref->self_pairs[i].a, ref->self_pairs[i].b};
  });
}

rdm_result rdm_robot_coupling_at(int32_t robot, int32_t i, rdm_robot_coupling* out) {
  return call([&] {
    need(out, "out");
    const RobotRef ref(robot);
    need_index(i, ref->couplings.count, "i");
    const RobotCoupling& c = ref->couplings[i];
    *out = {c.link, c.other, c.ratio, c.slack};
  });
}

rdm_result rdm_robot_curve_at(int32_t robot, int32_t i, rdm_robot_curve* out) {
  return call([&] {
    need(out, "out");
    const RobotRef ref(robot);
    need_index(i, ref->curves.count, "i");
    const RobotCurve& c = ref->curves[i];
    rdm_robot_curve o{};
    o.link = c.link;
    o.driver = c.driver;
    o.num_knots = c.knots;
    std::copy_n(c.command, kMaxKnots, o.command);
    std::copy_n(c.angle, kMaxKnots, o.angle);
    *out = o;
  });
}

rdm_result rdm_robot_finger_at(int32_t robot, int32_t i, rdm_robot_finger* out) {
  return call([&] {
    need(out, "out");
    const RobotRef ref(robot);
    need_index(i, ref->fingers.count, "i");
    const RobotFinger& f = ref->fingers[i];
    rdm_robot_finger o{lasting(f.name), f.first,  ref->tips[i].link, f.lateral,
                       f.proximal,      f.middle, f.thumb,           {}};
    put(ref->tips[i].p_L, o.p_tip);
    *out = o;
  });
}

rdm_result rdm_robot_get_postures(int32_t robot, int32_t* commands, double* home, double* folded,
                                  float* closed) {
  return call([&] {
    const RobotRef ref(robot);
    const Robot& r = *ref;
    const int32_t n = r.num_actuated();
    for (int32_t i = 0; commands && i < n; ++i) commands[i] = r.actuated(i);
    give_pose(r, r.home, false, home);
    give_pose(r, r.poses.folded, true, folded);
    for (int32_t i = 0; closed && i < n; ++i) closed[i] = r.poses.closed.count ? r.poses.closed[i] : 0;
  });
}

rdm_result rdm_robot_get_poses(int32_t robot, const double* q, rdm_pose* links, rdm_pose* flange,
                               double* tips, rdm_pose* palm) {
  return call([&] {
    need(links, "links");
    const RobotRef ref(robot);
    const Robot& r = *ref;
    need_finite(q, r.links.count, "q");
    if (flange && r.flange == kNoLink) fail(Code::kUnsupported, "robot %s has no flange", r.name);
    if (palm && r.palm == kNoLink) fail(Code::kUnsupported, "robot %s has no palm", r.name);
    Pose X_RL[kMaxRobotLinks];
    link_poses(r, q, X_RL);
    for (int32_t i = 0; i < r.links.count; ++i) links[i] = to_abi(X_RL[i]);
    if (flange) *flange = to_abi(flange_pose(r, q));
    for (int32_t i = 0; tips && i < r.tips.count; ++i)
      put(X_RL[r.tips[i].link] * r.tips[i].p_L, tips + 3 * i);
    if (palm) *palm = to_abi(palm_frame(r, q));
  });
}

rdm_result rdm_robot_reach(int32_t robot, const rdm_pose* flange, double* q, int32_t* found) {
  return call([&] {
    need(found, "found");
    const RobotRef ref(robot);
    if (ref->flange == kNoLink) fail(Code::kUnsupported, "robot %s has no flange", ref->name);
    const Pose goal = need_pose(flange, "flange");
    need_finite(q, ref->links.count, "q");
    *found = solve_reach(*ref, goal, q);
  });
}
#endif
