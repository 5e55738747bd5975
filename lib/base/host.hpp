// What a host may take over: memory, log lines, and the spreading of work over its own threads.
#pragma once
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

namespace rdm {

using ParallelBody = void (*)(void* context, int32_t index);

inline constexpr int32_t kMaxRanks = 4096;  // processes that learn together

struct HostHooks {
  void* user = nullptr;
  void* (*alloc)(void* user, size_t bytes, size_t align) = nullptr;            // null: the C library's
  void (*release)(void* user, void* p, size_t bytes, size_t align) = nullptr;  // comes with alloc
  void (*log)(void* user, int32_t level, const char* line) = nullptr;          // null: silent
  // Runs body(context, i) once for every i in [0, n), each on one OS thread, and returns when all are
  // done. Serial execution is allowed. Null: the library's own workers.
  void (*parallel)(void* user, int32_t n, ParallelBody body, void* context) = nullptr;
};

// The hooks in force: those of the innermost HostScope of this thread, else the process-wide ones.
// A handle copies them when it is made.
HostHooks host();
// May run beside host() on other threads: each of them gets the old hooks or the new ones, whole.
void set_host(const HostHooks& hooks);

// While it lives, containers made on this thread take memory from the hooks of one handle.
class HostScope {
 public:
  explicit HostScope(const HostHooks& hooks);
  ~HostScope();
  HostScope(const HostScope&) = delete;
  HostScope& operator=(const HostScope&) = delete;

 private:
  HostHooks hooks_;
  const HostHooks* outer_;
};

// Throws Error(kMemory) when the host has none left. Zero bytes give a non-null pointer.
void* host_alloc(const HostHooks& hooks, size_t bytes, size_t align);
void host_release(const HostHooks& hooks, void* p, size_t bytes, size_t align) noexcept;

enum class LogLevel : int32_t { kInfo = 0, kWarning = 1, kError = 2 };
[[gnu::format(printf, 3, 4)]] void log(const HostHooks& hooks, LogLevel level, const char* format, ...);

// Objects of the library live in host memory: make with host_new, end with host_delete.
template <class T, class... Args>
T* host_new(const HostHooks& hooks, Args&&... args) {
  void* p = host_alloc(hooks, sizeof(T), alignof(T));
  try {
    return new (p) T(std::forward<Args>(args)...);
  } catch (...) {
    host_release(hooks, p, sizeof(T), alignof(T));
    throw;
  }
}
template <class T>
void host_delete(const HostHooks& hooks, T* p) noexcept {
  if (!p) return;
  const HostHooks copy = hooks;  // the hooks may live inside *p
  p->~T();
  host_release(copy, p, sizeof(T), alignof(T));
}

// std allocator over the hooks in force, for containers that are filled while something is made.
template <class T>
struct HostAllocator {
  using value_type = T;
  HostAllocator() = default;
  template <class U>
  HostAllocator(const HostAllocator<U>& other) : hooks(other.hooks) {}
  T* allocate(size_t n) { return static_cast<T*>(host_alloc(hooks, n * sizeof(T), alignof(T))); }
  void deallocate(T* p, size_t n) noexcept { host_release(hooks, p, n * sizeof(T), alignof(T)); }
  template <class U>
  bool operator==(const HostAllocator<U>& o) const {
    return hooks.alloc == o.hooks.alloc && hooks.user == o.hooks.user;
  }
  HostHooks hooks = host();
};
template <class T>
using Vector = std::vector<T, HostAllocator<T>>;

}  // namespace rdm
