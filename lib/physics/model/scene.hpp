// What a world is made of: constant, shared by all worlds of a pool, and free of any engine's types.
//
// A scene has articulations (trees of links on a fixed or free base), free bodies, and static shapes.
// Every shape has one number (its index in Scene::shapes) by which contacts, pictures and tasks name it.
#pragma once
#include <cstdint>
#include <utility>

#include "base/host.hpp"
#include "base/vec.hpp"
#include "physics/model/contact_law.hpp"
#include "physics/model/hull.hpp"

namespace rdm {

inline constexpr int kNameSize = 32;
struct Name {
  char text[kNameSize] = "";
  Name() = default;
  Name(const char* s);  // cuts at kNameSize - 1
  bool operator==(const char* s) const;
};

enum class ShapeKind : int32_t {
  kSphere = 0,
  kCapsule = 1,
  kBox = 2,
  kCylinder = 3,
  kPlane = 4,
  kEllipsoid = 5,
  kHull = 6
};

// How many sizes a primitive has; 0 for hulls, planes and what is no kind.
constexpr int num_sizes(ShapeKind kind) {
  switch (kind) {
    case ShapeKind::kSphere:
      return 1;
    case ShapeKind::kCapsule:
    case ShapeKind::kCylinder:
      return 2;
    case ShapeKind::kBox:
    case ShapeKind::kEllipsoid:
      return 3;
    case ShapeKind::kHull:
    case ShapeKind::kPlane:
      break;
  }
  return 0;
}

// size: sphere (radius, 0, 0); capsule and cylinder along z (radius, half length of the straight part, 0);
// box half sizes; plane (0, 0, 0): the half space below z = 0 of its frame; ellipsoid half axes; hull: the
// scene sets it to half sizes of the box about its frame's origin that holds it. m.
// What a shape looks made of, in pictures for people.
enum class Finish : uint8_t { kPaint, kSkin, kPlastic, kRubber, kWood, kMetal, kGlass, kCloth };

struct ShapeDef {
  Name name;
  ShapeKind kind = ShapeKind::kSphere;
  Vec3 size;
  Pose X_LS;             // in the frame of the link or body that carries it (of the world if static)
  int32_t material = 0;  // row of the pair friction table
  uint8_t color[3] = {200, 200, 200};
  Finish finish = Finish::kPaint;
  bool collides = true;  // false: only seen
  Vector<Vec3> points;   // of a hull: what make_hull takes
};

enum class JointKind : int32_t { kRevolute = 0, kPrismatic = 1 };

// A joint moves its link about (along) `axis` of the link's own frame, at the link's origin. rad, N m, s
// (m, N for prismatic).
struct JointDef {
  Name name;
  JointKind kind = JointKind::kRevolute;
  Vec3 axis{0, 0, 1};
  double lower = 0, upper = 0;  // range
  double kp = 0, kd = 0;        // drive: torque = kp (target - q) - kd qd, implicit
  double effort = 0;            // bound of the drive's torque
  double velocity = 0;          // how fast its target may move, which whoever sets it sees to; 0: at once
  double armature = 0;          // added inertia about the axis, kg m2; revolute only
  double friction = 0;          // dry friction torque
  // A coupled joint has no target of its own: it is driven to clamp(q, ratio q_other -+ slack).
  int32_t coupled_to = -1;  // link of the same articulation, before or behind, not coupled itself; -1: none
  double ratio = 1, slack = 0;
};

struct Inertia {
  double mass = 0;                        // kg
  Vec3 com;                               // in the link frame
  double moment[6] = {0, 0, 0, 0, 0, 0};  // xx yy zz xy xz yz about com, link axes, kg m2
};

struct LinkDef {
  Name name;
  int32_t parent = -1;  // link index, -1: the base; a parent stands before its children
  Pose X_PL;            // link frame in the parent's frame at q = 0
  Inertia inertia;
  JointDef joint;
  bool sensor = false;      // contact force and torque on it are summed and reported
  bool weightless = false;  // feels no gravity, though its articulation does
};

struct ArticulationShape {
  int32_t link = -1;  // -1: the base
  ShapeDef shape;
};

struct ArticulationDef {
  Name name;
  Pose X_WB;  // base frame in the world (start pose when free)
  bool free_base = false;
  Inertia base;             // of a free base
  double base_damping = 0;  // 1/s on linear and angular velocity of every link of a free-base robot
  bool gravity = false;     // on base and links, but for those that are weightless
  Vector<LinkDef> links;
  Vector<ArticulationShape> shapes;
  Vector<std::pair<int32_t, int32_t>> self_pairs;  // shape indices within `shapes` that may touch
};

struct BodyDef {
  Name name;
  Pose X_WB;                   // start pose
  Inertia inertia;             // com must be the body's origin
  double angular_damping = 0;  // 1/s
  double linear_damping = 0;   // 1/s
  bool gravity = true;
  Vector<ShapeDef> shapes;
};

// mu and softness of contacts between two materials; the table is symmetric.
struct Friction {
  double mu = 1;
  bool passes = false;  // the two go through each other
};

inline constexpr int32_t kMostContacts = 4096;

// How engine articulated carries a robot's momenta over a substep (articulated/look_ahead.inl).
enum class Integrator : int32_t {
  kAuto = 0,      // trapezoid for free bases that little damps, else euler
  kEuler = 1,     // semi-implicit, one solve; a free base without damping may gain energy without bound
  kTrapezoid = 2  // by the pose behind and the pose to come: energy swings and does not drift
};

struct SolverDef {
  double h = 1.0 / 120;          // substep, s
  int32_t substeps = 2;          // per control step, 1..16
  int32_t iterations = 8;        // at most; engine ode 1..8
  double relaxation = 1.3;       // successive over-relaxation of QuickStep
  double erp = 0.8, cfm = 1e-9;  // joints
  double contact_erp = 0.2, contact_cfm = 1e-4;
  double contact_layer = 0.0005;    // m of allowed depth, less between thin things: kLayerShare
  double contact_max_speed = 0;     // m/s, correction of depth; 0: the engine's own, see below
  int32_t contacts_per_pair = 4;    // 1..8
  int32_t contacts_max = 36;        // per world and substep, to kMostContacts; more raise
                                    // kStatusContactOverflow; 0: make_scene fills in what the shapes need
  double limit_margin = 5e-3;       // rad beyond a joint's range before it is clamped, without a reaction
  double limit_stiffness = 100;     // N m/rad of the soft limit; engine articulated: of light joints, 0: none
  double link_armature = 3e-5;      // kg m2 about the joint axis of links under 1e-4 kg m2 (engine ode)
  bool spring_only_effort = false;  // true: effort bounds the spring alone, damping stays outside
  bool exact = false;               // engine ode: the O(n^3) solver, slow; the reference of tests
  // Engine articulated:
  bool double_precision = false;  // arithmetic in double, one lane: a reference, half as fast
  Integrator integrator = Integrator::kAuto;
  int32_t lanes = 0;  // 1, 4, 8 or 16 numbers at a time; 0: what suits scene and machine. Same bytes for all
  bool speculative_contacts = false;  // rows for what free bodies are about to hit (collision/sweep.hpp)
  ContactLaw limit_law;               // of joint limits, where it is soft: in place of limit_stiffness
  // Free bodies fall asleep (articulated/sleep.hpp) once they have been slower than both for so long.
  double sleep_time = 0;                         // s; 0: never
  double sleep_speed = 0.01, sleep_spin = 0.25;  // m/s, rad/s
};

// Faster correction helps engine ode, whose contacts give way; in joint coordinates it would kick fingers.
inline constexpr double kOdeContactSpeed = 1.0, kArticulatedContactSpeed = 0.4;  // m/s

// Of the smallest half width of the thinner of two shapes: what they may be in each other at rest.
inline constexpr double kLayerShare = 0.05;

inline constexpr int kMaxMaterials = 16;

struct SceneDef {
  Vec3 gravity{0, 0, -9.81};
  SolverDef solver;
  Vector<ArticulationDef> articulations;
  Vector<BodyDef> bodies;
  Vector<ShapeDef> statics;
  int32_t num_materials = 1;
  Friction friction[kMaxMaterials][kMaxMaterials];
  ContactLaw laws[kMaxMaterials][kMaxMaterials];  // symmetric; engine articulated, others: World::make
  bool articulations_touch = true;  // shapes of different articulations may (friction by material)
  bool feedforward = false;         // worlds have World::feedforward, a torque added to every drive
  bool adjustable = false;          // worlds have World::dynamics, factors on these constants (dynamics.hpp)
};

// Of one articulation: links, and six for a free base.
inline constexpr int32_t kMaxCoords = 512;

// Where a shape of the flattened scene sits. The base of an articulation may be fixed or free.
enum class Carrier : int32_t { kStatic = 0, kLink = 1, kBody = 2, kBase = 3 };
struct SceneShape {
  ShapeDef def;
  Carrier carrier = Carrier::kStatic;
  int32_t index = -1;         // flat link index or body index; -1 for statics and bases
  int32_t articulation = -1;  // owner, -1: none
  double radius = 0;          // m, of the sphere around X_LS.p that holds the shape; < 0: a plane
  int32_t hull = -1;          // index of Scene::hulls
};

// `a` always moves; `b` may be at rest.
struct ShapePair {
  int32_t a, b;  // indices of Scene::shapes
  double mu;
  double reach;  // m, sum of bounding radii; < 0: b is a plane
  double layer;  // m of allowed depth: contact_layer, at most kLayerShare of the thinner shape's half width
};

// What forward kinematics needs of a link, packed.
struct LinkFrame {
  int32_t parent = -1;  // flat link index, -1: the base
  bool prismatic = false;
  bool turned = false;  // q_PL is not the identity
  Vec3 p_PL;
  Quat q_PL;
  Vec3 axis;
};

// A run of neighbours in Scene::pairs. With an articulation given, all of them are pairs of one `shape` with
// shapes of that articulation: while the shape is outside the box around those, none of them can touch.
struct PairRun {
  int32_t first, count;
  int32_t shape, articulation;  // -1: pairs of any kind
};

// The flattened, validated, constant model. Links of all articulations are numbered in one row
// (`link_offset`), and so are their joints: joint i moves link i.
struct Scene {
  SceneDef def;
  int32_t num_links = 0, num_bodies = 0;
  int32_t first_body_shape = 0;  // shapes of bodies stand in one run
  int32_t num_body_shapes = 0;
  Vector<int32_t> link_offset;        // per articulation
  Vector<int32_t> link_articulation;  // per link
  Vector<int32_t> first_shape;        // per articulation
  Vector<LinkFrame> frames;           // per link
  Vector<SceneShape> shapes;  // articulation by articulation (base shapes are in place), bodies, statics
  Vector<Hull> hulls;
  Vector<ShapePair> pairs;    // all pairs that may touch, in fixed order
  Vector<PairRun> runs;       // the same pairs, run by run
  Vector<ContactLaw> laws;    // those of pairs that have one of their own
  Vector<int16_t> pair_laws;  // [pairs] index of laws, -1: none; empty: no pair has one
  Vector<int32_t> sensors;    // link indices with a sensor

  const LinkDef& link(int32_t i) const;
  // Null: the pair has no law of its own.
  const ContactLaw* law_of(int32_t pair) const {
    if (pair_laws.empty()) return nullptr;
    const int16_t i = pair_laws[static_cast<size_t>(pair)];
    return i < 0 ? nullptr : &laws[static_cast<size_t>(i)];
  }
  bool moves(const SceneShape& shape) const;  // not static, not on a fixed base
  // Null where the shape is of another kind.
  const Hull* hull_of(const SceneShape& shape) const {
    return shape.hull < 0 ? nullptr : &hulls[static_cast<size_t>(shape.hull)];
  }
  // Index by name; Error(kNotFound).
  int32_t find_shape(const char* name) const;
  double control_dt() const { return def.solver.h * def.solver.substeps; }
};

// Half of a shape's extent along the axis along which it is thinnest, m; infinite for a plane. Of a hull, along
// the normals of its faces.
double half_width(const Scene& scene, const SceneShape& shape);
// What a contact of things with these half widths may be deep, m.
inline double layer_of(const SolverDef& solver, double half_width) {
  return half_width * kLayerShare < solver.contact_layer ? half_width * kLayerShare : solver.contact_layer;
}

// Error(kArgument) or Error(kRange) for anything a world could not be made of.
Scene make_scene(SceneDef def);

}  // namespace rdm
