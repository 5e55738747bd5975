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
    rdm_field_info field = RDM_INIT(rdm_field_info), of_task = field;
    EXPECT_EQ(rdm_pool_field_at(p, i, &field), RDM_OK);
    EXPECT_EQ(rdm_task_field_at(spec.task, i, &of_task), RDM_OK);
    EXPECT_EQ(std::isnan(field.low), std::isnan(field.high)) << field.name;
    if (!std::isnan(field.low)) {
      EXPECT_LE(field.low, field.high) << field.name;
      EXPECT_EQ(field.low, of_task.low) << field.name;
      EXPECT_EQ(field.high, of_task.high) << field.name;
    }
    b.low.insert(b.low.end(), static_cast<size_t>(field.count), field.low);
    b.high.insert(b.high.end(), static_cast<size_t>(field.count), field.high);
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
    rdm_field_info past = RDM_INIT(rdm_field_info);
    past.low = 7;
    EXPECT_EQ(rdm_pool_field_at(p, spec.num_fields, &past), RDM_ERROR_RANGE);
    EXPECT_EQ(rdm_pool_field_at(p, 0, nullptr), RDM_ERROR_ARGUMENT);
    EXPECT_EQ(rdm_task_field_at(spec.task, -1, &past), RDM_ERROR_RANGE);
    past.struct_size = sizeof past - 1;
    EXPECT_EQ(rdm_pool_field_at(p, 0, &past), RDM_ERROR_ARGUMENT);
    EXPECT_EQ(past.low, 7);
    rdm_pool_destroy(p);
  }
}

// By their names: those that tasks with hands cut, and those that are tighter by what they are.
TEST(FieldBounds, OfSomeFields) {
  const auto bounds = [](const char* task, const char* wanted) {
    int32_t index = 0;
    EXPECT_EQ(rdm_task_find(task, &index), RDM_OK);
    rdm_field_info field = RDM_INIT(rdm_field_info);
    int32_t i = 0;
    while (rdm_task_field_at(index, i, &field) == RDM_OK && std::string(field.name) != wanted) ++i;
    EXPECT_STREQ(field.name, wanted);
    return std::pair(field.low, field.high);
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
