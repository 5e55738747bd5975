#include "physics/ode/ode_links.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"
#include "physics/model/inertia.hpp"
#include "physics/ode_library/ode_convert.hpp"

// One substep; W world, L link, P parent (World::rebuild has the kinematics):
//   products   rates that stay are not momenta that stay: the bodies' velocities J(q) qd change by h dJ/dt qd
//              from pose to pose. What that takes,
//                alpha = alpha_P + w_P x w_L,  a = a_P + alpha_P x r + w_P x (w_P x r) + 2 w_P x slide,
//                f = m a_c,  n_c = I alpha + w x I w,
//              is summed from the tips (RNEA) and taken from the joints, as torques -C(q, qd) qd, and from a free
//              base. I is the link's own moment, without armature. What damps the bodies damps these too.
//   drive      each joint's motor row is told velocity v*, softness cfm and bound F (drive.hpp). With J the
//              row that takes the bodies' velocities to the joint's rate, the solver looks for lambda with
//                h J M^-1 J^T lambda + cfm lambda = v* - J v,   |lambda| <= F,
//              beside the rows that hold the joint together.
//   solve      ODE's, at most 8 sweeps: what the bodies got is not yet that lambda.
//   integrate  rate qd = a . (w_L - w_P) about the axis a that the solver used; q += h qd, clamped. The
//              torque told is the drive law's at that rate, clip((v* - qd) / cfm, -F, F), which a converged
//              lambda equals: the sweeps' own lambda dies away while a finger presses (to a quarter within
//              half a second), because what they leave of the joints' rows is dropped when links are written.
//   write      every body goes where forward kinematics says: no drift.
// A universal joint has two such axes, at a right angle.
namespace rdm {
namespace {

constexpr dReal kStill[4] = {0, 0, 0, 0};
constexpr double kLightMoment = 1e-4;  // kg m2: links below it get the solver's link_armature

double largest_moment(const Inertia& inertia) {
  return std::max({inertia.moment[0], inertia.moment[1], inertia.moment[2]});
}

double trace(const Inertia& inertia) {
  return inertia.moment[0] + inertia.moment[1] + inertia.moment[2];
}

// About the joint's axis. The outer axis of a universal joint turns in the link, so that one gets it all
// around.
void add_armature(Inertia* inertia, double armature, const Vec3& axis, bool all_around) {
  Mat3 moment = moment_matrix(*inertia);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      moment(r, c) += armature * (all_around ? (r == c ? 1.0 : 0.0) : axis[r] * axis[c]);
  set_moment(inertia, moment);
}

// x of A x = b, by Cramer's rule.
Vec3 solved(const Mat3& A, const Vec3& b) {
  const Vec3 x = A.col(0), y = A.col(1), z = A.col(2), across = cross(y, z);
  return (1 / dot(x, across)) * Vec3{dot(b, across), dot(x, cross(b, z)), dot(x, cross(y, b))};
}

dBodyID make_body(dWorldID world, const Inertia& inertia) {
  const dBodyID body = dBodyCreate(world);
  dMass mass;
  const double* m = inertia.moment;
  dMassSetParameters(&mass, inertia.mass, 0, 0, 0, m[0], m[1], m[2], m[3], m[4], m[5]);
  dBodySetMass(body, &mass);
  dBodySetGyroscopicMode(body, 0);
  return body;
}

}  // namespace

void OdeLinks::carve(const Scene& scene, Arena& arena) {
  num_links_ = scene.num_links;
  links_ = arena.make<Link>(static_cast<size_t>(num_links_));
  joints_ = arena.make<Joint>(static_cast<size_t>(num_links_));
  bases_ = arena.make<Link>(scene.def.articulations.size());
  bias_ = arena.make<Bias>(static_cast<size_t>(num_links_));
  pushed_ = arena.make<Wrench>(scene.def.articulations.size());
  momentum_ = arena.make<Momentum>(scene.def.articulations.size());
}

// A link without shapes whose only child turns about a second axis through the same origin, at a right
// angle: one universal joint serves both, and the light body in between is spared.
bool OdeLinks::merges(const Scene& scene, int32_t link) const {
  const auto& frames = scene.frames;
  int32_t child = -1;
  for (int32_t i = link + 1; i < num_links_; ++i) {
    if (frames[static_cast<size_t>(i)].parent != link) continue;
    if (child >= 0) return false;
    child = i;
  }
  if (child < 0) return false;
  for (const SceneShape& shape : scene.shapes)
    if (shape.carrier == Carrier::kLink && shape.index == link) return false;
  const LinkFrame &a = frames[static_cast<size_t>(link)], &b = frames[static_cast<size_t>(child)];
  if (a.prismatic || b.prismatic || norm(b.p_PL) != 0 || scene.link(link).sensor) return false;
  if (scene.link(link).weightless != scene.link(child).weightless) return false;
  const bool parent_merges = a.parent >= 0 && !links_[a.parent].owner;
  return !parent_merges && std::fabs(dot(a.axis, rotate(b.q_PL, b.axis))) < 1e-9;
}

void OdeLinks::make_bodies(dWorldID world, int32_t articulation, const LinkState& state) {
  const Scene& scene = *state.scene;
  const ArticulationDef& def = scene.def.articulations[static_cast<size_t>(articulation)];
  Link& base = bases_[articulation];
  base = {nullptr, true, {}, 1};
  if (def.free_base) {
    base.com = def.base.com;
    base.body = make_body(world, def.base);
    dBodySetGravityMode(base.body, def.gravity);
  }
  const int32_t first = scene.link_offset[static_cast<size_t>(articulation)];
  const int32_t end = first + static_cast<int32_t>(def.links.size());
  for (int32_t i = first; i < end; ++i) {
    links_[i] = {nullptr, !merges(scene, i), {}, 1};
    if (!links_[i].owner) continue;
    const LinkDef& link = scene.link(i);
    const int32_t parent = scene.frames[static_cast<size_t>(i)].parent;
    const bool universal = parent >= 0 && !links_[parent].owner;
    // The light link in the middle of a universal joint is lumped at its child's centre of mass; shifting
    // the centre and adding its moment made the fingers softer under load.
    Inertia inertia = link.inertia;
    if (universal) inertia.mass += scene.link(parent).inertia.mass;
    if (inertia.mass <= 0 || !positive_definite(moment_matrix(inertia)))
      fail(Code::kRange, "%s: a link with a body needs mass and moment above 0", link.name.text);
    double armature = link.joint.armature;
    if (universal) armature = std::max(armature, scene.link(parent).joint.armature);
    if (largest_moment(inertia) < kLightMoment) armature += scene.def.solver.link_armature;
    const double own = trace(inertia);
    add_armature(&inertia, armature, link.joint.axis, universal);
    links_[i].own_share = own / trace(inertia);
    links_[i].com = inertia.com;
    links_[i].body = make_body(world, inertia);
    dBodySetGravityMode(links_[i].body, def.gravity && !link.weightless);
    if (universal) links_[parent].body = links_[i].body;
  }
}

void OdeLinks::make_joint(dWorldID world, int32_t i, const LinkState& state) {
  const Scene& scene = *state.scene;
  if (!links_[i].owner) return;  // its child makes the joint of both
  const LinkFrame& frame = scene.frames[static_cast<size_t>(i)];
  const bool universal = frame.parent >= 0 && !links_[frame.parent].owner;
  const int32_t first = universal ? frame.parent : i;
  const int32_t parent = scene.frames[static_cast<size_t>(first)].parent;
  const int32_t articulation = scene.link_articulation[static_cast<size_t>(i)];
  const dBodyID child_body = links_[i].body;
  const dBodyID parent_body = parent >= 0 ? links_[parent].body : bases_[articulation].body;
  const Vec3& p = state.links[i].X.p;

  Joint& joint = joints_[i];
  joint.def = &scene.link(i).joint;
  joint.child = child_body;
  joint.parent = parent_body;
  joint.w_child = dBodyGetAngularVel(child_body);
  joint.w_parent = parent_body ? dBodyGetAngularVel(parent_body) : kStill;
  joint.sign = 1;
  joint.cfm = joint.force = -1;
  const Vec3& axis = state.axes[i];
  if (universal) {
    const Vec3& outer = state.axes[first];
    const dJointID id = dJointCreateUniversal(world, nullptr);
    Joint& joint_of_first = joints_[first];
    joint_of_first = joint;
    joint_of_first.def = &scene.link(first).joint;
    joint.id = joint_of_first.id = id;
    // ODE measures the first body against the second; a joint with the world wants its body first.
    const bool parent_first = parent_body != nullptr;
    joint.sign = joint_of_first.sign = parent_first ? -1 : 1;
    joint.row = parent_first ? Row::kUniversal2 : Row::kUniversal1;
    joint_of_first.row = parent_first ? Row::kUniversal1 : Row::kUniversal2;
    const Vec3 &one = parent_first ? outer : axis, &two = parent_first ? axis : outer;
    dJointAttach(id, parent_first ? parent_body : child_body, parent_first ? child_body : parent_body);
    dJointSetUniversalAnchor(id, p.x, p.y, p.z);
    // ODE computes a frame from both axes at each call, which fails while they are parallel; the other axis of a new
    // joint may be parallel to the first one. The first axis is therefore set by way of a direction between the two.
    const Vec3 between = one + two + cross(one, two);
    dJointSetUniversalAxis1(id, between.x, between.y, between.z);
    dJointSetUniversalAxis2(id, two.x, two.y, two.z);
    dJointSetUniversalAxis1(id, one.x, one.y, one.z);
  } else if (frame.prismatic) {
    joint.id = dJointCreateSlider(world, nullptr);
    joint.row = Row::kSlider;
    dJointAttach(joint.id, child_body, parent_body);
    dJointSetSliderAxis(joint.id, axis.x, axis.y, axis.z);
  } else {
    joint.id = dJointCreateHinge(world, nullptr);
    joint.row = Row::kHinge;
    dJointAttach(joint.id, child_body, parent_body);
    dJointSetHingeAnchor(joint.id, p.x, p.y, p.z);
    dJointSetHingeAxis(joint.id, axis.x, axis.y, axis.z);
  }
}

void OdeLinks::make(dWorldID world, const LinkState& state) {
  const Scene& scene = *state.scene;
  for (int32_t a = 0; a < static_cast<int32_t>(scene.def.articulations.size()); ++a) {
    make_bodies(world, a, state);
    write_base(a, state);
    write(a, state);
    const int32_t first = scene.link_offset[static_cast<size_t>(a)];
    const auto count = static_cast<int32_t>(scene.def.articulations[static_cast<size_t>(a)].links.size());
    for (int32_t i = first; i < first + count; ++i) make_joint(world, i, state);
    for (int32_t i = first; i < first + count; ++i) {
      const int32_t other = joints_[i].def->coupled_to;
      joints_[i].other = other < 0 ? -1 : first + other;
    }
  }
}

void OdeLinks::push_velocity_products(const LinkState& state) {
  const Scene& scene = *state.scene;
  const auto spin_moment = [](const Inertia& inertia, const Mat3& R, const Vec3& w, const Vec3& alpha) {
    const auto turned = [&](const Vec3& v) { return R * (moment_matrix(inertia) * (transpose(R) * v)); };
    return turned(alpha) + cross(w, turned(w));
  };
  const auto push = [](dBodyID body, const Vec3& force, const Vec3& torque) {
    if (!body) return;
    dBodyAddForce(body, force.x, force.y, force.z);
    dBodyAddTorque(body, torque.x, torque.y, torque.z);
  };
  for (int32_t a = 0; a < static_cast<int32_t>(scene.def.articulations.size()); ++a) {
    const ArticulationDef& def = scene.def.articulations[static_cast<size_t>(a)];
    const Motion& base = state.bases[a];
    const int32_t first = scene.link_offset[static_cast<size_t>(a)],
                  end = first + static_cast<int32_t>(def.links.size());
    Bias of_base;
    const Vec3 base_arm = state.base_R[a] * def.base.com;
    if (def.free_base) {
      of_base.linear = -cross(base.w, cross(base.w, base_arm));  // its centre of mass goes straight on
      of_base.moment = spin_moment(def.base, state.base_R[a], base.w, {});
    }
    for (int32_t i = first; i < end; ++i) {
      const LinkFrame& frame = scene.frames[static_cast<size_t>(i)];
      const bool on_base = frame.parent < 0;
      const Motion &m = state.links[i], &parent = on_base ? base : state.links[frame.parent];
      const Bias& before = on_base ? of_base : bias_[frame.parent];
      const Vec3 r = m.X.p - parent.X.p, w_x_r = cross(parent.w, r), slide = m.v - parent.v - w_x_r;
      Bias& here = bias_[i];
      here = {};
      here.angular = before.angular + cross(parent.w, m.w);
      here.linear = before.linear + cross(before.angular, r) + cross(parent.w, w_x_r + 2 * slide);
      if (!links_[i].owner) continue;
      dMass mass;
      dBodyGetMass(links_[i].body, &mass);
      const Vec3 arm = state.link_R[i] * links_[i].com;
      here.force = mass.mass * (here.linear + cross(here.angular, arm) + cross(m.w, cross(m.w, arm)));
      here.moment = spin_moment(scene.link(i).inertia, state.link_R[i], m.w, here.angular) +
                    cross(m.X.p + arm - base.X.p, here.force);
    }
    const double factor = def.free_base ? 1 / (1 + scene.def.solver.h * def.base_damping) : 1;
    for (int32_t i = end - 1; i >= first; --i) {
      const LinkFrame& frame = scene.frames[static_cast<size_t>(i)];
      const Joint& joint = joints_[i];
      const Bias& here = bias_[i];
      Bias& inboard = frame.parent < 0 ? of_base : bias_[frame.parent];
      inboard.force += here.force;
      inboard.moment += here.moment;
      const Vec3& axis = state.axes[i];
      if (frame.prismatic) {
        const Vec3 force = (-factor * dot(axis, here.force)) * axis;
        Vec3 couple;  // what a force along two lines leaves, shared by both
        if (joint.parent)
          couple =
              0.5 * cross(from_ode(dBodyGetPosition(joint.parent)) - from_ode(dBodyGetPosition(joint.child)),
                          force);
        push(joint.child, force, couple);
        push(joint.parent, -force, couple);
      } else {
        const Vec3 torque =
            (-factor * dot(axis, here.moment - cross(state.links[i].X.p - base.X.p, here.force))) * axis;
        push(joint.child, {}, torque);
        push(joint.parent, {}, -torque);
      }
    }
    if (!def.free_base) continue;
    pushed_[a] = {-factor * of_base.force, -factor * (of_base.moment - cross(base_arm, of_base.force))};
    push(bases_[a].body, pushed_[a].force, pushed_[a].torque);
  }
}

// Of the bodies where ODE has them, turned as the state says.
OdeLinks::Momentum OdeLinks::momentum(int32_t articulation, const LinkState& state) const {
  const auto a = static_cast<size_t>(articulation);
  const int32_t first = state.scene->link_offset[a];
  const int32_t end = first + static_cast<int32_t>(state.scene->def.articulations[a].links.size());
  const auto each = [&](auto&& visit) {
    visit(bases_[articulation].body, state.base_R[articulation]);
    for (int32_t i = first; i < end; ++i)
      if (links_[i].owner) visit(links_[i].body, state.link_R[i]);
  };
  Momentum sum = {};
  each([&](dBodyID body, const Mat3&) {
    dMass m;
    dBodyGetMass(body, &m);
    sum.mass += m.mass;
    sum.center += m.mass * from_ode(dBodyGetPosition(body));
    sum.linear += m.mass * from_ode(dBodyGetLinearVel(body));
  });
  sum.center = (1 / sum.mass) * sum.center;
  std::fill_n(sum.moment.m, 9, 0.0);
  each([&](dBodyID body, const Mat3& R) {
    dMass m;
    dBodyGetMass(body, &m);
    const Vec3 r = from_ode(dBodyGetPosition(body)) - sum.center;
    Mat3 own;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) own(i, j) = m.I[4 * i + j];
    own = R * own * transpose(R);
    sum.angular +=
        own * from_ode(dBodyGetAngularVel(body)) + m.mass * cross(r, from_ode(dBodyGetLinearVel(body)));
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        sum.moment(i, j) += own(i, j) + m.mass * ((i == j ? dot(r, r) : 0.0) - r[i] * r[j]);
  });
  return sum;
}

// The bodies have moved and are still turned as they were.
void OdeLinks::note_momentum(int32_t articulation, const LinkState& state) {
  const double h = state.scene->def.solver.h;
  const dBodyID base = bases_[articulation].body;
  if (!base) return;
  Momentum& now = momentum_[articulation];
  now = momentum(articulation, state);
  const Wrench& push = pushed_[articulation];
  // where it was pushed, before they moved
  const Vec3 arm = from_ode(dBodyGetPosition(base)) - now.center -
                   h * (from_ode(dBodyGetLinearVel(base)) - (1 / now.mass) * now.linear);
  now.linear -= h * push.force;
  now.angular -= h * (push.torque + cross(arm, push.force));
}

// The rest of the motion is applied to the whole robot as one rigid body with its joints fixed; its centre of mass
// is where that of the solver's bodies is.
void OdeLinks::restore_momentum(int32_t articulation, const LinkState& state) const {
  if (!bases_[articulation].body) return;
  const Momentum now = momentum(articulation, state);
  const Momentum& meant = momentum_[articulation];
  const Vec3 w = solved(now.moment, meant.angular - now.angular);
  Motion& base = state.bases[articulation];
  base.v += (1 / now.mass) * (meant.linear - now.linear) + cross(w, base.X.p - now.center);
  base.w += w;
  base.X.p += meant.center - now.center;
}

void OdeLinks::tell(Joint& joint, const MotorRow& row) const {
  const double velocity = joint.sign * row.velocity;
  const bool softness = row.cfm != joint.cfm, bound = row.force != joint.force;
  switch (joint.row) {
    case Row::kHinge:
      dJointSetHingeParam(joint.id, dParamVel, velocity);
      if (softness) dJointSetHingeParam(joint.id, dParamCFM, row.cfm);
      if (bound) dJointSetHingeParam(joint.id, dParamFMax, row.force);
      break;
    case Row::kSlider:
      dJointSetSliderParam(joint.id, dParamVel, velocity);
      if (softness) dJointSetSliderParam(joint.id, dParamCFM, row.cfm);
      if (bound) dJointSetSliderParam(joint.id, dParamFMax, row.force);
      break;
    case Row::kUniversal1:
    case Row::kUniversal2: {
      const int group = joint.row == Row::kUniversal2 ? static_cast<int>(dParamGroup2) : 0;
      dJointSetUniversalParam(joint.id, group | static_cast<int>(dParamVel), velocity);
      if (softness) dJointSetUniversalParam(joint.id, group | static_cast<int>(dParamCFM), row.cfm);
      if (bound) dJointSetUniversalParam(joint.id, group | static_cast<int>(dParamFMax), row.force);
      break;
    }
  }
  joint.cfm = row.cfm;
  joint.force = row.force;
  joint.motor = row;
}

void OdeLinks::drive(const LinkState& state) {
  const SolverDef& solver = state.scene->def.solver;
  for (int32_t i = 0; i < num_links_; ++i) {
    Joint& joint = joints_[i];
    const JointDef& def = *joint.def;
    const double goal = joint.other >= 0 ? coupled_target(def, state.q[i], state.q[joint.other])
                                         : std::clamp(state.target[i], def.lower, def.upper);
    const double extra = state.feedforward ? state.feedforward[i] : 0;
    tell(joint, motor_row(def, solver, state.q[i], state.qd[i], goal, extra));
  }
}

double OdeLinks::rate(const Joint& joint, const Vec3& axis) const {
  if (joint.row == Row::kSlider) {
    Vec3 v = from_ode(dBodyGetLinearVel(joint.child));
    if (joint.parent) {
      const Vec3 arm = from_ode(dBodyGetPosition(joint.child)) - from_ode(dBodyGetPosition(joint.parent));
      v -= from_ode(dBodyGetLinearVel(joint.parent)) + cross(from_ode(joint.w_parent), arm);
    }
    return dot(axis, v);
  }
  return dot(axis, from_ode(joint.w_child) - from_ode(joint.w_parent));
}

bool OdeLinks::integrate(const LinkState& state, double weight) {
  const SolverDef& solver = state.scene->def.solver;
  for (int32_t i = 0; i < num_links_; ++i) {
    const Joint& joint = joints_[i];
    const JointDef& def = *joint.def;
    double qd = rate(joint, state.axes[i]);
    if (!(std::fabs(qd) < kRateBound)) return false;
    state.torque[i] += weight * motor_torque(joint.motor, qd);
    double q = state.q[i] + solver.h * qd;
    const double low = def.lower - solver.limit_margin, high = def.upper + solver.limit_margin;
    if (q < low) {
      q = low;
      qd = std::max(qd, 0.0);
    } else if (q > high) {
      q = high;
      qd = std::min(qd, 0.0);
    }
    state.q[i] = q;
    state.qd[i] = qd;
  }
  return true;
}

void OdeLinks::read_base(int32_t articulation, const LinkState& state) {
  const Link& base = bases_[articulation];
  if (!base.body) return;
  const Mat3 r = mat_from_ode(dBodyGetRotation(base.body));
  const Vec3 arm = r * base.com, w = from_ode(dBodyGetAngularVel(base.body));
  state.base_R[articulation] = r;
  state.bases[articulation] = {
      {from_ode(dBodyGetPosition(base.body)) - arm, quat_from_ode(dBodyGetQuaternion(base.body))},
      from_ode(dBodyGetLinearVel(base.body)) - cross(w, arm),
      w};
}

void OdeLinks::write_base(int32_t articulation, const LinkState& state) {
  const Link& base = bases_[articulation];
  if (!base.body) return;
  const Motion& m = state.bases[articulation];
  const Vec3 arm = state.base_R[articulation] * base.com;
  write_pose(base.body, m.X.p + arm, m.X.q, state.base_R[articulation]);
  write_velocity(base.body, m.v + cross(m.w, arm), m.w);
  read_base(articulation, state);
}

void OdeLinks::write(int32_t articulation, const LinkState& state) {
  const auto a = static_cast<size_t>(articulation);
  const int32_t first = state.scene->link_offset[a];
  const int32_t end = first + static_cast<int32_t>(state.scene->def.articulations[a].links.size());
  for (int32_t i = first; i < end; ++i) {
    const Link& link = links_[i];
    if (!link.owner) continue;
    const Motion& m = state.links[i];
    const Vec3 arm = state.link_R[i] * link.com;
    write_pose(link.body, m.X.p + arm, m.X.q, state.link_R[i]);
    write_velocity(link.body, m.v + cross(m.w, arm), m.w);
  }
}

double OdeLinks::drift(const Scene& scene) const {
  double worst = 0;
  for (int32_t i = 0; i < num_links_; ++i) {
    const Joint& joint = joints_[i];
    if (joint.row == Row::kSlider || scene.frames[static_cast<size_t>(i)].prismatic) continue;
    dVector3 a, b;
    if (joint.row == Row::kHinge) {
      dJointGetHingeAnchor(joint.id, a);
      dJointGetHingeAnchor2(joint.id, b);
    } else {
      dJointGetUniversalAnchor(joint.id, a);
      dJointGetUniversalAnchor2(joint.id, b);
    }
    worst = std::max(worst, norm(from_ode(a) - from_ode(b)));
  }
  return worst;
}

}  // namespace rdm
