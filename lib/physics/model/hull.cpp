#include "physics/model/hull.hpp"

#include <algorithm>
#include <cmath>

#include "base/eigen.hpp"
#include "base/error.hpp"

// Faces: a plane through three points is one when all others lie on one side of it. With at most 32 points
// that is tried for every three; points within kFlat of it belong to the same face, which gift wrapping
// (Jarvis 1973) puts in order. The result is checked: V - E + F = 2 (Euler), and every edge in two faces,
// once each way.
//
// Weight: the solid is cut into tetrahedra (o, a, b, c) from its corner o. With edges from o, volume
// V = a . (b x c) / 6, and for uniform density (Tonon, Explicit exact formulas for the 3-D tetrahedron
// inertia tensor in terms of its vertex coordinates, 2004)
//   int x dV = V/4 (a + b + c),   int x x^T dV = V/20 (a a^T + b b^T + c c^T + s s^T),  s = a + b + c.
// About the centre of mass m: S = int x x^T dV / V - m m^T, and per kg I = tr(S) 1 - S.
//
// Eigen adds the outer products. The planes' dots and crosses are ours: Eigen's dot of three adds in another
// order, and the last bits of every hull would change.
namespace rdm {
namespace {

constexpr double kFlat = 1e-6;      // of the hull's size: farther from a plane, a point is not in it
constexpr double kSliver = 1e-4;    // of the hull's size: height of triangles that span no plane
constexpr double kThinnest = 1e-3;  // of the hull's size: nothing flatter is a solid
constexpr double kFarthest = 1e3;   // m
constexpr double kSmallest = 1e-6;  // m: below it the fifth power of a size, a moment, is lost in rounding

// The corners of a polygon among the points of one plane, counterclockwise about n: gift wrapping.
int32_t wrap(const Vec3* points, const uint8_t* list, int32_t count, const Vec3& n, double flat,
             uint8_t* out) {
  Vec3 center;
  for (int32_t i = 0; i < count; ++i) center += (1.0 / count) * points[list[i]];
  int32_t first = 0;
  const auto square = [&](int32_t i) {
    const Vec3 d = points[list[i]] - center;
    return dot(d, d);
  };
  for (int32_t i = 1; i < count; ++i)
    if (square(i) > square(first)) first = i;
  int32_t corners = 0, now = first;
  do {
    out[corners++] = list[now];
    const Vec3& p = points[list[now]];
    int32_t next = now == 0 ? 1 : 0;
    for (int32_t i = 0; i < count; ++i) {
      if (i == now || i == next) continue;
      const Vec3 d = points[list[i]] - p, best = points[list[next]] - p;
      const double side = dot(n, cross(best, d)), along = flat * norm(best);
      if (side < -along || (side <= along && dot(d, d) > dot(best, best))) next = i;
    }
    now = next;
  } while (now != first && corners < count);
  return corners;
}

// v v^T
Eigen::Matrix3d square(const Vec3& v) {
  const Eigen::Vector3d e = to_eigen(v);
  return e * e.transpose();
}

class Builder {
 public:
  Builder(const Vec3* points, int32_t count, const char* owner) : owner_(owner) {
    if (count < 4 || count > Hull::kMostPoints)
      fail(Code::kRange, "%s: the number of points, %d, is outside [4, %d]", owner, count, Hull::kMostPoints);
    hull_.num_points = count;
    for (int32_t i = 0; i < count; ++i) {
      if (!finite(points[i])) fail(Code::kArgument, "%s: point %d is not finite", owner, i);
      if (norm(points[i]) > kFarthest)
        fail(Code::kRange, "%s: point %d is farther than %g m from the origin", owner, i, kFarthest);
      hull_.points[i] = points[i];
      size_ = std::max(size_, norm(points[i] - points[0]));
    }
    if (size_ < kSmallest)
      fail(Code::kArgument, "%s: the points are too close to each other: all lie within %g m", owner,
           kSmallest);
  }
  Hull make() {
    const int32_t n = hull_.num_points;
    for (int32_t i = 0; i < n; ++i)
      for (int32_t j = i + 1; j < n; ++j)
        for (int32_t k = j + 1; k < n; ++k) try_face(i, j, k);
    keep_corners();
    if (!closed())
      fail(Code::kArgument, "%s: the points lie in one plane, or too close to each other", owner_);
    weigh();
    return hull_;
  }

 private:
  bool known(int32_t i, int32_t j, int32_t k) const {
    const uint32_t all = 1u << i | 1u << j | 1u << k;
    return std::any_of(members_, members_ + hull_.num_faces, [&](uint32_t m) { return (m & all) == all; });
  }
  void try_face(int32_t i, int32_t j, int32_t k) {
    const Vec3* p = hull_.points;
    const Vec3 u = p[j] - p[i], v = p[k] - p[i], w = p[k] - p[j];
    const double longest = std::sqrt(std::max({dot(u, u), dot(v, v), dot(w, w)}));
    Vec3 n = cross(u, v);
    const double area = norm(n);
    if (!(area > kSliver * size_ * longest) || known(i, j, k)) return;
    n = (1 / area) * n;
    double offset = dot(n, p[i]), low = 0, high = 0;
    uint8_t list[Hull::kMostPoints];
    int32_t count = 0;
    uint32_t member = 0;
    for (int32_t q = 0; q < hull_.num_points; ++q) {
      const double beyond = dot(n, p[q]) - offset;
      low = std::min(low, beyond);
      high = std::max(high, beyond);
      if (std::fabs(beyond) > kFlat * size_) continue;
      list[count++] = static_cast<uint8_t>(q);
      member |= 1u << q;
    }
    if (high > kFlat * size_) {
      if (low < -kFlat * size_) return;
      n = -n;
      offset = -offset;
      std::swap(low, high);
      low = -low;
    }
    const double depth = -low;
    if (depth < kThinnest * size_ || hull_.num_faces == Hull::kMostFaces) {
      broken_ = true;
      return;
    }
    uint8_t around[Hull::kMostPoints];
    const int32_t corners = wrap(p, list, count, n, kFlat * size_, around);
    if (corners < 3 || used_ + corners > 3 * Hull::kMostFaces) {
      broken_ = true;
      return;
    }
    std::copy_n(around, corners, hull_.corners + used_);
    members_[hull_.num_faces] = member;
    hull_.faces[hull_.num_faces++] = {n, offset, used_, corners};
    used_ += corners;
  }
  void keep_corners() {
    uint8_t place[Hull::kMostPoints];
    bool seen[Hull::kMostPoints] = {};
    for (int32_t i = 0; i < used_; ++i) seen[hull_.corners[i]] = true;
    int32_t kept = 0;
    for (int32_t i = 0; i < hull_.num_points; ++i) {
      if (!seen[i]) continue;
      place[i] = static_cast<uint8_t>(kept);
      hull_.points[kept++] = hull_.points[i];
    }
    hull_.num_points = kept;
    for (int32_t i = 0; i < used_; ++i) hull_.corners[i] = place[hull_.corners[i]];
  }
  // Each edge is one of two faces, once each way.
  bool closed() const {
    if (broken_ || hull_.num_points + hull_.num_faces - used_ / 2 != 2) return false;
    uint32_t edges[Hull::kMostPoints] = {};
    for (int32_t f = 0; f < hull_.num_faces; ++f) {
      const Hull::Face& face = hull_.faces[f];
      for (int32_t i = 0; i < face.count; ++i) {
        const int32_t a = hull_.corners[face.first + i], b = hull_.corners[face.first + (i + 1) % face.count];
        if (edges[a] >> b & 1u) return false;
        edges[a] |= 1u << b;
      }
    }
    for (int32_t a = 0; a < hull_.num_points; ++a)
      for (int32_t b = 0; b < a; ++b)
        if ((edges[a] >> b & 1u) != (edges[b] >> a & 1u)) return false;
    return true;
  }
  void weigh() {
    const Vec3 o = hull_.points[0];
    Vec3 first;
    Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
    for (int32_t f = 0; f < hull_.num_faces; ++f) {
      const Hull::Face& face = hull_.faces[f];
      for (int32_t i = 1; i + 1 < face.count; ++i) {
        const Vec3 a = hull_.corner(face, 0) - o, b = hull_.corner(face, i) - o,
                   c = hull_.corner(face, i + 1) - o, sum = a + b + c;
        const double volume = dot(a, cross(b, c)) / 6;
        hull_.volume += volume;
        first += (volume / 4) * sum;
        second += volume / 20 * (square(a) + square(b) + square(c) + square(sum));
      }
    }
    const Vec3 center = (1 / hull_.volume) * first;
    hull_.com = o + center;
    const Eigen::Matrix3d spread = second / hull_.volume - square(center);
    const double moment[6] = {spread(1, 1) + spread(2, 2),
                              spread(0, 0) + spread(2, 2),
                              spread(0, 0) + spread(1, 1),
                              -spread(0, 1),
                              -spread(0, 2),
                              -spread(1, 2)};
    std::copy_n(moment, 6, hull_.moment);
  }

  const char* owner_;
  Hull hull_;
  double size_ = 0;
  int32_t used_ = 0;                    // corners
  uint32_t members_[Hull::kMostFaces];  // points in the plane of each face
  bool broken_ = false;
};

}  // namespace

Hull make_hull(const Vec3* points, int32_t count, const char* owner) {
  return Builder(points, count, owner).make();
}

void scale_hull(const Hull& hull, double factor, Hull* out) {
  *out = hull;
  for (int32_t i = 0; i < hull.num_points; ++i) out->points[i] = factor * hull.points[i];
  for (int32_t i = 0; i < hull.num_faces; ++i) out->faces[i].offset = factor * hull.faces[i].offset;
  out->volume = factor * factor * factor * hull.volume;
  out->com = factor * hull.com;
  for (int i = 0; i < 6; ++i) out->moment[i] = factor * factor * hull.moment[i];
}

Vec3 half_box(const Hull& hull) {
  Vec3 half;
  for (int32_t i = 0; i < hull.num_points; ++i)
    for (int k = 0; k < 3; ++k) half[k] = std::max(half[k], std::fabs(hull.points[i][k]));
  return half;
}

}  // namespace rdm
