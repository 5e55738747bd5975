#include "physics/world.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "base/text.hpp"
#include "physics/articulated/articulated_world.hpp"
#include "physics/kinematic_world.hpp"
#include "physics/model/soft_limits.hpp"
#include "physics/ode/ode_world.hpp"

namespace rdm {

namespace {

void check_kind(EngineKind kind) {
  if (kind != EngineKind::kOde && kind != EngineKind::kArticulated && kind != EngineKind::kKinematic)
    fail(Code::kUnsupported, "engine %d does not exist", static_cast<int>(kind));
}

// ODE knows a bounce, and no more of contact laws.
void check_laws(EngineKind kind, const Scene& scene) {
  if (kind != EngineKind::kOde) return;
  for (const ContactLaw& law : scene.laws)
    if (law.soft() || law.torsional > 0 || law.rolling > 0)
      fail(Code::kUnsupported,
           "engine ode supports only the restitution of a contact law; use engine articulated for "
           "time_constant, torsional and rolling friction");
}

}  // namespace

World* World::create(EngineKind kind, const Scene& scene, Arena& arena, const HostHooks& hooks,
                     World* partner, int32_t together) {
  const HostScope scope(hooks);
  check_laws(kind, scene);
  if (kind == EngineKind::kOde)
    return host_new<OdeWorld>(hooks, scene, arena, static_cast<OdeWorld*>(partner));
  check_kind(kind);
  if (kind == EngineKind::kKinematic) return host_new<KinematicWorld>(hooks, scene, arena);
  return host_new<ArticulatedWorld>(hooks, scene, arena, static_cast<ArticulatedWorld*>(partner),
                                    partner != nullptr, together);
}

void World::measure(EngineKind kind, const Scene& scene, Arena& arena, bool partnered, int32_t together) {
  check_kind(kind);
  check_laws(kind, scene);
  if (!arena.measuring()) fail(Code::kInternal, "measure: the arena is a real one");
  if (kind == EngineKind::kOde)
    const OdeWorld world(scene, arena);
  else if (kind == EngineKind::kKinematic)
    const KinematicWorld world(scene, arena);
  else
    const ArticulatedWorld world(scene, arena, nullptr, partnered, together);
}

size_t World::object_bytes(EngineKind kind) {
  check_kind(kind);
  if (kind == EngineKind::kOde) return sizeof(OdeWorld);
  return kind == EngineKind::kKinematic ? sizeof(KinematicWorld) : sizeof(ArticulatedWorld);
}

size_t World::engine_bytes(EngineKind kind, const Scene& scene, bool partnered) {
  check_kind(kind);
  if (kind == EngineKind::kOde) return OdeWorld::heap_bytes(scene);
  return partnered || kind == EngineKind::kKinematic ? 0 : ArticulatedWorld::heap_bytes(scene);
}

void World::destroy(World* world, const HostHooks& hooks) {
  if (!world) return;
  if (world->engine() == EngineKind::kOde)
    host_delete(hooks, static_cast<OdeWorld*>(world));
  else if (world->engine() == EngineKind::kKinematic)
    host_delete(hooks, static_cast<KinematicWorld*>(world));
  else
    host_delete(hooks, static_cast<ArticulatedWorld*>(world));
}

World::World(const Scene& scene, Arena& arena) : scene_(&scene) {
  carve(arena);
}

void World::carve(Arena& arena) {
  const auto links = static_cast<size_t>(scene_->num_links), bases = scene_->def.articulations.size();
  q_ = arena.make<double>(links);
  qd_ = arena.make<double>(links);
  target_ = arena.make<double>(links);
  torque_ = arena.make<double>(links);
  links_ = arena.make<Motion>(links);
  link_R_ = arena.make<Mat3>(links);
  axes_ = arena.make<Vec3>(links);
  bases_ = arena.make<Motion>(bases);
  base_R_ = arena.make<Mat3>(bases);
  bodies_ = arena.make<Motion>(static_cast<size_t>(scene_->num_bodies));
  contacts_ = arena.make<Contact>(static_cast<size_t>(scene_->def.solver.contacts_max));
  sensors_ = arena.make<Wrench>(scene_->sensors.size());
  touched_ = arena.make<uint8_t>(scene_->pairs.size());
  fresh_ = arena.make<uint8_t>(links);
  if (scene_->def.feedforward) feedforward_ = arena.make<double>(links);
  if (scene_->def.adjustable) {
    dynamics_.carve(*scene_, arena);
    edited_.carve(*scene_, arena);
    sized_ = arena.make<SizedShape>(static_cast<size_t>(scene_->num_body_shapes));
    size_t hulls = 0;
    for (const SceneShape& s : scene_->shapes) hulls += s.carrier == Carrier::kBody && s.hull >= 0;
    hulls_ = arena.make<Hull>(hulls);
  }
  if (arena.measuring()) return;
  size_shapes();
  for (size_t a = 0; a < bases; ++a) {
    const ArticulationDef& def = scene_->def.articulations[a];
    bases_[a] = {def.X_WB, {}, {}};
    base_R_[a] = to_matrix(def.X_WB.q);
  }
  for (size_t i = 0; i < links; ++i) {
    const JointDef& joint = scene_->link(static_cast<int32_t>(i)).joint;
    q_[i] = target_[i] = std::clamp(0.0, joint.lower, joint.upper);
  }
  for (size_t i = 0; i < scene_->def.bodies.size(); ++i) bodies_[i] = {scene_->def.bodies[i].X_WB, {}, {}};
}

void World::size_shapes() {
  if (!sized_) return;
  Hull* hull = hulls_;
  for (int32_t i = 0; i < scene_->num_body_shapes; ++i) {
    const SceneShape& s = scene_->shapes[static_cast<size_t>(scene_->first_body_shape + i)];
    const double factor = dynamics_.bodies[s.index].size;
    sized_[i] = {factor * s.def.size, factor * s.def.X_LS.p, factor, nullptr};
    if (s.hull < 0) continue;
    scale_hull(*scene_->hull_of(s), factor, hull);
    sized_[i].hull = hull++;
  }
}

Dynamics& World::edit_dynamics() {
  if (!scene_->def.adjustable) fail(Code::kState, "dynamics: the scene is not adjustable");
  edited_.copy(dynamics_);
  return edited_;
}

void World::set_dynamics(const Dynamics& dynamics) {
  if (!scene_->def.adjustable) fail(Code::kState, "dynamics: the scene is not adjustable");
  dynamics.check(*scene_);
  dynamics_.copy(dynamics);
  size_shapes();
  dynamics_changed();
}

void World::save_extras(Writer& out) const {
  if (feedforward_) out.bytes(feedforward_, sizeof(double) * static_cast<size_t>(scene_->num_links));
  if (scene_->def.adjustable) dynamics_.save(out);
}

void World::load_extras(Reader& in) {
  if (feedforward_) in.bytes(feedforward_, sizeof(double) * static_cast<size_t>(scene_->num_links));
  if (!scene_->def.adjustable) return;
  dynamics_.load(in);
  size_shapes();
}

bool World::sound_extras(Reader& in, const Scene& scene) {
  bool good = true;
  if (scene.def.feedforward)
    for (int32_t i = 0; i < scene.num_links; ++i) good &= bounded(in.value<double>(), kFeedforwardBound);
  if (scene.def.adjustable) good &= Dynamics::sound(in, scene);
  return good;
}

bool World::copy_rows(const World& other) {
  const auto links = static_cast<size_t>(scene_->num_links);
  status_ = saved_status(other.status_);
  std::copy_n(other.q_, links, q_);
  std::copy_n(other.qd_, links, qd_);
  std::copy_n(other.target_, links, target_);
  std::copy_n(other.torque_, links, torque_);
  std::copy_n(other.sensors_, scene_->sensors.size(), sensors_);
  std::copy_n(other.bases_, scene_->def.articulations.size(), bases_);
  std::copy_n(other.base_R_, scene_->def.articulations.size(), base_R_);
  std::copy_n(other.bodies_, scene_->num_bodies, bodies_);
  if (feedforward_) std::copy_n(other.feedforward_, links, feedforward_);
  std::fill_n(touched_, scene_->pairs.size(), uint8_t{0});
  num_contacts_ = 0;
  if (!scene_->def.adjustable || dynamics_.same(other.dynamics_)) return false;
  dynamics_.copy(other.dynamics_);
  size_shapes();
  return true;
}

void World::step_together(World* const* worlds, int32_t count) {
  if (count > 0) worlds[0]->step_group(worlds, count);
}

void World::step_group(World* const* worlds, int32_t count) {
  for (int32_t i = 0; i < count; ++i) worlds[i]->step();
}

void World::set_joints(int32_t articulation, const double* q, const double* qd) {
  const auto a = static_cast<size_t>(articulation);
  const int32_t first = scene_->link_offset[a];
  const auto count = static_cast<int32_t>(scene_->def.articulations[a].links.size());
  for (int32_t i = 0; i < count; ++i)
    if (!std::isfinite(q[i]) || !bounded(qd[i], kRateBound))
      fail(Code::kArgument, "set_joints: joint %d is not finite, or faster than %g", i, kRateBound);
  for (int32_t i = 0; i < count; ++i) {
    const JointDef& joint = scene_->link(first + i).joint;
    q_[first + i] = std::clamp(q[i], joint.lower, joint.upper);
    qd_[first + i] = qd[i];
  }
  links_changed(articulation);
}

void World::place_joints(const double* q, const double* qd) {
  const auto name = [&](int32_t i) { return scene_->link(i).joint.name.text; };
  const auto led = [&](int32_t i, const double* x) {
    return std::isnan(x[i]) && scene_->link(i).joint.coupled_to >= 0;
  };
  for (int32_t i = 0; q && i < scene_->num_links; ++i) {
    const JointDef& joint = scene_->link(i).joint;
    if (led(i, q)) continue;
    if (!std::isfinite(q[i])) fail(Code::kArgument, "q: joint %s is not finite", name(i));
    if (!sound_joint(joint, scene_->def.solver, q[i]))
      fail(Code::kRange, "q: %s of joint %s is outside [%s, %s]", Number(q[i]).text, name(i),
           Number(joint.lower).text, Number(joint.upper).text);
  }
  for (int32_t i = 0; qd && i < scene_->num_links; ++i) {
    if (led(i, qd)) continue;
    if (!std::isfinite(qd[i])) fail(Code::kArgument, "qd: joint %s is not finite", name(i));
    if (!bounded(qd[i], kRateBound))
      fail(Code::kRange, "qd: %g of joint %s is outside (%g, %g)", qd[i], name(i), -kRateBound, kRateBound);
  }
  for (size_t a = 0; a < scene_->def.articulations.size(); ++a) {
    const int32_t first = scene_->link_offset[a];
    const auto count = static_cast<int32_t>(scene_->def.articulations[a].links.size());
    for (int32_t i = first; i < first + count; ++i) {
      const JointDef& joint = scene_->link(i).joint;
      const int32_t other = first + joint.coupled_to;
      if (qd) qd_[i] = led(i, qd) ? joint.ratio * qd[other] : qd[i];
      if (!q) continue;
      q_[i] = led(i, q) ? std::clamp(joint.ratio * q[other], joint.lower, joint.upper) : q[i];
      target_[i] = std::clamp(q_[i], joint.lower, joint.upper);
    }
    if (q || qd) links_changed(static_cast<int32_t>(a));
  }
}

Motion World::checked_motion(const char* call, int32_t index, const Motion& m) {
  if (!bounded(m.X.p) || !bounded(m.v) || !bounded(m.w))
    fail(Code::kArgument, "%s: motion %d is not finite, or its magnitude is above %g", call, index,
         kStateBound);
  const Quat q = normalized(m.X.q);
  if (!is_unit(q))
    fail(Code::kArgument, "%s: the quaternion of motion %d does not have length 1", call, index);
  return {{m.X.p, q}, m.v, m.w};
}

bool World::sound(const Motion& m) {
  return bounded(m.X.p) && bounded(m.v) && bounded(m.w) && is_unit(m.X.q);
}

bool World::sound_joint(const JointDef& joint, const SolverDef& solver, double q) {
  // an engine may keep angles as floats
  const double room = stop_margin(solver) + 1e-6 * (1 + std::fabs(joint.lower) + std::fabs(joint.upper));
  return q >= joint.lower - room && q <= joint.upper + room;
}

bool World::sound_rows(Reader& in, const Scene& scene) {
  bool good = (in.value<uint32_t>() & ~(kStatusContactOverflow | kStatusDiverged)) == 0;
  for (int32_t i = 0; i < scene.num_links; ++i)
    good &= sound_joint(scene.link(i).joint, scene.def.solver, in.value<double>());
  for (int32_t i = 0; i < scene.num_links; ++i) good &= bounded(in.value<double>(), kRateBound);
  for (int32_t i = 0; i < scene.num_links; ++i) good &= bounded(in.value<double>(), kStateBound);  // target
  for (int32_t i = 0; i < scene.num_links; ++i) good &= bounded(in.value<double>(), FLT_MAX);      // torque
  for (size_t i = 0; i < scene.sensors.size(); ++i) {
    const auto sensor = in.value<Wrench>();
    good &= fits_float(sensor.force) && fits_float(sensor.torque);
  }
  return good;
}

void World::rebuild(int32_t articulation) {
  const auto a = static_cast<size_t>(articulation);
  const int32_t first = scene_->link_offset[a];
  const int32_t end = first + static_cast<int32_t>(scene_->def.articulations[a].links.size());
  const LinkFrame* frames = scene_->frames.data();
  for (int32_t i = first; i < end; ++i) {
    const LinkFrame& frame = frames[i];
    const Motion& parent = frame.parent < 0 ? bases_[a] : links_[frame.parent];
    const Mat3& R_WP = frame.parent < 0 ? base_R_[a] : link_R_[frame.parent];
    Motion& link = links_[i];
    Vec3 r = R_WP * frame.p_PL;
    Quat q_WL = frame.turned ? parent.X.q * frame.q_PL : parent.X.q;
    if (frame.prismatic) {
      link_R_[i] = to_matrix(q_WL);
      axes_[i] = link_R_[i] * frame.axis;
      r += q_[i] * axes_[i];
      link.w = parent.w;
      link.v = parent.v + cross(parent.w, r) + qd_[i] * axes_[i];
    } else {
      q_WL = q_WL * axis_angle(frame.axis, q_[i]);
      link_R_[i] = to_matrix(q_WL);
      axes_[i] = link_R_[i] * frame.axis;
      link.w = parent.w + qd_[i] * axes_[i];
      link.v = parent.v + cross(parent.w, r);
    }
    link.X = {parent.X.p + r, q_WL};
  }
}

Pose World::shape_pose(int32_t shape) const {
  const SceneShape& s = scene_->shapes[static_cast<size_t>(shape)];
  switch (s.carrier) {
    case Carrier::kLink:
      return peek_link(s.index).X * s.def.X_LS;
    case Carrier::kBody:
      if (const SizedShape* own = sized(shape)) return bodies_[s.index].X * Pose{own->p, s.def.X_LS.q};
      return bodies_[s.index].X * s.def.X_LS;
    case Carrier::kBase:
      return bases_[s.articulation].X * s.def.X_LS;
    case Carrier::kStatic:
      break;
  }
  return s.def.X_LS;
}

Vec3 World::shape_size(int32_t shape) const {
  const SizedShape* own = sized(shape);
  return own ? own->size : scene_->shapes[static_cast<size_t>(shape)].def.size;
}

const Hull* World::shape_hull(int32_t shape) const {
  const SizedShape* own = sized(shape);
  return own ? own->hull : scene_->hull_of(scene_->shapes[static_cast<size_t>(shape)]);
}

}  // namespace rdm
