#include "physics/collider.hpp"

#include <algorithm>
#include <cmath>

#include "physics/convert.hpp"

namespace rdm {
namespace {

constexpr float kFar = 1e30f;       // m
constexpr float kSlack = 1e-5f;     // m, for the rounding of bounds
constexpr float kFlatness = 1e-6f;  // of two axes that count as parallel

using Four = float __attribute__((vector_size(16)));

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

// Squared distance of the segments p +- u and q +- v.
float segment_distance(Four p, Four u, Four q, Four v) {
  const Four r = p - q;
  const float a = dot3(u, u) + 1e-10f, e = dot3(v, v) + 1e-10f, b = dot3(u, v), c = dot3(u, r),
              f = dot3(v, r);
  const float d = a * e - b * b;
  float s = d > kFlatness * a * e ? (b * f - c * e) / d : -c / a;
  s = std::clamp(s, -1.0f, 1.0f);
  float t = (b * s + f) / e;
  if (t < -1 || t > 1) {
    t = t < -1 ? -1.0f : 1.0f;
    s = std::clamp((b * t - c) / a, -1.0f, 1.0f);
  }
  const Four w = r + u * s - v * t;
  return dot3(w, w);
}

bool is_round(ShapeKind kind) {
  return kind == ShapeKind::kSphere || kind == ShapeKind::kCapsule;
}

}  // namespace

Collider::~Collider() {
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
}

void Collider::make(const Scene& scene) {
  for (size_t i = 0; i < scene.shapes.size(); ++i) {
    const SceneShape& s = scene.shapes[i];
    moves_[i] = scene.moves(s);
    Pose X_WS = s.def.X_LS;
    if (s.carrier == Carrier::kBase && !moves_[i])
      X_WS = scene.def.articulations[static_cast<size_t>(s.articulation)].X_WB * X_WS;
    if (s.def.collides) geoms_[i] = make_geom(s.def, X_WS);
    Bound& bound = bounds_[i];
    bound.center[3] = static_cast<float>(s.radius);
    for (int k = 0; k < 3; ++k) bound.center[k] = static_cast<float>(X_WS.p[k]);
    if (s.def.kind != ShapeKind::kCapsule) continue;
    const Vec3 axis = rotate(X_WS.q, {0, 0, s.def.size.y});
    for (int k = 0; k < 3; ++k) bound.axis[k] = static_cast<float>(axis[k]);
  }
  for (size_t k = 0; k < scene.pairs.size(); ++k) {
    const ShapePair& pair = scene.pairs[k];
    const ShapeDef &a = scene.shapes[static_cast<size_t>(pair.a)].def,
                   &b = scene.shapes[static_cast<size_t>(pair.b)].def;
    const bool round = is_round(a.kind) && is_round(b.kind);
    pairs_[k] = {pair.a, pair.b, pair.reach < 0 ? -1.0f : static_cast<float>(pair.reach) + kSlack,
                 round ? static_cast<float>(a.size.x + b.size.x) + kSlack : -1.0f};
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

// False also where a number is missing: what is nowhere touches nothing.
bool Collider::near(const Pair& pair) const {
  const Bound &a = bounds_[pair.a], &b = bounds_[pair.b];
  if (pair.reach < 0) {
    const Geom& plane = geoms_[pair.b];
    const Vec3 c{a.center[0], a.center[1], a.center[2]};
    return dot(c, plane.plane_n) - plane.plane_d < a.center[3] + kSlack;
  }
  const Four p = load(a.center), q = load(b.center), d = p - q;
  if (!(dot3(d, d) < pair.reach * pair.reach)) return false;
  const Four u = load(a.axis), v = load(b.axis);
  if (pair.gap >= 0) return segment_distance(p, u, q, v) < pair.gap * pair.gap;
  const bool slender_a = dot3(u, u) > 0, slender_b = dot3(v, v) > 0;
  if (slender_a == slender_b) return true;
  // the other shape's sphere against the capsule
  const float reach =
      slender_a ? q[3] + (p[3] - std::sqrt(dot3(u, u))) : p[3] + (q[3] - std::sqrt(dot3(v, v)));
  return segment_distance(p, u, q, v) < (reach + kSlack) * (reach + kSlack);
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

int Collider::touch(const Scene&, Poses& poses, int32_t pair, int most, dContactGeom* out) {
  const Pair& p = pairs_[pair];
  put(poses, p.a);
  put(poses, p.b);
  return collide_geoms(geoms_[p.a], geoms_[p.b], most, out);
}

Collider::Found Collider::collide(const Scene& scene, Poses& poses, Contact* contacts, int32_t* pairs,
                                  uint8_t* touched) {
  ++search_;
  update_boxes(scene);
  Found found = {0, false};
  dContactGeom points[kMaxPairPoints];
  const SolverDef& solver = scene.def.solver;
  for (const PairRun& run : scene.runs) {
    if (run.shape >= 0 && !near(bounds_[run.shape], boxes_[run.articulation])) continue;
    for (int32_t k = run.first; k < run.first + run.count; ++k) {
      if (!near(pairs_[k])) continue;
      const int n = touch(scene, poses, k, solver.contacts_per_pair, points);
      if (n > 0) touched[k] = 1;
      for (int i = 0; i < n; ++i) {
        if (found.count == solver.contacts_max) {
          found.overflow = true;
          break;
        }
        pairs[found.count] = k;
        contacts[found.count++] = {
            pairs_[k].a,     pairs_[k].b, from_ode(points[i].pos), from_ode(points[i].normal),
            points[i].depth, {}};
      }
    }
  }
  return found;
}

double Collider::overlap(const Scene& scene, Poses& poses, int32_t body) {
  ++search_;
  const auto carries = [&](int32_t shape) {
    const SceneShape& s = scene.shapes[static_cast<size_t>(shape)];
    return s.carrier == Carrier::kBody && s.index == body;
  };
  double deepest = 0;
  dContactGeom points[kMaxPairPoints];
  for (int32_t k = 0; k < static_cast<int32_t>(scene.pairs.size()); ++k) {
    if (!(carries(pairs_[k].a) || carries(pairs_[k].b)) || !near(pairs_[k])) continue;
    const int n = touch(scene, poses, k, kMaxPairPoints, points);
    for (int i = 0; i < n; ++i) deepest = std::max(deepest, static_cast<double>(points[i].depth));
  }
  return deepest;
}

}  // namespace rdm
