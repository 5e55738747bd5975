// Looking into a pool: shapes, poses, contacts, pictures, and the experimental push.
#define RDM_EXPERIMENTAL
#include <gtest/gtest.h>
#include <redman/redman.h>

#include <cmath>
#include <cstring>
#include <set>
#include <string>
#include <vector>

namespace {

class Look : public testing::Test {
 protected:
  void SetUp() override {
    pool = make();
    spec.struct_size = sizeof spec;
    ASSERT_EQ(rdm_pool_get_spec(pool, &spec), RDM_OK);
  }
  void TearDown() override { rdm_pool_destroy(pool); }
  static rdm_pool* make(const rdm_option* options = nullptr, int32_t count = 0) {
    rdm_pool_config config;
    rdm_pool_config_init(&config, sizeof config);
    config.options = options;
    config.num_options = count;
    config.task = "hand_over_safe_finger";
    config.num_envs = 2;
    rdm_pool* made = nullptr;
    EXPECT_EQ(rdm_pool_create(&made, &config), RDM_OK) << rdm_last_error();
    EXPECT_EQ(rdm_pool_reset(made, nullptr, nullptr), RDM_OK);
    return made;
  }
  std::vector<rdm_pose> poses(rdm_pool* p, int32_t env) const {
    std::vector<rdm_pose> out(static_cast<size_t>(spec.num_shapes), {{NAN, NAN, NAN}, {NAN, NAN, NAN, NAN}});
    EXPECT_EQ(rdm_pool_get_poses(p, env, out.data()), RDM_OK);
    return out;
  }
  int32_t object() const { return object(pool); }
  int32_t object(const rdm_pool* p) const {
    rdm_shape_info s = RDM_INIT(rdm_shape_info);
    for (int32_t i = 0; i < spec.num_shapes; ++i)
      if (rdm_pool_shape_at(p, i, &s) == RDM_OK && std::string(s.name).find("object") != std::string::npos)
        return i;
    ADD_FAILURE() << "no shape is called object";
    return 0;
  }
  rdm_pool* pool = nullptr;
  rdm_spec spec;
};

TEST_F(Look, AHullShowsItsCorners) {
  const rdm_option asked[] = {{"object", "hull", 0},
                              {"hull", "0,0,0;0.06,0,0;0,0.06,0;0,0,0.06;0.01,0.01,0.01", 0}};
  rdm_pool* p = make(asked, 2);
  const int32_t i = object(p);
  rdm_shape_info s = RDM_INIT(rdm_shape_info);
  ASSERT_EQ(rdm_pool_shape_at(p, i, &s), RDM_OK);
  EXPECT_EQ(s.kind, RDM_SHAPE_HULL);
  EXPECT_NEAR(s.size[0], 0.045, 1e-6);  // the centre of mass is at a quarter
  float corners[12] = {}, sum[3] = {};
  size_t count = 0;
  ASSERT_EQ(rdm_pool_get_hull(p, i, corners, 4, &count), RDM_OK);
  EXPECT_EQ(count, 4u);
  for (int k = 0; k < 12; ++k) sum[k % 3] += corners[k];
  for (const float x : sum) EXPECT_NEAR(x, 0, 1e-6);
  EXPECT_EQ(rdm_pool_get_hull(p, i, nullptr, 0, &count), RDM_OK);
  EXPECT_EQ(rdm_pool_get_hull(p, i, nullptr, 1, &count), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_get_hull(p, i, corners, static_cast<size_t>(-1), &count), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_get_hull(p, i, corners, 4, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_get_hull(p, spec.num_shapes, corners, 4, &count), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_get_hull(pool, object(), corners, 4, &count), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_get_hull(nullptr, 0, corners, 4, &count), RDM_ERROR_ARGUMENT);
  rdm_pool_destroy(p);
}

TEST_F(Look, ShapesAndPoses) {
  ASSERT_GT(spec.num_shapes, 30);
  rdm_shape_info s = RDM_INIT(rdm_shape_info);
  int fixed = 0;
  for (int32_t i = 0; i < spec.num_shapes; ++i) {
    ASSERT_EQ(rdm_pool_shape_at(pool, i, &s), RDM_OK);
    EXPECT_GT(std::strlen(s.name), 0u);
    fixed += s.fixed;
  }
  EXPECT_LT(fixed, spec.num_shapes);
  EXPECT_EQ(rdm_pool_shape_at(pool, spec.num_shapes, &s), RDM_ERROR_RANGE);
  for (const rdm_pose& pose : poses(pool, 1)) {
    EXPECT_NEAR(std::hypot(std::hypot(pose.q[0], pose.q[1]), std::hypot(pose.q[2], pose.q[3])), 1, 1e-12);
    EXPECT_LT(std::abs(pose.p[0]) + std::abs(pose.p[1]) + std::abs(pose.p[2]), 100);
  }
  rdm_pose none;
  EXPECT_EQ(rdm_pool_get_poses(pool, 2, &none), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_get_poses(pool, -1, &none), RDM_ERROR_RANGE);
}

TEST_F(Look, ContactsAreCountedBeyondTheCapacity) {
  size_t most = 0;
  for (int step = 0; step < 60; ++step) {
    ASSERT_EQ(rdm_pool_step(pool), RDM_OK);
    size_t count = 7777;
    ASSERT_EQ(rdm_pool_get_contacts(pool, 0, nullptr, 0, &count), RDM_OK);
    std::vector<rdm_contact> contacts(count + 1);
    std::memset(contacts.data(), 0x7f, contacts.size() * sizeof contacts[0]);
    ASSERT_EQ(rdm_pool_get_contacts(pool, 0, contacts.data(), count + 1, &count), RDM_OK);
    for (size_t i = 0; i < count; ++i) {
      const rdm_contact& c = contacts[i];
      EXPECT_NEAR(std::hypot(c.normal[0], c.normal[1], c.normal[2]), 1, 1e-4);
      EXPECT_TRUE(c.shape_a >= 0 && c.shape_a < spec.num_shapes && c.shape_b >= 0 &&
                  c.shape_b < spec.num_shapes);
      EXPECT_GE(c.depth, -1e-3f);
    }
    EXPECT_EQ(contacts[count].shape_a, 0x7f7f7f7f);
    most = std::max(most, count);
  }
  EXPECT_GT(most, 0u);  // the object lies in the hand
  size_t count = 0;
  EXPECT_EQ(rdm_pool_get_contacts(pool, 0, nullptr, 5, &count), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_get_contacts(pool, 0, nullptr, static_cast<size_t>(-1), &count), RDM_ERROR_RANGE);
}

TEST_F(Look, PicturesAgreeWithEachOther) {
  constexpr int32_t kWidth = 80, kHeight = 60;
  constexpr size_t kPixels = 80 * 60;
  std::vector<uint8_t> rgb(3 * kPixels), again(3 * kPixels);
  std::vector<float> depth(kPixels);
  std::vector<int32_t> seg(kPixels), alone(kPixels, -7);
  ASSERT_EQ(rdm_pool_render(pool, 0, "front", kWidth, kHeight, rgb.data(), depth.data(), seg.data()), RDM_OK)
      << rdm_pool_error(pool);
  ASSERT_EQ(rdm_pool_render(pool, 0, "FRONT", kWidth, kHeight, again.data(), nullptr, nullptr), RDM_OK);
  ASSERT_EQ(rdm_pool_render(pool, 0, "front", kWidth, kHeight, nullptr, nullptr, alone.data()), RDM_OK);
  EXPECT_EQ(rgb, again);
  EXPECT_EQ(seg, alone);
  EXPECT_GT(std::set<uint8_t>(rgb.begin(), rgb.end()).size(), 20u);
  std::set<int32_t> seen(seg.begin(), seg.end());
  EXPECT_GT(seen.size(), 10u);
  EXPECT_TRUE(seen.count(object()));
  EXPECT_GE(*seen.begin(), -1);
  EXPECT_LT(*seen.rbegin(), spec.num_shapes);
  for (size_t i = 0; i < kPixels; ++i)
    EXPECT_TRUE(seg[i] >= 0 ? depth[i] > 0 && depth[i] < 100 : depth[i] == 0) << depth[i];
}

TEST_F(Look, LookingChangesNothing) {
  uint64_t before = 0, after = 0;
  ASSERT_EQ(rdm_pool_get_hash(pool, -1, &before), RDM_OK);
  std::vector<uint8_t> rgb(3 * 32 * 24);
  size_t count = 0;
  rdm_pool_render(pool, 0, "front", 32, 24, rgb.data(), nullptr, nullptr);
  rdm_pool_get_contacts(pool, 0, nullptr, 0, &count);
  poses(pool, 0);
  ASSERT_EQ(rdm_pool_get_hash(pool, -1, &after), RDM_OK);
  EXPECT_EQ(before, after);
}

TEST_F(Look, BadPictures) {
  uint8_t rgb[12];
  EXPECT_EQ(rdm_pool_render(pool, 0, "frnt", 2, 2, rgb, nullptr, nullptr), RDM_ERROR_NOT_FOUND);
  EXPECT_NE(std::string(rdm_pool_error(pool)).find("front"), std::string::npos) << rdm_pool_error(pool);
  EXPECT_EQ(rdm_pool_render(pool, 0, nullptr, 2, 2, rgb, nullptr, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_render(pool, 2, "front", 2, 2, rgb, nullptr, nullptr), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_render(pool, 0, "front", 0, 2, rgb, nullptr, nullptr), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_render(pool, 0, "front", 2, -2, rgb, nullptr, nullptr), RDM_ERROR_RANGE);
}

TEST_F(Look, PushMovesTheObjectInItsDirectionForOneStep) {
  rdm_pool* twin = make();
  const int32_t shape = object();
  const float force[3] = {0, 0, 5};
  ASSERT_EQ(rdm_pool_push(pool, 0, shape, force), RDM_OK) << rdm_last_error();
  for (int step = 0; step < 3; ++step) {
    ASSERT_EQ(rdm_pool_step(pool), RDM_OK);
    ASSERT_EQ(rdm_pool_step(twin), RDM_OK);
  }
  const auto at = static_cast<size_t>(shape);
  EXPECT_GT(poses(pool, 0)[at].p[2], poses(twin, 0)[at].p[2] + 0.005);
  const std::vector<rdm_pose> other = poses(pool, 1), same = poses(twin, 1);
  EXPECT_EQ(std::memcmp(other.data(), same.data(), other.size() * sizeof other[0]), 0);
  rdm_pool_destroy(twin);
  const float bad[3] = {0, NAN, 0};
  EXPECT_EQ(rdm_pool_push(pool, 0, shape, bad), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_push(pool, 0, -1, force), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_push(pool, 0, shape, nullptr), RDM_ERROR_ARGUMENT);
}

}  // namespace
