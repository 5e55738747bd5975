// Counts every heap allocation of the test program, and can refuse one, by standing in front of the C
// library's own functions. Include it in one source of a test.
#pragma once
#include <atomic>
#include <cerrno>
#include <cstddef>
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
// False: this call is one to refuse.
inline bool heap_serves() {
  ++heap_calls;
  int64_t left = heap_left.load();
  if (left < 0) return true;
  while (left > 0)
    if (heap_left.compare_exchange_weak(left, left - 1)) return true;
  if (left < 0 || heap_refusals.fetch_sub(1) <= 0) return true;
  ++heap_refused;
  return false;
}
inline void* heap_block(void* p) {
  if (p) ++heap_live;
  return p;
}

extern "C" {
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);
void __libc_free(void*);

void* malloc(size_t size) noexcept {
  if (heap_serves()) return heap_block(__libc_malloc(size));
  errno = ENOMEM;
  return nullptr;
}
void* calloc(size_t count, size_t size) noexcept {
  if (heap_serves()) return heap_block(__libc_calloc(count, size));
  errno = ENOMEM;
  return nullptr;
}
void* realloc(void* p, size_t size) noexcept {
  if (!heap_serves()) {
    errno = ENOMEM;
    return nullptr;
  }
  void* const q = __libc_realloc(p, size);
  if (!p && q) ++heap_live;
  if (p && !q && size == 0) --heap_live;
  return q;
}
void* aligned_alloc(size_t align, size_t size) noexcept {
  if (heap_serves()) return heap_block(__libc_memalign(align, size));
  errno = ENOMEM;
  return nullptr;
}
int posix_memalign(void** out, size_t align, size_t size) noexcept {
  *out = heap_serves() ? heap_block(__libc_memalign(align, size)) : nullptr;
  return *out ? 0 : ENOMEM;
}
void free(void* p) noexcept {
  if (p) --heap_live;
  __libc_free(p);
}
}
#endif
