#include "base/memory_block.hpp"

#include <algorithm>
#include <cstring>
#include <new>

#include "base/error.hpp"

namespace rdm {
namespace {

constexpr size_t kGrain = Places::kGrain;

}  // namespace

size_t Places::take(size_t bytes) {
  const size_t n = Arena::padded(bytes);
  if (n < bytes) return kNone;
  for (Gap* g = gaps_; g < gaps_ + num_gaps_; ++g) {
    if (g->end - g->begin < n) continue;
    const size_t at = g->begin;
    g->begin += n;
    if (g->begin == g->end) {
      std::copy(g + 1, gaps_ + num_gaps_, g);
      --num_gaps_;
    }
    return at;
  }
  if (n > capacity_ - top_) return kNone;
  const size_t at = top_;
  top_ += n;
  most_ = std::max(most_, top_);
  return at;
}

void Places::give(size_t at, size_t bytes) {
  size_t end = at + Arena::padded(bytes);
  Gap* const last = gaps_ + num_gaps_;
  Gap* after = std::find_if(gaps_, last, [at](const Gap& g) { return g.begin > at; });
  Gap* before = after > gaps_ && after[-1].end == at ? after - 1 : nullptr;
  const bool joins = after < last && after->begin == end;
  if (joins) end = after->end;
  if (before) {
    before->end = end;
    if (joins) std::copy(after + 1, last, after), --num_gaps_;
  } else if (joins) {
    after->begin = at;
  } else if (end != top_ && num_gaps_ < kMostGaps) {
    std::copy_backward(after, last, last + 1);
    *after = {at, end};
    ++num_gaps_;
  } else if (end == top_) {
    top_ = at;
  }
  if (num_gaps_ > 0 && gaps_[num_gaps_ - 1].end == top_) top_ = gaps_[--num_gaps_].begin;
}

size_t MemoryBlock::head() {
  return Arena::padded(sizeof(MemoryBlock)) + kGrain - 1;
}

MemoryBlock* MemoryBlock::make(void* memory, size_t bytes, const HostHooks& host, bool spills) {
  if (bytes < head()) return nullptr;
  const size_t off = (kGrain - reinterpret_cast<uintptr_t>(memory) % kGrain) % kGrain;
  auto* const at = static_cast<unsigned char*>(memory) + off;
  return new (at) MemoryBlock(at + Arena::padded(sizeof(MemoryBlock)), bytes - head(), host, spills);
}

size_t MemoryBlock::bytes() const {
  return head() + places_.most();
}

void MemoryBlock::end(MemoryBlock* block) {
  block->~MemoryBlock();
}

void* MemoryBlock::take(size_t bytes, size_t align) {
  size_t at = Places::kNone;
  {
    const std::lock_guard lock(mutex_);
    at = places_.take(bytes);
    refused_ = refused_ || at == Places::kNone;
  }
  if (at != Places::kNone) return first_ + at;
  return spills_ ? host_alloc(host_, bytes, align) : nullptr;
}

void MemoryBlock::give(void* p, size_t bytes, size_t align) {
  const auto at = reinterpret_cast<uintptr_t>(p) - reinterpret_cast<uintptr_t>(first_);
  if (at >= capacity_) return host_release(host_, p, bytes, align);
  const std::lock_guard lock(mutex_);
  places_.give(at, bytes);
}

HostHooks MemoryBlock::hooks() {
  HostHooks h;
  h.user = this;
  h.alloc = [](void* user, size_t bytes, size_t align) {
    return static_cast<MemoryBlock*>(user)->take(bytes, align);
  };
  h.release = [](void* user, void* p, size_t bytes, size_t align) {
    static_cast<MemoryBlock*>(user)->give(p, bytes, align);
  };
  if (host_.log)
    h.log = [](void* user, int32_t level, const char* line) {
      const HostHooks& to = static_cast<MemoryBlock*>(user)->host_;
      to.log(to.user, level, line);
    };
  if (host_.parallel)
    h.parallel = [](void* user, int32_t n, ParallelBody body, void* context) {
      const HostHooks& to = static_cast<MemoryBlock*>(user)->host_;
      to.parallel(to.user, n, body, context);
    };
  return h;
}

void MemoryCount::take(size_t bytes) {
  places_.take(bytes > 0 ? bytes : 1);
}

size_t MemoryCount::bytes() const {
  return MemoryBlock::head() + places_.most();
}

// Where a block's place would be stands before what the C library gave.
HostHooks MemoryCount::hooks() {
  HostHooks h;
  h.user = this;
  h.alloc = [](void* user, size_t bytes, size_t) -> void* {
    auto* const p = static_cast<unsigned char*>(host_alloc({}, kGrain + bytes, kGrain));
    const size_t at = static_cast<MemoryCount*>(user)->places_.take(bytes);
    std::memcpy(p, &at, sizeof at);
    return p + kGrain;
  };
  h.release = [](void* user, void* p, size_t bytes, size_t) {
    auto* const begin = static_cast<unsigned char*>(p) - kGrain;
    size_t at = 0;
    std::memcpy(&at, begin, sizeof at);
    static_cast<MemoryCount*>(user)->places_.give(at, bytes);
    host_release({}, begin, kGrain + bytes, kGrain);
  };
  return h;
}

}  // namespace rdm
