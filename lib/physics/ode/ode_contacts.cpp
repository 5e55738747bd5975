#include "physics/ode/ode_contacts.hpp"

#include "physics/collision/overlap.hpp"
#include "physics/ode_library/ode_convert.hpp"

namespace rdm {
namespace {

// The one place where a contact's surface is described, every field of the mode included.
// ODE has one layer for all contacts: what a pair's own is thinner by counts as depth.
dContact describe(const SolverDef& solver, const dContactGeom& geom, double mu, double layer,
                  const ContactLaw* law) {
  dContact contact = {};
  contact.geom = geom;
  contact.geom.depth += solver.contact_layer - layer;
  contact.surface.mode = dContactApprox1 | dContactSoftERP | dContactSoftCFM;
  contact.surface.mu = mu;
  contact.surface.soft_erp = solver.contact_erp;
  contact.surface.soft_cfm = solver.contact_cfm;
  if (law && law->restitution > 0) {
    contact.surface.mode |= dContactBounce;
    contact.surface.bounce = law->restitution;
    contact.surface.bounce_vel = kBounceSpeed;
    contact.surface.soft_cfm = solver.cfm;  // softness would swallow some
  }
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
  broad_.carve(scene, arena);
  feedback_ = arena.make<dJointFeedback>(static_cast<size_t>(scene.def.solver.contacts_max));
}

void OdeContacts::make_geom(const Scene& scene, int32_t index, dBodyID body, const Vec3& com) {
  const SceneShape& def = scene.shapes[static_cast<size_t>(index)];
  if (!def.def.collides) return;
  const Pose& X_LS = def.def.X_LS;
  Shape& shape = shapes_[index];
  shape.geom = rdm::make_geom(def.def, scene.hull_of(def), rest_pose(scene, def));
  shape.body = body;
  if (!body) return;
  shape.offset = X_LS.p - com;
  shape.axis = rotate(X_LS.q, capsule_around(def).axis);
  dGeomSetBody(shape.geom.id, body);
  const bool turned = X_LS.q.x != 0 || X_LS.q.y != 0 || X_LS.q.z != 0;
  if (turned || norm(shape.offset) != 0) {
    dQuaternion q;
    to_ode(X_LS.q, q);
    make_offset(shape.geom.id, body);
    dGeomSetOffsetPosition(shape.geom.id, shape.offset.x, shape.offset.y, shape.offset.z);
    dGeomSetOffsetQuaternion(shape.geom.id, q);
  }
}

void OdeContacts::make(const Scene& scene) {
  broad_.make(scene);
  group_ = dJointGroupCreate(0);
}

void OdeContacts::empty() {
  dJointGroupEmpty(group_);
}

void OdeContacts::make_joint(dWorldID world, const Scene& scene, const dContactGeom& geom, double mu,
                             double layer, const ContactLaw* law, dBodyID a, dBodyID b, int32_t index) {
  const dContact contact = describe(scene.def.solver, geom, mu, layer, law);
  const dJointID joint = dJointCreateContact(world, group_, &contact);
  dJointAttach(joint, a, b);
  dJointSetFeedback(joint, &feedback_[index]);
}

void OdeContacts::fill(dWorldID world, const Scene& scene, const dBodyID* bodies, int32_t count) {
  dContactGeom geom = {};
  geom.normal[2] = 1;
  for (int32_t i = 0; i < scene.def.solver.contacts_max; ++i) {
    const dBodyID a = bodies[i % count], b = bodies[(i + 1) % count];
    make_joint(world, scene, geom, 1, scene.def.solver.contact_layer, nullptr, a, a == b ? nullptr : b, i);
  }
}

void OdeContacts::update_bounds() {
  Bound* bounds = broad_.bounds();
  for (int32_t i = 0; i < num_shapes_; ++i) {
    const Shape& s = shapes_[i];
    if (!s.body) continue;
    const Mat3 R_WB = mat_from_ode(dBodyGetRotation(s.body));
    const Vec3 center = from_ode(dBodyGetPosition(s.body)) + R_WB * s.offset, axis = R_WB * s.axis;
    for (int k = 0; k < 3; ++k) {
      bounds[i].center[k] = static_cast<float>(center[k]);
      bounds[i].axis[k] = static_cast<float>(axis[k]);
    }
  }
}

OdeContacts::Found OdeContacts::collide(dWorldID world, const Scene& scene, Contact* contacts,
                                        uint8_t* touched) {
  empty();
  update_bounds();
  Found found = {0, false};
  Search search = {this, world, scene, contacts, touched, &found};
  const auto visit = [](void* context, int32_t pair, bool) {
    const auto* s = static_cast<Search*>(context);
    s->self->add_points(*s, pair);
  };
  broad_.search(scene, nullptr, nullptr, visit, &search);
  return found;
}

void OdeContacts::add_points(const Search& search, int32_t index) {
  const SolverDef& solver = search.scene.def.solver;
  const ShapePair& pair = search.scene.pairs[static_cast<size_t>(index)];
  const Shape &a = shapes_[pair.a], &b = shapes_[pair.b];
  dContactGeom geoms[kMaxPairPoints];
  const int n = collide_geoms(a.geom, b.geom, solver.contacts_per_pair, geoms);
  if (n > 0) search.touched[index] = 1;
  for (int i = 0; i < n; ++i) {
    int32_t& count = search.found->count;
    if (count == solver.contacts_max) {
      search.found->overflow = true;
      return;
    }
    make_joint(search.world, search.scene, geoms[i], pair.mu, pair.layer, search.scene.law_of(index), a.body,
               b.body, count);
    search.contacts[count++] = {
        pair.a, pair.b, from_ode(geoms[i].pos), from_ode(geoms[i].normal), geoms[i].depth, {}, {}};
  }
}

void OdeContacts::read_forces(int32_t count, Contact* contacts) const {
  for (int32_t i = 0; i < count; ++i) contacts[i].force = from_ode(feedback_[i].f1);
}

double OdeContacts::overlap(const Scene& scene, int32_t body) {
  update_bounds();
  return deepest_overlap(scene, broad_, body, [&](const ShapePair& pair, dContactGeom* points) {
    return collide_geoms(shapes_[pair.a].geom, shapes_[pair.b].geom, kMaxPairPoints, points);
  });
}

}  // namespace rdm
