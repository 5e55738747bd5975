#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <thread>
#include <vector>

#include "base/error.hpp"
#include "base/fpmode.hpp"
#include "base/workers.hpp"

namespace rdm {
namespace {

struct Visits {
  explicit Visits(int n) : count(static_cast<size_t>(n), 0), thread(static_cast<size_t>(n)) {}
  std::vector<int> count;
  std::vector<std::thread::id> thread;
  static void body(void* context, int32_t i) {
    auto* v = static_cast<Visits*>(context);
    ++v->count[static_cast<size_t>(i)];
    v->thread[static_cast<size_t>(i)] = std::this_thread::get_id();
  }
  bool all(int times) const {
    return std::all_of(count.begin(), count.end(), [=](int c) { return c == times; });
  }
};

class WorkersOf : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Threads, WorkersOf, testing::Values(0, 1, 2, 4));

TEST_P(WorkersOf, EveryIndexOnceEveryRound) {
  Workers workers(host(), GetParam());
  EXPECT_EQ(workers.width(), std::max(1, GetParam()));
  for (const int n : {0, 1, 2, 3, 7, 64}) {
    Visits visits(n);
    for (int round = 1; round <= 200; ++round) {
      workers.run(n, Visits::body, &visits);
      ASSERT_TRUE(visits.all(round)) << n << " bodies, round " << round;
    }
  }
}

// Pauses that are longer than any thread looks out for: it is asleep, and has to be woken up.
TEST_P(WorkersOf, SleepersAreWoken) {
  struct Slow : Visits {
    using Visits::Visits;
    static void body(void* context, int32_t i) {
      if (i == 1) std::this_thread::sleep_for(std::chrono::milliseconds(2));
      Visits::body(context, i);
    }
  } visits(4);
  Workers workers(host(), GetParam());
  for (int round = 1; round <= 20; ++round) {
    workers.run(4, Slow::body, static_cast<Visits*>(&visits));
    ASSERT_TRUE(visits.all(round)) << "round " << round;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
}

TEST_P(WorkersOf, BodyStaysWithItsThread) {
  const int threads = std::max(1, GetParam());
  Workers workers(host(), GetParam());
  Visits first(40), later(40);
  workers.run(40, Visits::body, &first);
  for (int i = 0; i < 20; ++i) workers.run(40, Visits::body, &later);
  EXPECT_EQ(first.thread, later.thread);
  EXPECT_EQ(first.thread[0], std::this_thread::get_id());
  for (int i = 0; i < 40; ++i)
    for (int j = 0; j < 40; ++j)
      EXPECT_EQ(first.thread[static_cast<size_t>(i)] == first.thread[static_cast<size_t>(j)],
                i % threads == j % threads);
}

TEST_P(WorkersOf, ResultDoesNotDependOnTheThreads) {
  struct Sums {
    double out[33] = {};
    static void body(void* context, int32_t i) {
      double x = 1.0 / (i + 1);
      for (int k = 0; k < 1000; ++k) x += 1e-3 * std::sqrt(x + k);
      static_cast<Sums*>(context)->out[i] = x;
    }
  } serial, parallel;
  for (int32_t i = 0; i < 33; ++i) Sums::body(&serial, i);
  Workers(host(), GetParam()).run(33, Sums::body, &parallel);
  for (int i = 0; i < 33; ++i) EXPECT_EQ(serial.out[i], parallel.out[i]);
}

TEST_P(WorkersOf, PiecesAreAllItemsOnceAndOneAtATimeForAPart) {
  struct Pieces {
    std::vector<std::atomic<int>> items;
    std::atomic<int> busy[4] = {};
    std::atomic<bool> good = true;
    int32_t parts = 1, grain = 1;
    static void body(void* context, int32_t part, int32_t begin, int32_t end) {
      auto* p = static_cast<Pieces*>(context);
      if (part < 0 || part >= p->parts || p->busy[part]++ != 0) p->good = false;
      if (p->parts > 1 && (end <= begin || end - begin > p->grain)) p->good = false;
      for (int32_t i = begin; i < end; ++i) ++p->items[static_cast<size_t>(i)];
      --p->busy[part];
    }
  };
  Workers workers(host(), GetParam());
  for (const int32_t n : {1, 5, 16, 67})
    for (int32_t parts = 1; parts <= std::min(n, workers.width()); ++parts)
      for (const int32_t grain : {1, 4, 100}) {
        Pieces pieces{std::vector<std::atomic<int>>(static_cast<size_t>(n))};
        pieces.parts = parts;
        pieces.grain = grain;
        for (int round = 1; round <= 50; ++round) {
          workers.run_pieces(n, parts, grain, Pieces::body, &pieces);
          ASSERT_TRUE(pieces.good) << n << " in " << parts << " by " << grain;
          for (const auto& times : pieces.items) ASSERT_EQ(times, round);
        }
      }
}

// The first piece lasts until all others are done: some thread has to take what is left of its part.
TEST(Workers, OneThatIsIdleTakesPiecesOfAPartThatLasts) {
  struct Lasting {
    std::atomic<int> done = 0;
    int seen = 0;
    static void body(void* context, int32_t, int32_t begin, int32_t) {
      auto* l = static_cast<Lasting*>(context);
      const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(20);
      while (begin == 0 && l->done < 7 && std::chrono::steady_clock::now() < until) std::this_thread::yield();
      if (begin == 0) l->seen = l->done;
      ++l->done;
    }
  } lasting;
  Workers(host(), 2).run_pieces(8, 2, 1, Lasting::body, &lasting);
  EXPECT_EQ(lasting.seen, 7);
  EXPECT_EQ(lasting.done, 8);
}

TEST(Workers, HostHookTakesTheWork) {
  struct Host {
    int calls = 0;
    int32_t n = 0;
  } spread;
  HostHooks hooks;
  hooks.user = &spread;
  hooks.parallel = [](void* user, int32_t n, ParallelBody body, void* context) {
    auto* host = static_cast<Host*>(user);
    ++host->calls;
    host->n = n;
    std::vector<std::thread> threads;
    for (int32_t i = n - 1; i >= 0; --i) threads.emplace_back(body, context, i);
    for (auto& t : threads) t.join();
  };
  Workers workers(hooks, 4);
  EXPECT_EQ(workers.width(), 4);
  Visits visits(9);
  workers.run(9, Visits::body, &visits);
  EXPECT_TRUE(visits.all(1));
  EXPECT_EQ(spread.calls, 1);
  EXPECT_EQ(spread.n, 9);
}

// Hooks that do not do what they should, each for one round; the next round is a good one.
TEST(Workers, HookThatRunsTooLittleOrTooMuchIsNoticed) {
  using Hook = void (*)(int32_t n, ParallelBody body, void* context);
  const struct {
    const char* text;
    Hook hook;
    int times;  // that index 1 is run
  } cases[] = {
      {"the parallel hook ran 0 of 3 pieces", [](int32_t, ParallelBody, void*) {}, 0},
      {"the parallel hook ran 2 of 3 pieces",
       [](int32_t n, ParallelBody body, void* context) {
         for (int32_t i = 1; i < n; ++i) body(context, i);
       },
       1},
      {"the parallel hook ran index 1 twice",
       [](int32_t n, ParallelBody body, void* context) {
         for (int32_t i = 0; i < n; ++i) body(context, i);
         body(context, 1);
       },
       1},
      {"the parallel hook ran index 3, which is outside [0, 3)",
       [](int32_t n, ParallelBody body, void* context) {
         for (int32_t i = 0; i <= n; ++i) body(context, i);
       },
       1},
      {"the parallel hook ran index -1, which is outside [0, 3)",
       [](int32_t n, ParallelBody body, void* context) {
         for (int32_t i = -1; i < n; ++i) body(context, i);
       },
       1},
      {"the parallel hook threw an exception", [](int32_t, ParallelBody, void*) { throw 1; }, 0},
  };
  static Hook hook;
  HostHooks hooks;
  hooks.parallel = [](void*, int32_t n, ParallelBody body, void* context) { hook(n, body, context); };
  Workers workers(hooks, 3);
  for (const auto& c : cases) {
    Visits visits(3);
    hook = c.hook;
    EXPECT_NE(guard([&] { workers.run(3, Visits::body, &visits); }), Code::kOk) << c.text;
    EXPECT_STREQ(last_error(), c.text);
    EXPECT_EQ(visits.count[1], c.times) << c.text;
    hook = [](int32_t n, ParallelBody body, void* context) {
      for (int32_t i = 0; i < n; ++i) body(context, i);
    };
    Visits good(3);
    EXPECT_EQ(guard([&] { workers.run(3, Visits::body, &good); }), Code::kOk) << last_error();
    EXPECT_TRUE(good.all(1));
  }
}

// Jobs that go on after the hook has returned: those that had begun are waited for, the others do nothing.
TEST(Workers, HookThatReturnsEarlyIsNoticed) {
  struct Jobs {
    std::vector<std::thread> threads;
    std::atomic<bool> begun = false, late = false;
  } jobs;
  HostHooks hooks;
  hooks.user = &jobs;
  hooks.parallel = [](void* user, int32_t, ParallelBody body, void* context) {
    auto* j = static_cast<Jobs*>(user);
    j->threads.emplace_back(body, context, 0);
    j->threads.emplace_back([=] {
      while (!j->late) std::this_thread::yield();
      body(context, 1);
    });
    while (!j->begun) std::this_thread::yield();
  };
  struct Work {
    Jobs* jobs;
    std::atomic<int> ended{0};
  } work{&jobs};
  Workers workers(hooks, 2);
  const ParallelBody body = [](void* context, int32_t) {
    auto* w = static_cast<Work*>(context);
    w->jobs->begun = true;
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    ++w->ended;
  };
  EXPECT_EQ(guard([&] { workers.run(2, body, &work); }), Code::kState);
  EXPECT_STREQ(last_error(), "the parallel hook returned while 1 of 2 pieces were still running");
  EXPECT_EQ(work.ended, 1);
  jobs.late = true;
  for (std::thread& t : jobs.threads) t.join();
  EXPECT_EQ(work.ended, 1);
}

#if defined(__SSE2__)
void write_mode(void* context, int32_t i) {
  static_cast<unsigned*>(context)[i] = _mm_getcsr() & 0xFFC0u;
}

TEST(Workers, BodiesRunInTheLibrarysFloatingPointMode) {
  unsigned modes[8] = {};
  Workers(host(), 4).run(8, write_mode, modes);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(modes[i], 0x9FC0u) << i;

  HostHooks hooks;
  hooks.parallel = [](void*, int32_t n, ParallelBody body, void* context) {
    for (int32_t i = 0; i < n; ++i) body(context, i);
  };
  std::fill(modes, modes + 8, 0u);
  const unsigned before = _mm_getcsr();
  Workers(hooks, 2).run(8, write_mode, modes);
  for (int i = 0; i < 8; ++i) EXPECT_EQ(modes[i], 0x9FC0u) << i;
  EXPECT_EQ(_mm_getcsr() & 0xFFC0u, before & 0xFFC0u);
}
#endif

#if !defined(__SANITIZE_THREAD__)  // a forked child may not start threads under the thread sanitizer
TEST(Workers, ForkedChildIsToldAndCanMakeItsOwn) {
  Workers workers(host(), 2);
  Visits visits(4);
  workers.run(4, Visits::body, &visits);
  const pid_t child = fork();
  if (child == 0) {
    const bool told = guard([&] { workers.run(4, Visits::body, &visits); }) == Code::kState;
    Visits own(4);
    Workers(host(), 2).run(4, Visits::body, &own);
    { Workers moved_along(host(), 1); }
    _exit(told && own.all(1) && visits.all(1) ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
  workers.run(4, Visits::body, &visits);
  EXPECT_TRUE(visits.all(2));
}

TEST(Workers, SerialPoolSurvivesFork) {
  Workers workers(host(), 0);
  const pid_t child = fork();
  if (child == 0) {
    Visits own(4);
    workers.run(4, Visits::body, &own);
    _exit(own.all(1) ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << status;
}
#endif

}  // namespace
}  // namespace rdm
