#include <algorithm>
#include <mutex>

#include "agents.hpp"
#include "algos/core/batch_workers.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

struct Bench {
  AgentSetup setup;
  ResolvedAgentConfig resolved;
  Arena arena;
  BatchWorkers workers;

  Bench(int32_t threads, HostHooks hooks = {})
      : setup("ppo", 3, 2, 8), resolved(resolve_config(configure(setup, threads, hooks))) {
    Arena measure;
    workers.carve(measure, resolved, 10);
    arena = Arena(HostHooks(), measure.used());
    workers.carve(arena, resolved, 10);
    workers.open(hooks, threads);
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

TEST(BatchWorkers, AtMostOnePerThreadAndPerChunk) {
  EXPECT_EQ(Bench(0).workers.count(), 1);
  EXPECT_EQ(Bench(3).workers.count(), 3);
  EXPECT_EQ(Bench(64).workers.count(), 4);  // 512 rows in chunks of 128
}

TEST(BatchWorkers, EveryRowOnceAndReducesInOrder) {
  HostHooks reversed;
  reversed.parallel = backwards;
  for (const int32_t threads : {0, 2, 3, 4}) {
    for (const HostHooks& hooks : {HostHooks(), reversed}) {
      Bench b(threads, hooks);
      for (const int32_t rows : {1, 9, 10, 11, 55, 100}) {
        std::vector<int> seen(size_of(rows), 0);
        std::vector<int32_t> order;
        b.workers.sweep(
            rows, 10,
            [&](Workspace& workspace, int32_t first, int32_t n) {
              for (int32_t i = first; i < first + n; ++i) ++seen[size_of(i)];
              workspace.sums.loss = first;
            },
            [&](int32_t group, int32_t n) {
              for (int32_t i = 0; i < n; ++i) {
                EXPECT_EQ(b.workers[i].sums.loss, 10 * (group + i));
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
  b.workers.sweep(0, 10, [](Workspace&, int32_t, int32_t) { FAIL(); });
  b.workers.spread(0, [](int32_t) { FAIL(); });
}
