#include "physics/manifold.hpp"

#include <algorithm>
#include <cmath>

namespace rdm {
namespace {

constexpr double kStanding = 0.9;  // cosine of the tilt up to which the cap carries
constexpr double kLying = 0.1;     // sine of the tilt up to which the side carries
constexpr double kLevel = 1e-3;    // tilt below which a cap has no lowest point of its own

bool inside(const Face& face, const Vec3& p) {
  if (!face.half) return true;
  const Vec3 d = p - face.center;
  return std::fabs(dot(d, face.side[0])) <= face.half[0] && std::fabs(dot(d, face.side[1])) <= face.half[1];
}

int standing(const Cylinder& c, const Face& face, double cosine, ManifoldPoint* out) {
  const Vec3 axis = c.R.col(2);
  const Vec3 cap = c.p - std::copysign(c.half_length, cosine) * axis;
  // Directions on the cap: from its lowest point on where there is one, else the body's own.
  Vec3 first = c.R.col(0);
  const Vec3 downhill = cosine * axis - face.n;
  if (norm(downhill) > kLevel) {
    const Vec3 along = downhill - dot(downhill, axis) * axis;
    first = normalized(along);
  }
  const Vec3 second = cross(axis, first);
  int count = 0;
  for (const Vec3& direction : {first, second, -first, -second}) {
    const Vec3 p = cap + c.radius * direction;
    if (!inside(face, p)) return -1;
    const double depth = face.offset - dot(face.n, p);
    if (depth > 0) out[count++] = {p, depth};
  }
  return count;
}

int lying(const Cylinder& c, const Face& face, double cosine, ManifoldPoint* out) {
  const Vec3 axis = c.R.col(2);
  const Vec3 below = c.p - c.radius * normalized(face.n - cosine * axis);
  double low = -c.half_length, high = c.half_length;
  for (int k = 0; face.half && k < 2; ++k) {
    const double at = dot(below - face.center, face.side[k]), slope = dot(axis, face.side[k]);
    if (std::fabs(slope) < 1e-9) {
      if (std::fabs(at) > face.half[k]) return -1;
      continue;
    }
    const double a = (-face.half[k] - at) / slope, b = (face.half[k] - at) / slope;
    low = std::max(low, std::min(a, b));
    high = std::min(high, std::max(a, b));
  }
  if (low >= high) return -1;
  int count = 0;
  for (const double t : {low, high}) {
    const Vec3 p = below + t * axis;
    const double depth = face.offset - dot(face.n, p);
    if (depth > 0) out[count++] = {p, depth};
  }
  return count;
}

}  // namespace

int cylinder_on_face(const Cylinder& cylinder, const Face& face, ManifoldPoint* out) {
  const double cosine = dot(cylinder.R.col(2), face.n);
  if (std::fabs(cosine) > kStanding) return standing(cylinder, face, cosine, out);
  if (std::fabs(cosine) < kLying) return lying(cylinder, face, cosine, out);
  return -1;
}

}  // namespace rdm
