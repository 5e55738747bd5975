#include "tasks/throw_game.hpp"

#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"
#include "tasks/hands.hpp"
#include "tasks/throw_objects.hpp"

namespace rdm {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr double kDegree = kPi / 180;
constexpr int kMaxDraws = 100;
constexpr double kRaise = 0.005;  // m a time, when no draw was clear
constexpr int kMaxRaises = 100;

constexpr OptionSpec kRows[] = {
    number_option("object_mass", 0, 0, 10, "mass of the object, kg; 0: its own"),
    number_option("object_damping", 0.1, 0, 100,
                  "angular damping of the object, 1/s; stands for rolling friction"),
    number_option("start_noise", 0.01, 0, 0.2, "half width of the start position's draw, m per axis"),
    text_option("start_rotation", "random", "random|fixed", "rotation of the object at the start"),
    text_option("goal_rotation", "random", "random|fixed", "rotation of the goal, redrawn at each reset"),
    number_option("joint_noise", 0.2, 0, 1, "share of each joint's range that is drawn at a reset"),
    text_option("joint_noise_mode", "one_sided", "one_sided|literal",
                "draw u in [0, 1) for each hand, or (literal) in [-1, 1) and the same for both"),
    number_option("alpha", 50, 0, 1000, "weight of distance in the reward, 1/m"),
    number_option("reward_scale", 1, 0, 1000, "factor on the reward"),
    flag_option("ignore_rotation", false, "leave the rotation out of the reward"),
    flag_option("canonical_rotation", false, "rotation error with w >= 0 in the observation"),
    number_option("success_distance", 0.05, 0, 1, "object to goal distance that counts as success, m"),
    integer_option("success_steps", 10, 1, 1000, "consecutive steps within it"),
    integer_option("max_steps", 75, 1, 100000, "control steps of an episode"),
};

}  // namespace

void add_throw_options(const ThrowPlace& place, OptionTable& table) {
  table.add(text_option("object", "egg", throw_object_choices(), "what is thrown"));
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i)
    table.add("start", kAxes[i], nullptr, number_option("", place.start[i], -10, 10, "start position, m"));
  for (int i = 0; i < 3; ++i)
    table.add("goal", kAxes[i], nullptr, number_option("", place.goal[i], -10, 10, "goal position, m"));
  table.add(
      number_option("fall_height", place.fall_height, -10, 10, "the episode ends with the object below, m"));
  table.add(kRows);
}

ThrowGame throw_game_from(const Options& o) {
  ThrowGame g;
  g.start = {o.number("start.x"), o.number("start.y"), o.number("start.z")};
  g.goal = {o.number("goal.x"), o.number("goal.y"), o.number("goal.z")};
  g.start_noise = o.number("start_noise");
  g.fall_height = o.number("fall_height");
  g.joint_noise = o.number("joint_noise");
  g.joint_noise_literal = same_name(o.text("joint_noise_mode"), "literal");
  g.alpha = o.number("alpha");
  g.reward_scale = o.number("reward_scale");
  g.success_distance = o.number("success_distance");
  g.success_steps = o.integer("success_steps");
  g.random_start = same_name(o.text("start_rotation"), "random");
  g.random_goal = same_name(o.text("goal_rotation"), "random");
  g.ignore_rotation = o.flag("ignore_rotation");
  g.canonical_rotation = o.flag("canonical_rotation");
  return g;
}

BodyDef throw_body_from(const Options& o) {
  const Pose start{throw_game_from(o).start, {}};
  return make_throw_body(throw_object_named(o.text("object")), o.number("object_mass"),
                         o.number("object_damping"), kObject, start);
}

Quat draw_rotation(Stream& stream) {
  const double a = kPi * stream.signed_unit(), b = kPi * stream.signed_unit();
  return axis_angle({1, 0, 0}, a) * axis_angle({0, 1, 0}, b);
}

void reset_throw(const ThrowGame& game, World& world, ThrowState* state, Stream& stream) {
  Motion m;
  bool clear = false;
  for (int draw = 0; draw < kMaxDraws && !clear; ++draw) {
    for (int i = 0; i < 3; ++i) m.X.p[i] = game.start[i] + game.start_noise * stream.signed_unit();
    m.X.q = game.random_start ? draw_rotation(stream) : Quat{};
    world.set_body(0, m);
    clear = world.body_overlap(0) <= 0;
  }
  for (int raise = 0; raise < kMaxRaises && !clear; ++raise) {
    m.X.p.z += kRaise;
    world.set_body(0, m);
    clear = world.body_overlap(0) <= 0;
  }
  state->goal = game.random_goal ? draw_rotation(stream) : Quat{};
}

Quat rotation_error(const ThrowGame& game, const Quat& rotation, const ThrowState& state) {
  const Quat q = rotation * conjugate(state.goal);
  return game.canonical_rotation && q.w < 0 ? Quat{-q.w, -q.x, -q.y, -q.z} : q;
}

double rotation_angle(const Quat& q) {
  return 2 * elementary::asin(std::min(1.0, std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z)));
}

ThrowMeasure measure_throw(const ThrowGame& game, const World& world, const ThrowState& state) {
  const Pose& X = world.body(0).X;
  return {norm(X.p - game.goal), game.ignore_rotation ? 0 : rotation_angle(rotation_error(game, X.q, state))};
}

double throw_reward(const ThrowMeasure& m, double alpha, double scale) {
  return scale * elementary::exp(-0.2 * (alpha * m.distance + m.theta));
}

bool count_success(const ThrowGame& game, double distance, ThrowState* state) {
  state->near = distance <= game.success_distance ? state->near + 1 : 0;
  return state->near >= game.success_steps;
}

namespace {

struct ThrowView {
  const ThrowGame& game;
  const ThrowState& state;
  const Motion& object;
};

constexpr FieldEntry<ThrowView> kFields[] = {
    {"object.position", "m", 3, [](const ThrowView& v, float* out) { put(v.object.X.p, out); }},
    {"object.rotation", "1", 4, [](const ThrowView& v, float* out) { put(v.object.X.q, out); }},
    {"object.velocity", "m/s", 3, [](const ThrowView& v, float* out) { put(v.object.v, out); }},
    {"object.spin", "5 rad/s", 3, [](const ThrowView& v, float* out) { put(v.object.w, out, 0.2); }},
    {"goal.position", "m", 3, [](const ThrowView& v, float* out) { put(v.game.goal, out); }},
    {"goal.rotation", "1", 4, [](const ThrowView& v, float* out) { put(v.state.goal, out); }},
    {"object.rotation_error", "1", 4,
     [](const ThrowView& v, float* out) { put(rotation_error(v.game, v.object.X.q, v.state), out); }},
};

}  // namespace

void add_throw_fields(FieldTable& table) {
  for (const auto& e : kFields) add_field(table, nullptr, e.name, e.unit, e.count);
}

float* write_throw(const ThrowGame& game, const World& world, const ThrowState& state, float* out) {
  return write_fields<kFields>(ThrowView{game, state, world.body(0)}, out);
}

const CameraSpec kThrowCameras[] = {
    {"front", {1.1, -0.5, 0.9}, {0, -0.5, 0.5}, 45 * kDegree},
    {"top", {0, -0.5, 1.8}, {0, -0.5, 0.5}, 45 * kDegree},
    {"right", {0.6, 0.3, 0.9}, {0, -0.4, 0.5}, 45 * kDegree},
    {"left", {0.6, -1.3, 0.9}, {0, -0.6, 0.5}, 45 * kDegree},
    {"close", {0.62, -0.34, 0.84}, {0, -0.5, 0.53}, 45 * kDegree},
    // close by, for point clouds
    {"cloud_above", {0, -0.5, 0.95}, {0, -0.5, 0.5}, 57 * kDegree},
    {"cloud_front", {0.4, -0.5, 0.75}, {0, -0.5, 0.5}, 57 * kDegree},
    {"cloud_back", {-0.4, -0.5, 0.75}, {0, -0.5, 0.5}, 57 * kDegree},
};
const int32_t kNumThrowCameras = sizeof kThrowCameras / sizeof *kThrowCameras;

}  // namespace rdm
