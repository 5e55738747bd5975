// One simulated world: joint coordinates and free bodies as state, behind one interface for all engines.
//
// Tasks read and write this class and never learn which engine moves it. The joint coordinates are the
// state of every articulation; link poses and velocities follow from them by forward kinematics.
#pragma once
#include <cstdint>
#include <limits>

#include "base/arena.hpp"
#include "base/bytes.hpp"
#include "physics/limits.hpp"
#include "physics/model/dynamics.hpp"
#include "physics/model/scene.hpp"

namespace rdm {

enum class EngineKind : int32_t { kOde = 0, kArticulated = 1, kKinematic = 2 };

// Degraded steps raise bits, they neither fail nor hide.
enum : uint32_t {
  kStatusContactOverflow = 1u,  // more contacts than contacts_max: the last ones were left out
  kStatusDiverged = 2u,         // a value is not finite, or the engine gave up; reset the world
  kStatusUnconverged = 16u,     // contacts were not solved: contact_solver.inl; not saved with a state
  kStatusSlowed = 32u,          // a free body spun faster than the engine follows: limits.hpp; not saved
};

struct Motion {
  Pose X;     // pose in the world, of the link's (joint) frame or of the body's centre of mass
  Vec3 v, w;  // velocity of that origin, angular velocity; world axes; m/s, rad/s
};

struct Contact {
  int32_t shape_a, shape_b;  // indices of Scene::shapes
  Vec3 p, n;                 // point; unit normal from b into a; world
  double depth;              // m; < 0, in a substep only: yet to come, so far along n
  Vec3 force;                // on a, N, world
  Vec3 gap;                  // of one to come: from p, which is on a, to the point of b as it is now
};

struct Wrench {
  Vec3 force, torque;
};

// A shape of a body in a world where the body has a size of its own.
struct SizedShape {
  Vec3 size;  // as ShapeDef::size
  Vec3 p;     // place in the body's frame
  double size_factor = 1;
  const Hull* hull = nullptr;
};

class World {
 public:
  // Arrays come out of `arena` (or are only measured); the engine's own memory is the C library's.
  // `scene` must outlive the world. Error(kUnsupported) for an engine this build has not.
  // `partner`, of the same scene, lends the solver's working memory (half of what an engine takes): the two
  // worlds must then never step at the same time. `together`: how many worlds that memory is for, 0: any
  // number; more or fewer of them step to the same bytes, but slower.
  static World* create(EngineKind kind, const Scene& scene, Arena& arena, const HostHooks& hooks,
                       World* partner = nullptr, int32_t together = 0);
  // What create carves, without or with a partner.
  static void measure(EngineKind kind, const Scene& scene, Arena& arena, bool partnered = false,
                      int32_t together = 0);
  // Bytes of the world itself. With a partner create takes no others from the hooks.
  static size_t object_bytes(EngineKind kind);
  // Bytes that the engine allocates by itself for one world, an estimate from above.
  static size_t engine_bytes(EngineKind kind, const Scene& scene, bool partnered = false);
  static void destroy(World* world, const HostHooks& hooks);
  virtual ~World() = default;

  const Scene& scene() const { return *scene_; }
  virtual EngineKind engine() const = 0;
  // The name that whoever made it gives it, no part of its state; -1 at first.
  int32_t number() const { return number_; }
  void set_number(int32_t number) { number_ = number; }

  // One control step: solver.substeps substeps towards `target`. Clears and sets status, contacts,
  // torques, wrenches. Never throws.
  virtual void step() = 0;
  // The same for `count` worlds that share working memory (see create), together where the engine gains
  // from it: the bytes are those of stepping each alone.
  static void step_together(World* const* worlds, int32_t count);
  // From now on this world works in the memory of `lender` (a world of the same scene that lends), which no
  // other world may then do at the same time. Worlds of an engine that does not lend keep to their own.
  virtual bool lends() const { return false; }
  virtual void borrow(const World&) {}
  // The number of worlds that are best stepped together.
  virtual int32_t group_size() const { return 1; }

  // Joint coordinates, [num_links], rad and rad/s (m, m/s). target is what the drives go for.
  const double* q() const { return q_; }
  const double* qd() const { return qd_; }
  double* target() { return target_; }
  const double* target() const { return target_; }
  // Torque added to each drive's spring, N m (N), [num_links]; it lasts until it is written again:
  //   torque = clamp(kp (target - q) - kd qd + feedforward, +-effort)
  // Null unless the scene asks for it. A step takes one that is not finite or beyond kFeedforwardBound for 0
  // and marks the world.
  double* feedforward() { return feedforward_; }
  const double* feedforward() const { return feedforward_; }
  // Drive torque (with the limit spring) by the drive law at the end of each substep, their mean, N m.
  const double* torque() const { return torque_; }

  // Sets all joint coordinates of one articulation and rebuilds its links. Values are clamped to range.
  // Error(kArgument) for a value that is not finite, a rate beyond kRateBound.
  void set_joints(int32_t articulation, const double* q, const double* qd);
  // The same of all articulations, [num_links], but as they are, and with q the drives' targets; null: these
  // stay. NaN of a coupled joint is what the other one leads it to. Error(kRange) for what no world can have,
  // with the joint's name: beyond a range by more than its ends give way, a rate beyond kRateBound;
  // Error(kArgument) for what is not finite. Nothing has changed then.
  void place_joints(const double* q, const double* qd);

  // Factors on the scene's constants that hold in this world alone, all 1 at first; null unless the scene is
  // adjustable.
  const Dynamics* dynamics() const { return scene_->def.adjustable ? &dynamics_ : nullptr; }
  // A copy of them in this world's memory, to be changed and given to set_dynamics. Only of adjustable
  // scenes.
  Dynamics& edit_dynamics();
  // From the next step on; joints, bases and bodies keep their places and velocities. Error(kState) where the
  // scene is not adjustable, else as Dynamics::check; the world then stays as it was.
  void set_dynamics(const Dynamics& dynamics);

  const Motion& link(int32_t i) const {  // [num_links]
    if (!fresh_[i]) read_link(i, &links_[i]), fresh_[i] = 1;
    return links_[i];
  }
  // The same for any number of threads that only look.
  Motion peek_link(int32_t i) const {
    if (fresh_[i]) return links_[i];
    Motion m;
    read_link(i, &m);
    return m;
  }
  const Motion& base(int32_t articulation) const { return bases_[articulation]; }
  const Motion& body(int32_t i) const { return bodies_[i]; }  // [num_bodies]
  // Error(kArgument) for a motion that is not finite or beyond kStateBound, or has no unit quaternion.
  virtual void set_body(int32_t i, const Motion& m) = 0;
  // Moves a free base; its links follow with their joint coordinates. Error(kState) for a fixed base.
  virtual void set_base(int32_t articulation, const Motion& m) = 0;
  Pose shape_pose(int32_t shape) const;
  // As ShapeDef::size and Scene::hull_of, in this world.
  Vec3 shape_size(int32_t shape) const;
  const Hull* shape_hull(int32_t shape) const;

  // Acts during the next step only; world axes; at the centre of mass of the body, or at p of the link.
  virtual void push_body(int32_t i, const Vec3& force, const Vec3& torque) = 0;
  virtual void push_link(int32_t i, const Vec3& force, const Vec3& p_W) = 0;
  // On a free base, at its centre of mass. Error(kState) for a fixed base.
  virtual void push_base(int32_t articulation, const Vec3& force, const Vec3& torque) = 0;

  // Contacts of the last substep; pair_touched is the OR over all substeps of the last step.
  const Contact* contacts() const { return contacts_; }
  int32_t num_contacts() const { return num_contacts_; }
  bool pair_touched(int32_t pair) const { return touched_[pair] != 0; }  // index of Scene::pairs
  // Contact force and torque about the link's origin, in the link's frame, mean over the substeps.
  const Wrench& sensor(int32_t i) const { return sensors_[i]; }  // index of Scene::sensors

  // Depth of the deepest overlap at the present poses between a body's shapes and everything it may
  // touch, m; 0 when clear. Used to redraw bad start poses.
  virtual double body_overlap(int32_t body) = 0;

  uint32_t status() const { return status_; }
  // Largest distance between the two sides of any joint, m: 0 by construction where links are rebuilt.
  virtual double joint_drift() const = 0;
  // What the velocity of a contact point along its normal was still wrong by as the last sweep of the last
  // step came to it, m/s: the largest of all, 0 without contacts; NaN where the engine does not measure it.
  virtual double solver_residual() const { return std::numeric_limits<double>::quiet_NaN(); }

  // The whole state, exact to the bit: a world that loads it goes on as the one that saved it. Torques,
  // sensors and status are in it; contacts are not (none after load), nor are pushes not yet acted on. Its
  // size is the scene's.
  virtual void save(Writer& out) const = 0;
  // Reads a state without taking any of it. Error(kFormat) where a number is not finite or out of its range.
  virtual void check(Reader& in) const = 0;
  // Of bytes that check has passed, or that a world of the same scene saved.
  virtual void take(Reader& in) = 0;
  // Both; where check fails the world stays as it was.
  void load(Reader& in) {
    Reader look = in;
    check(look);
    take(in);
  }
  // What load(save(other)) does, as plain memory: `other` is a world of the same engine and of an equal
  // scene.
  virtual void copy(const World& other) = 0;

 protected:
  World(const Scene& scene, Arena& arena);
  void carve(Arena& arena);
  // Forward kinematics of one articulation: links_ from q_, qd_ and bases_.
  void rebuild(int32_t articulation);
  // Where an engine makes links_[i] only when asked (fresh_[i] is 0): what it then is.
  virtual void read_link(int32_t, Motion*) const {}
  // Called after q_, qd_ or bases_ changed outside of step.
  virtual void links_changed(int32_t articulation) = 0;
  // Called after dynamics_ changed.
  virtual void dynamics_changed() {}
  // The sizes of shapes by dynamics_.
  void size_shapes();
  // Null where the shape has the scene's own size.
  const SizedShape* sized(int32_t shape) const {
    const int32_t i = shape - scene_->first_body_shape;
    return sized_ && i >= 0 && i < scene_->num_body_shapes ? sized_ + i : nullptr;
  }
  virtual void step_group(World* const* worlds, int32_t count);
  // What set_body and set_base take, with a unit quaternion; the text of the error begins with `call`.
  static Motion checked_motion(const char* call, int32_t index, const Motion& m);
  // A motion of a loaded state.
  static bool sound(const Motion& m);
  // A joint of a loaded state is within its range, or beyond it by what its ends give way.
  static bool sound_joint(const JointDef& joint, const SolverDef& solver, double q);
  // What a scene asks for beside them, saved behind everything else.
  void save_extras(Writer& out) const;
  void load_extras(Reader& in);
  static bool sound_extras(Reader& in, const Scene& scene);
  // The rows in which every engine's state agrees, bases and bodies, and what the scene asks for; true:
  // factors of dynamics_ changed, sizes of shapes with them.
  bool copy_rows(const World& other);
  // What a state keeps of the status.
  static uint32_t saved_status(uint32_t status) { return status & ~(kStatusUnconverged | kStatusSlowed); }
  // Reads status, q, qd, target, torque and sensors, in which every engine's state agrees; false where one
  // of them is not finite or out of range.
  static bool sound_rows(Reader& in, const Scene& scene);

  const Scene* scene_;
  double *q_ = nullptr, *qd_ = nullptr, *target_ = nullptr, *torque_ = nullptr;
  Motion *links_ = nullptr, *bases_ = nullptr, *bodies_ = nullptr;
  Mat3 *link_R_ = nullptr, *base_R_ = nullptr;  // R_WL and R_WB of the poses above
  Vec3* axes_ = nullptr;                        // joint axes, world
  Contact* contacts_ = nullptr;
  Wrench* sensors_ = nullptr;
  uint8_t *touched_ = nullptr, *fresh_ = nullptr;
  double* feedforward_ = nullptr;
  Dynamics dynamics_, edited_;
  SizedShape* sized_ = nullptr;  // [num_body_shapes]
  Hull* hulls_ = nullptr;        // of those that are hulls, in order
  int32_t num_contacts_ = 0, number_ = -1;
  uint32_t status_ = 0;
};

}  // namespace rdm
