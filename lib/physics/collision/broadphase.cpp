#include "physics/collision/broadphase.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/simd.hpp"

namespace rdm {
namespace {

constexpr int32_t kBatch = 64;        // pairs
constexpr float kFar = 1e30f;         // m
constexpr float kEverywhere = 1e15f;  // m, radius of a plane's bound: its square is a number
constexpr int32_t kPartShapes = 6;
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

int32_t parts_in(const ArticulationDef& def) {
  return (static_cast<int32_t>(def.shapes.size()) + kPartShapes - 1) / kPartShapes;
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

template <class Use>
void BroadPhase::each_row(const Scene& scene, const Use& use) const {
  Row row{};
  const auto part_of = [&](const SceneShape& s, int32_t shape) {
    int32_t part = 0;
    for (int32_t a = 0; a < s.articulation; ++a)
      part += parts_in(scene.def.articulations[static_cast<size_t>(a)]);
    return part + (shape - scene.first_shape[static_cast<size_t>(s.articulation)]) / kPartShapes;
  };
  int32_t last = -1;  // shape a of the row
  for (const PairRun& run : scene.runs) {
    for (int32_t k = run.first; run.shape < 0 && k < run.first + run.count; ++k) {
      const ShapePair& pair = scene.pairs[static_cast<size_t>(k)];
      const SceneShape& a = scene.shapes[static_cast<size_t>(pair.a)];
      const int32_t other = pair.b - first_other_;
      const bool whole = a.articulation >= 0 && other >= 0;
      const bool goes_on = row.count > 0 && (whole ? row.part >= 0 && pair.a == last && other % 64 != 0 &&
                                                         other == row.first_other + row.count
                                                   : row.part < 0);
      if (goes_on) {
        ++row.count;
        continue;
      }
      if (row.count > 0) use(row);
      row = {k, 1, whole ? part_of(a, pair.a) : -1, whole ? other : -1};
      last = pair.a;
    }
    if (row.count > 0) use(row);
    row.count = 0;
  }
}

void BroadPhase::carve(const Scene& scene, Arena& arena) {
  const auto planes = std::count_if(scene.shapes.begin(), scene.shapes.end(),
                                    [](const SceneShape& s) { return s.radius < 0; });
  first_other_ = scene.first_body_shape;
  num_others_ = static_cast<int32_t>(scene.shapes.size()) - first_other_;
  num_parts_ = 0;
  for (const ArticulationDef& def : scene.def.articulations) num_parts_ += parts_in(def);
  words_ = (num_others_ + 63) / 64;
  num_rows_ = 0;
  each_row(scene, [&](const Row&) { ++num_rows_; });
  const auto parts = static_cast<size_t>(num_parts_), others = static_cast<size_t>(num_others_);
  bounds_ = arena.make<Bound>(scene.shapes.size());
  pairs_ = arena.make<Pair>(scene.pairs.size());
  planes_ = arena.make<Plane>(static_cast<size_t>(planes));
  boxes_ = arena.make<Box>(scene.def.articulations.size());
  parts_ = arena.make<Part>(parts);
  part_boxes_ = arena.make<Box>(parts);
  part_lanes_ = arena.make<BoxLanes>((parts + 3) / 4);
  other_plane_ = arena.make<int32_t>(others);
  neighbours_ = arena.make<uint8_t>(scene.shapes.size());
  near_ = arena.make<uint64_t>(parts * static_cast<size_t>(words_));
  rows_ = arena.make<Row>(static_cast<size_t>(num_rows_));
}

void BroadPhase::make(const Scene& scene) {
  int32_t planes = 0;
  for (size_t i = 0; i < scene.shapes.size(); ++i) {
    const SceneShape& s = scene.shapes[i];
    const Pose X_WS = rest_pose(scene, s);
    const bool plane = s.radius < 0;
    const Capsule capsule = plane ? Capsule{{}, kEverywhere} : capsule_around(s);
    const Vec3 axis = rotate(X_WS.q, capsule.axis);
    Bound& bound = bounds_[i];
    bound.center[3] = plane ? kEverywhere : static_cast<float>(s.radius);
    bound.axis[3] = static_cast<float>(capsule.radius);
    for (int k = 0; k < 3; ++k) {
      bound.center[k] = static_cast<float>(X_WS.p[k]);
      bound.axis[k] = static_cast<float>(axis[k]);
    }
    if (const int32_t other = static_cast<int32_t>(i) - first_other_; other >= 0)
      other_plane_[other] = plane ? planes : -1;
    if (!plane) continue;
    const Vec3 n = rotate(X_WS.q, {0, 0, 1});
    planes_[planes++] = {n, rdm::dot(n, X_WS.p)};
  }
  for (int32_t k = num_parts_; k % 4 != 0; ++k)  // nothing
    for (int r = 0; r < 3; ++r) {
      part_lanes_[k / 4].low[r][k % 4] = kFar;
      part_lanes_[k / 4].high[r][k % 4] = -kFar;
    }
  Part* part = parts_;
  for (size_t a = 0; a < scene.def.articulations.size(); ++a) {
    const int32_t begin = scene.first_shape[a],
                  end = begin + static_cast<int32_t>(scene.def.articulations[a].shapes.size());
    for (int32_t first = begin; first < end; first += kPartShapes)
      *part++ = {static_cast<int32_t>(a), first, std::min(first + kPartShapes, end)};
  }
  for (size_t k = 0; k < scene.pairs.size(); ++k) {
    const ShapePair& pair = scene.pairs[k];
    const int32_t other = pair.b - first_other_;
    pairs_[k] = {pair.a, pair.b, other >= 0 ? other_plane_[other] : -1};
  }
  Row* row = rows_;
  each_row(scene, [&](const Row& r) { *row++ = r; });
}

void BroadPhase::update_boxes(const Scene& scene) {
  const Box nothing = {{kFar, kFar, kFar, kFar}, {-kFar, -kFar, -kFar, -kFar}};
  for (size_t a = 0; a < scene.def.articulations.size(); ++a) boxes_[a] = nothing;
  for (int32_t k = 0; k < num_parts_; ++k) {
    const Part& part = parts_[k];
    Float4 low = splat(kFar), high = splat(-kFar);
    for (int32_t i = part.first; i < part.end; ++i) {
      const Float4 c = load4(bounds_[i].center), r = splat(c[3] + kSlack), x = c - r, y = c + r;
      low = x < low ? x : low;
      high = y > high ? y : high;
    }
    store4(part_boxes_[k].low, low);
    store4(part_boxes_[k].high, high);
    for (int r = 0; r < 3; ++r) {
      part_lanes_[k / 4].low[r][k % 4] = low[r];
      part_lanes_[k / 4].high[r][k % 4] = high[r];
    }
    Box& box = boxes_[part.articulation];
    store4(box.low, min(load4(box.low), low));
    store4(box.high, max(load4(box.high), high));
  }
}

bool BroadPhase::near(const Bound& bound, const Box& box) {
  const Float4 c = load4(bound.center), zero{};
  const Float4 under = load4(box.low) - c, over = c - load4(box.high);
  Float4 d = under > over ? under : over;
  d = d > zero ? d : zero;
  return dot3(d, d) < c[3] * c[3];
}

uint32_t BroadPhase::near(const Bound& bound, const BoxLanes& boxes) {
  const Float4 zero{};
  Float4 d[3];
  for (int k = 0; k < 3; ++k) {
    const Float4 c = splat(bound.center[k]);
    const Float4 under = load4(boxes.low[k]) - c, over = c - load4(boxes.high[k]);
    d[k] = under > over ? under : over;
    d[k] = d[k] > zero ? d[k] : zero;
  }
  return bits_of(dot(d, d) < splat(bound.center[3] * bound.center[3]));
}

// The corner farthest below it.
bool BroadPhase::near(const Plane& plane, const Box& box) {
  Vec3 corner;
  for (int k = 0; k < 3; ++k) corner[k] = plane.n[k] > 0 ? box.low[k] : box.high[k];
  return rdm::dot(corner, plane.n) - plane.d < kSlack;
}

bool BroadPhase::on_plane(const Pair& pair) const {
  const Bound& a = bounds_[pair.a];
  const Plane& plane = planes_[pair.plane];
  const Vec3 c{a.center[0], a.center[1], a.center[2]};
  return rdm::dot(c, plane.n) - plane.d < a.center[3] + kSlack;
}

bool BroadPhase::near(int32_t pair) const {
  const int32_t list[4] = {pair, pair, pair, pair};
  if (pairs_[pair].plane >= 0) return on_plane(pairs_[pair]);
  return spheres_meet(list) != 0 && capsules_meet(list) != 0;
}

// Shapes of an articulation that are near another's box.
void BroadPhase::mark_neighbours(const Scene& scene, int32_t articulation, const Box& box) {
  const int32_t first = scene.first_shape[static_cast<size_t>(articulation)];
  const auto count = scene.def.articulations[static_cast<size_t>(articulation)].shapes.size();
  for (int32_t i = first; i < first + static_cast<int32_t>(count); ++i)
    neighbours_[i] = near(bounds_[i], box);
}

uint32_t BroadPhase::spheres_meet(const int32_t* list) const {
  Float4 p[4], q[4];
  for (int k = 0; k < 4; ++k) {
    const Pair& pair = pairs_[list[k]];
    p[k] = load4(bounds_[pair.a].center);
    q[k] = load4(bounds_[pair.b].center);
  }
  transpose(p), transpose(q);
  const Float4 d[3] = {p[0] - q[0], p[1] - q[1], p[2] - q[2]}, reach = p[3] + q[3] + splat(kSlack);
  return bits_of(dot(d, d) < reach * reach);
}

uint32_t BroadPhase::capsules_meet(const int32_t* list) const {
  Float4 p[4], u[4], q[4], v[4];
  for (int k = 0; k < 4; ++k) {
    const Bound &a = bounds_[pairs_[list[k]].a], &b = bounds_[pairs_[list[k]].b];
    p[k] = load4(a.center), u[k] = load4(a.axis);
    q[k] = load4(b.center), v[k] = load4(b.axis);
  }
  transpose(p), transpose(q), transpose(u), transpose(v);
  const Float4 reach = u[3] + v[3] + splat(kSlack);
  return bits_of(segment_distance(p, u, q, v) < reach * reach);
}

// What is no link and near a part of an articulation.
void BroadPhase::mark_others() {
  std::fill_n(near_, num_parts_ * words_, uint64_t{0});
  for (int32_t i = 0; i < num_others_; ++i) {
    const Bound& bound = bounds_[first_other_ + i];
    const int32_t plane = other_plane_[i];
    const auto mark = [&](int32_t part) { near_[part * words_ + i / 64] |= uint64_t{1} << (i % 64); };
    for (int32_t k = 0; plane >= 0 && k < num_parts_; ++k)
      if (near(planes_[plane], part_boxes_[k])) mark(k);
    for (int32_t k = 0; plane < 0 && k < num_parts_; k += 4)
      for (uint32_t bits = near(bound, part_lanes_[k / 4]); bits != 0; bits &= bits - 1)
        mark(k + std::countr_zero(bits));
  }
}

// Of at most kBatch pairs: all tests before any of the collisions, so that they overlap in the machine. The
// list has room up to a multiple of four.
void BroadPhase::visit_near(int32_t* list, int32_t count, Visit visit, void* context) const {
  int32_t near[kBatch + 3], found = 0;
  for (int32_t k = count; k % 4 != 0; ++k) list[k] = list[0];
  for (int32_t k = 0; k < count; k += 4) {
    const uint32_t bits = spheres_meet(list + k);
    for (int32_t i = 0; i < std::min(4, count - k); ++i) {
      near[found] = list[k + i];
      found += bits >> i & 1;
    }
  }
  for (int32_t k = found; k % 4 != 0; ++k) near[k] = near[0];
  uint64_t bits = 0;
  for (int32_t k = 0; k < found; k += 4) bits |= uint64_t{capsules_meet(near + k)} << k;
  if (found < kBatch) bits &= (uint64_t{1} << found) - 1;
  for (; bits != 0; bits &= bits - 1) visit(context, near[std::countr_zero(bits)]);
}

void BroadPhase::search_listed(const PairList& listed, Visit visit, void* context) {
  for (int32_t at = 0; at < listed.count;) {
    int32_t list[kBatch + 3], count = 0;
    for (; at < listed.count && count < kBatch; ++at) {
      const Pair& pair = pairs_[listed.pairs[at]];
      if (pair.plane < 0 || on_plane(pair)) list[count++] = listed.pairs[at];
    }
    visit_near(list, count, visit, context);
  }
}

void BroadPhase::search(const Scene& scene, const PairList* listed, Visit visit, void* context) {
  update_boxes(scene);
  mark_others();
  int32_t list[kBatch + 3], count = 0;
  const auto add = [&](int32_t pair) {
    list[count++] = pair;
    if (count < kBatch) return;
    visit_near(list, count, visit, context);
    count = 0;
  };
  int32_t marked[2] = {-1, -1};  // the articulations that neighbours_ is about
  const auto try_pair = [&](int32_t pair) {
    if (pairs_[pair].plane < 0 || on_plane(pairs_[pair])) add(pair);
  };
  int32_t at = 0;  // in the list of those to search
  const Row* row = rows_;
  for (const PairRun& run : scene.runs) {
    const int32_t end = run.first + run.count;
    for (; run.shape < 0 && row < rows_ + num_rows_ && row->first < end; ++row) {
      const int32_t row_end = row->first + row->count;
      uint64_t bits = row->part < 0 ? 0 : near_others(*row);
      // of a row that is listed as a whole, or all are, only those that are near
      const int32_t last = at + row->count - 1;
      const bool whole = !listed || (last < listed->count && listed->pairs[at] == row->first &&
                                     listed->pairs[last] == row_end - 1);
      if (whole) at += row->count;
      if (whole && row->part >= 0) {
        for (; bits != 0; bits &= bits - 1) try_pair(row->first + std::countr_zero(bits));
      } else if (whole) {
        for (int32_t k = row->first; k < row_end; ++k) try_pair(k);
      } else {
        for (; at < listed->count && listed->pairs[at] < row_end; ++at)
          if (row->part < 0 || (bits >> (listed->pairs[at] - row->first) & 1) != 0)
            try_pair(listed->pairs[at]);
      }
    }
    if (run.shape < 0) continue;
    if (!near(bounds_[run.shape], boxes_[run.articulation])) continue;
    const int32_t owner = scene.shapes[static_cast<size_t>(run.shape)].articulation;
    if (owner >= 0 && (owner != marked[0] || run.articulation != marked[1])) {
      marked[0] = owner;
      marked[1] = run.articulation;
      mark_neighbours(scene, run.articulation, boxes_[owner]);
    }
    for (int32_t k = run.first; k < end; ++k)
      if (owner < 0 || neighbours_[pairs_[k].b] != 0) add(k);
  }
  visit_near(list, count, visit, context);
}

}  // namespace rdm
