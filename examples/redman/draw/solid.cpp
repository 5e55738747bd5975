#include "draw/solid.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace tool {
namespace {

using Vec = std::array<double, 3>;
Vec operator-(const Vec& a, const Vec& b) {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}
double dot(const Vec& a, const Vec& b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
Vec cross(const Vec& a, const Vec& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}
Vec unit(const Vec& v) {
  const double length = std::sqrt(dot(v, v));
  return {v[0] / length, v[1] / length, v[2] / length};
}

void add_point(Solid& s, const Vec& p, const Vec& normal) {
  for (const double v : p) s.points.push_back(static_cast<float>(v));
  for (const double v : normal) s.normals.push_back(static_cast<float>(v));
}
void add_triangle(Solid& s, size_t a, size_t b, size_t c) {
  for (const size_t i : {a, b, c}) s.triangles.push_back(static_cast<uint16_t>(i));
}

// A flat polygon with its corners in order.
void add_polygon(Solid& s, const std::vector<Vec>& corners, const Vec& normal) {
  const size_t first = s.points.size() / 3;
  for (const Vec& c : corners) add_point(s, c, normal);
  for (size_t i = 2; i < corners.size(); ++i) add_triangle(s, first, first + i - 1, first + i);
}

// A point of an outline that is turned about z: distance from the axis, height, and the normal's two parts.
struct Outline {
  double r, z, normal_r, normal_z;
};

// From top to bottom.
Solid lathe(const std::vector<Outline>& outline) {
  Solid s;
  for (const Outline& o : outline)
    for (int i = 0; i < kAround; ++i) {
      const double a = 2 * std::numbers::pi * i / kAround, c = std::cos(a), d = std::sin(a);
      add_point(s, {o.r * c, o.r * d, o.z}, {o.normal_r * c, o.normal_r * d, o.normal_z});
    }
  for (size_t k = 0; k + 1 < outline.size(); ++k) {
    if (outline[k].r == outline[k + 1].r && outline[k].z == outline[k + 1].z) continue;  // an edge
    for (size_t i = 0; i < kAround; ++i) {
      const size_t next = (i + 1) % kAround, up = k * kAround, down = up + kAround;
      if (outline[k + 1].r > 0) add_triangle(s, up + i, down + i, down + next);
      if (outline[k].r > 0) add_triangle(s, up + i, down + next, up + next);
    }
  }
  return s;
}

// A quarter circle from angle `begin` above the equator to `end` below it, in right angles.
void add_arc(std::vector<Outline>& outline, double radius, double z, int begin, int end) {
  constexpr int kSteps = kAround / 4;
  for (int i = begin * kSteps; i >= end * kSteps; --i) {
    const bool pole = std::abs(i) == kSteps;
    const double a = std::numbers::pi / 2 * i / kSteps, c = pole ? 0 : std::cos(a), d = std::sin(a);
    outline.push_back({radius * c, z + radius * d, c, d});
  }
}

}  // namespace

Solid make_ellipsoid(const float radii[3]) {
  std::vector<Outline> outline;
  add_arc(outline, 1, 0, 1, -1);
  Solid s = lathe(outline);
  for (size_t i = 0; i < s.points.size(); i += 3) {
    Vec normal;
    for (size_t k = 0; k < 3; ++k) {
      normal[k] = static_cast<double>(s.points[i + k]) / static_cast<double>(radii[k]);
      s.points[i + k] *= radii[k];
    }
    normal = unit(normal);
    for (size_t k = 0; k < 3; ++k) s.normals[i + k] = static_cast<float>(normal[k]);
  }
  return s;
}

Solid make_cylinder(float radius, float half_length, bool rounded) {
  const double r = static_cast<double>(radius), h = static_cast<double>(half_length);
  std::vector<Outline> outline;
  if (rounded) {
    add_arc(outline, r, h, 1, 0);
    add_arc(outline, r, -h, 0, -1);
  } else {
    outline = {{0, h, 0, 1}, {r, h, 0, 1}, {r, h, 1, 0}, {r, -h, 1, 0}, {r, -h, 0, -1}, {0, -h, 0, -1}};
  }
  return lathe(outline);
}

Solid make_box(const float half[3]) {
  Solid s;
  for (size_t k = 0; k < 3; ++k)
    for (const int side : {1, -1}) {
      const size_t u = (k + 1) % 3, v = (k + 2) % 3;
      std::vector<Vec> corners;
      for (const auto& [a, b] : {std::pair{-1, -side}, {1, -side}, {1, side}, {-1, side}}) {
        Vec p;
        p[k] = side * static_cast<double>(half[k]);
        p[u] = a * static_cast<double>(half[u]);
        p[v] = b * static_cast<double>(half[v]);
        corners.push_back(p);
      }
      Vec normal{};
      normal[k] = side;
      add_polygon(s, corners, normal);
    }
  return s;
}

Solid make_square(float x, float y, float half) {
  const double a = static_cast<double>(x), b = static_cast<double>(y), h = static_cast<double>(half);
  Solid s;
  add_polygon(s, {{a - h, b - h, 0}, {a + h, b - h, 0}, {a + h, b + h, 0}, {a - h, b + h, 0}}, {0, 0, 1});
  return s;
}

Solid make_hull(const std::vector<float>& corners) {
  std::vector<Vec> p(corners.size() / 3);
  double size = 0;
  for (size_t i = 0; i < p.size(); ++i)
    for (size_t k = 0; k < 3; ++k) {
      p[i][k] = static_cast<double>(corners[3 * i + k]);
      size = std::max(size, std::abs(p[i][k]));
    }
  const double flat = 1e-5 * size;
  std::vector<Vec> faces;  // normals of the faces that are there
  Solid s;
  for (size_t i = 0; i < p.size(); ++i)
    for (size_t j = 0; j < p.size(); ++j)
      for (size_t k = std::max(i, j) + 1; k < p.size(); ++k) {
        if (i == j) continue;
        Vec normal = cross(p[j] - p[i], p[k] - p[i]);
        if (dot(normal, normal) < flat * flat * size * size) continue;
        normal = unit(normal);
        std::vector<Vec> face;
        bool outside = true;
        for (const Vec& q : p) {
          const double above = dot(normal, q - p[i]);
          outside = outside && above <= flat;
          if (above >= -flat) face.push_back(q);
        }
        const auto same = [&](const Vec& n) { return dot(n, normal) > 1 - 1e-6; };
        if (!outside || std::any_of(faces.begin(), faces.end(), same)) continue;
        faces.push_back(normal);
        // in order about their middle
        Vec middle{};
        for (const Vec& q : face)
          for (size_t m = 0; m < 3; ++m) middle[m] += q[m] / static_cast<double>(face.size());
        const Vec right = unit(face[0] - middle), up = cross(normal, right);
        const auto angle = [&](const Vec& q) {
          return std::atan2(dot(q - middle, up), dot(q - middle, right));
        };
        std::sort(face.begin(), face.end(), [&](const Vec& a, const Vec& b) { return angle(a) < angle(b); });
        add_polygon(s, face, normal);
      }
  return s;
}

}  // namespace tool
