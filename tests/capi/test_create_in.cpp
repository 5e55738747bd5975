// A pool in memory that its caller lends: exactly the bytes that were asked for, at any address, and not one
// more from hooks or heap; the same bytes as any other pool.
#include <algorithm>
#include <cstring>

#include "contract.hpp"
#include "heap_count.hpp"

namespace {

constexpr unsigned char kGuard = 0xa5;

struct Case {
  std::string task;
  std::string settings;
  int32_t worlds, threads;
};

std::vector<Case> cases() {
  std::vector<Case> out;
  for (const std::string& task : task_names()) out.push_back({task, "", 3, 0});
  out.push_back({"hand_over_safe_finger", "", 1, 0});
  out.push_back({"hand_over_safe_finger", "", 5, 3});
  out.push_back({"hand_over_safe_finger", "hand=allegro\narm=ur5e\nmodality=points\npoints=64", 2, 0});
  out.push_back({"grasp", "engine=ode", 3, 2});
  out.push_back({"jenga", "engine=ode", 2, 0});
  out.push_back({"grasp",
                 "object_mass=0.05..0.2\nnoise.object.position=0.01\ndelay.*_tip_*=1..3\naction_delay=2", 2,
                 0});
  return out;
}

// Memory of so many bytes, `off` bytes past a multiple of 64, between guards.
class Lent {
 public:
  Lent(size_t bytes, size_t off) : bytes_(bytes), all_(bytes + 3 * 64, kGuard) {
    const auto at = reinterpret_cast<uintptr_t>(all_.data()) + 63;
    first_ = all_.data() + 63 - at % 64 + off;
  }
  void* data() { return first_; }
  bool guards_stand() const {
    const auto whole = [](const unsigned char* a, const unsigned char* b) {
      return std::all_of(a, b, [](unsigned char c) { return c == kGuard; });
    };
    return whole(all_.data(), first_) && whole(first_ + bytes_, all_.data() + all_.size());
  }

 private:
  size_t bytes_;
  std::vector<unsigned char> all_;
  unsigned char* first_;
};

class CreateIn : public testing::TestWithParam<size_t> {
 protected:
  CreateIn() : test(cases()[GetParam()]), config(pool_config(test.worlds)) {
    config.task = test.task.c_str();
    config.settings = test.settings.c_str();
    config.num_threads = test.threads;
    config.seed = 7;
    config.host = &host.hooks;
  }
  size_t needed() {
    size_t ours = 0, engines = 0;
    EXPECT_EQ(rdm_pool_config_memory(&config, &ours, &engines), RDM_OK) << rdm_last_error();
    EXPECT_EQ(host.calls, 0u);
    return ours;
  }
  // Resets, plays, saves, goes back and on: what all that leaves.
  static std::vector<unsigned char> play(rdm_pool* p) {
    EXPECT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK) << rdm_last_error();
    size_t size = 0;
    EXPECT_EQ(rdm_pool_write_state(p, -1, nullptr, 0, &size), RDM_OK);
    std::vector<unsigned char> state(size);
    for (int i = 0; i < 20; ++i) {
      EXPECT_EQ(rdm_pool_baseline(p, RDM_BASELINE_RANDOM), RDM_OK);
      EXPECT_EQ(rdm_pool_step(p), RDM_OK) << rdm_last_error();
      rdm_result r = RDM_OK;
      if (i == 10) r = rdm_pool_write_state(p, -1, state.data(), size, &size);
      if (i == 15) r = rdm_pool_read_state(p, -1, state.data(), size);
      EXPECT_EQ(r, RDM_OK) << rdm_last_error();
    }
    EXPECT_EQ(rdm_pool_write_state(p, -1, state.data(), size, &size), RDM_OK);
    hash_of(p);
    return state;
  }

  const Case test;
  CountingHost host;
  rdm_pool_config config;
};

TEST_P(CreateIn, TakesTheBytesThatWereAskedForAndNoMore) {
  const size_t bytes = needed();
  std::vector<unsigned char> plain;
  {
    rdm_pool* p = make_pool(config);
    EXPECT_EQ(host.calls, 1u);
    EXPECT_EQ(host.live, bytes);
    plain = play(p);
    rdm_pool_destroy(p);
    EXPECT_EQ(host.calls, 1u);
    EXPECT_EQ(host.live, 0u);
  }
  ASSERT_EQ(rdm_init(&host.hooks), RDM_OK);  // those of the process are not asked either
  for (const size_t off : {0, 1, 63}) {
    Lent lent(bytes, off);
    rdm_pool* p = nullptr;
    EXPECT_EQ(rdm_pool_create_in(&p, &config, lent.data(), bytes - 1), RDM_ERROR_RANGE);
    EXPECT_EQ(p, nullptr);
    EXPECT_STREQ(rdm_last_error(), ("bytes: " + std::to_string(bytes - 1) + " are too few, " +
                                    std::to_string(bytes) + " are needed")
                                       .c_str());
    ASSERT_EQ(rdm_pool_create_in(&p, &config, lent.data(), bytes), RDM_OK) << rdm_last_error();
    const rdm_pool* const first = p;
    EXPECT_EQ(play(p), plain) << off;
    rdm_pool_destroy(p);
    EXPECT_TRUE(lent.guards_stand());
    // what was destroyed is known for it while nobody has used the memory
    rdm_spec spec{};
    spec.struct_size = sizeof spec;
    EXPECT_EQ(rdm_pool_get_spec(first, &spec), RDM_ERROR_ARGUMENT);
    ASSERT_EQ(rdm_pool_create_in(&p, &config, lent.data(), bytes), RDM_OK) << rdm_last_error();
    EXPECT_EQ(play(p), plain);
    rdm_pool_destroy(p);
  }
  rdm_shutdown();
  EXPECT_EQ(host.calls, 1u);
}

// The physics engine's share does not grow with the worlds, but in engine ode; bodies that move by the task
// alone have none.
TEST_P(CreateIn, TakesNothingFromTheHeap) {
  if (test.threads > 0 || test.settings.find("ode") != std::string::npos) return;
  int64_t taken[2];
  for (int32_t k = 0; k < 2; ++k) {
    config.num_envs = 1 + 3 * k;
    config.host = nullptr;
    const size_t bytes = needed();
    Lent lent(bytes, 0);
    rdm_pool* p = nullptr;
    const int64_t before = heap_count();
    ASSERT_EQ(rdm_pool_create_in(&p, &config, lent.data(), bytes), RDM_OK) << rdm_last_error();
    taken[k] = heap_count() - before;
    const std::vector<unsigned char> warm = play(p);
    size_t size = warm.size();
    std::vector<unsigned char> state(size);
    const int64_t made = heap_count();
    EXPECT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
    EXPECT_EQ(rdm_pool_step(p), RDM_OK);
    EXPECT_EQ(rdm_pool_write_state(p, -1, state.data(), size, &size), RDM_OK);
    EXPECT_EQ(rdm_pool_read_state(p, -1, state.data(), size), RDM_OK);
    hash_of(p);
    rdm_pool_destroy(p);
    EXPECT_EQ(heap_count(), made);
    size_t ours = 0, engines = 0;
    EXPECT_EQ(rdm_pool_config_memory(&config, &ours, &engines), RDM_OK);
    EXPECT_TRUE(engines > 0 || taken[k] == 0) << taken[k];
  }
  EXPECT_EQ(taken[0], taken[1]);
}

INSTANTIATE_TEST_SUITE_P(Every, CreateIn, testing::Range(size_t{0}, cases().size()));

TEST(CreateInAny, SizeThatIsTooSmallIsToldAndLeavesNothing) {
  rdm_pool_config c = pool_config(2);
  size_t bytes = 0, last = 0;
  ASSERT_EQ(rdm_pool_config_memory(&c, &bytes, nullptr), RDM_OK);
  const std::string needed = " are too few, " + std::to_string(bytes) + " are needed";
  Lent lent(bytes, 0);
  const int64_t live = heap_blocks();
  for (size_t given = 0; given < bytes; given += 2999, last = given) {
    rdm_pool* p = nullptr;
    ASSERT_EQ(rdm_pool_create_in(&p, &c, lent.data(), given), RDM_ERROR_RANGE) << given;
    ASSERT_EQ(rdm_last_error(), "bytes: " + std::to_string(given) + needed);
    ASSERT_EQ(p, nullptr);
  }
  EXPECT_GT(last, bytes / 2);
  EXPECT_EQ(heap_blocks(), live);
  EXPECT_TRUE(lent.guards_stand());
}

// A host's own threads and log are asked as ever, its memory is not.
TEST(CreateInAny, OtherHooksAreCalled) {
  CountingHost host;
  static int rounds;
  rounds = 0;
  host.hooks.parallel = [](void*, int32_t n, rdm_body body, void* context) {
    ++rounds;
    for (int32_t i = 0; i < n; ++i) body(context, i);
  };
  rdm_pool_config c = pool_config(5);
  c.num_threads = 3;
  c.host = &host.hooks;
  size_t bytes = 0;
  ASSERT_EQ(rdm_pool_config_memory(&c, &bytes, nullptr), RDM_OK);
  EXPECT_EQ(rounds, 0);
  Lent lent(bytes, 9);
  rdm_pool* p = nullptr;
  EXPECT_EQ(rdm_pool_create_in(&p, &c, lent.data(), bytes - 1), RDM_ERROR_RANGE);
  ASSERT_EQ(rdm_pool_create_in(&p, &c, lent.data(), bytes), RDM_OK) << rdm_last_error();
  ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  EXPECT_EQ(rounds, 1);
  EXPECT_EQ(rdm_pool_step(p), RDM_OK);
  EXPECT_EQ(rounds, 2);
  rdm_pool_destroy(p);
  EXPECT_EQ(host.calls, 0u);
}

TEST(CreateInAny, WhatIsWrongIsSaidAsByCreate) {
  std::vector<unsigned char> memory(1 << 20);
  rdm_pool* p = nullptr;
  rdm_pool_config c = pool_config(1);
  EXPECT_EQ(rdm_pool_create_in(nullptr, &c, memory.data(), memory.size()), RDM_ERROR_ARGUMENT);
  EXPECT_STREQ(rdm_last_error(), "out is NULL");
  EXPECT_EQ(rdm_pool_create_in(&p, &c, nullptr, memory.size()), RDM_ERROR_ARGUMENT);
  EXPECT_STREQ(rdm_last_error(), "memory is NULL");
  EXPECT_EQ(rdm_pool_create_in(&p, nullptr, memory.data(), memory.size()), RDM_ERROR_ARGUMENT);
  for (const char* settings : {"no_such=1", "contacts_max=-1", "hand=none"}) {
    c.settings = settings;
    const rdm_result made = rdm_pool_create(&p, &c);
    const std::string text = rdm_last_error();
    EXPECT_NE(made, RDM_OK);
    EXPECT_EQ(rdm_pool_create_in(&p, &c, memory.data(), memory.size()), made);
    EXPECT_EQ(rdm_last_error(), text);
  }
}

// Memory beyond that serves what a pool is given to keep later.
TEST(CreateInAny, WhatIsKeptLaterMustHaveRoomToo) {
  rdm_pool_config c = pool_config(2);
  c.task = "ball_run";
  size_t bytes = 0;
  ASSERT_EQ(rdm_pool_config_memory(&c, &bytes, nullptr), RDM_OK);
  for (const size_t more : {0, 100000}) {
    Lent lent(bytes + more, 5);
    rdm_pool* p = nullptr;
    ASSERT_EQ(rdm_pool_create_in(&p, &c, lent.data(), bytes + more), RDM_OK) << rdm_last_error();
    ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
    rdm_recording_config rc;
    rdm_recording* r = nullptr;
    ASSERT_EQ(rdm_recording_config_init(&rc, sizeof rc), RDM_OK);
    ASSERT_EQ(rdm_recording_config_for_pool(&rc, p), RDM_OK);
    rc.state_stride = 1;
    ASSERT_EQ(rdm_recording_create(&r, &rc), RDM_OK);
    for (int i = 0; i < 50; ++i) {
      ASSERT_EQ(rdm_recording_begin_step(r, p, nullptr, nullptr), RDM_OK);
      ASSERT_EQ(rdm_pool_step(p), RDM_OK);
      ASSERT_EQ(rdm_recording_end_step(r, p, nullptr), RDM_OK);
    }
    const uint64_t before = hash_of(p);
    EXPECT_EQ(rdm_pool_set_starts(p, r, 0.5), more ? RDM_OK : RDM_ERROR_MEMORY) << rdm_last_error();
    EXPECT_EQ(hash_of(p), before);
    EXPECT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
    rdm_recording_destroy(r);
    rdm_pool_destroy(p);
    EXPECT_TRUE(lent.guards_stand());
  }
}

}  // namespace
