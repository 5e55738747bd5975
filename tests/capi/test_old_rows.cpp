// The functions of 0.1 that fill frozen structs say what those that have taken their place say.
#include <gtest/gtest.h>
#include <redman/redman.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "contract.hpp"

#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"

namespace {

int32_t index_of(const char* task) {
  int32_t index = -1;
  EXPECT_EQ(rdm_task_find(task, &index), RDM_OK);
  return index;
}

void expect_same(const rdm_option_info& old, const rdm_option_spec& now) {
  EXPECT_STREQ(old.key, now.key);
  EXPECT_STREQ(old.help, now.help);
  EXPECT_STREQ(old.text, now.text);
  EXPECT_STREQ(old.choices, now.choices);
  EXPECT_EQ(old.number, now.number);
  EXPECT_EQ(old.low, now.low);
  EXPECT_EQ(old.high, now.high);
  EXPECT_EQ(old.kind, now.kind);
  EXPECT_EQ(old.live, now.live);
}

TEST(OldRows, OfTasksAndAlgorithms) {
  const int32_t task = index_of("hand_over_safe_finger");
  rdm_field_info field = RDM_INIT(rdm_field_info);
  rdm_field old_field;
  float low = 0, high = 0;
  int32_t i = 0;
  for (; rdm_task_field_at(task, i, &field) == RDM_OK; ++i) {
    ASSERT_EQ(rdm_task_field(task, i, &old_field), RDM_OK);
    EXPECT_STREQ(old_field.name, field.name);
    EXPECT_STREQ(old_field.unit, field.unit);
    EXPECT_EQ(old_field.offset, field.offset);
    EXPECT_EQ(old_field.count, field.count);
    ASSERT_EQ(rdm_task_field_bounds(task, i, &low, &high), RDM_OK);
    EXPECT_TRUE(low == field.low || std::isnan(low));
    EXPECT_TRUE(high == field.high || std::isnan(high));
  }
  EXPECT_GT(i, 3);
  EXPECT_EQ(rdm_task_field(task, i, &old_field), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_task_field(task, 0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_task_field_bounds(task, 0, nullptr, &high), RDM_ERROR_ARGUMENT);

  rdm_cost_info cost = RDM_INIT(rdm_cost_info);
  rdm_cost old_cost;
  ASSERT_EQ(rdm_task_cost_at(task, 0, &cost), RDM_OK);
  ASSERT_EQ(rdm_task_cost(task, 0, &old_cost), RDM_OK);
  EXPECT_STREQ(old_cost.name, cost.name);
  EXPECT_STREQ(old_cost.help, cost.help);
  EXPECT_EQ(old_cost.limit, cost.limit);
  EXPECT_EQ(rdm_task_cost(task, 0, nullptr), RDM_ERROR_ARGUMENT);

  rdm_camera_info camera = RDM_INIT(rdm_camera_info);
  rdm_camera old_camera;
  ASSERT_EQ(rdm_task_camera_at(task, 1, &camera), RDM_OK);
  ASSERT_EQ(rdm_task_camera(task, 1, &old_camera), RDM_OK);
  EXPECT_STREQ(old_camera.name, camera.name);
  EXPECT_EQ(std::memcmp(old_camera.eye, camera.eye, sizeof camera.eye), 0);
  EXPECT_EQ(std::memcmp(old_camera.target, camera.target, sizeof camera.target), 0);
  EXPECT_EQ(old_camera.fov_y, camera.fov_y);
  EXPECT_EQ(old_camera.mount, camera.mount);
  EXPECT_EQ(rdm_task_camera(task, -1, &old_camera), RDM_ERROR_RANGE);

  rdm_option_spec option = RDM_INIT(rdm_option_spec);
  rdm_option_info old_option;
  for (i = 0; rdm_task_option_at(task, i, &option) == RDM_OK; ++i) {
    ASSERT_EQ(rdm_task_option(task, i, &old_option), RDM_OK);
    expect_same(old_option, option);
  }
  EXPECT_EQ(rdm_task_option(task, i, &old_option), RDM_ERROR_RANGE);
  for (i = 0; rdm_algo_option_at(0, i, &option) == RDM_OK; ++i) {
    ASSERT_EQ(rdm_algo_option(0, i, &old_option), RDM_OK);
    expect_same(old_option, option);
  }
  EXPECT_GT(i, 3);
  EXPECT_EQ(rdm_algo_option(0, 0, nullptr), RDM_ERROR_ARGUMENT);
}

TEST(OldRows, OfAPool) {
  rdm_pool* p = make_pool(pool_config());
  ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  for (int i = 0; i < 30; ++i) ASSERT_EQ(rdm_pool_step(p), RDM_OK);
  rdm_field_info field = RDM_INIT(rdm_field_info);
  rdm_field old_field;
  float low = 0, high = 0;
  ASSERT_EQ(rdm_pool_field_at(p, 1, &field), RDM_OK);
  ASSERT_EQ(rdm_pool_field(p, 1, &old_field), RDM_OK);
  EXPECT_STREQ(old_field.name, field.name);
  EXPECT_EQ(old_field.offset, field.offset);
  ASSERT_EQ(rdm_pool_field_bounds(p, 1, &low, &high), RDM_OK);
  EXPECT_EQ(low, field.low);
  EXPECT_EQ(high, field.high);

  const auto count = static_cast<size_t>(spec_of(p).num_shapes);
  std::vector<rdm_pose> poses(count);
  std::vector<float> old_poses(7 * count + 1, 77);
  ASSERT_EQ(rdm_pool_get_poses(p, 1, poses.data()), RDM_OK);
  ASSERT_EQ(rdm_pool_poses(p, 1, old_poses.data()), RDM_OK);
  for (size_t i = 0; i < count; ++i) {
    rdm_shape_info shape = RDM_INIT(rdm_shape_info);
    rdm_shape old_shape;
    ASSERT_EQ(rdm_pool_shape_at(p, static_cast<int32_t>(i), &shape), RDM_OK);
    ASSERT_EQ(rdm_pool_shape(p, static_cast<int32_t>(i), &old_shape), RDM_OK);
    EXPECT_STREQ(old_shape.name, shape.name);
    EXPECT_EQ(old_shape.kind, shape.kind);
    EXPECT_EQ(old_shape.fixed, shape.fixed);
    EXPECT_EQ(std::memcmp(old_shape.color, shape.color, 4), 0);
    for (size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(old_shape.size[k], static_cast<float>(shape.size[k]));
      EXPECT_EQ(old_poses[7 * i + k], static_cast<float>(poses[i].p[k]));
    }
    for (size_t k = 0; k < 4; ++k) EXPECT_EQ(old_poses[7 * i + 3 + k], static_cast<float>(poses[i].q[k]));
  }
  EXPECT_EQ(old_poses.back(), 77) << "as many as there are";
  EXPECT_EQ(rdm_pool_shape(p, 0, nullptr), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_pool_poses(p, 2, old_poses.data()), RDM_ERROR_RANGE);

  size_t contacts = 0, size = 0, old_size = 0;
  int32_t old_contacts = -1;
  ASSERT_EQ(rdm_pool_get_contacts(p, 0, nullptr, 0, &contacts), RDM_OK);
  ASSERT_EQ(rdm_pool_contacts(p, 0, nullptr, 0, &old_contacts), RDM_OK);
  EXPECT_EQ(static_cast<size_t>(old_contacts), contacts);
  rdm_contact one[1];
  EXPECT_EQ(rdm_pool_contacts(p, 0, one, -1, &old_contacts), RDM_ERROR_RANGE) << "not a large number";
  EXPECT_EQ(rdm_pool_contacts(p, 0, one, 1, nullptr), RDM_ERROR_ARGUMENT);
  ASSERT_EQ(rdm_pool_write_state(p, 0, nullptr, 0, &size), RDM_OK);
  ASSERT_EQ(rdm_pool_state_size(p, 0, &old_size), RDM_OK);
  EXPECT_EQ(old_size, size);
  EXPECT_GT(size, 1000u);
  rdm_pool_destroy(p);
}

TEST(OldRows, OfJoints) {
  int32_t robot = -1, i = 0;
  ASSERT_EQ(rdm_robot_find("shadow_hand", &robot), RDM_OK);
  rdm_joint_info joint = RDM_INIT(rdm_joint_info);
  rdm_joint old;
  for (; rdm_robot_joint_at(robot, i, &joint) == RDM_OK; ++i) {
    ASSERT_EQ(rdm_robot_joint(robot, i, &old), RDM_OK);
    EXPECT_STREQ(old.name, joint.name);
    EXPECT_EQ(old.lower, joint.lower);
    EXPECT_EQ(old.upper, joint.upper);
    EXPECT_EQ(old.kp, joint.kp);
    EXPECT_EQ(old.kd, joint.kd);
    EXPECT_EQ(old.effort, joint.effort);
    EXPECT_EQ(old.action, joint.action);
    EXPECT_EQ(old.reserved, 0);
  }
  EXPECT_EQ(i, 24);
  EXPECT_EQ(rdm_robot_joint(robot, i, &old), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_robot_joint(robot, 0, nullptr), RDM_ERROR_ARGUMENT);
}

TEST(OldRows, OfObjects) {
  rdm_object_info object = RDM_INIT(rdm_object_info);
  rdm_object old;
  int32_t i = 0;
  for (; rdm_object_info_at(i, &object) == RDM_OK; ++i) {
    ASSERT_EQ(rdm_object_at(i, &old), RDM_OK);
    EXPECT_STREQ(old.name, object.name);
    EXPECT_STREQ(old.shape, object.shape);
    EXPECT_EQ(old.mass, object.mass);
  }
  EXPECT_GT(i, 60);
  EXPECT_EQ(rdm_object_at(i, &old), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_object_at(0, nullptr), RDM_ERROR_ARGUMENT);
}

}  // namespace
#pragma GCC diagnostic pop
