// A world without physics: free bodies stand where the task puts them, and nothing else moves.
//
// For tasks that compute their motion themselves. Pictures, poses, saved states and pools come for free.
#pragma once
#include "physics/world.hpp"

namespace rdm {

class KinematicWorld final : public World {
 public:
  // Error(kUnsupported) for a scene with articulations, or an adjustable one.
  KinematicWorld(const Scene& scene, Arena& arena);

  EngineKind engine() const override { return EngineKind::kKinematic; }
  void step() override {}
  bool lends() const override { return true; }
  void set_body(int32_t i, const Motion& m) override { bodies_[i] = m; }
  // Error(kUnsupported): there is no mass that a force could move.
  void set_base(int32_t articulation, const Motion& m) override;
  void push_body(int32_t i, const Vec3& force, const Vec3& torque) override;
  void push_link(int32_t i, const Vec3& force, const Vec3& p_W) override;
  void push_base(int32_t articulation, const Vec3& force, const Vec3& torque) override;
  double body_overlap(int32_t) override { return 0; }
  double joint_drift() const override { return 0; }
  void save(Writer& out) const override;
  void check(Reader& in) const override;
  void take(Reader& in) override;
  void copy(const World& other) override { copy_rows(other); }

 private:
  void links_changed(int32_t) override {}
};

}  // namespace rdm
