#include <thread>

#include "tasks/catalog.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

TEST(Catalog, AnyThreadMayAskFirstAndOften) {
  std::vector<std::thread> threads;
  for (int i = 0; i < 4; ++i) threads.emplace_back([] { register_builtin_tasks(); });
  for (auto& t : threads) t.join();
  const int32_t count = task_count();
  register_builtin_tasks();
  EXPECT_EQ(task_count(), count);
}

TEST(Catalog, SafetyGymnasiumsIdsAreAliases) {
  register_builtin_tasks();
  const struct {
    const char *id, *name;
  } rows[] = {{"ShadowHandOverSafeFinger", "hand_over_safe_finger"},
              {"SafetyShadowHandOverSafeFinger-v0", "hand_over_safe_finger"},
              {"ShadowHandOverSafeJoint", "hand_over_safe_joint"},
              {"hand-over-safe-joint", "hand_over_safe_joint"}};
  for (const auto& row : rows) EXPECT_STREQ(task_at(task_find(row.id)).name, row.name) << row.id;
}

// What every task owes: a first column called cost, described options, defaults that its table knows.
TEST(Catalog, EveryRowIsComplete) {
  register_builtin_tasks();
  ASSERT_GT(task_count(), 0);
  for (int32_t t = 0; t < task_count(); ++t) {
    const TaskInfo& info = task_at(t);
    EXPECT_GT(std::strlen(info.summary), 10u) << info.name;
    EXPECT_STREQ(info.costs[0].name, "cost");
    EXPECT_GT(info.costs[0].limit, 0);
    for (int32_t k = 0; k < info.num_costs; ++k) EXPECT_GT(std::strlen(info.costs[k].help), 5u);
    EXPECT_STREQ(info.cameras[0].name, "front");
    int32_t count = 0;
    const OptionSpec* specs = info.options(&count, nullptr);
    EXPECT_EQ(info.options(&count, nullptr), specs);
    Options o;
    o.add_table(specs, count);
    for (int32_t i = 0; i < count; ++i) {
      EXPECT_GT(std::strlen(specs[i].help), 5u) << specs[i].key;
      EXPECT_LT(std::strlen(specs[i].help), 110u) << specs[i].key;
      char text[kOptionTextSize];
      o.print(i, text);
      const OptionInput same{specs[i].key, text, 0};  // each default is inside its own bounds
      EXPECT_EQ(code_of([&] { o.set(same, info.name); }), Code::kOk) << specs[i].key << " = " << text;
    }
    for (int32_t i = 0; i < info.num_defaults; ++i) EXPECT_NE(info.defaults[i].value, nullptr);
  }
}

}  // namespace
}  // namespace rdm::test
