#include "toy_task.hpp"

namespace rdm::test {
namespace {

TEST(Registry, FindsByNameAliasAndId) {
  register_toy();
  const int32_t i = task_find("toy_push");
  EXPECT_EQ(&task_at(i), &toy_info());
  for (const char* name :
       {"TOY-PUSH", "Toy_Push", "ToyPush", "ToyPush-v0", "SafetyToyPush-v0", "SafetyToyPush"})
    EXPECT_EQ(task_find(name), i) << name;
}

TEST(Registry, RefusesWhatIsNotThere) {
  register_toy();
  for (const char* name : {"toy_pul", "ToyPush-vx", "ToyPush-v", "UnsafetyToyPush", ""}) {
    EXPECT_EQ(code_of([&] { task_find(name); }), Code::kNotFound) << name;
    const bool near = std::strlen(name) > 0 && std::strlen(name) <= 10;
    EXPECT_EQ(std::strstr(last_error(), "; nearest is toy_push") != nullptr, near) << last_error();
  }
  EXPECT_EQ(code_of([&] { task_find(nullptr); }), Code::kArgument);
  EXPECT_EQ(code_of([&] { task_at(-1); }), Code::kRange);
  EXPECT_EQ(code_of([&] { task_at(task_count()); }), Code::kRange);
  EXPECT_EQ(code_of([&] { register_task(toy_info()); }), Code::kInternal);  // twice
}

}  // namespace
}  // namespace rdm::test
