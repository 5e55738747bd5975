// rdm_task_check names the first promise that a task breaks; tasks that keep them pass.
#include <atomic>
#include <thread>

#include "contract.hpp"
#include "own_task.hpp"

namespace rdm::test {
namespace {

TEST(TaskCheck, GoodTasksPass) {
  BallTask t("check_good");
  const Registered made(t.def);
  EXPECT_EQ(rdm_task_check("check_good", nullptr, nullptr, nullptr, nullptr, 0), RDM_OK) << rdm_last_error();
  EXPECT_EQ(rdm_task_check("check_good", "push=2\nengine=ode", nullptr, nullptr, nullptr, 0), RDM_OK)
      << rdm_last_error();
  for (int32_t i = 0; i < rdm_task_count(); ++i) {
    rdm_task task{};
    task.struct_size = sizeof task;
    ASSERT_EQ(rdm_task_at(i, &task), RDM_OK);
    EXPECT_EQ(rdm_task_check(task.name, nullptr, nullptr, nullptr, nullptr, 0), RDM_OK) << rdm_last_error();
  }
}

TEST(TaskCheck, ATaskThatCannotBeMadeIsItsError) {
  char text[80] = "";
  EXPECT_EQ(rdm_task_check("grasb", nullptr, nullptr, nullptr, text, sizeof text), RDM_ERROR_NOT_FOUND);
  EXPECT_STREQ(text, "task grasb: unknown; nearest is grasp");
  EXPECT_EQ(rdm_task_check(nullptr, nullptr, nullptr, nullptr, nullptr, 0), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_task_check("grasp", "objekt=egg", nullptr, nullptr, nullptr, 0), RDM_ERROR_NOT_FOUND);
  EXPECT_EQ(rdm_task_check("grasp", nullptr, nullptr, nullptr, text, 0), RDM_ERROR_RANGE);
}

// Says stop when it was asked so many times; a flag that another thread may set does, too.
struct Patience {
  int64_t left;
  int64_t asked = 0, steps = 0;
  std::atomic<bool> enough = false;
  std::atomic<bool> begun = false;

  static int32_t stop(void* user, int64_t steps) {
    auto* p = static_cast<Patience*>(user);
    EXPECT_GE(steps, p->steps);
    p->steps = steps;
    p->begun = true;
    return p->asked++ >= p->left || p->enough;
  }
};

TEST(TaskCheck, EndsWhereItsHostSaysSo) {
  CountingHost host;
  ASSERT_EQ(rdm_init(&host.hooks), RDM_OK);
  {
    BallTask t("check_ends");
    const Registered made(t.def);
    const size_t live = host.live;
    Patience whole{INT64_MAX};
    ASSERT_EQ(rdm_task_check("check_ends", nullptr, Patience::stop, &whole, nullptr, 0), RDM_OK);
    EXPECT_GT(whole.asked, 500);
    EXPECT_GT(whole.steps, whole.asked);
    for (const int64_t left : {int64_t{0}, int64_t{1}, whole.asked / 3, whole.asked / 2, whole.asked - 1}) {
      Patience patience{left};
      char text[128] = "";
      EXPECT_EQ(rdm_task_check("check_ends", nullptr, Patience::stop, &patience, text, sizeof text),
                RDM_ERROR_CANCELLED);
      EXPECT_EQ(patience.asked, left + 1);
      EXPECT_EQ(std::string(text), "task check_ends: the host ended the check after " +
                                       std::to_string(patience.steps) + " control steps");
      EXPECT_EQ(host.live, live) << left;
    }
    Patience last{whole.asked};
    EXPECT_EQ(rdm_task_check("check_ends", nullptr, Patience::stop, &last, nullptr, 0), RDM_OK);
  }
  rdm_shutdown();
}

TEST(TaskCheck, EndsWhenAnotherThreadWantsIt) {
  Patience patience{INT64_MAX};
  std::thread other([&] {
    while (!patience.begun) std::this_thread::yield();
    patience.enough = true;
  });
  EXPECT_EQ(rdm_task_check("jenga", nullptr, Patience::stop, &patience, nullptr, 0), RDM_ERROR_CANCELLED);
  other.join();
}

struct Broken {
  Fault fault;
  const char* text;  // what follows "task broken: "
};

// Filled by the faults of tests/support/own_task.hpp, printed as the table of messages.
const Broken kBroken[] = {
    {Fault::kBuildFails, "build: the ball is too large"},
    {Fault::kBuildReturnsNonsense, "build returned 7, which is not an rdm_result"},
    {Fault::kBuildThrows, "build threw an exception"},
    {Fault::kResetHidden, "reset: the state differs for the same seed; step 0"},
    {Fault::kResetFails, "reset: call not allowed in this state; step 0"},
    {Fault::kStatePast, "control: it writes past the end of its state, byte 50 of 48; step 1"},
    {Fault::kStateBefore, "control: it writes before its state; step 1"},
    {Fault::kRowPast, "observe: it writes past the end of the row of observations, byte 36 of 36; step 0"},
    {Fault::kRowShort, "observe: entry 1 of field action is not written; step 0"},
    {Fault::kRowNan, "observe: entry 1 of field ball.velocity is not finite; step 2"},
    {Fault::kRowBound, "observe: entry 1 of field action is 1.5, outside [-1, 1]; step 0"},
    {Fault::kObserveState, "observe: it changes its state; step 0"},
    {Fault::kObserveCounts, "observe: called twice it writes other numbers; step 0"},
    {Fault::kObserveSets, "observe: world: it cannot be changed in observe; step 0"},
    {Fault::kControlAction, "control: it changes the action; step 1"},
    {Fault::kControlNan, "control: targets[0] is not finite or beyond 1e+06; step 1"},
    {Fault::kControlTouches, "after save and restore; step"},
    {Fault::kJudgeNan, "judge: the reward is not finite; step 3"},
    {Fault::kJudgeRawNan, "judge: the raw value of cost speed is not finite; step 1"},
    {Fault::kJudgeNegative, "judge: cost speed is -0.5, but it must be 0 or more; step 1"},
    {Fault::kJudgeHidden, "judge: its verdict differs for the same seed; step"},
    {Fault::kStateOutside, "check_state: start is not within +-1; step 5"},
    {Fault::kStateElsewhere, "for the same seed; step"},
    {Fault::kHoldFlies, "world 0 diverges with the hold action; step 1"},
};

TEST(TaskCheck, TheFirstBrokenPromiseIsNamed) {
  for (const Broken& broken : kBroken) {
    BallTask t("broken", broken.fault);
    const Registered made(t.def);
    char text[256] = "";
    EXPECT_NE(rdm_task_check("broken", nullptr, nullptr, nullptr, text, sizeof text), RDM_OK) << broken.text;
    EXPECT_NE(std::string(text).find(broken.text), std::string::npos) << text << "\nexpected " << broken.text;
    EXPECT_EQ(std::string(text).rfind("task broken: ", 0), 0u) << text;
    EXPECT_STREQ(rdm_last_error(), text);
    std::printf("%s\n", text);
  }
}

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST(TaskCheck, MemoryThatIsLeftBehindIsNamed) {
  BallTask t("leaks", Fault::kJudgeLeaks);
  t.user.leaked.reserve(100000);
  const Registered made(t.def);
  EXPECT_EQ(rdm_task_check("leaks", nullptr, nullptr, nullptr, nullptr, 0), RDM_ERROR_ARGUMENT);
  EXPECT_NE(std::strstr(rdm_last_error(), "judge does not free all of its memory"), nullptr)
      << rdm_last_error();
  std::printf("%s\n", rdm_last_error());
}
#endif

}  // namespace
}  // namespace rdm::test
