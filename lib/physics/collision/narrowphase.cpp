#include "physics/collision/narrowphase.hpp"

#include <algorithm>

#include "base/error.hpp"
#include "physics/collision/overlap.hpp"
#include "physics/collision/sweep.hpp"
#include "physics/ode_library/ode_convert.hpp"
#include "physics/ode_library/ode_guard.hpp"

// Per candidate pair, unless the capsule about one is clear of the other's box: poses of its two geoms, once
// per search (`placed_` holds the number of the search that put each there), the points (shapes.cpp: ODE's for
// spheres, capsules, boxes and planes with each other, ours otherwise), then one Contact per point until the
// world's contacts_max. Contacts stand in the order of the scene's pairs, whatever the bounds let through:
// results do not depend on the broad phase.
//
// Looking ahead, a pair that does not touch is swept (sweep.hpp) where a moves farther against b than its
// broad phase's `thin`; slower pairs are found by their overlap, as without looking ahead. Overlaps at seams go last
// (seams.hpp).
namespace rdm {
namespace {

// A pair that will overlap by less than this at the end of the substep is not swept, because the overlap will be
// found then: m, and a share of the thinner one's half width.
constexpr double kMostShallow = 1.5e-3, kShallowShare = 0.25;
constexpr double kComing = -1e-12;  // m, depth given to a coming point that touches already (it must be < 0)

// A pair that a sweep stopped in the last substep overlaps a little where the two met first: at one end of an edge,
// say, while the other end has not arrived yet. Such a pair is swept again; otherwise it would rotate about that one
// point and pass through. (Nothing passes through a plane, which has no far side.)
bool barely_touch(const dContactGeom* points, int n) {
  return std::all_of(points, points + n, [](const dContactGeom& p) { return p.depth <= kBarely; });
}

}  // namespace

Collider::~Collider() {
  const OdeScope scope;
  for (int32_t i = 0; geoms_ && i < num_shapes_; ++i)
    if (geoms_[i].id) dGeomDestroy(geoms_[i].id);
}

void Collider::carve(const Scene& scene, Arena& arena) {
  num_shapes_ = static_cast<int32_t>(scene.shapes.size());
  first_body_shape_ = scene.first_body_shape;
  geoms_ = arena.make<Geom>(scene.shapes.size());
  broad_.carve(scene, arena);
  seams_.carve(scene, arena);
  placed_ = arena.make<uint32_t>(scene.shapes.size());
  fetched_ = arena.make<uint32_t>(static_cast<size_t>(first_body_shape_));
  moves_ = arena.make<uint8_t>(scene.shapes.size());
}

void Collider::make(const Scene& scene) {
  const OdeScope scope;
  for (size_t i = 0; i < scene.shapes.size(); ++i) {
    const SceneShape& s = scene.shapes[i];
    moves_[i] = scene.moves(s);
    if (s.def.collides) geoms_[i] = make_geom(s.def, scene.hull_of(s), rest_pose(scene, s));
  }
  broad_.make(scene);
  seams_.make(scene, geoms_);
}

void Collider::put(Poses& poses, int32_t shape) {
  if (!moves_[shape] || placed_[shape] == search_) return;
  placed_[shape] = search_;
  Vec3 p;
  Mat3 R;
  poses.place(shape, &p, &R);
  if (poses.sized && shape >= first_body_shape_) {
    const SizedShape& own = poses.sized[shape - first_body_shape_];
    resize_geom(&geoms_[shape], own.size, own.hull);
  }
  dMatrix3 r;
  to_ode(R, r);
  dGeomSetRotation(geoms_[shape].id, r);
  dGeomSetPosition(geoms_[shape].id, p.x, p.y, p.z);
}

void Collider::fetch(Poses& poses, int32_t shape) {
  if (shape >= first_body_shape_ || !moves_[shape] || fetched_[shape] == search_) return;
  fetched_[shape] = search_;
  poses.bound(shape, &broad_.bounds()[shape]);
}

// Seen from the box, whose own bound says little of its sides. Two boxes mostly touch once their bounds meet.
bool Collider::clears_box(Poses& poses, int32_t shape, int32_t box) {
  const Geom& geom = geoms_[box];
  const ShapeKind other = geoms_[shape].kind;
  if (geom.kind != ShapeKind::kBox || other == ShapeKind::kPlane || other == ShapeKind::kBox) return false;
  put(poses, box);
  return broad_.clears_box(shape, from_ode(dGeomGetPosition(geom.id)),
                           mat_from_ode(dGeomGetRotation(geom.id)), geom.size);
}

int Collider::touch(Poses& poses, const ShapePair& pair, int most, dContactGeom* out) {
  if (clears_box(poses, pair.a, pair.b) || clears_box(poses, pair.b, pair.a)) return 0;
  put(poses, pair.a);
  put(poses, pair.b);
  return collide_geoms(geoms_[pair.a], geoms_[pair.b], most, out);
}

void Collider::add_points(const Search& search, int32_t index) {
  const SolverDef& solver = search.scene.def.solver;
  const ShapePair& pair = search.scene.pairs[static_cast<size_t>(index)];
  dContactGeom points[kMaxPairPoints];
  if (search.fetches) {
    fetch(search.poses, pair.a);
    fetch(search.poses, pair.b);
  }
  const int n = touch(search.poses, pair, solver.contacts_per_pair, points);
  if (n > 0) search.touched[index] = 1;
  if (broad_.looks_ahead() &&
      (n == 0 || (geoms_[pair.b].kind != ShapeKind::kPlane && barely_touch(points, n))) &&
      add_coming(search, index, n))
    return;
  for (int i = 0; i < n; ++i)
    add(search, index,
        {pair.a, pair.b, from_ode(points[i].pos), from_ode(points[i].normal), points[i].depth, {}, {}});
}

void Collider::add(const Search& search, int32_t index, const Contact& contact) {
  int32_t& count = search.found->count;
  if (count == search.scene.def.solver.contacts_max) {
    search.found->overflow = true;
    return;
  }
  search.pairs[count] = index;
  search.contacts[count++] = contact;
}

bool Collider::add_coming(const Search& search, int32_t index, int more_than) {
  const ShapePair& pair = search.scene.pairs[static_cast<size_t>(index)];
  const auto thin = static_cast<double>(broad_.thin(index));
  if (broad_.ways()[pair.a] + broad_.ways()[pair.b] <= broad_.thin(index)) return false;
  const Vec3 way_a = search.poses.way(pair.a), way_b = search.poses.way(pair.b);
  const Geom &a = geoms_[pair.a], &b = geoms_[pair.b];
  const double shallow = std::min(
      kMostShallow,
      kShallowShare * static_cast<double>(std::min(broad_.half_width(pair.a), broad_.half_width(pair.b))));
  ComingPoint points[kManifoldPoints];
  int n = 0;
  const auto meet = [&](const Vec3& way) {
    if (norm(way) <= thin || broad_.passes(index, way)) return;
    put(search.poses, pair.a);
    put(search.poses, pair.b);
    n = b.kind == ShapeKind::kPlane
            ? coming_on_plane(convex_of(a), b.plane_n, b.plane_d, way, shallow, points)
            : coming_contacts(convex_of(a), convex_of(b), way, shallow, points);
  };
  meet(way_a - way_b);
  // Two that fall one behind the other meet when something stops the first within the substep.
  if (n == 0 && dot(way_a, way_b) > 0) {
    meet(way_a);
    if (n == 0) meet(-way_b);
  }
  n = std::min(n, static_cast<int>(search.scene.def.solver.contacts_per_pair));
  if (n <= more_than) return false;
  for (int i = 0; i < n; ++i)
    add(search, index,
        {pair.a, pair.b, points[i].p, points[i].n, std::min(points[i].depth, kComing), {}, points[i].gap});
  return true;
}

template <class Walk>
Collider::Found Collider::search(const Search& search, Walk walk) {
  ++search_;
  *search.found = {0, false, false};
  try {
    const OdeScope scope;
    walk([](void* context, int32_t pair, bool ahead) {
      const auto* s = static_cast<const Search*>(context);
      if (ahead)
        s->self->add_coming(*s, pair, 0);
      else
        s->self->add_points(*s, pair);
    });
  } catch (const Error&) {
    search.found->failed = true;
  }
  search.found->count = seams_.smooth(geoms_, search.contacts, search.pairs, search.found->count);
  return *search.found;
}

Collider::Found Collider::collide(const Scene& scene, Poses& poses, const PairList* listed,
                                  const uint64_t* near_robots, Contact* contacts, int32_t* pairs,
                                  uint8_t* touched) {
  Found found;
  Search context = {this, scene, poses, contacts, pairs, touched, &found, near_robots != nullptr};
  return search(context,
                [&](BroadPhase::Visit visit) { broad_.search(scene, listed, near_robots, visit, &context); });
}

Collider::Found Collider::collide_listed(const Scene& scene, Poses& poses, const PairList& listed,
                                         Contact* contacts, int32_t* pairs, uint8_t* touched) {
  Found found;
  Search context = {this, scene, poses, contacts, pairs, touched, &found, false};
  return search(context, [&](BroadPhase::Visit visit) { broad_.search_listed(listed, visit, &context); });
}

double Collider::overlap(const Scene& scene, Poses& poses, int32_t body) {
  const OdeScope scope;
  ++search_;
  return deepest_overlap(scene, broad_, body, [&](const ShapePair& pair, dContactGeom* points) {
    return touch(poses, pair, kMaxPairPoints, points);
  });
}

}  // namespace rdm
