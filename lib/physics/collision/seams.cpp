#include "physics/collision/seams.hpp"

#include <algorithm>
#include <cmath>

namespace rdm {
namespace {

constexpr double kFlush = 5e-4;       // m, the layer of contacts as scenes come: what is lower trips nobody
constexpr double kParallel = 0.9999;  // cosine of two level faces
constexpr double kFacing = 0.999;     // cosine of a normal and the face it counts for
constexpr double kExact = 1 - 1e-7;   // the same of round things, whose normals are those of nearest points
constexpr double kLeaning = 0.9;
constexpr double kNear = 0.01;  // m, between bounds of neighbours

struct Face {
  Vec3 n, p;  // outward normal, a point on it
};

bool has_faces(ShapeKind kind) {
  return kind == ShapeKind::kBox || kind == ShapeKind::kHull || kind == ShapeKind::kCylinder ||
         kind == ShapeKind::kPlane;
}

// The face that looks along n; false: there is none.
bool face_along(const Geom& geom, const Vec3& n, double cosine, Face* out) {
  if (geom.kind == ShapeKind::kPlane) {
    *out = {geom.plane_n, geom.plane_d * geom.plane_n};
  } else {
    const Feature f = shown(convex_of(geom), n);
    if (f.count < 3) return false;
    *out = {f.n, f.points[0]};
  }
  return dot(out->n, n) > cosine;
}

// visit(n) for each face's normal.
template <class Visit>
void each_normal(const Geom& geom, const Visit& visit) {
  if (geom.kind == ShapeKind::kPlane) return visit(geom.plane_n);
  const Convex solid = convex_of(geom);
  if (geom.kind == ShapeKind::kHull) {
    for (int32_t i = 0; i < geom.hull->num_faces; ++i) visit(solid.R * geom.hull->faces[i].n);
    return;
  }
  for (int k = geom.kind == ShapeKind::kBox ? 0 : 2; k < 3; ++k)
    for (const double sign : {-1.0, 1.0}) visit(sign * solid.R.col(k));
}

bool have_level_faces(const Geom& a, const Geom& b) {
  bool found = false;
  each_normal(a, [&](const Vec3& n) {
    Face of_a, of_b;
    found = found || (face_along(a, n, kParallel, &of_a) && face_along(b, n, kParallel, &of_b) &&
                      std::fabs(dot(n, of_a.p - of_b.p)) < kFlush);
  });
  return found;
}

}  // namespace

void Seams::carve(const Scene& scene, Arena& arena) {
  level_ = arena.make<uint8_t>(scene.shapes.size());
}

void Seams::make(const Scene& scene, const Geom* geoms) {
  any_ = false;
  const auto count = static_cast<int32_t>(scene.shapes.size());
  const auto shape = [&](int32_t i) -> const SceneShape& { return scene.shapes[static_cast<size_t>(i)]; };
  const auto rests = [&](int32_t i) {
    return !scene.moves(shape(i)) && geoms[i].id && has_faces(geoms[i].kind);
  };
  const auto near = [&](int32_t i, int32_t k) {
    if (shape(i).radius < 0 || shape(k).radius < 0) return true;
    const double reach = shape(i).radius + shape(k).radius + kNear;
    const Vec3 d = convex_of(geoms[i]).p - convex_of(geoms[k]).p;
    return dot(d, d) < reach * reach;
  };
  for (int32_t i = 0; i < count; ++i) {
    if (!rests(i)) continue;
    for (int32_t k = 0; k < i; ++k) {
      if (!rests(k) || !near(i, k) || (level_[i] && level_[k]) || !have_level_faces(geoms[i], geoms[k]))
        continue;
      level_[i] = level_[k] = 1;
      any_ = true;
    }
  }
}

// `other` shows that `contact` is none of a face that things can reach; f: the face's normal.
bool Seams::is_ghost(const Geom* geoms, const Contact& contact, const Contact& other, Vec3* f) const {
  const ShapeKind kind = geoms[contact.shape_a].kind;
  const bool exact = kind == ShapeKind::kSphere || kind == ShapeKind::kCapsule;
  Face ground, next;
  if (!face_along(geoms[other.shape_b], other.n, kFacing, &ground)) return false;
  if (dot(contact.n, ground.n) > (exact ? kExact : kFacing)) return false;
  if (!face_along(geoms[contact.shape_b], ground.n, kParallel, &next)) return false;
  const Vec3 p = contact.p + contact.gap;
  const double below = dot(ground.n, ground.p - p);
  if (std::fabs(below - dot(next.n, next.p - p)) > kFlush || below < -kFlush) return false;
  *f = ground.n;
  if (below < std::max(other.depth, 0.0) + kFlush) return true;
  if (contact.depth >= 0 || geoms[other.shape_b].kind == ShapeKind::kPlane) return false;
  return dot(contact.n, farthest(convex_of(geoms[other.shape_b]), -contact.n) - p) < kFlush;
}

int32_t Seams::without_ghosts(const Geom* geoms, Contact* contacts, int32_t* pairs, int32_t count) const {
  int32_t kept = 0;
  // those that go do so behind the ones that are still looked at: a ghost shows nobody else to be one
  for (int32_t i = 0; i < count; ++i) {
    Contact contact = contacts[i];
    bool ghost = false;
    Vec3 f;
    for (int32_t k = 0; level_[contact.shape_b] && !ghost && k < count; ++k) {
      if (k >= kept && k < i) continue;  // moved
      const Contact& other = contacts[k];
      ghost = other.shape_a == contact.shape_a && other.shape_b != contact.shape_b && level_[other.shape_b] &&
              is_ghost(geoms, contact, other, &f);
    }
    if (ghost) {
      const ShapeKind kind = geoms[contact.shape_a].kind;
      const bool flat = kind == ShapeKind::kBox || kind == ShapeKind::kHull;
      if (!flat || dot(contact.n, f) < kLeaning) continue;
      contact.n = f;
    }
    contacts[kept] = contact;
    pairs[kept++] = pairs[i];
  }
  return kept;
}

}  // namespace rdm
