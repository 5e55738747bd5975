// What a malformed description, scene or call in a world gets: an error that names the thing and its range.
// The table is printed.
#include <gtest/gtest.h>
#include <redman/redman.h>

#include <functional>

#include "own_task.hpp"

namespace rdm::test {
namespace {

void expect_text(rdm_result r, rdm_result wanted, const std::string& text) {
  EXPECT_EQ(r, wanted) << text;
  EXPECT_EQ(std::string(rdm_last_error()), text);
  std::printf("%4d  %s\n", r, rdm_last_error());
}

struct BadDef {
  rdm_result code;
  const char* text;
  std::function<void(BallTask&)> change;
};

TEST(OwnTaskErrors, OfDescriptions) {
  static const float far[2] = {2, 0};
  const BadDef rows[] = {
      {RDM_ERROR_ARGUMENT, "def.name is NULL", [](auto& t) { t.def.name = nullptr; }},
      {RDM_ERROR_RANGE, "def.name:  must have 1 to 40 characters", [](auto& t) { t.def.name = ""; }},
      {RDM_ERROR_ARGUMENT, "def.name: a b may contain only letters, digits, '_', '-' and '.'",
       [](auto& t) { t.def.name = "a b"; }},
      {RDM_ERROR_ARGUMENT, "task grasp: the name is already used", [](auto& t) { t.def.name = "grasp"; }},
      {RDM_ERROR_RANGE, "def.max_steps: 0 is outside [1, 100000]", [](auto& t) { t.def.max_steps = 0; }},
      {RDM_ERROR_RANGE, "def.action_dim: 1025 is outside [1, 1024]",
       [](auto& t) { t.def.action_dim = 1025; }},
      {RDM_ERROR_RANGE, "def.obs_limit: -1 is outside [0, 1e30]", [](auto& t) { t.def.obs_limit = -1; }},
      {RDM_ERROR_RANGE, "def.state_bytes: 1048577 is above 1048576",
       [](auto& t) { t.def.state_bytes = (1 << 20) + 1; }},
      {RDM_ERROR_RANGE, "def.instance_bytes: 16777217 is above 16777216",
       [](auto& t) { t.def.instance_bytes = (1 << 24) + 1; }},
      {RDM_ERROR_ARGUMENT, "def.build is NULL", [](auto& t) { t.def.build = nullptr; }},
      {RDM_ERROR_ARGUMENT, "def.observe is NULL", [](auto& t) { t.def.observe = nullptr; }},
      {RDM_ERROR_RANGE, "def.hold[0]: 2 is outside [-1, 1]", [](auto& t) { t.def.hold = far; }},
      {RDM_ERROR_RANGE, "def.num_fields: 0 is outside [1, 512]", [](auto& t) { t.def.num_fields = 0; }},
      {RDM_ERROR_ARGUMENT, "def.fields is NULL with num_fields 4", [](auto& t) { t.def.fields = nullptr; }},
      {RDM_ERROR_ARGUMENT, "def.fields[1].name: ball.position occurs twice",
       [](auto& t) { t.fields[1].name = "ball.position"; }},
      {RDM_ERROR_ARGUMENT, "def.fields[0].unit is NULL", [](auto& t) { t.fields[0].unit = nullptr; }},
      {RDM_ERROR_RANGE, "def.fields[2].count: 0 of paddle.position is outside [1, 16384]",
       [](auto& t) { t.fields[2].count = 0; }},
      {RDM_ERROR_RANGE, "def.fields[2]: low 1 of paddle.position is not below high -1",
       [](auto& t) { t.fields[2].low = 1, t.fields[2].high = -1; }},
      {RDM_ERROR_RANGE, "def.num_costs: 0 is outside [1, 16]", [](auto& t) { t.def.num_costs = 0; }},
      {RDM_ERROR_RANGE, "def.num_costs: 17 is outside [1, 16]", [](auto& t) { t.def.num_costs = 17; }},
      {RDM_ERROR_ARGUMENT, "def.costs[1].name: touch occurs twice",
       [](auto& t) { t.costs[1].name = "touch"; }},
      {RDM_ERROR_ARGUMENT, "def.costs[0].limit of touch is not finite",
       [](auto& t) { t.costs[0].limit = NAN; }},
      {RDM_ERROR_ARGUMENT, "def.options[1].key: push occurs twice",
       [](auto& t) { t.options[1].key = "push"; }},
      {RDM_ERROR_ARGUMENT, "def.options[0].help is NULL", [](auto& t) { t.options[0].help = nullptr; }},
      {RDM_ERROR_RANGE, "def.options[0].number: 11 of push is outside [0, 10], or not an integer",
       [](auto& t) { t.options[0].number = 11; }},
      {RDM_ERROR_ARGUMENT,
       "def.options[0].choices of push: for a number or an integer it must be \"a..b\" or NULL",
       [](auto& t) { t.options[0].choices = "1|2"; }},
      {RDM_ERROR_ARGUMENT,
       "def.options[0].text of push: only a text, or a number that takes a range, has one",
       [](auto& t) { t.options[0].text = "0.1..0.2"; }},
      {RDM_ERROR_RANGE, "def.options[0].text option push: 1000000 is outside [0, 10]",
       [](auto& t) { t.options[0].choices = "a..b", t.options[0].text = "0..1e6"; }},
      {RDM_ERROR_RANGE, "def.options[1].text: cross of mood is not one of calm|wild",
       [](auto& t) { t.options[1].text = "cross"; }},
      {RDM_ERROR_RANGE, "def.options[0]: low -1e+300 or high 10 of push is outside [-2147483648, 2147483647]",
       [](auto& t) { t.options[0].kind = RDM_KIND_INTEGER, t.options[0].low = -1e300; }},
      {RDM_ERROR_RANGE,
       "def.options[0]: low 0 or high 2147483648 of push is outside [-2147483648, 2147483647]",
       [](auto& t) { t.options[0].kind = RDM_KIND_INTEGER, t.options[0].high = 2147483648.0; }},
      {RDM_ERROR_RANGE, "def.options[0].number: 1e+12 of push is outside [0, 10], or not an integer",
       [](auto& t) { t.options[0].kind = RDM_KIND_INTEGER, t.options[0].number = 1e12; }},
      {RDM_ERROR_RANGE, "def.options[0].kind: 9 of push is outside [0, 3]",
       [](auto& t) { t.options[0].kind = 9; }},
      {RDM_ERROR_ARGUMENT,
       "def.options[2].kind: frequency is an option of every task and of kind RDM_KIND_NUMBER",
       [](auto& t) { t.options[2].kind = RDM_KIND_TEXT; }},
      {RDM_ERROR_RANGE, "def.options[2].number: 5 of frequency is outside [10, 1000], or not an integer",
       [](auto& t) { t.options[2].number = 5; }},
      {RDM_ERROR_ARGUMENT, "def.options[0].key: max_steps is not an option; set def.max_steps",
       [](auto& t) { t.options[0].key = "max_steps"; }},
      {RDM_ERROR_RANGE, "def.cameras[0].fov_y: 0 of front is outside [0.01, 3]",
       [](auto& t) { t.cameras[0].fov_y = 0; }},
      {RDM_ERROR_RANGE, "def.cameras[0]: cx or cy of front is -10.5, outside [-10, 10]",
       [](auto& t) { t.cameras[0].cy = -10.5f; }},
      {RDM_ERROR_ARGUMENT, "def.cameras[0].up of front is not finite",
       [](auto& t) { t.cameras[0].up[1] = std::numeric_limits<float>::infinity(); }},
      {RDM_ERROR_ARGUMENT, "def.cameras[0].reserved: it must be 0",
       [](auto& t) { t.cameras[0].reserved = 1; }},
      {RDM_ERROR_ARGUMENT, "def.cameras[0]: eye and target of front are the same, or not finite",
       [](auto& t) { std::copy_n(t.cameras[0].eye, 3, t.cameras[0].target); }},
      {RDM_ERROR_ARGUMENT, "def.defaults[0].key is NULL", [](auto& t) { t.defaults[0].key = nullptr; }},
  };
  const int32_t count = rdm_task_count();
  for (const BadDef& row : rows) {
    BallTask t("bad_def");
    row.change(t);
    int32_t task = -5;
    expect_text(rdm_task_create(&task, &t.def), row.code, row.text);
    EXPECT_EQ(task, -5);
  }
  EXPECT_EQ(rdm_task_count(), count);
  BallTask t("bad_def");
  EXPECT_EQ(rdm_task_create(nullptr, &t.def), RDM_ERROR_ARGUMENT);
  int32_t task = -1;
  EXPECT_EQ(rdm_task_create(&task, nullptr), RDM_ERROR_ARGUMENT);
  t.def.struct_size = 8;
  EXPECT_EQ(rdm_task_create(&task, &t.def), RDM_ERROR_ARGUMENT);
}

// A task whose build or reset is what a row says; the others do nothing.
struct Scripted {
  std::function<rdm_result(rdm_scene*)> build;
  std::function<rdm_result(rdm_world*)> reset;
};

rdm_result simple_scene(rdm_scene* scene) {
  rdm_shape_def ball{};
  ball.kind = RDM_SHAPE_SPHERE, ball.size[0] = 0.05;
  rdm_body_def body{};
  body.struct_size = sizeof body, body.name = "ball", body.shapes = &ball, body.num_shapes = 1, body.mass = 1;
  if (const rdm_result r = rdm_scene_add_body(scene, &body, nullptr)) return r;
  rdm_scene_robot hand;
  rdm_scene_robot_init(&hand, sizeof hand);
  hand.name = "hand", hand.pose.p[2] = 1;
  if (const rdm_result r = rdm_robot_find("shadow_hand", &hand.robot)) return r;
  return rdm_scene_add_robot(scene, &hand, nullptr);
}

rdm_result try_task(Scripted* script) {
  static const rdm_field_def field = {"one", "1", 1, 0, 0, 0};
  static const rdm_cost_def cost = {"cost", "none", -1};
  rdm_task_def d;
  rdm_task_def_init(&d, sizeof d);
  d.name = "t", d.fields = &field, d.num_fields = 1, d.costs = &cost, d.num_costs = 1, d.action_dim = 1;
  d.user = script;
  d.build = [](void* user, rdm_scene* scene, void*) { return static_cast<Scripted*>(user)->build(scene); };
  d.reset = [](void* user, const void*, rdm_world* world, void*, rdm_random*) -> rdm_result {
    const auto& f = static_cast<Scripted*>(user)->reset;
    return f ? f(world) : static_cast<rdm_result>(RDM_OK);
  };
  d.control = [](void*, const void*, rdm_world*, void*, const float*) -> rdm_result { return RDM_OK; };
  d.judge = [](void*, const void*, rdm_world*, void*, int32_t, rdm_verdict*) -> rdm_result { return RDM_OK; };
  d.observe = [](void*, const void*, const rdm_world*, const void*, float* obs) -> rdm_result {
    obs[0] = 0;
    return RDM_OK;
  };
  const Registered made(d);
  rdm_pool_config c;
  rdm_pool_config_init(&c, sizeof c);
  c.task = "t";
  rdm_pool* p = nullptr;
  rdm_result r = rdm_pool_create(&p, &c);
  if (r == RDM_OK) r = rdm_pool_reset(p, nullptr, nullptr);
  rdm_pool_destroy(p);
  return r;
}

struct BadScene {
  rdm_result code;
  const char* text;  // after "task t: build: "
  std::function<rdm_result(rdm_scene*)> build;
};

// A body of one shape after simple_scene.
std::function<rdm_result(rdm_scene*)> with_body(std::function<void(rdm_body_def&, rdm_shape_def&)> change) {
  return [change](rdm_scene* scene) {
    if (const rdm_result r = simple_scene(scene)) return r;
    rdm_shape_def box{};
    box.kind = RDM_SHAPE_BOX, box.size[0] = box.size[1] = box.size[2] = 0.05;
    rdm_body_def cup{};
    cup.struct_size = sizeof cup, cup.name = "cup", cup.shapes = &box, cup.num_shapes = 1, cup.mass = 0.1;
    change(cup, box);
    return rdm_scene_add_body(scene, &cup, nullptr);
  };
}
std::function<rdm_result(rdm_scene*)> with_robot(std::function<void(rdm_scene_robot&)> change) {
  return [change](rdm_scene* scene) {
    if (const rdm_result r = simple_scene(scene)) return r;
    rdm_scene_robot hand;
    rdm_scene_robot_init(&hand, sizeof hand);
    hand.name = "other", hand.pose.p[0] = 1;
    rdm_robot_find("shadow_hand", &hand.robot);
    change(hand);
    return rdm_scene_add_robot(scene, &hand, nullptr);
  };
}
std::function<rdm_result(rdm_scene*)> after(std::function<rdm_result(rdm_scene*)> f) {
  return [f](rdm_scene* scene) {
    const rdm_result r = simple_scene(scene);
    return r != RDM_OK ? r : f(scene);
  };
}

std::function<rdm_result(rdm_scene*)> with_law(const char* material,
                                               std::function<void(rdm_contact_law&)> change) {
  return after([material, change](rdm_scene* scene) {
    rdm_contact_law law;
    rdm_contact_law_init(&law, sizeof law);
    change(law);
    return rdm_scene_set_contact_law(scene, material, "default", &law);
  });
}

TEST(OwnTaskErrors, OfScenes) {
  static const double flat[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
  const std::string no_robot = "robot: 99999 is outside [0, " + std::to_string(rdm_robot_count()) + ")";
  const auto add_static = [](const char* name) {
    return after([name](rdm_scene* s) {
      rdm_shape_def ground{};
      ground.name = name, ground.kind = RDM_SHAPE_PLANE;
      return rdm_scene_add_static(s, &ground);
    });
  };
  const BadScene rows[] = {
      {RDM_ERROR_ARGUMENT, "scene: it has nothing that can move",
       [](rdm_scene*) -> rdm_result { return RDM_OK; }},
      {RDM_ERROR_ARGUMENT, "scene: the name ball is already used",
       with_body([](auto& b, auto&) { b.name = "ball"; })},
      {RDM_ERROR_ARGUMENT, "shape ball occurs twice", with_body([](auto&, auto& s) { s.name = "ball"; })},
      {RDM_ERROR_ARGUMENT, "body.name is NULL", with_body([](auto& b, auto&) { b.name = nullptr; })},
      {RDM_ERROR_RANGE, "body cup: mass 0 is not above 0 and up to 1e6",
       with_body([](auto& b, auto&) { b.mass = 0; })},
      {RDM_ERROR_RANGE, "body cup: num_shapes: 0 is outside [1, 256]",
       with_body([](auto& b, auto&) { b.num_shapes = 0; })},
      {RDM_ERROR_ARGUMENT,
       "body cup: its shapes' centre of mass is at (0, 0, 0.1), not at the origin: move them, or give "
       "moments",
       with_body([](auto&, auto& s) { s.pose.p[2] = 0.1; })},
      {RDM_ERROR_RANGE, "shape cup: a size or its position is out of bounds",
       with_body([](auto&, auto& s) { s.size[1] = 0; })},
      {RDM_ERROR_RANGE, "cup: half size 0 is outside [1e-06, 1000]", with_body([](auto& b, auto& s) {
         s.size[1] = 0;
         b.moment[0] = b.moment[1] = b.moment[2] = 1;
       })},
      {RDM_ERROR_ARGUMENT, "cup: moment of inertia is not positive definite",
       with_body([](auto& b, auto&) { b.moment[0] = -1; })},
      {RDM_ERROR_ARGUMENT, "cup: the quaternion does not have length 1",
       with_body([](auto& b, auto&) { b.pose.q[0] = 2; })},
      {RDM_ERROR_ARGUMENT, "cup: position is not finite",
       with_body([](auto& b, auto&) { b.pose.p[0] = NAN; })},
      {RDM_ERROR_RANGE, "cup: linear_damping -1 is outside [0, 1000000]",
       with_body([](auto& b, auto&) { b.linear_damping = -1; })},
      {RDM_ERROR_NOT_FOUND, "material ruber: unknown",
       with_body([](auto&, auto& s) { s.material = "ruber"; })},
      {RDM_ERROR_ARGUMENT, "shape cup: kind 4 cannot be part of a body",
       with_body([](auto&, auto& s) { s.kind = RDM_SHAPE_PLANE; })},
      {RDM_ERROR_ARGUMENT, "shape cup: kind 12 cannot be part of a body",
       with_body([](auto&, auto& s) { s.kind = 12; })},
      {RDM_ERROR_RANGE, "shape cup: num_points: 0 is outside [4, 32]",
       with_body([](auto&, auto& s) { s.kind = RDM_SHAPE_HULL; })},
      {RDM_ERROR_ARGUMENT, "shape cup: points is NULL", with_body([](auto&, auto& s) {
         s.kind = RDM_SHAPE_HULL;
         s.num_points = 4;
       })},
      {RDM_ERROR_ARGUMENT, "cup: the points lie in one plane, or too close to each other",
       with_body([](auto&, auto& s) {
         s.kind = RDM_SHAPE_HULL;
         s.num_points = 4;
         s.points = flat;
       })},
      {RDM_ERROR_ARGUMENT,
       "robot.robot of other is not set: fill the struct by rdm_scene_robot_init, then set the number that "
       "rdm_robot_find gives",
       with_robot([](auto& r) { r.robot = -1; })},
      {RDM_ERROR_RANGE, no_robot.c_str(), with_robot([](auto& r) { r.robot = 99999; })},
      {RDM_ERROR_ARGUMENT, "robot.name is NULL", with_robot([](auto& r) { r.name = nullptr; })},
      {RDM_ERROR_ARGUMENT, "scene: the name hand is already used",
       with_robot([](auto& r) { r.name = "hand"; })},
      {RDM_ERROR_ARGUMENT, "robot.struct_size: 3 is less than 112",
       with_robot([](auto& r) { r.struct_size = 3; })},
      {RDM_ERROR_RANGE, "other: base_damping -1 is outside [0, 1000000]",
       with_robot([](auto& r) { r.base_damping = -1; })},
      {RDM_ERROR_ARGUMENT, "material clay occurs twice", after([](auto* s) {
         rdm_scene_add_material(s, "clay");
         return rdm_scene_add_material(s, "clay");
       })},
      {RDM_ERROR_NOT_FOUND, "material clay: unknown",
       after([](auto* s) { return rdm_scene_set_friction(s, "clay", "default", 1); })},
      {RDM_ERROR_RANGE, "mu: -2 is neither RDM_FRICTION_PASSES nor within [0, 1000]",
       after([](auto* s) { return rdm_scene_set_friction(s, "default", "default", -2); })},
      {RDM_ERROR_NOT_FOUND, "material clay: unknown", with_law("clay", [](auto&) {})},
      {RDM_ERROR_RANGE, "contact law: restitution: 2 is outside [0, 1]",
       with_law("default", [](auto& l) { l.restitution = 2; })},
      {RDM_ERROR_ARGUMENT, "law.struct_size: 3 is less than 72",
       with_law("default", [](auto& l) { l.struct_size = 3; })},
      {RDM_ERROR_ARGUMENT, "shape.name is NULL", add_static(nullptr)},
      {RDM_ERROR_ARGUMENT, "shape ball occurs twice", add_static("ball")},
      {RDM_ERROR_NOT_FOUND, "body bal: unknown; nearest is ball", after([](auto* s) {
         int32_t i;
         return rdm_scene_find(s, RDM_SCENE_BODY, "bal", &i);
       })},
      {RDM_ERROR_RANGE, "part: 7 is outside [0, 6]", after([](auto* s) {
         int32_t i;
         return rdm_scene_find(s, 7, "ball", &i);
       })},
      {RDM_ERROR_NOT_FOUND, "b cub*: unknown", after([](auto* s) {
         int32_t i;
         return rdm_scene_add_touch(s, "hand*", "cub*", &i);
       })},
      {RDM_ERROR_STATE,
       "scene: it is complete; nothing can be added or set after the first find, touch or joint",
       after([](auto* s) {
         int32_t i;
         rdm_scene_find(s, RDM_SCENE_BODY, "ball", &i);
         return rdm_scene_add_material(s, "late");
       })},
      {RDM_ERROR_NOT_FOUND, "field two: unknown",
       after([](auto* s) { return rdm_scene_set_field(s, "two", 2); })},
      {RDM_ERROR_RANGE, "count: 0 is outside [1, 1024]",
       after([](auto* s) { return rdm_scene_set_actions(s, 0, nullptr, nullptr); })},
      {RDM_ERROR_RANGE, "count: -1 is outside [1, 1024]",
       after([](auto* s) { return rdm_scene_set_actions(s, static_cast<size_t>(-1), nullptr, nullptr); })},
      {RDM_ERROR_ARGUMENT, "option engine is a text; call rdm_scene_get_text", after([](auto* s) {
         double x;
         return rdm_scene_get_number(s, "engine", &x);
       })},
      {RDM_ERROR_NOT_FOUND, "option gravty: unknown; nearest is gravity", after([](auto* s) {
         double x;
         return rdm_scene_get_number(s, "gravty", &x);
       })},
      {RDM_ERROR_NOT_FOUND, "option gravty: unknown; nearest is gravity", after([](auto* s) {
         double low, high;
         return rdm_scene_get_range(s, "gravty", &low, &high);
       })},
      {RDM_ERROR_ARGUMENT, "option engine is neither number nor integer", after([](auto* s) {
         double low, high;
         return rdm_scene_get_range(s, "engine", &low, &high);
       })},
      {RDM_ERROR_ARGUMENT, "option gravity is not a text; call rdm_scene_get_number", after([](auto* s) {
         const char* text;
         return rdm_scene_get_text(s, "gravity", &text);
       })},
      {RDM_ERROR_STATE, "call not allowed in this state",
       after([](auto*) -> rdm_result { return RDM_ERROR_STATE; })},
  };
  for (const BadScene& row : rows) {
    Scripted script{row.build, nullptr};
    expect_text(try_task(&script), row.code, std::string("task t: build: ") + row.text);
  }
}

struct BadCall {
  rdm_result code;
  const char* text;
  std::function<rdm_result(rdm_world*)> reset;
};

TEST(OwnTaskErrors, OfCallsInAWorld) {
  static rdm_motion out;
  static double x[64];
  static const double nan[3] = {NAN, 0, 0}, zero[3] = {0, 0, 0};
  const BadCall rows[] = {
      {RDM_ERROR_RANGE, "body: 1 is outside [0, 1)", [](auto* w) { return rdm_world_get_body(w, 1, &out); }},
      {RDM_ERROR_RANGE, "link: -1 is outside [0, 24)",
       [](auto* w) { return rdm_world_get_link(w, -1, &out); }},
      {RDM_ERROR_RANGE, "robot: 1 is outside [0, 1)", [](auto* w) { return rdm_world_get_base(w, 1, &out); }},
      {RDM_ERROR_RANGE, "shape: 500 is outside",
       [](auto* w) { return rdm_world_get_shape(w, 500, &out.pose); }},
      {RDM_ERROR_RANGE, "sensor: 5 is outside [0, 5)",
       [](auto* w) { return rdm_world_get_sensor(w, 5, x, x); }},
      {RDM_ERROR_RANGE, "group: 0 is outside [0, 0)",
       [](auto* w) { return rdm_world_get_touch(w, 0, nullptr, nullptr); }},
      {RDM_ERROR_ARGUMENT, "out is NULL", [](auto* w) { return rdm_world_get_body(w, 0, nullptr); }},
      {RDM_ERROR_ARGUMENT, "set_body: the quaternion of motion 0 does not have length 1",
       [](auto* w) {
         rdm_motion m{};
         m.pose.q[0] = NAN;
         return rdm_world_set_body(w, 0, &m);
       }},
      {RDM_ERROR_ARGUMENT, "set_body: motion 0 is not finite, or its magnitude is above 1e+06",
       [](auto* w) {
         rdm_motion m{};
         m.pose.q[3] = 1, m.v[1] = NAN;
         return rdm_world_set_body(w, 0, &m);
       }},
      {RDM_ERROR_STATE, "robot hand: its base is fixed and cannot be moved",
       [](auto* w) { return rdm_world_set_base(w, 0, &out); }},
      {RDM_ERROR_STATE, "robot hand: its base is fixed and cannot be moved",
       [](auto* w) { return rdm_world_push_base(w, 0, zero, zero); }},
      {RDM_ERROR_RANGE, "n: there are 3 q, but the robot has 24",
       [](auto* w) { return rdm_world_set_joints(w, 0, x, nullptr, 3); }},
      {RDM_ERROR_ARGUMENT, "set_joints: joint 2 is not finite, or faster than 1e+06",
       [](auto* w) {
         double q[24] = {};
         q[2] = NAN;
         return rdm_world_set_joints(w, 0, q, nullptr, 24);
       }},
      {RDM_ERROR_RANGE, "first, n: 10 joints from 20 on are more than the 24 that there are",
       [](auto* w) { return rdm_world_set_targets(w, 20, x, 10); }},
      {RDM_ERROR_ARGUMENT, "targets[0] is not finite or beyond 1e+06",
       [](auto* w) { return rdm_world_set_targets(w, 0, nan, 1); }},
      {RDM_ERROR_RANGE, "n: there are 24 commands, but the robot has 20",
       [](auto* w) { return rdm_world_set_commands(w, 0, x, 24); }},
      {RDM_ERROR_STATE,
       "world: its scene has no feed-forward; call rdm_scene_set_feedforward when it is built",
       [](auto* w) { return rdm_world_set_feedforward(w, 0, x, 1); }},
      {RDM_ERROR_RANGE, "n: there are 2 efforts, but the robot has 24",
       [](auto* w) { return rdm_world_get_gravity(w, 0, x, 2); }},
      {RDM_ERROR_STATE, "world: its scene is not adjustable; call rdm_scene_set_adjustable when it is built",
       [](auto* w) { return rdm_world_set_factors(w, nullptr, 0); }},
      {RDM_ERROR_ARGUMENT, "force is not finite",
       [](auto* w) { return rdm_world_push_body(w, 0, nan, zero); }},
      {RDM_ERROR_ARGUMENT, "point is not finite",
       [](auto* w) { return rdm_world_push_link(w, 0, zero, nan); }},
      {RDM_ERROR_RANGE, "capacity: ",
       [](auto* w) {
         size_t n;
         return rdm_world_get_contacts(w, nullptr, static_cast<size_t>(-1), &n);
       }},
      {RDM_ERROR_ARGUMENT, "io.struct_size: 0 is less than 48",
       [](auto* w) {
         rdm_joints j{};
         return rdm_world_get_joints(w, &j);
       }},
      {RDM_ERROR_FORMAT, "of my own", [](auto*) { return rdm_fail(RDM_ERROR_FORMAT, "of my own"); }},
      {RDM_ERROR_RANGE, "code: 0 is not the code of an error; the text was: fine",
       [](auto*) { return rdm_fail(RDM_OK, "fine"); }},
  };
  for (const BadCall& row : rows) {
    Scripted script{simple_scene, row.reset};
    EXPECT_EQ(try_task(&script), row.code);
    const std::string wanted = std::string("world 0: task t: reset: ") + row.text;
    EXPECT_EQ(std::string(rdm_last_error()).substr(0, wanted.size()), wanted);
    std::printf("%s\n", rdm_last_error());
  }
}

TEST(OwnTaskErrors, APoseWithoutARotationIsTaken) {
  Scripted script{simple_scene, [](rdm_world* w) {
                    rdm_motion m{};
                    if (const rdm_result r = rdm_world_set_body(w, 0, &m)) return r;
                    if (const rdm_result r = rdm_world_get_body(w, 0, &m)) return r;
                    return m.pose.q[3] == 1 ? RDM_OK : rdm_fail(RDM_ERROR_FORMAT, "it is turned");
                  }};
  EXPECT_EQ(try_task(&script), RDM_OK) << rdm_last_error();
}

// A handle that outlives its call is told so, as far as its memory is still there.
TEST(OwnTaskErrors, HandlesOutsideOfTheirCall) {
  rdm_motion out;
  int32_t i = 0;
  EXPECT_EQ(rdm_world_get_body(nullptr, 0, &out), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_scene_find(nullptr, 0, "x", &i), RDM_ERROR_ARGUMENT);
  static rdm_result late = RDM_OK;
  Scripted script;
  rdm_scene* kept = nullptr;
  script.build = [&](rdm_scene* s) {
    kept = s;
    return simple_scene(s);
  };
  script.reset = [&](rdm_world* w) {
    late = rdm_scene_find(kept, RDM_SCENE_BODY, "ball", &i);
    EXPECT_EQ(rdm_scene_find(reinterpret_cast<rdm_scene*>(w), RDM_SCENE_BODY, "ball", &i),
              RDM_ERROR_ARGUMENT);
    EXPECT_NE(std::strstr(rdm_last_error(), "a handle of another kind, world"), nullptr);
    return static_cast<rdm_result>(RDM_OK);
  };
  EXPECT_EQ(try_task(&script), RDM_OK) << rdm_last_error();
  EXPECT_EQ(late, RDM_ERROR_ARGUMENT);
}

TEST(OwnTaskErrors, RandomNumbers) {
  EXPECT_EQ(rdm_random_bits(nullptr), 0u);
  EXPECT_EQ(rdm_random_uniform(nullptr, 1, 2), 0);
  EXPECT_EQ(rdm_random_split(nullptr, nullptr), RDM_ERROR_ARGUMENT);
  rdm_random a{5, 0, 1, 1}, b = a, c;
  for (int i = 0; i < 100; ++i) {
    const double x = rdm_random_uniform(&a, -2, 3);
    EXPECT_GE(x, -2);
    EXPECT_LT(x, 3);
    EXPECT_EQ(x, rdm_random_uniform(&b, -2, 3));
  }
  EXPECT_EQ(a.counter, 100u);
  double sum = 0, square = 0;
  for (int i = 0; i < 10000; ++i) {
    const double x = rdm_random_normal(&a);
    sum += x, square += x * x;
  }
  EXPECT_NEAR(sum / 10000, 0, 0.05);
  EXPECT_NEAR(square / 10000, 1, 0.05);
  ASSERT_EQ(rdm_random_split(&b, &c), RDM_OK);
  EXPECT_NE(rdm_random_bits(&b), rdm_random_bits(&c));
  const double z[3] = {0, 0, 1}, none[3] = {0, 0, 0};
  double q[4];
  ASSERT_EQ(rdm_rotation(z, 1.5, q), RDM_OK);
  EXPECT_NEAR(q[2], std::sin(0.75), 1e-15);
  EXPECT_NEAR(q[3], std::cos(0.75), 1e-15);
  EXPECT_EQ(rdm_rotation(none, 1, q), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_rotation(z, NAN, q), RDM_ERROR_ARGUMENT);
}

}  // namespace
}  // namespace rdm::test
