// The memory of one handle as one block: a caller's, or what its alloc hook gives at once.
//
// Places within it are given out first fit, the lowest first, in pieces of kGrain bytes. They follow from the
// order of taking and giving alone, so that a count without the memory tells what a block must have.
#pragma once
#include <mutex>

#include "base/arena.hpp"
#include "base/host.hpp"

namespace rdm {

// Which bytes are taken; the bytes themselves are not looked at.
class Places {
 public:
  static constexpr size_t kGrain = Arena::kAlign, kNone = SIZE_MAX;

  explicit Places(size_t capacity) : capacity_(capacity) {}
  size_t take(size_t bytes);  // where they begin; kNone: there is no room
  void give(size_t at, size_t bytes);
  size_t most() const { return most_; }  // the highest end so far

 private:
  static constexpr int32_t kMostGaps = 64;  // what would be one more is lost
  struct Gap {
    size_t begin, end;
  };
  Gap gaps_[kMostGaps];  // [num_gaps_] free, ascending, below top_; none touches another or top_
  int32_t num_gaps_ = 0;
  size_t capacity_, top_ = 0, most_ = 0;
};

class MemoryBlock {
 public:
  // Lies at the beginning of memory [bytes] of any alignment; null: there is not even room for that. Lines
  // and parallel work go to `host`; with `spills`, so does what the block has no room for.
  static MemoryBlock* make(void* memory, size_t bytes, const HostHooks& host, bool spills);
  // The memory stays whose it is.
  static void end(MemoryBlock* block);

  HostHooks hooks();
  const HostHooks& host() const { return host_; }
  bool refused() const { return refused_; }  // something had no room
  size_t bytes() const;                      // that make needs for the most that was taken at a time so far

 private:
  friend class MemoryCount;
  MemoryBlock(unsigned char* first, size_t capacity, const HostHooks& host, bool spills)
      : first_(first), capacity_(capacity), host_(host), spills_(spills), places_(capacity) {}
  static size_t head();  // bytes before the first place, wherever the memory begins
  void* take(size_t bytes, size_t align);
  void give(void* p, size_t bytes, size_t align);

  unsigned char* first_;
  size_t capacity_;
  HostHooks host_;
  bool spills_, refused_ = false;
  std::mutex mutex_;
  Places places_;
};

// Takes and gives as a block does, with memory of the C library.
class MemoryCount {
 public:
  HostHooks hooks();
  void take(size_t bytes);  // what would be taken and stay
  size_t bytes() const;     // that MemoryBlock::make needs for what was taken so far

 private:
  Places places_{Places::kNone};
};

}  // namespace rdm
