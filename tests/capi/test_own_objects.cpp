// Objects through the ABI: the catalogue, objects of a host's own in tasks and in scenes, and what is
// refused.
#define RDM_EXPERIMENTAL
#include <gtest/gtest.h>
#include <redman/redman.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

namespace {

rdm_object_def default_def() {
  rdm_object_def d;
  EXPECT_EQ(rdm_object_def_init(&d, sizeof d), RDM_OK);
  return d;
}

// All that describes an object, as rdm_object_create takes it.
struct Described {
  rdm_object_def def = default_def();
  std::vector<rdm_shape_def> shapes;
  explicit Described(const char* name) {
    int32_t object = -1;
    EXPECT_EQ(rdm_object_find(name, &object), RDM_OK) << rdm_last_error();
    EXPECT_EQ(rdm_object_get_def(object, &def), RDM_OK);
    shapes.resize(static_cast<size_t>(def.num_shapes));
    for (int32_t i = 0; i < def.num_shapes; ++i)
      EXPECT_EQ(rdm_object_shape_at(object, i, shapes.data() + i), RDM_OK);
    def.shapes = shapes.data();
  }
};

struct Objects {  // removes what it made
  std::vector<int32_t> made;
  ~Objects() {
    for (const int32_t object : made) rdm_object_destroy(object);
  }
  int32_t create(const rdm_object_def& def) {
    int32_t object = -1;
    EXPECT_EQ(rdm_object_create(&object, &def), RDM_OK) << rdm_last_error();
    if (object >= 0) made.push_back(object);
    return object;
  }
};

// 40 steps of random actions; the hash of all worlds.
uint64_t hash_after(const char* task, const char* settings, int32_t threads = 1) {
  rdm_pool_config c;
  rdm_pool_config_init(&c, sizeof c);
  c.task = task, c.settings = settings, c.num_envs = 4, c.num_threads = threads, c.seed = 3;
  rdm_pool* p = nullptr;
  EXPECT_EQ(rdm_pool_create(&p, &c), RDM_OK) << rdm_last_error();
  if (!p) return 0;
  EXPECT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  for (int k = 0; k < 40; ++k) {
    rdm_pool_baseline(p, RDM_BASELINE_RANDOM);
    EXPECT_EQ(rdm_pool_step(p), RDM_OK);
  }
  rdm_pool_stats stats{};
  stats.struct_size = sizeof stats;
  EXPECT_EQ(rdm_pool_get_stats(p, &stats), RDM_OK);
  EXPECT_EQ(stats.diverged, 0) << settings;
  uint64_t hash = 0;
  EXPECT_EQ(rdm_pool_get_hash(p, -1, &hash), RDM_OK);
  rdm_pool_destroy(p);
  return hash;
}

TEST(Objects, EveryOneCanBeMadeAgain) {
  Objects own;
  const int32_t count = rdm_object_count();
  for (int32_t i = 0; i < count; ++i) {
    rdm_object_info object = RDM_INIT(rdm_object_info);
    ASSERT_EQ(rdm_object_info_at(i, &object), RDM_OK);
    Described d(object.name);
    EXPECT_EQ(d.def.mass, object.mass);
    d.def.name = "made_again", d.def.alias = nullptr;
    const int32_t made = own.create(d.def);
    const Described again("made_again");
    EXPECT_EQ(again.def.mass, d.def.mass);
    EXPECT_EQ(again.def.friction, d.def.friction);
    EXPECT_STREQ(again.def.material, d.def.material);
    for (int k = 0; k < 6; ++k) EXPECT_EQ(again.def.moment[k], d.def.moment[k]) << object.name;
    for (size_t k = 0; k < d.shapes.size(); ++k) {
      EXPECT_EQ(again.shapes[k].kind, d.shapes[k].kind);
      EXPECT_EQ(std::memcmp(again.shapes[k].pose.p, d.shapes[k].pose.p, sizeof d.shapes[k].pose.p), 0)
          << object.name;
      EXPECT_EQ(again.shapes[k].num_points, d.shapes[k].num_points);
    }
    EXPECT_EQ(rdm_object_destroy(made), RDM_OK);
    own.made.clear();
  }
  EXPECT_EQ(rdm_object_count(), count);
}

TEST(Objects, SayWhatTheyAre) {
  Objects own;
  int32_t index = -1;
  rdm_object_info info = RDM_INIT(rdm_object_info);
  ASSERT_EQ(rdm_object_find("mug_with_handle", &index), RDM_OK);
  ASSERT_EQ(rdm_object_info_at(index, &info), RDM_OK);
  EXPECT_STREQ(info.name, "mug_with_handle");
  EXPECT_STREQ(info.alias, "025_mug");
  EXPECT_EQ(info.kind, -1);
  EXPECT_EQ(info.num_shapes, 12);
  EXPECT_EQ(info.own, 0);
  EXPECT_EQ(info.friction, 0.3);
  EXPECT_NEAR(info.high[2] - info.low[2], 0.082, 1e-9);

  // Half a metre beside the frame's origin: what is told is from the centre of mass.
  rdm_shape_def box{};
  box.kind = RDM_SHAPE_BOX, box.size[0] = 0.02, box.size[1] = 0.03, box.size[2] = 0.06, box.pose.p[0] = 0.5;
  rdm_object_def d;
  ASSERT_EQ(rdm_object_def_init(&d, sizeof d), RDM_OK);
  d.name = "said", d.shapes = &box, d.num_shapes = 1, d.mass = 0.2, d.friction = 0.7;
  ASSERT_EQ(rdm_object_info_at(own.create(d), &info), RDM_OK);
  EXPECT_STREQ(info.name, "said");
  EXPECT_EQ(info.alias, nullptr);
  EXPECT_STREQ(info.summary, "");
  EXPECT_STREQ(info.shape, "box 0.04 x 0.06 x 0.12");
  EXPECT_EQ(info.kind, RDM_SHAPE_BOX);
  EXPECT_EQ(info.num_shapes, 1);
  EXPECT_EQ(info.own, 1);
  EXPECT_EQ(info.mass, 0.2);
  EXPECT_EQ(info.friction, 0.7);
  for (size_t k = 0; k < 3; ++k) {
    EXPECT_NEAR(info.low[k], -box.size[k], 1e-12);
    EXPECT_NEAR(info.high[k], box.size[k], 1e-12);
  }

  info.struct_size = 4;
  EXPECT_EQ(rdm_object_info_at(index, &info), RDM_ERROR_ARGUMENT);
}

TEST(Objects, OnesOwnIsTakenByTheTasks) {
  Objects own;
  Described d("mug_with_handle");
  d.def.name = "my_mug", d.def.alias = nullptr;
  own.create(d.def);
  for (const char* task : {"grasp", "hand_over_safe_finger", "reorient", "catch_underarm_safe_joint"}) {
    // the same to the bit, for any threads
    const uint64_t theirs = hash_after(task, "object=mug_with_handle");
    EXPECT_EQ(hash_after(task, "object=my_mug"), theirs) << task;
    EXPECT_EQ(hash_after(task, "object=025_mug", 3), theirs) << task;
    EXPECT_NE(hash_after(task, "object=mug_with_handle\nobject_scale=1.2"), theirs) << task;
    EXPECT_NE(hash_after(task, "object=mug_with_handle\nown_friction=true"), theirs) << task;
  }
  EXPECT_EQ(rdm_object_destroy(own.made[0]), RDM_OK);
  own.made.clear();
  rdm_pool_config c;
  rdm_pool_config_init(&c, sizeof c);
  c.task = "grasp", c.settings = "object=my_mugg";
  rdm_pool* p = nullptr;
  EXPECT_EQ(rdm_pool_create(&p, &c), RDM_ERROR_NOT_FOUND);
}

TEST(Objects, PoolsKeepWhatWasRemoved) {
  Objects own;
  Described d("banana");
  d.def.name = "short_lived", d.def.alias = nullptr;
  own.create(d.def);
  rdm_pool_config c;
  rdm_pool_config_init(&c, sizeof c);
  c.task = "grasp", c.settings = "object=short_lived";
  rdm_pool* p = nullptr;
  ASSERT_EQ(rdm_pool_create(&p, &c), RDM_OK) << rdm_last_error();
  EXPECT_EQ(rdm_object_destroy(own.made[0]), RDM_OK);
  own.made.clear();
  EXPECT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  EXPECT_EQ(rdm_pool_step(p), RDM_OK);
  int shapes = 0;
  rdm_shape_info s = RDM_INIT(rdm_shape_info);
  for (int32_t i = 0; rdm_pool_shape_at(p, i, &s) == RDM_OK; ++i)
    shapes += std::strncmp(s.name, "object", 6) == 0;
  EXPECT_EQ(shapes, 6);
  rdm_pool_destroy(p);
}

TEST(Objects, RefusalsNameTheRow) {
  const rdm_shape_def box = [] {
    rdm_shape_def s{};
    s.kind = RDM_SHAPE_BOX;
    s.size[0] = s.size[1] = s.size[2] = 0.02;
    return s;
  }();
  const auto refused = [&](rdm_result code, const char* text, auto&& spoil) {
    rdm_object_def d = default_def();
    rdm_shape_def shapes[2] = {box, box};
    d.name = "spoilt", d.mass = 0.1, d.shapes = shapes, d.num_shapes = 2;
    spoil(d, shapes);
    int32_t object = -7;
    EXPECT_EQ(rdm_object_create(&object, &d), code) << text;
    EXPECT_NE(std::string(rdm_last_error()).find(text), std::string::npos) << rdm_last_error();
    EXPECT_EQ(object, -7);
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  refused(RDM_ERROR_ARGUMENT, "struct_size", [](auto& d, auto*) { d.struct_size = 8; });
  refused(RDM_ERROR_RANGE, "num_shapes: 65 is outside [1, 64]", [](auto& d, auto*) { d.num_shapes = 65; });
  refused(RDM_ERROR_RANGE, "num_shapes: 0", [](auto& d, auto*) { d.num_shapes = 0; });
  refused(RDM_ERROR_ARGUMENT, "shapes is NULL", [](auto& d, auto*) { d.shapes = nullptr; });
  refused(RDM_ERROR_ARGUMENT, "the name is empty", [](auto& d, auto*) { d.name = nullptr; });
  refused(RDM_ERROR_ARGUMENT, "the name is already used", [](auto& d, auto*) { d.name = "011_banana"; });
  refused(RDM_ERROR_RANGE, "mass 0 is outside", [](auto& d, auto*) { d.mass = 0; });
  refused(RDM_ERROR_ARGUMENT, "friction is not finite", [&](auto& d, auto*) { d.friction = nan; });
  refused(RDM_ERROR_RANGE, "shapes[1]: size", [](auto&, auto* s) { s[1].size[2] = -1; });
  refused(RDM_ERROR_ARGUMENT, "shapes[1]: kind 4", [](auto&, auto* s) { s[1].kind = RDM_SHAPE_PLANE; });
  refused(RDM_ERROR_ARGUMENT, "shapes[0]: kind -3", [](auto&, auto* s) { s[0].kind = -3; });
  refused(RDM_ERROR_RANGE, "shapes[1].num_points: 3",
          [](auto&, auto* s) { s[1].kind = RDM_SHAPE_HULL, s[1].num_points = 3; });
  refused(RDM_ERROR_ARGUMENT, "shapes[1].points is NULL",
          [](auto&, auto* s) { s[1].kind = RDM_SHAPE_HULL, s[1].num_points = 8; });
  refused(RDM_ERROR_ARGUMENT, "place is not finite", [&](auto&, auto* s) { s[0].pose.p[1] = nan; });
  refused(RDM_ERROR_ARGUMENT, "triangle inequality",
          [](auto& d, auto*) { d.moment[0] = d.moment[1] = 1e-4, d.moment[2] = 3e-4; });
  int32_t object = -1;
  const rdm_object_def d = default_def();
  EXPECT_EQ(rdm_object_create(nullptr, &d), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_object_create(&object, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_object_find(nullptr, &object), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_object_find("egg", nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_object_find("banan", &object), RDM_ERROR_NOT_FOUND);
  EXPECT_NE(std::strstr(rdm_last_error(), "banana"), nullptr);
  EXPECT_EQ(rdm_object_get_def(0, nullptr), RDM_ERROR_ARGUMENT);
  rdm_shape_def s;
  EXPECT_EQ(rdm_object_shape_at(0, 1, &s), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_object_shape_at(0, 0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_object_shape_at(INT32_MAX, 0, &s), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_object_destroy(0), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_object_destroy(-1), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_object_def_init(nullptr, sizeof d), RDM_ERROR_ARGUMENT);
}

// ---- in a scene of one's own
struct Seen {
  rdm_result first = RDM_OK, second = RDM_OK, bad[6] = {};
  int32_t mug = -1, ball = -1, touch = -1;
  std::string texts[6];
  double mug_height = 0;
  double rest = 0;
};

rdm_result build(void* user, rdm_scene* scene, void*) {
  auto& seen = *static_cast<Seen*>(user);
  rdm_shape_def ground{};
  ground.name = "ground", ground.kind = RDM_SHAPE_PLANE;
  rdm_result r = rdm_scene_add_static(scene, &ground);
  int32_t mug = -1, ball = -1;
  rdm_object_find("025_mug", &mug);
  rdm_object_find("golf_ball", &ball);
  const rdm_pose above = {{0, 0, 0.1}, {}}, aside = {{0.3, 0, 0.1}, {}};
  if (r == RDM_OK) r = rdm_scene_add_object(scene, mug, "mug", &above, 1, &seen.mug);
  if (r == RDM_OK) r = rdm_scene_add_object(scene, ball, "ball", &aside, 2, &seen.ball);
  const auto note = [&](int i, rdm_result code) {
    seen.bad[i] = code;
    seen.texts[i] = rdm_last_error();
  };
  note(0, rdm_scene_add_object(scene, mug, "mug", &above, 1, nullptr));
  note(1, rdm_scene_add_object(scene, 100000, "other", &above, 1, nullptr));
  note(2, rdm_scene_add_object(scene, mug, "other", &above, 0, nullptr));
  note(3, rdm_scene_add_object(scene, mug, nullptr, &above, 1, nullptr));
  note(4, rdm_scene_add_object(scene, mug, "other", nullptr, 1, nullptr));
  // materials came along: "metal" of the mug, "plastic" of the ball
  int32_t metal = -1, plastic = -1;
  if (r == RDM_OK) r = rdm_scene_find(scene, RDM_SCENE_MATERIAL, "metal", &metal);
  if (r == RDM_OK) r = rdm_scene_find(scene, RDM_SCENE_MATERIAL, "plastic", &plastic);
  if (r == RDM_OK && (metal != 1 || plastic != 2)) r = rdm_fail(RDM_ERROR_INTERNAL, "materials");
  if (r == RDM_OK) r = rdm_scene_add_touch(scene, "mug", "ground", &seen.touch);
  note(5, rdm_scene_add_object(scene, mug, "late", &above, 1, nullptr));
  return r;
}
rdm_result reset(void*, const void*, rdm_world*, void*, rdm_random*) {
  return RDM_OK;
}
rdm_result control(void*, const void*, rdm_world*, void*, const float*) {
  return RDM_OK;
}
rdm_result judge(void* user, const void*, rdm_world* world, void*, int32_t, rdm_verdict* v) {
  auto& seen = *static_cast<Seen*>(user);
  double force = 0;
  rdm_motion m;
  rdm_result r = rdm_world_get_touch(world, seen.touch, nullptr, &force);
  if (r == RDM_OK) r = rdm_world_get_body(world, seen.mug, &m);
  seen.mug_height = m.pose.p[2];
  v->reward = seen.rest = force;
  return r;
}
rdm_result observe(void*, const void*, const rdm_world*, const void*, float* obs) {
  obs[0] = 0;
  return RDM_OK;
}

TEST(Objects, StandInAScene) {
  Seen seen;
  const rdm_field_def field = {"nothing", "1", 1, 0, 0, 0};
  const rdm_cost_def cost = {"cost", "none", -1};
  rdm_task_def d;
  ASSERT_EQ(rdm_task_def_init(&d, sizeof d), RDM_OK);
  d.name = "objects_stand", d.fields = &field, d.num_fields = 1, d.costs = &cost, d.num_costs = 1;
  d.action_dim = 1, d.user = &seen;
  d.build = build, d.reset = reset, d.control = control, d.judge = judge, d.observe = observe;
  int32_t task = -1;
  ASSERT_EQ(rdm_task_create(&task, &d), RDM_OK) << rdm_last_error();
  rdm_pool_config c;
  rdm_pool_config_init(&c, sizeof c);
  c.task = d.name;
  rdm_pool* p = nullptr;
  ASSERT_EQ(rdm_pool_create(&p, &c), RDM_OK) << rdm_last_error();
  EXPECT_EQ(seen.mug, 0);
  EXPECT_EQ(seen.ball, 1);
  const rdm_result codes[6] = {RDM_ERROR_ARGUMENT, RDM_ERROR_RANGE,    RDM_ERROR_RANGE,
                               RDM_ERROR_ARGUMENT, RDM_ERROR_ARGUMENT, RDM_ERROR_STATE};
  const char* texts[6] = {"mug is already used", "object: 100000", "scale: 0", "name", "p", "complete"};
  for (int i = 0; i < 6; ++i) {
    EXPECT_EQ(seen.bad[i], codes[i]) << i;
    EXPECT_NE(seen.texts[i].find(texts[i]), std::string::npos) << seen.texts[i];
  }
  std::vector<std::string> names;
  rdm_shape_info s = RDM_INIT(rdm_shape_info);
  for (int32_t i = 0; rdm_pool_shape_at(p, i, &s) == RDM_OK; ++i) {
    names.emplace_back(s.name);
    if (names.back() == "ball") {
      EXPECT_DOUBLE_EQ(s.size[0], 0.0427);  // twice as large
    }
  }
  EXPECT_EQ(names.size(), 14u);  // 12 of the mug, the ball, the ground
  EXPECT_EQ(names[0], "mug");
  EXPECT_EQ(names[11], "mug_11");
  ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  for (int k = 0; k < 60; ++k) ASSERT_EQ(rdm_pool_step(p), RDM_OK) << rdm_last_error();
  EXPECT_NEAR(seen.rest, 0.118 * 9.81, 0.05);  // its weight
  EXPECT_LT(seen.mug_height, 0.06);
  rdm_pool_destroy(p);
  EXPECT_EQ(rdm_task_destroy(task), RDM_OK);
}

// An object is looked at without being added, under a name that is taken too.
TEST(OwnObjects, CheckAddsNothing) {
  rdm_shape_def box{};
  box.kind = RDM_SHAPE_BOX;
  std::fill_n(box.size, 3, 0.02);
  rdm_object_def d;
  rdm_object_def_init(&d, sizeof d);
  d.name = "egg", d.shapes = &box, d.num_shapes = 1, d.mass = 0.1;
  const int32_t count = rdm_object_count();
  EXPECT_EQ(rdm_object_check(&d), RDM_OK) << rdm_last_error();
  d.mass = -1;
  EXPECT_EQ(rdm_object_check(&d), RDM_ERROR_RANGE);
  EXPECT_NE(std::string(rdm_last_error()).find("mass -1"), std::string::npos) << rdm_last_error();
  EXPECT_EQ(rdm_object_check(nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_object_count(), count);
}

}  // namespace
