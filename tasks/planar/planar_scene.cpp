#include "tasks/planar/planar_scene.hpp"

#include <algorithm>

#include "base/elementary.hpp"
#include "physics/model/inertia.hpp"

namespace rdm {
namespace {

constexpr double kWallHalfHeight = 0.1, kWallHalfWidth = 0.02, kDiscHalfHeight = 0.005;  // m

ShapeDef make_shape(const char* name, ShapeKind kind, const Vec3& size, Color color, const Pose& X) {
  ShapeDef s;
  s.name = name;
  s.kind = kind;
  s.size = size;
  s.X_LS = X;
  s.color[0] = color.red, s.color[1] = color.green, s.color[2] = color.blue;
  s.collides = false;
  return s;
}

}  // namespace

PlanarScene::PlanarScene(double control_dt) {
  // a scene's substep is at most 0.1 s long
  def_.solver.substeps = control_dt > 0.1 ? 10 : 1;
  def_.solver.h = control_dt / def_.solver.substeps;
  def_.solver.contacts_max = 1;
  def_.gravity = {};
  mark("floor", ShapeKind::kPlane, {}, {190, 195, 200}, {});
}

PlanarScene& PlanarScene::body(const char* name, ShapeKind kind, const Vec3& size, Color color,
                               const Pose& X_LS) {
  BodyDef b;
  b.name = name;
  b.inertia = sphere_inertia(1, 1);  // nothing ever weighs it
  b.gravity = false;
  def_.bodies.push_back(b);
  return shape(name, kind, size, color, X_LS);
}

PlanarScene& PlanarScene::shape(const char* name, ShapeKind kind, const Vec3& size, Color color,
                                const Pose& X_LS) {
  def_.bodies.back().shapes.push_back(make_shape(name, kind, size, color, X_LS));
  return *this;
}

PlanarScene& PlanarScene::mark(const char* name, ShapeKind kind, const Vec3& size, Color color,
                               const Pose& X_WS) {
  def_.statics.push_back(make_shape(name, kind, size, color, X_WS));
  return *this;
}

PlanarScene& PlanarScene::disc(const char* name, double radius, Color color, double x, double y) {
  return mark(name, ShapeKind::kCylinder, {radius, kDiscHalfHeight, 0}, color, {{x, y, 0}, {}});
}

PlanarScene& PlanarScene::wall(const char* name, Color color, double x0, double y0, double x1, double y1) {
  const Vec3 half{0.5 * std::max(std::fabs(x1 - x0), 2 * kWallHalfWidth),
                  0.5 * std::max(std::fabs(y1 - y0), 2 * kWallHalfWidth), kWallHalfHeight};
  return mark(name, ShapeKind::kBox, half, color, {{0.5 * (x0 + x1), 0.5 * (y0 + y1), kWallHalfHeight}, {}});
}

Motion planar_motion(const Vec3& p, double yaw, double vx, double vy, double rate) {
  return {{p, axis_angle({0, 0, 1}, yaw)}, {vx, vy, 0}, {0, 0, rate}};
}

PlanarTask::PlanarTask(Scene&& scene, int32_t max_steps, std::initializer_list<FieldSpec> fields)
    : scene_(std::move(scene)), max_steps_(max_steps) {
  for (const FieldSpec& f : fields) add(f);
}

void PlanarTask::add(const FieldSpec& f) {
  add_field(fields_, nullptr, f.name.text, f.unit, f.count, f.low, f.high);
}

void PlanarTask::hold_action(float* action) const {
  std::fill_n(action, action_dim(), 0.0f);
}
void PlanarTask::initial_mean(float* action) const {
  std::fill_n(action, action_dim(), 0.0f);
}

}  // namespace rdm
