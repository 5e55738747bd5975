// Bounds of observation entries: what random episodes of every task never leave, and what a new policy starts
// from.
#include <cmath>

#include "contract.hpp"

namespace {

struct Bounds {
  std::vector<float> low, high;  // [obs_dim]
};

Bounds bounds_of(const rdm_pool* p, const rdm_spec& spec) {
  Bounds b;
  for (int32_t i = 0; i < spec.num_fields; ++i) {
    rdm_field field;
    float low = 0, high = 0, task_low = 0, task_high = 0;
    EXPECT_EQ(rdm_pool_field(p, i, &field), RDM_OK);
    EXPECT_EQ(rdm_pool_field_bounds(p, i, &low, &high), RDM_OK);
    EXPECT_EQ(rdm_task_field_bounds(spec.task, i, &task_low, &task_high), RDM_OK);
    EXPECT_EQ(std::isnan(low), std::isnan(high)) << field.name;
    if (!std::isnan(low)) {
      EXPECT_LE(low, high) << field.name;
      EXPECT_EQ(low, task_low) << field.name;
      EXPECT_EQ(high, task_high) << field.name;
    }
    b.low.insert(b.low.end(), static_cast<size_t>(field.count), low);
    b.high.insert(b.high.end(), static_cast<size_t>(field.count), high);
  }
  return b;
}

TEST(FieldBounds, RandomEpisodesStayWithin) {
  for (const std::string& task : task_names()) {
    SCOPED_TRACE(task);
    rdm_pool_config c = pool_config(4);
    c.task = task.c_str();
    rdm_pool* p = make_pool(c);
    ASSERT_NE(p, nullptr);
    const rdm_spec spec = spec_of(p);
    const Bounds bounds = bounds_of(p, spec);
    ASSERT_EQ(bounds.low.size(), static_cast<size_t>(spec.obs_dim));
    const rdm_buffers b = buffers_of(p);
    ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
    for (int t = 0; t <= 120; ++t) {
      for (const float* rows : {b.obs, b.final_obs})
        for (int32_t i = 0; i < 4 * spec.obs_dim; ++i) {
          const auto k = static_cast<size_t>(i % spec.obs_dim);
          ASSERT_FALSE(rows[i] < bounds.low[k] || rows[i] > bounds.high[k])
              << "entry " << k << " is " << rows[i] << " in step " << t;
        }
      ASSERT_EQ(rdm_pool_baseline(p, RDM_BASELINE_RANDOM), RDM_OK);
      ASSERT_EQ(rdm_pool_step(p), RDM_OK);
    }
    float low = 7;
    EXPECT_EQ(rdm_pool_field_bounds(p, spec.num_fields, &low, &low), RDM_ERROR_RANGE);
    EXPECT_EQ(rdm_pool_field_bounds(p, 0, &low, nullptr), RDM_ERROR_ARGUMENT);
    EXPECT_EQ(rdm_task_field_bounds(spec.task, -1, &low, &low), RDM_ERROR_RANGE);
    EXPECT_EQ(low, 7);
    rdm_pool_destroy(p);
  }
}

// By their names: those that tasks with hands cut, and those that are tighter by what they are.
TEST(FieldBounds, OfSomeFields) {
  const auto bounds = [](const char* task, const char* wanted) {
    int32_t index = 0;
    EXPECT_EQ(rdm_task_find(task, &index), RDM_OK);
    rdm_field field;
    float low = 0, high = 0;
    for (int32_t i = 0; rdm_task_field(index, i, &field) == RDM_OK; ++i)
      if (std::string(field.name) == wanted) {
        EXPECT_EQ(rdm_task_field_bounds(index, i, &low, &high), RDM_OK);
      }
    return std::pair(low, high);
  };
  EXPECT_EQ(bounds("hand_over_safe_finger", "right.joint_velocity"), std::pair(-5.0f, 5.0f));
  EXPECT_EQ(bounds("hand_over_safe_finger", "right.action"), std::pair(-1.0f, 1.0f));
  EXPECT_EQ(bounds("point_goal1", "hazards_lidar"), std::pair(0.0f, 1.0f));
  EXPECT_EQ(bounds("car_run", "heading"), std::pair(-1.0f, 1.0f));
  EXPECT_TRUE(std::isnan(bounds("point_goal1", "velocimeter").first));
}

TEST(InitialMean, IsWhatAgentsAreLent) {
  for (const std::string& task : task_names()) {
    SCOPED_TRACE(task);
    rdm_pool_config c = pool_config(1);
    c.task = task.c_str();
    rdm_pool* p = make_pool(c);
    rdm_agent_config a;
    ASSERT_EQ(rdm_agent_config_init(&a, sizeof a), RDM_OK);
    ASSERT_EQ(rdm_agent_config_for_pool(&a, p), RDM_OK);
    std::vector<float> mean(static_cast<size_t>(a.action_dim), 9.0f);
    ASSERT_EQ(rdm_pool_get_initial_mean(p, mean.data()), RDM_OK);
    EXPECT_EQ(mean, std::vector<float>(a.initial_mean, a.initial_mean + a.action_dim));
    rdm_pool_destroy(p);
  }
}

}  // namespace
