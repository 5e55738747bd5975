#include "tasks/hand/object_goal.hpp"

#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"
#include "objects/hull_text.hpp"
#include "objects/objects.hpp"
#include "tasks/hand/hand_control.hpp"
#include "tasks/state_check.hpp"

namespace rdm {
namespace {

constexpr int kMaxDraws = 100;
constexpr const char* kOctahedron = "0.035,0,0;-0.035,0,0;0,0.035,0;0,-0.035,0;0,0,0.035;0,0,-0.035";
constexpr double kRaise = 0.005;  // m a time, when no draw was clear
constexpr int kMaxRaises = 100;
constexpr int kRings = 20, kPlaces = 8;  // aside: circles kRaise apart, places on each

struct ObjectOptions : GoalOptions {
  const char *object, *hull;  // texts of the Options
  DrawnOption object_mass, object_damping, object_scale;
  double start_x, start_y, start_z, goal_x, goal_y, goal_z;  // m
  bool own_friction;
  DrawnOption ground_friction;
};
constexpr auto kRows = option_rows<ObjectOptions>(
    row<&ObjectOptions::object>(
        basic(text_option("object", "", nullptr, "object that is handled, by name (redman objects)"))),
    row<&ObjectOptions::hull>(text_option(
        "hull", kOctahedron, nullptr,
        "corners of object=hull, m, at most 32: x,y,z;x,y,z;... (redman hull computes them from a mesh)",
        kHullTextSize - 1)),
    row<&ObjectOptions::object_mass>(levelled(
        basic(number_option("object_mass", 0, 0, 10, "mass of the object, kg; 0: the object's own mass")))),
    row<&ObjectOptions::start_x>(number_option("start.x", 0, -10, 10, "x of the object's start position, m")),
    row<&ObjectOptions::start_y>(number_option("start.y", 0, -10, 10, "y of the object's start position, m")),
    row<&ObjectOptions::start_z>(number_option("start.z", 0, -10, 10, "z of the object's start position, m")),
    row<&ObjectOptions::goal_x>(number_option("goal.x", 0, -10, 10, "x of the object's goal position, m")),
    row<&ObjectOptions::goal_y>(number_option("goal.y", 0, -10, 10, "y of the object's goal position, m")),
    row<&ObjectOptions::goal_z>(number_option("goal.z", 0, -10, 10, "z of the object's goal position, m")),
    row<&GoalOptions::start_noise>(
        basic(number_option("start_noise", 0.01, 0, 0.2,
                            "half width of the uniform noise on the object's start position, per axis, m"))),
    row<&GoalOptions::start_rotation, StartRotation::kRandom, StartRotation::kYaw, StartRotation::kFixed>(
        text_option("start_rotation", "random", "random|yaw|fixed",
                    "rotation of the object at the start; yaw: at random about the vertical axis")),
    row<&GoalOptions::random_goal, true, false>(text_option(
        "goal_rotation", "random", "random|fixed", "rotation of the goal; random: drawn at each reset")),
    row<&ObjectOptions::object_damping>(levelled(number_option(
        "object_damping", 0.1, 0, 100, "angular damping of the object, 1/s; models its rolling friction"))),
    row<&ObjectOptions::object_scale>(drawable(basic(
        number_option("object_scale", 1, 0.1, 10, "factor on the object's size; its mass does not change")))),
    row<&GoalOptions::canonical_rotation>(legacy(flag_option(
        "canonical_rotation", false, "the rotation error in the observation has the sign with w >= 0"))),
    row<&ObjectOptions::own_friction>(flag_option(
        "own_friction", false,
        "friction.hand_object and friction.object_ground have the value of the object's own surface")),
    row<&ObjectOptions::ground_friction>(levelled(number_option(
        "friction.object_ground", 1, 0, 10, "friction coefficient between object and ground"))));

Quat draw_start(StartRotation kind, Stream& stream) {
  if (kind == StartRotation::kRandom) return draw_rotation(stream);
  return kind == StartRotation::kYaw ? axis_angle({0, 0, 1}, kPi * stream.signed_unit()) : Quat{};
}

}  // namespace

void check_goal(const GoalState& state) {
  check_rotation("goal", state.goal);
}

void add_object_options(const ObjectPlace& place, OptionTable& table) {
  table.add(kRows.with<&ObjectOptions::object>(place.object)
                .with<&ObjectOptions::object_mass>(place.mass)
                .with<&ObjectOptions::start_x>(place.start.x)
                .with<&ObjectOptions::start_y>(place.start.y)
                .with<&ObjectOptions::start_z>(place.start.z)
                .with<&ObjectOptions::goal_x>(place.goal.x)
                .with<&ObjectOptions::goal_y>(place.goal.y)
                .with<&ObjectOptions::goal_z>(place.goal.z)
                .with<&GoalOptions::start_noise>(place.noise)
                .with<&GoalOptions::start_rotation>(place.start_rotation));
}

ObjectGoal object_goal_from(const Options& options) {
  const ObjectOptions o = kRows.read(options);
  ObjectGoal g;
  static_cast<GoalOptions&>(g) = o;
  g.start = {o.start_x, o.start_y, o.start_z};
  g.goal = {o.goal_x, o.goal_y, o.goal_z};
  return g;
}

void add_object(const Options& options, HandScene* scene) {
  const ObjectOptions o = kRows.read(options);
  const Pose start{{o.start_x, o.start_y, o.start_z}, {}};
  const double mass = o.object_mass.middle, scale = o.object_scale.middle;
  const ObjectRef object(find_object(o.object));
  BodyDef body = same_name(object->name, "hull")
                     ? make_hull_body(o.hull, "object", start, mass, scale, kObject)
                     : make_object_body(*object, "object", start, mass, scale, kObject);
  body.angular_damping = o.object_damping.middle;
  const auto index = static_cast<int32_t>(scene->bodies.size());
  scene->bodies.push_back(body);
  scene->draws.add(o.object_mass, Drawn::kBodyMass, index);
  scene->draws.add(o.object_damping, Drawn::kBodyDamping, index);
  scene->draws.add(o.object_scale, Drawn::kBodySize, index);
  set_friction(scene, kObject, kGround, o.ground_friction);
  if (!o.own_friction) return;
  for (const int32_t other : {kRightHand, kLeftHand, kGround})
    set_friction(scene, kObject, other, object->material.friction);
}

Quat draw_rotation(Stream& stream) {
  const double a = kPi * stream.signed_unit(), b = kPi * stream.signed_unit();
  return axis_angle({1, 0, 0}, a) * axis_angle({0, 1, 0}, b);
}

void draw_goal(const ObjectGoal& goal, GoalState* state, Stream& stream) {
  state->goal = goal.random_goal ? draw_rotation(stream) : Quat{};
}

void reset_object(const ObjectGoal& goal, World& world, GoalState* state, Stream& stream) {
  Motion m;
  bool clear = false;
  for (int draw = 0; draw < kMaxDraws && !clear; ++draw) {
    for (int i = 0; i < 3; ++i) m.X.p[i] = goal.start[i] + goal.start_noise * stream.signed_unit();
    m.X.q = draw_start(goal.start_rotation, stream);
    world.set_body(0, m);
    clear = world.body_overlap(0) <= 0;
  }
  const auto tried_at = [&](const Vec3& p) {
    m.X.p = p;
    world.set_body(0, m);
    clear = world.body_overlap(0) <= 0;
  };
  const Vec3 p = m.X.p;
  if (goal.standing) {
    for (int k = 0; k < kRings * kPlaces && !clear; ++k) {
      const int ring = k / kPlaces;
      const double r = kRaise * (1 + ring), angle = 2 * kPi / kPlaces * (k % kPlaces);
      tried_at(p + Vec3{r * elementary::cos(angle), r * elementary::sin(angle), 0});
    }
  } else {
    for (int raise = 0; raise < kMaxRaises && !clear; ++raise) tried_at(m.X.p + Vec3{0, 0, kRaise});
  }
  draw_goal(goal, state, stream);
}

Quat rotation_error(const ObjectGoal& goal, const Quat& rotation, const GoalState& state) {
  const Quat q = rotation * conjugate(state.goal);
  return goal.canonical_rotation && q.w < 0 ? Quat{-q.w, -q.x, -q.y, -q.z} : q;
}

double rotation_angle(const Quat& q) {
  return 2 * elementary::asin(std::min(1.0, std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z)));
}

namespace {

struct GoalView {
  const ObjectGoal& goal;
  const GoalState& state;
  const Motion& object;
};

constexpr FieldEntry<GoalView> kFields[] = {
    {"object.position", "m", 3, [](const GoalView& v, float* out) { put(v.object.X.p, out); }},
    {"object.rotation", "1", 4, [](const GoalView& v, float* out) { put(v.object.X.q, out); }},
    {"object.velocity", "m/s", 3, [](const GoalView& v, float* out) { put(v.object.v, out); }},
    {"object.spin", "5 rad/s", 3, [](const GoalView& v, float* out) { put(v.object.w, out, 0.2); }},
    {"goal.position", "m", 3, [](const GoalView& v, float* out) { put(v.goal.goal, out); }},
    {"goal.rotation", "1", 4, [](const GoalView& v, float* out) { put(v.state.goal, out); }},
    {"object.rotation_error", "1", 4,
     [](const GoalView& v, float* out) { put(rotation_error(v.goal, v.object.X.q, v.state), out); }},
};

}  // namespace

void add_goal_fields(FieldTable& table) {
  for (const auto& e : kFields) add_field(table, nullptr, e.name, e.unit, e.count);
}

float* write_goal(const ObjectGoal& goal, const World& world, const GoalState& state, float* out) {
  return write_fields<kFields>(GoalView{goal, state, world.body(0)}, out);
}

}  // namespace rdm
