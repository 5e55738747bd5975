#include <gtest/gtest.h>

#include <cstdlib>
#include <utility>

#include "base/arena.hpp"
#include "base/error.hpp"

namespace rdm {
namespace {

struct Carved {
  float* obs;
  double* state;
  unsigned char* flags;
};
Carved carve(Arena& arena) {
  return {arena.make<float>(37), arena.make<double>(1), arena.make<unsigned char>(65)};
}

TEST(Arena, MeasuringCountsWhatCarvingTakes) {
  Arena measure;
  const Carved none = carve(measure);
  EXPECT_TRUE(measure.measuring());
  EXPECT_EQ(none.obs, nullptr);
  EXPECT_EQ(measure.used(), 192u + 64u + 128u);

  Arena real(host(), measure.used());
  carve(real);
  EXPECT_FALSE(real.measuring());
  EXPECT_EQ(real.used(), real.capacity());
}

TEST(Arena, ArraysAreAlignedZeroedAndApart) {
  Arena arena(host(), 4096);
  const Carved c = carve(arena);
  for (const void* p : {static_cast<void*>(c.obs), static_cast<void*>(c.state), static_cast<void*>(c.flags)})
    EXPECT_EQ(reinterpret_cast<uintptr_t>(p) % Arena::kAlign, 0u);
  for (int i = 0; i < 37; ++i) EXPECT_EQ(c.obs[i], 0.0f);
  for (int i = 0; i < 37; ++i) c.obs[i] = -1;
  EXPECT_EQ(*c.state, 0.0);
  for (int i = 0; i < 65; ++i) EXPECT_EQ(c.flags[i], 0);
}

TEST(Arena, PastTheCapacityIsAnError) {
  Arena arena(host(), 64);
  arena.make<float>(16);
  try {
    arena.make<float>(1);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code, Code::kInternal);
  }
}

TEST(Arena, MoveKeepsTheBlockAndReleasesItOnce) {
  struct Count {
    int live = 0, made = 0;
  } count;
  HostHooks hooks;
  hooks.user = &count;
  hooks.alloc = [](void* user, size_t bytes, size_t align) -> void* {
    ++static_cast<Count*>(user)->live;
    ++static_cast<Count*>(user)->made;
    return std::aligned_alloc(align, (bytes + align - 1) / align * align);
  };
  hooks.release = [](void* user, void* p, size_t bytes, size_t align) {
    --static_cast<Count*>(user)->live;
    EXPECT_EQ(bytes, 256u);
    EXPECT_EQ(align, Arena::kAlign);
    std::free(p);
  };
  {
    Arena a(hooks, 256);
    double* x = a.make<double>(3);
    x[2] = 7;
    Arena b(std::move(a));
    EXPECT_EQ(b.used(), 64u);
    EXPECT_EQ(x[2], 7);
    Arena c;
    c = std::move(b);
    EXPECT_EQ(c.block(), x);
    EXPECT_EQ(count.live, 1);
  }
  EXPECT_EQ(count.live, 0);
  EXPECT_EQ(count.made, 1);
}

TEST(Arena, HostWithoutMemoryIsAnError) {
  HostHooks hooks;
  hooks.alloc = [](void*, size_t, size_t) -> void* { return nullptr; };
  hooks.release = [](void*, void*, size_t, size_t) {};
  try {
    Arena arena(hooks, 64);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code, Code::kMemory);
  }
}

}  // namespace
}  // namespace rdm
