// Recordings that keep what was seen: rows, files, and agents that are taught with eyes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <redman/record.hpp>
#include <redman/sense.hpp>
#include <string>
#include <vector>

namespace {

constexpr int32_t kEnvs = 3, kPoints = 64;

redman::Pool seeing(int32_t every = 1, uint64_t seed = 0) {
  const rdm_option options[] = {{"modality", "points", 0},
                                {"points", nullptr, kPoints},
                                {"sampling", "voxel", 0},
                                {"sense_every", nullptr, static_cast<double>(every)}};
  auto c = redman::pool_config("hand_over_safe_finger", kEnvs);
  c.seed = seed;
  c.options = options;
  c.num_options = 4;
  redman::Pool pool(c);
  pool.reset();
  return pool;
}

// The clouds of each row are those that the pool showed before its step, in millimetres.
TEST(RecordedClouds, AreWhatThePoolShowed) {
  redman::Pool pool = seeing();
  redman::Recording r(pool, 100);
  ASSERT_EQ(r.info().num_points, kPoints);
  std::vector<float> shown;
  std::vector<uint8_t> classes;
  for (int t = 0; t < 5; ++t) {
    const rdm_sensors s = redman::sensors(pool);
    shown.insert(shown.end(), s.points, s.points + kEnvs * kPoints * 3);
    classes.insert(classes.end(), s.point_class, s.point_class + kEnvs * kPoints);
    pool.baseline(RDM_BASELINE_RANDOM);
    r.begin_step(pool);
    pool.step();
    r.end_step(pool);
  }
  const rdm_recording_rows v = r.rows();
  ASSERT_EQ(v.rows, 5 * kEnvs);
  for (size_t i = 0; i < shown.size(); ++i) ASSERT_NEAR(v.points[i], 1000 * shown[i], 0.501) << "entry " << i;
  EXPECT_TRUE(std::equal(classes.begin(), classes.end(), v.point_class));
  EXPECT_GT(*std::max_element(classes.begin(), classes.end()), 1) << "hands and the object";

  const char* path = "recorded_clouds.npz";
  ASSERT_EQ(rdm_recording_write_file(r.get(), path), RDM_OK) << rdm_last_error();
  const redman::Recording again(path);
  EXPECT_EQ(again.info().fingerprint, r.info().fingerprint);
  const rdm_recording_rows w = again.rows();
  ASSERT_EQ(w.rows, v.rows);
  EXPECT_TRUE(std::equal(v.points, v.points + v.rows * kPoints * 3, w.points));
  EXPECT_TRUE(std::equal(v.point_class, v.point_class + v.rows * kPoints, w.point_class));
  std::remove(path);
}

redman::Pool showing(const char* task, const char* settings) {
  auto c = redman::pool_config(task, kEnvs);
  c.settings = settings;
  redman::Pool pool(c);
  pool.reset();
  return pool;
}

TEST(RecordedClouds, ColoursAreKept) {
  constexpr const char* kColored = "modality=points\npoints=64\nsampling=voxel\npoint_color=true";
  redman::Pool pool = showing("hand_over_safe_finger", kColored);
  redman::Recording r(pool, 10);
  const rdm_sensors s = redman::sensors(pool);
  std::vector<uint8_t> shown(s.point_color, s.point_color + kEnvs * kPoints * 3);
  for (int32_t i = 0; i < kEnvs * kPoints; ++i) {
    rdm_shape_info shape = RDM_INIT(rdm_shape_info);
    ASSERT_EQ(rdm_pool_shape_at(pool.get(), s.point_shape[i], &shape), RDM_OK);
    for (int k = 0; k < 3; ++k) ASSERT_EQ(s.point_color[3 * i + k], shape.color[k]) << "point " << i;
  }
  r.begin_step(pool);
  pool.step();
  r.end_step(pool);
  ASSERT_TRUE(r.rows().point_color);
  EXPECT_TRUE(std::equal(shown.begin(), shown.end(), r.rows().point_color));
  const char* path = "colored_clouds.npz";
  ASSERT_EQ(rdm_recording_write_file(r.get(), path), RDM_OK) << rdm_last_error();
  const redman::Recording again(path);
  EXPECT_EQ(again.info().fingerprint, r.info().fingerprint);
  EXPECT_TRUE(std::equal(shown.begin(), shown.end(), again.rows().point_color));
  std::remove(path);

  redman::Pool grey = seeing();
  EXPECT_FALSE(redman::sensors(grey).point_color);
  redman::Recording plain(grey, 10);
  EXPECT_FALSE(plain.rows().point_color);
  EXPECT_EQ(rdm_recording_begin_step(r.get(), grey.get(), nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_STREQ(rdm_recording_error(r.get()), "point_color: the recording has colours, but the pool has none");
  EXPECT_EQ(rdm_recording_append_all(plain.get(), r.get()), RDM_ERROR_ARGUMENT);
  EXPECT_STREQ(rdm_recording_error(plain.get()), "other: one of the two recordings has no colours");

  // whoever sees colours is not taught without them
  const auto agent = [&](const redman::Pool& of) {
    rdm_agent_config c = redman::agent_config(of);
    c.settings = "encoder=8,8\nencoder_points=64\nencoder_color=true\nhidden=16";
    return redman::Agent(c);
  };
  redman::Agent a = agent(pool);
  plain.begin_step(grey);
  grey.step();
  plain.end_step(grey);
  EXPECT_EQ(rdm_agent_set_recording(a.get(), plain.get()), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_agent_set_recording(a.get(), r.get()), RDM_OK) << rdm_agent_error(a.get());
  EXPECT_EQ(rdm_agent_rollout(a.get(), grey.get(), nullptr), RDM_ERROR_STATE);
}

// The last points lie on the object where it is to be brought, and are of a class of their own.
TEST(RecordedClouds, AGoalIsSeen) {
  for (const char* task : {"reorient", "hand_over_safe_finger", "grasp"}) {
    SCOPED_TRACE(task);
    redman::Pool pool = showing(task, "modality=points\npoints=64\nsampling=voxel\ngoal_points=24");
    redman::Pool plain = showing(task, "modality=points\npoints=40\nsampling=voxel");
    const rdm_sensors s = redman::sensors(pool), without = redman::sensors(plain);
    EXPECT_EQ(s.num_classes, without.num_classes + 1);
    size_t position = 0;
    rdm_field_info f = RDM_INIT(rdm_field_info);
    for (int32_t i = 0; rdm_pool_field_at(pool.get(), i, &f) == RDM_OK; ++i)
      if (std::string(f.name) == "goal.position") position = static_cast<size_t>(f.offset);
    ASSERT_GT(position, 0u);
    for (size_t i = 0; i < kEnvs; ++i) {
      const float* goal = &pool.obs()[i][position];
      for (size_t k = 0; k < 40; ++k) ASSERT_LT(s.point_class[i * 64 + k], without.num_classes);
      double furthest = 0;
      for (size_t k = 40; k < 64; ++k) {
        ASSERT_EQ(s.point_class[i * 64 + k], without.num_classes);
        double square = 0;
        for (size_t x = 0; x < 3; ++x) {
          const double d = s.points[3 * (i * 64 + k) + x] - goal[x];
          square += d * d;
        }
        furthest = std::max(furthest, std::sqrt(square));
      }
      EXPECT_GT(furthest, 0.01);
      EXPECT_LT(furthest, 0.09) << "an egg's or a cube's surface";
    }
  }
  auto c = redman::pool_config("jenga", 1);
  rdm_pool* p = nullptr;
  c.settings = "modality=points\ngoal_points=24";
  EXPECT_EQ(rdm_pool_create(&p, &c), RDM_ERROR_ARGUMENT);
  EXPECT_NE(std::string(rdm_last_error()).find("goal_points: task jenga has no object with a goal pose"),
            std::string::npos);
}

TEST(RecordedClouds, WhatDoesNotFitIsRefused) {
  redman::Pool pool = seeing();
  redman::Recording r(pool, 10);
  auto blind_config = redman::pool_config("hand_over_safe_finger", kEnvs);
  redman::Pool blind(blind_config);
  blind.reset();
  EXPECT_EQ(rdm_recording_begin_step(r.get(), blind.get(), nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_NE(std::string(rdm_recording_error(r.get())).find("num_points"), std::string::npos);
  EXPECT_EQ(r.info().rows, 0);
  auto rows = redman::sized<rdm_recording_rows>();
  std::vector<float> obs(static_cast<size_t>(r.info().obs_dim)),
      action(static_cast<size_t>(r.info().action_dim));
  rows.rows = 1;
  rows.obs = obs.data();
  rows.action = action.data();
  EXPECT_EQ(rdm_recording_append(r.get(), &rows), RDM_ERROR_ARGUMENT);
  EXPECT_NE(std::string(rdm_recording_error(r.get())).find("points"), std::string::npos);
  std::vector<int16_t> points(kPoints * 3, 5);
  rows.points = points.data();
  EXPECT_EQ(rdm_recording_append(r.get(), &rows), RDM_OK) << rdm_recording_error(r.get());
  EXPECT_EQ(r.rows().points[7], 5);
  EXPECT_EQ(r.rows().point_class[7], 0);
  redman::Recording plain(blind, 10);
  EXPECT_EQ(rdm_recording_append(plain.get(), &rows), RDM_ERROR_ARGUMENT) << "it has no clouds";
  EXPECT_EQ(rdm_recording_append_all(plain.get(), r.get()), RDM_ERROR_ARGUMENT);
}

// A teacher whose action is the object's height above where it began: nothing but the cloud tells it. What an
// agent with eyes clones is far nearer to it than what one without does.
TEST(RecordedClouds, EyesAreTaught) {
  redman::Pool pool = seeing(1, 1);
  redman::Recording r(pool, 1000);
  const size_t width = pool.action().width();
  std::vector<float> label(kEnvs * width);
  for (int t = 0; t < 150; ++t) {
    const rdm_sensors s = redman::sensors(pool);
    for (size_t i = 0; i < kEnvs; ++i) {
      float highest = -1;  // of the object's points; class 2 follows the two hands
      for (size_t k = i * kPoints; k < (i + 1) * kPoints; ++k)
        if (s.point_class[k] == 2) highest = std::max(highest, s.points[3 * k + 2]);
      for (size_t j = 0; j < width; ++j)
        label[i * width + j] = highest < 0 ? 0.0f : std::clamp(4 * (highest - 0.5f), -1.0f, 1.0f);
    }
    pool.baseline(RDM_BASELINE_RANDOM);
    r.begin_step(pool, label.data());
    pool.step();
    r.end_step(pool);
  }
  const auto loss = [&](const char* settings) {
    auto c = redman::agent_config(pool);
    c.settings = settings;
    redman::Agent agent(c);
    auto how = redman::clone_config();
    how.epochs = 40;
    how.patience = 0;
    how.batch_rows = 64;
    return redman::clone(agent, r, how).train_loss;
  };
  const double eyes =
      loss("actor_obs=right.joint_position\nencoder=16,32\nencoder_points=64\nhidden=32\nencoder_classes=4");
  const double blind = loss("actor_obs=right.joint_position\nhidden=32");
  EXPECT_LT(eyes, 0.5 * blind) << eyes << " " << blind;
  redman::Agent other([&] {
    auto c = redman::agent_config(pool);
    c.settings = "encoder=8,8\nencoder_points=32";
    return c;
  }());
  EXPECT_EQ(rdm_agent_clone(other.get(), r.get(), nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_NE(std::string(rdm_agent_error(other.get())).find("64 points"), std::string::npos);
}

// With sense_every=4 rows stand between the looks, and are those of every step where one is due.
TEST(RecordedClouds, LooksAreWhereTheyAreDue) {
  redman::Pool each = seeing(1), fourth = seeing(4);
  const size_t count = kEnvs * kPoints * 3;
  std::vector<float> last(redman::sensors(fourth).points, redman::sensors(fourth).points + count);
  for (int t = 1; t <= 12; ++t) {
    for (redman::Pool* p : {&each, &fourth}) {
      p->baseline(RDM_BASELINE_HOLD);
      p->step();
    }
    const float *a = redman::sensors(each).points, *b = redman::sensors(fourth).points;
    for (size_t i = 0; i < kEnvs; ++i) {
      ASSERT_FALSE(each.terminated()[i]);
      const auto from = static_cast<ptrdiff_t>(i * kPoints * 3), to = from + kPoints * 3;
      EXPECT_TRUE(t % 4 == 0 ? std::equal(a + from, a + to, b + from)
                             : std::equal(last.begin() + from, last.begin() + to, b + from))
          << t;
    }
    last.assign(b, b + count);
  }
}

}  // namespace
