#include "physics/articulated/articulated_world.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/error.hpp"
#include "physics/model/inertia.hpp"

namespace rdm {
namespace {

constexpr double kStateBound = 1e6;     // m, m/s, rad/s; a body beyond it has diverged
constexpr double kMaxBodySpin = 100.0;  // rad/s, of free bodies
constexpr float kWarmReach = 0.02f;     // m between two substeps' points that count as one

bool bounded(const Vec3& v) {
  return std::fabs(v.x) < kStateBound && std::fabs(v.y) < kStateBound && std::fabs(v.z) < kStateBound;
}

// C with C C^T = a, lower triangle, inverted.
Mat3 inverse_cholesky(const Mat3& a) {
  Mat3 c;
  c(0, 0) = std::sqrt(a(0, 0));
  c(1, 0) = a(1, 0) / c(0, 0);
  c(2, 0) = a(2, 0) / c(0, 0);
  c(1, 1) = std::sqrt(a(1, 1) - c(1, 0) * c(1, 0));
  c(2, 1) = (a(2, 1) - c(2, 0) * c(1, 0)) / c(1, 1);
  c(2, 2) = std::sqrt(a(2, 2) - c(2, 0) * c(2, 0) - c(2, 1) * c(2, 1));
  Mat3 b;
  for (int i = 0; i < 3; ++i) b(i, i) = 1 / c(i, i);
  b(1, 0) = -c(1, 0) * b(0, 0) * b(1, 1);
  b(2, 1) = -c(2, 1) * b(1, 1) * b(2, 2);
  b(2, 0) = -(c(2, 0) * b(0, 0) + c(2, 1) * b(1, 0)) * b(2, 2);
  return b;
}

BodyModel make_body_model(const BodyDef& def, const Scene& scene) {
  const double h = scene.def.solver.h;
  BodyModel m;
  m.inverse_mass = 1 / def.inertia.mass;
  m.root_inverse_mass = std::sqrt(m.inverse_mass);
  m.moment = moment_matrix(def.inertia);
  m.inverse_root = inverse_cholesky(m.moment);
  m.inverse = transpose(m.inverse_root) * m.inverse_root;
  m.linear = 1 / (1 + h * def.linear_damping);
  m.angular = 1 / (1 + h * def.angular_damping);
  if (def.gravity) m.gravity = scene.def.gravity;
  return m;
}

// Poses outside of a step, from the world's own answers.
class StillPoses final : public Collider::Poses {
 public:
  explicit StillPoses(const World& world) : world_(world) {}
  void place(int32_t shape, Vec3* p, Mat3* R) override {
    const Pose X_WS = world_.shape_pose(shape);
    *p = X_WS.p;
    *R = to_matrix(X_WS.q);
  }

 private:
  const World& world_;
};

void set_bound(const SceneShape& shape, const Vec3& p, const Mat3& R, Bound* bound) {
  const Vec3 axis = R * capsule_around(shape).axis;
  for (int k = 0; k < 3; ++k) {
    bound->center[k] = static_cast<float>(p[k]);
    bound->axis[k] = static_cast<float>(axis[k]);
  }
}

}  // namespace

ArticulatedWorld::ArticulatedWorld(const Scene& scene, Arena& arena, ArticulatedWorld* partner,
                                   bool partnered)
    : World(scene, arena) {
  const auto links = static_cast<size_t>(scene.num_links), bodies = static_cast<size_t>(scene.num_bodies),
             bases = scene.def.articulations.size(),
             contacts = static_cast<size_t>(scene.def.solver.contacts_max);
  keep_ = arena.make<unsigned char>(keep_bytes(scene, scene.def.solver.double_precision));
  moving_ = arena.make<Body>(bodies);
  pushes_ = arena.make<Wrench>(links + bases + bodies);
  contact_pairs_ = arena.make<int32_t>(contacts);
  impulses_ = arena.make<Vec3>(contacts);
  warm_ = arena.make<WarmPoint>(contacts);
  next_ = arena.make<WarmPoint>(contacts);
  sensor_of_link_ = arena.make<int32_t>(links);
  good_bodies_ = arena.make<Motion>(bodies);
  good_bases_ = arena.make<Motion>(bases);
  try {
    make_shared(arena, partner, partnered);
  } catch (...) {  // no destructor runs
    release_shared();
    throw;
  }
  if (arena.measuring()) return;
  for (size_t i = 0; i < links; ++i) sensor_of_link_[i] = -1;
  for (size_t i = 0; i < scene.sensors.size(); ++i)
    sensor_of_link_[scene.sensors[i]] = static_cast<int32_t>(i);
  for (int32_t i = 0; i < scene.num_bodies; ++i) set_body(i, bodies_[i]);
  for (int32_t a = 0; a < static_cast<int32_t>(bases); ++a) links_changed(a);
}

void ArticulatedWorld::make_shared(Arena& arena, ArticulatedWorld* partner, bool partnered) {
  if (partnered) {
    if (!partner) return;  // measuring
    shared_ = partner->shared_;
    ++shared_->users;
    return;
  }
  const HostHooks hooks = host();
  auto* shared = host_new<ArticulatedShared>(hooks);
  shared_ = shared;
  shared->users = 1;
  shared->hooks = hooks;
  shared->trees = make_trees(*scene_);
  for (const BodyDef& body : scene_->def.bodies) shared->bodies.push_back(make_body_model(body, *scene_));
  shared->collider.carve(*scene_, arena);
  const SolverDef& solver = scene_->def.solver;
  const auto make = [&](int32_t lanes) {
    return make_stepper({solver.double_precision, lanes}, *scene_, *shared, arena);
  };
  if (solver.double_precision || solver.lanes > 0) {
    shared->alone = shared->group = make(std::max(solver.lanes, 1));
  } else {
    const bool single = std::all_of(shared->trees.begin(), shared->trees.end(),
                                    [](const Tree& tree) { return tree.members.size() == 1; });
    shared->alone = make(single ? 1 : 4);
    shared->group = make(8);
  }
  if (!arena.measuring()) shared->collider.make(*scene_);
}

ArticulatedWorld::~ArticulatedWorld() {
  release_shared();
}

void ArticulatedWorld::release_shared() {
  if (!shared_ || --shared_->users > 0) return;
  const HostHooks hooks = shared_->hooks;
  if (shared_->group && shared_->group != shared_->alone) shared_->group->end(hooks);
  if (shared_->alone) shared_->alone->end(hooks);
  host_delete(hooks, shared_);
}

void ArticulatedWorld::links_changed(int32_t articulation) {
  const auto a = static_cast<size_t>(articulation);
  const int32_t first = scene_->link_offset[a];
  const auto count = static_cast<int32_t>(scene_->def.articulations[a].links.size());
  for (int32_t i = first; i < first + count; ++i) {
    if (!scene_->def.solver.double_precision) {  // what the lanes will make of them
      q_[i] = static_cast<double>(static_cast<float>(q_[i]));
      qd_[i] = static_cast<double>(static_cast<float>(qd_[i]));
    }
    fresh_[i] = 0;
  }
  shared_->alone->refresh(*this, articulation);
}

void ArticulatedWorld::fetch_link(int32_t i) const {
  shared_->alone->read_link(*this, i, &links_[i], &link_R_[i]);
  fresh_[i] = 1;
}

void ArticulatedWorld::set_body(int32_t i, const Motion& m) {
  if (!finite(m.X.p) || !finite(m.v) || !finite(m.w))
    fail(Code::kArgument, "set_body: body %d is not finite", i);
  const Quat q = normalized(m.X.q);
  if (!std::isfinite(q.w)) fail(Code::kArgument, "set_body: body %d has no unit quaternion", i);
  bodies_[i] = {{m.X.p, q}, m.v, m.w};
  moving_[i].R = to_matrix(q);
}

void ArticulatedWorld::set_base(int32_t articulation, const Motion& m) {
  if (!scene_->def.articulations[static_cast<size_t>(articulation)].free_base)
    fail(Code::kState, "set_base: the base of articulation %d is fixed", articulation);
  if (!finite(m.X.p) || !finite(m.v) || !finite(m.w))
    fail(Code::kArgument, "set_base: articulation %d is not finite", articulation);
  const Quat q = normalized(m.X.q);
  if (!std::isfinite(q.w))
    fail(Code::kArgument, "set_base: articulation %d has no unit quaternion", articulation);
  bases_[articulation] = {{m.X.p, q}, m.v, m.w};
  base_R_[articulation] = to_matrix(q);
  links_changed(articulation);
}

void ArticulatedWorld::push_link(int32_t i, const Vec3& force, const Vec3& p_W) {
  if (!finite(force) || !finite(p_W)) fail(Code::kArgument, "push: the force is not finite");
  const Motion& m = link(i);
  const Vec3 com = m.X.p + link_R_[i] * scene_->link(i).inertia.com;
  pushes_[i].force += force;
  pushes_[i].torque += cross(p_W - com, force);
  pushed_ = true;
}

void ArticulatedWorld::push_base(int32_t articulation, const Vec3& force, const Vec3& torque) {
  if (!scene_->def.articulations[static_cast<size_t>(articulation)].free_base)
    fail(Code::kState, "push_base: the base of articulation %d is fixed", articulation);
  if (!finite(force) || !finite(torque)) fail(Code::kArgument, "push: the force is not finite");
  Wrench& push = pushes_[scene_->num_links + articulation];
  push.force += force;
  push.torque += torque;
  pushed_ = true;
}

void ArticulatedWorld::push_body(int32_t i, const Vec3& force, const Vec3& torque) {
  if (!finite(force) || !finite(torque)) fail(Code::kArgument, "push: the force is not finite");
  Wrench& push = pushes_[scene_->num_links + static_cast<int32_t>(scene_->def.articulations.size()) + i];
  push.force += force;
  push.torque += torque;
  pushed_ = true;
}

void ArticulatedWorld::begin_step() {
  status_ = 0;
  num_contacts_ = 0;
  diverged_ = false;
  for (int32_t i = 0; i < scene_->num_links; ++i) {
    if (std::isfinite(target_[i])) continue;
    target_[i] = q_[i];
    status_ |= kStatusDiverged;
  }
  for (size_t i = 0; i < scene_->sensors.size(); ++i) sensors_[i] = {};
  std::memset(touched_, 0, scene_->pairs.size());
  std::copy_n(bodies_, scene_->num_bodies, good_bodies_);
  std::copy_n(bases_, scene_->def.articulations.size(), good_bases_);
}

void ArticulatedWorld::predict_bodies() {
  const double h = scene_->def.solver.h;
  const Wrench* pushes = pushes_ + scene_->num_links + scene_->def.articulations.size();
  for (int32_t i = 0; i < scene_->num_bodies; ++i) {
    const BodyModel& model = shared_->bodies[static_cast<size_t>(i)];
    const Motion& m = bodies_[i];
    Body& body = moving_[i];
    const Mat3 R_BW = transpose(body.R);
    body.whitener = model.inverse_root * R_BW;
    Vec3 a = model.gravity, spin{};
    if (pushed_) {
      a += model.inverse_mass * pushes[i].force;
      spin = body.R * (model.inverse * (R_BW * pushes[i].torque));
    }
    body.v = model.linear * (m.v + h * a);
    body.w = model.angular * (m.w + h * spin);
  }
}

void ArticulatedWorld::set_body_bounds() {
  Bound* bounds = shared_->collider.bounds();
  for (size_t i = scene_->shapes.size(); i-- > 0;) {
    const SceneShape& s = scene_->shapes[i];
    if (s.carrier == Carrier::kStatic) continue;
    if (s.carrier != Carrier::kBody) break;  // bodies stand after all articulations
    const Mat3& R_WB = moving_[s.index].R;
    set_bound(s, bodies_[s.index].X.p + R_WB * s.def.X_LS.p, R_WB * to_matrix(s.def.X_LS.q), &bounds[i]);
  }
}

void ArticulatedWorld::collide(Collider::Poses& poses) {
  set_body_bounds();
  const Collider::Found found =
      shared_->collider.collide(*scene_, poses, contacts_, contact_pairs_, touched_);
  num_contacts_ = found.count;
  if (found.failed) mark_diverged();
  if (found.overflow) status_ |= kStatusContactOverflow;
  const Bound* bounds = shared_->collider.bounds();
  for (int32_t i = 0; i < num_contacts_; ++i) {
    const float* center = bounds[contacts_[i].shape_a].center;
    next_[i].pair = contact_pairs_[i];
    for (int k = 0; k < 3; ++k)
      next_[i].p[k] = static_cast<float>(contacts_[i].p[k] - static_cast<double>(center[k]));
  }
}

bool ArticulatedWorld::warm_impulse(int32_t contact, Vec3* impulse) const {
  const WarmPoint& here = next_[contact];
  float nearest = kWarmReach * kWarmReach;
  const WarmPoint* found = nullptr;
  for (int32_t i = 0; i < num_warm_; ++i) {
    if (warm_[i].pair != here.pair) continue;
    float square = 0;
    for (int k = 0; k < 3; ++k) square += (warm_[i].p[k] - here.p[k]) * (warm_[i].p[k] - here.p[k]);
    if (!(square < nearest)) continue;
    nearest = square;
    found = &warm_[i];
  }
  if (!found) return false;
  *impulse = {static_cast<double>(found->impulse[0]), static_cast<double>(found->impulse[1]),
              static_cast<double>(found->impulse[2])};
  return true;
}

void ArticulatedWorld::keep_impulses() {
  for (int32_t i = 0; i < num_contacts_; ++i)
    for (int k = 0; k < 3; ++k) next_[i].impulse[k] = static_cast<float>(impulses_[i][k]);
  std::swap(warm_, next_);
  num_warm_ = num_contacts_;
}

void ArticulatedWorld::move_bodies() {
  const double h = scene_->def.solver.h;
  for (int32_t i = 0; i < scene_->num_bodies; ++i) {
    const BodyModel& model = shared_->bodies[static_cast<size_t>(i)];
    Body& body = moving_[i];
    Motion& m = bodies_[i];
    m.v = body.v1;
    m.w = body.w1;
    if (!bounded(m.v) || !bounded(m.w) || !bounded(m.X.p)) {
      diverged_ = true;
      m = good_bodies_[i];
      m.v = m.w = {};
      continue;
    }
    const double spin = norm(m.w);
    if (spin > kMaxBodySpin) m.w = (kMaxBodySpin / spin) * m.w;
    const Vec3 momentum = body.R * (model.moment * (transpose(body.R) * m.w));
    m.X = moved(m.X, m.v, m.w, h);
    body.R = to_matrix(m.X.q);
    m.w = body.R * (model.inverse * (transpose(body.R) * momentum));  // free turning keeps the momentum
  }
}

// Back to the last poses that were good, at rest: the world stays usable and is still marked.
void ArticulatedWorld::recover() {
  status_ |= kStatusDiverged;
  num_contacts_ = num_warm_ = 0;
  for (int32_t i = 0; i < scene_->num_bodies; ++i) set_body(i, {good_bodies_[i].X, {}, {}});
  for (int32_t i = 0; i < scene_->num_links; ++i) qd_[i] = torque_[i] = 0;
  for (int32_t a = 0; a < static_cast<int32_t>(scene_->def.articulations.size()); ++a) {
    bases_[a] = {good_bases_[a].X, {}, {}};
    base_R_[a] = to_matrix(bases_[a].X.q);
    links_changed(a);
  }
  for (size_t i = 0; i < scene_->sensors.size(); ++i) sensors_[i] = {};
}

void ArticulatedWorld::end_step() {
  std::memset(fresh_, 0, static_cast<size_t>(scene_->num_links));
  if (diverged_) recover();
  if (!pushed_) return;
  pushed_ = false;
  std::fill_n(pushes_,
              static_cast<size_t>(scene_->num_links + scene_->num_bodies) + scene_->def.articulations.size(),
              Wrench{});
}

void ArticulatedWorld::step() {
  ArticulatedWorld* const one[1] = {this};
  const OdeScope scope;
  shared_->alone->step(one, 1);
}

void ArticulatedWorld::step_group(World* const* worlds, int32_t count) {
  const OdeScope scope;
  ArticulatedWorld* run[8];
  const int32_t most = std::min(shared_->group->group_size(), 8);
  for (int32_t first = 0; first < count; first += most) {
    const int32_t n = std::min(most, count - first);
    for (int32_t i = 0; i < n; ++i) run[i] = static_cast<ArticulatedWorld*>(worlds[first + i]);
    (n == 1 ? shared_->alone : shared_->group)->step(run, n);
  }
}

double ArticulatedWorld::body_overlap(int32_t body) {
  const OdeScope scope;
  Bound* bounds = shared_->collider.bounds();
  for (size_t i = 0; i < scene_->shapes.size(); ++i) {
    const SceneShape& s = scene_->shapes[i];
    if (!scene_->moves(s)) continue;
    const Pose X_WS = shape_pose(static_cast<int32_t>(i));
    set_bound(s, X_WS.p, to_matrix(X_WS.q), &bounds[i]);
  }
  StillPoses poses(*this);
  return shared_->collider.overlap(*scene_, poses, body);
}

}  // namespace rdm
