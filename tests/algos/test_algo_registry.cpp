#include <cstdlib>
#include <map>

#include "agents.hpp"
#include "algos/algo_registry.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

// Hooks that count what is taken, and can refuse.
struct Books {
  std::map<void*, size_t> live;
  size_t taken = 0, calls = 0, refuse_at = SIZE_MAX;
  HostHooks hooks() {
    HostHooks h;
    h.user = this;
    h.alloc = [](void* user, size_t bytes, size_t align) -> void* {
      auto* b = static_cast<Books*>(user);
      if (++b->calls >= b->refuse_at) return nullptr;
      void* p = std::aligned_alloc(align, (bytes + align - 1) / align * align);
      b->live[p] = bytes;
      b->taken += bytes;
      return p;
    };
    h.release = [](void* user, void* p, size_t bytes, size_t) {
      auto* b = static_cast<Books*>(user);
      EXPECT_EQ(b->live.at(p), bytes);
      b->live.erase(p);
      std::free(p);
    };
    return h;
  }
};

}  // namespace

TEST(AlgoRegistry, ListAndFind) {
  ASSERT_GT(algo_count(), 0);
  for (int32_t i = 0; i < algo_count(); ++i) {
    EXPECT_EQ(algo_find(algo_at(i).name), i);
    EXPECT_GT(std::strlen(algo_at(i).summary), 10u);
    EXPECT_GT(algo_at(i).num_options, 20);
  }
  EXPECT_STREQ(algo_at(algo_find("PPO-Lag")).name, "ppo_lag");
  EXPECT_EQ(thrown([] { algo_at(algo_count()); }).code, Code::kRange);
  EXPECT_EQ(thrown([] { algo_at(-1); }).code, Code::kRange);
}

TEST(AlgoRegistry, UnknownNamesOfferTheNearest) {
  const Thrown t = thrown([] { algo_find("pp_lag"); });
  EXPECT_EQ(t.code, Code::kNotFound);
  EXPECT_NE(t.text.find("ppo_lag"), std::string::npos) << t.text;
  EXPECT_EQ(thrown([] { algo_find(nullptr); }).code, Code::kArgument);
}

TEST(AlgoRegistry, MemoryIsWhatCreateTakesToTheByte) {
  for (int32_t i = 0; i < algo_count(); ++i) {
    const char* algo = algo_at(i).name;
    for (const int32_t threads : {0, 1, 3}) {
      for (const char* hidden : {"64,64", "16"}) {
        Books books;
        AgentSetup s(algo, 17, 5, 6);
        s.config.cost_dim = 2;
        s.config.num_threads = threads;
        s.config.hooks = books.hooks();
        s.with("hidden", hidden).with("critic_hidden", "20,30").with("horizon", "7");
        const size_t promised = Agent::memory(s.ready());
        EXPECT_TRUE(books.live.empty());
        books.taken = 0;
        AgentPtr a = s.make();
        EXPECT_EQ(books.taken, promised) << algo << " " << threads << " " << hidden;
        NoiseWorld world(s.config);
        world.epoch(*a);
        EXPECT_EQ(books.taken, promised);
        a.reset();
        EXPECT_TRUE(books.live.empty());
      }
    }
  }
}

TEST(AlgoRegistry, RefusedMemoryLeavesNothingBehind) {
  size_t created = 0;
  for (size_t refuse_at = 1; refuse_at < 20; ++refuse_at) {
    Books books;
    books.refuse_at = refuse_at;
    AgentSetup s("ppo_lag", 17, 5, 6);
    s.config.num_threads = 2;
    s.config.hooks = books.hooks();
    const Thrown t = thrown([&] { s.make(); });
    if (t.code == Code::kOk)
      ++created;
    else
      EXPECT_EQ(t.code, Code::kMemory) << refuse_at;
    EXPECT_TRUE(books.live.empty()) << refuse_at;
  }
  EXPECT_GT(created, 5u);
  EXPECT_LT(created, 19u);
}

TEST(AlgoRegistry, DestroyTakesNull) {
  Agent::destroy(nullptr);
}
