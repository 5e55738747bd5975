#include "tasks/props/house_scene.hpp"

#include <algorithm>

#include "physics/model/inertia.hpp"

namespace rdm {
namespace {

constexpr Vec3 kBroomStart = {0, -0.5, 1.1}, kTrashStart = {0, -0.9, kTrashRadius}, kPan = {0, -2.9, 0};
constexpr double kChairX = 0.184, kChairY = -1.62;
constexpr double kHandleMass = 0.132, kHeadMass = 1.5, kHandleRadius = 0.02, kHeadAt = -0.8;
constexpr Vec3 kHeadHalf = {0.25, 0.05, 0.3};

ShapeDef shape(const char* name, ShapeKind kind, const Vec3& size, const Vec3& p, int32_t material,
               const uint8_t (&color)[3]) {
  ShapeDef s;
  s.name = name;
  s.kind = kind;
  s.size = size;
  s.X_LS.p = p;
  s.material = material;
  std::copy_n(color, 3, s.color);
  return s;
}

// Moves shapes and start so that the centre of mass is the origin.
void center(BodyDef* body) {
  const Vec3 com = body->inertia.com;
  body->X_WB.p += com;
  body->inertia.com = {};
  for (ShapeDef& s : body->shapes) s.X_LS.p -= com;
}

Inertia at(Inertia part, const Vec3& p) {
  return transformed(part, {p, {}});
}

BodyDef make_broom(const HouseMaterials& m, double sink) {
  constexpr uint8_t kWood[3] = {200, 160, 100}, kBristle[3] = {110, 85, 60};
  BodyDef b;
  b.name = "broom";
  b.X_WB.p = kBroomStart - Vec3{0, 0, sink};
  b.inertia = combined(cylinder_inertia(kHandleMass, kHandleRadius, kHandleHalf),
                       at(box_inertia(kHeadMass, kHeadHalf), {0, 0, kHeadAt}));
  b.shapes.push_back(
      shape("broom_handle", ShapeKind::kCylinder, {kHandleRadius, kHandleHalf, 0}, {}, m.handle, kWood));
  b.shapes.push_back(shape("broom_head", ShapeKind::kBox, kHeadHalf, {0, 0, kHeadAt}, m.head, kBristle));
  for (ShapeDef& s : b.shapes) s.finish = Finish::kWood;
  center(&b);
  return b;
}

BodyDef make_trash(const HouseMaterials& m, double mass, double sink) {
  constexpr uint8_t kGreen[3] = {60, 140, 90};
  BodyDef b;
  b.name = "trash";
  // its axis along x: it rolls along y
  b.X_WB = {kTrashStart - Vec3{0, 0, sink}, axis_angle({0, 1, 0}, 0.5 * kPi)};
  b.inertia = cylinder_inertia(mass, kTrashRadius, kTrashHalf);
  b.shapes.push_back(
      shape("trash", ShapeKind::kCylinder, {kTrashRadius, kTrashHalf, 0}, {}, m.trash, kGreen));
  return b;
}

BodyDef make_chair(const HouseMaterials& m, double mass, double sink) {
  constexpr uint8_t kSteel[3] = {90, 92, 98}, kCloth[3] = {70, 90, 150};
  // parts and their shares of the mass
  struct Part {
    const char* name;
    ShapeKind kind;
    Vec3 size, p;
    double share;
  };
  constexpr Part kParts[] = {
      {"chair_foot", ShapeKind::kCylinder, {0.28, 0.025, 0}, {0, 0, 0.025}, 0.4},
      {"chair_column", ShapeKind::kCylinder, {0.03, 0.2, 0}, {0, 0, 0.225}, 0.1},
      {"chair_seat", ShapeKind::kBox, {0.23, 0.23, 0.025}, {0, 0, 0.45}, 0.3},
      {"chair_back", ShapeKind::kBox, {0.22, 0.02, 0.18}, {0, -0.21, 0.66}, 0.2},
  };
  BodyDef b;
  b.name = "chair";
  b.X_WB.p = {kChairX, kChairY, -sink};
  bool first = true;
  for (const Part& part : kParts) {
    const double kg = part.share * mass;
    const bool box = part.kind == ShapeKind::kBox;
    const Inertia solid =
        at(box ? box_inertia(kg, part.size) : cylinder_inertia(kg, part.size.x, part.size.y), part.p);
    b.inertia = first ? solid : combined(b.inertia, solid);
    first = false;
    b.shapes.push_back(shape(part.name, part.kind, part.size, part.p, m.chair, box ? kCloth : kSteel));
  }
  center(&b);
  return b;
}

void add_dustpan(int32_t material, SceneDef* scene) {
  constexpr uint8_t kRed[3] = {190, 70, 60};
  constexpr double kWide = 0.2, kLong = 0.175, kThin = 0.0025, kWall = 0.03;
  struct Part {
    const char* name;
    Vec3 half, p;
  };
  const Part parts[] = {
      {"pan_floor", {kWide, kLong, kThin}, {0, 0, kThin}},
      {"pan_back", {kWide, kThin, kWall}, {0, -kLong, kWall}},
      {"pan_side_a", {kThin, kLong, kWall}, {-kWide, 0, kWall}},
      {"pan_side_b", {kThin, kLong, kWall}, {kWide, 0, kWall}},
  };
  for (const Part& part : parts)
    scene->statics.push_back(shape(part.name, ShapeKind::kBox, part.half, kPan + part.p, material, kRed));
}

}  // namespace

Vec3 broom_middle() {
  return {0, 0, -kHeadAt * kHeadMass / (kHeadMass + kHandleMass)};
}

void add_house(const HouseDef& house, const HouseMaterials& materials, SceneDef* scene) {
  scene->bodies.push_back(make_broom(materials, house.sink));
  scene->bodies.push_back(make_trash(materials, house.trash_mass, house.sink));
  scene->bodies.push_back(make_chair(materials, house.chair_mass, house.sink));
  add_dustpan(materials.pan, scene);
  for (const int32_t part : {materials.handle, materials.head})
    scene->friction[part][materials.pan].passes = scene->friction[materials.pan][part].passes = true;
}

}  // namespace rdm
