#include <algorithm>
#include <mutex>

#include "agents.hpp"
#include "algos/core/batch_workers.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

struct Bench {
  AgentSetup setup;
  ResolvedAgentConfig plan;
  Arena arena;
  BatchWorkers lanes;

  Bench(int32_t threads, HostHooks hooks = {})
      : setup("ppo", 3, 2, 8), plan(make_plan(configure(setup, threads, hooks))) {
    Arena measure;
    lanes.carve(measure, plan, 10);
    arena = Arena(HostHooks(), measure.used());
    lanes.carve(arena, plan, 10);
    lanes.open(hooks, threads);
  }
  static const AgentConfig& configure(AgentSetup& s, int32_t threads, HostHooks hooks) {
    s.config.num_threads = threads;
    s.config.hooks = hooks;
    return s.with("minibatches", "1").with("horizon", "64").ready();
  }
};

// A host that runs bodies last to first.
void backwards(void*, int32_t n, ParallelBody body, void* context) {
  for (int32_t i = n - 1; i >= 0; --i) body(context, i);
}

}  // namespace

TEST(BatchWorkers, AtMostOnePerThreadAndPerPiece) {
  EXPECT_EQ(Bench(0).lanes.count(), 1);
  EXPECT_EQ(Bench(3).lanes.count(), 3);
  EXPECT_EQ(Bench(64).lanes.count(), 4);  // 512 rows in pieces of 128
}

TEST(BatchWorkers, EveryRowOnceAndFoldsInOrder) {
  HostHooks reversed;
  reversed.parallel = backwards;
  for (const int32_t threads : {0, 2, 3, 4}) {
    for (const HostHooks& hooks : {HostHooks(), reversed}) {
      Bench b(threads, hooks);
      for (const int32_t rows : {1, 9, 10, 11, 55, 100}) {
        std::vector<int> seen(size_of(rows), 0);
        std::vector<int32_t> order;
        b.lanes.sweep(
            rows, 10,
            [&](Lane& lane, int32_t first, int32_t n) {
              for (int32_t i = first; i < first + n; ++i) ++seen[size_of(i)];
              lane.sums.loss = first;
            },
            [&](int32_t group, int32_t n) {
              for (int32_t i = 0; i < n; ++i) {
                EXPECT_EQ(b.lanes[i].sums.loss, 10 * (group + i));
                order.push_back(group + i);
              }
            });
        EXPECT_EQ(std::count(seen.begin(), seen.end(), 1), rows);
        EXPECT_TRUE(std::is_sorted(order.begin(), order.end()));
        EXPECT_EQ(static_cast<int32_t>(order.size()), (rows + 9) / 10);
      }
    }
  }
}

TEST(BatchWorkers, NoBodyForNothing) {
  Bench b(2);
  b.lanes.sweep(0, 10, [](Lane&, int32_t, int32_t) { FAIL(); });
  b.lanes.spread(0, [](int32_t) { FAIL(); });
}
