// Long runs: 1,000,000 random steps of every task (100,000 on engine ode) stay finite and slow enough, and
// memory stays flat.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>

#include "heap_count.hpp"
#include "tasks/catalog.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

constexpr const char* kTasks[] = {"hand_over_safe_finger",
                                  "hand_over_safe_joint",
                                  "catch_underarm_safe_finger",
                                  "catch_underarm_safe_joint",
                                  "grasp",
                                  "reorient",
                                  "hand_over_wall",
                                  "jenga",
                                  "pick_bottles",
                                  "clean_house"};

TEST(SlowTasks, RandomStepsStayFinite) {
  register_builtin_tasks();
  for (const char* task : kTasks)
    for (const char* engine : {"ode", "articulated"}) {
      SCOPED_TRACE(std::string(task) + ", " + engine);
      const int steps = std::strcmp(engine, "ode") == 0 ? 5000 : 50000;
      TestPool p(task, 20, {{"engine", engine, 0}});
      p->reset(nullptr, nullptr);
      double fastest = 0;
      for (int t = 0; t < steps; ++t) {
        p->baseline(Baseline::kRandom);
        p->step(nullptr);
        for (int i = 0; i < 20; ++i) {
          for (int b = 0; b < p->task().scene().num_bodies; ++b)
            fastest = std::max(fastest, norm(p->world(i).body(b).v));
          for (int k = 0; k < p->obs_dim(); ++k) {
            ASSERT_LE(std::abs(p.obs(i)[k]), p->task().obs_limit());
            ASSERT_LE(std::abs(p.final_obs(i)[k]), p->task().obs_limit());
          }
          ASSERT_TRUE(std::isfinite(p.rows().reward[i]));
        }
      }
      std::printf("%-26s %-11s %d steps, fastest body %.1f m/s, contacts mean %.1f, most %d\n", task, engine,
                  20 * steps, fastest, p->stats().contacts_mean, p->stats().contacts_max);
      EXPECT_LT(fastest, 20);
      EXPECT_EQ(p->stats().steps, 20 * steps);
      EXPECT_EQ(p->stats().diverged, 0);
      EXPECT_EQ(p->stats().overflowed, 0);
    }
}

TEST(SlowTasks, AHundredThousandResetsTakeNoMemory) {
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
