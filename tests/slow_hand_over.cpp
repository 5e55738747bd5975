// Long runs of the hand over tasks: 100,000 random steps stay finite and slow enough, and memory stays flat.
#include <cmath>

#include "heap_count.hpp"
#include "tasks/catalog.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

TEST(SlowHandOver, RandomStepsStayFinite) {
  register_builtin_tasks();
  for (const char* task : {"hand_over_safe_finger", "hand_over_safe_joint"}) {
    TestPool p(task, 20);
    p->reset(nullptr, nullptr);
    double fastest = 0;
    for (int t = 0; t < 5000; ++t) {
      p->baseline(Baseline::kRandom);
      p->step(nullptr);
      for (int i = 0; i < 20; ++i) {
        fastest = std::max(fastest, norm(p->world(i).body(0).v));
        for (int k = 0; k < p->obs_dim(); ++k) {
          ASSERT_LE(std::abs(p.obs(i)[k]), 5);
          ASSERT_LE(std::abs(p.final_obs(i)[k]), 5);
        }
        ASSERT_TRUE(std::isfinite(p.rows().reward[i]));
      }
    }
    EXPECT_LT(fastest, 20) << task;
    EXPECT_EQ(p->stats().steps, 100000);
    EXPECT_EQ(p->stats().diverged, 0);
    EXPECT_EQ(p->stats().overflowed, 0);
  }
}

TEST(SlowHandOver, AHundredThousandResetsTakeNoMemory) {
  if (!kHeapIsCounted) GTEST_SKIP() << "a sanitizer owns the heap";
  register_builtin_tasks();
  TestPool p("hand_over_safe_finger", 10);
  p->reset(nullptr, nullptr);
  const int64_t before = heap_count();
  for (int i = 0; i < 10000; ++i) p->reset(nullptr, nullptr);
  p->step(nullptr);
  EXPECT_EQ(heap_count(), before);
}

}  // namespace
}  // namespace rdm::test
