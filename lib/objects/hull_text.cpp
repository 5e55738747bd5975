#include "objects/hull_text.hpp"

#include <cstring>

#include "base/chars.hpp"
#include "base/error.hpp"
#include "physics/model/inertia.hpp"

namespace rdm {

Vector<Vec3> hull_points_from(const char* text) {
  Vector<Vec3> points;
  const char *at = text, *end = text + std::strlen(text);
  while (at < end) {
    Vec3 p;
    for (int k = 0; k < 3; ++k) {
      while (*at == ' ' || *at == '+') ++at;
      const auto [stop, error] = from_chars(at, end, p[k]);
      if (error != std::errc() || (k < 2 ? *stop != ',' : *stop != ';' && *stop != '\0'))
        fail(Code::kArgument, "hull: point %d is not x,y,z with ';' between points",
             static_cast<int>(points.size()));
      at = stop < end ? stop + 1 : end;
    }
    points.push_back(p);
  }
  return points;
}

BodyDef make_hull_body(const char* points, const char* name, const Pose& X_WB, double mass, double scale,
                       int32_t material) {
  BodyDef body;
  body.name = name;
  body.X_WB = X_WB;
  ShapeDef shape;
  shape.name = name;
  shape.kind = ShapeKind::kHull;
  shape.material = material;
  shape.color[0] = 150, shape.color[1] = 140;
  shape.points = hull_points_from(points);
  const Hull hull = make_hull(shape.points.data(), static_cast<int32_t>(shape.points.size()), "hull");
  body.inertia = hull_inertia(mass > 0 ? mass : kHullDensity * hull.volume, hull);
  body.inertia.com = {};
  for (Vec3& p : shape.points) p -= hull.com;
  if (scale != 1) {
    for (Vec3& p : shape.points) p = scale * p;
    for (double& m : body.inertia.moment) m *= scale * scale;
  }
  body.shapes.push_back(std::move(shape));
  return body;
}

}  // namespace rdm
