// The world in generalised coordinates: robots as trees of joint coordinates, free bodies beside them, one
// contact solver for all. ODE finds the contact points and nothing else.
//
// The state is the joint coordinates, each link's momentum as it was solved, the drives' sets, the free
// bodies and the last contacts' impulses. The arithmetic is a Stepper's, which steps several worlds at a
// time and is shared by the worlds of one worker.
#pragma once
#include "physics/articulated/stepper.hpp"
#include "physics/articulated/tree.hpp"
#include "physics/collision/narrowphase.hpp"
#include "physics/ode/ode_guard.hpp"
#include "physics/world.hpp"

namespace rdm {

// Constants of a free body.
struct BodyModel {
  double inverse_mass, root_inverse_mass;
  Mat3 moment;             // body axes
  Mat3 inverse;            // of it
  Mat3 inverse_root;       // C^-1 where the moment is C C^T
  double linear, angular;  // factors of implicit damping
  Vec3 gravity;            // m/s2
};

// What the worlds of one worker share: the model and the working memory of a step.
struct ArticulatedShared {
  Vector<Tree> trees;
  Vector<BodyModel> bodies;
  Collider collider;
  Stepper *alone = nullptr, *group = nullptr;  // for one world and for many; may be the same
  int32_t users = 0;
  HostHooks hooks;
};

// A contact's impulse on a, kept to start the next substep's solve from.
struct WarmPoint {
  int32_t pair;
  float p[3];        // from the bound's centre of shape a, world axes, m
  float impulse[3];  // world, N s
};

class ArticulatedWorld final : public World {
 public:
  ArticulatedWorld(const Scene& scene, Arena& arena, ArticulatedWorld* partner, bool partnered);
  ~ArticulatedWorld() override;

  static size_t heap_bytes(const Scene& scene);

  EngineKind engine() const override { return EngineKind::kArticulated; }
  void step() override;
  int32_t group_size() const override { return shared_->group->group_size(); }
  void set_body(int32_t i, const Motion& m) override;
  void set_base(int32_t articulation, const Motion& m) override;
  void push_body(int32_t i, const Vec3& force, const Vec3& torque) override;
  void push_link(int32_t i, const Vec3& force, const Vec3& p_W) override;
  void push_base(int32_t articulation, const Vec3& force, const Vec3& torque) override;
  double body_overlap(int32_t body) override;
  double joint_drift() const override { return 0; }
  void save(Writer& out) const override;
  void load(Reader& in) override;

  // --- for the stepper. A step is begin_step, then per substep predict_bodies, collide, finish_substep,
  // then end_step.
  const ArticulatedShared& shared() const { return *shared_; }
  void* keep() { return keep_; }  // [articulations] BaseState, then LinkState per link
  const void* keep() const { return keep_; }
  double* q_out() { return q_; }
  double* qd_out() { return qd_; }
  double* torque_out() { return torque_; }
  Motion& base_out(int32_t articulation) { return bases_[articulation]; }
  const Mat3& base_R(int32_t articulation) const { return base_R_[articulation]; }
  Mat3& base_R_out(int32_t articulation) { return base_R_[articulation]; }
  bool pushed() const { return pushed_; }
  const Wrench& link_push(int32_t i) const { return pushes_[i]; }  // torque about the link's centre of mass
  const Wrench& base_push(int32_t articulation) const { return pushes_[scene_->num_links + articulation]; }

  struct Body {
    Mat3 R, whitener;  // whitener = C^-1 R^T: world to whitened angular coordinates
    Vec3 v, w;         // predicted, without contacts
    Vec3 v1, w1;       // with them
  };
  Body& moving_body(int32_t i) { return moving_[i]; }
  const Body& moving_body(int32_t i) const { return moving_[i]; }

  void begin_step();
  void predict_bodies();
  void collide(Collider::Poses& poses);  // after the bounds of all that moves are set
  Contact* contacts_out() { return contacts_; }
  const int32_t* contact_pairs() const { return contact_pairs_; }
  // Impulse on shape a that the last substep gave at a point like this one; false: none.
  bool warm_impulse(int32_t contact, Vec3* impulse) const;
  Vec3& impulse(int32_t contact) { return impulses_[contact]; }
  void keep_impulses();
  Wrench& sensor_out(int32_t i) { return sensors_[i]; }
  int32_t sensor_of_link(int32_t link) const { return sensor_of_link_[link]; }
  void move_bodies();  // by v1, w1
  void mark_diverged() { diverged_ = true; }
  void end_step();

 private:
  void links_changed(int32_t articulation) override;
  void step_group(World* const* worlds, int32_t count) override;
  void fetch_link(int32_t i) const override;
  void make_shared(Arena& arena, ArticulatedWorld* partner, bool partnered);
  void release_shared();
  void set_body_bounds();
  void recover();

  OdeGuard guard_;
  ArticulatedShared* shared_ = nullptr;
  unsigned char* keep_ = nullptr;
  Body* moving_ = nullptr;
  Wrench* pushes_ = nullptr;  // links, bases, bodies
  int32_t* contact_pairs_ = nullptr;
  Vec3* impulses_ = nullptr;
  WarmPoint *warm_ = nullptr, *next_ = nullptr;  // of the last substep and of this one
  int32_t* sensor_of_link_ = nullptr;
  Motion* good_bodies_ = nullptr;  // at the step's start
  Motion* good_bases_ = nullptr;
  int32_t num_warm_ = 0;
  bool pushed_ = false, diverged_ = false;
};

}  // namespace rdm
