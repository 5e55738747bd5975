// Option action_repeat: what a step of several control steps leaves in the rows, where episodes end or break.
#include "toy_task.hpp"

namespace rdm::test {
namespace {

std::vector<OptionInput> repeating(int repeat, std::vector<OptionInput> more = {}) {
  register_toy();
  more.push_back({"action_repeat", nullptr, static_cast<double>(repeat)});
  return more;
}

TEST(PoolRepeat, SumsAndCounts) {
  TestPool p("toy_push", 2, repeating(4));
  EXPECT_EQ(p->repeat(), 4);
  p->reset(nullptr, nullptr);
  p.action(0)[1] = 0.5f;
  p.action(1)[0] = -1;
  p->step(nullptr);
  EXPECT_EQ(p.rows().reward[0], 2.0f);
  EXPECT_EQ(p.cost(0)[1], 1.0f);
  EXPECT_EQ(p.rows().cost_raw[1], 0.25f);  // of the last control step
  EXPECT_EQ(p.rows().episode_step[0], 4);
  EXPECT_EQ(p.rows().episode_return[0], 2.0f);
  EXPECT_EQ(p->taken(0), 4);
  EXPECT_EQ(p->stats().steps, 8);
  EXPECT_LT(p.obs(1)[0], p.obs(0)[0]);
  p->step(nullptr);
  EXPECT_EQ(p.rows().reward[0], 2.0f);  // of this step alone
  EXPECT_EQ(p.rows().episode_return[0], 4.0f);
}

TEST(PoolRepeat, StopsAtTheEndOfAnEpisode) {
  for (const Autoreset mode : {Autoreset::kSameStep, Autoreset::kNextStep, Autoreset::kOff}) {
    PoolConfig c;
    c.autoreset = mode;
    TestPool p("toy_push", 1, repeating(4), c);  // of 10 control steps
    p->reset(nullptr, nullptr);
    p.action(0)[1] = 1;
    for (int t = 0; t < 3; ++t) p->step(nullptr);
    EXPECT_EQ(p.rows().reward[0], 2.0f);
    EXPECT_EQ(p.rows().episode_step[0], 10);
    EXPECT_EQ(p.rows().truncated[0], 1);
    EXPECT_EQ(p->taken(0), 2);
    if (mode == Autoreset::kOff) continue;
    p->step(nullptr);
    EXPECT_EQ(p->taken(0), mode == Autoreset::kNextStep ? 0 : 4);
    EXPECT_EQ(p.rows().episode_step[0], mode == Autoreset::kNextStep ? 0 : 4);
    EXPECT_EQ(p.rows().reward[0], mode == Autoreset::kNextStep ? 0.0f : 4.0f);
    EXPECT_EQ(p.rows().truncated[0], 0);
  }
}

TEST(PoolRepeat, SuccessAndStatusOfAnyControlStepStay) {
  TestPool p("toy_push", 2, repeating(6, {{"nan_at", nullptr, 3}}));
  p->reset(nullptr, nullptr);
  p.action(0)[1] = p.action(1)[1] = 1;
  p->step(nullptr);
  EXPECT_EQ(p.rows().status[0], kStatusDiverged);
  EXPECT_EQ(p.rows().truncated[0], 1);
  EXPECT_EQ(p.rows().reward[0], 2.0f);  // of the two that were good
  EXPECT_EQ(p->taken(0), 3);

  TestPool bad("toy_push", 1, repeating(6));
  bad->reset(nullptr, nullptr);
  bad.action(0)[0] = std::numeric_limits<float>::infinity();
  bad->step(nullptr);
  EXPECT_EQ(bad.rows().status[0], kStatusBadAction);
  EXPECT_EQ(bad.rows().reward[0], 0.0f);
  EXPECT_EQ(bad->taken(0), 1);
}

TEST(PoolRepeat, AnErrorOfOneWorldEndsItsStepAlone) {
  TestPool p("toy_push", 2, repeating(5, {{"throw_at", nullptr, 7}}));
  p->reset(nullptr, nullptr);
  const uint8_t second[] = {0, 1};
  p->step(second);
  EXPECT_EQ(code_of([&] { p->step(nullptr); }), Code::kInternal);
  EXPECT_EQ(p.rows().episode_step[0], 5);
  EXPECT_EQ(p.rows().episode_step[1], 6);
}

TEST(PoolRepeat, ZeroIsTheTasksOwnRate) {
  TestPool p("toy_push", 1, repeating(0));
  EXPECT_EQ(p->repeat(), 1);  // it has none
  EXPECT_EQ(code_of([] { TestPool("toy_push", 1, repeating(-1)); }), Code::kRange);
  EXPECT_EQ(code_of([] { TestPool("toy_push", 1, repeating(10001)); }), Code::kRange);
}

}  // namespace
}  // namespace rdm::test
