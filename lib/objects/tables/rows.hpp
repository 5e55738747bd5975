// Short ways to write the rows of the tables of objects. Lengths are whole ones (a box by its sides), in m.
//
// Sources, for mass and size in turn: S, from the table of Calli et al., Benchmarking in Manipulation
// Research: The YCB Object and Model Set, 2015; K, known: as that table is remembered, or a round figure of
// such a thing. Forms and moments are derived: primitives and small hulls of our own that keep the stated
// sizes, solid, of one density.
#pragma once
#include "objects/object.hpp"

namespace rdm::object_rows {

struct Color {
  uint8_t r, g, b;
};

// Coefficients on dry things, K: middles of what handbooks give for such pairs.
inline constexpr ObjectMaterial kPlastic = {"plastic", 0.4}, kCardboard = {"cardboard", 0.45},
                                kMetal = {"metal", 0.3}, kWood = {"wood", 0.45}, kGlass = {"glass", 0.35},
                                kRubber = {"rubber", 0.9}, kFoam = {"foam", 0.7}, kFelt = {"felt", 0.6},
                                kLeather = {"leather", 0.55}, kShell = {"shell", 0.4};

constexpr ObjectShape sphere(double r, Vec3 p, Color c) {
  return {ShapeKind::kSphere, {r, 0, 0}, p, {}, {c.r, c.g, c.b}};
}
constexpr ObjectShape box(double x, double y, double z, Vec3 p, Color c, Quat q = {}) {
  return {ShapeKind::kBox, {x / 2, y / 2, z / 2}, p, q, {c.r, c.g, c.b}};
}
constexpr ObjectShape cylinder(double r, double h, Vec3 p, Color c, Quat q = {}) {
  return {ShapeKind::kCylinder, {r, h / 2, 0}, p, q, {c.r, c.g, c.b}};
}
constexpr ObjectShape capsule(double r, double straight, Vec3 p, Color c, Quat q = {}) {
  return {ShapeKind::kCapsule, {r, straight / 2, 0}, p, q, {c.r, c.g, c.b}};
}
constexpr ObjectShape ellipsoid(double a, double b, double c, Vec3 p, Color t) {
  return {ShapeKind::kEllipsoid, {a, b, c}, p, {}, {t.r, t.g, t.b}};
}
template <int32_t N>
constexpr ObjectShape hull(const Vec3 (&points)[N], Vec3 p, Color c, Quat q = {}) {
  return {ShapeKind::kHull, {}, p, q, {c.r, c.g, c.b}, table(points)};
}

inline constexpr double kRoot = 0.70710678118654752;  // of a quarter turn's quaternion
inline constexpr Quat kAlongX = {kRoot, 0, kRoot, 0}, kAlongY = {kRoot, -kRoot, 0, 0};

constexpr double root(double x) {
  double r = x > 1 ? x : 1;
  for (int i = 0; i < 60; ++i) r = 0.5 * (r + x / r);
  return r;
}
// A turn about an axis of the frame, by half its angle's tangent.
constexpr Quat turn(int axis, double tangent) {
  const double w = 1 / root(1 + tangent * tangent), s = tangent * w;
  return {w, axis == 0 ? s : 0, axis == 1 ? s : 0, axis == 2 ? s : 0};
}

// A capsule whose straight part goes from a to b, not straight down.
constexpr ObjectShape rod(Vec3 a, Vec3 b, double r, Color c) {
  const Vec3 d = {b.x - a.x, b.y - a.y, b.z - a.z};
  const double length = root(d.x * d.x + d.y * d.y + d.z * d.z);
  const Quat q = {1 + d.z / length, -d.y / length, d.x / length, 0};
  const double n = root(q.w * q.w + q.x * q.x + q.y * q.y);
  return {ShapeKind::kCapsule,
          {r, length / 2, 0},
          {(a.x + b.x) / 2, (a.y + b.y) / 2, (a.z + b.z) / 2},
          {q.w / n, q.x / n, q.y / n, 0},
          {c.r, c.g, c.b}};
}

// Directions of the corners of an octagon.
inline constexpr double kCos[8] = {1, kRoot, 0, -kRoot, -1, -kRoot, 0, kRoot};
inline constexpr double kSin[8] = {0, kRoot, 1, kRoot, 0, -kRoot, -1, -kRoot};

struct Ring {
  double r, z;
};
// A body of revolution as octagons, corners at r: at most four of them, convex.
template <int32_t N>
struct Turned {
  Vec3 points[8 * N] = {};
  constexpr Turned(const Ring (&rings)[N]) {
    for (int k = 0; k < N; ++k)
      for (int i = 0; i < 8; ++i)
        points[8 * k + i] = {rings[k].r * kCos[i], rings[k].r * kSin[i], rings[k].z};
  }
};
// The wall of a hollow one between two octagons, `thickness` towards the axis: eight hulls.
struct Wall {
  Vec3 panels[8][8] = {};
  constexpr Wall(Ring low, Ring high, double thickness) {
    for (int i = 0; i < 8; ++i) {
      const Ring rings[2] = {low, high};
      int n = 0;
      for (const Ring& ring : rings)
        for (const int side : {i, (i + 1) % 8})
          for (const double r : {ring.r, ring.r - thickness})
            panels[i][n++] = {r * kCos[side], r * kSin[side], ring.z};
    }
  }
};
#define RDM_WALL(wall, p, color)                                                                            \
  hull((wall).panels[0], p, color), hull((wall).panels[1], p, color), hull((wall).panels[2], p, color),     \
      hull((wall).panels[3], p, color), hull((wall).panels[4], p, color), hull((wall).panels[5], p, color), \
      hull((wall).panels[6], p, color), hull((wall).panels[7], p, color)

}  // namespace rdm::object_rows
