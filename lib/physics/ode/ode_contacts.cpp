#include "physics/ode/ode_contacts.hpp"

#include <algorithm>
#include <cmath>

#include "physics/ode/ode_convert.hpp"

namespace rdm {
namespace {

constexpr double kFar = 1e300;  // m

// The one place where a contact's surface is described, every field of the mode included.
dContact describe(const SolverDef& solver, const dContactGeom& geom, double mu) {
  dContact contact = {};
  contact.geom = geom;
  contact.surface.mode = dContactApprox1 | dContactSoftERP | dContactSoftCFM;
  contact.surface.mu = mu;
  contact.surface.soft_erp = solver.contact_erp;
  contact.surface.soft_cfm = solver.contact_cfm;
  return contact;
}

// ODE makes two poses, and forgets the first when it is refused the second.
void make_offset(dGeomID geom, dBodyID body) {
  try {
    dGeomSetOffsetPosition(geom, 0, 0, 0);
  } catch (...) {
    void* const pose = const_cast<dReal*>(dGeomGetPosition(geom));  // stands at its beginning
    if (pose != dBodyGetPosition(body)) dFree(pose, 0);
    throw;
  }
}

}  // namespace

void OdeContacts::destroy() {
  if (group_) dJointGroupDestroy(group_);
  group_ = nullptr;
  for (int32_t i = 0; shapes_ && i < num_shapes_; ++i) {
    if (shapes_[i].geom.id) dGeomDestroy(shapes_[i].geom.id);
    shapes_[i].geom.id = nullptr;
  }
}

void OdeContacts::carve(const Scene& scene, Arena& arena) {
  num_shapes_ = static_cast<int32_t>(scene.shapes.size());
  shapes_ = arena.make<Shape>(scene.shapes.size());
  num_articulations_ = static_cast<int32_t>(scene.def.articulations.size());
  boxes_ = arena.make<Box>(scene.def.articulations.size());
  feedback_ = arena.make<dJointFeedback>(static_cast<size_t>(scene.def.solver.contacts_max));
}

void OdeContacts::make_geom(const Scene& scene, int32_t index, dBodyID body, const Vec3& com,
                            const Pose& X_WC) {
  const SceneShape& def = scene.shapes[static_cast<size_t>(index)];
  if (!def.def.collides) return;
  const Pose& X_LS = def.def.X_LS;
  const Pose X_WS = X_WC * X_LS;
  Shape& shape = shapes_[index];
  shape.geom = rdm::make_geom(def.def, scene.hull_of(def), X_WS);
  shape.body = body;
  shape.articulation = def.articulation;
  shape.radius = def.radius;
  shape.rest = body == nullptr;
  if (def.radius < 0) {
    shape.center = shape.geom.plane_n;
    shape.radius = shape.geom.plane_d;
    return;
  }
  if (!body) {
    shape.center = X_WS.p;
    return;
  }
  shape.offset = X_LS.p - com;
  shape.p = dBodyGetPosition(body);
  shape.r = dBodyGetRotation(body);
  dGeomSetBody(shape.geom.id, body);
  const bool turned = X_LS.q.x != 0 || X_LS.q.y != 0 || X_LS.q.z != 0;
  shape.slender = def.def.kind == ShapeKind::kCapsule && !turned;
  if (turned || norm(shape.offset) != 0) {
    dQuaternion q;
    to_ode(X_LS.q, q);
    make_offset(shape.geom.id, body);
    dGeomSetOffsetPosition(shape.geom.id, shape.offset.x, shape.offset.y, shape.offset.z);
    dGeomSetOffsetQuaternion(shape.geom.id, q);
  }
}

void OdeContacts::make_group() {
  group_ = dJointGroupCreate(0);
}

void OdeContacts::empty() {
  dJointGroupEmpty(group_);
}

void OdeContacts::make_joint(dWorldID world, const Scene& scene, const dContactGeom& geom, double mu,
                             dBodyID a, dBodyID b, int32_t index) {
  const dContact contact = describe(scene.def.solver, geom, mu);
  const dJointID joint = dJointCreateContact(world, group_, &contact);
  dJointAttach(joint, a, b);
  dJointSetFeedback(joint, &feedback_[index]);
}

void OdeContacts::fill(dWorldID world, const Scene& scene, const dBodyID* bodies, int32_t count) {
  dContactGeom geom = {};
  geom.normal[2] = 1;
  for (int32_t i = 0; i < scene.def.solver.contacts_max; ++i) {
    const dBodyID a = bodies[i % count], b = bodies[(i + 1) % count];
    make_joint(world, scene, geom, 1, a, a == b ? nullptr : b, i);
  }
}

void OdeContacts::update_centers() {
  for (int32_t i = 0; i < num_articulations_; ++i) boxes_[i] = {{kFar, kFar, kFar}, {-kFar, -kFar, -kFar}};
  for (int32_t i = 0; i < num_shapes_; ++i) {
    Shape& s = shapes_[i];
    if (!s.geom.id) continue;
    if (!s.rest) {
      const dReal* r = s.r;
      const Vec3& o = s.offset;
      s.center = {s.p[0] + r[0] * o.x + r[1] * o.y + r[2] * o.z,
                  s.p[1] + r[4] * o.x + r[5] * o.y + r[6] * o.z,
                  s.p[2] + r[8] * o.x + r[9] * o.y + r[10] * o.z};
      s.axis = {r[2], r[6], r[10]};
    }
    if (s.articulation < 0) continue;
    Box& box = boxes_[s.articulation];
    for (int k = 0; k < 3; ++k) {
      box.low[k] = std::min(box.low[k], s.center[k] - s.radius);
      box.high[k] = std::max(box.high[k], s.center[k] + s.radius);
    }
  }
}

bool OdeContacts::near(const Shape& shape, const Box& box) const {
  double square = 0;  // of the distance to the box
  for (int k = 0; k < 3; ++k) {
    const double d = std::max({box.low[k] - shape.center[k], shape.center[k] - box.high[k], 0.0});
    square += d * d;
  }
  return square < shape.radius * shape.radius;
}

bool OdeContacts::near(const ShapePair& pair) const {
  const Shape &a = shapes_[pair.a], &b = shapes_[pair.b];
  if (pair.reach < 0) return dot(a.center, b.center) - b.radius < a.radius;
  const Vec3 d = a.center - b.center;
  return dot(d, d) < pair.reach * pair.reach && !(b.slender && beside(a, b, d)) &&
         !(a.slender && beside(b, a, -d));
}

// The bounding sphere of `shape`, whose centre is at `d` from the capsule's, does not reach the capsule.
bool OdeContacts::beside(const Shape& shape, const Shape& capsule, const Vec3& d) {
  const double half = capsule.geom.size.y, along = std::clamp(dot(d, capsule.axis), -half, half);
  const Vec3 off = d - along * capsule.axis;
  const double reach = shape.radius + capsule.geom.size.x;
  return dot(off, off) > reach * reach;
}

OdeContacts::Found OdeContacts::collide(dWorldID world, const Scene& scene, Contact* contacts,
                                        uint8_t* touched) {
  empty();
  update_centers();
  Found found = {0, false};
  for (const PairRun& run : scene.runs) {
    if (run.shape >= 0 && !near(shapes_[run.shape], boxes_[run.articulation])) continue;
    for (int32_t k = run.first; k < run.first + run.count; ++k) {
      const ShapePair& pair = scene.pairs[static_cast<size_t>(k)];
      if (near(pair) && touch(world, scene, pair, contacts, &found)) touched[k] = 1;
    }
  }
  return found;
}

bool OdeContacts::touch(dWorldID world, const Scene& scene, const ShapePair& pair, Contact* contacts,
                        Found* found) {
  const SolverDef& solver = scene.def.solver;
  const Shape &a = shapes_[pair.a], &b = shapes_[pair.b];
  dContactGeom geoms[kMaxPairPoints];
  const int n = collide_geoms(a.geom, b.geom, solver.contacts_per_pair, geoms);
  for (int i = 0; i < n; ++i) {
    if (found->count == solver.contacts_max) {
      found->overflow = true;
      break;
    }
    make_joint(world, scene, geoms[i], pair.mu, a.body, b.body, found->count);
    contacts[found->count++] = {pair.a,         pair.b, from_ode(geoms[i].pos), from_ode(geoms[i].normal),
                                geoms[i].depth, {}};
  }
  return n > 0;
}

void OdeContacts::read_forces(int32_t count, Contact* contacts) const {
  for (int32_t i = 0; i < count; ++i) contacts[i].force = from_ode(feedback_[i].f1);
}

double OdeContacts::overlap(const Scene& scene, int32_t body) {
  update_centers();
  const auto carries = [&](int32_t shape) {
    const SceneShape& s = scene.shapes[static_cast<size_t>(shape)];
    return s.carrier == Carrier::kBody && s.index == body;
  };
  double deepest = 0;
  dContactGeom geoms[kMaxPairPoints];
  for (const ShapePair& pair : scene.pairs) {
    if (!(carries(pair.a) || carries(pair.b)) || !near(pair)) continue;
    const int n = collide_geoms(shapes_[pair.a].geom, shapes_[pair.b].geom, kMaxPairPoints, geoms);
    for (int i = 0; i < n; ++i) deepest = std::max(deepest, static_cast<double>(geoms[i].depth));
  }
  return deepest;
}

}  // namespace rdm
