// Places within one block: where they are, what they take, and what a count without the memory says of both.
#include <gtest/gtest.h>

#include <cstring>
#include <map>

#include "base/error.hpp"
#include "base/memory_block.hpp"
#include "base/rng.hpp"

namespace rdm::test {
namespace {

constexpr size_t kGrain = Places::kGrain;

TEST(Places, FirstFitAndGapsJoin) {
  Places p(10 * kGrain);
  EXPECT_EQ(p.take(1), 0u);
  EXPECT_EQ(p.take(kGrain + 1), kGrain);
  EXPECT_EQ(p.take(3 * kGrain), 3 * kGrain);
  EXPECT_EQ(p.take(kGrain), 6 * kGrain);
  EXPECT_EQ(p.most(), 7 * kGrain);
  p.give(0, 1);
  p.give(3 * kGrain, 3 * kGrain);
  EXPECT_EQ(p.take(2 * kGrain), 3 * kGrain);  // the first gap is too small
  p.give(kGrain, kGrain + 1);                 // joins the first
  EXPECT_EQ(p.take(3 * kGrain), 0u);
  EXPECT_EQ(p.take(kGrain), 5 * kGrain);
  EXPECT_EQ(p.most(), 7 * kGrain);
  EXPECT_EQ(p.take(4 * kGrain), Places::kNone);
  EXPECT_EQ(p.take(3 * kGrain), 7 * kGrain);
  EXPECT_EQ(p.take(1), Places::kNone);
  EXPECT_EQ(p.take(SIZE_MAX), Places::kNone);
}

TEST(Places, NothingIsGivenTwiceAndAllComesBack) {
  Places p(Places::kNone);
  std::map<size_t, size_t> taken;  // where, how many
  Stream draw(3, 0, Purpose::kReset);
  for (int i = 0; i < 20000; ++i) {
    if (taken.size() < 40 && (taken.empty() || draw.uniform() < 0.5)) {
      const size_t bytes = 1 + draw.below(2000), at = p.take(bytes);
      const auto next = taken.lower_bound(at);
      ASSERT_TRUE(next == taken.end() || at + bytes <= next->first);
      if (next != taken.begin()) {
        const auto before = std::prev(next);
        ASSERT_LE(before->first + before->second, at);
      }
      ASSERT_EQ(at % kGrain, 0u);
      taken[at] = bytes;
    } else {
      auto it = taken.begin();
      std::advance(it, draw.below(static_cast<uint32_t>(taken.size())));
      p.give(it->first, it->second);
      taken.erase(it);
    }
  }
  const size_t most = p.most();
  EXPECT_LT(most, size_t{40} * 2048 * 2);
  for (const auto& [at, bytes] : taken) p.give(at, bytes);
  EXPECT_EQ(p.take(most), 0u);
  EXPECT_EQ(p.most(), most);
}

// More gaps than there is room to note: those beyond are lost, none is given twice.
TEST(Places, ManyGapsCostRoomAlone) {
  Places p(Places::kNone);
  for (size_t i = 0; i < 400; ++i) ASSERT_EQ(p.take(kGrain), i * kGrain);
  for (size_t i = 0; i < 400; i += 2) p.give(i * kGrain, kGrain);
  size_t again = 0;
  while (p.take(kGrain) < 400 * kGrain) ++again;
  EXPECT_GE(again, 64u);
  EXPECT_LE(again, 200u);
}

// What containers do when they are filled.
void fill(const HostHooks& hooks, const char* text) {
  const HostScope scope(hooks);
  Vector<Vector<int>> rows;
  for (int i = 0; i < 20; ++i) {
    rows.emplace_back();
    for (int k = 0; k < 7 * i; ++k) rows.back().push_back(k);
    if (i % 3 == 0) rows.erase(rows.begin());
  }
  void* const p = host_alloc(hooks, 1000, 64);
  EXPECT_EQ(reinterpret_cast<uintptr_t>(p) % 64, 0u) << text;
  std::memset(p, 0xff, 1000);
  host_release(hooks, p, 1000, 64);
}

TEST(MemoryBlock, TakesWhatWasCountedAndNotAByteLess) {
  MemoryCount count;
  fill(count.hooks(), "count");
  const size_t bytes = count.bytes();
  ASSERT_GT(bytes, 3000u);
  std::vector<unsigned char> memory(bytes + 65, 0xa5);
  for (size_t off = 0; off < 64; off += 7) {
    MemoryBlock* block = MemoryBlock::make(memory.data() + off, bytes, {}, false);
    fill(block->hooks(), "block");
    EXPECT_FALSE(block->refused());
    EXPECT_EQ(block->bytes(), bytes);
    MemoryBlock::end(block);
    EXPECT_EQ(memory[off + bytes], 0xa5);
    block = MemoryBlock::make(memory.data() + off, bytes - 1, {}, false);
    EXPECT_THROW(fill(block->hooks(), "small"), Error);
    EXPECT_TRUE(block->refused());
    MemoryBlock::end(block);
  }
  EXPECT_EQ(MemoryBlock::make(memory.data(), 0, {}, false), nullptr);
  MemoryBlock* const block = MemoryBlock::make(memory.data(), 3000, {}, true);  // the rest is the C library's
  fill(block->hooks(), "spills");
  EXPECT_TRUE(block->refused());
  MemoryBlock::end(block);
}

TEST(MemoryBlock, PassesLinesAndWorkOn) {
  struct Host {
    int lines = 0, rounds = 0;
  } own;
  HostHooks host;
  host.user = &own;
  host.log = [](void* user, int32_t, const char*) { ++static_cast<Host*>(user)->lines; };
  host.parallel = [](void* user, int32_t n, ParallelBody body, void* context) {
    ++static_cast<Host*>(user)->rounds;
    for (int32_t i = 0; i < n; ++i) body(context, i);
  };
  std::vector<unsigned char> memory(10000);
  MemoryBlock* const block = MemoryBlock::make(memory.data(), memory.size(), host, false);
  const HostHooks hooks = block->hooks();
  log(hooks, LogLevel::kInfo, "one");
  int sum = 0;
  hooks.parallel(
      hooks.user, 3, [](void* context, int32_t i) { *static_cast<int*>(context) += i; }, &sum);
  EXPECT_EQ(own.lines, 1);
  EXPECT_EQ(own.rounds, 1);
  EXPECT_EQ(sum, 3);
  MemoryBlock::end(block);
  MemoryBlock* const silent = MemoryBlock::make(memory.data(), memory.size(), {}, false);
  EXPECT_EQ(silent->hooks().log, nullptr);
  EXPECT_EQ(silent->hooks().parallel, nullptr);
  MemoryBlock::end(silent);
}

}  // namespace
}  // namespace rdm::test
