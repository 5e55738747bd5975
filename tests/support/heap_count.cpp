#include "heap_count.hpp"

#include <cerrno>
#include <cstddef>

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
namespace {

// False: this call is one to refuse.
bool heap_serves() {
  ++heap_calls;
  int64_t left = heap_left.load();
  if (left < 0) return true;
  while (left > 0)
    if (heap_left.compare_exchange_weak(left, left - 1)) return true;
  if (left < 0 || heap_refusals.fetch_sub(1) <= 0) return true;
  ++heap_refused;
  return false;
}
void* heap_block(void* p) {
  if (p) ++heap_live;
  return p;
}

}  // namespace

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
