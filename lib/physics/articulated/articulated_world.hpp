// The world in generalised coordinates: robots as trees of joint coordinates, free bodies beside them, one
// contact solver for all. ODE finds the contact points and nothing else.
//
// The state is the joint coordinates, each link's momentum as it was solved, the drives' active sets, the
// free bodies, which of them sleep, and the last contacts' impulses. The arithmetic is a Stepper's, which
// steps several worlds at a time and is shared by the worlds of one worker: a world hands it its WorldState
// and is never called back.
#pragma once
#include "physics/articulated/sleep.hpp"
#include "physics/articulated/stepper.hpp"
#include "physics/articulated/world_state.hpp"
#include "physics/collision/narrowphase.hpp"
#include "physics/ode_library/ode_guard.hpp"
#include "physics/world.hpp"

namespace rdm {

// What the worlds of one worker share: the model and the working memory of a step.
struct ArticulatedShared {
  ArticulatedModel model;
  Collider collider;
  static constexpr int kSteppers = 3;
  Stepper* steppers[kSteppers] = {};  // the first for one world, the last, of num_steppers, for the most
  int num_steppers = 0;
  int32_t users = 0;
  HostHooks hooks;

  Stepper& alone() const { return *steppers[0]; }
  Stepper& widest() const { return *steppers[num_steppers - 1]; }
  // The narrowest that takes so many worlds together.
  Stepper& fitting(int32_t worlds) const {
    int k = 0;
    while (k + 1 < num_steppers && steppers[k]->group_size() < worlds) ++k;
    return *steppers[k];
  }
};

class ArticulatedWorld final : public World {
 public:
  ArticulatedWorld(const Scene& scene, Arena& arena, ArticulatedWorld* partner, bool partnered,
                   int32_t together);
  ~ArticulatedWorld() override;

  static size_t heap_bytes(const Scene& scene);

  EngineKind engine() const override { return EngineKind::kArticulated; }
  void step() override;
  bool lends() const override { return true; }
  void borrow(const World& lender) override { shared_ = static_cast<const ArticulatedWorld&>(lender).home_; }
  int32_t group_size() const override { return shared_->widest().group_size(); }
  void set_body(int32_t i, const Motion& m) override;
  void set_base(int32_t articulation, const Motion& m) override;
  void push_body(int32_t i, const Vec3& force, const Vec3& torque) override;
  void push_link(int32_t i, const Vec3& force, const Vec3& p_W) override;
  void push_base(int32_t articulation, const Vec3& force, const Vec3& torque) override;
  double body_overlap(int32_t body) override;
  double joint_drift() const override { return 0; }
  double solver_residual() const override { return state_.residual; }
  void save(Writer& out) const override;
  void check(Reader& in) const override;
  void take(Reader& in) override;
  void copy(const World& other) override;

 private:
  void links_changed(int32_t articulation) override;
  void dynamics_changed() override;
  void step_group(World* const* worlds, int32_t count) override;
  void read_link(int32_t i, Motion* out) const override;
  void make_shared(Arena& arena, ArticulatedWorld* partner, bool partnered, int32_t together);
  // state_'s constants and body models by dynamics_; marks articulations of which a mass is another now.
  void own_constants();
  template <class S>
  void own_constants_of(const TreeMember& member);
  void release_shared();
  bool sleeps() const { return scene_->def.solver.sleep_time > 0 && scene_->num_bodies > 0; }
  void carve_sleep(Arena& arena);
  bool sleep_sound(Reader& in, Reader bodies) const;
  int32_t tag() const;
  void end_step();
  void clear_pushes();
  void recover();

  OdeGuard guard_;
  ArticulatedShared* home_ = nullptr;    // kept while this world lives
  ArticulatedShared* shared_ = nullptr;  // worked with: home_, or a lender's
  WorldState state_ = {};                // this world's arrays, as a stepper takes them
  BodyModel* own_models_ = nullptr;      // [num_bodies]
  uint8_t* heavier_ = nullptr;           // [articulations] a mass changed since the momenta were made
};

}  // namespace rdm
