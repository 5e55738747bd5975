// One description for every object that can be handled: a plain table, and the body made from it.
#pragma once
#include <cstdint>

#include "base/table.hpp"
#include "physics/model/scene.hpp"

namespace rdm {

struct ObjectShape {
  ShapeKind kind;
  Vec3 size;  // as ShapeDef::size
  Vec3 p;     // in the object's frame, any one
  Quat q;
  uint8_t color[3];
  Table<Vec3> points = {};  // of a hull
  bool collides = true;     // false: only seen
};

// What a surface is, and the coefficient of its friction on dry things.
struct ObjectMaterial {
  const char* name;
  double friction;
};

struct Object {
  const char* name;
  const char* alias;       // another name; null: none. "025_mug" is found as "mug" too, unless that is taken
  const char* help;        // one line: what it is, and where its numbers come from
  const char* shape_text;  // kinds and sizes in m, for people
  ObjectMaterial material;
  double mass;  // kg
  Table<ObjectShape> shapes;
  double moment[6] = {};  // as Inertia::moment, the centre of mass is the origin; zeros: of the shapes, solid
};

inline constexpr int32_t kMaxObjectShapes = 64;

// Mass, centre and moments in the object's frame.
Inertia object_inertia(const Object& object);

// Around what can be touched of it, along the axes of its frame, from the centre of mass, m.
struct ObjectBox {
  Vec3 low, high;
};
ObjectBox object_box(const Object& object);

// The object as the body `name`, its origin at the centre of mass, axes as in the table. mass <= 0: its own;
// moments go along. Sizes are `scale` times as large. Its shapes are called name, name_1, name_2 ...
BodyDef make_object_body(const Object& object, const char* name, const Pose& X_WB, double mass = 0,
                         double scale = 1, int32_t material = 0);

// Error(kArgument) or Error(kRange) for what no body could be made of, with the name of the row.
void check_object(const Object& object);

}  // namespace rdm
