// Every task shows and does things less exactly on demand, within its bounds, and says what it was asked for.
#include <cmath>

#include "contract.hpp"

namespace {

std::string settings_of(const rdm_pool* p) {
  size_t size = 0;
  EXPECT_EQ(rdm_pool_get_settings(p, nullptr, 0, &size), RDM_OK);
  std::string text(size + 1, '#');
  EXPECT_EQ(rdm_pool_get_settings(p, text.data(), text.size(), &size), RDM_OK);
  text.resize(size);
  return text;
}

TEST(Disturbances, OfEveryTaskComeBackAsTheyWereSet) {
  const std::string lines = "noise.*=0.1\nbias.*=0.01..0.02\ndelay.*=0..3\ndropout.*=0.05\n";
  for (int32_t i = 0; i < rdm_task_count(); ++i) {
    rdm_task task{};
    task.struct_size = sizeof task;
    ASSERT_EQ(rdm_task_at(i, &task), RDM_OK);
    SCOPED_TRACE(task.name);
    rdm_field_info field = RDM_INIT(rdm_field_info);
    ASSERT_EQ(rdm_task_field_at(i, 0, &field), RDM_OK);
    const std::string own = lines + "noise." + field.name + "=0.125\n", given = "action_delay=1..2\n" + own;
    rdm_pool_config c = pool_config(3);
    c.task = task.name;
    c.settings = given.c_str();
    rdm_pool* p = make_pool(c);
    ASSERT_NE(p, nullptr);
    const std::string all = settings_of(p);
    EXPECT_NE(all.find("\naction_delay=1..2\n"), std::string::npos);
    EXPECT_EQ(all.substr(all.size() - std::min(own.size(), all.size())), own) << all;
    EXPECT_EQ(all.find("FIELD"), std::string::npos);
    // one by one, behind those of the task
    const char* key = nullptr;
    char text[RDM_TEXT_SIZE];
    ASSERT_EQ(rdm_pool_setting_at(p, task.num_options, &key, text), RDM_OK);
    EXPECT_STREQ(key, "noise.*");
    ASSERT_EQ(rdm_pool_setting_at(p, task.num_options + 1, &key, text), RDM_OK);
    EXPECT_STREQ(text, "0.01..0.02");
    ASSERT_EQ(rdm_pool_setting_at(p, task.num_options + 4, &key, text), RDM_OK);
    EXPECT_EQ(key, std::string("noise.") + field.name);
    EXPECT_EQ(rdm_pool_setting_at(p, task.num_options + 5, &key, text), RDM_ERROR_RANGE);
    rdm_pool_config d = c;
    d.settings = all.c_str();
    rdm_pool* again = make_pool(d);
    ASSERT_NE(again, nullptr);
    for (rdm_pool* one : {p, again}) {
      EXPECT_EQ(rdm_pool_reset(one, nullptr, nullptr), RDM_OK);
      for (int t = 0; t < 20; ++t) {
        EXPECT_EQ(rdm_pool_baseline(one, RDM_BASELINE_RANDOM), RDM_OK);
        EXPECT_EQ(rdm_pool_step(one), RDM_OK);
      }
    }
    EXPECT_EQ(hash_of(p), hash_of(again));
    EXPECT_EQ(settings_of(again), all);
    rdm_pool_destroy(p);
    rdm_pool_destroy(again);
  }
}

TEST(Disturbances, KeepTheBoundsOfEveryField) {
  for (int32_t i = 0; i < rdm_task_count(); ++i) {
    rdm_task task{};
    task.struct_size = sizeof task;
    ASSERT_EQ(rdm_task_at(i, &task), RDM_OK);
    SCOPED_TRACE(task.name);
    rdm_pool_config c = pool_config(2);
    c.task = task.name;
    c.settings = "noise.*=1000\nbias.*=1000";
    rdm_pool* p = make_pool(c);
    ASSERT_NE(p, nullptr);
    rdm_buffers b{};
    b.struct_size = sizeof b;
    ASSERT_EQ(rdm_pool_get_buffers(p, &b), RDM_OK);
    ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
    for (int t = 0; t < 3; ++t) {
      for (int32_t k = 0; k < task.num_fields; ++k) {
        rdm_field_info f = RDM_INIT(rdm_field_info);
        ASSERT_EQ(rdm_pool_field_at(p, k, &f), RDM_OK);
        for (int32_t e = 0; e < f.count; ++e) {
          const float x = b.obs[f.offset + e];
          EXPECT_TRUE(std::isfinite(x));
          EXPECT_FALSE(x < f.low || x > f.high) << f.name << ' ' << x;
        }
      }
      ASSERT_EQ(rdm_pool_baseline(p, RDM_BASELINE_RANDOM), RDM_OK);
      ASSERT_EQ(rdm_pool_step(p), RDM_OK);
      EXPECT_EQ(b.status[0], 0u);
    }
    rdm_pool_destroy(p);
  }
}

TEST(Disturbances, AreRowsOfEveryTask) {
  for (int32_t i = 0; i < rdm_task_count(); ++i) {
    rdm_task task{};
    task.struct_size = sizeof task;
    ASSERT_EQ(rdm_task_at(i, &task), RDM_OK);
    int found = 0;
    for (int32_t k = 0; k < task.num_options; ++k) {
      rdm_option_spec o = RDM_INIT(rdm_option_spec);
      ASSERT_EQ(rdm_task_option_at(i, k, &o), RDM_OK);
      const std::string key = o.key;
      const bool open =
          key == "noise.FIELD" || key == "bias.FIELD" || key == "delay.FIELD" || key == "dropout.FIELD";
      found += open || key == "end_on_cost" || key == "action_delay";
      if (open || key == "action_delay") {
        EXPECT_STREQ(o.choices, "a..b");
      }
    }
    EXPECT_EQ(found, 6) << task.name;
  }
}

}  // namespace
