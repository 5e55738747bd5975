#include "physics/ode_contacts.hpp"

#include <algorithm>
#include <cmath>

#include "physics/convert.hpp"
#include "physics/manifold.hpp"

namespace rdm {
namespace {

constexpr double kFar = 1e300;  // m
constexpr int kMaxPerPair = 8;
constexpr double kFlat = 0.99;  // cosine between a contact's normal and that of a face it counts for

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

// The side of a box whose outward normal is nearest to `n`; false when none is near.
bool face_of_box(dGeomID box, const Vec3& size, const Vec3& n, double* half, Face* face) {
  const Mat3 r = mat_from_ode(dGeomGetRotation(box));
  for (int k = 0; k < 3; ++k) {
    const double cosine = dot(n, r.col(k));
    if (std::fabs(cosine) < kFlat) continue;
    const int i = (k + 1) % 3, j = (k + 2) % 3;
    face->n = std::copysign(1.0, cosine) * r.col(k);
    face->center = from_ode(dGeomGetPosition(box)) + size[k] * face->n;
    face->offset = dot(face->n, face->center);
    face->side[0] = r.col(i);
    face->side[1] = r.col(j);
    half[0] = size[i], half[1] = size[j];
    face->half = half;
    return true;
  }
  return false;
}

dGeomID create_geom(const ShapeDef& shape, const Pose& X_WS) {
  const Vec3& s = shape.size;
  switch (shape.kind) {
    case ShapeKind::kSphere:
      return dCreateSphere(nullptr, s.x);
    case ShapeKind::kCapsule:
      return dCreateCapsule(nullptr, s.x, 2 * s.y);
    case ShapeKind::kBox:
      return dCreateBox(nullptr, 2 * s.x, 2 * s.y, 2 * s.z);
    case ShapeKind::kCylinder:
      return dCreateCylinder(nullptr, s.x, 2 * s.y);
    case ShapeKind::kPlane:
      break;
  }
  const Vec3 n = rotate(X_WS.q, {0, 0, 1});
  return dCreatePlane(nullptr, n.x, n.y, n.z, dot(n, X_WS.p));
}

}  // namespace

OdeContacts::~OdeContacts() {
  if (group_) dJointGroupDestroy(group_);
  for (int32_t i = 0; shapes_ && i < num_shapes_; ++i)
    if (shapes_[i].geom) dGeomDestroy(shapes_[i].geom);
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
  shape.geom = create_geom(def.def, X_WS);
  shape.body = body;
  shape.articulation = def.articulation;
  shape.radius = def.radius;
  shape.kind = def.def.kind;
  shape.size = def.def.size;
  shape.rest = body == nullptr;
  if (def.radius < 0) {
    shape.center = rotate(X_WS.q, {0, 0, 1});
    shape.radius = dot(shape.center, X_WS.p);
    return;
  }
  dQuaternion q;
  if (!body) {
    to_ode(X_WS.q, q);
    dGeomSetPosition(shape.geom, X_WS.p.x, X_WS.p.y, X_WS.p.z);
    dGeomSetQuaternion(shape.geom, q);
    shape.center = X_WS.p;
    return;
  }
  shape.offset = X_LS.p - com;
  shape.p = dBodyGetPosition(body);
  shape.r = dBodyGetRotation(body);
  dGeomSetBody(shape.geom, body);
  const bool turned = X_LS.q.x != 0 || X_LS.q.y != 0 || X_LS.q.z != 0;
  shape.slender = def.def.kind == ShapeKind::kCapsule && !turned;
  if (turned || norm(shape.offset) != 0) {
    to_ode(X_LS.q, q);
    dGeomSetOffsetPosition(shape.geom, shape.offset.x, shape.offset.y, shape.offset.z);
    dGeomSetOffsetQuaternion(shape.geom, q);
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
    if (!s.geom) continue;
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
  const double half = capsule.size.y, along = std::clamp(dot(d, capsule.axis), -half, half);
  const Vec3 off = d - along * capsule.axis;
  const double reach = shape.radius + capsule.size.x;
  return dot(off, off) > reach * reach;
}

int OdeContacts::collide_pair(const ShapePair& pair, int most, dContactGeom* out) const {
  const Shape &a = shapes_[pair.a], &b = shapes_[pair.b];
  const int found = dCollide(a.geom, b.geom, most, out, sizeof out[0]);
  const bool first = a.kind == ShapeKind::kCylinder;
  if (found == 0 || (!first && b.kind != ShapeKind::kCylinder)) return found;
  const Shape &round = first ? a : b, &flat = first ? b : a;
  const Vec3 n = first ? from_ode(out[0].normal) : -from_ode(out[0].normal);
  Face face;
  double half[2];
  if (flat.kind == ShapeKind::kPlane) {
    face.n = flat.center;
    face.offset = flat.radius;
  } else if (flat.kind != ShapeKind::kBox || !face_of_box(flat.geom, flat.size, n, half, &face)) {
    return found;
  }
  const Cylinder cylinder = {from_ode(dGeomGetPosition(round.geom)),
                             mat_from_ode(dGeomGetRotation(round.geom)), round.size.x, round.size.y};
  ManifoldPoint points[kManifoldPoints];
  const int count = std::min(cylinder_on_face(cylinder, face, points), most);
  if (count <= 0) return found;
  for (int i = 0; i < count; ++i) {
    out[i] = out[0];
    to_ode(points[i].p, out[i].pos);
    to_ode(first ? face.n : -face.n, out[i].normal);
    out[i].depth = points[i].depth;
  }
  return count;
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
  dContactGeom geoms[kMaxPerPair];
  const int n = collide_pair(pair, solver.contacts_per_pair, geoms);
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
  dContactGeom geoms[kMaxPerPair];
  for (const ShapePair& pair : scene.pairs) {
    if (!(carries(pair.a) || carries(pair.b)) || !near(pair)) continue;
    const int n = collide_pair(pair, kMaxPerPair, geoms);
    for (int i = 0; i < n; ++i) deepest = std::max(deepest, static_cast<double>(geoms[i].depth));
  }
  return deepest;
}

}  // namespace rdm
