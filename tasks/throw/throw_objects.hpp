// Objects that tasks take by `object=`: primitives and hulls with uniform mass.
#pragma once
#include "physics/model/scene.hpp"

namespace rdm {

struct ThrowObject {
  const char* name;
  const char* shape_text;  // kind and sizes in m, for people
  ShapeKind kind;
  Vec3 size;    // as ShapeDef::size
  double mass;  // kg; hull: of the points that the option begins with
  Vec3 moment;  // kg m2 about x, y, z; zero: that of the uniform solid
  uint8_t color[3];
};

int32_t throw_object_count();
const ThrowObject& throw_object_at(int32_t index);
// Error(kNotFound) with the nearest name.
const ThrowObject& throw_object_named(const char* name);
// All names in one text, "egg|ball|...": the choices of the option.
const char* throw_object_choices();

// A hull's points from text "x,y,z;x,y,z;...", m: at most kMaxHullPoints. Error(kArgument).
inline constexpr int32_t kHullTextSize = 1024;
inline constexpr double kHullDensity = 500;  // kg/m3, that of the egg
Vector<Vec3> hull_points_from(const char* text);

// Principal moments of a uniform solid of this mass, kg m2.
Vec3 solid_moment(ShapeKind kind, const Vec3& size, double mass);

// The body `object` at X_WB. mass <= 0: the object's own; its moments scale along. `hull` is read for an
// object of that kind: its points, as hull_points_from takes them; the body's frame is in their centre of
// mass.
BodyDef make_throw_body(const ThrowObject& object, double mass, double rolling_damping, int32_t material,
                        const Pose& X_WB, const char* hull = "");

}  // namespace rdm
