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
// past its bound, which changes M and with it every contact. They are solved in turn; a world is open (not yet
// done) until its sets agree with its contacts' outcome. Rounds 0 and 1 change all contradictions, round 2 only
// the first of each robot, then the damped set is frozen and the contacts are solved once more.
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
  // A set of free bodies that touch each other, stored at the one with the lowest number.
  struct Island {
    int32_t root, points;  // union-find: that body, or one on the way to it; number of contact points
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

// How far the substep moves a shape's place at the velocities that it begins with, of free bodies with gravity's
// part of the substep.
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

// How far every shape may move in this substep, for the collider's search of contacts to come.
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

}  // namespace
}  // namespace rdm

// The members of BatchStepper that are not here: parts of this file.
#include "physics/articulated/contact_impulses.inl"
#include "physics/articulated/contact_rows.inl"
#include "physics/articulated/extreme_masses.inl"
#include "physics/articulated/lanes.inl"
#include "physics/articulated/law_rows.inl"
#include "physics/articulated/link_motion.inl"
#include "physics/articulated/pile_points.inl"
#include "physics/articulated/stepper_memory.inl"

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
