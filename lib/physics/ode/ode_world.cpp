#include "physics/ode/ode_world.hpp"

#include <ode/threading_impl.h>

#include <cmath>

#include "base/error.hpp"
#include "physics/ode/ode_convert.hpp"

namespace rdm {
namespace {

constexpr int32_t kMaxOdeIterations = 8;  // more would draw from a process-wide seed

}  // namespace

OdeWorld::Handle::~Handle() {
  const OdeScope scope;
  if (world) dWorldDestroy(world);
  if (threading) dThreadingFreeImplementation(threading);
}

OdeWorld::OdeWorld(const Scene& scene, Arena& arena, OdeWorld* partner) : World(scene, arena) {
  const auto links = static_cast<size_t>(scene.num_links), bodies = static_cast<size_t>(scene.num_bodies);
  tree_.carve(scene, arena);
  contact_.carve(scene, arena);
  body_ids_ = arena.make<dBodyID>(bodies);
  sensor_of_link_ = arena.make<int32_t>(links);
  num_forces_ = static_cast<int32_t>(links + scene.def.articulations.size() + bodies);
  forces_ = arena.make<Force>(static_cast<size_t>(num_forces_));
  if (scene.def.solver.iterations > kMaxOdeIterations)
    fail(Code::kRange, "iterations: engine ode takes at most %d, not %d", kMaxOdeIterations,
         scene.def.solver.iterations);
  if (arena.measuring()) return;
  const OdeScope scope;
  try {
    make_world(partner);
    make_bodies();
    make_geoms();
    make_forces();
    prewarm();
  } catch (const OdeFailure& failure) {
    fail(Code::kPhysics, "ode: %s", failure.text);
  }
}

OdeWorld::~OdeWorld() = default;

void OdeWorld::make_world(const OdeWorld* partner) {
  const SolverDef& solver = scene_->def.solver;
  ode_.world = dWorldCreate();
  ode_.threading = dThreadingAllocateSelfThreadedImplementation();
  if (!ode_.world || !ode_.threading) fail(Code::kMemory, "ode: no memory for a world");
  dWorldSetStepThreadingImplementation(ode_.world, dThreadingImplementationGetFunctions(ode_.threading),
                                       ode_.threading);
  // The prewarming step asks for the most that is ever needed: reserves on top of it would lie idle.
  const dWorldStepReserveInfo reserve = {sizeof reserve, 1.0f, 4096};
  if (!dWorldUseSharedWorkingMemory(ode_.world, partner ? partner->ode_.world : nullptr) ||
      !dWorldSetStepMemoryReservationPolicy(ode_.world, &reserve))
    fail(Code::kMemory, "ode: no memory for a world");
  const Vec3& g = scene_->def.gravity;
  dWorldSetGravity(ode_.world, g.x, g.y, g.z);
  dWorldSetERP(ode_.world, solver.erp);
  dWorldSetCFM(ode_.world, solver.cfm);
  dWorldSetQuickStepNumIterations(ode_.world, solver.iterations);
  dWorldSetQuickStepW(ode_.world, solver.relaxation);
  dWorldSetContactMaxCorrectingVel(
      ode_.world, solver.contact_max_speed > 0 ? solver.contact_max_speed : kOdeContactSpeed);
  dWorldSetContactSurfaceLayer(ode_.world, solver.contact_layer);
  dWorldSetAutoDisableFlag(ode_.world, 0);
  dWorldSetStepIslandsProcessingMaxThreadCount(ode_.world, 1);  // worlds are the unit of parallel work
}

void OdeWorld::make_bodies() {
  const auto num_articulations = static_cast<int32_t>(scene_->def.articulations.size());
  // ODE's joints are made in the pose of q = 0, whether it is in range or not.
  for (int32_t i = 0; i < scene_->num_links; ++i) {
    q_[i] = 0;
    fresh_[i] = 1;
  }
  for (int32_t a = 0; a < num_articulations; ++a) rebuild(a);
  tree_.make(ode_.world, state());
  for (int32_t i = 0; i < scene_->num_links; ++i) q_[i] = target_[i];
  for (int32_t a = 0; a < num_articulations; ++a) {
    links_changed(a);
  }
  for (int32_t i = 0; i < scene_->num_bodies; ++i) {
    const BodyDef& def = scene_->def.bodies[static_cast<size_t>(i)];
    const double* m = def.inertia.moment;
    dMass mass;
    dMassSetParameters(&mass, def.inertia.mass, 0, 0, 0, m[0], m[1], m[2], m[3], m[4], m[5]);
    body_ids_[i] = dBodyCreate(ode_.world);
    dBodySetMass(body_ids_[i], &mass);
    dBodySetGravityMode(body_ids_[i], def.gravity);
    dBodySetMaxAngularSpeed(body_ids_[i], kMaxBodySpin);
    set_body(i, {def.X_WB, {}, {}});
  }
}

void OdeWorld::make_geoms() {
  contact_.make_group();
  for (int32_t i = 0; i < scene_->num_links; ++i) sensor_of_link_[i] = -1;
  for (size_t i = 0; i < scene_->sensors.size(); ++i)
    sensor_of_link_[scene_->sensors[i]] = static_cast<int32_t>(i);
  for (int32_t i = 0; i < static_cast<int32_t>(scene_->shapes.size()); ++i) {
    const SceneShape& s = scene_->shapes[static_cast<size_t>(i)];
    switch (s.carrier) {
      case Carrier::kStatic:
        contact_.make_geom(*scene_, i, nullptr, {}, {});
        break;
      case Carrier::kLink:
        contact_.make_geom(*scene_, i, tree_.body(s.index), tree_.com(s.index), {});
        break;
      case Carrier::kBody:
        contact_.make_geom(*scene_, i, body_ids_[s.index], {}, {});
        break;
      case Carrier::kBase:
        contact_.make_geom(*scene_, i, tree_.base(s.articulation), tree_.base_com(s.articulation),
                           bases_[s.articulation].X);
        break;
    }
  }
}

void OdeWorld::set_force(Force* force, dBodyID body, double linear_damping, double angular_damping,
                         double mass, bool gravity) {
  const double h = scene_->def.solver.h;
  force->body = body;
  force->linear = 1 / (1 + h * linear_damping);
  force->angular = 1 / (1 + h * angular_damping);
  if (gravity) force->gravity = (mass * (force->linear - 1)) * scene_->def.gravity;
}

void OdeWorld::make_forces() {
  Force* force = forces_;
  for (int32_t i = 0; i < scene_->num_links; ++i, ++force) {
    const ArticulationDef& def =
        scene_->def.articulations[static_cast<size_t>(scene_->link_articulation[static_cast<size_t>(i)])];
    const double damping = def.free_base ? def.base_damping : 0;
    dMass mass;
    dBodyGetMass(tree_.body(i), &mass);
    set_force(force, tree_.body(i), damping, damping * tree_.own_share(i), mass.mass, def.gravity);
    const int32_t next = i + 1;
    // Both links of a universal joint push the same body; only one of them may damp it.
    if (next < scene_->num_links && tree_.body(next) == tree_.body(i)) {
      force->linear = force->angular = 1;
      force->gravity = {};
    }
  }
  for (size_t a = 0; a < scene_->def.articulations.size(); ++a, ++force) {
    const ArticulationDef& def = scene_->def.articulations[a];
    set_force(force, tree_.base(static_cast<int32_t>(a)), def.base_damping, def.base_damping, def.base.mass,
              def.gravity);
  }
  for (int32_t i = 0; i < scene_->num_bodies; ++i, ++force) {
    const BodyDef& def = scene_->def.bodies[static_cast<size_t>(i)];
    set_force(force, body_ids_[i], def.linear_damping, def.angular_damping, def.inertia.mass, def.gravity);
  }
}

// One solver step with as many contacts as there can ever be, in one island, then back to the start:
// ODE's working memory has its final size before the first real step.
void OdeWorld::prewarm() {
  Vector<dBodyID> heads;
  for (size_t a = 0; a < scene_->link_offset.size(); ++a)
    if (!scene_->def.articulations[a].links.empty()) heads.push_back(tree_.body(scene_->link_offset[a]));
  for (int32_t i = 0; i < scene_->num_bodies; ++i) heads.push_back(body_ids_[i]);
  if (heads.empty()) heads.push_back(tree_.base(0));
  tree_.drive(state());
  contact_.fill(ode_.world, *scene_, heads.data(), static_cast<int32_t>(heads.size()));
  solve();
  contact_.empty();
  for (int32_t a = 0; a < static_cast<int32_t>(scene_->def.articulations.size()); ++a)
    put_base(a, {scene_->def.articulations[static_cast<size_t>(a)].X_WB, {}, {}});
  for (int32_t i = 0; i < scene_->num_bodies; ++i)
    set_body(i, {scene_->def.bodies[static_cast<size_t>(i)].X_WB, {}, {}});
}

void OdeWorld::links_changed(int32_t articulation) {
  rebuild(articulation);
  tree_.write(articulation, state());
}

void OdeWorld::set_body(int32_t i, const Motion& m) {
  const Motion checked = checked_motion("set_body", i, m);
  write_pose(body_ids_[i], checked.X.p, checked.X.q, to_matrix(checked.X.q));
  write_velocity(body_ids_[i], checked.v, checked.w);
  bodies_[i] = checked;
}

void OdeWorld::set_base(int32_t articulation, const Motion& m) {
  if (!tree_.base(articulation))
    fail(Code::kState, "set_base: the base of articulation %d is fixed", articulation);
  put_base(articulation, checked_motion("set_base", articulation, m));
}

void OdeWorld::put_base(int32_t articulation, const Motion& m) {
  bases_[articulation] = m;
  base_R_[articulation] = to_matrix(m.X.q);
  tree_.write_base(articulation, state());
  rebuild(articulation);
  tree_.write(articulation, state());
}

void OdeWorld::add_push(Force& force, const Vec3& f, const Vec3& torque) {
  if (!finite(f) || !finite(torque)) fail(Code::kArgument, "push: the force is not finite");
  force.push.force += f;
  force.push.torque += torque;
  force.pushed = true;
}

void OdeWorld::push_link(int32_t i, const Vec3& force, const Vec3& p_W) {
  const Vec3 arm = p_W - from_ode(dBodyGetPosition(tree_.body(i)));
  add_push(forces_[i], force, cross(arm, force));
}

void OdeWorld::push_base(int32_t articulation, const Vec3& force, const Vec3& torque) {
  if (!tree_.base(articulation))
    fail(Code::kState, "push_base: the base of articulation %d is fixed", articulation);
  add_push(forces_[scene_->num_links + articulation], force, torque);
}

void OdeWorld::push_body(int32_t i, const Vec3& force, const Vec3& torque) {
  add_push(forces_[num_forces_ - scene_->num_bodies + i], force, torque);
}

void OdeWorld::apply_forces() {
  for (int32_t i = 0; i < num_forces_; ++i) {
    const Force& f = forces_[i];
    if (!f.body) continue;
    if (f.linear != 1 || f.angular != 1) {
      write_velocity(f.body, f.linear * from_ode(dBodyGetLinearVel(f.body)),
                     f.angular * from_ode(dBodyGetAngularVel(f.body)));
      dBodyAddForce(f.body, f.gravity.x, f.gravity.y, f.gravity.z);
    }
    if (!f.pushed) continue;
    const Vec3 force = f.linear * f.push.force, torque = f.angular * f.push.torque;
    dBodyAddForce(f.body, force.x, force.y, force.z);
    dBodyAddTorque(f.body, torque.x, torque.y, torque.z);
  }
}

void OdeWorld::solve() {
  const SolverDef& solver = scene_->def.solver;
  if (solver.exact)
    dWorldStep(ode_.world, solver.h);
  else
    dWorldQuickStep(ode_.world, solver.h);
}

void OdeWorld::read_body(int32_t i) {
  const dBodyID body = body_ids_[i];
  bodies_[i] = {{from_ode(dBodyGetPosition(body)), quat_from_ode(dBodyGetQuaternion(body))},
                from_ode(dBodyGetLinearVel(body)),
                from_ode(dBodyGetAngularVel(body))};
}

bool OdeWorld::read_bodies() {
  for (int32_t i = 0; i < scene_->num_bodies; ++i) {
    const dBodyID body = body_ids_[i];
    if (!bounded(from_ode(dBodyGetPosition(body))) || !bounded(from_ode(dBodyGetLinearVel(body))) ||
        !bounded(from_ode(dBodyGetAngularVel(body))))
      return false;
    read_body(i);
  }
  for (int32_t a = 0; a < static_cast<int32_t>(scene_->def.articulations.size()); ++a) {
    const dBodyID body = tree_.base(a);
    if (!body) continue;
    if (!bounded(from_ode(dBodyGetPosition(body))) || !bounded(from_ode(dBodyGetLinearVel(body))) ||
        !bounded(from_ode(dBodyGetAngularVel(body))))
      return false;
    tree_.read_base(a, state());
  }
  return true;
}

void OdeWorld::add_sensors(double weight) {
  for (int32_t k = 0; k < num_contacts_; ++k) {
    const Contact& contact = contacts_[k];
    for (int side = 0; side < 2; ++side) {
      const SceneShape& shape = scene_->shapes[static_cast<size_t>(side ? contact.shape_b : contact.shape_a)];
      const int32_t sensor = shape.carrier == Carrier::kLink ? sensor_of_link_[shape.index] : -1;
      if (sensor < 0) continue;
      const Vec3 force = (side ? -weight : weight) * contact.force;
      const Vec3 torque = cross(contact.p - links_[shape.index].X.p, force);
      const Mat3 R_LW = transpose(link_R_[shape.index]);
      sensors_[sensor].force += R_LW * force;
      sensors_[sensor].torque += R_LW * torque;
    }
  }
}

bool OdeWorld::substep(double weight) {
  apply_forces();
  tree_.drive(state());
  const OdeContacts::Found found = contact_.collide(ode_.world, *scene_, contacts_, touched_);
  num_contacts_ = found.count;
  if (found.overflow) status_ |= kStatusContactOverflow;
  solve();
  contact_.read_forces(num_contacts_, contacts_);
  add_sensors(weight);
  if (!tree_.integrate(state(), weight) || !read_bodies()) return false;
  for (int32_t a = 0; a < static_cast<int32_t>(scene_->def.articulations.size()); ++a) {
    rebuild(a);
    tree_.write(a, state());
  }
  return true;
}

// Back to the last poses that were good, at rest: the world stays usable and is still marked.
void OdeWorld::recover() {
  status_ |= kStatusDiverged;
  num_contacts_ = 0;
  contact_.empty();
  for (int32_t i = 0; i < scene_->num_links; ++i) qd_[i] = 0;
  for (size_t a = 0; a < scene_->link_offset.size(); ++a) {
    put_base(static_cast<int32_t>(a), {bases_[a].X, {}, {}});
  }
  for (int32_t i = 0; i < scene_->num_bodies; ++i) set_body(i, {bodies_[i].X, {}, {}});
  for (int32_t i = 0; i < num_forces_; ++i) {
    if (!forces_[i].body) continue;
    dBodySetForce(forces_[i].body, 0, 0, 0);
    dBodySetTorque(forces_[i].body, 0, 0, 0);
  }
  for (size_t i = 0; i < scene_->sensors.size(); ++i) sensors_[i] = {};
}

void OdeWorld::step() {
  const OdeScope scope;
  status_ = 0;
  num_contacts_ = 0;
  for (int32_t i = 0; i < scene_->num_links; ++i) {
    torque_[i] = 0;
    if (std::isfinite(target_[i])) continue;
    target_[i] = q_[i];
    status_ |= kStatusDiverged;
  }
  for (size_t i = 0; i < scene_->sensors.size(); ++i) sensors_[i] = {};
  for (size_t i = 0; i < scene_->pairs.size(); ++i) touched_[i] = 0;
  const int32_t substeps = scene_->def.solver.substeps;
  bool good = true;
  try {
    for (int32_t s = 0; s < substeps && good; ++s) good = substep(1.0 / substeps);
  } catch (const OdeFailure&) {
    good = false;
  }
  if (!good) recover();
  for (int32_t i = 0; i < num_forces_; ++i) {
    forces_[i].push = {};
    forces_[i].pushed = false;
  }
}

double OdeWorld::body_overlap(int32_t body) {
  return contact_.overlap(*scene_, body);
}

double OdeWorld::joint_drift() const {
  return tree_.drift(*scene_);
}

}  // namespace rdm
