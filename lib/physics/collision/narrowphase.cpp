#include "physics/collision/narrowphase.hpp"

#include "base/error.hpp"
#include "physics/collision/overlap.hpp"
#include "physics/ode/ode_convert.hpp"
#include "physics/ode/ode_guard.hpp"

// Per candidate pair: poses of its two geoms, once per search (`placed_` holds the number of the search that
// put each there), the points (shapes.cpp: ODE's for spheres, capsules, boxes and planes with each other,
// ours otherwise), then one Contact per point until the world's contacts_max. Contacts stand in the order of
// the scene's pairs, whatever the bounds let through: results do not depend on the broad phase.
namespace rdm {

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
  placed_ = arena.make<uint32_t>(scene.shapes.size());
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

int Collider::touch(Poses& poses, const ShapePair& pair, int most, dContactGeom* out) {
  put(poses, pair.a);
  put(poses, pair.b);
  return collide_geoms(geoms_[pair.a], geoms_[pair.b], most, out);
}

void Collider::add_points(const Search& search, int32_t index) {
  const SolverDef& solver = search.scene.def.solver;
  const ShapePair& pair = search.scene.pairs[static_cast<size_t>(index)];
  dContactGeom points[kMaxPairPoints];
  const int n = touch(search.poses, pair, solver.contacts_per_pair, points);
  if (n > 0) search.touched[index] = 1;
  for (int i = 0; i < n; ++i) {
    int32_t& count = search.found->count;
    if (count == solver.contacts_max) {
      search.found->overflow = true;
      return;
    }
    search.pairs[count] = index;
    search.contacts[count++] = {pair.a,          pair.b, from_ode(points[i].pos), from_ode(points[i].normal),
                                points[i].depth, {}};
  }
}

template <class Walk>
Collider::Found Collider::search(const Search& search, Walk walk) {
  ++search_;
  *search.found = {0, false, false};
  try {
    const OdeScope scope;
    walk([](void* context, int32_t pair) {
      const auto* s = static_cast<const Search*>(context);
      s->self->add_points(*s, pair);
    });
  } catch (const Error&) {
    search.found->failed = true;
  }
  return *search.found;
}

Collider::Found Collider::collide(const Scene& scene, Poses& poses, const PairList* listed, Contact* contacts,
                                  int32_t* pairs, uint8_t* touched) {
  Found found;
  Search context = {this, scene, poses, contacts, pairs, touched, &found};
  return search(context, [&](BroadPhase::Visit visit) { broad_.search(scene, listed, visit, &context); });
}

Collider::Found Collider::collide_listed(const Scene& scene, Poses& poses, const PairList& listed,
                                         Contact* contacts, int32_t* pairs, uint8_t* touched) {
  Found found;
  Search context = {this, scene, poses, contacts, pairs, touched, &found};
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
