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

float dot3(Float4 a, Float4 b) {
  const Float4 p = a * b;
  return p[0] + p[1] + p[2];
}

Float4 clamp_unit(Float4 x) {
  const Float4 one = splat(1.0f);
  x = x < -one ? -one : x;
  return x > one ? one : x;
}

Float4 dot(const Float4* a, const Float4* b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// Squared distances of four pairs of segments p + s u and q + t v, |s|, |t| <= 1, by coordinate. The lines
// are nearest where d/ds = d/dt = 0 of |p - q + s u - t v|^2; an end takes the place of what lies beyond it.
[[gnu::always_inline]] inline Float4 segment_distance(const Float4* p, const Float4* u, const Float4* q,
                                                      const Float4* v) {
  const Float4 tiny = splat(1e-10f);
  const Float4 r[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
  const Float4 a = dot(u, u) + tiny, e = dot(v, v) + tiny, b = dot(u, v), c = dot(u, r), f = dot(v, r);
  const Float4 d = a * e - b * b;
  const Float4 s = clamp_unit(d > kFlatness * a * e ? (b * f - c * e) / d : -c / a);
  const Float4 t = (b * s + f) / e, inside = clamp_unit(t);
  const Float4 s2 = t == inside ? s : clamp_unit((b * inside - c) / a);
  Float4 w[3];
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
  marks_ = arena.make<uint8_t>(scene.def.articulations.size() * static_cast<size_t>(scene.num_body_shapes));
}

void BroadPhase::make(const Scene& scene) {
  sized_ = scene.def.adjustable;
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
    const SceneShape &x = scene.shapes[static_cast<size_t>(pair.a)],
                     &y = scene.shapes[static_cast<size_t>(pair.b)];
    const int32_t mark = x.articulation >= 0 && y.carrier == Carrier::kBody
                             ? x.articulation * scene.num_body_shapes + pair.b - scene.first_body_shape
                             : -1;
    pairs_[k] = {pair.a, pair.b, reach * reach, spheres * spheres, -1, mark};
    if (pair.reach >= 0) continue;
    const auto before = std::count_if(scene.shapes.begin(), scene.shapes.begin() + pair.b,
                                      [](const SceneShape& s) { return s.radius < 0; });
    pairs_[k] = {pair.a, pair.b, kFar, kFar, static_cast<int32_t>(before), -1};
    const Pose X_WS = rest_pose(scene, scene.shapes[static_cast<size_t>(pair.b)]);
    const Vec3 n = rotate(X_WS.q, {0, 0, 1});
    planes_[before] = {n, rdm::dot(n, X_WS.p)};
  }
}

void BroadPhase::update_boxes(const Scene& scene) {
  for (size_t a = 0; a < scene.def.articulations.size(); ++a) {
    const int32_t first = scene.first_shape[a];
    const auto end = first + static_cast<int32_t>(scene.def.articulations[a].shapes.size());
    Float4 low = splat(kFar), high = splat(-kFar);
    for (int32_t i = first; i < end; ++i) {
      const Float4 c = load4(bounds_[i].center), r = splat(c[3] + kSlack), x = c - r, y = c + r;
      low = x < low ? x : low;
      high = y > high ? y : high;
    }
    store4(boxes_[a].low, low);
    store4(boxes_[a].high, high);
  }
}

bool BroadPhase::near(const Bound& bound, const Box& box) {
  const Float4 c = load4(bound.center), zero{};
  const Float4 under = load4(box.low) - c, over = c - load4(box.high);
  Float4 d = under > over ? under : over;
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

uint32_t BroadPhase::near_four(const int32_t* list) const {
  return sized_ ? near_four_of<true>(list) : near_four_of<false>(list);
}

template <bool kSized>
uint32_t BroadPhase::near_four_of(const int32_t* list) const {
  Float4 p[4], u[4], q[4], v[4], gap{}, reach{};
  for (int k = 0; k < 4; ++k) {
    const Pair& pair = pairs_[list[k]];
    const Bound &a = bounds_[pair.a], &b = bounds_[pair.b];
    gap[k] = pair.gap;
    reach[k] = pair.reach;
    if (kSized && pair.plane < 0) {
      const float narrow = a.axis[3] + b.axis[3] + kSlack, wide = a.center[3] + b.center[3] + kSlack;
      gap[k] = narrow * narrow;
      reach[k] = wide * wide;
    }
    p[k] = load4(a.center), u[k] = load4(a.axis);
    q[k] = load4(b.center), v[k] = load4(b.axis);
  }
  transpose(p), transpose(q);
  const Float4 d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]};
  if (bits_of(dot(d, d) < reach) == 0) return 0;
  transpose(u), transpose(v);
  return bits_of(segment_distance(p, u, q, v) < gap);
}

// The free bodies' shapes that are near an articulation's box.
void BroadPhase::mark_bodies(const Scene& scene) {
  uint8_t* mark = marks_;
  for (size_t a = 0; a < scene.def.articulations.size(); ++a)
    for (int32_t i = 0; i < scene.num_body_shapes; ++i)
      *mark++ = near(bounds_[scene.first_body_shape + i], boxes_[a]);
}

// Of at most kBatch pairs: all tests before any of the collisions, so that they overlap in the machine. The
// list is filled up to a multiple of four.
void BroadPhase::visit_near(int32_t* list, int32_t count, Visit visit, void* context) const {
  for (int32_t k = count; k % 4 != 0; ++k) list[k] = list[0];
  uint64_t bits = 0;
  for (int32_t k = 0; k < count; k += 4) bits |= uint64_t{near_four(list + k)} << k;
  if (count < kBatch) bits &= (uint64_t{1} << count) - 1;
  for (; bits != 0; bits &= bits - 1)
    if (const int32_t pair = list[std::countr_zero(bits)]; pairs_[pair].plane < 0 || on_plane(pairs_[pair]))
      visit(context, pair);
}

void BroadPhase::search_listed(const PairList& listed, Visit visit, void* context) {
  for (int32_t at = 0; at < listed.count;) {
    int32_t list[kBatch + 3], count = 0;
    while (at < listed.count && count < kBatch) list[count++] = listed.pairs[at++];
    visit_near(list, count, visit, context);
  }
}

void BroadPhase::search(const Scene& scene, const PairList* listed, Visit visit, void* context) {
  update_boxes(scene);
  mark_bodies(scene);
  int32_t marked[2] = {-1, -1};  // the articulations that neighbours_ is about
  int32_t at = 0;                // in the list
  for (const PairRun& run : scene.runs) {
    if (run.shape >= 0 && !near(bounds_[run.shape], boxes_[run.articulation])) continue;
    const int32_t owner = run.shape < 0 ? -1 : scene.shapes[static_cast<size_t>(run.shape)].articulation;
    if (owner >= 0 && (owner != marked[0] || run.articulation != marked[1])) {
      marked[0] = owner;
      marked[1] = run.articulation;
      mark_neighbours(scene, run.articulation, boxes_[owner]);
    }
    const int32_t end = run.first + run.count;
    if (listed && run.shape < 0) {
      while (at < listed->count && listed->pairs[at] < end) {
        int32_t list[kBatch + 3], count = 0;
        for (; at < listed->count && listed->pairs[at] < end && count < kBatch; ++at)
          if (!passed_over(listed->pairs[at])) list[count++] = listed->pairs[at];
        visit_near(list, count, visit, context);
      }
      continue;
    }
    for (int32_t first = run.first; first < end;) {
      int32_t list[kBatch + 3], count = 0;
      for (; first < end && count < kBatch; ++first)
        if (owner < 0 ? !passed_over(first) : neighbours_[pairs_[first].b] != 0) list[count++] = first;
      visit_near(list, count, visit, context);
    }
  }
}

}  // namespace rdm
