#include "physics/collision/narrowphase.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "base/error.hpp"
#include "physics/ode/ode_convert.hpp"
#include "physics/ode/ode_guard.hpp"

namespace rdm {
namespace {

constexpr int32_t kBatch = 64;      // pairs
constexpr float kFar = 1e30f;       // m
constexpr float kSlack = 1e-5f;     // m, for the rounding of bounds
constexpr float kFlatness = 1e-6f;  // of two axes that count as parallel

using Four = float __attribute__((vector_size(16)));
using FourMask = int32_t __attribute__((vector_size(16)));

Four load(const float* p) {
  Four v;
  std::memcpy(&v, p, sizeof v);
  return v;
}
void store(float* p, Four v) {
  std::memcpy(p, &v, sizeof v);
}
float dot3(Four a, Four b) {
  const Four p = a * b;
  return p[0] + p[1] + p[2];
}

Four clamp_unit(Four x) {
  const Four one = Four{} + 1.0f;
  x = x < -one ? -one : x;
  return x > one ? one : x;
}

// Four rows into four columns.
void transpose(Four* r) {
  const Four a = __builtin_shufflevector(r[0], r[1], 0, 4, 1, 5),
             b = __builtin_shufflevector(r[0], r[1], 2, 6, 3, 7);
  const Four c = __builtin_shufflevector(r[2], r[3], 0, 4, 1, 5),
             d = __builtin_shufflevector(r[2], r[3], 2, 6, 3, 7);
  r[0] = __builtin_shufflevector(a, c, 0, 1, 4, 5);
  r[1] = __builtin_shufflevector(a, c, 2, 3, 6, 7);
  r[2] = __builtin_shufflevector(b, d, 0, 1, 4, 5);
  r[3] = __builtin_shufflevector(b, d, 2, 3, 6, 7);
}

uint32_t bits_of(FourMask m) {
#if defined(__x86_64__)
  __m128 r;
  std::memcpy(&r, &m, sizeof r);
  return static_cast<uint32_t>(_mm_movemask_ps(r));
#else
  uint32_t bits = 0;
  for (int k = 0; k < 4; ++k) bits |= static_cast<uint32_t>(m[k] != 0) << k;
  return bits;
#endif
}

Four dot(const Four* a, const Four* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Squared distances of four pairs of segments p +- u and q +- v, by coordinate.
Four segment_distance(const Four* p, const Four* u, const Four* q, const Four* v) {
  const Four tiny = Four{} + 1e-10f;
  const Four r[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
  const Four a = dot(u, u) + tiny, e = dot(v, v) + tiny, b = dot(u, v), c = dot(u, r), f = dot(v, r);
  const Four d = a * e - b * b;
  const Four s = clamp_unit(d > kFlatness * a * e ? (b * f - c * e) / d : -c / a);
  const Four t = (b * s + f) / e, inside = clamp_unit(t);
  const Four s2 = t == inside ? s : clamp_unit((b * inside - c) / a);
  Four w[3];
  for (int k = 0; k < 3; ++k) w[k] = r[k] + u[k] * s2 - v[k] * inside;
  return dot(w, w);
}

}  // namespace

Capsule capsule_around(const SceneShape& shape) {
  const Vec3& s = shape.def.size;
  const Capsule sphere = {{}, shape.radius};
  if (shape.def.kind == ShapeKind::kCapsule) return {{0, 0, s.y}, s.x};
  // of links the engine knows no axis
  if (shape.carrier != Carrier::kBody && shape.carrier != Carrier::kStatic) return sphere;
  if (shape.def.kind == ShapeKind::kCylinder && s.y > s.x) return {{0, 0, s.y}, s.x};
  const bool round = shape.def.kind == ShapeKind::kEllipsoid;
  if (!round && shape.def.kind != ShapeKind::kBox) return sphere;
  const int longest = s.x >= s.y && s.x >= s.z ? 0 : s.y >= s.z ? 1 : 2;
  Vec3 axis, rest = s;
  axis[longest] = s[longest];
  rest[longest] = 0;
  if (round) {
    const double wide = std::max({rest.x, rest.y, rest.z});
    axis[longest] -= wide;
    return {axis, wide};
  }
  return norm(rest) < s[longest] ? Capsule{axis, norm(rest)} : sphere;
}

Collider::~Collider() {
  const OdeScope scope;
  for (int32_t i = 0; geoms_ && i < num_shapes_; ++i)
    if (geoms_[i].id) dGeomDestroy(geoms_[i].id);
}

void Collider::carve(const Scene& scene, Arena& arena) {
  num_shapes_ = static_cast<int32_t>(scene.shapes.size());
  geoms_ = arena.make<Geom>(scene.shapes.size());
  bounds_ = arena.make<Bound>(scene.shapes.size());
  pairs_ = arena.make<Pair>(scene.pairs.size());
  boxes_ = arena.make<Box>(scene.def.articulations.size());
  placed_ = arena.make<uint32_t>(scene.shapes.size());
  moves_ = arena.make<uint8_t>(scene.shapes.size());
  neighbours_ = arena.make<uint8_t>(scene.shapes.size());
}

void Collider::make(const Scene& scene) {
  const OdeScope scope;
  for (size_t i = 0; i < scene.shapes.size(); ++i) {
    const SceneShape& s = scene.shapes[i];
    moves_[i] = scene.moves(s);
    Pose X_WS = s.def.X_LS;
    if (s.carrier == Carrier::kBase && !moves_[i])
      X_WS = scene.def.articulations[static_cast<size_t>(s.articulation)].X_WB * X_WS;
    if (s.def.collides) geoms_[i] = make_geom(s.def, scene.hull_of(s), X_WS);
    Bound& bound = bounds_[i];
    bound.center[3] = static_cast<float>(s.radius);
    for (int k = 0; k < 3; ++k) bound.center[k] = static_cast<float>(X_WS.p[k]);
    bound.axis[3] = bound.center[3];
    const Capsule capsule = capsule_around(s);
    bound.axis[3] = static_cast<float>(capsule.radius);
    const Vec3 axis = rotate(X_WS.q, capsule.axis);
    for (int k = 0; k < 3; ++k) bound.axis[k] = static_cast<float>(axis[k]);
  }
  for (size_t k = 0; k < scene.pairs.size(); ++k) {
    const ShapePair& pair = scene.pairs[k];
    const float reach = bounds_[pair.a].axis[3] + bounds_[pair.b].axis[3] + kSlack;
    const float spheres = bounds_[pair.a].center[3] + bounds_[pair.b].center[3] + kSlack;
    const bool plane = pair.reach < 0;
    pairs_[k] = {pair.a, pair.b, plane ? kFar : reach * reach, plane ? kFar : spheres * spheres, plane};
  }
}

void Collider::update_boxes(const Scene& scene) {
  for (size_t a = 0; a < scene.def.articulations.size(); ++a) {
    const int32_t first = scene.first_shape[a];
    const auto end = first + static_cast<int32_t>(scene.def.articulations[a].shapes.size());
    Four low = Four{} + kFar, high = Four{} - kFar;
    for (int32_t i = first; i < end; ++i) {
      const Four c = load(bounds_[i].center), r = Four{} + (c[3] + kSlack), x = c - r, y = c + r;
      low = x < low ? x : low;
      high = y > high ? y : high;
    }
    store(boxes_[a].low, low);
    store(boxes_[a].high, high);
  }
}

bool Collider::near(const Bound& bound, const Box& box) {
  const Four c = load(bound.center), zero{};
  const Four under = load(box.low) - c, over = c - load(box.high);
  Four d = under > over ? under : over;
  d = d > zero ? d : zero;
  return dot3(d, d) < c[3] * c[3];
}

// Against a plane. False also where a number is missing: what is nowhere touches nothing.
bool Collider::above(const Pair& pair) const {
  const Bound& a = bounds_[pair.a];
  const Geom& plane = geoms_[pair.b];
  const Vec3 c{a.center[0], a.center[1], a.center[2]};
  return rdm::dot(c, plane.plane_n) - plane.plane_d < a.center[3] + kSlack;
}

bool Collider::near_one(int32_t pair) const {
  const int32_t list[4] = {pair, pair, pair, pair};
  return near_four(list) != 0 && (!pairs_[pair].plane || above(pairs_[pair]));
}

// Shapes of a robot that are near another's box.
void Collider::mark_neighbours(const Scene& scene, int32_t articulation, const Box& box) {
  const int32_t first = scene.first_shape[static_cast<size_t>(articulation)];
  const auto count = scene.def.articulations[static_cast<size_t>(articulation)].shapes.size();
  for (int32_t i = first; i < first + static_cast<int32_t>(count); ++i)
    neighbours_[i] = near(bounds_[i], box);
}

// Bit k: the bounds of pair list[k] meet, or one of them is a plane; four of them.
uint32_t Collider::near_four(const int32_t* list) const {
  Four p[4], u[4], q[4], v[4], gap{}, reach{};
  for (int k = 0; k < 4; ++k) {
    const Pair& pair = pairs_[list[k]];
    const Bound &a = bounds_[pair.a], &b = bounds_[pair.b];
    gap[k] = pair.gap;
    reach[k] = pair.reach;
    p[k] = load(a.center), u[k] = load(a.axis);
    q[k] = load(b.center), v[k] = load(b.axis);
  }
  transpose(p), transpose(q);
  const Four d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
  if (bits_of(dot(d, d) < reach) == 0) return 0;
  transpose(u), transpose(v);
  return bits_of(segment_distance(p, u, q, v) < gap);
}

void Collider::put(Poses& poses, int32_t shape) {
  if (!moves_[shape] || placed_[shape] == search_) return;
  placed_[shape] = search_;
  Vec3 p;
  Mat3 R;
  poses.place(shape, &p, &R);
  dMatrix3 r;
  to_ode(R, r);
  dGeomSetRotation(geoms_[shape].id, r);
  dGeomSetPosition(geoms_[shape].id, p.x, p.y, p.z);
}

int Collider::touch(Poses& poses, int32_t pair, int most, dContactGeom* out) {
  const Pair& p = pairs_[pair];
  put(poses, p.a);
  put(poses, p.b);
  return collide_geoms(geoms_[p.a], geoms_[p.b], most, out);
}

void Collider::add_points(const Scene& scene, Poses& poses, int32_t pair, Contact* contacts, int32_t* pairs,
                          uint8_t* touched, Found* found) {
  const SolverDef& solver = scene.def.solver;
  dContactGeom points[kMaxPairPoints];
  if (pairs_[pair].plane && !above(pairs_[pair])) return;
  const int n = touch(poses, pair, solver.contacts_per_pair, points);
  if (n > 0) touched[pair] = 1;
  for (int i = 0; i < n; ++i) {
    if (found->count == solver.contacts_max) {
      found->overflow = true;
      return;
    }
    pairs[found->count] = pair;
    contacts[found->count++] = {pairs_[pair].a,          pairs_[pair].b,
                                from_ode(points[i].pos), from_ode(points[i].normal),
                                points[i].depth,         {}};
  }
}

Collider::Found Collider::collide(const Scene& scene, Poses& poses, Contact* contacts, int32_t* pairs,
                                  uint8_t* touched) {
  Found found = {0, false, false};
  try {
    const OdeScope scope;
    search(scene, poses, contacts, pairs, touched, &found);
  } catch (const Error&) {
    found.failed = true;
  }
  return found;
}

void Collider::search(const Scene& scene, Poses& poses, Contact* contacts, int32_t* pairs, uint8_t* touched,
                      Found* found) {
  ++search_;
  update_boxes(scene);
  int32_t robots[2] = {-1, -1};  // whose shapes are listed in neighbours_
  for (const PairRun& run : scene.runs) {
    if (run.shape >= 0 && !near(bounds_[run.shape], boxes_[run.articulation])) continue;
    const int32_t owner = run.shape < 0 ? -1 : scene.shapes[static_cast<size_t>(run.shape)].articulation;
    if (owner >= 0 && (owner != robots[0] || run.articulation != robots[1])) {
      robots[0] = owner;
      robots[1] = run.articulation;
      mark_neighbours(scene, run.articulation, boxes_[owner]);
    }
    for (int32_t first = run.first, end = run.first + run.count; first < end;) {
      // all tests of a batch before any of its collisions: they overlap in the machine
      int32_t list[kBatch + 3], count = 0;
      for (; first < end && count < kBatch; ++first)
        if (owner < 0 || neighbours_[pairs_[first].b]) list[count++] = first;
      for (int32_t k = count; k % 4 != 0; ++k) list[k] = list[0];
      uint64_t bits = 0;
      for (int32_t k = 0; k < count; k += 4) bits |= uint64_t{near_four(list + k)} << k;
      if (count < kBatch) bits &= (uint64_t{1} << count) - 1;
      for (; bits != 0; bits &= bits - 1)
        add_points(scene, poses, list[std::countr_zero(bits)], contacts, pairs, touched, found);
    }
  }
}

double Collider::overlap(const Scene& scene, Poses& poses, int32_t body) {
  const OdeScope scope;
  ++search_;
  const auto carries = [&](int32_t shape) {
    const SceneShape& s = scene.shapes[static_cast<size_t>(shape)];
    return s.carrier == Carrier::kBody && s.index == body;
  };
  double deepest = 0;
  dContactGeom points[kMaxPairPoints];
  for (int32_t k = 0; k < static_cast<int32_t>(scene.pairs.size()); ++k) {
    if (!(carries(pairs_[k].a) || carries(pairs_[k].b)) || !near_one(k)) continue;
    const int n = touch(poses, k, kMaxPairPoints, points);
    for (int i = 0; i < n; ++i) deepest = std::max(deepest, static_cast<double>(points[i].depth));
  }
  return deepest;
}

}  // namespace rdm
