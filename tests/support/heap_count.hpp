// Counts every heap allocation of the test program, and can refuse one: heap_count.cpp, which such programs have, stands
// in front of the C library's own functions.
#pragma once
#include <atomic>
#include <cstdint>

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kHeapIsCounted = false;
inline int64_t heap_count() {
  return 0;
}
inline int64_t heap_blocks() {
  return 0;
}
inline void refuse_heap(int64_t, int64_t = 1) {}
inline bool allow_heap() {
  return false;
}
#else
inline constexpr bool kHeapIsCounted = true;
inline std::atomic<int64_t> heap_calls{0}, heap_live{0};
inline std::atomic<int64_t> heap_left{-1}, heap_refusals{0}, heap_refused{0};  // see refuse_heap
// Calls so far of malloc and its kin in this process, those of operator new included.
inline int64_t heap_count() {
  return heap_calls.load();
}
// Blocks that nobody has freed yet.
inline int64_t heap_blocks() {
  return heap_live.load();
}
// From now on `after` calls are served and then `count` refused, those of all threads together.
inline void refuse_heap(int64_t after, int64_t count = 1) {
  heap_refusals = count;
  heap_refused = 0;
  heap_left = after;
}
// Ends that. True when a call was refused.
inline bool allow_heap() {
  heap_left = -1;
  return heap_refused > 0;
}
#endif
