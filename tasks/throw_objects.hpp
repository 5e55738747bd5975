// Objects that the throw tasks take by `object=`: primitives with uniform mass.
#pragma once
#include "physics/scene.hpp"

namespace rdm {

struct ThrowObject {
  const char* name;
  const char* shape_text;  // kind and sizes in m, for people
  ShapeKind kind;
  Vec3 size;    // as ShapeDef::size
  double mass;  // kg
  Vec3 moment;  // kg m2 about x, y, z; zero: that of the uniform solid
  uint8_t color[3];
};

int32_t throw_object_count();
const ThrowObject& throw_object_at(int32_t index);
// Error(kNotFound) with the nearest name.
const ThrowObject& throw_object_named(const char* name);
// All names in one text, "egg|ball|...": the choices of the option.
const char* throw_object_choices();

// Principal moments of a uniform solid of this mass, kg m2.
Vec3 solid_moment(ShapeKind kind, const Vec3& size, double mass);

// The body `object` at X_WB. mass <= 0: the object's own; its moments scale along.
BodyDef make_throw_body(const ThrowObject& object, double mass, double rolling_damping, int32_t material,
                        const Pose& X_WB);

}  // namespace rdm
