// The stepper: one control step of several worlds, their robots in SIMD lanes. Part of stepper_v*.cpp, which
// compile it once per instruction set.
//
// Layout. Robots that are alike are members of one tree (tree.hpp); a batch holds as many of them as there
// are lanes, from one world or from several: `group_size` worlds fill the lanes, and all batches of all trees
// are stepped together. Trees run in batches; contacts run world by world, on one lane's numbers.
//
// substep() below is the whole of it, in the order of a textbook (MuJoCo's mj_step: position, velocity,
// actuation, acceleration, constraint, integration):
//   position       link inertias and shapes in world axes, contact points
//   acceleration   joint columns, bias forces, composite inertias                          tree_dynamics.inl
//                  of free bases without damping once more, for the motion to come            look_ahead.inl
//   actuation      drives, effort bounds and joint limits as an active set, velocities
//                  without contacts                                                        joint_limits.inl
//   constraint     contact impulses, in turn with the active set                           contact_solver.inl
//   integration    semi-implicit Euler: q += h v1; bases, bodies; kinematics of the next substep
// Bodies that sleep (sleep.hpp) take no part in any of it.
//
// Contacts and active sets depend on each other: an impulse may push a joint against its limit or a drive
// past its bound, which changes M and with it every contact. They are solved in turn; a world is open until
// its sets agree with its contacts' outcome. Rounds 0 and 1 change all contradictions, round 2 the first of
// each robot alone, then the damped set is frozen and the contacts are solved once more.
//
// Numbers. Joint coordinates, bases and bodies are doubles in a world (WorldState); a batch works in S,
// floats but for the reference, on places relative to each robot's base. A base moves in double, and contact
// points and free bodies are in double throughout, so that the rounding never depends on where in the
// world a robot stands. Nothing is summed across lanes: the bytes are those of one lane, whatever shares its
// batch.
#pragma once
#include "physics/articulated/contact_solver.inl"
#include "physics/articulated/direct_contacts.inl"
#include "physics/articulated/joint_limits.inl"
#include "physics/articulated/look_ahead.inl"
#include "physics/articulated/sleep.hpp"
#include "physics/articulated/stepper.hpp"
#include "physics/collision/robot_pairs.inl"
#include "physics/model/soft_limits.hpp"

namespace rdm {
namespace {

constexpr int kContactRounds = 3;  // of contacts and active sets in turn
// m/s by which a loaded point gives way, at most: it so lies no deeper than kMostYield h / erp below the layer
// (0.8 mm as scenes come), whatever it carries. 200 N at the softness that scenes come with.
constexpr double kMostYield = 0.02;

// The working memory of one world's contacts, whatever the lanes.
template <class S>
struct ContactStepper : Stepper {
  ContactSolver<S> own_contacts;
  DirectContacts<ContactSolver<S>> own_direct;
  WarmPoint* own_points = nullptr;  // [contacts_max] for find_contacts
};

template <class L>
class BatchStepper final : public ContactStepper<typename L::Scalar> {
 public:
  using S = typename L::Scalar;
  using V = typename L::V;
  using Mask = typename L::Mask;

  BatchStepper(const StepperKind& kind, const ArticulatedModel& model, Collider* collider, Arena& arena)
      : model_(&model),
        scene_(model.scene),
        collider_(collider),
        lender_(kind.lender ? static_cast<ContactStepper<S>*>(kind.lender) : this) {
    carve(arena, kind.borrows);
    if (arena.measuring()) return;
    for (int32_t k = 0; k < num_batches_; ++k) fill_constants(batches_[k], k);
    list_attachments();
    list_felt_links();
    if (in_lanes_) robot_pairs_.make(*scene_, collider_->broad());
  }
  int32_t group_size() const override { return group_size_; }
  void end(const HostHooks& hooks) override { host_delete(hooks, this); }
  void step(WorldState* const* worlds, int32_t count) override;
  void refresh(WorldState* world, int32_t articulation) override;
  void read_link(const WorldState& world, int32_t link, Motion* m) const override;
  Mat3 link_rotation(const WorldState& world, int32_t link) const override;

 private:
  static constexpr int kBase = static_cast<int>(kBaseWords), kLink = static_cast<int>(kLinkWords);
  // Robots' pairs are searched for all worlds at once, in vectors of half the width: two hands fill one.
  static constexpr bool kSearchesWide = sizeof(S) == 4 && L::kCount >= 8;
  using Half = Simd<float, kSearchesWide ? L::kCount / 2 : 4>;
  // Links with a sensor are written four lanes at a time (link_motion.inl).
  static constexpr bool kWritesFelt = sizeof(S) == 4 && L::kCount >= 4;

  // The batches of one tree: batches_[first_batch ...].
  struct Group {
    const Tree* tree;
    int32_t members, first_batch, num_batches;
    int32_t* felt;  // [num_felt] the tree's links with a sensor, of any member
    int32_t num_felt;
  };
  // What carries a shape.
  struct Attachment {
    enum Kind : int32_t { kStatic, kTree, kBody } kind;
    int32_t group, member, coord;  // of a tree: the last coordinate that moves it
    int32_t link, body;
    int32_t sensor;         // of the link, -1: none
    int32_t first_segment;  // of the body or the member in the contact solver
  };
  // Of free bodies that hang together by contacts, at the lowest of them.
  struct Island {
    int32_t root, points;  // the lowest body, or one that is nearer to it
    double least, most;    // inverse mass, 1/kg
  };
  struct Lane {
    TreeBatch<L>* batch;
    int lane;
  };
  // Exact shape poses of one world, for the collider.
  struct WorldPoses final : Collider::Poses {
    WorldPoses(const BatchStepper* s, int32_t i) : stepper(s), index(i) { sized = s->worlds_[i]->sized; }
    void place(int32_t shape, Vec3* p, Mat3* R) override { stepper->shape_pose(index, shape, p, R); }
    void bound(int32_t shape, Bound* bound) override { stepper->robot_pairs_.get(shape, index, bound); }
    Vec3 way(int32_t shape) override { return stepper->shape_way(index, shape); }
    const BatchStepper* stepper;
    int32_t index;
  };

  // memory and constants
  void carve(Arena& arena, bool borrows);
  bool may_be_extreme() const;
  void fill_constants(TreeBatch<L>& t, int32_t batch);
  void list_attachments();
  void list_felt_links();
  // lanes and worlds
  Lane lane_of(int32_t group, int32_t member, int32_t world) const {
    const Group& g = groups_[group];
    const int32_t flat = world * g.members + member;
    return {&batches_[g.first_batch + flat / L::kCount], flat % L::kCount};
  }
  const TreeMember& member_of(const TreeBatch<L>& t, int lane) const {
    return t.tree->members[static_cast<size_t>(t.member[lane])];
  }
  S* persistent_of(const WorldState& world, int32_t articulation) const {
    return static_cast<S*>(world.persistent) + first_word_[articulation];
  }
  // The numbers of a persistent record, one after the other, as a world stores them.
  template <class Record>
  static V* words(Record* record) {
    static_assert(alignof(Record) == alignof(V) && sizeof(Record) % sizeof(V) == 0);
    return reinterpret_cast<V*>(record);
  }
  Mask lanes_of(const TreeBatch<L>& t, uint32_t worlds) const;
  uint32_t worlds_of(const TreeBatch<L>& t, Mask lanes) const;
  void assign(TreeBatch<L>& t, int32_t batch, int32_t count);
  void gather(TreeBatch<L>& t);
  void gather_constants(TreeBatch<L>& t);
  void gather_pushes(TreeBatch<L>& t);
  void gather_base(TreeBatch<L>& t, int lane);
  void scatter(TreeBatch<L>& t);
  PersistentLink<S> link_words(const WorldState& world, int32_t link) const;
  void write_felt_links(int32_t batch);
  // the stages
  void substep();
  void find_robot_pairs();
  typename Half::V worlds_part(const V& lanes, int32_t members, int32_t member, int32_t chunk) const;
  void set_bounds(int32_t world);
  void detect_contacts(int32_t world);
  void shape_pose(int32_t world, int32_t shape, Vec3* p, Mat3* R) const;
  Vec3 shape_way(int32_t world, int32_t shape) const;
  void find_coming(int32_t world);
  void solve_contacts();
  void solve_contacts_of(int32_t world, bool again);
  void add_contact_rows(typename ContactSolver<S>::Point* point, const Attachment& at, int32_t world, S sign,
                        const Vec3& p, const Vec3* axes);
  using LawPoint = typename LawContacts<S>::Point;
  void add_law_point(int32_t world, int32_t contact, const ContactLaw& law, bool again);
  void add_law_rows(LawPoint* point, const Attachment& at, int32_t world, S sign, const Vec3& p,
                    const Vec3* axes, double* before);
  void align(int32_t world, const Contact& contact, Vec3* t, Vec3* u) const;
  double bounce(const ContactLaw& law, const Contact& contact, double before, double change) const;
  // A point of a free body with another or with what is at rest.
  bool is_free(const Contact& contact) const {
    return attachments_[contact.shape_a].kind == Attachment::kBody &&
           (attachments_[contact.shape_b].kind == Attachment::kBody ||
            attachments_[contact.shape_b].kind == Attachment::kStatic);
  }
  double most_push_out_speed() const;
  double push_out_speed(const WorldState& w, int32_t contact) const;
  double softness(const WorldState& w, int32_t contact) const;
  double layer(const WorldState& w, int32_t contact) const;
  double friction(const WorldState& w, int32_t pair) const;
  void find_extremes(int32_t world);
  bool solve_extremes(int32_t world);
  bool add_piles(int32_t world, bool again);
  void add_pile_points(int32_t world, bool again, typename WideContacts<S>::Group* group);
  void read_pile_impulses(int32_t world);
  void take_impulses(int32_t world);
  void apply_impulses(TreeBatch<L>& t);
  void contact_forces(int32_t world);
  void integrate(TreeBatch<L>& t);
  void integrate_base(TreeBatch<L>& t);

  const ArticulatedModel* model_;
  const Scene* scene_;
  Collider* collider_;
  Group* groups_ = nullptr;
  TreeBatch<L>* batches_ = nullptr;
  Attachment* attachments_ = nullptr;  // [shapes]
  double* half_widths_ = nullptr;      // [shapes] m
  int32_t* body_segment_ = nullptr;    // [num_bodies]
  int32_t* member_segment_ = nullptr;  // [articulations] first segment
  int32_t* first_word_ = nullptr;      // [articulations] in WorldState::persistent, in numbers
  uint8_t* touched_ = nullptr;         // [articulations] by a contact of the world being solved
  uint8_t* in_pile_ = nullptr;         // [contacts_max] of that world's points those in lanes
  S* path_ = nullptr;                // [most coordinates][4, with laws 6] working memory of a contact's path
  const V** factor_rows_ = nullptr;  // [most coordinates] of its coordinates
  Quat* q_JL_ = nullptr;             // [num_links]
  Mat3* R_JL_ = nullptr;             // [num_links]
  RobotPairs<Half> robot_pairs_;
  bool in_lanes_ = false;  // those are in use
  ContactStepper<S>* lender_;
  ContactSolver<S>& contacts_ = lender_->own_contacts;
  DirectContacts<ContactSolver<S>>& direct_ = lender_->own_direct;
  Island* island_ = nullptr;  // [num_bodies]; null: bodies are much alike
  int32_t* directly_ =
      nullptr;             // [contacts_max] of the world being solved: a point's island, -1: by sweeps alone
  bool extremes_ = false;  // any point is of an island
  int32_t num_groups_ = 0, num_batches_ = 0, group_size_ = 1, count_ = 0;
  WorldState* const* worlds_ = nullptr;  // [count_] of the step under way
};

// --- The stages.

template <class L>
void BatchStepper<L>::step(WorldState* const* worlds, int32_t count) {
  worlds_ = worlds;
  count_ = count;
  for (int32_t w = 0; w < count; ++w) {
    begin_step(*model_, worlds[w]);
    begin_sleepers(*model_, worlds[w]);
  }
  for (int32_t k = 0; k < num_batches_; ++k) {
    assign(batches_[k], k, count);
    gather(batches_[k]);
  }
  for (int32_t s = 0; s < scene_->def.solver.substeps; ++s) substep();
  for (int32_t k = 0; k < num_batches_; ++k) {
    orientations(batches_[k]);
    scatter(batches_[k]);
    write_felt_links(k);
  }
  worlds_ = nullptr;
}

template <class L>
void BatchStepper<L>::substep() {
  // position
  for (int32_t k = 0; k < num_batches_; ++k) {
    link_inertias(batches_[k]);
    shape_poses(batches_[k]);
    if (batches_[k].shape_way) shape_ways(batches_[k]);
  }
  if (in_lanes_) find_robot_pairs();
  for (int32_t w = 0; w < count_; ++w) {
    detect_contacts(w);
    predict_bodies(*model_, worlds_[w]);  // of those that a contact has woken too
  }
  // acceleration and actuation
  for (int32_t k = 0; k < num_batches_; ++k) {
    TreeBatch<L>& t = batches_[k];
    motion_subspaces(t);
    if (t.tree->looks_ahead) guess_ahead(t);
    body_forces(t);
    bias_forces(t);
    composite_inertias(t);
    joint_drives(t);
    solve_without_contacts(t);
    if (!t.tree->looks_ahead) continue;
    solve_ahead(t, L::mask(~0u));
    const Mask far = turn_far(t);
    if (L::bits(far) != 0) solve_ahead(t, far);
  }
  // constraint
  solve_contacts();
  for (int32_t w = 0; w < count_; ++w) contact_forces(w);
  // integration
  for (int32_t k = 0; k < num_batches_; ++k) {
    TreeBatch<L>& t = batches_[k];
    joint_torques(t, static_cast<S>(1.0 / scene_->def.solver.substeps));
    integrate(t);
    momenta(t);
    if (t.tree->looks_ahead) add_half_ahead(t);
    integrate_base(t);
    kinematics(t);
  }
  for (int32_t w = 0; w < count_; ++w) {
    integrate_bodies(*model_, worlds_[w]);
    fall_asleep(*model_, worlds_[w]);
  }
}

// The part of a tree's lanes that belongs to one member, by world.
template <class L>
typename BatchStepper<L>::Half::V BatchStepper<L>::worlds_part(const V& lanes, int32_t members,
                                                               int32_t member, int32_t chunk) const {
  typename Half::V part{};
  if constexpr (kSearchesWide) {
    if (members == 1) {
      std::memcpy(&part, reinterpret_cast<const char*>(&lanes) + static_cast<size_t>(chunk) * sizeof part,
                  sizeof part);
    } else if (members == 2) {
      part = member == 0 ? L::evens(lanes) : L::odds(lanes);
    } else {
      for (int l = 0; l < Half::kCount; ++l)
        if (const int32_t world = chunk * Half::kCount + l; world < group_size_)
          Half::set(&part, l, L::get(lanes, world * members + member));
    }
  }
  return part;
}

// All bounds of all worlds, then the pairs with a robot's shape that may touch.
template <class L>
void BatchStepper<L>::find_robot_pairs() {
  if constexpr (kSearchesWide) {
    Bound* bounds = collider_->bounds();
    for (int32_t w = 0; w < count_; ++w) {
      set_body_bounds(*scene_, *worlds_[w], bounds);
      for (int32_t i = 0; i < scene_->num_body_shapes; ++i)
        robot_pairs_.set(scene_->first_body_shape + i, w, bounds[scene_->first_body_shape + i]);
    }
    for (int32_t g = 0; g < num_groups_; ++g) {
      const Tree& tree = *groups_[g].tree;
      const TreeBatch<L>& batch = batches_[groups_[g].first_batch];
      for (int32_t m = 0; m < groups_[g].members; ++m) {
        const TreeMember& member = tree.members[static_cast<size_t>(m)];
        for (int32_t c = 0; c < robot_pairs_.chunks(); ++c) {
          typename Half::V origin[3] = {};
          for (int l = 0; l < Half::kCount && c * Half::kCount + l < count_; ++l)
            for (int r = 0; r < 3; ++r)
              Half::set(&origin[r], l,
                        static_cast<float>(worlds_[c * Half::kCount + l]->bases[member.articulation].X.p[r]));
          for (int32_t k = 0; k < static_cast<int32_t>(tree.shape_links.size()); ++k) {
            if (tree.shape_links[static_cast<size_t>(k)] < 0 && !tree.free_base) continue;
            auto* center = robot_pairs_.center(member.first_shape + k, c);
            auto* axis = robot_pairs_.axis(member.first_shape + k, c);
            for (int r = 0; r < 3; ++r)
              center[r] = origin[r] + worlds_part(batch.center[k][r], groups_[g].members, m, c);
            for (int r = 0; r < 3 && tree.shape_slender[static_cast<size_t>(k)]; ++r)
              axis[r] = worlds_part(batch.axis[k][r], groups_[g].members, m, c);
          }
        }
      }
    }
    robot_pairs_.search(*scene_, collider_->broad(), count_);
  }
}

// Of all shapes that move, for the collider.
template <class L>
void BatchStepper<L>::set_bounds(int32_t world) {
  const WorldState& w = *worlds_[world];
  Bound* bounds = collider_->bounds();
  if (in_lanes_ && w.sleep)
    std::copy_n(w.body_bounds, scene_->num_body_shapes, bounds + scene_->first_body_shape);
  else
    set_body_bounds(*scene_, w, bounds);
  if (in_lanes_) return;
  for (int32_t g = 0; g < num_groups_; ++g) {
    const Tree& tree = *groups_[g].tree;
    for (int32_t m = 0; m < groups_[g].members; ++m) {
      const auto [batch, lane] = lane_of(g, m, world);
      const TreeMember& member = tree.members[static_cast<size_t>(m)];
      const Vec3& base = w.bases[member.articulation].X.p;
      const float origin[3] = {static_cast<float>(base.x), static_cast<float>(base.y),
                               static_cast<float>(base.z)};
      const auto shapes = static_cast<int32_t>(tree.shape_links.size());
      const int32_t* links = tree.shape_links.data();
      const uint8_t* slender = tree.shape_slender.data();
      Bound* bound = bounds + member.first_shape;
      for (int32_t k = 0; k < shapes; ++k, ++bound) {
        if (links[k] < 0 && !tree.free_base) continue;
        const V *center = batch->center[k], *axis = batch->axis[k];
        for (int r = 0; r < 3; ++r)
          bound->center[r] = origin[r] + static_cast<float>(L::get(center[r], lane));
        if (!slender[k]) continue;
        for (int r = 0; r < 3; ++r) bound->axis[r] = static_cast<float>(L::get(axis[r], lane));
      }
    }
  }
}

template <class L>
void BatchStepper<L>::detect_contacts(int32_t world) {
  set_bounds(world);
  if (scene_->def.solver.speculative_contacts) find_coming(world);
  WorldPoses poses(this, world);
  find_contacts(*model_, collider_, poses, in_lanes_ ? robot_pairs_.near(world) : nullptr,
                lender_->own_points, worlds_[world]);
}

// In double, from the pose that the lanes have: what the collider asks for once two bounds meet.
template <class L>
void BatchStepper<L>::shape_pose(int32_t world, int32_t shape, Vec3* p, Mat3* R) const {
  const Attachment& at = attachments_[shape];
  const WorldState& w = *worlds_[world];
  if (at.kind == Attachment::kBody) {
    const Pose& X_BS = scene_->shapes[static_cast<size_t>(shape)].def.X_LS;
    const Mat3& R_WB = w.free_bodies[at.body].R;
    const Vec3& p_BS = w.sized ? w.sized[shape - scene_->first_body_shape].p : X_BS.p;
    *p = w.bodies[at.body].X.p + R_WB * p_BS;
    *R = R_WB * to_matrix(X_BS.q);
    return;
  }
  const auto [batch, lane] = lane_of(at.group, at.member, world);
  const TreeMember& member = batch->tree->members[static_cast<size_t>(at.member)];
  const int32_t k = shape - member.first_shape;
  const V* rows = at.link < 0 ? batch->base_R : batch->state[at.link].R;
  Mat3 R_WJ;
  for (int i = 0; i < 9; ++i) R_WJ.m[i] = static_cast<double>(L::get(rows[i], lane));
  *R = R_WJ * member.shapes[static_cast<size_t>(k)].R_JS;
  *p = w.bases[member.articulation].X.p;
  for (int r = 0; r < 3; ++r) (*p)[r] += static_cast<double>(L::get(batch->center[k][r], lane));
}

// Where the substep takes a shape's place at the rates that it begins with, and bodies by their weight.
template <class L>
Vec3 BatchStepper<L>::shape_way(int32_t world, int32_t shape) const {
  const Attachment& at = attachments_[shape];
  if (at.kind == Attachment::kStatic) return {};
  const double h = scene_->def.solver.h;
  Vec3 v, spin, arm;
  if (at.kind == Attachment::kBody) {
    const WorldState& w = *worlds_[world];
    if (w.asleep(at.body)) return {};
    const Vec3& p_BS = w.sized ? w.sized[shape - scene_->first_body_shape].p
                               : scene_->shapes[static_cast<size_t>(shape)].def.X_LS.p;
    const Motion& m = w.bodies[at.body];
    v = m.v + h * w.body_models[at.body].gravity;
    spin = m.w;
    arm = w.free_bodies[at.body].R * p_BS;
  } else {
    const auto [batch, lane] = lane_of(at.group, at.member, world);
    const int32_t k = shape - batch->tree->members[static_cast<size_t>(at.member)].first_shape;
    for (int r = 0; r < 3; ++r) {
      const bool base = at.link < 0;
      v[r] = static_cast<double>(L::get(base ? batch->coord[r].qd : batch->state[at.link].v[r], lane));
      spin[r] = static_cast<double>(L::get(base ? batch->coord[3 + r].qd : batch->state[at.link].w[r], lane));
      arm[r] = static_cast<double>(L::get(batch->center[k][r], lane));
      if (!base) arm[r] -= static_cast<double>(L::get(batch->state[at.link].P[r], lane));
    }
  }
  return h * (v + cross(spin, arm));
}

// Bounds on all ways, for the collider: of links each, of bodies each.
template <class L>
void BatchStepper<L>::find_coming(int32_t world) {
  float* ways = collider_->ways();
  float fastest = 0;
  for (int32_t g = 0; g < num_groups_; ++g) {
    const Tree& tree = *groups_[g].tree;
    for (int32_t m = 0; m < groups_[g].members; ++m) {
      const auto [batch, lane] = lane_of(g, m, world);
      float* way = ways + tree.members[static_cast<size_t>(m)].first_shape;
      for (int32_t k = 0; k < static_cast<int32_t>(tree.shape_links.size()); ++k) {
        way[k] = static_cast<float>(L::get(batch->shape_way[k], lane));
        fastest = std::max(fastest, way[k]);
      }
    }
  }
  const int32_t first = scene_->first_body_shape;
  for (int32_t i = first; i < first + scene_->num_body_shapes; ++i)
    ways[i] = static_cast<float>(norm(shape_way(world, i)));
  collider_->look_ahead(fastest);
}

// Contacts and active sets in turn, until they agree or the rounds are over: then the damped choice. `open`
// has a bit for each world that is not done.
template <class L>
void BatchStepper<L>::solve_contacts() {
  uint32_t open = 0;
  for (int32_t w = 0; w < count_; ++w) {
    WorldState& world = *worlds_[w];
    for (int32_t i = 0; i < scene_->num_bodies; ++i) {
      world.free_bodies[i].v1 = world.free_bodies[i].v;
      world.free_bodies[i].w1 = world.free_bodies[i].w;
    }
    world.residual = 0;
    if (world.num_contacts > 0) open |= 1u << w;
  }
  for (int round = 0; open != 0; ++round) {
    for (int32_t k = 0; k < num_batches_; ++k) {
      TreeBatch<L>& t = batches_[k];
      t.pushed = 0;
      for (int32_t c = 0; c < t.tree->num_coords; ++c) {
        t.coord[c].inv_sqrt_d = L::root(t.coord[c].inv_d);
        t.push[c] = V{};
      }
    }
    for (int32_t w = 0; w < count_; ++w)
      if (open >> w & 1) solve_contacts_of(w, round > 0);
    for (int32_t k = 0; k < num_batches_; ++k)
      if (batches_[k].pushed != 0) apply_impulses(batches_[k]);
    if (round > kContactRounds) return;
    uint32_t changed = 0;
    for (int32_t k = 0; k < num_batches_; ++k) {
      TreeBatch<L>& t = batches_[k];
      const Mask lanes = update_active_set(t, lanes_of(t, open), round >= 2 && round < kContactRounds);
      changed |= worlds_of(t, lanes);
      if (round == kContactRounds) damp_active_set(t, lanes);
    }
    if (changed == 0) return;
    for (int32_t k = 0; k < num_batches_; ++k)
      solve_active_set(batches_[k], lanes_of(batches_[k], changed), Factors::kOtherSet);
    open = changed;
  }
}

// Two unit vectors t, u at right angles to n and each other.
inline void tangents(const Vec3& n, Vec3* t, Vec3* u) {
  if (n.z * n.z > 0.5) {
    const double k = 1 / std::sqrt(n.y * n.y + n.z * n.z);
    *t = {0, -n.z * k, n.y * k};
  } else {
    const double k = 1 / std::sqrt(n.x * n.x + n.y * n.y);
    *t = {-n.y * k, n.x * k, 0};
  }
  *u = cross(n, *t);
}

// One side's part of a point's rows, and its velocity without contacts, which is taken from the wanted one.
// `sign` is +1 on a, -1 on b; p the point, axes the normal and the tangents, in double.
// A body:  J = (n, (p - c) x n), times sqrt(1/m) and C^-1 R^T: half of the solve with its mass matrix.
// A robot: J has an entry n . (s_c + a_c x p) per coordinate c on the path from the touched link to the root.
//          z = D^-1/2 L^-T J^T stays on that path: from the link inward, each entry is taken off those
//          before it.
template <class L>
void BatchStepper<L>::add_contact_rows(typename ContactSolver<S>::Point* point, const Attachment& at,
                                       int32_t world, S sign, const Vec3& p, const Vec3* axes) {
  const WorldState& w = *worlds_[world];
  const int count = point->axes;
  if (at.kind == Attachment::kBody) {
    const FreeBody& body = w.free_bodies[at.body];
    const double sqrt_inv_mass = w.body_models[at.body].sqrt_inv_mass;
    const Vec3 arm = p - w.bodies[at.body].X.p;
    auto* rows = contacts_.segment_rows(point, at.first_segment);
    for (int f = 0; f < count; ++f) {
      const Vec3 moment = cross(arm, axes[f]), angular = body.inv_sqrt_inertia * moment;
      for (int r = 0; r < 3; ++r) {
        rows[f][r] += sign * static_cast<S>(axes[f][r] * sqrt_inv_mass);
        rows[f][3 + r] += sign * static_cast<S>(angular[r]);
      }
      point->b[f] -= sign * static_cast<S>(dot(axes[f], body.v) + dot(moment, body.w));
    }
    return;
  }
  if (at.kind == Attachment::kStatic) return;
  const auto [batch, lane] = lane_of(at.group, at.member, world);
  const Tree& tree = *batch->tree;
  const int32_t articulation = tree.members[static_cast<size_t>(at.member)].articulation;
  touched_[articulation] = 1;
  const Vec3& base = w.bases[articulation].X.p;
  using Axes4 = typename ContactSolver<S>::Axes;
  Axes4 axis[3], velocity{};
  S x[3];
  for (int r = 0; r < 3; ++r) {
    x[r] = static_cast<S>(p[r] - base[r]);
    axis[r] =
        sign * Axes4{static_cast<S>(axes[0][r]), static_cast<S>(axes[1][r]), static_cast<S>(axes[2][r]), 0};
  }
  // z[d]: the three rows' entries of the path's coordinate d
  Axes4* z = reinterpret_cast<Axes4*>(path_);
  const int32_t first = tree.row[static_cast<size_t>(at.coord)],
                depth = tree.depth[static_cast<size_t>(at.coord)];
  const int16_t* path = tree.path.data() + first;
  const uint8_t* moving = tree.moving.data() + first;
  for (int32_t d = 0; d <= depth; ++d) {
    factor_rows_[d] = batch->factor + tree.row[static_cast<size_t>(path[d])];
    if (!moving[d]) {
      z[d] = Axes4{};
      continue;
    }
    const CoordWork<V>& c = batch->coord[path[d]];
    S a[3], s[3];
    for (int r = 0; r < 3; ++r) {
      a[r] = L::get(c.a[r], lane);
      s[r] = L::get(c.s[r], lane);
    }
    // velocity of the point at unit rate
    const S v[3] = {s[0] + (a[1] * x[2] - a[2] * x[1]), s[1] + (a[2] * x[0] - a[0] * x[2]),
                    s[2] + (a[0] * x[1] - a[1] * x[0])};
    z[d] = axis[0] * v[0] + axis[1] * v[1] + axis[2] * v[2];
    velocity += z[d] * L::get(c.v1, lane);
  }
  for (int f = 0; f < count; ++f) point->b[f] -= velocity[f];
  // L^-T: from each entry what those behind it take, the last first; four entries at a time stay in registers
  int32_t top = depth;
  for (; top >= 3; top -= 4) {
    Axes4* const four = z + top - 3;
    Axes4 y[4] = {four[0], four[1], four[2], four[3]};
    const auto take = [&, lane = lane](const Axes4& from, int32_t d, int entries) {
      const V* factor = factor_rows_[d] + top - 3;
      for (int i = 0; i < entries; ++i) y[i] -= from * L::get(factor[i], lane);
    };
    for (int32_t d = depth; d > top; --d) take(z[d], d, 4);
    take(y[3], top, 3);
    take(y[2], top - 1, 2);
    take(y[1], top - 2, 1);
    for (int i = 0; i < 4; ++i) four[i] = y[i];
  }
  for (; top >= 0; --top)
    for (int32_t d = depth; d > top; --d) z[top] -= z[d] * L::get(factor_rows_[d][top], lane);
  // D^-1/2, into the segments that the path runs through
  for (int32_t d = depth; d >= 0;) {
    const int32_t segment = tree.slots[static_cast<size_t>(path[d])].segment;
    S part[3][kSegment] = {};
    for (; d >= 0; --d) {
      const TreeSlot slot = tree.slots[static_cast<size_t>(path[d])];
      if (slot.segment != segment) break;
      const Axes4 half_solved = z[d] * L::get(batch->coord[path[d]].inv_sqrt_d, lane);
      for (int f = 0; f < 3; ++f) part[f][slot.slot] = half_solved[f];
    }
    auto* rows = contacts_.segment_rows(point, at.first_segment + segment);
    for (int f = 0; f < count; ++f) {
      typename ContactSolver<S>::Row row;
      std::memcpy(&row, part[f], sizeof row);
      rows[f] += row;
    }
  }
}

template <class L>
double BatchStepper<L>::most_push_out_speed() const {
  const SolverDef& solver = scene_->def.solver;
  return solver.contact_max_speed > 0 ? solver.contact_max_speed : kArticulatedContactSpeed;
}

// erp / h of the depth below the layer, within a bound: a deep overlap, as after a blow, must not turn into a
// shot. Above the layer as much the other way: what rests lies equally deep wherever it started, and no point of
// a face leaves and comes back. What is yet to come may come as near as it is.
template <class L>
double BatchStepper<L>::push_out_speed(const WorldState& w, int32_t index) const {
  const SolverDef& solver = scene_->def.solver;
  const double depth = w.contacts[index].depth;
  if (depth < 0) return depth / solver.h;
  return std::min((depth - layer(w, index)) * solver.contact_erp / solver.h, most_push_out_speed());
}

// The pair's; of shapes that a world has in sizes of its own by those.
template <class L>
double BatchStepper<L>::layer(const WorldState& w, int32_t index) const {
  const ShapePair& pair = scene_->pairs[static_cast<size_t>(w.contact_pairs[index])];
  if (!w.sized) return pair.layer;
  const auto width = [&](int32_t shape) {
    const int32_t k = shape - scene_->first_body_shape;
    const bool own = k >= 0 && k < scene_->num_body_shapes;
    return (own ? w.sized[k].size_factor : 1.0) * half_widths_[shape];
  };
  return layer_of(scene_->def.solver, std::min(width(pair.a), width(pair.b)));
}

// cfm / h; less where the point's last impulse would give way by more than kMostYield.
template <class L>
double BatchStepper<L>::softness(const WorldState& w, int32_t index) const {
  const SolverDef& solver = scene_->def.solver;
  const double soft = solver.contact_cfm / solver.h;
  Vec3 last;
  if (!warm_impulse(w, index, &last)) return soft;
  const double n = dot(last, w.contacts[index].n);
  return soft * n > kMostYield ? kMostYield / n : soft;
}

template <class L>
double BatchStepper<L>::friction(const WorldState& w, int32_t index) const {
  const ShapePair& pair = scene_->pairs[static_cast<size_t>(index)];
  return w.dynamics ? w.dynamics->mu(*scene_, pair) : pair.mu;
}

// The impulses of one world's contacts for the present factors, and the velocities v1 that they give.
// `again`: not for the first time in this substep.
template <class L>
void BatchStepper<L>::solve_contacts_of(int32_t world, bool again) {
  WorldState& w = *worlds_[world];
  const SolverDef& solver = scene_->def.solver;
  const int32_t count = w.num_contacts;
  contacts_.begin();
  for (size_t a = 0; a < scene_->def.articulations.size(); ++a) touched_[a] = 0;
  find_extremes(world);
  const bool piles = add_piles(world, again);
  for (int32_t i = 0; i < count; ++i) {
    const Contact& contact = w.contacts[i];
    if (piles && in_pile_[i]) continue;
    if (const ContactLaw* law = scene_->law_of(w.contact_pairs[i])) {
      add_law_point(world, i, *law, piles && again);
      continue;
    }
    contacts_.stacked += attachments_[contact.shape_a].kind == Attachment::kBody &&
                         attachments_[contact.shape_b].kind == Attachment::kBody;
    auto& point =
        contacts_.add(static_cast<S>(friction(w, w.contact_pairs[i])), static_cast<S>(softness(w, i)));
    Vec3 axes[3] = {contact.n, {}, {}};
    tangents(contact.n, &axes[1], &axes[2]);
    point.b[0] = static_cast<S>(push_out_speed(w, i));
    if (contact.depth < 0) point.softness = S(0);
    add_contact_rows(&point, attachments_[contact.shape_a], world, S(1), contact.p, axes);
    add_contact_rows(&point, attachments_[contact.shape_b], world, S(-1), contact.p + contact.gap, axes);
    contacts_.prepare(&point);
    Vec3 last;
    if (piles && again)
      last = w.contacts[i].force;
    else if (!warm_impulse(w, i, &last))
      continue;
    S start[3];
    for (int f = 0; f < 3; ++f) start[f] = static_cast<S>(dot(last, axes[f]));
    start[0] = start[0] < 0 ? S(0) : start[0];
    contacts_.warm_start(&point, start);
  }
  const bool solved = extremes_ && solve_extremes(world);
  if (!solved || contacts_.wide.count > 0) contacts_.solve(solver.iterations, solved);
  w.residual = static_cast<double>(contacts_.residual());
  for (int32_t i = 0, k = 0, of_law = 0; i < count; ++i) {
    if (piles && in_pile_[i]) continue;
    const Vec3& n = w.contacts[i].n;
    Vec3 t, u;
    tangents(n, &t, &u);
    if (scene_->law_of(w.contact_pairs[i])) {
      const auto& point = contacts_.laws.points[of_law++];
      const auto& impulse = point.impulse;
      for (int r = 0; r < 3; ++r) t[r] = static_cast<double>(point.tangent[r]);
      u = cross(n, t);
      w.contacts[i].force = static_cast<double>(impulse[0]) * n + static_cast<double>(impulse[1]) * t +
                            static_cast<double>(impulse[2]) * u;
      continue;
    }
    const auto& impulse = contacts_.points[k++].impulse;
    w.contacts[i].force = static_cast<double>(impulse[0]) * n + static_cast<double>(impulse[1]) * t +
                          static_cast<double>(impulse[2]) * u;
  }
  if (piles) read_pile_impulses(world);
  take_impulses(world);
}

// Which points are solved at once: those of free bodies that hang together by contacts and differ much in mass.
template <class L>
void BatchStepper<L>::find_extremes(int32_t world) {
  extremes_ = false;
  if (!island_) return;
  const WorldState& w = *worlds_[world];
  const auto body_of = [&](int32_t shape) {
    const Attachment& at = attachments_[shape];
    return at.kind == Attachment::kBody ? at.body : -1;
  };
  const auto root = [&](int32_t i) {
    while (island_[i].root != i) i = island_[i].root = island_[island_[i].root].root;
    return i;
  };
  for (int32_t i = 0; i < scene_->num_bodies; ++i) {
    const double inverse = w.body_models[i].inv_mass;
    island_[i] = {i, 0, inverse, inverse};
  }
  for (int32_t i = 0; i < w.num_contacts; ++i) {
    const int32_t a = body_of(w.contacts[i].shape_a), b = body_of(w.contacts[i].shape_b);
    if (a < 0 || b < 0) continue;
    const int32_t x = root(a), y = root(b);
    if (x == y) continue;
    Island &to = island_[std::min(x, y)], &from = island_[std::max(x, y)];
    from.root = std::min(x, y);
    to.least = std::min(to.least, from.least);
    to.most = std::max(to.most, from.most);
    extremes_ |= to.most > kExtremeRatio * to.least;
  }
  if (!extremes_) return;
  for (int32_t i = 0; i < w.num_contacts; ++i) {
    const int32_t a = body_of(w.contacts[i].shape_a), b = body_of(w.contacts[i].shape_b);
    const bool own_law = scene_->law_of(w.contact_pairs[i]) != nullptr;
    directly_[i] = own_law || (a < 0 && b < 0) ? -1 : root(std::max(a, b));
    if (directly_[i] < 0) continue;
    // what a robot holds is left to the sweeps: its points hang together through the whole robot
    const bool held = attachments_[w.contacts[i].shape_a].kind == Attachment::kTree ||
                      attachments_[w.contacts[i].shape_b].kind == Attachment::kTree;
    island_[directly_[i]].points += held ? kMostDirect + 1 : 1;
  }
  for (int32_t i = 0; i < w.num_contacts; ++i) {
    if (directly_[i] < 0) continue;
    const Island& island = island_[directly_[i]];
    if (island.points > kMostDirect || island.most <= kExtremeRatio * island.least) directly_[i] = -1;
  }
}

// True if that is all there is to solve of the points outside of lanes: then no sweep touches them.
template <class L>
bool BatchStepper<L>::solve_extremes(int32_t world) {
  bool all = true;
  const WorldState& w = *worlds_[world];
  const SolverDef& solver = scene_->def.solver;
  for (int32_t island = 0; island < scene_->num_bodies; ++island) {
    direct_.begin();
    for (int32_t i = 0, k = 0; i < w.num_contacts; ++i) {
      if (contacts_.wide.count > 0 && in_pile_[i]) continue;
      if (scene_->law_of(w.contact_pairs[i])) {
        all = false;
        continue;
      }
      auto* point = contacts_.points + k++;
      all &= directly_[i] >= 0;
      if (directly_[i] == island)
        direct_.add(point, kYieldShare * layer(w, i) * solver.contact_erp / solver.h);
    }
    if (direct_.count > 0) all &= direct_.solve(&contacts_);
  }
  return all;
}

// One side's part of the rows of a point with a law, as add_contact_rows; axes 3 to 5 are of turning. Adds
// the velocities of the substep's start to `before`.
template <class L>
void BatchStepper<L>::add_law_rows(LawPoint* point, const Attachment& at, int32_t world, S sign,
                                   const Vec3& p, const Vec3* axes, double* before) {
  constexpr int kAxes = LawContacts<S>::kAxes;
  const WorldState& w = *worlds_[world];
  const int count = point->axes;
  const double side = static_cast<double>(sign);
  if (at.kind == Attachment::kBody) {
    const FreeBody& body = w.free_bodies[at.body];
    const Motion& m = w.bodies[at.body];
    const double sqrt_inv_mass = w.body_models[at.body].sqrt_inv_mass;
    const Vec3 arm = p - m.X.p;
    auto* rows = contacts_.laws.segment_rows(point, at.first_segment);
    for (int f = 0; f < count; ++f) {
      const Vec3 linear = f < 3 ? axes[f] : Vec3{}, moment = f < 3 ? cross(arm, axes[f]) : axes[f - 3];
      const Vec3 angular = body.inv_sqrt_inertia * moment;
      for (int r = 0; r < 3; ++r) {
        rows[f][r] += sign * static_cast<S>(linear[r] * sqrt_inv_mass);
        rows[f][3 + r] += sign * static_cast<S>(angular[r]);
      }
      point->b[f] -= sign * static_cast<S>(dot(linear, body.v) + dot(moment, body.w));
      before[f] += side * (dot(linear, m.v) + dot(moment, m.w));
    }
    return;
  }
  if (at.kind == Attachment::kStatic) return;
  const auto [batch, lane] = lane_of(at.group, at.member, world);
  const Tree& tree = *batch->tree;
  const int32_t articulation = tree.members[static_cast<size_t>(at.member)].articulation;
  touched_[articulation] = 1;
  const Vec3& base = w.bases[articulation].X.p;
  S x[3];
  for (int r = 0; r < 3; ++r) x[r] = static_cast<S>(p[r] - base[r]);
  S(*z)[kAxes] = reinterpret_cast<S(*)[kAxes]>(path_);
  const int32_t first = tree.row[static_cast<size_t>(at.coord)],
                depth = tree.depth[static_cast<size_t>(at.coord)];
  const int16_t* path = tree.path.data() + first;
  const uint8_t* moving = tree.moving.data() + first;
  for (int32_t d = 0; d <= depth; ++d) {
    factor_rows_[d] = batch->factor + tree.row[static_cast<size_t>(path[d])];
    if (!moving[d]) {
      for (int f = 0; f < kAxes; ++f) z[d][f] = 0;
      continue;
    }
    const CoordWork<V>& c = batch->coord[path[d]];
    S a[3], s[3];
    for (int r = 0; r < 3; ++r) {
      a[r] = L::get(c.a[r], lane);
      s[r] = L::get(c.s[r], lane);
    }
    const S v[3] = {s[0] + (a[1] * x[2] - a[2] * x[1]), s[1] + (a[2] * x[0] - a[0] * x[2]),
                    s[2] + (a[0] * x[1] - a[1] * x[0])};
    const S rate = L::get(c.v1, lane), last = L::get(c.qd, lane);
    for (int f = 0; f < count; ++f) {
      const S* of = f < 3 ? v : a;
      const Vec3& axis = axes[f % 3];
      z[d][f] = sign * (static_cast<S>(axis.x) * of[0] + static_cast<S>(axis.y) * of[1] +
                        static_cast<S>(axis.z) * of[2]);
      point->b[f] -= z[d][f] * rate;
      before[f] += static_cast<double>(z[d][f] * last);
    }
  }
  for (int32_t top = depth; top >= 0; --top)
    for (int32_t d = depth; d > top; --d)
      for (int f = 0; f < count; ++f) z[top][f] -= z[d][f] * L::get(factor_rows_[d][top], lane);
  for (int32_t d = depth; d >= 0; --d) {
    const TreeSlot slot = tree.slots[static_cast<size_t>(path[d])];
    auto* rows = contacts_.laws.segment_rows(point, at.first_segment + slot.segment);
    const S scale = L::get(batch->coord[path[d]].inv_sqrt_d, lane);
    for (int f = 0; f < count; ++f) rows[f][slot.slot] += z[d][f] * scale;
  }
}

// The speed at which a point is to part that closed at -before (m/s, along the normal, at the substep's
// start), 0: it does not meet in this substep, or was too slow to bounce. A free body that falls onto what is
// at rest is as deep in it as it came since they met: it leaves with the energy that it would have had there.
// What moves it through the substep, `change`, comes on top.
template <class L>
double BatchStepper<L>::bounce(const ContactLaw& law, const Contact& contact, double before,
                               double change) const {
  if (!(before < -kBounceSpeed) || law.restitution == 0) return 0;
  if (contact.depth < 0 && (before + change) * scene_->def.solver.h > contact.depth) return 0;
  const Attachment &a = attachments_[contact.shape_a], &b = attachments_[contact.shape_b];
  double fallen = 0;  // m2/s2: twice gravity times the way since they met
  if (a.kind == Attachment::kBody && b.kind == Attachment::kStatic)
    fallen = -2 * contact.depth * dot(model_->bodies[static_cast<size_t>(a.body)].gravity, contact.n);
  const double square = before * before, e = law.restitution;
  if (contact.depth >= 0) fallen = std::clamp(fallen, 0.0, square);
  const double left = std::max(e * e * (square - fallen) + fallen, 0.0);
  return std::max(std::sqrt(left) + std::min(change, 0.0), 0.0);
}

// MuJoCo's edges of friction of a capsule on a plane: along and across its axis.
template <class L>
void BatchStepper<L>::align(int32_t world, const Contact& contact, Vec3* t, Vec3* u) const {
  if (scene_->shapes[static_cast<size_t>(contact.shape_a)].def.kind != ShapeKind::kCapsule) return;
  Vec3 p;
  Mat3 R;
  shape_pose(world, contact.shape_a, &p, &R);
  const Vec3 axis{R(0, 2), R(1, 2), R(2, 2)}, along = axis - dot(axis, contact.n) * contact.n;
  const double length = norm(along);
  if (length < 1e-6) return;
  *t = (1 / length) * along;
  *u = cross(contact.n, *t);
}

template <class L>
void BatchStepper<L>::add_law_point(int32_t world, int32_t index, const ContactLaw& law, bool again) {
  WorldState& w = *worlds_[world];
  const Contact& contact = w.contacts[index];
  const double mu = friction(w, w.contact_pairs[index]);
  const double friction_of[] = {0, mu, mu, law.torsional, law.rolling, law.rolling};
  LawPoint& point = contacts_.laws.add(law.rolling > 0 ? 6 : law.torsional > 0 ? 4 : mu > 0 ? 3 : 1);
  // the collider's point is the deepest of the shape's
  const bool middle = law.soft() && scene_->shapes[static_cast<size_t>(contact.shape_b)].radius < 0;
  Vec3 axes[3] = {contact.n, {}, {}};
  tangents(contact.n, &axes[1], &axes[2]);
  if (middle && law.pyramid) align(world, contact, &axes[1], &axes[2]);
  for (int r = 0; r < 3; ++r) point.tangent[r] = static_cast<S>(axes[1][r]);
  double before[LawContacts<S>::kAxes] = {};
  const Vec3 p = middle ? contact.p + (0.5 * (contact.depth + law.margin)) * contact.n : contact.p;
  add_law_rows(&point, attachments_[contact.shape_a], world, S(1), p, axes, before);
  add_law_rows(&point, attachments_[contact.shape_b], world, S(-1), p + contact.gap, axes, before);
  contacts_.laws.prepare(&point);
  for (int f = 0; f < point.axes; ++f) point.friction[f] = static_cast<S>(friction_of[f]);
  if (law.soft() && contact.depth < 0) {  // yet to come: it gives way once they meet
    point.b[0] = S(-1e9);
  } else if (law.soft()) {
    const SoftRow row = soft_row(law, contact.depth, scene_->def.solver.h);
    const double weight = model_->inverse_weights[static_cast<size_t>(contact.shape_a)] +
                          model_->inverse_weights[static_cast<size_t>(contact.shape_b)];
    point.pyramid = law.pyramid && point.axes > 1 && mu > 0;
    for (int f = 0; f < point.axes; ++f) {
      point.b[f] += static_cast<S>(row.keep * before[f] + (f == 0 ? row.push : 0));
      const double ratio = f > 2 && friction_of[f] > 0 ? mu / friction_of[f] : 1;
      point.softness[f] = static_cast<S>(row.weight * weight * ratio * ratio);
    }
    if (point.pyramid) point.softness[0] = static_cast<S>(2 * mu * mu * (1 + mu * mu) * row.weight * weight);
  } else {
    const double change = -static_cast<double>(point.b[0]) - before[0];
    const double leaving = bounce(law, contact, before[0], change), push_out = push_out_speed(w, index);
    // softness would swallow some of a bounce
    if (leaving <= push_out && contact.depth >= 0) point.softness[0] = static_cast<S>(softness(w, index));
    point.b[0] += static_cast<S>(leaving > 0 ? std::max(push_out, leaving) : push_out);
  }
  Vec3 last;
  if (again)
    last = w.contacts[index].force;
  else if (!warm_impulse(w, index, &last))
    return;
  S start[3];
  for (int f = 0; f < 3; ++f) start[f] = static_cast<S>(dot(last, axes[f]));
  start[0] = start[0] < 0 ? S(0) : start[0];
  contacts_.laws.warm_start(&point, start, contacts_.sum);
}

// The pairs of free bodies with each other and with static shapes into lanes, if there are enough of them.
template <class L>
bool BatchStepper<L>::add_piles(int32_t world, bool again) {
  const WorldState& w = *worlds_[world];
  auto& wide = contacts_.wide;
  if (!wide.points || w.num_contacts < kWideFrom) return false;
  int32_t free = 0;
  for (int32_t i = 0; i < w.num_contacts; ++i) {
    in_pile_[i] =
        is_free(w.contacts[i]) && !scene_->law_of(w.contact_pairs[i]) && !(extremes_ && directly_[i] >= 0);
    free += in_pile_[i];
  }
  if (free < kWideFrom) return false;
  for (int32_t i = 0, end = 0; i < w.num_contacts; i = end) {
    while (end < w.num_contacts && w.contact_pairs[end] == w.contact_pairs[i]) ++end;
    if (in_pile_[i])
      wide.add(i, end - i, attachments_[w.contacts[i].shape_a].body,
               attachments_[w.contacts[i].shape_b].body);
  }
  wide.number_points();
  for (int32_t g = 0; g < wide.num_groups; ++g) add_pile_points(world, again, &wide.groups[g]);
  wide.warm_start(contacts_.sum);
  contacts_.levels = wide.levels([&](const auto& visit) {
    for (int32_t i = 0; i < w.num_contacts; ++i) {
      if (in_pile_[i]) continue;
      const Attachment &a = attachments_[w.contacts[i].shape_a], &b = attachments_[w.contacts[i].shape_b];
      if (a.kind == Attachment::kTree && b.kind == Attachment::kBody) visit(b.body);
      if (b.kind == Attachment::kTree && a.kind == Attachment::kBody) visit(a.body);
    }
  });
  return true;
}

// Rows, wanted velocities and starts of a group's points. Lanes without one get an axis and no mass.
template <class L>
void BatchStepper<L>::add_pile_points(int32_t world, bool again, typename WideContacts<S>::Group* group) {
  using W = typename WideContacts<S>::L;
  using WV = typename W::V;
  const WorldState& w = *worlds_[world];
  auto& wide = contacts_.wide;
  struct Side {
    WV root[9], v[3], w[3];  // C^-1 R^T, velocities without contacts
  };
  Side a{}, b{};
  const auto put = [](WV* v, int lane, double x) { W::set(v, lane, static_cast<S>(x)); };
  const auto put_body = [&](Side* side, WV* sqrt_mass, int lane, int32_t i) {
    if (i < 0) return;
    const FreeBody& body = w.free_bodies[i];
    for (int k = 0; k < 9; ++k) put(&side->root[k], lane, body.inv_sqrt_inertia.m[k]);
    for (int r = 0; r < 3; ++r) {
      put(&side->v[r], lane, body.v[r]);
      put(&side->w[r], lane, body.w[r]);
    }
    put(sqrt_mass, lane, w.body_models[i].sqrt_inv_mass);
  };
  for (int l = 0; l < group->lanes; ++l) {
    put_body(&a, &group->sqrt_mass_a, l, group->body_a[l]);
    put_body(&b, &group->sqrt_mass_b, l, group->body_b[l]);
    put(&group->mu, l, friction(w, w.contact_pairs[group->first[l]]));
  }
  group->linear = group->sqrt_mass_a * group->sqrt_mass_a + group->sqrt_mass_b * group->sqrt_mass_b;
  const auto dot3 = [](const WV* x, const WV* y) { return (x[0] * y[0] + x[1] * y[1]) + x[2] * y[2]; };
  const auto cross3 = [](const WV* x, const WV* y, WV* out) {
    out[0] = x[1] * y[2] - x[2] * y[1];
    out[1] = x[2] * y[0] - x[0] * y[2];
    out[2] = x[0] * y[1] - x[1] * y[0];
  };
  for (int32_t k = 0; k < group->most; ++k) {
    auto& p = wide.points[group->first_point + k];
    WV arm_a[3] = {}, arm_b[3] = {}, last[3] = {}, push_out{}, soft{};
    WV* n = p.axis[0];
    n[0] = n[1] = WV{};
    n[2] = W::all(S(1));
    for (int l = 0; l < group->lanes; ++l) {
      if (k >= group->count[l]) continue;
      const int32_t i = group->first[l] + k;
      const Contact& contact = w.contacts[i];
      const Vec3 to_a = contact.p - w.bodies[group->body_a[l]].X.p;
      const Vec3 to_b =
          group->body_b[l] < 0 ? Vec3{} : contact.p + contact.gap - w.bodies[group->body_b[l]].X.p;
      Vec3 start;
      if (again)
        start = w.contacts[i].force;
      else
        warm_impulse(w, i, &start);
      put(&push_out, l, push_out_speed(w, i));
      put(&soft, l, contact.depth < 0 ? 0 : softness(w, i));
      for (int r = 0; r < 3; ++r) {
        put(&n[r], l, contact.n[r]);
        put(&arm_a[r], l, to_a[r]);
        put(&arm_b[r], l, to_b[r]);
        put(&last[r], l, start[r]);
      }
    }
    // as tangents()
    const auto steep = n[2] * n[2] > S(0.5);
    const WV one = W::all(S(1)), none{};
    const WV inv = one / W::root(n[1] * n[1] + W::select(steep, n[2] * n[2], n[0] * n[0]));
    p.axis[1][0] = W::select(steep, none, -n[1] * inv);
    p.axis[1][1] = W::select(steep, -n[2], n[0]) * inv;
    p.axis[1][2] = W::select(steep, n[1] * inv, none);
    cross3(n, p.axis[1], p.axis[2]);
    for (int f = 0; f < 3; ++f) {
      WV moment_a[3], moment_b[3];
      cross3(arm_a, p.axis[f], moment_a);
      cross3(arm_b, p.axis[f], moment_b);
      WV slip[3];
      for (int r = 0; r < 3; ++r) {
        p.turn_a[f][r] = dot3(&a.root[3 * r], moment_a);
        p.turn_b[f][r] = -dot3(&b.root[3 * r], moment_b);
        slip[r] = a.v[r] - b.v[r];
      }
      p.b[f] = -(dot3(p.axis[f], slip) + dot3(moment_a, a.w) - dot3(moment_b, b.w));
      p.impulse[f] = dot3(last, p.axis[f]);
      if (f > 0) p.impulse[f] = W::select(group->mu > none, p.impulse[f], none);
    }
    p.b[0] += push_out;
    p.impulse[0] = W::select(p.impulse[0] < none, none, p.impulse[0]);
    wide.prepare(*group, &p, soft);
    // a lane that has no such point
    for (int l = 0; l < group->lanes; ++l)
      if (k >= group->count[l]) wide.clear(&p, l);
  }
}

template <class L>
void BatchStepper<L>::read_pile_impulses(int32_t world) {
  WorldState& w = *worlds_[world];
  const auto& wide = contacts_.wide;
  typedef double Doubles __attribute__((vector_size(sizeof(double) * kWide)));
  for (int32_t g = 0; g < wide.num_groups; ++g) {
    const auto& group = wide.groups[g];
    for (int32_t k = 0; k < group.most; ++k) {
      const auto& p = wide.points[group.first_point + k];
      Doubles out[3] = {};
      for (int f = 0; f < 3; ++f) {
        const Doubles impulse = __builtin_convertvector(p.impulse[f], Doubles);
        for (int r = 0; r < 3; ++r) out[r] += __builtin_convertvector(p.axis[f][r], Doubles) * impulse;
      }
      for (int l = 0; l < group.lanes; ++l)
        if (k < group.count[l]) w.contacts[group.first[l] + k].force = {out[0][l], out[1][l], out[2][l]};
    }
  }
}

// What the contacts of one world come to: v1 of its bodies, and of robots the sums into their lanes.
template <class L>
void BatchStepper<L>::take_impulses(int32_t world) {
  WorldState& w = *worlds_[world];
  for (int32_t g = 0; g < num_groups_; ++g) {
    const Tree& tree = *groups_[g].tree;
    for (int32_t m = 0; m < groups_[g].members; ++m) {
      const int32_t a = tree.members[static_cast<size_t>(m)].articulation;
      if (!touched_[a]) continue;
      const auto [batch, lane] = lane_of(g, m, world);
      const auto* sum = contacts_.sum + member_segment_[a];
      batch->pushed |= 1u << lane;
      for (int32_t c = 0; c < tree.num_coords; ++c) {
        const TreeSlot slot = tree.slots[static_cast<size_t>(c)];
        L::set(&batch->push[c], lane, sum[slot.segment][slot.slot]);
      }
    }
  }
  for (int32_t i = 0; i < scene_->num_bodies; ++i) {
    if (w.asleep(i)) continue;
    FreeBody& body = w.free_bodies[i];
    const auto& sum = contacts_.sum[body_segment_[i]];
    const double sqrt_inv_mass = w.body_models[i].sqrt_inv_mass;
    const Vec3 linear{static_cast<double>(sum[0]), static_cast<double>(sum[1]), static_cast<double>(sum[2])},
        angular{static_cast<double>(sum[3]), static_cast<double>(sum[4]), static_cast<double>(sum[5])};
    body.v1 = body.v + sqrt_inv_mass * linear;
    body.w1 = body.w + transpose(body.inv_sqrt_inertia) * angular;
  }
}

// v1 += L^-1 D^-1/2 sum for the robots that are touched.
template <class L>
void BatchStepper<L>::apply_impulses(TreeBatch<L>& t) {
  const Tree& tree = *t.tree;
  const Mask lanes = L::mask(t.pushed);
  V* const push = t.push;
  for (int32_t c = 0; c < tree.num_coords; ++c) {
    CoordWork<V>& coord = t.coord[c];
    const int32_t row = tree.row[static_cast<size_t>(c)], depth = tree.depth[static_cast<size_t>(c)];
    const V* factor = t.factor + row;
    const int16_t* path = tree.path.data() + row;
    V x = push[c] * coord.inv_sqrt_d;
    for (int32_t d = 0; d < depth; ++d) x -= factor[d] * push[path[d]];
    push[c] = x;
    coord.v1 = L::select(lanes, V(coord.v1 + x), coord.v1);
  }
}

// Points to come that got no impulse: nobody touches there.
inline void drop_unmet(WorldState* w) {
  int32_t kept = 0;
  for (int32_t i = 0; i < w->num_contacts; ++i) {
    Contact& contact = w->contacts[i];
    if (contact.depth < 0) {
      if (dot(contact.force, contact.force) == 0) continue;
      w->touched[w->contact_pairs[i]] = 1;
      contact.depth = 0;
    }
    if (kept != i) {
      w->contacts[kept] = contact;
      w->contact_pairs[kept] = w->contact_pairs[i];
      w->warm[kept] = w->warm[i];
    }
    ++kept;
  }
  w->num_contacts = w->num_warm = kept;
}

// Contact forces, the impulses that the next substep's solve starts from, and the mean of the forces on the links
// with a sensor, in the pose they act in. A point that is solved moves apart at push_out_speed - softness n: where
// that is the bound and n is larger, it gives way for ever.
template <class L>
void BatchStepper<L>::contact_forces(int32_t world) {
  WorldState& w = *worlds_[world];
  const double inv_h = 1 / scene_->def.solver.h, weight = 1.0 / scene_->def.solver.substeps;
  const double fastest = most_push_out_speed();
  if (w.residual > kUnsolvedSpeed) w.status |= kStatusUnconverged;
  if (scene_->def.solver.speculative_contacts) drop_unmet(&w);
  for (int32_t i = 0; i < w.num_contacts; ++i) {
    Contact& contact = w.contacts[i];
    const ContactLaw* law = scene_->law_of(w.contact_pairs[i]);
    if (!(law && law->soft()) && softness(w, i) * dot(contact.force, contact.n) > fastest &&
        push_out_speed(w, i) == fastest)
      w.status |= kStatusUnconverged;
    for (int r = 0; r < 3; ++r) w.warm[i].impulse[r] = static_cast<float>(contact.force[r]);
    contact.force = inv_h * contact.force;
    for (int side = 0; side < 2; ++side) {
      const Attachment& at = attachments_[side ? contact.shape_b : contact.shape_a];
      if (at.kind == Attachment::kBody) w.free_bodies[at.body].touches = true;
      if (at.sensor < 0) continue;
      const TreeMember& member = groups_[at.group].tree->members[static_cast<size_t>(at.member)];
      const auto [batch, lane] = lane_of(at.group, at.member, world);
      const PersistentLink<V>& link = batch->state[at.link];
      Mat3 R_WJ;
      for (int k = 0; k < 9; ++k) R_WJ.m[k] = static_cast<double>(L::get(link.R[k], lane));
      Vec3 origin = w.bases[member.articulation].X.p;
      for (int r = 0; r < 3; ++r) origin[r] += static_cast<double>(L::get(link.P[r], lane));
      const Mat3 R_LW = member.links[static_cast<size_t>(at.link)].R_LJ * transpose(R_WJ);
      const Vec3 force = (side ? -weight : weight) * contact.force,
                 place = side ? contact.p + contact.gap : contact.p;
      w.sensors[at.sensor].force += R_LW * force;
      w.sensors[at.sensor].torque += R_LW * cross(place - origin, force);
    }
  }
}

// Joints, and the rates of free bases; a world whose rates are beyond their bound has diverged.
template <class L>
void BatchStepper<L>::integrate(TreeBatch<L>& t) {
  const Mask good =
      integrate_joints(t, static_cast<S>(stop_margin(scene_->def.solver)), static_cast<S>(kRateBound));
  const uint32_t bad = worlds_of(t, good ^ L::mask(~0u));
  for (int32_t w = 0; w < count_; ++w)
    if (bad >> w & 1) worlds_[w]->diverged = true;
}

// Free bases move by the rates of their first six coordinates, the centre of mass in a straight line: its
// velocity is what the step solved for, that of the base's origin is not steady while the base turns.
template <class L>
void BatchStepper<L>::integrate_base(TreeBatch<L>& t) {
  if (!t.tree->free_base) return;
  const double h = scene_->def.solver.h;
  for (int l = 0; l < L::kCount; ++l) {
    if (t.used[l]) {
      WorldState& world = *worlds_[t.world[l]];
      const int32_t a = member_of(t, l).articulation;
      Motion& base = world.bases[a];
      for (int k = 0; k < 3; ++k) {
        base.v[k] = static_cast<double>(L::get(t.coord[k].qd, l));
        base.w[k] = static_cast<double>(L::get(t.coord[3 + k].qd, l));
      }
      const Vec3& com = member_of(t, l).base.com;
      Mat3& R = world.base_R[a];
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
    gather_base(t, l);
  }
}

// --- Between steps.

// Kinematics and momenta of one articulation from its joint coordinates and base, as if the step before had
// ended so.
template <class L>
void BatchStepper<L>::refresh(WorldState* world, int32_t articulation) {
  worlds_ = &world;
  count_ = 1;
  for (int32_t k = 0; k < num_batches_; ++k) {
    TreeBatch<L>& t = batches_[k];
    assign(t, k, 1);
    int lane = -1;
    for (int l = 0; l < L::kCount; ++l)
      if (t.used[l] && member_of(t, l).articulation == articulation) lane = l;
    if (lane < 0) continue;
    gather(t);
    kinematics(t);
    orientations(t);
    link_inertias(t);
    momenta(t);
    // this member alone: the others keep what they have
    S* to = persistent_of(*world, articulation);
    const V *base = words(&t.base_state), *links = words(t.state);
    for (int i = 0; i < kBase; ++i) to[i] = L::get(base[i], lane);
    for (int i = 0; i < kLink * t.tree->num_links; ++i) to[kBase + i] = L::get(links[i], lane);
  }
  worlds_ = nullptr;
}

// --- Worlds into lanes and back.

// Masks of lanes from sets of worlds, a bit each, and back.
template <class L>
typename L::Mask BatchStepper<L>::lanes_of(const TreeBatch<L>& t, uint32_t worlds) const {
  uint32_t bits = 0;
  for (int l = 0; l < L::kCount; ++l)
    if (t.used[l]) bits |= (worlds >> t.world[l] & 1) << l;
  return L::mask(bits);
}

template <class L>
uint32_t BatchStepper<L>::worlds_of(const TreeBatch<L>& t, Mask lanes) const {
  const uint32_t bits = L::bits(lanes);
  uint32_t worlds = 0;
  for (int l = 0; bits != 0 && l < L::kCount; ++l)
    if (t.used[l] && (bits >> l & 1)) worlds |= 1u << t.world[l];
  return worlds;
}

// Which world and member each lane has when `count` worlds are in.
template <class L>
void BatchStepper<L>::assign(TreeBatch<L>& t, int32_t batch, int32_t count) {
  int32_t g = 0;
  while (batch >= groups_[g].first_batch + groups_[g].num_batches) ++g;
  const Group& group = groups_[g];
  for (int l = 0; l < L::kCount; ++l) {
    const int32_t flat = (batch - group.first_batch) * L::kCount + l;
    t.member[l] = flat % group.members;
    t.world[l] = flat / group.members;
    t.used[l] = t.world[l] < count;
    if (!t.used[l]) t.world[l] = 0;
  }
}

// All that a step reads of its worlds, lane by lane, rounded to S. Lanes without a world read another's and
// are never written back: they cost nothing and take the same path as that one.
template <class L>
void BatchStepper<L>::gather(TreeBatch<L>& t) {
  const Tree& tree = *t.tree;
  const int32_t offset = tree.coord(0);
  const S* from[L::kCount];
  const double *q[L::kCount], *qd[L::kCount], *target[L::kCount];
  for (int l = 0; l < L::kCount; ++l) {
    const WorldState& world = *worlds_[t.world[l]];
    const TreeMember& member = member_of(t, l);
    from[l] = persistent_of(world, member.articulation);
    gather_base(t, l);
    if (tree.free_base) {
      const Motion& base = world.bases[member.articulation];
      for (int k = 0; k < 3; ++k) {
        L::set(&t.coord[k].qd, l, static_cast<S>(base.v[k]));
        L::set(&t.coord[3 + k].qd, l, static_cast<S>(base.w[k]));
      }
    }
    q[l] = world.q + member.first_link;
    qd[l] = world.qd + member.first_link;
    target[l] = world.target + member.first_link;
    for (int32_t i = 0; t.feedforward && i < tree.num_links; ++i)
      L::set(&t.feedforward[i], l, static_cast<S>(world.feedforward[member.first_link + i]));
  }
  L::gather_doubles(q, tree.num_links, [&](int i) { return &t.work[i].q; });
  L::gather_doubles(qd, tree.num_links, [&](int i) { return &t.coord[offset + i].qd; });
  L::gather_doubles(target, tree.num_links, [&](int i) { return &t.work[i].target; });
  L::gather(from, kBase, words(&t.base_state));
  for (const S*& f : from) f += kBase;
  L::gather(from, kLink * tree.num_links, words(t.state));
  for (int32_t i = 0; i < tree.num_links; ++i) t.work[i].torque = V{};
  if (scene_->def.adjustable) gather_constants(t);
  gather_pushes(t);
}

// What worlds have of their own in place of the scene's constants.
template <class L>
void BatchStepper<L>::gather_constants(TreeBatch<L>& t) {
  constexpr int kOfBase = static_cast<int>(kBaseConstants), kOfLink = static_cast<int>(kLinkConstants);
  const S* from[L::kCount];
  for (int l = 0; l < L::kCount; ++l)
    from[l] = static_cast<const S*>(worlds_[t.world[l]]->constants) +
              first_constant(*scene_, member_of(t, l).articulation);
  L::gather(from, kOfBase, words(static_cast<BaseConstants<V>*>(&t)));
  for (const S*& f : from) f += kOfBase;
  for (int32_t i = 0; i < t.tree->num_links; ++i) {
    L::gather(from, kOfLink, words(static_cast<LinkConstants<V>*>(&t.model[i])));
    for (const S*& f : from) f += kOfLink;
  }
}

template <class L>
void BatchStepper<L>::gather_pushes(TreeBatch<L>& t) {
  t.any_push = false;
  for (int l = 0; l < L::kCount; ++l) t.any_push |= worlds_[t.world[l]]->pushed;
  if (!t.any_push) return;
  const auto put = [](V* v, int lane, const Wrench& w) {
    for (int r = 0; r < 3; ++r) {
      L::set(&v[r], lane, static_cast<S>(w.force[r]));
      L::set(&v[3 + r], lane, static_cast<S>(w.torque[r]));
    }
  };
  for (int l = 0; l < L::kCount; ++l) {
    const WorldState& world = *worlds_[t.world[l]];
    const TreeMember& member = member_of(t, l);
    for (int32_t i = 0; i < t.tree->num_links; ++i)
      put(t.work[i].push, l, world.pushes[member.first_link + i]);
    put(t.base.push, l, world.base_pushes(*scene_)[member.articulation]);
  }
}

template <class L>
void BatchStepper<L>::gather_base(TreeBatch<L>& t, int lane) {
  const WorldState& world = *worlds_[t.world[lane]];
  const int32_t a = member_of(t, lane).articulation;
  const Mat3& R = world.base_R[a];
  for (int k = 0; k < 9; ++k) L::set(&t.base_R[k], lane, static_cast<S>(R.m[k]));
  const Quat& q_WB = world.bases[a].X.q;
  const double q[4] = {q_WB.w, q_WB.x, q_WB.y, q_WB.z};
  for (int k = 0; k < 4; ++k) L::set(&t.base_q[k], lane, static_cast<S>(q[k]));
}

template <class L>
void BatchStepper<L>::scatter(TreeBatch<L>& t) {
  const Tree& tree = *t.tree;
  const int32_t offset = tree.coord(0);
  S* to[L::kCount] = {};
  double *q[L::kCount] = {}, *qd[L::kCount] = {}, *torque[L::kCount] = {};
  int lanes = 0;
  for (int l = 0; l < L::kCount && t.used[l]; ++l, ++lanes) {
    WorldState& world = *worlds_[t.world[l]];
    const TreeMember& member = member_of(t, l);
    to[l] = persistent_of(world, member.articulation);
    q[l] = world.q + member.first_link;
    qd[l] = world.qd + member.first_link;
    torque[l] = world.torque + member.first_link;
  }
  L::scatter_doubles([&](int i) { return &t.work[i].q; }, tree.num_links, lanes, q);
  L::scatter_doubles([&](int i) { return &t.coord[offset + i].qd; }, tree.num_links, lanes, qd);
  L::scatter_doubles([&](int i) { return &t.work[i].torque; }, tree.num_links, lanes, torque);
  L::scatter(words(&t.base_state), kBase, lanes, to);
  for (int l = 0; l < lanes; ++l) to[l] += kBase;
  L::scatter(words(t.state), kLink * tree.num_links, lanes, to);
}

// --- Memory and constants.

// Two bodies differ by kExtremeRatio, as they are or by a world's factors on their masses.
template <class L>
bool BatchStepper<L>::may_be_extreme() const {
  constexpr double kFactors = 4;
  double least = HUGE_VAL, most = 0;
  for (const BodyDef& body : scene_->def.bodies) {
    least = std::min(least, body.inertia.mass);
    most = std::max(most, body.inertia.mass);
  }
  return most * (scene_->def.adjustable ? kFactors : 1) > kExtremeRatio * least;
}

// Segments of the contact solver: those of every member of every tree, then one per body.
template <class L>
void BatchStepper<L>::carve(Arena& arena, bool borrows) {
  num_groups_ = static_cast<int32_t>(model_->trees.size());
  groups_ = arena.make<Group>(static_cast<size_t>(num_groups_));
  int32_t most_members = 1, most_coords = 0, segments = scene_->num_bodies, path = 1;
  num_batches_ = 0;
  for (const Tree& tree : model_->trees)
    most_members = std::max(most_members, static_cast<int32_t>(tree.members.size()));
  group_size_ = std::max(1, L::kCount / most_members);
  for (int32_t g = 0; g < num_groups_; ++g) {
    const Tree& tree = model_->trees[static_cast<size_t>(g)];
    const auto members = static_cast<int32_t>(tree.members.size());
    Group group = {&tree,   members, num_batches_, (group_size_ * members + L::kCount - 1) / L::kCount,
                   nullptr, 0};
    if (kWritesFelt) group.felt = arena.make<int32_t>(static_cast<size_t>(tree.num_links));
    if (groups_) groups_[g] = group;
    num_batches_ += group.num_batches;
    most_coords = std::max(most_coords, tree.num_coords);
    segments += members * tree.num_segments;
    path = std::max(path, tree.path_segments);
  }
  batches_ = arena.make<TreeBatch<L>>(static_cast<size_t>(num_batches_));
  int32_t batch = 0;
  for (const Tree& tree : model_->trees) {
    const auto members = static_cast<int32_t>(tree.members.size());
    for (int32_t k = 0; k < (group_size_ * members + L::kCount - 1) / L::kCount; ++k, ++batch) {
      const auto links = static_cast<size_t>(tree.num_links), shapes = tree.shape_links.size();
      TreeBatch<L> t{};
      t.tree = &tree;
      t.model = arena.make<LinkModel<L>>(links);
      t.state = arena.make<PersistentLink<V>>(links);
      if (tree.looks_ahead) {
        t.trial = arena.make<PersistentLink<V>>(links);
        t.present = arena.make<V>(static_cast<size_t>(tree.num_coords) + links);
      }
      t.work = arena.make<LinkWork<V>>(links);
      t.coord = arena.make<CoordWork<V>>(static_cast<size_t>(tree.num_coords));
      t.mass_matrix = arena.make<V>(tree.path.size());
      t.reduced = arena.make<V>(tree.path.size());
      t.factor = arena.make<V>(tree.path.size());
      t.dv = arena.make<V>(static_cast<size_t>(tree.num_coords));
      t.push = arena.make<V>(static_cast<size_t>(tree.num_coords));
      if (scene_->def.feedforward) t.feedforward = arena.make<V>(links);
      t.shape_p = arena.make<V[3]>(shapes);
      t.shape_a = arena.make<V[3]>(shapes);
      t.center = arena.make<V[3]>(shapes);
      t.axis = arena.make<V[3]>(shapes);
      if (scene_->def.solver.speculative_contacts) t.shape_way = arena.make<V>(shapes);
      if (batches_) batches_[batch] = t;
    }
  }
  in_lanes_ = kSearchesWide && num_groups_ > 0 && !scene_->def.solver.speculative_contacts;
  if (in_lanes_) robot_pairs_.carve(*scene_, arena, group_size_);
  attachments_ = arena.make<Attachment>(scene_->shapes.size());
  half_widths_ = arena.make<double>(scene_->shapes.size());
  body_segment_ = arena.make<int32_t>(static_cast<size_t>(scene_->num_bodies));
  member_segment_ = arena.make<int32_t>(scene_->def.articulations.size());
  first_word_ = arena.make<int32_t>(scene_->def.articulations.size());
  touched_ = arena.make<uint8_t>(scene_->def.articulations.size());
  in_pile_ = arena.make<uint8_t>(static_cast<size_t>(scene_->def.solver.contacts_max));
  if (may_be_extreme()) {
    island_ = arena.make<Island>(static_cast<size_t>(scene_->num_bodies));
    directly_ = arena.make<int32_t>(static_cast<size_t>(scene_->def.solver.contacts_max));
    if (!borrows) direct_.carve(arena, segments);
  }
  path_ = arena.make<S>((scene_->laws.empty() ? 4u : 6u) * static_cast<size_t>(most_coords));
  factor_rows_ = arena.make<const V*>(static_cast<size_t>(most_coords));
  R_JL_ = arena.make<Mat3>(static_cast<size_t>(scene_->num_links));
  q_JL_ = arena.make<Quat>(static_cast<size_t>(scene_->num_links));
  if (borrows) return;
  this->own_points = arena.make<WarmPoint>(static_cast<size_t>(scene_->def.solver.contacts_max));
  contacts_.carve(arena, scene_->def.solver.contacts_max, segments, path, scene_->num_bodies);
  if (!scene_->laws.empty()) contacts_.laws.carve(arena, scene_->def.solver.contacts_max, path);
}

// The constants of each lane's member. They stay: a lane holds the same member in every step.
template <class L>
void BatchStepper<L>::fill_constants(TreeBatch<L>& t, int32_t batch) {
  const SolverDef& solver = scene_->def.solver;
  const Tree& tree = *t.tree;
  t.h = static_cast<S>(solver.h);
  t.inv_h = static_cast<S>(1 / solver.h);
  t.spring_only = solver.spring_only_effort;
  t.limit_law = solver.limit_law.soft() ? &solver.limit_law : nullptr;
  assign(t, batch, group_size_);
  if (tree.free_base)
    for (int k = 0; k < 3; ++k) {
      t.coord[k].s[k] = L::all(1);
      t.coord[3 + k].a[k] = L::all(1);
    }
  const auto put = [](V* v, int lane, double x) { L::set(v, lane, static_cast<S>(x)); };
  for (int l = 0; l < L::kCount; ++l) {
    const TreeMember& m = member_of(t, l);
    const auto put_words = [&](V* to, const auto& record) {
      double from[sizeof record / sizeof(double)];
      std::memcpy(from, &record, sizeof record);
      for (size_t k = 0; k < std::size(from); ++k) put(to + k, l, from[k]);
    };
    put_words(words(static_cast<BaseConstants<V>*>(&t)), base_constants(*model_, m, nullptr));
    for (int r = 0; r < 3; ++r) put(&t.base_com[r], l, m.base.com[r]);
    for (int32_t i = 0; i < tree.num_links; ++i) {
      const MemberLink& link = m.links[static_cast<size_t>(i)];
      const JointDef& joint = link.joint;
      LinkModel<L>& b = t.model[i];
      for (int k = 0; k < 9; ++k) put(&b.R_PJ[k], l, link.R_PJ.m[k]);
      const double q_PJ[4] = {link.q_PJ.w, link.q_PJ.x, link.q_PJ.y, link.q_PJ.z};
      for (int k = 0; k < 4; ++k) put(&b.q_PJ[k], l, q_PJ[k]);
      for (int r = 0; r < 3; ++r) put(&b.p_PJ[r], l, link.p_PJ[r]);
      for (int r = 0; r < 3; ++r) put(&b.com[r], l, link.inertia.com[r]);
      put_words(words(static_cast<LinkConstants<V>*>(&b)), link_constants(*model_, m, i, nullptr));
      put(&b.lower, l, joint.lower);
      put(&b.upper, l, joint.upper);
      put(&b.ratio, l, joint.ratio);
      put(&b.slack, l, joint.slack);
      put(&b.limit_stiffness, l, link.limit_stiffness);
      put(&b.limit_weight, l, link.limit_weight);
      put(&b.limit_time, l, link.limit_time);
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

// Which body, or which link's coordinate, moves each shape, where its rows go, and which sensor feels it.
template <class L>
void BatchStepper<L>::list_attachments() {
  int32_t segment = 0, word = 0;
  for (size_t a = 0; a < scene_->def.articulations.size(); ++a) {
    first_word_[a] = word;
    word += kBase + kLink * static_cast<int32_t>(scene_->def.articulations[a].links.size());
  }
  const Attachment none = {Attachment::kStatic, 0, 0, -1, -1, -1, -1, 0};
  for (size_t i = 0; i < scene_->shapes.size(); ++i) {
    attachments_[i] = none;
    half_widths_[i] = half_width(*scene_, scene_->shapes[i]);
  }
  const auto sensor_of = [&](int32_t link) {
    for (size_t i = 0; i < scene_->sensors.size(); ++i)
      if (scene_->sensors[i] == link) return static_cast<int32_t>(i);
    return -1;
  };
  for (int32_t g = 0; g < num_groups_; ++g) {
    const Tree& tree = *groups_[g].tree;
    for (int32_t m = 0; m < groups_[g].members; ++m, segment += tree.num_segments) {
      const TreeMember& member = tree.members[static_cast<size_t>(m)];
      member_segment_[member.articulation] = segment;
      for (int32_t i = 0; i < tree.num_links; ++i) {
        R_JL_[member.first_link + i] = transpose(member.links[static_cast<size_t>(i)].R_LJ);
        q_JL_[member.first_link + i] = conjugate(member.links[static_cast<size_t>(i)].q_LJ);
      }
      for (size_t k = 0; k < tree.shape_links.size(); ++k) {
        const int32_t link = tree.shape_links[k],
                      coord = link < 0 ? (tree.free_base ? 5 : -1) : tree.coord(link);
        if (coord < 0) continue;  // on a fixed base
        Attachment& at = attachments_[static_cast<size_t>(member.first_shape) + k];
        at.kind = Attachment::kTree;
        at.group = g;
        at.member = m;
        at.coord = coord;
        at.link = link;
        at.sensor = link < 0 ? -1 : sensor_of(member.first_link + link);
        at.first_segment = segment;
      }
    }
  }
  for (int32_t i = 0; i < scene_->num_bodies; ++i) body_segment_[i] = segment++;
  for (size_t i = 0; i < scene_->shapes.size(); ++i) {
    const SceneShape& s = scene_->shapes[i];
    if (s.carrier != Carrier::kBody) continue;
    attachments_[i].kind = Attachment::kBody;
    attachments_[i].body = s.index;
    attachments_[i].first_segment = body_segment_[s.index];
  }
}

}  // namespace
}  // namespace rdm

#include "physics/articulated/link_motion.inl"

namespace rdm {
namespace {

template <class L>
Stepper* make_batches(const StepperKind& kind, const ArticulatedModel& model, Collider* collider,
                      const HostHooks& hooks, Arena& arena) {
  if (arena.measuring()) {
    const BatchStepper<L> measured(kind, model, collider, arena);
    return nullptr;
  }
  return host_new<BatchStepper<L>>(hooks, kind, model, collider, arena);
}

Stepper* make_kind(const StepperKind& kind, const ArticulatedModel& model, Collider* collider,
                   const HostHooks& hooks, Arena& arena) {
  if (kind.double_precision) return make_batches<Simd<double, 1>>(kind, model, collider, hooks, arena);
#if defined(RDM_SIMD_AVX512)
  if (kind.lanes > 8) return make_batches<Simd<float, 16>>(kind, model, collider, hooks, arena);
#endif
  if (kind.lanes >= 8) return make_batches<Simd<float, 8>>(kind, model, collider, hooks, arena);
  if (kind.lanes == 4) return make_batches<Simd<float, 4>>(kind, model, collider, hooks, arena);
  return make_batches<Simd<float, 1>>(kind, model, collider, hooks, arena);
}

StepperTable stepper_table(const char* isa) {
#if defined(RDM_SIMD_AVX512)
  constexpr int32_t kWidest = 16;
#else
  constexpr int32_t kWidest = 8;
#endif
  return {isa, kWidest, make_kind};
}

}  // namespace
}  // namespace rdm
