// Counts every heap allocation of the test program, by standing in front of the C library's own functions.
// Include it in one source of a test.
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
#else
inline constexpr bool kHeapIsCounted = true;
inline std::atomic<int64_t> heap_calls{0};
// Calls so far of malloc and its kin in this process, those of operator new included.
inline int64_t heap_count() {
  return heap_calls.load();
}

extern "C" {
void* __libc_malloc(size_t);
void* __libc_calloc(size_t, size_t);
void* __libc_realloc(void*, size_t);
void* __libc_memalign(size_t, size_t);

void* malloc(size_t size) noexcept {
  ++heap_calls;
  return __libc_malloc(size);
}
void* calloc(size_t count, size_t size) noexcept {
  ++heap_calls;
  return __libc_calloc(count, size);
}
void* realloc(void* p, size_t size) noexcept {
  ++heap_calls;
  return __libc_realloc(p, size);
}
void* aligned_alloc(size_t align, size_t size) noexcept {
  ++heap_calls;
  return __libc_memalign(align, size);
}
int posix_memalign(void** out, size_t align, size_t size) noexcept {
  ++heap_calls;
  *out = __libc_memalign(align, size);
  return *out ? 0 : ENOMEM;
}
}
#endif
