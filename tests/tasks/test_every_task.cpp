// What every task with a choice of engines owes on each: finite, bounded, reproducible, restorable, no heap.
#include <algorithm>
#include <cmath>
#include <string>

#include "heap_count.hpp"
#include "tasks/catalog.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

struct Case {
  std::string task, engine, object = "";  // "": the task's own
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.task << ' ' << c.engine << ' ' << c.object;
}

// Tasks that have a choice of engines.
std::vector<Case> all_cases() {
  register_builtin_tasks();
  std::vector<Case> out;
  for (int32_t i = 0; i < task_count(); ++i) {
    int32_t count = 0;
    const OptionSpec* specs = task_at(i).options(&count, nullptr);
    if (std::none_of(specs, specs + count, [](const OptionSpec& o) { return same_name(o.key, "engine"); }))
      continue;
    for (const char* engine : {"ode", "articulated"}) out.push_back({task_at(i).name, engine});
  }
  // objects of forms that no task begins with
  for (const char* engine : {"ode", "articulated"})
    for (const char* object : {"ellipsoid_egg", "hull"})
      out.push_back({"hand_over_safe_finger", engine, object});
  return out;
}

class EveryTask : public testing::TestWithParam<Case> {
 protected:
  std::vector<OptionInput> options(std::vector<OptionInput> more = {}) const {
    more.push_back({"engine", GetParam().engine.c_str(), 0});
    if (!GetParam().object.empty()) more.push_back({"object", GetParam().object.c_str(), 0});
    return more;
  }
  const char* task() const { return GetParam().task.c_str(); }
  static void run(TestPool& p, int steps) {
    for (int t = 0; t < steps; ++t) {
      p->baseline(Baseline::kRandom);
      p->step(nullptr);
    }
  }
};

TEST_P(EveryTask, RandomStepsStayFiniteAndSlow) {
  constexpr int kSteps = 250;
  const int worlds = GetParam().engine == "ode" ? 6 : 20;  // ODE's worlds take ten times as long
  TestPool p(task(), worlds, options());
  p->reset(nullptr, nullptr);
  const double limit = static_cast<double>(p->task().obs_limit());
  const int bodies = p->task().scene().num_bodies;
  double fastest = 0;
  for (int t = 0; t < kSteps; ++t) {
    run(p, 1);
    for (int i = 0; i < worlds; ++i) {
      for (int b = 0; b < bodies; ++b) fastest = std::max(fastest, norm(p->world(i).body(b).v));
      for (int k = 0; k < p->obs_dim(); ++k) {
        ASSERT_LE(std::abs(p.obs(i)[k]), limit);
        ASSERT_LE(std::abs(p.final_obs(i)[k]), limit);
      }
      ASSERT_TRUE(std::isfinite(p.rows().reward[i]));
    }
  }
  EXPECT_LT(fastest, 20);
  EXPECT_EQ(p->stats().diverged, 0);
  EXPECT_EQ(p->stats().overflowed, 0) << "at most " << p->stats().contacts_max << " contacts";
}

TEST_P(EveryTask, ThreadsSeedsAndRestartsGiveTheSameBytes) {
  const auto hashes = [&](int32_t threads, uint64_t created, bool reseed, int32_t worlds = 5) {
    PoolConfig c;
    c.num_threads = threads;
    c.seed = created;
    TestPool p(task(), worlds, options({{"max_steps", nullptr, 25}}), c);
    p->reset(nullptr, nullptr);
    if (reseed) {
      run(p, 30);
      const uint64_t seeds[] = {6, 6, 6, 6, 6};
      p->reset(seeds, nullptr);
    }
    run(p, 60);
    std::vector<uint64_t> out;
    for (int32_t i = 0; i < worlds; ++i) out.push_back(p->hash(i));
    return out;
  };
  const auto expected = hashes(0, 6, false);
  for (const int32_t threads : {1, 2, 4}) EXPECT_EQ(hashes(threads, 6, false), expected) << threads;
  EXPECT_NE(hashes(0, 7, false), expected);
  // a seed alone names the episodes: those of a pool of one world
  EXPECT_EQ(hashes(0, 99, true), std::vector<uint64_t>(5, hashes(0, 6, false, 1)[0]));
}

TEST_P(EveryTask, ASavedPoolGoesOnInAnother) {
  for (const int at : {0, 7, 40}) {
    TestPool a(task(), 3, options({{"max_steps", nullptr, 30}}));
    a->reset(nullptr, nullptr);
    run(a, at);
    const auto state = a.state();
    TestPool b(task(), 3, options({{"max_steps", nullptr, 30}}));
    b->reset(nullptr, nullptr);
    run(b, 13);
    b->set_state(-1, state.data(), state.size());
    const auto same = [&](const float* x, const float* y, int32_t width) {
      return std::memcmp(x, y, sizeof(float) * 3 * static_cast<size_t>(width)) == 0;
    };
    EXPECT_TRUE(same(a.rows().obs, b.rows().obs, a->obs_dim()));
    for (int t = 0; t < 50; ++t) {
      run(a, 1);
      run(b, 1);
      ASSERT_EQ(a->hash(-1), b->hash(-1)) << "step " << t << " after " << at;
      ASSERT_TRUE(same(a.rows().final_obs, b.rows().final_obs, a->obs_dim()));
      ASSERT_TRUE(same(a.rows().cost, b.rows().cost, a->cost_dim()));
    }
  }
}

TEST_P(EveryTask, AllocatesNothing) {
  if (!kHeapIsCounted) GTEST_SKIP() << "a sanitizer owns the heap";
  TestPool p(task(), 2, options());
  const int64_t before = heap_count();
  p->reset(nullptr, nullptr);
  run(p, 160);
  EXPECT_EQ(heap_count(), before);
}

// Costs are 0 or 1 in each step, and begin each episode at 0.
TEST_P(EveryTask, CostsAreFlags) {
  TestPool p(task(), 8, options({{"max_steps", nullptr, 40}}));
  p->reset(nullptr, nullptr);
  for (int t = 0; t < 90; ++t) {
    run(p, 1);
    for (int k = 0; k < 8 * p->cost_dim(); ++k) {
      EXPECT_TRUE(p.rows().cost[k] == 0 || p.rows().cost[k] == 1);
      EXPECT_TRUE(std::isfinite(p.rows().cost_raw[k]));
    }
  }
  p->reset(nullptr, nullptr);
  for (int k = 0; k < 8 * p->cost_dim(); ++k) {
    EXPECT_EQ(p.rows().cost[k], 0);
    EXPECT_EQ(p.rows().episode_cost[k], 0);
  }
}

TEST_P(EveryTask, HoldAndMeanAreActions) {
  TestPool p(task(), 1, options());
  std::vector<float> a(static_cast<size_t>(p->task().action_dim()), 9.0f);
  p->task().hold_action(a.data());
  for (const float x : a) EXPECT_LE(std::abs(x), 1);
  std::fill(a.begin(), a.end(), 9.0f);
  p->task().initial_mean(a.data());
  for (const float x : a) EXPECT_LE(std::abs(x), 1);
}

INSTANTIATE_TEST_SUITE_P(Tasks, EveryTask, testing::ValuesIn(all_cases()), [](const auto& info) {
  const Case& c = info.param;
  return c.task + "_" + c.engine + (c.object.empty() ? "" : "_" + c.object);
});

}  // namespace
}  // namespace rdm::test
