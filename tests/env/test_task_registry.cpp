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

// A row that was added: its functions go through the source, which ends with the last reference.
class Source final : public TaskSource {
 public:
  explicit Source(const char* name) : info_(toy_info()) {
    info_.name = name;
    info_.alias = nullptr;
    info_.options = nullptr;
    info_.make = nullptr;
    info_.destroy = nullptr;
    info_.source = this;
  }
  const TaskInfo& info() const override { return info_; }
  const OptionSpec* options(int32_t* count) const override { return toy_info().options(count, nullptr); }
  Task* make(const Options& o, const HostHooks& hooks, void*) const override {
    return toy_info().make(o, hooks);
  }
  void destroy(Task* task, const HostHooks& hooks) const override { toy_info().destroy(task, hooks); }
  void end() noexcept override { ++ended; }
  int ended = 0;

 private:
  TaskInfo info_;
};

TEST(TaskRegistry, AddedRowsStayWithTheirLastReference) {
  Source first("added"), second("added");
  const int32_t i = add_task(&first);
  EXPECT_EQ(i, task_count() - 1);
  EXPECT_EQ(code_of([&] { add_task(&second); }), Code::kArgument);
  EXPECT_EQ(second.ended, 0);
  EXPECT_EQ(task_find("ADDED"), i);
  {
    TestPool p("added", 2);
    p->reset(nullptr, nullptr);
    TaskRef ref(i), moved(std::move(ref));
    EXPECT_EQ(&*moved, &first.info());
    remove_task(i);
    EXPECT_EQ(code_of([&] { remove_task(i); }), Code::kNotFound);
    EXPECT_EQ(code_of([&] { TaskRef{i}; }), Code::kNotFound);
    EXPECT_EQ(code_of([&] { task_find("added"); }), Code::kNotFound);
    EXPECT_EQ(&task_at(i), &first.info());  // someone holds it
    moved = TaskRef();
    p->step(nullptr);
    EXPECT_EQ(first.ended, 0);
    const int32_t k = add_task(&second);  // the name is free, the number is not
    EXPECT_GT(k, i);
    remove_task(k);
    EXPECT_EQ(second.ended, 1);
  }
  EXPECT_EQ(first.ended, 1);
  EXPECT_EQ(code_of([&] { task_at(i); }), Code::kNotFound);
  EXPECT_EQ(code_of([&] { remove_task(task_find("toy_push")); }), Code::kArgument);
  EXPECT_EQ(code_of([&] { remove_task(task_count() + 1000); }), Code::kRange);  // never given
}

}  // namespace
}  // namespace rdm::test
