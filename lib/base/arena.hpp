// One block of memory, made once, cut into aligned arrays.
//
// The same carving code runs twice: on a measuring arena, which only counts, and on a real one. So the
// number that rdm_*_memory reports is the number that create takes, to the byte.
#pragma once
#include <cstddef>
#include <cstring>
#include <type_traits>

#include "base/host.hpp"

namespace rdm {

class Arena {
 public:
  static constexpr size_t kAlign = 64;
  // What so many bytes take in a block.
  static constexpr size_t padded(size_t bytes) { return (bytes + kAlign - 1) / kAlign * kAlign; }

  Arena() = default;                               // measuring: make() returns null and counts
  Arena(const HostHooks& hooks, size_t capacity);  // one zeroed block of `capacity` bytes
  ~Arena();
  Arena(Arena&& other) noexcept;
  Arena& operator=(Arena&& other) noexcept;
  Arena(const Arena&) = delete;
  Arena& operator=(const Arena&) = delete;

  // `count` zeroed elements, 64-byte aligned; null while measuring. Past the capacity: Error(kInternal).
  template <class T>
  T* make(size_t count) {
    static_assert(std::is_trivially_copyable_v<T> && alignof(T) <= kAlign);
    return static_cast<T*>(take(count * sizeof(T)));
  }

  bool measuring() const { return block_ == nullptr; }
  size_t used() const { return used_; }
  size_t capacity() const { return capacity_; }
  const void* block() const { return block_; }

 private:
  void* take(size_t bytes);
  HostHooks hooks_;
  unsigned char* block_ = nullptr;
  size_t capacity_ = 0, used_ = 0;
};

}  // namespace rdm
