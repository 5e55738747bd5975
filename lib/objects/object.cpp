#include "objects/object.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstring>

#include "base/error.hpp"
#include "base/format.hpp"
#include "base/names.hpp"
#include "base/text.hpp"
#include "physics/collision/convex.hpp"
#include "physics/model/inertia.hpp"

namespace rdm {
namespace {

constexpr double kLeast = 1e-4, kMost = 100;  // m, sizes and places
constexpr double kTriangle = 1 + 1e-6;        // of the triangle rule, for rounded tables

bool has_moment(const Object& o) {
  return std::any_of(o.moment, o.moment + 6, [](double m) { return m != 0; });
}

ShapeDef shape_def(const ObjectShape& row, const char* name, int32_t i) {
  ShapeDef s;
  if (i == 0) {
    s.name = name;
  } else {
    char text[2 * kNameSize], tail[16];
    const int length = std::snprintf(tail, sizeof tail, "_%d", i);
    std::snprintf(text, sizeof text, "%.*s%s", kNameSize - 1 - length, name, tail);
    s.name = text;
  }
  s.kind = row.kind;
  s.size = row.size;
  s.X_LS = {row.p, normalized(row.q)};
  s.collides = row.collides;
  std::copy_n(row.color, 3, s.color);
  s.points.assign(row.points.begin(), row.points.end());
  return s;
}

Vector<ShapeDef> shape_defs(const Object& o, const char* name) {
  Vector<ShapeDef> out;
  for (int32_t i = 0; i < o.shapes.count; ++i) out.push_back(shape_def(o.shapes[i], name, i));
  return out;
}

// A lone primitive in place keeps the bits of its closed form.
bool is_plain(const ShapeDef& s) {
  const Pose& X = s.X_LS;
  return s.kind != ShapeKind::kHull && X.p.x == 0 && X.p.y == 0 && X.p.z == 0 && X.q.x == 0 && X.q.y == 0 &&
         X.q.z == 0;
}

Inertia plain_inertia(const ShapeDef& s, double mass) {
  switch (s.kind) {
    case ShapeKind::kSphere:
      return sphere_inertia(mass, s.size.x);
    case ShapeKind::kBox:
      return box_inertia(mass, s.size);
    case ShapeKind::kCylinder:
      return cylinder_inertia(mass, s.size.x, s.size.y);
    case ShapeKind::kCapsule:
      return capsule_inertia(mass, s.size.x, s.size.y);
    case ShapeKind::kEllipsoid:
      return ellipsoid_inertia(mass, s.size);
    case ShapeKind::kHull:
    case ShapeKind::kPlane:
      break;
  }
  fail(Code::kInternal, "no moment by sizes alone");
}

Inertia inertia_of(const Object& o, const Vector<ShapeDef>& shapes) {
  Inertia out;
  out.mass = o.mass;
  if (has_moment(o))
    std::copy_n(o.moment, 6, out.moment);
  else if (shapes.size() == 1 && is_plain(shapes[0]))
    out = plain_inertia(shapes[0], o.mass);
  else
    out = shapes_inertia(shapes.data(), static_cast<int32_t>(shapes.size()), o.mass);
  return out;
}

Finish finish_of(const ObjectMaterial& material) {
  constexpr struct {
    const char* name;
    Finish finish;
  } kFinishes[] = {{"plastic", Finish::kPlastic}, {"shell", Finish::kPlastic}, {"metal", Finish::kMetal},
                   {"wood", Finish::kWood},       {"glass", Finish::kGlass},   {"rubber", Finish::kRubber},
                   {"leather", Finish::kRubber},  {"felt", Finish::kCloth},    {"foam", Finish::kCloth},
                   {"cardboard", Finish::kCloth}};
  for (const auto& f : kFinishes)
    if (material.name && same_name(f.name, material.name)) return f.finish;
  return Finish::kPaint;
}

}  // namespace

Inertia object_inertia(const Object& object) {
  return inertia_of(object, shape_defs(object, object.name));
}

BodyDef make_object_body(const Object& object, const char* name, const Pose& X_WB, double mass, double scale,
                         int32_t material) {
  BodyDef body;
  body.name = name;
  body.X_WB = X_WB;
  body.shapes = shape_defs(object, name);
  const Inertia own = inertia_of(object, body.shapes);
  body.inertia.mass = mass > 0 ? mass : object.mass;
  for (int i = 0; i < 6; ++i) body.inertia.moment[i] = own.moment[i] * body.inertia.mass / object.mass;
  for (ShapeDef& s : body.shapes) {
    s.material = material;
    s.finish = finish_of(object.material);
    s.X_LS.p -= own.com;
  }
  if (scale != 1) {
    for (ShapeDef& s : body.shapes) {
      s.size = scale * s.size;
      s.X_LS.p = scale * s.X_LS.p;
      for (Vec3& p : s.points) p = scale * p;
    }
    for (double& m : body.inertia.moment) m *= scale * scale;
  }
  return body;
}

ObjectBox object_box(const Object& object) {
  constexpr double kFar = 1e9;  // m, beyond all
  ObjectBox box{{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  const auto hold = [&](const Vec3& p) {
    for (int axis = 0; axis < 3; ++axis) {
      box.low[axis] = std::min(box.low[axis], p[axis]);
      box.high[axis] = std::max(box.high[axis], p[axis]);
    }
  };
  for (const ShapeDef& s : make_object_body(object, object.name, {}).shapes) {
    if (!s.collides) continue;
    for (const Vec3& p : s.points) hold(s.X_LS * p);
    if (s.kind == ShapeKind::kHull) continue;
    const Convex solid{s.kind, s.size, s.X_LS.p, to_matrix(s.X_LS.q), nullptr};
    for (int axis = 0; axis < 3; ++axis)
      for (const double way : {-1.0, 1.0}) {
        Vec3 direction;
        direction[axis] = way;
        hold(farthest(solid, direction));
      }
  }
  return box;
}

namespace {

// Every check of one object: its name in front of each text.
struct Check {
  const Object& object;

  [[gnu::format(printf, 3, 4)]] [[noreturn]] void bad(Code code, const char* format, ...) const {
    char text[kErrorTextSize];
    va_list list;
    va_start(list, format);
    print_list(text, sizeof text, format, list);
    va_end(list);
    fail(code, "object %s: %s", Quoted(object.name ? object.name : "").text, text);
  }
  void within(double value, double low, double high, const char* what) const {
    if (!std::isfinite(value)) bad(Code::kArgument, "%s is not finite", what);
    if (value < low || value > high)
      bad(Code::kRange, "%s %s is outside [%s, %s]", what, Number(value).text, Number(low).text,
          Number(high).text);
  }
  // Room for what tells its shapes apart.
  void name(const char* text) const {
    constexpr size_t kLongest = kNameSize - 1 - 6;
    if (!text || !*text) bad(Code::kArgument, "the name is empty");
    if (std::strlen(text) > kLongest)
      bad(Code::kRange, "the name %s is longer than %zu characters", Quoted(text).text, kLongest);
    for (const char* c = text; *c; ++c)
      if (!std::isalnum(static_cast<unsigned char>(*c)) && !std::strchr("_-+", *c))
        bad(Code::kArgument, "the name %s may contain only letters, digits, '_', '-' and '+'",
            Quoted(text).text);
  }
  void shape(const ObjectShape& s, int32_t i) const {
    char what[32];
    std::snprintf(what, sizeof what, "shapes[%d]: size", i);
    const int sizes = num_sizes(s.kind);
    if (s.kind == ShapeKind::kHull) {
      if (s.points.count < 4 || s.points.count > kMaxHullPoints)
        bad(Code::kRange, "shapes[%d]: num_points %d is outside [4, %d]", i, s.points.count, kMaxHullPoints);
    } else if (sizes == 0) {
      bad(Code::kArgument, "shapes[%d]: kind %d cannot be part of an object", i, static_cast<int>(s.kind));
    }
    for (int k = 0; k < sizes; ++k) within(s.size[k], kLeast, kMost, what);
    std::snprintf(what, sizeof what, "shapes[%d]: place", i);
    for (int k = 0; k < 3; ++k) within(s.p[k], -kMost, kMost, what);
    std::snprintf(what, sizeof what, "shapes[%d]: point", i);
    for (const Vec3& p : s.points)
      for (int k = 0; k < 3; ++k) within(p[k], -kMost, kMost, what);
    const Quat& q = s.q;
    const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
    if (!(std::abs(length - 1) <= 1e-4))
      bad(Code::kArgument, "shapes[%d]: the quaternion has length %g, not 1", i, length);
  }
  void inertia() const {
    for (const double m : object.moment) within(m, -1e6, 1e6, "moment of inertia");
    const Inertia body = object_inertia(object);
    const Mat3 m = moment_matrix(body);
    if (!positive_definite(m)) bad(Code::kArgument, "the moment of inertia is not positive definite");
    const Vec3 p = principal_moments(m);
    if (p.x + p.y < p.z / kTriangle || p.y + p.z < p.x / kTriangle || p.z + p.x < p.y / kTriangle)
      bad(Code::kArgument, "principal moments %g, %g, %g violate the triangle inequality", p.x, p.y, p.z);
  }
};

}  // namespace

void check_object(const Object& object) {
  const Check check{object};
  check.name(object.name);
  if (object.alias) check.name(object.alias);
  check.name(object.material.name);
  check.within(object.material.friction, 0, 10, "friction");
  check.within(object.mass, 1e-6, 1000, "mass");
  if (object.shapes.count < 1 || object.shapes.count > kMaxObjectShapes)
    check.bad(Code::kRange, "num_shapes: %d is outside [1, %d]", object.shapes.count, kMaxObjectShapes);
  bool touched = false;
  for (int32_t i = 0; i < object.shapes.count; ++i) {
    check.shape(object.shapes[i], i);
    touched = touched || object.shapes[i].collides;
  }
  if (!touched) check.bad(Code::kArgument, "none of its shapes collides");
  check.inertia();
}

}  // namespace rdm
