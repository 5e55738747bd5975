// Shapes, distance functions and buffers that the tests of lib/sense share.
#pragma once
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "base/arena.hpp"
#include "hulls.hpp"
#include "sense/render/raycast.hpp"

namespace rdm {

inline constexpr ShapeKind kAllKinds[] = {ShapeKind::kSphere,   ShapeKind::kCapsule, ShapeKind::kBox,
                                          ShapeKind::kCylinder, ShapeKind::kPlane,   ShapeKind::kEllipsoid,
                                          ShapeKind::kHull};

inline constexpr double kNarrow = 0.6;  // of hulls: their heads

// Signed distance (a lower bound of it inside) from p, in the shape's frame: the reference that the closed
// forms are held against, written without any of them.
inline double signed_distance(ShapeKind kind, const Vec3& size, const Vec3& p) {
  switch (kind) {
    case ShapeKind::kSphere:
      return norm(p) - size.x;
    case ShapeKind::kCapsule:
      return norm(p - Vec3{0, 0, std::clamp(p.z, -size.y, size.y)}) - size.x;
    case ShapeKind::kBox: {
      const Vec3 q{std::abs(p.x) - size.x, std::abs(p.y) - size.y, std::abs(p.z) - size.z};
      const Vec3 out{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)};
      return norm(out) + std::min(0.0, std::max({q.x, q.y, q.z}));
    }
    case ShapeKind::kCylinder: {
      const double a = std::hypot(p.x, p.y) - size.x, b = std::abs(p.z) - size.y;
      return std::hypot(std::max(a, 0.0), std::max(b, 0.0)) + std::min(0.0, std::max(a, b));
    }
    case ShapeKind::kEllipsoid: {
      // a lower bound outside: the surface is nowhere flatter than its smallest half axis says
      const double k = norm({p.x / size.x, p.y / size.y, p.z / size.z});
      return (k - 1) * std::min({size.x, size.y, size.z});
    }
    case ShapeKind::kHull: {
      double out = -HUGE_VAL;  // likewise: to the farthest plane
      const Hull& hull = kept_hull(size, kNarrow);
      for (int32_t i = 0; i < hull.num_faces; ++i)
        out = std::max(out, dot(hull.faces[i].n, p) - hull.faces[i].offset);
      return out;
    }
    case ShapeKind::kPlane:
      return p.z;
  }
  return HUGE_VAL;
}

// First t in (0, limit) at which o + t d is within 1e-9 m of the shape, by sphere tracing; infinite if none.
// `gap` gets the smallest distance seen on the way.
inline double march(ShapeKind kind, const Vec3& size, const Vec3& o, const Vec3& d, double limit,
                    double* gap) {
  const double speed = norm(d);
  *gap = HUGE_VAL;
  for (double t = 0; t < limit;) {
    const double distance = signed_distance(kind, size, o + t * d);
    *gap = std::min(*gap, distance);
    if (distance < 1e-9) return t;
    t += distance / speed;
  }
  return HUGE_VAL;
}

struct Draw {
  std::mt19937_64 engine;
  explicit Draw(uint64_t seed) : engine(seed) {}
  double uniform(double lo, double hi) { return std::uniform_real_distribution<double>(lo, hi)(engine); }
  Vec3 box(double half) { return {uniform(-half, half), uniform(-half, half), uniform(-half, half)}; }
  Quat turn() {
    std::normal_distribution<double> n;
    return normalized(Quat{n(engine), n(engine), n(engine), n(engine)});
  }
};

inline RenderShape make_shape(ShapeKind kind, Vec3 size, Pose X_WS, int32_t id = 0) {
  RenderShape s;
  s.kind = kind;
  s.size = size;
  s.X_WS = X_WS;
  s.id = id;
  if (kind == ShapeKind::kHull) s.hull = &kept_hull(size, kNarrow);
  return s;
}

inline Camera look(Vec3 eye, Vec3 target, double fov_y = 0.8) {
  return {"test", eye, target, fov_y};
}

inline constexpr ShapeKind kFinite[] = {ShapeKind::kSphere,   ShapeKind::kCapsule,   ShapeKind::kBox,
                                        ShapeKind::kCylinder, ShapeKind::kEllipsoid, ShapeKind::kHull};
// `count` small shapes of all finite kinds about the origin, and a floor below.
inline std::vector<RenderShape> crowd(uint64_t seed, int count) {
  Draw draw(seed);
  std::vector<RenderShape> shapes{make_shape(ShapeKind::kPlane, {}, {{0, 0, -0.4}, {}}, 7)};
  for (int i = 0; i < count; ++i) {
    const Vec3 size{draw.uniform(0.01, 0.06), draw.uniform(0.01, 0.12), draw.uniform(0.01, 0.06)};
    shapes.push_back(make_shape(kFinite[i % 6], size, {draw.box(0.4), draw.turn()}, 100 + i));
    for (uint8_t& c : shapes.back().color) c = static_cast<uint8_t>(draw.uniform(20, 240));
  }
  return shapes;
}

// A picture with its own memory.
struct Picture {
  std::vector<uint8_t> rgb;
  std::vector<float> depth;
  std::vector<int32_t> segmentation;
  int32_t width, height;

  Picture(int32_t w, int32_t h)
      : rgb(static_cast<size_t>(w * h * 3)),
        depth(static_cast<size_t>(w * h), -7),
        segmentation(static_cast<size_t>(w * h), -7),
        width(w),
        height(h) {}
  Image image() { return {width, height, rgb.data(), depth.data(), segmentation.data()}; }
  size_t at(int32_t x, int32_t y) const { return static_cast<size_t>(y * width + x); }
  double light(int32_t x, int32_t y) const {
    const size_t i = 3 * at(x, y);
    return (rgb[i] + rgb[i + 1] + rgb[i + 2]) / 3.0;
  }
};

// A scratch with its own memory.
struct OwnScratch {
  Arena arena;
  RaycastScratch scratch;
  explicit OwnScratch(int32_t max_shapes = 256) {
    Arena measure;
    carve_raycast_scratch(measure, max_shapes);
    arena = Arena(host(), measure.used());
    scratch = carve_raycast_scratch(arena, max_shapes);
  }
};

inline Picture take(const std::vector<RenderShape>& shapes, const Camera& camera, int32_t width,
                    int32_t height, const RenderOptions& options = {}) {
  OwnScratch own(static_cast<int32_t>(shapes.size()));
  Picture picture(width, height);
  render(shapes.data(), static_cast<int32_t>(shapes.size()), camera, picture.image(), options, own.scratch);
  return picture;
}

}  // namespace rdm
