#include "tasks/props/bottles.hpp"

#include <algorithm>
#include <cstdio>

#include "physics/model/inertia.hpp"

namespace rdm {
namespace {

constexpr double kTop = 0.337;  // of the table, m
constexpr double kBodyRadius = 0.0395, kNeckRadius = 0.016, kShoulder = 0.08, kHead = 0.1496;

ShapeDef tube(const char* name, const char* part, double radius, double low, double high, int32_t material,
              const uint8_t* color) {
  ShapeDef s;
  char text[kNameSize];
  std::snprintf(text, sizeof text, "%s%s", name, part);
  s.name = text;
  s.kind = ShapeKind::kCylinder;
  s.size = {radius, 0.5 * (high - low), 0};
  s.X_LS.p.z = 0.5 * (high + low);
  s.material = material;
  std::copy_n(color, 3, s.color);
  s.finish = Finish::kGlass;
  return s;
}

}  // namespace

BodyDef make_bottle(const char* name, double mass, int32_t material, const Vec3& p, const uint8_t* color) {
  BodyDef b;
  b.name = name;
  b.X_WB.p = p;
  b.inertia = cylinder_inertia(mass, kBodyRadius, 0.5 * (kBottleFoot + kHead));
  b.shapes.push_back(tube(name, "", kBodyRadius, -kBottleFoot, kShoulder, material, color));
  b.shapes.push_back(tube(name, "_neck", kNeckRadius, kShoulder, kHead, material, color));
  return b;
}

Vec3 bottle_place(int32_t number, double sink) {
  return {0, -0.9 + 0.1 * number, kTop + kBottleFoot - sink};
}

void add_bottles(double mass, double sink, bool fixed, int32_t picked, int32_t other, int32_t table,
                 SceneDef* scene) {
  constexpr uint8_t kGreen[3] = {60, 140, 90}, kGlass[3] = {150, 185, 200}, kWood[3] = {120, 125, 135};
  for (const int32_t number : {2, 4, 1, 3, 5}) {
    char name[kNameSize];
    std::snprintf(name, sizeof name, "bottle_%d", number);
    const bool taken = number % 2 == 0;
    BodyDef b =
        make_bottle(name, mass, taken ? picked : other, bottle_place(number, sink), taken ? kGreen : kGlass);
    if (taken || !fixed) {
      scene->bodies.push_back(b);
      continue;
    }
    for (ShapeDef& shape : b.shapes) {
      shape.X_LS = b.X_WB * shape.X_LS;
      scene->statics.push_back(shape);
    }
  }
  ShapeDef top;
  top.name = "table";
  top.kind = ShapeKind::kBox;
  top.size = {0.24, 0.305, 0.01};
  top.X_LS.p = {0.006, -0.595, kTop - 0.01};
  top.material = table;
  std::copy_n(kWood, 3, top.color);
  scene->statics.push_back(top);
}

}  // namespace rdm
