#include "sense/render/primitive.hpp"

#include <algorithm>
#include <cmath>

#include "base/error.hpp"

namespace rdm {

namespace {

constexpr double kClose = 1e-3;      // m before the eye: nearer, a projection is not bounded
constexpr double kFarAway = 1e6;     // m
constexpr float kEverywhere = 1e9f;  // pixels

bool drawable(const Pose& X) {
  return norm(X.p) < kFarAway && std::isfinite(X.q.w) && std::isfinite(X.q.x) && std::isfinite(X.q.y) &&
         std::isfinite(X.q.z);
}

void check_size(const RenderShape& shape, int32_t index) {
  int used = 0;
  switch (shape.kind) {
    case ShapeKind::kSphere:
      used = 1;
      break;
    case ShapeKind::kCapsule:
    case ShapeKind::kCylinder:
      used = 2;
      break;
    case ShapeKind::kHull:
      if (!shape.hull) fail(Code::kArgument, "shapes[%d]: a hull needs points", index);
      [[fallthrough]];
    case ShapeKind::kBox:
    case ShapeKind::kEllipsoid:
      used = 3;
      break;
    case ShapeKind::kPlane:
      used = 0;
      break;
    default:
      fail(Code::kArgument, "shapes[%d]: kind %d is unknown", index, static_cast<int>(shape.kind));
  }
  for (int k = 0; k < used; ++k)
    if (!(shape.size[k] > 0 && shape.size[k] < kFarAway))
      fail(Code::kRange, "shapes[%d]: size[%d] %g m is outside (0, 1e6)", index, k, shape.size[k]);
}

// The shape lies in the convex hull of balls of radius `round` about these points of S.
int wrap(const RenderShape& shape, Vec3 points[kMaxHullPoints], double* round) {
  const Vec3& s = shape.size;
  switch (shape.kind) {
    case ShapeKind::kCapsule:
    case ShapeKind::kCylinder:
      points[0] = {0, 0, s.y};
      points[1] = {0, 0, -s.y};
      *round = s.x;
      return 2;
    case ShapeKind::kBox:
      for (int i = 0; i < 8; ++i) points[i] = {i & 1 ? s.x : -s.x, i & 2 ? s.y : -s.y, i & 4 ? s.z : -s.z};
      *round = 0;
      return 8;
    case ShapeKind::kHull:
      std::copy_n(shape.hull->points, shape.hull->num_points, points);
      *round = 0;
      return shape.hull->num_points;
    case ShapeKind::kEllipsoid:
      points[0] = {};
      *round = std::max({s.x, s.y, s.z});
      return 1;
    default:
      points[0] = {};
      *round = s.x;
      return 1;
  }
}

// Slopes x / z of the two lines from the origin that touch the circle of radius r about (x, z), z > r.
void touching(double x, double z, double r, double* low, double* high) {
  const double root = r * std::sqrt(x * x + z * z - r * r), scale = 1 / (z * z - r * r);
  *low = (x * z - root) * scale;
  *high = (x * z + root) * scale;
}

void bound_in_image(const RenderShape& shape, const Mat3& R_CS, const Vec3& p_CS, const View& view,
                    Primitive* out) {
  out->nearest = 0;
  out->x0 = out->y0 = -kEverywhere;
  out->x1 = out->y1 = kEverywhere;
  if (shape.kind == ShapeKind::kPlane) return;
  Vec3 points[kMaxHullPoints];
  double round = 0;
  const int n = wrap(shape, points, &round);
  double x0 = HUGE_VAL, y0 = HUGE_VAL, x1 = -HUGE_VAL, y1 = -HUGE_VAL, near = HUGE_VAL, far = -HUGE_VAL;
  for (int i = 0; i < n; ++i) {
    const Vec3 p = p_CS + R_CS * points[i];
    near = std::min(near, p.z - round);
    far = std::max(far, p.z + round);
    if (p.z - round < kClose) continue;
    double low = 0, high = 0;
    touching(p.x, p.z, round, &low, &high);
    x0 = std::min(x0, low);
    x1 = std::max(x1, high);
    touching(p.y, p.z, round, &low, &high);
    y0 = std::min(y0, low);
    y1 = std::max(y1, high);
  }
  if (far < 0) {
    out->x0 = out->y0 = kEverywhere;
    out->x1 = out->y1 = -kEverywhere;
    return;
  }
  if (near < kClose) return;
  // Half a pixel and a thousandth of the depth stand for the rounding of floats.
  const double scale = 1 / view.pixel;
  out->nearest = static_cast<float>(0.999 * near);
  out->x0 = static_cast<float>(view.cx + x0 * scale - 0.5);
  out->x1 = static_cast<float>(view.cx + x1 * scale + 0.5);
  out->y0 = static_cast<float>(view.cy + y0 * scale - 0.5);
  out->y1 = static_cast<float>(view.cy + y1 * scale + 0.5);
}

// Capsule of about the same bulk, along the longest axis of the shape.
void bound_bulk(const RenderShape& shape, const Mat3& R_ES, Primitive* out) {
  const Vec3& s = shape.size;
  int axis = 2;
  double half = 0, thick = s.x, radius = s.x;
  if (shape.kind == ShapeKind::kCapsule || shape.kind == ShapeKind::kCylinder) {
    const bool round = shape.kind == ShapeKind::kCapsule;
    half = round ? s.y : std::max(0.0, s.y - s.x);
    radius = round ? s.x + s.y : norm({s.x, s.y, 0});
  } else if (shape.kind == ShapeKind::kBox || shape.kind == ShapeKind::kHull ||
             shape.kind == ShapeKind::kEllipsoid) {
    axis = s.x > s.y ? (s.x > s.z ? 0 : 2) : (s.y > s.z ? 1 : 2);
    thick = std::sqrt(s.x * s.y * s.z / s[axis]);
    half = std::max(0.0, s[axis] - thick);
    radius = shape.kind == ShapeKind::kEllipsoid ? s[axis] : norm(s);
  } else if (shape.kind == ShapeKind::kPlane) {
    radius = HUGE_VAL;
  }
  out->radius = static_cast<float>(1.0001 * radius);
  out->thick = static_cast<float>(thick);
  const Vec3 spine = half * R_ES.col(axis);
  for (int k = 0; k < 3; ++k) out->spine[k] = static_cast<float>(spine[k]);
}

}  // namespace

bool make_primitive(const RenderShape& shape, int32_t index, const View& view, Primitive* out) {
  check_size(shape, index);
  if (!drawable(shape.X_WS)) return false;
  const Mat3 R_ES = to_matrix(shape.X_WS.q), R_SE = transpose(R_ES), R_CW = transpose(view.R_WC);
  const Vec3 p_ES = shape.X_WS.p - view.eye;
  const Vec3 o_S = R_SE * -p_ES;
  out->kind = shape.kind;
  out->id = shape.id;
  out->hull = shape.hull;
  for (int k = 0; k < 9; ++k) out->R_SE[k] = static_cast<float>(R_SE.m[k]);
  for (int k = 0; k < 3; ++k) {
    out->p_ES[k] = static_cast<float>(p_ES[k]);
    out->o_S[k] = static_cast<float>(o_S[k]);
    out->size[k] = static_cast<float>(shape.size[k]);
    out->color[k] = 0;
  }
  out->round = static_cast<float>(shape.round);
  out->finish = shape.finish;
  bound_in_image(shape, R_CW * R_ES, R_CW * p_ES, view, out);
  bound_bulk(shape, R_ES, out);
  return true;
}

}  // namespace rdm
