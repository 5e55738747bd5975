// A Stepper for one kind of lanes: gathers worlds into lanes, runs the substeps, scatters them back.
// Part of stepper_v*.cpp.
#pragma once
#include "physics/articulated/articulated_world.hpp"
#include "physics/articulated/contact_rows.hpp"
#include "physics/articulated/stepper_table.hpp"
#include "physics/articulated/tree_drives.hpp"

namespace rdm {
namespace {

constexpr double kRateBound = 1e6;  // rad/s, m/s: beyond it a world has diverged
constexpr int kContactRounds = 3;   // of contacts and sets in turn

template <class L>
class StepperLanes final : public Stepper {
 public:
  using S = typename L::Scalar;
  using V = typename L::V;
  using Mask = typename L::Mask;

  StepperLanes(const Scene& scene, ArticulatedShared& shared, Arena& arena)
      : scene_(&scene), shared_(&shared) {
    carve(arena);
    if (arena.measuring()) return;
    for (int32_t k = 0; k < num_sets_; ++k) fill_constants(sets_[k], k);
    list_places();
  }
  int32_t group_size() const override { return group_; }
  void end(const HostHooks& hooks) override { host_delete(hooks, this); }
  void step(ArticulatedWorld* const* worlds, int32_t count) override;
  void refresh(ArticulatedWorld& world, int32_t articulation) override;
  void read_link(const ArticulatedWorld& world, int32_t link, Motion* m, Mat3* R) const override;

 private:
  // A tree's lanes: sets_[first_set ...].
  struct Group {
    const Tree* tree;
    int32_t members, first_set, num_sets;
  };
  // Who carries a shape.
  struct Place {
    enum Kind : int32_t { kRest, kTree, kBody } kind;
    int32_t group, member, coord;  // of a tree: the last coordinate that moves it
    int32_t link, body;
    int32_t first_segment;
  };
  struct Lane {
    TreeBatch<L>* set;
    int lane;
  };
  // Exact shape poses of one world, for the collider.
  struct WorldPoses final : Collider::Poses {
    WorldPoses(const StepperLanes* s, int32_t i) : stepper(s), index(i) {}
    void place(int32_t shape, Vec3* p, Mat3* R) override { stepper->place_shape(index, shape, p, R); }
    const StepperLanes* stepper;
    int32_t index;
  };

  void carve(Arena& arena);
  void fill_constants(TreeBatch<L>& t, int32_t set);
  void list_places();
  Lane lane_of(int32_t group, int32_t member, int32_t world) const {
    const Group& g = groups_[group];
    const int32_t flat = world * g.members + member;
    return {&sets_[g.first_set + flat / L::kCount], flat % L::kCount};
  }
  const TreeMember& member_of(const TreeBatch<L>& t, int lane) const {
    return t.tree->members[static_cast<size_t>(t.member[lane])];
  }
  S* keep_of(ArticulatedWorld& world, int32_t articulation) const {
    return static_cast<S*>(world.keep()) + keep_first_[articulation];
  }
  const S* keep_of(const ArticulatedWorld& world, int32_t articulation) const {
    return static_cast<const S*>(world.keep()) + keep_first_[articulation];
  }
  void assign(TreeBatch<L>& t, int32_t set, int32_t count);
  void gather(TreeBatch<L>& t);
  void gather_pushes(TreeBatch<L>& t);
  void scatter(TreeBatch<L>& t);
  void set_base(TreeBatch<L>& t, int lane);
  void move_base(TreeBatch<L>& t);
  void substep();
  void find_contacts(int32_t world);
  void place_shape(int32_t world, int32_t shape, Vec3* p, Mat3* R) const;
  void solve_contacts();
  Mask lanes_of(const TreeBatch<L>& t, uint32_t worlds) const;
  uint32_t worlds_of(const TreeBatch<L>& t, Mask lanes) const;
  void solve_world(int32_t world);
  void add_side(typename ContactRows<S>::Point* point, const Place& place, int32_t world, S sign,
                const Vec3& p, const Vec3* axes);
  void apply(int32_t world);
  void add_forces(int32_t world);

  const Scene* scene_;
  ArticulatedShared* shared_;
  Group* groups_ = nullptr;
  TreeBatch<L>* sets_ = nullptr;
  Place* places_ = nullptr;  // [shapes]
  int32_t* body_segment_ = nullptr;
  int32_t* member_segment_ = nullptr;  // [articulations] first segment
  int32_t* keep_first_ = nullptr;      // [articulations] in numbers
  uint8_t* touched_ = nullptr;         // [articulations] by a contact of the world being solved
  S* change_ = nullptr;                // [most coordinates][4]
  Quat* link_back_ = nullptr;          // [num_links] q_JL
  Mat3* link_turn_ = nullptr;          // [num_links] R_JL
  ContactRows<S> rows_;
  int32_t num_groups_ = 0, num_sets_ = 0, group_ = 1, count_ = 0;
  ArticulatedWorld* const* worlds_ = nullptr;
};

template <class L>
void StepperLanes<L>::carve(Arena& arena) {
  num_groups_ = static_cast<int32_t>(shared_->trees.size());
  groups_ = arena.make<Group>(static_cast<size_t>(num_groups_));
  int32_t most_members = 1, most_coords = 0, segments = scene_->num_bodies, path = 1;
  num_sets_ = 0;
  for (const Tree& tree : shared_->trees)
    most_members = std::max(most_members, static_cast<int32_t>(tree.members.size()));
  group_ = std::max(1, L::kCount / most_members);
  for (int32_t g = 0; g < num_groups_; ++g) {
    const Tree& tree = shared_->trees[static_cast<size_t>(g)];
    const auto members = static_cast<int32_t>(tree.members.size());
    const Group group = {&tree, members, num_sets_, (group_ * members + L::kCount - 1) / L::kCount};
    if (groups_) groups_[g] = group;
    num_sets_ += group.num_sets;
    most_coords = std::max(most_coords, tree.num_coords);
    segments += members * tree.num_segments;
    path = std::max(path, tree.path_segments);
  }
  sets_ = arena.make<TreeBatch<L>>(static_cast<size_t>(num_sets_));
  int32_t set = 0;
  for (const Tree& tree : shared_->trees) {
    const auto members = static_cast<int32_t>(tree.members.size());
    for (int32_t k = 0; k < (group_ * members + L::kCount - 1) / L::kCount; ++k, ++set) {
      const auto links = static_cast<size_t>(tree.num_links), shapes = tree.shape_links.size();
      TreeBatch<L> t{};
      t.tree = &tree;
      t.bones = arena.make<LinkLanes<L>>(links);
      t.keep = arena.make<LinkState<V>>(links);
      t.work = arena.make<LinkWork<V>>(links);
      t.coord = arena.make<CoordWork<V>>(static_cast<size_t>(tree.num_coords));
      t.mass_matrix = arena.make<V>(tree.path.size());
      t.factor = arena.make<V>(tree.path.size());
      t.shape_p = arena.make<V[3]>(shapes);
      t.shape_a = arena.make<V[3]>(shapes);
      t.center = arena.make<V[3]>(shapes);
      t.axis = arena.make<V[3]>(shapes);
      if (sets_) sets_[set] = t;
    }
  }
  places_ = arena.make<Place>(scene_->shapes.size());
  body_segment_ = arena.make<int32_t>(static_cast<size_t>(scene_->num_bodies));
  member_segment_ = arena.make<int32_t>(scene_->def.articulations.size());
  keep_first_ = arena.make<int32_t>(scene_->def.articulations.size());
  touched_ = arena.make<uint8_t>(scene_->def.articulations.size());
  change_ = arena.make<S>(4 * static_cast<size_t>(most_coords));
  link_turn_ = arena.make<Mat3>(static_cast<size_t>(scene_->num_links));
  link_back_ = arena.make<Quat>(static_cast<size_t>(scene_->num_links));
  rows_.carve(arena, scene_->def.solver.contacts_max, segments, path);
}

template <class L>
void StepperLanes<L>::fill_constants(TreeBatch<L>& t, int32_t set) {
  const SolverDef& solver = scene_->def.solver;
  const Tree& tree = *t.tree;
  t.h = static_cast<S>(solver.h);
  t.inverse_h = static_cast<S>(1 / solver.h);
  t.limit_stiffness = static_cast<S>(solver.limit_stiffness);
  t.spring_only = solver.spring_only_effort;
  assign(t, set, group_);
  if (tree.free_base)
    for (int k = 0; k < 3; ++k) {
      t.coord[k].s[k] = L::all(1);
      t.coord[3 + k].a[k] = L::all(1);
    }
  const auto put = [](V* v, int lane, double x) { L::set(v, lane, static_cast<S>(x)); };
  for (int l = 0; l < L::kCount; ++l) {
    const TreeMember& m = member_of(t, l);
    for (int r = 0; r < 3; ++r) put(&t.gravity[r], l, m.gravity[r]);
    put(&t.linear_damping, l, 1 / (1 + solver.h * m.base_damping));
    put(&t.angular_damping, l, 1 / (1 + solver.h * m.base_damping));
    put(&t.base_mass, l, m.base.mass);
    for (int r = 0; r < 3; ++r) put(&t.base_com[r], l, m.base.com[r]);
    for (int k = 0; k < 6; ++k) put(&t.base_moment[k], l, m.base.moment[k]);
    for (int32_t i = 0; i < tree.num_links; ++i) {
      const MemberLink& bone = m.bones[static_cast<size_t>(i)];
      const JointDef& joint = bone.joint;
      LinkLanes<L>& b = t.bones[i];
      for (int k = 0; k < 9; ++k) put(&b.R_PJ[k], l, bone.R_PJ.m[k]);
      const double q_PJ[4] = {bone.q_PJ.w, bone.q_PJ.x, bone.q_PJ.y, bone.q_PJ.z};
      for (int k = 0; k < 4; ++k) put(&b.q_PJ[k], l, q_PJ[k]);
      for (int r = 0; r < 3; ++r) put(&b.p_PJ[r], l, bone.p_PJ[r]);
      for (int r = 0; r < 3; ++r) put(&b.com[r], l, bone.inertia.com[r]);
      for (int k = 0; k < 6; ++k) put(&b.moment[k], l, bone.inertia.moment[k]);
      put(&b.mass, l, bone.inertia.mass);
      put(&b.kp, l, joint.kp);
      put(&b.kd, l, joint.kd);
      put(&b.effort, l, joint.effort);
      put(&b.lower, l, joint.lower);
      put(&b.upper, l, joint.upper);
      put(&b.armature, l, joint.armature);
      put(&b.friction, l, joint.friction);
      put(&b.ratio, l, joint.ratio);
      put(&b.slack, l, joint.slack);
    }
    for (size_t k = 0; k < m.shapes.size(); ++k) {
      const ShapeDef& def = scene_->shapes[static_cast<size_t>(m.first_shape) + k].def;
      for (int r = 0; r < 3; ++r) {
        put(&t.shape_p[k][r], l, m.shapes[k].p_JS[r]);
        put(&t.shape_a[k][r], l, tree.shape_slender[k] ? def.size.y * m.shapes[k].R_JS(r, 2) : 0);
      }
    }
  }
}

template <class L>
void StepperLanes<L>::list_places() {
  int32_t segment = 0, keep = 0;
  for (size_t a = 0; a < scene_->def.articulations.size(); ++a) {
    keep_first_[a] = keep;
    keep += static_cast<int32_t>(
        (sizeof(BaseState<S>) + sizeof(LinkState<S>) * scene_->def.articulations[a].links.size()) /
        sizeof(S));
  }
  for (size_t i = 0; i < scene_->shapes.size(); ++i) places_[i] = {Place::kRest, 0, 0, -1, -1, -1, 0};
  for (int32_t g = 0; g < num_groups_; ++g) {
    const Tree& tree = *groups_[g].tree;
    for (int32_t m = 0; m < groups_[g].members; ++m, segment += tree.num_segments) {
      const TreeMember& member = tree.members[static_cast<size_t>(m)];
      member_segment_[member.articulation] = segment;
      for (int32_t i = 0; i < tree.num_links; ++i) {
        link_turn_[member.first_link + i] = transpose(member.bones[static_cast<size_t>(i)].R_LJ);
        link_back_[member.first_link + i] = conjugate(member.bones[static_cast<size_t>(i)].q_LJ);
      }
      for (size_t k = 0; k < tree.shape_links.size(); ++k) {
        const int32_t link = tree.shape_links[k],
                      coord = link < 0 ? (tree.free_base ? 5 : -1) : tree.coord(link);
        if (coord >= 0)
          places_[static_cast<size_t>(member.first_shape) + k] = {Place::kTree, g,  m,      coord,
                                                                  link,         -1, segment};
      }
    }
  }
  for (int32_t i = 0; i < scene_->num_bodies; ++i) body_segment_[i] = segment++;
  for (size_t i = 0; i < scene_->shapes.size(); ++i) {
    const SceneShape& s = scene_->shapes[i];
    if (s.carrier == Carrier::kBody)
      places_[i] = {Place::kBody, 0, 0, -1, -1, s.index, body_segment_[s.index]};
  }
}

// Which world and member each lane has when `count` worlds are in.
template <class L>
void StepperLanes<L>::assign(TreeBatch<L>& t, int32_t set, int32_t count) {
  int32_t g = 0;
  while (set >= groups_[g].first_set + groups_[g].num_sets) ++g;
  const Group& group = groups_[g];
  for (int l = 0; l < L::kCount; ++l) {
    const int32_t flat = (set - group.first_set) * L::kCount + l;
    t.member[l] = flat % group.members;
    t.world[l] = flat / group.members;
    t.used[l] = t.world[l] < count;
    if (!t.used[l]) t.world[l] = 0;
  }
}

template <class L>
void StepperLanes<L>::set_base(TreeBatch<L>& t, int lane) {
  const ArticulatedWorld& world = *worlds_[t.world[lane]];
  const int32_t a = member_of(t, lane).articulation;
  const Mat3& R = world.base_R(a);
  for (int k = 0; k < 9; ++k) L::set(&t.base_R[k], lane, static_cast<S>(R.m[k]));
  const Quat& turn = world.base(a).X.q;
  const double q[4] = {turn.w, turn.x, turn.y, turn.z};
  for (int k = 0; k < 4; ++k) L::set(&t.base_q[k], lane, static_cast<S>(q[k]));
}

template <class L>
void StepperLanes<L>::gather(TreeBatch<L>& t) {
  const Tree& tree = *t.tree;
  const int32_t offset = tree.coord(0);
  const S* from[L::kCount];
  for (int l = 0; l < L::kCount; ++l) {
    const ArticulatedWorld& world = *worlds_[t.world[l]];
    const TreeMember& member = member_of(t, l);
    from[l] = keep_of(world, member.articulation);
    set_base(t, l);
    if (tree.free_base) {
      const Motion& base = world.base(member.articulation);
      for (int k = 0; k < 3; ++k) {
        L::set(&t.coord[k].qd, l, static_cast<S>(base.v[k]));
        L::set(&t.coord[3 + k].qd, l, static_cast<S>(base.w[k]));
      }
    }
    const double *q = world.q() + member.first_link, *qd = world.qd() + member.first_link,
                 *target = world.target() + member.first_link;
    for (int32_t i = 0; i < tree.num_links; ++i) {
      L::set(&t.work[i].q, l, static_cast<S>(q[i]));
      L::set(&t.coord[offset + i].qd, l, static_cast<S>(qd[i]));
      L::set(&t.work[i].target, l, static_cast<S>(target[i]));
    }
  }
  constexpr int kBase = sizeof(BaseState<S>) / sizeof(S), kLink = sizeof(LinkState<S>) / sizeof(S);
  L::gather(from, kBase, t.base_keep.linear);
  for (const S*& f : from) f += kBase;
  L::gather(from, kLink * tree.num_links, t.keep[0].R);
  for (int32_t i = 0; i < tree.num_links; ++i) t.work[i].torque = V{};
  gather_pushes(t);
}

template <class L>
void StepperLanes<L>::gather_pushes(TreeBatch<L>& t) {
  t.any_push = false;
  for (int l = 0; l < L::kCount; ++l) t.any_push |= worlds_[t.world[l]]->pushed();
  if (!t.any_push) return;
  const auto put = [](V* v, int lane, const Wrench& w) {
    for (int r = 0; r < 3; ++r) {
      L::set(&v[r], lane, static_cast<S>(w.force[r]));
      L::set(&v[3 + r], lane, static_cast<S>(w.torque[r]));
    }
  };
  for (int l = 0; l < L::kCount; ++l) {
    const ArticulatedWorld& world = *worlds_[t.world[l]];
    const TreeMember& member = member_of(t, l);
    for (int32_t i = 0; i < t.tree->num_links; ++i)
      put(t.work[i].push, l, world.link_push(member.first_link + i));
    put(t.base.push, l, world.base_push(member.articulation));
  }
}

template <class L>
void StepperLanes<L>::scatter(TreeBatch<L>& t) {
  const Tree& tree = *t.tree;
  const int32_t offset = tree.coord(0);
  S* to[L::kCount] = {};
  int lanes = 0;
  for (int l = 0; l < L::kCount && t.used[l]; ++l, ++lanes) {
    ArticulatedWorld& world = *worlds_[t.world[l]];
    const TreeMember& member = member_of(t, l);
    to[l] = keep_of(world, member.articulation);
    double *q = world.q_out() + member.first_link, *qd = world.qd_out() + member.first_link,
           *torque = world.torque_out() + member.first_link;
    for (int32_t i = 0; i < tree.num_links; ++i) {
      q[i] = static_cast<double>(L::get(t.work[i].q, l));
      qd[i] = static_cast<double>(L::get(t.coord[offset + i].qd, l));
      torque[i] = static_cast<double>(L::get(t.work[i].torque, l));
    }
  }
  constexpr int kBase = sizeof(BaseState<S>) / sizeof(S), kLink = sizeof(LinkState<S>) / sizeof(S);
  L::scatter(t.base_keep.linear, kBase, lanes, to);
  for (int l = 0; l < lanes; ++l) to[l] += kBase;
  L::scatter(t.keep[0].R, kLink * tree.num_links, lanes, to);
}

// Free bases go on by the rates of their first six coordinates: the centre of mass straight on.
template <class L>
void StepperLanes<L>::move_base(TreeBatch<L>& t) {
  if (!t.tree->free_base) return;
  const double h = scene_->def.solver.h;
  for (int l = 0; l < L::kCount; ++l) {
    if (t.used[l]) {
      ArticulatedWorld& world = *worlds_[t.world[l]];
      const int32_t a = member_of(t, l).articulation;
      Motion& base = world.base_out(a);
      for (int k = 0; k < 3; ++k) {
        base.v[k] = static_cast<double>(L::get(t.coord[k].qd, l));
        base.w[k] = static_cast<double>(L::get(t.coord[3 + k].qd, l));
      }
      const Vec3& com = member_of(t, l).base.com;
      Mat3& R = world.base_R_out(a);
      const Vec3 arm = R * com, v = base.v + cross(base.w, arm);
      base.X = moved({base.X.p + arm, base.X.q}, v, base.w, h);
      R = to_matrix(base.X.q);
      const Vec3 next = R * com;
      base.X.p -= next;
      base.v = v - cross(base.w, next);
      for (int k = 0; k < 3; ++k) {
        L::set(&t.coord[k].qd, l, static_cast<S>(base.v[k]));
        base.v[k] = static_cast<double>(static_cast<S>(base.v[k]));
      }
    }
    set_base(t, l);
  }
}

template <class L>
void StepperLanes<L>::substep() {
  for (int32_t k = 0; k < num_sets_; ++k) {
    place_masses(sets_[k]);
    place_shapes(sets_[k]);
  }
  for (int32_t w = 0; w < count_; ++w) find_contacts(w);
  for (int32_t k = 0; k < num_sets_; ++k) {
    dynamics(sets_[k]);
    set_drives(sets_[k]);
    solve_drives(sets_[k]);
  }
  solve_contacts();
  const SolverDef& solver = scene_->def.solver;
  for (int32_t w = 0; w < count_; ++w) add_forces(w);
  for (int32_t k = 0; k < num_sets_; ++k) {
    TreeBatch<L>& t = sets_[k];
    add_torques(t, static_cast<S>(1.0 / solver.substeps));
    const Mask good = integrate(t, static_cast<S>(solver.limit_margin), static_cast<S>(kRateBound));
    const uint32_t bad = worlds_of(t, good ^ L::mask(~0u));
    for (int32_t w = 0; w < count_; ++w)
      if (bad >> w & 1) worlds_[w]->mark_diverged();
    carry(t);
    move_base(t);
    kinematics(t);
  }
  for (int32_t w = 0; w < count_; ++w) {
    worlds_[w]->keep_impulses();
    worlds_[w]->move_bodies();
  }
}

template <class L>
void StepperLanes<L>::step(ArticulatedWorld* const* worlds, int32_t count) {
  worlds_ = worlds;
  count_ = count;
  for (int32_t w = 0; w < count; ++w) worlds[w]->begin_step();
  for (int32_t k = 0; k < num_sets_; ++k) {
    assign(sets_[k], k, count);
    gather(sets_[k]);
  }
  for (int32_t s = 0; s < scene_->def.solver.substeps; ++s) substep();
  for (int32_t k = 0; k < num_sets_; ++k) {
    turns(sets_[k]);
    scatter(sets_[k]);
  }
  for (int32_t w = 0; w < count; ++w) worlds[w]->end_step();
}

template <class L>
StepperLanes<L>* make_lanes(const Scene& scene, ArticulatedShared& shared, Arena& arena) {
  if (arena.measuring()) {
    const StepperLanes<L> measured(scene, shared, arena);
    return nullptr;
  }
  return host_new<StepperLanes<L>>(shared.hooks, scene, shared, arena);
}

Stepper* make_kind(const StepperKind& kind, const Scene& scene, ArticulatedShared& shared, Arena& arena) {
  if (kind.double_precision) return make_lanes<Simd<double, 1>>(scene, shared, arena);
  if (kind.lanes == 8) return make_lanes<Simd<float, 8>>(scene, shared, arena);
  if (kind.lanes == 4) return make_lanes<Simd<float, 4>>(scene, shared, arena);
  return make_lanes<Simd<float, 1>>(scene, shared, arena);
}

StepperTable stepper_table(const char* isa) {
  return {isa, make_kind};
}

}  // namespace
}  // namespace rdm

#include "physics/articulated/stepper_contacts.hpp"
#include "physics/articulated/stepper_still.hpp"
