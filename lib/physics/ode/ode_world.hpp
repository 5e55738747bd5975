// The world on ODE's QuickStep: contacts and drives are solved there, joint coordinates are kept here.
//
// At most 8 iterations a substep: from the ninth on QuickStep draws from one process-wide seed and
// results would depend on what other worlds and threads do.
#pragma once
#include <ode/ode.h>

#include <memory>

#include "physics/ode/ode_contacts.hpp"
#include "physics/ode/ode_links.hpp"
#include "physics/ode_library/ode_guard.hpp"
#include "physics/world.hpp"

namespace rdm {

class OdeWorld final : public World {
 public:
  // With a measuring arena only the arrays are counted and no ODE object is made.
  OdeWorld(const Scene& scene, Arena& arena, OdeWorld* partner = nullptr);
  ~OdeWorld() override;

  // Heap that one world takes inside ODE, an estimate from above, bytes.
  static size_t heap_bytes(const Scene& scene);

  EngineKind engine() const override { return EngineKind::kOde; }
  void step() override;
  void set_body(int32_t i, const Motion& m) override;
  void set_base(int32_t articulation, const Motion& m) override;
  void push_body(int32_t i, const Vec3& force, const Vec3& torque) override;
  void push_link(int32_t i, const Vec3& force, const Vec3& p_W) override;
  void push_base(int32_t articulation, const Vec3& force, const Vec3& torque) override;
  double body_overlap(int32_t body) override;
  double joint_drift() const override;
  void save(Writer& out) const override;
  void check(Reader& in) const override;
  void take(Reader& in) override;
  void copy(const World& other) override;

 private:
  // One ODE body: what acts on it besides gravity and joints. Damping is brought in before the solver runs,
  //   v <- factor v + push_factor h a.
  // Of links and bases it is implicit, both factors 1 / (1 + h c). A free body flies exactly, v' = a - c v:
  //   v1 = k v0 + h p1 a,  x1 = x0 + h (p1 v0 + h p2 a),  k = e^-hc, p1 = (1 - k) / hc, p2 = (1 - p1) / hc;
  // one that touches something moves by h v1, which its contacts were solved for.
  struct Force {
    dBodyID body;
    double linear, angular, linear_push, angular_push;
    double way;    // p2
    Vec3 gravity;  // N that damping takes from ODE's own gravity
    Vec3 p, v;     // of a free body, as the substep began
    Wrench push;
    bool pushed, touched;
  };

  LinkState state() const {
    return {scene_, q_, qd_, target_, torque_, feedforward_, links_, bases_, link_R_, base_R_, axes_};
  }
  void links_changed(int32_t articulation) override;
  void put_base(int32_t articulation, const Motion& m);
  void make_world(const OdeWorld* partner);
  void make_bodies();
  void make_geoms();
  void make_forces();
  void make_threading();
  void grow_working_memory();
  void prewarm();
  void destroy();
  void set_force(Force* force, dBodyID body, double linear_damping, double angular_damping, double mass,
                 bool gravity, bool flies);
  void add_push(Force& force, const Vec3& f, const Vec3& torque);
  bool substep(double weight);  // false: diverged
  void apply_forces();
  void solve();
  void fly();
  bool read_bodies();
  void add_sensors(double weight);
  void recover();
  void put_back();
  void restart_solver();
  struct BodyState;
  static bool sound_body(const BodyState& state);
  void save_body(Writer& out, dBodyID body) const;
  void load_body(Reader& in, dBodyID body);
  void read_body(int32_t i);

  OdeGuard guard_;
  std::shared_ptr<OdeBlocks> blocks_;  // of all partners
  dWorldID ode_ = nullptr;
  dThreadingImplementationID threading_ = nullptr;
  bool in_solver_ = false;  // also after a throw through it, until it is restarted
  OdeLinks tree_;
  OdeContacts contact_;
  dBodyID* body_ids_ = nullptr;        // [num_bodies]
  dBodyID* heads_ = nullptr;           // [articulations + num_bodies + 1] for grow_working_memory
  int32_t* sensor_of_link_ = nullptr;  // [num_links], -1: none
  // Links (a merged one shares its child's), bases, bodies.
  Force* forces_ = nullptr;
  int32_t num_forces_ = 0;
};

}  // namespace rdm
