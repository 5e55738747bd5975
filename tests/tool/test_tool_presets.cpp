// What the presets of actor_obs leave of many tasks at once is what they leave of each alone.
#include <gtest/gtest.h>

#include "common/names.hpp"
#include "common/presets.hpp"

namespace {

using namespace tool;

void expect_same(const std::vector<ObsPreset>& a, const std::vector<ObsPreset>& b, const char* where) {
  ASSERT_EQ(a.size(), b.size()) << where;
  for (size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name) << where;
    EXPECT_EQ(a[i].columns, b[i].columns) << where << ' ' << a[i].name;
  }
}

TEST(Presets, AskedOnceAreThoseOfEachTask) {
  std::vector<rdm_field_info> all;
  for (int32_t i = 0; i < rdm_task_count(); ++i)
    for (const rdm_field_info& f : task_fields(i)) all.push_back(f);
  const Presets presets(all);
  for (int32_t i = 0; i < rdm_task_count(); ++i) {
    const rdm_task t = task_at(i);
    expect_same(presets.of(t.obs_dim, task_fields(i)), obs_presets(t.obs_dim, task_fields(i)), t.name);
  }
}

rdm_field_info field(const char* name, int32_t offset, int32_t count) {
  rdm_field_info f{};
  f.name = name;
  f.unit = "1";
  f.offset = offset;
  f.count = count;
  return f;
}

TEST(Presets, AFieldOfTheSameNameHidesOneWhereItIs) {
  const std::vector<rdm_field_info> hidden = {field("Touch", 0, 2), field("right.joint_position", 2, 3)},
                                    plain = {field("right.joint_position", 0, 3),
                                             field("goal.position", 4, 1)};
  std::vector<rdm_field_info> all = hidden;
  all.insert(all.end(), plain.begin(), plain.end());
  const Presets presets(all);
  expect_same(presets.of(5, hidden), obs_presets(5, hidden), "hidden");
  expect_same(presets.of(6, plain), obs_presets(6, plain), "plain, with entries of no field");
  const std::vector<rdm_field_info> unknown = {field("gyro", 0, 3)};
  expect_same(presets.of(3, unknown), obs_presets(3, unknown), "of a field that was not among them");
}

}  // namespace
