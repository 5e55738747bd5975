#include "tasks/legged/walker_scene.hpp"

#include <cmath>
#include <utility>

#include "physics/model/inertia.hpp"

namespace rdm {
namespace {

constexpr double kFreely = 1e4;  // rad, m: the range of what has no limit
constexpr int32_t kContactsMax = 48;
// No motor here, and no leg that swings, reaches this far beyond a joint's end. Past it the engine stops a
// joint without a reaction, which is a push from nowhere.
constexpr double kStopMargin = 0.1;     // rad
constexpr double kTimeConstant = 0.02;  // s, of solref

ShapeDef make_shape(const char* name, ShapeKind kind, const Vec3& size, const Pose& X, int32_t material,
                    Color color) {
  ShapeDef s;
  s.name = name;
  s.kind = kind;
  s.size = size;
  s.X_LS = X;
  s.material = material;
  s.color[0] = color.red, s.color[1] = color.green, s.color[2] = color.blue;
  return s;
}

void weigh(const Inertia& part, const Pose& X, Inertia* whole) {
  const Inertia placed = transformed(part, X);
  *whole = whole->mass > 0 ? combined(*whole, placed) : placed;
}

Inertia& inertia_of(ArticulationDef* robot, int32_t link) {
  return link < 0 ? robot->base : robot->links[static_cast<size_t>(link)].inertia;
}

}  // namespace

void make_walkable(PlanarScene& scene, double h, int32_t substeps, double limb_mu, double foot_mu) {
  SceneDef& def = scene.def();
  def.gravity = {0, 0, -9.81};
  def.solver = {};
  def.solver.h = h;
  def.solver.substeps = substeps;
  def.solver.contacts_max = kContactsMax;
  def.solver.spring_only_effort = true;
  def.solver.limit_margin = kStopMargin;
  def.feedforward = true;
  def.num_materials = 3;
  for (const auto& [material, mu] : {std::pair{kLimbMaterial, limb_mu}, std::pair{kFootMaterial, foot_mu}})
    def.friction[kFloorMaterial][material].mu = def.friction[material][kFloorMaterial].mu = mu;
  def.friction[kFloorMaterial][kFloorMaterial].passes = true;  // what a task moves along the floor
  for (ShapeDef& s : def.statics) s.collides = s.kind == ShapeKind::kPlane;
}

void soften(const MujocoContact& contact, PlanarScene& scene) {
  SceneDef& def = scene.def();
  ContactLaw law;
  law.time_constant = kTimeConstant;
  def.solver.limit_law = law;
  law.impedance_min = contact.impedance_min;
  law.impedance_max = contact.impedance_max;
  law.impedance_width = contact.width;
  law.pyramid = true;
  law.margin = contact.margin;
  for (const int32_t material : {kLimbMaterial, kFootMaterial})
    def.laws[kFloorMaterial][material] = def.laws[material][kFloorMaterial] = law;
  for (ArticulationDef& robot : def.articulations)
    for (ArticulationShape& shape : robot.shapes) shape.shape.size.x += contact.margin;
}

LinkDef hinged_link(const char* name, int32_t parent, const Vec3& at, const Vec3& axis,
                    const MotorJoint* joint) {
  LinkDef link;
  link.name = link.joint.name = name;
  link.parent = parent;
  link.X_PL.p = at;
  link.joint.axis = axis;
  link.joint.lower = joint ? joint->lower : -kFreely;
  link.joint.upper = joint ? joint->upper : kFreely;
  if (joint) {
    link.joint.kd = joint->damping;
    link.joint.effort = joint->gear;
    link.joint.armature = joint->armature;
  }
  return link;
}

LinkDef slide_link(const char* name, int32_t parent, const Vec3& axis) {
  LinkDef link = hinged_link(name, parent, {}, axis, nullptr);
  link.joint.kind = JointKind::kPrismatic;
  return link;
}

void add_capsule(const char* name, const Vec3& p, const Vec3& q, double radius, double density,
                 int32_t material, Color color, int32_t link, ArticulationDef* robot) {
  const Vec3 along = q - p;
  const double length = norm(along), half = 0.5 * length;
  // turns z to the capsule's axis
  const Vec3 to = (1 / length) * along, side = cross({0, 0, 1}, to);
  const double sine = norm(side);
  const Quat turn = sine > 0 ? axis_angle((1 / sine) * side, elementary::atan2(sine, to.z)) : Quat{};
  const Pose X{0.5 * (p + q), turn};
  const double mass = density * kPi * radius * radius * (length + 4 * radius / 3);
  weigh(capsule_inertia(mass, radius, half), X, &inertia_of(robot, link));
  robot->shapes.push_back(
      {link, make_shape(name, ShapeKind::kCapsule, {radius, half, 0}, X, material, color)});
}

void add_sphere(const char* name, double radius, double density, Color color, int32_t link,
                ArticulationDef* robot) {
  const double mass = density * 4 * kPi / 3 * radius * radius * radius;
  weigh(sphere_inertia(mass, radius), {}, &inertia_of(robot, link));
  robot->shapes.push_back(
      {link, make_shape(name, ShapeKind::kSphere, {radius, 0, 0}, {}, kLimbMaterial, color)});
}

}  // namespace rdm
