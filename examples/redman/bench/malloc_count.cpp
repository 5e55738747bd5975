#include "bench/malloc_count.hpp"

#include <atomic>
#include <cerrno>
#include <cstddef>

// A sanitizer has an allocator of its own. GCC says by a macro that there is one, clang by a feature.
#if defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer) || __has_feature(memory_sanitizer)
#define TOOL_SANITIZED
#endif
#elif defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define TOOL_SANITIZED
#endif

#if defined(TOOL_SANITIZED) || !defined(__GLIBC__)

int64_t tool::allocation_count() {
  return -1;
}

#else

namespace {
std::atomic<int64_t> g_count{0};
void count() {
  g_count.fetch_add(1, std::memory_order_relaxed);
}
}  // namespace

int64_t tool::allocation_count() {
  return g_count.load();
}

// glibc's own names for its allocator. Shared libraries of the process call these too.
extern "C" {
void* __libc_malloc(size_t bytes);
void* __libc_calloc(size_t count, size_t bytes);
void* __libc_realloc(void* p, size_t bytes);
void* __libc_memalign(size_t align, size_t bytes);
void __libc_free(void* p);

void* malloc(size_t bytes) {
  count();
  return __libc_malloc(bytes);
}
void* calloc(size_t n, size_t bytes) {
  count();
  return __libc_calloc(n, bytes);
}
void* realloc(void* p, size_t bytes) {
  count();
  return __libc_realloc(p, bytes);
}
void* memalign(size_t align, size_t bytes) {
  count();
  return __libc_memalign(align, bytes);
}
void* aligned_alloc(size_t align, size_t bytes) {
  count();
  return __libc_memalign(align, bytes);
}
int posix_memalign(void** out, size_t align, size_t bytes) {
  count();
  if (align % sizeof(void*) != 0 || (align & (align - 1)) != 0) return EINVAL;
  void* p = __libc_memalign(align, bytes);
  if (!p) return ENOMEM;
  *out = p;
  return 0;
}
void free(void* p) {
  __libc_free(p);
}
}

#endif
