#include "physics/collision/broadphase.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/simd.hpp"

namespace rdm {
namespace {

constexpr int32_t kBatch = 64;      // pairs
constexpr float kFar = 1e30f;       // m
constexpr float kSlack = 1e-5f;     // m, for the rounding of bounds
constexpr float kFlatness = 1e-6f;  // of two axes that count as parallel

using Lanes = Simd<float, 4>;
using Four = Lanes::V;

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
  const Four one = Lanes::all(1);
  x = x < -one ? -one : x;
  return x > one ? one : x;
}

Four dot(const Four* a, const Four* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Squared distances of four pairs of segments p + s u and q + t v, |s|, |t| <= 1, by coordinate. The lines
// are nearest where d/ds = d/dt = 0 of |p - q + s u - t v|^2; an end takes the place of what lies beyond it.
Four segment_distance(const Four* p, const Four* u, const Four* q, const Four* v) {
  const Four tiny = Lanes::all(1e-10f);
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

Pose rest_pose(const Scene& scene, const SceneShape& shape) {
  if (shape.carrier != Carrier::kBase || scene.moves(shape)) return shape.def.X_LS;
  return scene.def.articulations[static_cast<size_t>(shape.articulation)].X_WB * shape.def.X_LS;
}

void BroadPhase::carve(const Scene& scene, Arena& arena) {
  bounds_ = arena.make<Bound>(scene.shapes.size());
  pairs_ = arena.make<Pair>(scene.pairs.size());
  const auto planes = std::count_if(scene.shapes.begin(), scene.shapes.end(),
                                    [](const SceneShape& s) { return s.radius < 0; });
  planes_ = arena.make<Plane>(static_cast<size_t>(planes));
  boxes_ = arena.make<Box>(scene.def.articulations.size());
  neighbours_ = arena.make<uint8_t>(scene.shapes.size());
}

void BroadPhase::make(const Scene& scene) {
  for (size_t i = 0; i < scene.shapes.size(); ++i) {
    const SceneShape& s = scene.shapes[i];
    const Pose X_WS = rest_pose(scene, s);
    const Capsule capsule = capsule_around(s);
    const Vec3 axis = rotate(X_WS.q, capsule.axis);
    Bound& bound = bounds_[i];
    bound.center[3] = static_cast<float>(s.radius);
    bound.axis[3] = static_cast<float>(capsule.radius);
    for (int k = 0; k < 3; ++k) {
      bound.center[k] = static_cast<float>(X_WS.p[k]);
      bound.axis[k] = static_cast<float>(axis[k]);
    }
  }
  for (size_t k = 0; k < scene.pairs.size(); ++k) {
    const ShapePair& pair = scene.pairs[k];
    const float reach = bounds_[pair.a].axis[3] + bounds_[pair.b].axis[3] + kSlack;
    const float spheres = bounds_[pair.a].center[3] + bounds_[pair.b].center[3] + kSlack;
    pairs_[k] = {pair.a, pair.b, reach * reach, spheres * spheres, -1};
    if (pair.reach >= 0) continue;
    const auto before = std::count_if(scene.shapes.begin(), scene.shapes.begin() + pair.b,
                                      [](const SceneShape& s) { return s.radius < 0; });
    pairs_[k] = {pair.a, pair.b, kFar, kFar, static_cast<int32_t>(before)};
    const Pose X_WS = rest_pose(scene, scene.shapes[static_cast<size_t>(pair.b)]);
    const Vec3 n = rotate(X_WS.q, {0, 0, 1});
    planes_[before] = {n, rdm::dot(n, X_WS.p)};
  }
}

void BroadPhase::update_boxes(const Scene& scene) {
  for (size_t a = 0; a < scene.def.articulations.size(); ++a) {
    const int32_t first = scene.first_shape[a];
    const auto end = first + static_cast<int32_t>(scene.def.articulations[a].shapes.size());
    Four low = Lanes::all(kFar), high = Lanes::all(-kFar);
    for (int32_t i = first; i < end; ++i) {
      const Four c = load(bounds_[i].center), r = Lanes::all(c[3] + kSlack), x = c - r, y = c + r;
      low = x < low ? x : low;
      high = y > high ? y : high;
    }
    store(boxes_[a].low, low);
    store(boxes_[a].high, high);
  }
}

bool BroadPhase::near(const Bound& bound, const Box& box) {
  const Four c = load(bound.center), zero{};
  const Four under = load(box.low) - c, over = c - load(box.high);
  Four d = under > over ? under : over;
  d = d > zero ? d : zero;
  return dot3(d, d) < c[3] * c[3];
}

bool BroadPhase::on_plane(const Pair& pair) const {
  const Bound& a = bounds_[pair.a];
  const Plane& plane = planes_[pair.plane];
  const Vec3 c{a.center[0], a.center[1], a.center[2]};
  return rdm::dot(c, plane.n) - plane.d < a.center[3] + kSlack;
}

bool BroadPhase::near(int32_t pair) const {
  const int32_t list[4] = {pair, pair, pair, pair};
  return near_four(list) != 0 && (pairs_[pair].plane < 0 || on_plane(pairs_[pair]));
}

// Shapes of an articulation that are near another's box.
void BroadPhase::mark_neighbours(const Scene& scene, int32_t articulation, const Box& box) {
  const int32_t first = scene.first_shape[static_cast<size_t>(articulation)];
  const auto count = scene.def.articulations[static_cast<size_t>(articulation)].shapes.size();
  for (int32_t i = first; i < first + static_cast<int32_t>(count); ++i)
    neighbours_[i] = near(bounds_[i], box);
}

// Bit k: the bounds of pair list[k] meet, or one of them is a plane; four of them.
uint32_t BroadPhase::near_four(const int32_t* list) const {
  const float *a[4], *b[4], *u[4], *v[4];
  Four gap{}, reach{};
  for (int k = 0; k < 4; ++k) {
    const Pair& pair = pairs_[list[k]];
    gap[k] = pair.gap;
    reach[k] = pair.reach;
    a[k] = bounds_[pair.a].center, u[k] = bounds_[pair.a].axis;
    b[k] = bounds_[pair.b].center, v[k] = bounds_[pair.b].axis;
  }
  Four p[4], q[4], pu[4], qv[4];
  Lanes::gather(a, 4, p), Lanes::gather(b, 4, q);
  const Four d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
  if (Lanes::bits(dot(d, d) < reach) == 0) return 0;
  Lanes::gather(u, 4, pu), Lanes::gather(v, 4, qv);
  return Lanes::bits(segment_distance(p, pu, q, qv) < gap);
}

void BroadPhase::search(const Scene& scene, Visit visit, void* context) {
  update_boxes(scene);
  int32_t marked[2] = {-1, -1};  // the articulations that neighbours_ is about
  for (const PairRun& run : scene.runs) {
    if (run.shape >= 0 && !near(bounds_[run.shape], boxes_[run.articulation])) continue;
    const int32_t owner = run.shape < 0 ? -1 : scene.shapes[static_cast<size_t>(run.shape)].articulation;
    if (owner >= 0 && (owner != marked[0] || run.articulation != marked[1])) {
      marked[0] = owner;
      marked[1] = run.articulation;
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
        if (const int32_t pair = list[std::countr_zero(bits)];
            pairs_[pair].plane < 0 || on_plane(pairs_[pair]))
          visit(context, pair);
    }
  }
}

}  // namespace rdm
