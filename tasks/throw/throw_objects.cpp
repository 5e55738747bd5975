#include "tasks/throw/throw_objects.hpp"

#include <charconv>
#include <cstring>

#include "base/error.hpp"
#include "base/option.hpp"
#include "base/text.hpp"
#include "physics/model/inertia.hpp"

namespace rdm {
namespace {

// egg: mass and moments of the ellipsoid 0.03, 0.03, 0.04 m at 500 kg/m3, seen and touched as a capsule.
// From cracker_box on: sizes and masses that the YCB set publishes.
constexpr ThrowObject kObjects[] = {
    {"egg",
     "capsule r 0.03, straight part 0.02",
     ShapeKind::kCapsule,
     {0.03, 0.01, 0},
     0.0754,
     {3.77e-5, 3.77e-5, 2.71e-5},
     {240, 225, 190}},
    {"ball", "sphere r 0.0333", ShapeKind::kSphere, {0.0333, 0, 0}, 0.0754, {}, {220, 80, 60}},
    {"heavy_ball", "sphere r 0.0375", ShapeKind::kSphere, {0.0375, 0, 0}, 0.25, {}, {120, 60, 60}},
    {"cube", "box 0.05 x 0.05 x 0.05", ShapeKind::kBox, {0.025, 0.025, 0.025}, 0.071, {}, {90, 150, 90}},
    {"cracker_box", "box 0.16 x 0.21 x 0.06", ShapeKind::kBox, {0.08, 0.105, 0.03}, 0.411, {}, {200, 40, 40}},
    {"soup_can",
     "cylinder r 0.033, h 0.101",
     ShapeKind::kCylinder,
     {0.033, 0.0505, 0},
     0.349,
     {},
     {210, 60, 50}},
    {"mustard_bottle",
     "box 0.058 x 0.095 x 0.19",
     ShapeKind::kBox,
     {0.029, 0.0475, 0.095},
     0.603,
     {},
     {230, 190, 40}},
    {"potted_meat_can",
     "box 0.05 x 0.097 x 0.082",
     ShapeKind::kBox,
     {0.025, 0.0485, 0.041},
     0.37,
     {},
     {60, 80, 160}},
    {"mug", "cylinder r 0.04, h 0.081", ShapeKind::kCylinder, {0.04, 0.0405, 0}, 0.118, {}, {200, 50, 50}},
    {"baseball", "sphere r 0.0375", ShapeKind::kSphere, {0.0375, 0, 0}, 0.148, {}, {235, 235, 230}},
    {"tennis_ball", "sphere r 0.033", ShapeKind::kSphere, {0.033, 0, 0}, 0.058, {}, {200, 220, 60}},
    {"foam_brick",
     "box 0.05 x 0.075 x 0.05",
     ShapeKind::kBox,
     {0.025, 0.0375, 0.025},
     0.028,
     {},
     {180, 60, 60}},
    {"rubiks_cube",
     "box 0.057 x 0.057 x 0.057",
     ShapeKind::kBox,
     {0.0285, 0.0285, 0.0285},
     0.094,
     {},
     {60, 120, 200}},
    {"ellipsoid_egg",
     "ellipsoid 0.03 x 0.03 x 0.04 (half axes)",
     ShapeKind::kEllipsoid,
     {0.03, 0.03, 0.04},
     0.0754,
     {},
     {240, 225, 190}},
    {"hull", "convex hull of the points of option hull", ShapeKind::kHull, {}, 0.0286, {}, {150, 140, 200}},
};
constexpr int32_t kCount = sizeof kObjects / sizeof *kObjects;

}  // namespace

int32_t throw_object_count() {
  return kCount;
}

const ThrowObject& throw_object_at(int32_t index) {
  if (index < 0 || index >= kCount) fail(Code::kRange, "object: %d is outside [0, %d)", index, kCount);
  return kObjects[index];
}

const ThrowObject& throw_object_named(const char* name) {
  const char* names[kCount];
  for (int32_t i = 0; i < kCount; ++i) {
    if (same_name(kObjects[i].name, name)) return kObjects[i];
    names[i] = kObjects[i].name;
  }
  fail(Code::kNotFound, "object %s: unknown%s", Quoted(name).text, Nearest(name, names, kCount).text);
}

const char* throw_object_choices() {
  struct Text {
    char text[kCount * kNameSize] = "";
    Text() {
      for (const ThrowObject& o : kObjects) {
        if (*text) std::strcat(text, "|");
        std::strcat(text, o.name);
      }
    }
  };
  static const Text choices;
  return choices.text;
}

Vec3 solid_moment(ShapeKind kind, const Vec3& size, double mass) {
  const auto principal = [](const Inertia& i) { return Vec3{i.moment[0], i.moment[1], i.moment[2]}; };
  switch (kind) {
    case ShapeKind::kSphere:
      return principal(sphere_inertia(mass, size.x));
    case ShapeKind::kBox:
      return principal(box_inertia(mass, size));
    case ShapeKind::kCylinder:
      return principal(cylinder_inertia(mass, size.x, size.y));
    case ShapeKind::kCapsule:
      return principal(capsule_inertia(mass, size.x, size.y));
    case ShapeKind::kEllipsoid:
      return principal(ellipsoid_inertia(mass, size));
    case ShapeKind::kHull:
    case ShapeKind::kPlane:
      break;
  }
  fail(Code::kInternal, "no moment by sizes alone");
}

Vector<Vec3> hull_points_from(const char* text) {
  Vector<Vec3> points;
  const char *at = text, *end = text + std::strlen(text);
  while (at < end) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) {
      while (*at == ' ' || *at == '+') ++at;
      const auto [stop, error] = std::from_chars(at, end, p[k]);
      if (error != std::errc() || (k < 2 ? *stop != ',' : *stop != ';' && *stop != '\0'))
        fail(Code::kArgument, "hull: point %d is not x,y,z with ';' between points",
             static_cast<int>(points.size()));
      at = stop < end ? stop + 1 : end;
    }
    points.push_back(p);
  }
  return points;
}

BodyDef make_throw_body(const ThrowObject& object, double mass, double rolling_damping, int32_t material,
                        const Pose& X_WB, const char* hull_text) {
  BodyDef body;
  body.name = "object";
  body.X_WB = X_WB;
  body.angular_damping = rolling_damping;
  ShapeDef shape;
  body.inertia.mass = mass > 0 ? mass : object.mass;
  if (object.kind == ShapeKind::kHull) {
    shape.points = hull_points_from(hull_text);
    const Hull hull = make_hull(shape.points.data(), static_cast<int32_t>(shape.points.size()), "hull");
    body.inertia = hull_inertia(mass > 0 ? mass : kHullDensity * hull.volume, hull);
    body.inertia.com = {};
    for (Vec3& p : shape.points) p -= hull.com;
  } else {
    Vec3 moment = object.moment;
    if (dot(moment, moment) == 0) moment = solid_moment(object.kind, object.size, object.mass);
    for (int i = 0; i < 3; ++i) body.inertia.moment[i] = moment[i] * body.inertia.mass / object.mass;
  }
  shape.name = "object";
  shape.kind = object.kind;
  shape.size = object.size;
  shape.material = material;
  std::memcpy(shape.color, object.color, sizeof shape.color);
  body.shapes.push_back(shape);
  return body;
}

}  // namespace rdm
