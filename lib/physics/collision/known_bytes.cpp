#include "physics/collision/known_bytes.hpp"

#include "base/hash.hpp"
#include "physics/collision/convex.hpp"
#include "physics/collision/shapes.hpp"
#include "physics/ode_library/ode_convert.hpp"
#include "physics/ode_library/ode_guard.hpp"

namespace rdm {
namespace {

// Of Debian's packages on x86-64: ODE 0.16 and libccd 2.1, double precision.
constexpr uint64_t kOde = 0xcca81df37cfc77cb, kCcd = 0xc41840d6fb0cac59;

constexpr int kPoses = 6;

// No coordinate is a round number; the shapes of a pair overlap by a few millimetres.
Pose pose(int k, double apart) {
  const double t = 0.37 * k + 0.11;
  const Quat q = normalized(Quat{0.9 - 0.13 * t, 0.31 + 0.07 * t, -0.23 * t, 0.17 + 0.05 * t});
  return {{0.013 * t, -0.021 * t, apart + 0.0017 * t}, q};
}

uint64_t join(uint64_t hash, const Vec3& v) {
  const double xyz[3] = {v.x, v.y, v.z};
  return hash_bytes(xyz, sizeof xyz, hash);
}

struct OwnedGeom {
  OwnedGeom(ShapeKind kind, const Vec3& size, const Pose& X) {
    ShapeDef shape;
    shape.kind = kind;
    shape.size = size;
    geom = make_geom(shape, nullptr, X);
  }
  ~OwnedGeom() { dGeomDestroy(geom.id); }
  OwnedGeom(const OwnedGeom&) = delete;
  OwnedGeom& operator=(const OwnedGeom&) = delete;
  Geom geom;
};

struct Pair {
  ShapeKind a, b;
  double apart;  // m
};

uint64_t hash_of_ode() {
  constexpr Pair pairs[] = {{ShapeKind::kBox, ShapeKind::kBox, 0.08},
                            {ShapeKind::kSphere, ShapeKind::kBox, 0.06},
                            {ShapeKind::kCapsule, ShapeKind::kCapsule, 0.05},
                            {ShapeKind::kBox, ShapeKind::kPlane, 0.04},
                            {ShapeKind::kCapsule, ShapeKind::kPlane, 0.03}};
  const Vec3 size{0.03, 0.041, 0.037};
  const OdeGuard guard;
  const OdeScope scope;
  uint64_t hash = kHashSeed;
  for (const Pair& pair : pairs)
    for (int k = 0; k < kPoses; ++k) {
      const OwnedGeom a(pair.a, size, pose(k, pair.apart)), b(pair.b, size, pose(2 * k + 1, 0));
      dContactGeom points[kMaxPairPoints];
      const int n = collide_geoms(a.geom, b.geom, kMaxPairPoints, points);
      hash = hash_bytes(&n, sizeof n, hash);
      for (int i = 0; i < n; ++i) {
        hash = join(join(hash, from_ode(points[i].pos)), from_ode(points[i].normal));
        hash = hash_bytes(&points[i].depth, sizeof points[i].depth, hash);
      }
    }
  return hash;
}

uint64_t hash_of_ccd() {
  constexpr Pair pairs[] = {{ShapeKind::kCylinder, ShapeKind::kBox, 0.06},
                            {ShapeKind::kCylinder, ShapeKind::kCylinder, 0.05},
                            {ShapeKind::kEllipsoid, ShapeKind::kCapsule, 0.05}};
  uint64_t hash = kHashSeed;
  for (const Pair& pair : pairs)
    for (int k = 0; k < kPoses; ++k) {
      const auto solid = [](ShapeKind kind, const Pose& X) {
        return Convex{kind, {0.03, 0.041, 0.037}, X.p, to_matrix(X.q), nullptr};
      };
      Overlap found{};
      const bool met =
          find_overlap(solid(pair.a, pose(k, pair.apart)), solid(pair.b, pose(2 * k + 1, 0)), &found);
      hash = hash_bytes(&met, sizeof met, hash);
      hash = hash_bytes(&found.depth, sizeof found.depth, join(join(hash, found.n), found.p));
    }
  return hash;
}

}  // namespace

const KnownBytes& known_bytes() {
  static const KnownBytes found = {hash_of_ode() == kOde, hash_of_ccd() == kCcd};
  return found;
}

}  // namespace rdm
