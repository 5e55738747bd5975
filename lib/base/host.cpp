#include "base/host.hpp"

#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <new>
#if defined(_WIN32)
#include <malloc.h>
#endif

#include "base/error.hpp"
#include "base/format.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {
// The C library's; null when it has no more.
void* aligned_block(size_t bytes, size_t align) {
#if defined(_WIN32)
  return _aligned_malloc(bytes, align);
#else
  void* p = nullptr;
  return posix_memalign(&p, align, bytes) == 0 ? p : nullptr;
#endif
}
void free_aligned_block(void* p) {
#if defined(_WIN32)
  _aligned_free(p);
#else
  std::free(p);
#endif
}

std::mutex g_mutex;
HostHooks g_host;
thread_local const HostHooks* t_scope = nullptr;
}  // namespace

HostHooks host() {
  if (t_scope) return *t_scope;
  const std::lock_guard lock(g_mutex);
  return g_host;
}
HostScope::HostScope(const HostHooks& hooks) : hooks_(hooks), outer_(t_scope) {
  t_scope = &hooks_;
}
HostScope::~HostScope() {
  t_scope = outer_;
}
void set_host(const HostHooks& hooks) {
  const std::lock_guard lock(g_mutex);
  g_host = hooks;
}

void* host_alloc(const HostHooks& hooks, size_t bytes, size_t align) {
  if (bytes == 0) bytes = 1;
  if (align < sizeof(void*)) align = sizeof(void*);
  void* const p = hooks.alloc ? hooks.alloc(hooks.user, bytes, align) : aligned_block(bytes, align);
  if (!p) fail(Code::kMemory, "out of memory: %zu bytes could not be allocated", bytes);
  return p;
}

void host_release(const HostHooks& hooks, void* p, size_t bytes, size_t align) noexcept {
  if (!p) return;
  if (bytes == 0) bytes = 1;
  if (align < sizeof(void*)) align = sizeof(void*);
  if (hooks.alloc)
    hooks.release(hooks.user, p, bytes, align);
  else
    free_aligned_block(p);
}

void log(const HostHooks& hooks, LogLevel level, const char* format, ...) {
  if (!hooks.log) return;
  char raw[512 + 4], line[512];  // a character that is cut in the first does not fit into the second
  va_list args;
  va_start(args, format);
  print_list(raw, sizeof raw, format, args);
  va_end(args);
  clean_text(line, sizeof line, raw);
  hooks.log(hooks.user, static_cast<int32_t>(level), line);
}

}  // namespace rdm
