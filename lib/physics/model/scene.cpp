#include "physics/model/scene.hpp"

#include <algorithm>
#include <cstring>

#include "base/error.hpp"
#include "base/text.hpp"
#include "physics/model/inertia.hpp"
#include "physics/model/soft_limits.hpp"
#include "physics/model/validate.hpp"

namespace rdm {
namespace {

void need(double value, double low, double high, const char* owner, const char* field) {
  if (!(value >= low && value <= high))
    fail(Code::kRange, "%s: %s %s is outside [%s, %s]", owner, field, Number(value).text, Number(low).text,
         Number(high).text);
}

void need_finite(const Vec3& v, const char* owner, const char* field) {
  if (!finite(v)) fail(Code::kArgument, "%s: %s is not finite", owner, field);
}

void check_pose(Pose* X, const char* owner) {
  need_finite(X->p, owner, "position");
  const Quat& q = X->q;
  const double square = q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z;
  if (!(std::fabs(square - 1) < 1e-4))
    fail(Code::kArgument, "%s: the quaternion does not have length 1", owner);
  if (std::fabs(square - 1) > 1e-15) X->q = normalized(q);
}

void check_solver(const SolverDef& s) {
  need(s.h, 1e-5, 0.1, "solver", "h");
  need(s.substeps, 1, 16, "solver", "substeps");
  need(s.iterations, 1, 1000, "solver", "iterations");
  need(s.relaxation, 0.1, 1.99, "solver", "relaxation");
  need(s.erp, 0, 1, "solver", "erp");
  need(s.cfm, 0, 1, "solver", "cfm");
  need(s.contact_erp, 0, 1, "solver", "contact_erp");
  need(s.contact_cfm, 0, 1, "solver", "contact_cfm");
  need(s.contact_layer, 0, 0.1, "solver", "contact_layer");
  need(s.contact_max_speed, 0, 1e3, "solver", "contact_max_speed");
  need(s.contacts_per_pair, 1, 8, "solver", "contacts_per_pair");
  need(s.contacts_max, 0, kMostContacts, "solver", "contacts_max");
  need(s.limit_margin, 0, 0.1, "solver", "limit_margin");
  need(s.limit_stiffness, 0, 1e6, "solver", "limit_stiffness");
  need(s.link_armature, 0, 1, "solver", "link_armature");
  check_law(s.limit_law);
  need(s.sleep_time, 0, 100, "solver", "sleep_time");
  need(s.sleep_speed, 0, 10, "solver", "sleep_speed");
  need(s.sleep_spin, 0, 100, "solver", "sleep_spin");
  if (s.lanes != 0 && s.lanes != 1 && s.lanes != 4 && s.lanes != 8 && s.lanes != 16)
    fail(Code::kRange, "solver: lanes: %d is not one of 0, 1, 4, 8, 16", s.lanes);
}

void check_inertia(const Inertia& inertia, bool may_be_empty, const char* owner) {
  need_finite(inertia.com, owner, "centre of mass");
  for (const double m : inertia.moment)
    if (!std::isfinite(m)) fail(Code::kArgument, "%s: moment of inertia is not finite", owner);
  need(inertia.mass, 0, 1e6, owner, "mass");
  if (may_be_empty && inertia.mass == 0) return;
  if (inertia.mass <= 0) fail(Code::kRange, "%s: mass must be above 0", owner);
  if (!positive_definite(moment_matrix(inertia)))
    fail(Code::kArgument, "%s: moment of inertia is not positive definite", owner);
}

void check_shape(ShapeDef* shape, int32_t num_materials, bool moves) {
  const char* name = shape->name.text;
  check_pose(&shape->X_LS, name);
  need(shape->material, 0, num_materials - 1, name, "material");
  const Vec3& s = shape->size;
  switch (shape->kind) {
    case ShapeKind::kSphere:
      need(s.x, 1e-6, 1e3, name, "radius");
      return;
    case ShapeKind::kCapsule:
    case ShapeKind::kCylinder:
      need(s.x, 1e-6, 1e3, name, "radius");
      need(s.y, 1e-6, 1e3, name, "half length");
      return;
    case ShapeKind::kBox:
    case ShapeKind::kEllipsoid:
      for (int i = 0; i < 3; ++i) need(s[i], 1e-6, 1e3, name, "half size");
      return;
    case ShapeKind::kHull:
      make_hull(shape->points.data(), static_cast<int32_t>(shape->points.size()), name);
      return;
    case ShapeKind::kPlane:
      if (moves) fail(Code::kArgument, "%s: a plane cannot move", name);
      return;
  }
  fail(Code::kArgument, "%s: unknown shape kind %d", name, static_cast<int>(shape->kind));
}

void check_joint(JointDef* joint, int32_t self, int32_t num_links) {
  const char* name = joint->name.text;
  if (joint->kind != JointKind::kRevolute && joint->kind != JointKind::kPrismatic)
    fail(Code::kArgument, "%s: unknown joint kind %d", name, static_cast<int>(joint->kind));
  need_finite(joint->axis, name, "axis");
  if (!(std::fabs(norm(joint->axis) - 1) < 1e-4))
    fail(Code::kArgument, "%s: the axis is not a unit vector", name);
  if (std::fabs(norm(joint->axis) - 1) > 1e-15) joint->axis = normalized(joint->axis);
  need(joint->lower, -1e4, 1e4, name, "lower");
  need(joint->upper, joint->lower, 1e4, name, "upper");
  need(joint->kp, 0, 1e7, name, "kp");
  need(joint->kd, 0, 1e7, name, "kd");
  need(joint->effort, 0, 1e7, name, "effort");
  need(joint->armature, 0, 1e4, name, "armature");
  if (joint->kind == JointKind::kPrismatic && joint->armature != 0)
    fail(Code::kArgument, "%s: a prismatic joint cannot have an armature", name);
  need(joint->friction, 0, 1e4, name, "friction");
  need(joint->slack, 0, 1e4, name, "slack");
  need(joint->ratio, -1e3, 1e3, name, "ratio");
  if (joint->coupled_to < -1 || joint->coupled_to >= num_links || joint->coupled_to == self)
    fail(Code::kArgument, "%s: coupled_to %d is not another link", name, joint->coupled_to);
}

void check_articulation(ArticulationDef* a, int32_t num_materials) {
  const char* name = a->name.text;
  check_pose(&a->X_WB, name);
  need(a->base_damping, 0, 1e6, name, "base_damping");
  if (a->free_base) check_inertia(a->base, false, name);
  const auto num_links = static_cast<int32_t>(a->links.size());
  for (int32_t i = 0; i < num_links; ++i) {
    LinkDef& link = a->links[static_cast<size_t>(i)];
    if (link.parent < -1 || link.parent >= i)
      fail(Code::kArgument, "%s: parent %d does not come before link %d", link.name.text, link.parent, i);
    check_pose(&link.X_PL, link.name.text);
    check_inertia(link.inertia, true, link.name.text);
    check_joint(&link.joint, i, num_links);
  }
  for (const LinkDef& link : a->links)
    if (const int32_t other = link.joint.coupled_to;
        other >= 0 && a->links[static_cast<size_t>(other)].joint.coupled_to >= 0)
      fail(Code::kArgument, "%s: coupled_to %d is itself a coupled joint", link.joint.name.text, other);
  for (ArticulationShape& s : a->shapes) {
    if (s.link < -1 || s.link >= num_links)
      fail(Code::kArgument, "%s: link %d does not exist", s.shape.name.text, s.link);
    check_shape(&s.shape, num_materials, s.link >= 0 || a->free_base);
  }
  const auto num_shapes = static_cast<int32_t>(a->shapes.size());
  for (const auto& [x, y] : a->self_pairs)
    if (x < 0 || y < 0 || x >= num_shapes || y >= num_shapes || x == y)
      fail(Code::kArgument, "%s: self pair (%d, %d) does not name two shapes", name, x, y);
}

void check_body(BodyDef* body, int32_t num_materials) {
  const char* name = body->name.text;
  check_pose(&body->X_WB, name);
  check_inertia(body->inertia, false, name);
  if (norm(body->inertia.com) > 1e-12)
    fail(Code::kArgument, "%s: the centre of mass is not at the origin", name);
  need(body->angular_damping, 0, 1e6, name, "angular_damping");
  need(body->linear_damping, 0, 1e6, name, "linear_damping");
  for (ShapeDef& shape : body->shapes) check_shape(&shape, num_materials, true);
}

void check(SceneDef* def) {
  need_finite(def->gravity, "scene", "gravity");
  check_solver(def->solver);
  need(def->num_materials, 1, kMaxMaterials, "scene", "num_materials");
  for (int i = 0; i < def->num_materials; ++i)
    for (int j = 0; j < def->num_materials; ++j) {
      need(def->friction[i][j].mu, 0, 1e3, "friction", "mu");
      if (def->friction[i][j].mu != def->friction[j][i].mu ||
          def->friction[i][j].passes != def->friction[j][i].passes)
        fail(Code::kArgument, "friction: the values of materials %d and %d depend on their order", i, j);
      check_law(def->laws[i][j]);
      if (!(def->laws[i][j] == def->laws[j][i]))
        fail(Code::kArgument, "contact law: the laws of materials %d and %d depend on their order", i, j);
    }
  if (def->articulations.empty() && def->bodies.empty())
    fail(Code::kArgument, "scene: it has nothing that can move");
  for (ArticulationDef& a : def->articulations) check_articulation(&a, def->num_materials);
  for (BodyDef& body : def->bodies) check_body(&body, def->num_materials);
  for (ShapeDef& shape : def->statics) check_shape(&shape, def->num_materials, false);
}

double bounding_radius(const ShapeDef& shape) {
  const Vec3& s = shape.size;
  switch (shape.kind) {
    case ShapeKind::kSphere:
      return s.x;
    case ShapeKind::kCapsule:
      return s.x + s.y;
    case ShapeKind::kCylinder:
      return norm({s.x, s.y, 0});
    case ShapeKind::kBox:
      return norm(s);
    case ShapeKind::kEllipsoid:
      return std::max({s.x, s.y, s.z});
    case ShapeKind::kHull:
    case ShapeKind::kPlane:
      break;
  }
  return -1;
}

void add_shape(Scene* scene, const ShapeDef& def, Carrier carrier, int32_t index, int32_t articulation) {
  SceneShape shape{def, carrier, index, articulation, bounding_radius(def), -1};
  if (def.kind == ShapeKind::kHull) {
    const Hull hull = make_hull(def.points.data(), static_cast<int32_t>(def.points.size()), def.name.text);
    shape.hull = static_cast<int32_t>(scene->hulls.size());
    shape.def.size = half_box(hull);
    shape.radius = 0;
    for (int32_t i = 0; i < hull.num_points; ++i) shape.radius = std::max(shape.radius, norm(hull.points[i]));
    scene->hulls.push_back(hull);
  }
  scene->shapes.push_back(shape);
}

void flatten(Scene* scene) {
  const auto num_articulations = static_cast<int32_t>(scene->def.articulations.size());
  for (int32_t a = 0; a < num_articulations; ++a) {
    const ArticulationDef& def = scene->def.articulations[static_cast<size_t>(a)];
    const int32_t offset = scene->num_links;
    scene->link_offset.push_back(offset);
    scene->first_shape.push_back(static_cast<int32_t>(scene->shapes.size()));
    for (const LinkDef& link : def.links) {
      if (link.sensor) scene->sensors.push_back(scene->num_links);
      const Quat& q = link.X_PL.q;
      scene->frames.push_back(
          {link.parent < 0 ? -1 : offset + link.parent, link.joint.kind == JointKind::kPrismatic,
           q.w != 1 || q.x != 0 || q.y != 0 || q.z != 0, link.X_PL.p, q, link.joint.axis});
      scene->link_articulation.push_back(a);
      ++scene->num_links;
    }
    for (const ArticulationShape& s : def.shapes)
      add_shape(scene, s.shape, s.link < 0 ? Carrier::kBase : Carrier::kLink,
                s.link < 0 ? -1 : offset + s.link, a);
  }
  scene->first_body_shape = static_cast<int32_t>(scene->shapes.size());
  for (const BodyDef& body : scene->def.bodies) {
    for (const ShapeDef& shape : body.shapes) add_shape(scene, shape, Carrier::kBody, scene->num_bodies, -1);
    ++scene->num_bodies;
  }
  scene->num_body_shapes = static_cast<int32_t>(scene->shapes.size()) - scene->first_body_shape;
  for (const ShapeDef& shape : scene->def.statics) add_shape(scene, shape, Carrier::kStatic, -1, -1);
}

// Distance from the base's origin that no point of the shape can exceed, m.
double reach_of(const Scene& scene, const SceneShape& shape) {
  double reach = norm(shape.def.X_LS.p) + shape.radius;
  for (int32_t i = shape.carrier == Carrier::kLink ? shape.index : -1; i >= 0;
       i = scene.frames[static_cast<size_t>(i)].parent) {
    const LinkFrame& frame = scene.frames[static_cast<size_t>(i)];
    reach += norm(frame.p_PL);
    const JointDef& joint = scene.link(i).joint;
    if (frame.prismatic)
      reach += std::max(std::fabs(joint.lower), std::fabs(joint.upper)) + stop_margin(scene.def.solver);
  }
  return reach;
}

// False when a shape of a fixed-base robot can never come near a shape at rest.
bool within_reach(const Scene& scene, const SceneShape& moving, const SceneShape& rest) {
  if (moving.articulation < 0) return true;
  const ArticulationDef& def = scene.def.articulations[static_cast<size_t>(moving.articulation)];
  if (def.free_base) return true;
  const double reach = reach_of(scene, moving);
  Pose X_WS = rest.def.X_LS;
  if (rest.carrier == Carrier::kBase)
    X_WS = scene.def.articulations[static_cast<size_t>(rest.articulation)].X_WB * X_WS;
  const Vec3 to_base = def.X_WB.p - X_WS.p;
  if (rest.radius < 0) return dot(to_base, rotate(X_WS.q, {0, 0, 1})) < reach;
  return norm(to_base) < reach + rest.radius;
}

void add_pair(Scene* scene, int32_t a, int32_t b) {
  const SceneShape *x = &scene->shapes[static_cast<size_t>(a)], *y = &scene->shapes[static_cast<size_t>(b)];
  if (!x->def.collides || !y->def.collides) return;
  if (!scene->moves(*x)) {
    std::swap(a, b);
    std::swap(x, y);
  }
  if (!scene->moves(*x)) return;
  if (!scene->moves(*y) && !within_reach(*scene, *x, *y)) return;
  const Friction& friction = scene->def.friction[x->def.material][y->def.material];
  if (friction.passes) return;
  scene->pairs.push_back(
      {a, b, friction.mu, y->radius < 0 ? -1 : x->radius + y->radius,
       layer_of(scene->def.solver, std::min(half_width(*scene, *x), half_width(*scene, *y)))});
}

void list_pairs(Scene* scene) {
  const auto num_shapes = static_cast<int32_t>(scene->shapes.size());
  const auto shape = [&](int32_t i) -> const SceneShape& { return scene->shapes[static_cast<size_t>(i)]; };
  int32_t first = 0;
  for (size_t a = 0; a < scene->def.articulations.size(); ++a) {
    const ArticulationDef& def = scene->def.articulations[a];
    for (const auto& [x, y] : def.self_pairs) add_pair(scene, first + x, first + y);
    first += static_cast<int32_t>(def.shapes.size());
  }
  for (int32_t i = 0; i < num_shapes; ++i)
    for (int32_t j = i + 1; j < num_shapes; ++j) {
      const SceneShape &x = shape(i), &y = shape(j);
      if (x.articulation >= 0 && x.articulation == y.articulation) continue;
      if (x.carrier == Carrier::kBody && y.carrier == Carrier::kBody && x.index == y.index) continue;
      if (x.articulation >= 0 && y.articulation >= 0 && !scene->def.articulations_touch) continue;
      add_pair(scene, i, j);
    }
}

void list_runs(Scene* scene) {
  for (int32_t k = 0; k < static_cast<int32_t>(scene->pairs.size()); ++k) {
    const ShapePair& pair = scene->pairs[static_cast<size_t>(k)];
    const SceneShape &x = scene->shapes[static_cast<size_t>(pair.a)],
                     &y = scene->shapes[static_cast<size_t>(pair.b)];
    const bool boxed = y.articulation >= 0 && y.articulation != x.articulation;
    const PairRun run = {k, 1, boxed ? pair.a : -1, boxed ? y.articulation : -1};
    if (scene->runs.empty() || scene->runs.back().shape != run.shape ||
        scene->runs.back().articulation != run.articulation)
      scene->runs.push_back(run);
    else
      ++scene->runs.back().count;
  }
}

// Every law that differs once.
void list_laws(Scene* scene) {
  for (const ShapePair& pair : scene->pairs) {
    const auto material = [&](int32_t shape) {
      return scene->shapes[static_cast<size_t>(shape)].def.material;
    };
    const ContactLaw& law = scene->def.laws[material(pair.a)][material(pair.b)];
    int32_t i = -1;
    if (law.differs()) {
      i = 0;
      while (i < static_cast<int32_t>(scene->laws.size()) && !(scene->laws[static_cast<size_t>(i)] == law))
        ++i;
      if (i == static_cast<int32_t>(scene->laws.size())) scene->laws.push_back(law);
    }
    scene->pair_laws.push_back(static_cast<int16_t>(i));
  }
  if (scene->laws.empty()) scene->pair_laws = {};
}

// The number of contact points of a heap of convex shapes: three neighbours for each shape of a body (each neighbour
// has it as one too, so there are six), one for each shape of a robot, none for shapes without pairs; at least the
// default of scenes.
int32_t contacts_needed(const Scene& scene) {
  constexpr int32_t kOfBody = 3, kOfRobot = 1;
  Vector<int32_t> partners(scene.shapes.size());
  for (const ShapePair& pair : scene.pairs) {
    ++partners[static_cast<size_t>(pair.a)];
    ++partners[static_cast<size_t>(pair.b)];
  }
  int64_t pairs = 0;
  for (size_t i = 0; i < scene.shapes.size(); ++i)
    if (scene.moves(scene.shapes[i]))
      pairs += std::min(partners[i], scene.shapes[i].carrier == Carrier::kBody ? kOfBody : kOfRobot);
  return static_cast<int32_t>(std::clamp<int64_t>(pairs * scene.def.solver.contacts_per_pair,
                                                  SolverDef().contacts_max, kMostContacts));
}

}  // namespace

double half_width(const Scene& scene, const SceneShape& shape) {
  const Vec3& s = shape.def.size;
  switch (shape.def.kind) {
    case ShapeKind::kSphere:
    case ShapeKind::kCapsule:
      return s.x;
    case ShapeKind::kCylinder:
      return std::min(s.x, s.y);
    case ShapeKind::kBox:
    case ShapeKind::kEllipsoid:
      return std::min({s.x, s.y, s.z});
    case ShapeKind::kHull: {
      const Hull& hull = *scene.hull_of(shape);
      double width = HUGE_VAL;
      for (int32_t f = 0; f < hull.num_faces; ++f) {
        double lowest = HUGE_VAL;
        for (int32_t i = 0; i < hull.num_points; ++i)
          lowest = std::min(lowest, dot(hull.faces[f].n, hull.points[i]));
        width = std::min(width, hull.faces[f].offset - lowest);
      }
      return 0.5 * width;
    }
    case ShapeKind::kPlane:
      break;
  }
  return HUGE_VAL;
}

void validate_body(BodyDef body, int32_t num_materials) {
  check_body(&body, num_materials);
}

void validate_static(ShapeDef shape, int32_t num_materials) {
  check_shape(&shape, num_materials, false);
}

Name::Name(const char* s) {
  std::strncpy(text, s, kNameSize - 1);
}
bool Name::operator==(const char* s) const {
  return std::strcmp(text, s) == 0;
}

const LinkDef& Scene::link(int32_t i) const {
  const auto a = static_cast<size_t>(link_articulation[static_cast<size_t>(i)]);
  return def.articulations[a].links[static_cast<size_t>(i - link_offset[a])];
}

bool Scene::moves(const SceneShape& shape) const {
  switch (shape.carrier) {
    case Carrier::kLink:
    case Carrier::kBody:
      return true;
    case Carrier::kBase:
      return def.articulations[static_cast<size_t>(shape.articulation)].free_base;
    case Carrier::kStatic:
      break;
  }
  return false;
}

int32_t Scene::find_shape(const char* name) const {
  for (size_t i = 0; i < shapes.size(); ++i)
    if (shapes[i].def.name == name) return static_cast<int32_t>(i);
  fail(Code::kNotFound, "shape %s does not exist", name);
}

Scene make_scene(SceneDef def) {
  check(&def);
  Scene scene;
  scene.def = std::move(def);
  flatten(&scene);
  list_pairs(&scene);
  list_runs(&scene);
  list_laws(&scene);
  if (scene.def.solver.contacts_max == 0) scene.def.solver.contacts_max = contacts_needed(scene);
  return scene;
}

}  // namespace rdm
