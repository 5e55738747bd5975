// Options have levels: each task and each algorithm has a screenful of basic ones, and lists of the tool begin with them.
#include <gtest/gtest.h>

#include <redman/redman.hpp>

namespace {

template <class At>
std::array<int, 3> levels(int32_t count, At at) {
  std::array<int, 3> n{};
  for (int32_t i = 0; i < count; ++i) {
    rdm_option_spec o = RDM_INIT(rdm_option_spec);
    EXPECT_EQ(at(i, &o), RDM_OK);
    EXPECT_TRUE(o.level >= RDM_LEVEL_BASIC && o.level <= RDM_LEVEL_LEGACY) << o.key;
    ++n.at(static_cast<size_t>(o.level));
  }
  return n;
}

TEST(OptionLevels, AFewAreBasicInEveryTask) {
  for (int32_t t = 0; t < rdm_task_count(); ++t) {
    rdm_task task = RDM_INIT(rdm_task);
    ASSERT_EQ(rdm_task_at(t, &task), RDM_OK);
    const auto n =
        levels(task.num_options, [&](int32_t i, rdm_option_spec* o) { return rdm_task_option_at(t, i, o); });
    EXPECT_GE(n[RDM_LEVEL_BASIC], 8) << task.name;
    EXPECT_LE(n[RDM_LEVEL_BASIC], 32) << task.name;
    EXPECT_LE(n[RDM_LEVEL_LEGACY], 20) << task.name;
  }
}

TEST(OptionLevels, AFewAreBasicInEveryAlgorithm) {
  for (int32_t a = 0; a < rdm_algo_count(); ++a) {
    rdm_algo algo = RDM_INIT(rdm_algo);
    ASSERT_EQ(rdm_algo_at(a, &algo), RDM_OK);
    const auto n =
        levels(algo.num_options, [&](int32_t i, rdm_option_spec* o) { return rdm_algo_option_at(a, i, o); });
    EXPECT_GE(n[RDM_LEVEL_BASIC], 15) << algo.name;
    EXPECT_LE(n[RDM_LEVEL_BASIC], 25) << algo.name;
  }
}

TEST(OptionLevels, FollowTheRow) {
  const auto level_of = [](const char* key) {
    int32_t t = 0;
    EXPECT_EQ(rdm_task_find("hand_over_safe_finger", &t), RDM_OK);
    for (int32_t i = 0;; ++i) {
      rdm_option_spec o = RDM_INIT(rdm_option_spec);
      if (rdm_task_option_at(t, i, &o) != RDM_OK) return -1;
      if (std::string(o.key) == key) return o.level;
    }
  };
  EXPECT_EQ(level_of("object"), RDM_LEVEL_BASIC);
  EXPECT_EQ(level_of("iterations"), RDM_LEVEL_ADVANCED);
  EXPECT_EQ(level_of("cost_mode"), RDM_LEVEL_LEGACY);
}

}  // namespace
