// What Pool::measure counts is what create takes, and all comes back.
#include <cstdlib>
#include <vector>

#include "tasks/catalog.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

struct CountedHost {
  size_t live = 0, calls = 0, refuse_at = SIZE_MAX;
  HostHooks hooks() {
    HostHooks h;
    h.user = this;
    h.alloc = [](void* user, size_t bytes, size_t align) -> void* {
      auto& c = *static_cast<CountedHost*>(user);
      if (c.calls++ >= c.refuse_at) return nullptr;
      void* p = nullptr;
      if (posix_memalign(&p, align, bytes) != 0) return nullptr;
      c.live += bytes;
      return p;
    };
    h.release = [](void* user, void* p, size_t bytes, size_t) {
      static_cast<CountedHost*>(user)->live -= bytes;
      std::free(p);
    };
    return h;
  }
};

TEST(PoolMemory, IsExact) {
  register_toy();
  register_builtin_tasks();
  constexpr const char* kDisturbed =
      "noise.*position=0.01\nbias.*position=0.1..0.2\ndelay.*action=1..7\ndropout.*=0.1\naction_delay=3";
  for (const char* task : {"toy_push", "hand_over_safe_finger"})
    for (const int32_t envs : {1, 5})
      for (const int32_t threads : {0, 3}) {
        PoolConfig c;
        c.task = task;
        c.num_envs = envs;
        c.num_threads = threads;
        c.settings = threads ? kDisturbed : nullptr;
        MemoryCount count;
        c.hooks = count.hooks();
        size_t engines = 0;
        Pool::measure(c, &count, &engines);
        EXPECT_GT(engines, 0u);
        std::vector<unsigned char> memory(count.bytes());
        MemoryBlock* block = MemoryBlock::make(memory.data(), count.bytes(), {}, false);
        c.hooks = block->hooks();
        Pool* p = Pool::create(c);
        EXPECT_EQ(block->bytes(), count.bytes()) << task << " x " << envs << " on " << threads;
        p->reset(nullptr, nullptr);
        p->step(nullptr);
        EXPECT_EQ(block->bytes(), count.bytes());
        Pool::destroy(p);
        MemoryBlock::end(block);
      }
}

TEST(PoolMemory, ARefusalAtAnyPlaceLosesNothing) {
  register_toy();
  CountedHost host;
  PoolConfig c;
  c.task = "toy_push";
  c.num_envs = 2;
  c.settings = "noise.*=0.1\ndelay.ball.*=2";
  c.hooks = host.hooks();
  for (size_t at = 0;; ++at) {
    host.calls = 0;
    host.refuse_at = at;
    Pool* p = nullptr;
    const Code code = code_of([&] { p = Pool::create(c); });
    if (code == Code::kOk) {
      EXPECT_GT(at, 5u);
      Pool::destroy(p);
      break;
    }
    EXPECT_EQ(code, Code::kMemory);
    EXPECT_EQ(host.live, 0u) << "refused call " << at;
    ASSERT_LT(at, 10000u);
  }
  EXPECT_EQ(host.live, 0u);
}

}  // namespace
}  // namespace rdm::test
