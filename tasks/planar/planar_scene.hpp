// What tasks without a physics engine share: a floor with marks and bodies that the task places itself.
#pragma once
#include <algorithm>
#include <cstddef>
#include <initializer_list>

#include "base/option.hpp"
#include "env/fields.hpp"
#include "env/task.hpp"

namespace rdm {

struct Color {
  uint8_t red, green, blue;
};
inline constexpr Color kMarkRed{205, 70, 60}, kMarkGreen{70, 165, 90}, kMarkBlue{60, 110, 200},
    kMarkYellow{225, 185, 60}, kMarkGrey{120, 125, 132}, kMarkCyan{70, 180, 190}, kMarkPurple{140, 90, 180};

// Puts a scene together. Nothing in it collides or falls.
class PlanarScene {
 public:
  // A floor at z = 0; control_dt is the simulated time of a control step, s, in [1e-5, 1].
  explicit PlanarScene(double control_dt);
  // A body that the task moves, with its first shape; bodies are numbered from 0 as they come.
  PlanarScene& body(const char* name, ShapeKind kind, const Vec3& size, Color color, const Pose& X_LS = {});
  // One more shape of the body that came last.
  PlanarScene& shape(const char* name, ShapeKind kind, const Vec3& size, Color color, const Pose& X_LS = {});
  // A shape at rest.
  PlanarScene& mark(const char* name, ShapeKind kind, const Vec3& size, Color color, const Pose& X_WS);
  // A flat disc, and a thin wall along x or y between two ends, both at rest.
  PlanarScene& disc(const char* name, double radius, Color color, double x, double y);
  PlanarScene& wall(const char* name, Color color, double x0, double y0, double x1, double y1);
  // Calls f(scene): for parts that are shared.
  template <class F>
  PlanarScene& also(F&& f) {
    f(*this);
    return *this;
  }
  // What it is so far, for parts that an engine moves.
  SceneDef& def() { return def_; }
  Scene build() { return make_scene(std::move(def_)); }

 private:
  SceneDef def_;
};

// A body at (x, y, z), turned by yaw about z, moving at (vx, vy) and turning at `rate`. m, rad, s.
Motion planar_motion(const Vec3& p, double yaw, double vx = 0, double vy = 0, double rate = 0);

// The part of a task that is the same for all of them. Their hold action and first mean are 0.
class PlanarTask : public Task {
 public:
  const Scene& scene() const override { return scene_; }
  EngineKind engine() const override { return EngineKind::kKinematic; }
  int32_t max_steps() const override { return max_steps_; }
  const Vector<FieldSpec>& fields() const override { return fields_; }
  void hold_action(float* action) const override;
  void initial_mean(float* action) const override;
  // Robots' motors come behind the joints that nothing drives, in the order of the action.
  int32_t action_of(int32_t joint) const override {
    return std::max(joint - (scene_.num_links - action_dim()), -1);
  }

 protected:
  PlanarTask(Scene&& scene, int32_t max_steps, std::initializer_list<FieldSpec> fields);
  // One more field of the row; for constructors.
  void add(const FieldSpec& field);

 private:
  Scene scene_;
  int32_t max_steps_;
  FieldTable fields_;
};

}  // namespace rdm
