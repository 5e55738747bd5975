#include "physics/articulated/articulated_world.hpp"

#include <algorithm>
#include <array>
#include <cfloat>
#include <cmath>
#include <cstddef>
#include <iterator>

#include "base/bit_cast.hpp"
#include "base/error.hpp"
#include "physics/limits.hpp"

namespace rdm {
namespace {

constexpr int32_t kTag = 0x41525431;  // ART1; the scalar type is added

// Poses outside of a step, from the world's own answers.
class RestingPoses final : public Collider::Poses {
 public:
  explicit RestingPoses(const World& world) : world_(world) {}
  void place(int32_t shape, Vec3* p, Mat3* R) override {
    const Pose X_WS = world_.shape_pose(shape);
    *p = X_WS.p;
    *R = to_matrix(X_WS.q);
  }

 private:
  const World& world_;
};

size_t persistent_bytes(const Scene& scene) {
  size_t words = 0;
  for (const ArticulationDef& a : scene.def.articulations) words += kBaseWords + kLinkWords * a.links.size();
  return words * (scene.def.solver.double_precision ? sizeof(double) : sizeof(float));
}

}  // namespace

// World's arrays and this class's own, named once in state_ for the stepper.
ArticulatedWorld::ArticulatedWorld(const Scene& scene, Arena& arena, ArticulatedWorld* partner,
                                   bool partnered, int32_t together)
    : World(scene, arena) {
  const auto links = static_cast<size_t>(scene.num_links), bodies = static_cast<size_t>(scene.num_bodies),
             bases = scene.def.articulations.size(),
             contacts = static_cast<size_t>(scene.def.solver.contacts_max);
  state_.q = q_;
  state_.qd = qd_;
  state_.target = target_;
  state_.torque = torque_;
  state_.bases = bases_;
  state_.base_R = base_R_;
  state_.bodies = bodies_;
  state_.contacts = contacts_;
  state_.links = links_;
  state_.fresh = fresh_;
  state_.sensors = sensors_;
  state_.touched = touched_;
  state_.persistent = arena.make<unsigned char>(persistent_bytes(scene));
  state_.free_bodies = arena.make<FreeBody>(bodies);
  state_.pushes = arena.make<Wrench>(links + bases + bodies);
  state_.contact_pairs = arena.make<int32_t>(contacts);
  state_.warm = arena.make<WarmPoint>(contacts);
  carve_sleep(arena);
  state_.start_bodies = arena.make<Motion>(bodies);
  state_.start_bases = arena.make<Motion>(bases);
  state_.feedforward = feedforward_;
  if (scene.def.adjustable) {
    const size_t number = scene.def.solver.double_precision ? sizeof(double) : sizeof(float);
    state_.constants = arena.make<unsigned char>(number * first_constant(scene, static_cast<int32_t>(bases)));
    state_.dynamics = &dynamics_;
    state_.sized = sized_;
    own_models_ = arena.make<BodyModel>(bodies);
    heavier_ = arena.make<uint8_t>(bases);
  }
  try {
    make_shared(arena, partner, partnered, together);
  } catch (...) {  // no destructor runs
    release_shared();
    throw;
  }
  if (arena.measuring()) return;
  state_.body_models = own_models_ ? own_models_ : home_->model.bodies.data();
  own_constants();
  for (int32_t i = 0; i < scene.num_bodies; ++i) set_body(i, bodies_[i]);
  for (int32_t a = 0; a < static_cast<int32_t>(bases); ++a) links_changed(a);
}

void ArticulatedWorld::carve_sleep(Arena& arena) {
  const auto bodies = static_cast<size_t>(scene_->num_bodies),
             contacts = static_cast<size_t>(scene_->def.solver.contacts_max);
  if (!sleeps()) return;
  state_.sleep = arena.make<BodySleep>(bodies);
  state_.kept = arena.make<KeptPoint>(contacts);
  state_.kept_pairs = arena.make<int32_t>(contacts);
  state_.kept_warm = arena.make<WarmPoint>(contacts);
  size_t listed = 0;
  for (const PairRun& run : scene_->runs) listed += run.shape < 0 ? static_cast<size_t>(run.count) : 0;
  state_.listed = arena.make<int32_t>(listed);
  state_.body_bounds = arena.make<Bound>(static_cast<size_t>(scene_->num_body_shapes));
  state_.parent = arena.make<int32_t>(bodies);
  state_.island_marks = arena.make<uint8_t>(bodies);
  if (!arena.measuring()) wake_all(*scene_, &state_);
}

void ArticulatedWorld::make_shared(Arena& arena, ArticulatedWorld* partner, bool partnered,
                                   int32_t together) {
  if (partnered) {
    if (!partner) return;  // measuring
    shared_ = home_ = partner->home_;
    ++home_->users;
    return;
  }
  const HostHooks hooks = host();
  auto* shared = host_new<ArticulatedShared>(hooks);
  shared_ = home_ = shared;
  shared->users = 1;
  shared->hooks = hooks;
  shared->model = make_articulated_model(*scene_);
  shared->collider.carve(*scene_, arena);
  if (!arena.measuring()) shared->collider.make(*scene_);
  const SolverDef& solver = scene_->def.solver;
  const StepperTable table = best_steppers();
  const auto make = [&](int32_t lanes) {
    const StepperKind kind = {solver.double_precision, lanes, shared->num_steppers > 0, shared->steppers[0]};
    shared->steppers[shared->num_steppers++] =
        table.make(kind, shared->model, &shared->collider, hooks, arena);
  };
  if (solver.double_precision || solver.lanes > 0) {
    make(std::max(solver.lanes, 1));
  } else {
    // one for a world alone, one for full groups of those that step together, and one for the rest of them
    int32_t members = 1;
    for (const Tree& tree : shared->model.trees)
      members = std::max(members, static_cast<int32_t>(tree.members.size()));
    const int32_t widest = table.lanes, most = std::max(1, widest / members), alone = members == 1 ? 1 : 4;
    const auto fits = [&](int32_t lanes, int32_t worlds) {  // and nothing narrower does
      const auto group = [&](int32_t n) { return std::max(1, n / members); };
      const int32_t narrower = lanes == 8 ? alone : lanes / 2;
      return worlds > group(narrower) && worlds <= group(lanes);
    };
    make(alone);
    for (int32_t lanes = 8; lanes <= widest; lanes *= 2)
      if (together == 0 || fits(lanes, std::min(together, most)) || fits(lanes, together % most)) make(lanes);
  }
}

ArticulatedWorld::~ArticulatedWorld() {
  release_shared();
}

void ArticulatedWorld::release_shared() {
  if (!home_ || --home_->users > 0) return;
  const HostHooks hooks = home_->hooks;
  for (Stepper* stepper : home_->steppers)
    if (stepper) stepper->end(hooks);
  host_delete(hooks, home_);
}

template <class S>
void ArticulatedWorld::own_constants_of(const TreeMember& member) {
  S* to = static_cast<S*>(state_.constants) + first_constant(*scene_, member.articulation);
  bool heavier = false;
  const auto put = [&](const auto& record, size_t mass_at) {
    double from[sizeof record / sizeof(double)];
    std::memcpy(from, &record, sizeof record);
    const size_t mass = mass_at / sizeof(double), end = mass + 7;  // mass and moments
    for (size_t k = 0; k < std::size(from); ++k) {
      const S x = static_cast<S>(from[k]);
      heavier |= k >= mass && k < end && to[k] != x;
      to[k] = x;
    }
    to += std::size(from);
  };
  put(base_constants(shared_->model, member, &dynamics_), offsetof(BaseConstants<double>, base_mass));
  for (int32_t i = 0; i < static_cast<int32_t>(member.links.size()); ++i)
    put(link_constants(shared_->model, member, i, &dynamics_), offsetof(LinkConstants<double>, mass));
  heavier_[member.articulation] = heavier;
}

void ArticulatedWorld::own_constants() {
  if (!state_.constants) return;
  for (const Tree& tree : shared_->model.trees)
    for (const TreeMember& member : tree.members)
      if (scene_->def.solver.double_precision)
        own_constants_of<double>(member);
      else
        own_constants_of<float>(member);
  for (int32_t i = 0; i < scene_->num_bodies; ++i) own_models_[i] = body_model(*scene_, i, &dynamics_);
}

// Momenta are stored beside velocities, so those of links whose mass has changed are computed again.
void ArticulatedWorld::dynamics_changed() {
  own_constants();
  wake_all(*scene_, &state_);
  for (int32_t a = 0; a < static_cast<int32_t>(scene_->def.articulations.size()); ++a)
    if (heavier_[a]) links_changed(a);
}

// Joint coordinates or the base were set: the persistent words follow.
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
  shared_->alone().refresh(&state_, articulation);
}

void ArticulatedWorld::read_link(int32_t i, Motion* out) const {
  shared_->alone().read_link(state_, i, out);
}

void ArticulatedWorld::set_body(int32_t i, const Motion& m) {
  bodies_[i] = checked_motion("set_body", i, m);
  state_.free_bodies[i].R = to_matrix(bodies_[i].X.q);
  wake(*scene_, i, &state_);
}

void ArticulatedWorld::set_base(int32_t articulation, const Motion& m) {
  if (!scene_->def.articulations[static_cast<size_t>(articulation)].free_base)
    fail(Code::kState, "set_base: the base of articulation %d is fixed", articulation);
  bases_[articulation] = checked_motion("set_base", articulation, m);
  base_R_[articulation] = to_matrix(bases_[articulation].X.q);
  links_changed(articulation);
}

void ArticulatedWorld::push_link(int32_t i, const Vec3& force, const Vec3& p_W) {
  if (!finite(force) || !finite(p_W)) fail(Code::kArgument, "push: the force is not finite");
  const Vec3 com = link(i).X.p + shared_->alone().link_rotation(state_, i) * scene_->link(i).inertia.com;
  state_.pushes[i].force += force;
  state_.pushes[i].torque += cross(p_W - com, force);
  state_.pushed = true;
}

void ArticulatedWorld::push_base(int32_t articulation, const Vec3& force, const Vec3& torque) {
  if (!scene_->def.articulations[static_cast<size_t>(articulation)].free_base)
    fail(Code::kState, "push_base: the base of articulation %d is fixed", articulation);
  if (!finite(force) || !finite(torque)) fail(Code::kArgument, "push: the force is not finite");
  Wrench& push = state_.pushes[scene_->num_links + articulation];
  push.force += force;
  push.torque += torque;
  state_.pushed = true;
}

void ArticulatedWorld::push_body(int32_t i, const Vec3& force, const Vec3& torque) {
  if (!finite(force) || !finite(torque)) fail(Code::kArgument, "push: the force is not finite");
  Wrench& push =
      state_.pushes[scene_->num_links + static_cast<int32_t>(scene_->def.articulations.size()) + i];
  push.force += force;
  push.torque += torque;
  state_.pushed = true;
}

// After a divergence: back to the poses at the start of the step, at rest. The world stays usable and keeps its
// status bit.
void ArticulatedWorld::recover() {
  status_ |= kStatusDiverged;
  num_contacts_ = state_.num_warm = state_.num_kept = 0;
  wake_all(*scene_, &state_);
  for (int32_t i = 0; i < scene_->num_bodies; ++i) set_body(i, {state_.start_bodies[i].X, {}, {}});
  for (int32_t i = 0; i < scene_->num_links; ++i) qd_[i] = torque_[i] = 0;
  for (int32_t a = 0; a < static_cast<int32_t>(scene_->def.articulations.size()); ++a) {
    bases_[a] = {state_.start_bases[a].X, {}, {}};
    base_R_[a] = to_matrix(bases_[a].X.q);
    links_changed(a);
  }
  for (size_t i = 0; i < scene_->sensors.size(); ++i) sensors_[i] = {};
}

void ArticulatedWorld::end_step() {
  status_ = state_.status;
  num_contacts_ = report_contacts(*scene_, &state_);
  if (state_.diverged) recover();
  clear_pushes();
}

void ArticulatedWorld::clear_pushes() {
  if (!state_.pushed) return;
  state_.pushed = false;
  std::fill_n(state_.pushes,
              static_cast<size_t>(scene_->num_links + scene_->num_bodies) + scene_->def.articulations.size(),
              Wrench{});
}

void ArticulatedWorld::step() {
  WorldState* const one = &state_;
  const OdeScope scope;
  shared_->alone().step(&one, 1);
  end_step();
}

void ArticulatedWorld::step_group(World* const* worlds, int32_t count) {
  const OdeScope scope;
  WorldState* run[kMostLanes];
  const int32_t most = shared_->widest().group_size();
  for (int32_t first = 0; first < count; first += most) {
    const int32_t n = std::min(most, count - first);
    for (int32_t i = 0; i < n; ++i) run[i] = &static_cast<ArticulatedWorld*>(worlds[first + i])->state_;
    shared_->fitting(n).step(run, n);
    for (int32_t i = 0; i < n; ++i) static_cast<ArticulatedWorld*>(worlds[first + i])->end_step();
  }
}

double ArticulatedWorld::body_overlap(int32_t body) {
  const OdeScope scope;
  for (int32_t i = 0; i < scene_->num_links; ++i) link(i);  // once, not for each shape and pair
  Bound* bounds = shared_->collider.bounds();
  for (size_t i = 0; i < scene_->shapes.size(); ++i) {
    const SceneShape& s = scene_->shapes[i];
    if (!scene_->moves(s)) continue;
    const Pose X_WS = shape_pose(static_cast<int32_t>(i));
    set_bound(s, X_WS.p, to_matrix(X_WS.q), &bounds[i]);
    if (const SizedShape* own = sized(static_cast<int32_t>(i))) size_bound(s, own->size_factor, &bounds[i]);
  }
  RestingPoses poses(*this);
  poses.sized = sized_;
  return shared_->collider.overlap(*scene_, poses, body);
}

// --- Saving and loading. A state is the tag, the scene's counts, the rows that every engine has, bases,
// bodies, the persistent words, the impulses of the last contacts, who sleeps where bodies may, and what the
// scene asks for beside them.

namespace {

// The next `count` words, each below `bound` in size.
template <class S>
bool words_within(Reader& in, size_t count, double bound) {
  bool good = true;
  for (size_t i = 0; i < count; ++i) good &= bounded(static_cast<double>(in.value<S>()), bound);
  return good;
}

// How far a link's rotation may be off: the rounding of every joint before it adds up.
constexpr double kChainTolerance = 0.1;

// Checks a link's saved words: a rotation, velocities and momenta within their bounds, valid active sets, a unit
// quaternion.
template <class S>
bool link_sound(const PersistentLink<S>& link) {
  constexpr auto wide = [](S x) { return static_cast<double>(x); };
  bool good = true;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k <= i; ++k) {  // R R^T = 1
      double product = 0;
      for (int c = 0; c < 3; ++c) product += wide(link.R[3 * i + c]) * wide(link.R[3 * k + c]);
      good &= bounded(product - (i == k ? 1 : 0), kChainTolerance);
    }
  for (int r = 0; r < 3; ++r)
    good &= bounded(wide(link.P[r]), kStateBound) && bounded(wide(link.w[r]), kMomentumBound) &&
            bounded(wide(link.v[r]), kMomentumBound) && bounded(wide(link.linear[r]), kMomentumBound) &&
            bounded(wide(link.angular[r]), kMomentumBound);
  for (const S set : {link.saturated, link.limited}) good &= set == -1 || set == 0 || set == 1;
  double square = 0;
  for (const S x : link.q) square += wide(x) * wide(x);
  return good && bounded(square - 1, kChainTolerance);
}

template <class S>
bool persistent_sound(Reader& in, const Scene& scene) {
  bool good = true;
  for (const ArticulationDef& a : scene.def.articulations) {
    good &= words_within<S>(in, kBaseWords, kMomentumBound);
    for (size_t i = 0; i < a.links.size(); ++i) good &= link_sound(in.value<PersistentLink<S>>());
  }
  return good;
}

bool same_motion(const Motion& a, const Motion& b) {
  using Words = std::array<uint64_t, sizeof(Motion) / 8>;
  return bit_cast<Words>(a) == bit_cast<Words>(b);
}

}  // namespace

void ArticulatedWorld::check(Reader& in) const {
  const SolverDef& solver = scene_->def.solver;
  if (in.value<int32_t>() != tag()) fail(Code::kFormat, "world state: it belongs to another engine");
  if (in.value<int32_t>() != scene_->num_links || in.value<int32_t>() != scene_->num_bodies)
    fail(Code::kFormat, "world state: it belongs to another scene");
  bool good = sound_rows(in, *scene_);
  for (size_t a = 0; a < scene_->def.articulations.size(); ++a) {
    const auto base = in.value<Motion>();
    good &= scene_->def.articulations[a].free_base ? sound(base) : same_motion(base, bases_[a]);
  }
  const Reader bodies = in;
  for (int32_t i = 0; i < scene_->num_bodies; ++i) good &= sound(in.value<Motion>());
  good &=
      solver.double_precision ? persistent_sound<double>(in, *scene_) : persistent_sound<float>(in, *scene_);
  const auto num_warm = in.value<int32_t>();
  good &= num_warm >= 0 && num_warm <= solver.contacts_max;
  int32_t last = 0;
  for (int32_t i = 0; i < solver.contacts_max; ++i) {
    const auto pair = in.value<int32_t>();
    good &= pair >= 0 && (pair < static_cast<int32_t>(scene_->pairs.size()) || pair == 0);
    good &= i >= num_warm || pair >= last;  // in the order of the pairs
    last = pair;
    good &= words_within<float>(in, 6, kMomentumBound);
  }
  good &= !sleeps() || sleep_sound(in, bodies);
  good &= sound_extras(in, *scene_);
  if (!good) fail(Code::kFormat, "world state: a number is not finite or out of range");
}

// Checks the sleepers of a saved state: an island has the number of its lowest body, quiet times are in range, and
// sleeping bodies do not move.
bool ArticulatedWorld::sleep_sound(Reader& in, Reader bodies) const {
  const int32_t most = shared_->model.sleep_substeps;
  Reader rows = in;
  bool good = true;
  for (int32_t i = 0; i < scene_->num_bodies; ++i) {
    const auto row = in.value<BodySleep>();
    const auto m = bodies.value<Motion>();
    good &= row.quiet >= 0 && row.quiet <= most && row.island >= kAwake && row.island <= i;
    if (!good) return false;
    if (row.island == kAwake) continue;
    Reader first = rows;
    first.view(static_cast<size_t>(row.island) * sizeof(BodySleep));
    good &= first.value<BodySleep>().island == row.island && row.quiet == most;
    good &= dot(m.v, m.v) == 0 && dot(m.w, m.w) == 0;
  }
  return good;
}

int32_t ArticulatedWorld::tag() const {
  return kTag + (scene_->def.solver.double_precision ? 1 : 0) + (sleeps() ? 2 : 0);
}

void ArticulatedWorld::save(Writer& out) const {
  out.value(tag());
  out.value(scene_->num_links);
  out.value(scene_->num_bodies);
  out.value(saved_status(status_));
  const auto bytes = static_cast<size_t>(scene_->num_links) * sizeof(double);
  for (const double* row : {q_, qd_, target_, torque_}) out.bytes(row, bytes);
  out.bytes(sensors_, scene_->sensors.size() * sizeof(Wrench));
  out.bytes(bases_, scene_->def.articulations.size() * sizeof(Motion));
  out.bytes(bodies_, static_cast<size_t>(scene_->num_bodies) * sizeof(Motion));
  out.bytes(state_.persistent, persistent_bytes(*scene_));
  // as many points as there can be, so that the size never changes
  const int32_t num_warm = state_.num_warm + state_.num_kept;
  out.value(num_warm);
  each_warm(state_, [&](const WarmPoint& point) { out.value(point); });
  for (int32_t i = num_warm; i < scene_->def.solver.contacts_max; ++i) out.value(WarmPoint{});
  if (sleeps()) out.bytes(state_.sleep, static_cast<size_t>(scene_->num_bodies) * sizeof(BodySleep));
  save_extras(out);
}

void ArticulatedWorld::take(Reader& in) {
  in.view(3 * sizeof(int32_t));
  status_ = in.value<uint32_t>();
  const auto links = static_cast<size_t>(scene_->num_links), bodies = static_cast<size_t>(scene_->num_bodies),
             bases = scene_->def.articulations.size();
  for (double* row : {q_, qd_, target_, torque_}) in.bytes(row, links * sizeof(double));
  in.bytes(sensors_, scene_->sensors.size() * sizeof(Wrench));
  in.bytes(bases_, bases * sizeof(Motion));
  in.bytes(bodies_, bodies * sizeof(Motion));
  in.bytes(state_.persistent, persistent_bytes(*scene_));
  state_.num_warm = in.value<int32_t>();
  in.bytes(state_.warm, static_cast<size_t>(scene_->def.solver.contacts_max) * sizeof(WarmPoint));
  if (sleeps()) in.bytes(state_.sleep, bodies * sizeof(BodySleep));
  load_extras(in);
  own_constants();
  for (size_t a = 0; a < bases; ++a) base_R_[a] = to_matrix(bases_[a].X.q);
  for (size_t i = 0; i < bodies; ++i) state_.free_bodies[i].R = to_matrix(bodies_[i].X.q);
  for (size_t i = 0; i < links; ++i) fresh_[i] = 0;
  for (size_t i = 0; i < scene_->pairs.size(); ++i) touched_[i] = 0;
  for (size_t i = 0; i < links + bases + bodies; ++i) state_.pushes[i] = {};
  num_contacts_ = 0;
  state_.pushed = false;
  forget_kept(*scene_, &state_);
}

void ArticulatedWorld::copy(const World& world) {
  if (&world == this) return;
  const auto& other = static_cast<const ArticulatedWorld&>(world);
  if (copy_rows(other)) own_constants();
  std::memcpy(state_.persistent, other.state_.persistent, persistent_bytes(*scene_));
  state_.num_warm = 0;
  each_warm(other.state_, [&](const WarmPoint& point) { state_.warm[state_.num_warm++] = point; });
  if (sleeps()) std::copy_n(other.state_.sleep, scene_->num_bodies, state_.sleep);
  for (int32_t i = 0; i < scene_->num_bodies; ++i) state_.free_bodies[i].R = other.state_.free_bodies[i].R;
  std::fill_n(fresh_, scene_->num_links, uint8_t{0});
  clear_pushes();
  forget_kept(*scene_, &state_);
}

size_t ArticulatedWorld::heap_bytes(const Scene& scene) {
  // The collider's geoms, measured and rounded up; worlds of one worker share them.
  return scene.shapes.size() * 300;
}

}  // namespace rdm
