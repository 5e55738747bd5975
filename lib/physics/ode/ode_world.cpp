#include "physics/ode/ode_world.hpp"

#include <ode/threading_impl.h>

#include <cmath>

#include "base/error.hpp"
#include "physics/model/flow.hpp"
#include "physics/ode_library/ode_convert.hpp"

namespace rdm {
namespace {

constexpr int32_t kMaxOdeIterations = 8;  // with more, ODE shuffles rows by a process-wide random seed
constexpr double kTurnTolerance = 1e-6;   // between a saved quaternion and its matrix

// What the solver's working memory is taken for: a purpose of its own, because it serves all worlds that
// share it. ODE gives the old block back before it asks for a larger one, and keeps pointing at it when that
// is refused: it stays until the larger one is there.
const char kWorkingMemory = 0, kOldWorkingMemory = 0;

void* take_working_memory(dsizeint bytes) {
  void* const block = ode_alloc(bytes, &kWorkingMemory);
  ode_blocks()->release(&kOldWorkingMemory);
  return block;
}
void* shrink_working_memory(void* block, dsizeint, dsizeint) {
  return block;
}
void free_working_memory(void* block, dsizeint) {
  ode_blocks()->give_purpose(block, &kOldWorkingMemory);
}

}  // namespace

OdeWorld::OdeWorld(const Scene& scene, Arena& arena, OdeWorld* partner) : World(scene, arena) {
  const auto links = static_cast<size_t>(scene.num_links), bodies = static_cast<size_t>(scene.num_bodies);
  tree_.carve(scene, arena);
  contact_.carve(scene, arena);
  body_ids_ = arena.make<dBodyID>(bodies);
  heads_ = arena.make<dBodyID>(scene.def.articulations.size() + bodies + 1);
  sensor_of_link_ = arena.make<int32_t>(links);
  num_forces_ = static_cast<int32_t>(links + scene.def.articulations.size() + bodies);
  forces_ = arena.make<Force>(static_cast<size_t>(num_forces_));
  if (scene.def.adjustable)
    fail(Code::kUnsupported, "adjustable: engine ode does not support scenes whose dynamics can be changed");
  if (scene.def.solver.iterations > kMaxOdeIterations)
    fail(Code::kRange, "iterations: engine ode takes at most %d, but %d were set", kMaxOdeIterations,
         scene.def.solver.iterations);
  if (arena.measuring()) return;
  blocks_ = partner ? partner->blocks_ : std::make_shared<OdeBlocks>();
  const OdeScope scope(blocks_.get());
  try {
    make_world(partner);
    make_bodies();
    make_geoms();
    make_forces();
    prewarm();
  } catch (...) {  // no destructor runs
    destroy();
    throw;
  }
}

OdeWorld::~OdeWorld() {
  if (!blocks_) return;  // measuring
  const OdeScope scope(blocks_.get());
  destroy();
}

void OdeWorld::destroy() {
  contact_.destroy();
  if (in_solver_) dWorldCleanupWorkingMemory(ode_);  // a partner takes its own
  if (ode_) dWorldDestroy(ode_);
  if (in_solver_)  // an error left the solver: its unfinished jobs are dropped before ODE looks at them
    blocks_->release(this);
  else if (threading_)
    dThreadingFreeImplementation(threading_);
}

void OdeWorld::make_world(const OdeWorld* partner) {
  const SolverDef& solver = scene_->def.solver;
  ode_ = dWorldCreate();
  make_threading();
  // no reserve: the prewarming step already takes the largest amount that is ever needed
  const dWorldStepReserveInfo reserve = {sizeof reserve, 1.0f, 4096};
  const dWorldStepMemoryFunctionsInfo memory = {sizeof memory, take_working_memory, shrink_working_memory,
                                                free_working_memory};
  if (!dWorldUseSharedWorkingMemory(ode_, partner ? partner->ode_ : nullptr) ||
      !dWorldSetStepMemoryReservationPolicy(ode_, &reserve) || !dWorldSetStepMemoryManager(ode_, &memory))
    fail(Code::kMemory, "ode: there is not enough memory for a world");
  const Vec3& g = scene_->def.gravity;
  dWorldSetGravity(ode_, g.x, g.y, g.z);
  dWorldSetERP(ode_, solver.erp);
  dWorldSetCFM(ode_, solver.cfm);
  dWorldSetQuickStepNumIterations(ode_, solver.iterations);
  dWorldSetQuickStepW(ode_, solver.relaxation);
  dWorldSetContactMaxCorrectingVel(
      ode_, solver.contact_max_speed > 0 ? solver.contact_max_speed : kOdeContactSpeed);
  dWorldSetContactSurfaceLayer(ode_, solver.contact_layer);
  dWorldSetAutoDisableFlag(ode_, 0);
  dWorldSetStepIslandsProcessingMaxThreadCount(ode_, 1);  // worlds are the unit of parallel work
}

void OdeWorld::make_bodies() {
  const auto num_articulations = static_cast<int32_t>(scene_->def.articulations.size());
  // ODE's joints are made in the pose of q = 0, whether it is in range or not.
  for (int32_t i = 0; i < scene_->num_links; ++i) {
    q_[i] = 0;
    fresh_[i] = 1;
  }
  for (int32_t a = 0; a < num_articulations; ++a) rebuild(a);
  tree_.make(ode_, state());
  for (int32_t i = 0; i < scene_->num_links; ++i) q_[i] = target_[i];
  for (int32_t a = 0; a < num_articulations; ++a) {
    links_changed(a);
  }
  for (int32_t i = 0; i < scene_->num_bodies; ++i) {
    const BodyDef& def = scene_->def.bodies[static_cast<size_t>(i)];
    const double* m = def.inertia.moment;
    dMass mass;
    dMassSetParameters(&mass, def.inertia.mass, 0, 0, 0, m[0], m[1], m[2], m[3], m[4], m[5]);
    body_ids_[i] = dBodyCreate(ode_);
    dBodySetMass(body_ids_[i], &mass);
    dBodySetGravityMode(body_ids_[i], def.gravity);
    dBodySetMaxAngularSpeed(body_ids_[i], kMaxBodyTurn / scene_->def.solver.h);
    set_body(i, {def.X_WB, {}, {}});
  }
}

void OdeWorld::make_geoms() {
  contact_.make(*scene_);
  for (int32_t i = 0; i < scene_->num_links; ++i) sensor_of_link_[i] = -1;
  for (size_t i = 0; i < scene_->sensors.size(); ++i)
    sensor_of_link_[scene_->sensors[i]] = static_cast<int32_t>(i);
  for (int32_t i = 0; i < static_cast<int32_t>(scene_->shapes.size()); ++i) {
    const SceneShape& s = scene_->shapes[static_cast<size_t>(i)];
    switch (s.carrier) {
      case Carrier::kStatic:
        contact_.make_geom(*scene_, i, nullptr, {});
        break;
      case Carrier::kLink:
        contact_.make_geom(*scene_, i, tree_.body(s.index), tree_.com(s.index));
        break;
      case Carrier::kBody:
        contact_.make_geom(*scene_, i, body_ids_[s.index], {});
        break;
      case Carrier::kBase:
        contact_.make_geom(*scene_, i, tree_.base(s.articulation), tree_.base_com(s.articulation));
        break;
    }
  }
}

void OdeWorld::set_force(Force* force, dBodyID body, double linear_damping, double angular_damping,
                         double mass, bool gravity, bool flies) {
  const double h = scene_->def.solver.h;
  force->body = body;
  const auto damp = [&](double damping, double* factor, double* push) {
    const Flow flow = damped_flow(h, damping);
    *factor = flies ? flow.keep : 1 / (1 + h * damping);
    *push = flies ? flow.gain : *factor;
  };
  damp(linear_damping, &force->linear, &force->linear_push);
  damp(angular_damping, &force->angular, &force->angular_push);
  force->way = damped_flow(h, linear_damping).fall;
  if (gravity) force->gravity = (mass * (force->linear_push - 1)) * scene_->def.gravity;
}

void OdeWorld::make_forces() {
  Force* force = forces_;
  for (int32_t i = 0; i < scene_->num_links; ++i, ++force) {
    const ArticulationDef& def =
        scene_->def.articulations[static_cast<size_t>(scene_->link_articulation[static_cast<size_t>(i)])];
    const double damping = def.free_base ? def.base_damping : 0;
    dMass mass;
    dBodyGetMass(tree_.body(i), &mass);
    set_force(force, tree_.body(i), damping, damping * tree_.own_share(i), mass.mass,
              def.gravity && !scene_->link(i).weightless, false);
    const int32_t next = i + 1;
    // Both links of a universal joint push the same body; only one of them may damp it.
    if (next < scene_->num_links && tree_.body(next) == tree_.body(i)) {
      force->linear = force->angular = force->linear_push = force->angular_push = 1;
      force->gravity = {};
    }
  }
  for (size_t a = 0; a < scene_->def.articulations.size(); ++a, ++force) {
    const ArticulationDef& def = scene_->def.articulations[a];
    set_force(force, tree_.base(static_cast<int32_t>(a)), def.base_damping, def.base_damping, def.base.mass,
              def.gravity, false);
  }
  for (int32_t i = 0; i < scene_->num_bodies; ++i, ++force) {
    const BodyDef& def = scene_->def.bodies[static_cast<size_t>(i)];
    set_force(force, body_ids_[i], def.linear_damping, def.angular_damping, def.inertia.mass, def.gravity,
              true);
  }
}

// A threading implementation of its own: ODE's default one is shared by all worlds and not thread-safe.
void OdeWorld::make_threading() {
  const OdeScope scope(blocks_.get(), this);
  threading_ = dThreadingAllocateSelfThreadedImplementation();
  if (!threading_) fail(Code::kMemory, "ode: there is not enough memory for a world");
  dWorldSetStepThreadingImplementation(ode_, dThreadingImplementationGetFunctions(threading_), threading_);
}

// One solver step with as many contacts as there can ever be, in one island: ODE's working memory has its
// final size before the first real step. The bodies have moved then.
void OdeWorld::grow_working_memory() {
  int32_t count = 0;
  for (size_t a = 0; a < scene_->link_offset.size(); ++a)
    if (!scene_->def.articulations[a].links.empty()) heads_[count++] = tree_.body(scene_->link_offset[a]);
  for (int32_t i = 0; i < scene_->num_bodies; ++i) heads_[count++] = body_ids_[i];
  if (count == 0) heads_[count++] = tree_.base(0);
  tree_.drive(state());
  contact_.fill(ode_, *scene_, heads_, count);
  solve();
  contact_.empty();
}

// And back to the start.
void OdeWorld::prewarm() {
  grow_working_memory();
  for (int32_t a = 0; a < static_cast<int32_t>(scene_->def.articulations.size()); ++a)
    put_base(a, {scene_->def.articulations[static_cast<size_t>(a)].X_WB, {}, {}});
  for (int32_t i = 0; i < scene_->num_bodies; ++i)
    set_body(i, {scene_->def.bodies[static_cast<size_t>(i)].X_WB, {}, {}});
}

void OdeWorld::links_changed(int32_t articulation) {
  const OdeScope scope;
  rebuild(articulation);
  tree_.write(articulation, state());
}

void OdeWorld::set_body(int32_t i, const Motion& m) {
  const Motion checked = checked_motion("set_body", i, m);
  const OdeScope scope;
  write_pose(body_ids_[i], checked.X.p, checked.X.q, to_matrix(checked.X.q));
  write_velocity(body_ids_[i], checked.v, checked.w);
  bodies_[i] = checked;
}

void OdeWorld::set_base(int32_t articulation, const Motion& m) {
  if (!tree_.base(articulation))
    fail(Code::kState, "set_base: the base of articulation %d is fixed", articulation);
  const OdeScope scope;
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
  const OdeScope scope;
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
    Force& f = forces_[i];
    if (!f.body) continue;
    f.p = from_ode(dBodyGetPosition(f.body));
    f.v = from_ode(dBodyGetLinearVel(f.body));
    f.touched = false;
    if (f.linear != 1 || f.angular != 1) {
      write_velocity(f.body, f.linear * from_ode(dBodyGetLinearVel(f.body)),
                     f.angular * from_ode(dBodyGetAngularVel(f.body)));
      dBodyAddForce(f.body, f.gravity.x, f.gravity.y, f.gravity.z);
    }
    if (!f.pushed) continue;
    const Vec3 force = f.linear_push * f.push.force, torque = f.angular_push * f.push.torque;
    dBodyAddForce(f.body, force.x, force.y, force.z);
    dBodyAddTorque(f.body, torque.x, torque.y, torque.z);
  }
}

void OdeWorld::solve() {
  const OdeScope scope(blocks_.get(), this);
  const SolverDef& solver = scene_->def.solver;
  in_solver_ = true;
  if (!(solver.exact ? dWorldStep(ode_, solver.h) : dWorldQuickStep(ode_, solver.h)))
    fail(Code::kMemory, "ode: there is not enough memory for a step");
  in_solver_ = false;
}

// Free bodies that touched nothing, from where ODE has put them to where they flew.
void OdeWorld::fly() {
  const double h = scene_->def.solver.h;
  Force* const flying = forces_ + (num_forces_ - scene_->num_bodies);
  for (int32_t k = 0; k < num_contacts_; ++k)
    for (const int32_t shape : {contacts_[k].shape_a, contacts_[k].shape_b}) {
      const SceneShape& of = scene_->shapes[static_cast<size_t>(shape)];
      if (of.carrier == Carrier::kBody) flying[of.index].touched = true;
    }
  for (int32_t i = 0; i < scene_->num_bodies; ++i) {
    const Force& f = flying[i];
    if (f.touched) continue;
    const Vec3 a = (1 / (h * f.linear_push)) * (from_ode(dBodyGetLinearVel(f.body)) - f.linear * f.v);
    const Vec3 p = f.p + h * (f.linear_push * f.v + (h * f.way) * a);
    dBodySetPosition(f.body, p.x, p.y, p.z);
  }
}

// Repairs ODE after an exception went through its solver. Its jobs point into a stack that no longer exists, and it
// has lost its working memory: both are dropped and made again.
void OdeWorld::restart_solver() {
  dWorldCleanupWorkingMemory(ode_);
  dWorldSetStepThreadingImplementation(ode_, nullptr, nullptr);
  for (const void* lost : {static_cast<const void*>(&kWorkingMemory),
                           static_cast<const void*>(&kOldWorkingMemory), static_cast<const void*>(this)})
    blocks_->release(lost);
  threading_ = nullptr;
  make_threading();
  grow_working_memory();
}

void OdeWorld::read_body(int32_t i) {
  const dBodyID body = body_ids_[i];
  bodies_[i] = {{from_ode(dBodyGetPosition(body)), quat_from_ode(dBodyGetQuaternion(body))},
                from_ode(dBodyGetLinearVel(body)),
                from_ode(dBodyGetAngularVel(body))};
}

bool OdeWorld::read_bodies() {
  constexpr double kAtBound = 1 - 1e-9;
  for (int32_t i = 0; i < scene_->num_bodies; ++i) {
    const dBodyID body = body_ids_[i];
    if (!bounded(from_ode(dBodyGetPosition(body))) || !bounded(from_ode(dBodyGetLinearVel(body))) ||
        !bounded(from_ode(dBodyGetAngularVel(body))))
      return false;
    read_body(i);
    // ODE cuts to it
    if (norm(bodies_[i].w) >= kAtBound * kMaxBodyTurn / scene_->def.solver.h) status_ |= kStatusSlowed;
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
  tree_.push_velocity_products(state());
  apply_forces();
  tree_.drive(state());
  const OdeContacts::Found found = contact_.collide(ode_, *scene_, contacts_, touched_);
  num_contacts_ = found.count;
  if (found.overflow) status_ |= kStatusContactOverflow;
  solve();
  fly();
  contact_.read_forces(num_contacts_, contacts_);
  add_sensors(weight);
  const auto articulations = static_cast<int32_t>(scene_->def.articulations.size());
  for (int32_t a = 0; a < articulations; ++a) tree_.note_momentum(a, state());
  if (!tree_.integrate(state(), weight) || !read_bodies()) return false;
  for (int32_t a = 0; a < articulations; ++a) {
    rebuild(a);
    tree_.write(a, state());
    if (!tree_.base(a)) continue;
    tree_.restore_momentum(a, state());
    tree_.write_base(a, state());
    rebuild(a);
    tree_.write(a, state());
  }
  return true;
}

// After a divergence: back to the last finite poses, at rest. The world stays usable and keeps its status bit.
void OdeWorld::recover() {
  status_ |= kStatusDiverged;
  num_contacts_ = 0;
  for (int32_t i = 0; i < scene_->num_links; ++i) qd_[i] = 0;
  for (size_t i = 0; i < scene_->sensors.size(); ++i) sensors_[i] = {};
  put_back();
  if (!in_solver_) return;
  try {
    restart_solver();
  } catch (const Error&) {  // without memory: the next step tries again
    in_solver_ = true;
  }
  put_back();
}

void OdeWorld::put_back() {
  contact_.empty();
  for (size_t a = 0; a < scene_->link_offset.size(); ++a)
    put_base(static_cast<int32_t>(a), {bases_[a].X, {}, {}});
  for (int32_t i = 0; i < scene_->num_bodies; ++i) set_body(i, {bodies_[i].X, {}, {}});
  for (int32_t i = 0; i < num_forces_; ++i) {
    if (!forces_[i].body) continue;
    dBodySetForce(forces_[i].body, 0, 0, 0);
    dBodySetTorque(forces_[i].body, 0, 0, 0);
  }
}

void OdeWorld::step() {
  const OdeScope scope(blocks_.get());
  status_ = 0;
  num_contacts_ = 0;
  for (int32_t i = 0; i < scene_->num_links; ++i) {
    torque_[i] = 0;
    if (std::isfinite(target_[i])) continue;
    target_[i] = q_[i];
    status_ |= kStatusDiverged;
  }
  for (int32_t i = 0; feedforward_ && i < scene_->num_links; ++i) {
    if (bounded(feedforward_[i], kFeedforwardBound)) continue;
    feedforward_[i] = 0;
    status_ |= kStatusDiverged;
  }
  for (size_t i = 0; i < scene_->sensors.size(); ++i) sensors_[i] = {};
  for (size_t i = 0; i < scene_->pairs.size(); ++i) touched_[i] = 0;
  const int32_t substeps = scene_->def.solver.substeps;
  bool good = !in_solver_;
  try {
    for (int32_t s = 0; s < substeps && good; ++s) good = substep(1.0 / substeps);
  } catch (const Error&) {
    good = false;
  }
  if (!good) recover();
  for (int32_t i = 0; i < num_forces_; ++i) {
    forces_[i].push = {};
    forces_[i].pushed = false;
  }
}

double OdeWorld::body_overlap(int32_t body) {
  const OdeScope scope;
  return contact_.overlap(*scene_, body);
}

double OdeWorld::joint_drift() const {
  const OdeScope scope;
  return tree_.drift(*scene_);
}

// dBodySetQuaternion normalises again and computes the matrix, which changes last bits. Quaternion and matrix are
// therefore restored as they were saved.
struct OdeWorld::BodyState {
  Vec3 p;
  Quat q;
  Mat3 R;
  Vec3 v, w;
};

void OdeWorld::save_body(Writer& out, dBodyID body) const {
  out.value(BodyState{from_ode(dBodyGetPosition(body)), quat_from_ode(dBodyGetQuaternion(body)),
                      mat_from_ode(dBodyGetRotation(body)), from_ode(dBodyGetLinearVel(body)),
                      from_ode(dBodyGetAngularVel(body))});
}

void OdeWorld::load_body(Reader& in, dBodyID body) {
  const auto state = in.value<BodyState>();
  write_pose(body, state.p, state.q, state.R);
  write_velocity(body, state.v, state.w);
}

void OdeWorld::save(Writer& out) const {
  const OdeScope scope;
  out.value(scene_->num_links);
  out.value(scene_->num_bodies);
  out.value(saved_status(status_));
  const auto bytes = static_cast<size_t>(scene_->num_links) * sizeof(double);
  for (const double* row : {q_, qd_, target_, torque_}) out.bytes(row, bytes);
  out.bytes(sensors_, scene_->sensors.size() * sizeof(Wrench));
  for (int32_t a = 0; a < static_cast<int32_t>(scene_->def.articulations.size()); ++a)
    if (tree_.base(a)) save_body(out, tree_.base(a));
  for (int32_t i = 0; i < scene_->num_bodies; ++i) save_body(out, body_ids_[i]);
  save_extras(out);
}

void OdeWorld::check(Reader& in) const {
  if (in.value<int32_t>() != scene_->num_links || in.value<int32_t>() != scene_->num_bodies)
    fail(Code::kFormat, "world state: it belongs to another scene");
  bool good = sound_rows(in, *scene_);
  int32_t count = scene_->num_bodies;
  for (int32_t a = 0; a < static_cast<int32_t>(scene_->def.articulations.size()); ++a)
    count += tree_.base(a) ? 1 : 0;
  for (int32_t i = 0; i < count; ++i) good &= sound_body(in.value<BodyState>());
  good &= sound_extras(in, *scene_);
  if (!good) fail(Code::kFormat, "world state: a number is not finite or out of range");
}

bool OdeWorld::sound_body(const BodyState& state) {
  const Mat3 R = to_matrix(state.q);
  for (size_t i = 0; i < 9; ++i)
    if (!bounded(R.m[i] - state.R.m[i], kTurnTolerance)) return false;
  return sound({{state.p, state.q}, state.v, state.w});
}

void OdeWorld::take(Reader& in) {
  const OdeScope scope;
  in.view(2 * sizeof(int32_t));
  status_ = in.value<uint32_t>();
  const auto bytes = static_cast<size_t>(scene_->num_links) * sizeof(double);
  for (double* row : {q_, qd_, target_, torque_}) in.bytes(row, bytes);
  in.bytes(sensors_, scene_->sensors.size() * sizeof(Wrench));
  for (int32_t a = 0; a < static_cast<int32_t>(scene_->def.articulations.size()); ++a) {
    if (tree_.base(a)) {
      load_body(in, tree_.base(a));
      tree_.read_base(a, state());
    }
    rebuild(a);
    tree_.write(a, state());
  }
  for (int32_t i = 0; i < scene_->num_bodies; ++i) {
    load_body(in, body_ids_[i]);
    read_body(i);
  }
  load_extras(in);
  num_contacts_ = 0;
  for (size_t i = 0; i < scene_->pairs.size(); ++i) touched_[i] = 0;
  for (int32_t i = 0; i < num_forces_; ++i) {
    forces_[i].push = {};
    forces_[i].pushed = false;
  }
}

void OdeWorld::copy(const World& world) {
  if (&world == this) return;
  const auto& other = static_cast<const OdeWorld&>(world);
  const OdeScope scope;
  copy_rows(other);
  const auto copy_body = [](dBodyID to, dBodyID from) {
    write_pose(to, from_ode(dBodyGetPosition(from)), quat_from_ode(dBodyGetQuaternion(from)),
               mat_from_ode(dBodyGetRotation(from)));
    write_velocity(to, from_ode(dBodyGetLinearVel(from)), from_ode(dBodyGetAngularVel(from)));
  };
  for (int32_t a = 0; a < static_cast<int32_t>(scene_->def.articulations.size()); ++a) {
    if (tree_.base(a)) {
      copy_body(tree_.base(a), other.tree_.base(a));
      tree_.read_base(a, state());
    }
    rebuild(a);
    tree_.write(a, state());
  }
  for (int32_t i = 0; i < scene_->num_bodies; ++i) {
    copy_body(body_ids_[i], other.body_ids_[i]);
    read_body(i);
  }
  for (int32_t i = 0; i < num_forces_; ++i) {
    forces_[i].push = {};
    forces_[i].pushed = false;
  }
}

size_t OdeWorld::heap_bytes(const Scene& scene) {
  const auto links = static_cast<size_t>(scene.num_links), bodies = static_cast<size_t>(scene.num_bodies);
  const auto contacts = static_cast<size_t>(scene.def.solver.contacts_max);
  // Measured with the packaged library and rounded up: ODE's objects and, for all contacts in one island,
  // the solver's rows.
  return 32000 + links * 2200 + bodies * 1200 + scene.shapes.size() * 300 + contacts * 1600;
}

}  // namespace rdm
