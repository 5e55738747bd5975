#include "physics/collision/broadphase.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/simd.hpp"

namespace rdm {
namespace {

constexpr int32_t kBatch = 64;        // pairs
constexpr float kEverywhere = 1e15f;  // m, radius of a plane's bound: its square is a number
constexpr int32_t kBlock = 4;
constexpr float kSlack = kBoundSlack, kCenterSlack = kBoundCenterSlack, kFlatness = kBoundFlatness,
                kFar = kBoundFar;
// How far two shapes may overlap before they must be found: a share of the thinner one's half width, and at most m.
// Slower pairs are not looked at ahead (BroadPhase::thin).
constexpr float kThinShare = 0.5f, kMostThin = 1.5e-3f;

Float4 clamp_unit(Float4 x) {
  return min(splat(1.0f), max(splat(-1.0f), x));
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

Float4 slack_at(const Bound& bound) {
  return splat(kSlack) + kCenterSlack * abs(load4(bound.center));
}

// Half sides of the box around a bound's capsule.
Float4 half_sides(const Bound& bound) {
  const Float4 u = load4(bound.axis);
  return abs(u) + splat(u[3]) + slack_at(bound);
}

// Half of the least width, m: of a hull, among the directions of its faces.
float half_width_of(const SceneShape& shape, const Hull* hull) {
  const Vec3& s = shape.def.size;
  switch (shape.def.kind) {
    case ShapeKind::kBox:
    case ShapeKind::kEllipsoid:
      return static_cast<float>(std::min({s.x, s.y, s.z}));
    case ShapeKind::kCylinder:
      return static_cast<float>(std::min(s.x, s.y));
    case ShapeKind::kHull: {
      double least = HUGE_VAL;
      for (int32_t i = 0; i < hull->num_faces; ++i) {
        const Hull::Face& face = hull->faces[i];
        double width = 0;
        for (int32_t k = 0; k < hull->num_points; ++k)
          width = std::max(width, rdm::dot(face.n, hull->corner(face, 0) - hull->points[k]));
        least = std::min(least, width);
      }
      return static_cast<float>(0.5 * least);
    }
    case ShapeKind::kSphere:
    case ShapeKind::kCapsule:
      return static_cast<float>(s.x);
    case ShapeKind::kPlane:
      break;
  }
  return kFar;
}

// Points of two segments p + s u and q + t v, |s|, |t| <= 1, that are nearest or nearly so; a - b.
Vec3 between_segments(const Vec3& r, const Vec3& u, const Vec3& v) {
  const double a = rdm::dot(u, u) + 1e-12, e = rdm::dot(v, v) + 1e-12, b = rdm::dot(u, v), c = rdm::dot(u, r),
               f = rdm::dot(v, r), d = a * e - b * b;
  const auto unit = [](double x) { return std::clamp(x, -1.0, 1.0); };
  double s = unit(d > 1e-9 * a * e ? (b * f - c * e) / d : -c / a);
  const double t = unit((b * s + f) / e);
  s = unit((b * t - c) / a);
  return r + s * u - t * v;
}

// use(k) of the bits k in [first, end) that are set, in their order.
template <class Use>
void each_bit(const uint64_t* bits, int32_t first, int32_t end, const Use& use) {
  for (int32_t word = first / 64; word * 64 < end; ++word) {
    uint64_t here = bits[word];
    if (const int32_t before = first - word * 64; before > 0) here &= ~uint64_t{0} << before;
    if (const int32_t within = end - word * 64; within < 64) here &= (uint64_t{1} << within) - 1;
    for (; here != 0; here &= here - 1) use(word * 64 + std::countr_zero(here));
  }
}

int32_t blocks_in(const ArticulationDef& def) {
  return (static_cast<int32_t>(def.shapes.size()) + kBlock - 1) / kBlock;
}

}  // namespace

Capsule capsule_around(const SceneShape& shape) {
  const Vec3& s = shape.def.size;
  const Capsule sphere = {{}, shape.radius};
  if (shape.def.kind == ShapeKind::kCapsule) return {{0, 0, s.y}, s.x};
  // links are bounded by spheres, because the engine does not compute their axes
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
  for (const PairRun& run : scene.runs) {
    if (run.shape >= 0) {
      const int32_t owner = scene.shapes[static_cast<size_t>(run.shape)].articulation;
      use(Row{Row::kRun, run.first, run.count, run.shape, 0, 0, run.articulation, owner, 0, 0, 0});
      continue;
    }
    Row row{};
    for (int32_t k = run.first; k < run.first + run.count; ++k) {
      const ShapePair& pair = scene.pairs[static_cast<size_t>(k)];
      const int32_t other = pair.b - first_other_;
      const bool link = pair.a < first_other_, whole = link && other >= 0,
                 plane = !whole && other >= 0 && scene.shapes[static_cast<size_t>(pair.b)].radius < 0;
      const Row::Kind kind = whole ? Row::kOthers : plane ? Row::kPlane : link ? Row::kLink : Row::kAny;
      const bool follows =
          row.shape == pair.a && row.shift + row.count < 64 && other % 64 == row.shift + row.count;
      if (row.count > 0 && row.kind == kind && !plane && (!whole || follows)) {
        ++row.count;
        continue;
      }
      if (row.count > 0) use(row);
      row = {kind, k, 1, -1, 0, 0, -1, -1, 0, 0, 0};
      if (whole)
        row = {Row::kOthers, k, 1, pair.a, pair.a * words_ + other / 64, other % 64, -1, -1, 0, 0, 0};
    }
    use(row);
  }
}

void BroadPhase::carve(const Scene& scene, Arena& arena) {
  const auto planes = std::count_if(scene.shapes.begin(), scene.shapes.end(),
                                    [](const SceneShape& s) { return s.radius < 0; });
  first_other_ = scene.first_body_shape;
  num_others_ = static_cast<int32_t>(scene.shapes.size()) - first_other_;
  num_articulations_ = static_cast<int32_t>(scene.def.articulations.size());
  num_blocks_ = 0;
  for (const ArticulationDef& def : scene.def.articulations) num_blocks_ += blocks_in(def);
  words_ = (num_others_ + 63) / 64;
  num_rows_ = 0;
  each_row(scene, [&](const Row&) { ++num_rows_; });
  const auto links = static_cast<size_t>(first_other_), others = static_cast<size_t>(num_others_);
  num_moving_ = first_other_ + scene.num_body_shapes;
  bounds_ = arena.make<Bound>(scene.shapes.size());
  ways_ = arena.make<float>(scene.shapes.size());
  half_widths_ = arena.make<float>(scene.shapes.size());
  extents_ = arena.make<Extent>(scene.shapes.size());
  pairs_ = arena.make<Pair>(scene.pairs.size());
  planes_ = arena.make<Plane>(static_cast<size_t>(planes));
  boxes_ = arena.make<Box>(scene.def.articulations.size());
  blocks_ = arena.make<Block>(static_cast<size_t>(num_blocks_));
  block_end_ = arena.make<int32_t>(scene.def.articulations.size());
  other_plane_ = arena.make<int32_t>(others);
  neighbours_ = arena.make<uint8_t>(scene.shapes.size());
  near_ = arena.make<uint64_t>(links * static_cast<size_t>(words_));
  rows_ = arena.make<Row>(static_cast<size_t>(num_rows_));
  num_listed_ = 0;
  for (const PairRun& run : scene.runs) num_listed_ += run.shape < 0 ? run.count : 0;
  crowd_.carve(scene, arena);
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
    store4(extents_[i].half, half_sides(bound));
    const Mat3 R = to_matrix(X_WS.q);
    for (int k = 0; s.def.kind == ShapeKind::kBox && k < 3; ++k) {
      const Vec3& half = s.def.size;
      extents_[i].half[k] = static_cast<float>(std::fabs(R(k, 0)) * half.x + std::fabs(R(k, 1)) * half.y +
                                               std::fabs(R(k, 2)) * half.z) +
                            slack_at(bound)[k];
    }
    if (const int32_t other = static_cast<int32_t>(i) - first_other_; other >= 0)
      other_plane_[other] = plane ? planes : -1;
    if (!plane) continue;
    const Vec3 n = rotate(X_WS.q, {0, 0, 1});
    planes_[planes++] = {n, rdm::dot(n, X_WS.p)};
  }
  int32_t blocks = 0;
  for (size_t a = 0; a < scene.def.articulations.size(); ++a) {
    const int32_t begin = scene.first_shape[a],
                  end = begin + static_cast<int32_t>(scene.def.articulations[a].shapes.size());
    for (int32_t first = begin; first < end; first += kBlock)
      blocks_[blocks++] = {first, std::min(kBlock, end - first), {}, {}};
    block_end_[a] = blocks;
  }
  for (size_t i = 0; i < scene.shapes.size(); ++i)
    half_widths_[i] = half_width_of(scene.shapes[i], scene.hull_of(scene.shapes[i]));
  const auto of_body = [&](int32_t shape) { return shape >= first_other_ && shape < num_moving_; };
  least_thin_ = kFar;
  for (size_t k = 0; k < scene.pairs.size(); ++k) {
    const ShapePair& pair = scene.pairs[k];
    const int32_t other = pair.b - first_other_;
    const float thin =
        of_body(pair.a) || of_body(pair.b)
            ? std::min(kMostThin, kThinShare * std::min(half_widths_[pair.a], half_widths_[pair.b]))
            : kFar;
    pairs_[k] = {pair.a, pair.b, other >= 0 ? other_plane_[other] : -1, thin};
    least_thin_ = std::min(least_thin_, thin);
  }
  crowd_.make(scene);
  Row* row = rows_;
  each_row(scene, [&](const Row& r) { *row++ = r; });
  for (int32_t i = num_rows_ - 1; i >= 0; --i) {
    Row& of = rows_[i];
    const bool with_robot = of.of_robot(), on = with_robot && i + 1 < num_rows_ && rows_[i + 1].of_robot();
    of.next = on ? rows_[i + 1].next : i + 1;
    of.end = on ? rows_[i + 1].end : of.first + of.count;
    of.listed = (of.kind == Row::kRun ? 0 : of.count) + (on ? rows_[i + 1].listed : 0);
  }
}

void BroadPhase::update_extents(int32_t first) {
  for (int32_t i = first; i < num_moving_; ++i) store4(extents_[i].half, half_sides(bounds_[i]));
  for (int32_t i = first_other_; ahead_ && i < num_moving_; ++i)
    store4(extents_[i].half, load4(extents_[i].half) + splat(ways_[i] + link_way_));
}

void BroadPhase::look_ahead(float link_way) {
  float fastest = 0;
  for (int32_t i = first_other_; i < num_moving_; ++i) fastest = std::max(fastest, ways_[i]);
  link_way_ = link_way;
  ahead_ = fastest + std::max(fastest, link_way) > least_thin_;
}

void BroadPhase::update_boxes() {
  int32_t k = 0;
  for (int32_t a = 0; a < num_articulations_; ++a) {
    Float4 low = splat(kFar), high = splat(-kFar);
    for (; k < block_end_[a]; ++k) {
      Block& block = blocks_[k];
      Float4 center[4], half[4];
      for (int i = 0; i < kBlock; ++i) {
        const int32_t shape = block.first + (i < block.count ? i : 0);
        center[i] = load4(bounds_[shape].center);
        half[i] = load4(extents_[shape].half);
        low = min(center[i] - half[i], low);
        high = max(center[i] + half[i], high);
      }
      transpose(center), transpose(half);
      for (int r = 0; r < 3; ++r) {
        store4(block.center[r], center[r]);
        store4(block.half[r], half[r]);
      }
    }
    store4(boxes_[a].low, low);
    store4(boxes_[a].high, high);
  }
}

bool BroadPhase::boxes_meet(int32_t a, int32_t b) const {
  const Float4 gap = abs(load4(bounds_[a].center) - load4(bounds_[b].center));
  return (bits_of(gap < load4(extents_[a].half) + load4(extents_[b].half)) & 7) == 7;
}

bool BroadPhase::near(int32_t shape, const Box& box) const {
  const Float4 c = load4(bounds_[shape].center), half = load4(extents_[shape].half);
  return (bits_of((load4(box.low) < c + half) & (load4(box.high) > c - half)) & 7) == 7;
}

uint32_t BroadPhase::near(int32_t shape, const Block& block) const {
  Int4 meet = splat_int(-1);
  for (int k = 0; k < 3; ++k) {
    const Float4 gap = abs(load4(block.center[k]) - splat(bounds_[shape].center[k]));
    meet &= gap < load4(block.half[k]) + splat(extents_[shape].half[k]);
  }
  return bits_of(meet);
}

// Bit k: the lowest corner of box k lies below the plane.
uint32_t BroadPhase::near(const Plane& plane, const Block& block) {
  Float4 above = splat(-static_cast<float>(plane.d)), reach{};
  for (int k = 0; k < 3; ++k) {
    const float n = static_cast<float>(plane.n[k]);
    above += n * load4(block.center[k]);
    reach += std::fabs(n) * load4(block.half[k]);
  }
  return bits_of(above < reach);
}

bool BroadPhase::near(const Plane& plane, const Box& box) {
  Vec3 corner;
  for (int k = 0; k < 3; ++k) corner[k] = static_cast<double>(plane.n[k] > 0 ? box.low[k] : box.high[k]);
  return rdm::dot(corner, plane.n) - plane.d < 0;
}

bool BroadPhase::on_plane(const Pair& pair) const {
  const Bound& bound = bounds_[pair.a];
  Float4 half = half_sides(bound);
  if (ahead_ && pair.a >= first_other_) half += splat(ways_[pair.a]);
  const Plane& plane = planes_[pair.plane];
  double above = -plane.d, reach = 0;
  for (int k = 0; k < 3; ++k) {
    above += plane.n[k] * static_cast<double>(bound.center[k]);
    reach += std::fabs(plane.n[k]) * static_cast<double>(half[k]);
  }
  return above < reach;
}

bool BroadPhase::near(int32_t pair) const {
  const int32_t list[4] = {pair, pair, pair, pair};
  return pairs_[pair].plane >= 0 ? on_plane(pairs_[pair]) : capsules_meet(list, nullptr) != 0;
}

// Shapes of an articulation that are near another's box.
void BroadPhase::mark_neighbours(const Scene& scene, int32_t articulation, const Box& box) {
  const int32_t first = scene.first_shape[static_cast<size_t>(articulation)];
  const auto count = scene.def.articulations[static_cast<size_t>(articulation)].shapes.size();
  for (int32_t i = first; i < first + static_cast<int32_t>(count); ++i) neighbours_[i] = near(i, box);
}

// Four planes are tried: the box's three sides, and the one square to the way from the box to the capsule's
// middle. With c and u the capsule's middle and half axis in the box's frame, r its radius and d a plane's
// direction, the two are apart if d . c - |d . u| - r |d| > |d_x| h_x + |d_y| h_y + |d_z| h_z.
bool BroadPhase::clears_box(int32_t shape, const Vec3& p_WB, const Mat3& R_WB, const Vec3& half) const {
  const Bound& bound = bounds_[shape];
  Vec3 middle, axis;
  for (int k = 0; k < 3; ++k) {
    middle[k] = static_cast<double>(bound.center[k]) - p_WB[k];
    axis[k] = static_cast<double>(bound.axis[k]);
  }
  const Mat3 R_BW = transpose(R_WB);
  const Vec3 c = R_BW * middle, u = R_BW * axis;
  const double far = std::max({std::fabs(p_WB.x), std::fabs(p_WB.y), std::fabs(p_WB.z)});
  const double r = static_cast<double>(bound.axis[3]) + static_cast<double>(kSlack) +
                   4 * static_cast<double>(kCenterSlack) * far;
  Vec3 d;
  for (int k = 0; k < 3; ++k) {
    if (std::fabs(c[k]) - std::fabs(u[k]) - r > half[k]) return true;
    d[k] = c[k] - std::clamp(c[k], -half[k], half[k]);
  }
  const double length = std::sqrt(rdm::dot(d, d));
  // d points away from the box, so that its support lies on c's side
  return rdm::dot(d, c) - std::fabs(rdm::dot(d, u)) - r * length >
         std::fabs(d.x) * half.x + std::fabs(d.y) * half.y + std::fabs(d.z) * half.z;
}

bool BroadPhase::passes(int32_t index, const Vec3& way) const {
  const Pair& pair = pairs_[index];
  if (pair.plane >= 0) return false;
  const Bound &a = bounds_[pair.a], &b = bounds_[pair.b];
  Vec3 r, u, v;
  for (int k = 0; k < 3; ++k) {
    r[k] = static_cast<double>(a.center[k]) - static_cast<double>(b.center[k]);
    u[k] = static_cast<double>(a.axis[k]);
    v[k] = static_cast<double>(b.axis[k]);
  }
  const auto slack = static_cast<double>(kSlack);
  // the spheres
  const double spheres = static_cast<double>(a.center[3]) + static_cast<double>(b.center[3]) + slack;
  const Vec3 nearest = r + std::clamp(-rdm::dot(r, way) / rdm::dot(way, way), 0.0, 1.0) * way;
  if (rdm::dot(nearest, nearest) > spheres * spheres) return true;
  // the capsules: a direction that separates them at the start and at the end separates them all the time between
  const Vec3 x = between_segments(r, u, v);
  const double length = norm(x),
               reach = static_cast<double>(a.axis[3]) + static_cast<double>(b.axis[3]) + slack;
  const double apart = rdm::dot(x, r) - std::fabs(rdm::dot(x, u)) - std::fabs(rdm::dot(x, v));
  return apart + std::min(0.0, rdm::dot(x, way)) > reach * length;
}

uint32_t BroadPhase::capsules_meet(const int32_t* list, uint32_t* ahead) const {
  Float4 p[4], u[4], q[4], v[4];
  for (int k = 0; k < 4; ++k) {
    const Bound &a = bounds_[pairs_[list[k]].a], &b = bounds_[pairs_[list[k]].b];
    p[k] = load4(a.center), u[k] = load4(a.axis);
    q[k] = load4(b.center), v[k] = load4(b.axis);
  }
  transpose(p), transpose(q), transpose(u), transpose(v);
  const Float4 reach = u[3] + v[3] + splat(kSlack);
  const Float4 square = segment_distance(p, u, q, v);
  if (ahead) {
    Float4 more{};
    for (int k = 0; k < 4; ++k) {
      const Pair& pair = pairs_[list[k]];
      const float way = ways_[pair.a] + ways_[pair.b];
      more[k] = way > pair.thin ? way : 0.0f;
    }
    const Float4 far = reach + more;
    *ahead = bits_of(square < far * far);
  }
  return bits_of(square < reach * reach);
}

// Marks in near_, for each shape of a robot, the shapes of bodies, statics and planes whose boxes meet its own.
void BroadPhase::mark_others() {
  std::fill_n(near_, first_other_ * words_, uint64_t{0});
  for (int32_t i = 0; i < num_others_; ++i) {
    const int32_t shape = first_other_ + i;
    const Plane* plane = other_plane_[i] < 0 ? nullptr : planes_ + other_plane_[i];
    for (int32_t a = 0, first = 0; a < num_articulations_; first = block_end_[a++]) {
      if (!(plane ? near(*plane, boxes_[a]) : near(shape, boxes_[a]))) continue;
      for (int32_t k = first; k < block_end_[a]; ++k) {
        const Block& block = blocks_[k];
        uint32_t bits = (plane ? near(*plane, block) : near(shape, block)) & ((1u << block.count) - 1);
        for (; bits != 0; bits &= bits - 1)
          near_[(block.first + std::countr_zero(bits)) * words_ + i / 64] |= uint64_t{1} << (i % 64);
      }
    }
  }
}

// Tests at most kBatch pairs, then visits those that passed. All tests come before the first visit, so that the
// processor can overlap them. The list must be long enough to be padded to a multiple of four.
void BroadPhase::visit_near(int32_t* list, int32_t count, Visit visit, void* context) const {
  for (int32_t k = count; k % 4 != 0; ++k) list[k] = list[0];
  uint64_t bits = 0, ahead = 0;
  for (int32_t k = 0; k < count; k += 4) {
    uint32_t coming = 0;
    bits |= uint64_t{capsules_meet(list + k, ahead_ ? &coming : nullptr)} << k;
    ahead |= uint64_t{coming} << k;
  }
  uint64_t all = bits | ahead;
  if (count < kBatch) all &= (uint64_t{1} << count) - 1;
  for (; all != 0; all &= all - 1) {
    const int k = std::countr_zero(all);
    visit(context, list[k], (bits >> k & 1) == 0);
  }
}

void BroadPhase::search_listed(const PairList& listed, Visit visit, void* context) {
  update_extents(first_other_);
  for (int32_t at = 0; at < listed.count;) {
    int32_t list[kBatch + 3], count = 0;
    for (; at < listed.count && count < kBatch; ++at) {
      const Pair& pair = pairs_[listed.pairs[at]];
      if (pair.plane < 0 ? boxes_meet(pair.a, pair.b) : on_plane(pair)) list[count++] = listed.pairs[at];
    }
    visit_near(list, count, visit, context);
  }
}

void BroadPhase::search(const Scene& scene, const PairList* listed, const uint64_t* near_robots, Visit visit,
                        void* context) {
  update_extents(near_robots ? first_other_ : 0);
  if (!near_robots) {
    update_boxes();
    mark_others();
  }
  int32_t list[kBatch + 3], count = 0;
  const auto add = [&](int32_t pair) {
    list[count++] = pair;
    if (count < kBatch) return;
    visit_near(list, count, visit, context);
    count = 0;
  };
  const auto try_pair = [&](int32_t index) {
    if (boxes_meet(pairs_[index].a, pairs_[index].b)) add(index);
  };
  if (listed && listed->count == num_listed_) listed = nullptr;
  const int32_t to_try = listed ? listed->count : num_listed_;
  const uint64_t* const crowd = crowd_.pays(to_try) ? crowd_.search(bounds_, extents_) : nullptr;
  int32_t marked[2] = {-1, -1};  // the articulations that neighbours_ is about
  int32_t at = 0;                // in the list of those to search
  for (const Row *row = rows_, *last = rows_ + num_rows_; row < last; ++row) {
    const int32_t end = row->first + row->count;
    if (near_robots && row->of_robot()) {
      visit_near(list, count, visit, context);
      count = 0;
      each_bit(near_robots, row->first, row->end, [&](int32_t pair) { visit(context, pair, false); });
      at += row->listed;
      row = rows_ + row->next - 1;
    } else if (row->kind == Row::kOthers) {
      at += row->count;
      uint64_t bits = near_[row->word] >> row->shift;
      if (row->count < 64) bits &= (uint64_t{1} << row->count) - 1;
      for (; bits != 0; bits &= bits - 1) add(row->first + std::countr_zero(bits));
    } else if (row->kind == Row::kRun) {
      if (!near(row->shape, boxes_[row->articulation])) continue;
      if (row->owner >= 0 && (row->owner != marked[0] || row->articulation != marked[1])) {
        marked[0] = row->owner;
        marked[1] = row->articulation;
        mark_neighbours(scene, row->articulation, boxes_[row->owner]);
      }
      for (int32_t k = row->first; k < end; ++k)
        if (row->owner < 0 || neighbours_[pairs_[k].b] != 0) try_pair(k);
    } else if (row->kind == Row::kLink) {
      at += row->count;
      for (int32_t k = row->first; k < end; ++k) try_pair(k);
    } else if (row->kind == Row::kAny && crowd) {
      each_bit(crowd, row->first, end, [&](int32_t pair) {
        if (!listed || std::binary_search(listed->pairs + at, listed->pairs + listed->count, pair)) add(pair);
      });
      if (listed)
        at = static_cast<int32_t>(std::lower_bound(listed->pairs + at, listed->pairs + listed->count, end) -
                                  listed->pairs);
    } else {
      const bool plane = row->kind == Row::kPlane;
      for (int32_t k = row->first; k < end; ++k) {
        if (listed && !(at < listed->count && listed->pairs[at] < end)) break;
        const int32_t pair = listed ? listed->pairs[at++] : k;
        if (plane ? on_plane(pairs_[pair]) : boxes_meet(pairs_[pair].a, pairs_[pair].b)) add(pair);
      }
    }
  }
  visit_near(list, count, visit, context);
}

}  // namespace rdm
