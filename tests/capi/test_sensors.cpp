// rdm_pool_get_sensors and rdm_sample_furthest through the C ABI, on the hands.
#include <cmath>
#include <memory>
#include <set>

#include "contract.hpp"

namespace {

struct Seeing {
  explicit Seeing(std::vector<rdm_option> options, int32_t envs = 2, int32_t threads = 0) {
    rdm_pool_config c;
    EXPECT_EQ(rdm_pool_config_init(&c, sizeof c), RDM_OK);
    c.task = "hand_over_safe_finger";
    c.num_envs = envs;
    c.num_threads = threads;
    c.options = options.data();
    c.num_options = static_cast<int32_t>(options.size());
    EXPECT_EQ(rdm_pool_config_memory(&c, &ours, nullptr), RDM_OK) << rdm_last_error();
    EXPECT_EQ(rdm_pool_create(&p, &c), RDM_OK) << rdm_last_error();
    EXPECT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK) << rdm_pool_error(p);
    s.struct_size = sizeof s;
    EXPECT_EQ(rdm_pool_get_sensors(p, &s), RDM_OK) << rdm_last_error();
  }
  ~Seeing() { rdm_pool_destroy(p); }
  rdm_pool* p = nullptr;
  rdm_sensors s{};
  size_t ours = 0;
};

TEST(Sensors, TwoThousandPointsOfBothHandsAndTheObject) {
  const Seeing seeing({{"modality", "points", 0}});
  const rdm_sensors& s = seeing.s;
  ASSERT_EQ(s.num_points, 2048);
  EXPECT_EQ(s.rgb, nullptr);
  EXPECT_EQ(s.voxels, nullptr);
  for (int env = 0; env < 2; ++env) {
    EXPECT_EQ(s.point_count[env], 2048);
    std::set<std::string> bodies;
    float low = 9;
    for (int i = 0; i < 2048; ++i) {
      const float* at = s.points + 3 * (2048 * env + i);
      low = std::min(low, at[2]);
      rdm_shape_info shape = RDM_INIT(rdm_shape_info);
      ASSERT_EQ(rdm_pool_shape_at(seeing.p, s.point_shape[2048 * env + i], &shape), RDM_OK);
      EXPECT_NE(std::string(shape.name), "ground");
      bodies.insert(std::string(shape.name).substr(0, 5));
    }
    EXPECT_GT(low, 0.01f) << "the floor is left out";
    EXPECT_TRUE(bodies.count("right")) << *bodies.begin();
    EXPECT_TRUE(bodies.count("left_")) << *bodies.begin();
    EXPECT_GE(bodies.size(), 3u) << "and the object";
  }
}

// What a state that is read, or joints that are set, show at once: as the pool that they come from.
TEST(Sensors, AStateThatWasReadIsSeen) {
  const Seeing from({{"modality", "points+depth", 0}, {"points", nullptr, 64}});
  Seeing to({{"modality", "points+depth", 0}, {"points", nullptr, 64}}, 2, 1);
  for (int i = 0; i < 5; ++i) {
    ASSERT_EQ(rdm_pool_baseline(from.p, RDM_BASELINE_RANDOM), RDM_OK);
    ASSERT_EQ(rdm_pool_step(from.p), RDM_OK);
  }
  const auto same = [&](int env) {
    const size_t n = 3 * 64, at = n * static_cast<size_t>(env);
    return std::equal(from.s.points + at, from.s.points + at + n, to.s.points + at);
  };
  std::vector<unsigned char> bytes(1 << 20);
  size_t size = 0;
  ASSERT_EQ(rdm_pool_write_state(from.p, 1, bytes.data(), bytes.size(), &size), RDM_OK);
  EXPECT_FALSE(same(1));
  ASSERT_EQ(rdm_pool_read_state(to.p, 1, bytes.data(), size), RDM_OK) << rdm_pool_error(to.p);
  EXPECT_TRUE(same(1));
  EXPECT_FALSE(same(0));
  ASSERT_EQ(rdm_pool_write_state(from.p, -1, bytes.data(), bytes.size(), &size), RDM_OK);
  ASSERT_EQ(rdm_pool_read_state(to.p, -1, bytes.data(), size), RDM_OK) << rdm_pool_error(to.p);
  EXPECT_TRUE(same(0) && same(1));
  const size_t pixels = static_cast<size_t>(to.s.width) * static_cast<size_t>(to.s.height);
  EXPECT_TRUE(std::equal(from.s.depth, from.s.depth + 2 * pixels, to.s.depth));

  const std::vector<float> before(to.s.points, to.s.points + 3 * 64);
  rdm_spec spec{};
  spec.struct_size = sizeof spec;
  ASSERT_EQ(rdm_pool_get_spec(to.p, &spec), RDM_OK);
  std::vector<double> q(256);
  size_t joints = 0;
  for (rdm_joint_info j = RDM_INIT(rdm_joint_info);
       rdm_pool_joint_at(to.p, static_cast<int32_t>(joints), &j) == RDM_OK; ++joints)
    q[joints] = (j.lower + j.upper) / 2;
  ASSERT_EQ(rdm_pool_set_joints(to.p, 0, q.data(), nullptr, joints), RDM_OK) << rdm_pool_error(to.p);
  EXPECT_FALSE(std::equal(before.begin(), before.end(), to.s.points));
  EXPECT_TRUE(same(1));
}

TEST(Sensors, PicturesAreThoseOfRender) {
  const Seeing seeing({{"modality", "rgb+depth+segmentation", 0},
                       {"cameras", "top+front", 0},
                       {"image_width", nullptr, 32},
                       {"image_height", nullptr, 24}});
  const rdm_sensors& s = seeing.s;
  ASSERT_EQ(s.num_cameras, 2);
  ASSERT_EQ(s.width * s.height, 32 * 24);
  std::vector<float> depth(32 * 24);
  std::vector<int32_t> shape(32 * 24);
  for (int env = 0; env < 2; ++env)
    for (int k = 0; k < 2; ++k) {
      rdm_camera_info camera = RDM_INIT(rdm_camera_info);
      ASSERT_EQ(rdm_pool_sensor_camera_at(seeing.p, 0, k, &camera), RDM_OK);
      EXPECT_STREQ(camera.name, k ? "front" : "top");
      ASSERT_EQ(rdm_pool_render(seeing.p, env, camera.name, 32, 24, nullptr, depth.data(), shape.data()),
                RDM_OK);
      const size_t at = static_cast<size_t>(2 * env + k) * 32 * 24;
      EXPECT_TRUE(std::equal(depth.begin(), depth.end(), s.depth + at));
      EXPECT_TRUE(std::equal(shape.begin(), shape.end(), s.segmentation + at));
    }
}

TEST(Sensors, StepsWriteThemAndThreadsAgree) {
  const std::vector<rdm_option> options = {{"modality", "points+voxels", 0}, {"points", nullptr, 256}};
  const Seeing one(options, 4), two(options, 4, 2);
  const std::vector<float> first(one.s.points, one.s.points + 3 * 256 * 4);
  for (const Seeing* w : {&one, &two})
    for (int t = 0; t < 3; ++t) {
      ASSERT_EQ(rdm_pool_baseline(w->p, RDM_BASELINE_RANDOM), RDM_OK);
      ASSERT_EQ(rdm_pool_step(w->p), RDM_OK);
    }
  EXPECT_FALSE(std::equal(first.begin(), first.end(), one.s.points));
  EXPECT_TRUE(std::equal(one.s.points, one.s.points + 3 * 256 * 4, two.s.points));
  EXPECT_TRUE(std::equal(one.s.voxels, one.s.voxels + 4 * 16 * 16 * 16, two.s.voxels));
}

TEST(Sensors, MemoryIsWhatWasSaid) {
  CountingHost host;
  const rdm_option options[] = {{"modality", "rgb+points+voxels", 0}};
  rdm_pool_config c;
  ASSERT_EQ(rdm_pool_config_init(&c, sizeof c), RDM_OK);
  c.task = "hand_over_safe_finger";
  c.num_envs = 3;
  c.options = options;
  c.num_options = 1;
  c.host = &host.hooks;
  size_t ours = 0;
  ASSERT_EQ(rdm_pool_config_memory(&c, &ours, nullptr), RDM_OK) << rdm_last_error();
  rdm_pool* p = nullptr;
  ASSERT_EQ(rdm_pool_create(&p, &c), RDM_OK) << rdm_last_error();
  EXPECT_EQ(host.live, ours);
  rdm_pool_destroy(p);
  EXPECT_EQ(host.live, 0u);
}

TEST(Sensors, EveryTaskHasTheOptions) {
  for (int32_t t = 0; t < rdm_task_count(); ++t) {
    rdm_task task{};
    task.struct_size = sizeof task;
    ASSERT_EQ(rdm_task_at(t, &task), RDM_OK);
    std::set<std::string> keys;
    rdm_option_spec o = RDM_INIT(rdm_option_spec);
    for (int32_t i = 0; i < task.num_options; ++i) {
      ASSERT_EQ(rdm_task_option_at(t, i, &o), RDM_OK);
      EXPECT_TRUE(keys.insert(o.key).second) << task.name << " has " << o.key << " twice";
    }
    EXPECT_EQ(rdm_task_option_at(t, task.num_options, &o), RDM_ERROR_RANGE);
    EXPECT_TRUE(keys.count("modality") && keys.count("cloud_cameras")) << task.name;
    // every modality works in it
    const rdm_option all[] = {{"modality", "rgb+depth+segmentation+points+voxels", 0},
                              {"cameras", "above", 0}};
    rdm_pool_config c;
    ASSERT_EQ(rdm_pool_config_init(&c, sizeof c), RDM_OK);
    c.task = task.name;
    c.options = all;
    c.num_options = 2;
    rdm_pool* p = nullptr;
    ASSERT_EQ(rdm_pool_create(&p, &c), RDM_OK) << task.name << ": " << rdm_last_error();
    EXPECT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK) << task.name << ": " << rdm_pool_error(p);
    EXPECT_EQ(rdm_pool_baseline(p, RDM_BASELINE_RANDOM), RDM_OK);
    EXPECT_EQ(rdm_pool_step(p), RDM_OK) << task.name << ": " << rdm_pool_error(p);
    rdm_pool_destroy(p);
  }
}

TEST(Sensors, BadWordsAreRefused) {
  const auto create = [](rdm_option option) {
    rdm_pool_config c;
    rdm_pool_config_init(&c, sizeof c);
    c.task = "hand_over_safe_finger";
    c.options = &option;
    c.num_options = 1;
    rdm_pool* p = nullptr;
    const rdm_result r = rdm_pool_create(&p, &c);
    EXPECT_EQ(p, nullptr);
    return r;
  };
  EXPECT_EQ(create({"modality", "smell", 0}), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(create({"points", nullptr, -3}), RDM_ERROR_RANGE);
  EXPECT_EQ(create({"sampling", "best", 0}), RDM_ERROR_RANGE);
  const Seeing seeing({});
  rdm_sensors s{};
  rdm_camera_info camera = RDM_INIT(rdm_camera_info);
  EXPECT_EQ(rdm_pool_get_sensors(nullptr, &s), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_get_sensors(seeing.p, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_get_sensors(seeing.p, &s), RDM_ERROR_ARGUMENT);  // no struct_size
  EXPECT_EQ(seeing.s.points, nullptr);
  EXPECT_EQ(rdm_pool_sensor_camera_at(seeing.p, 0, 0, &camera), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_sensor_camera_at(seeing.p, 2, 0, &camera), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_sensor_camera_at(seeing.p, 0, 0, nullptr), RDM_ERROR_ARGUMENT);
}

TEST(Sensors, HostsSampleTheirOwnClouds) {
  const float points[] = {0, 0, 0, 1, 0, 0, 0.4f, 0, 0, 0.9f, 0, 0};
  int32_t chosen[4];
  const size_t bytes = rdm_sample_scratch(4);
  ASSERT_GT(bytes, 0u);
  std::vector<unsigned char> memory(bytes + 64);
  unsigned char* scratch = memory.data();
  for (size_t shift = 0; shift < 64; ++shift)  // at any address
    ASSERT_EQ(rdm_sample_furthest(points, 4, 4, 0, chosen, scratch + shift, bytes), RDM_OK)
        << rdm_last_error();
  EXPECT_EQ(chosen[0], 0);
  EXPECT_EQ(chosen[1], 1);
  EXPECT_EQ(chosen[2], 2);
  EXPECT_EQ(chosen[3], 3);
  const float nan[] = {0, NAN, 0};
  EXPECT_EQ(rdm_sample_furthest(nan, 1, 1, 0, chosen, scratch, bytes), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_sample_furthest(nullptr, 1, 1, 0, chosen, scratch, bytes), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_sample_furthest(points, 4, 5, 0, chosen, scratch, bytes), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_sample_furthest(points, 4, 1, 4, chosen, scratch, bytes), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_sample_furthest(points, 4, 1, 0, chosen, scratch, bytes - 1), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_sample_furthest(points, 0, 1, 0, chosen, scratch, bytes), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_sample_scratch(0), 0u);
  EXPECT_EQ(rdm_sample_scratch(1 << 30), 0u);
}

}  // namespace
