#include "base/arena.hpp"

#include <utility>

#include "base/error.hpp"

namespace rdm {

Arena::Arena(const HostHooks& hooks, size_t capacity) : hooks_(hooks), capacity_(capacity) {
  block_ = static_cast<unsigned char*>(host_alloc(hooks_, capacity, kAlign));
  std::memset(block_, 0, capacity);
}

Arena::~Arena() {
  if (block_) host_release(hooks_, block_, capacity_, kAlign);
}

Arena::Arena(Arena&& other) noexcept {
  *this = std::move(other);
}

Arena& Arena::operator=(Arena&& other) noexcept {
  std::swap(hooks_, other.hooks_);
  std::swap(block_, other.block_);
  std::swap(capacity_, other.capacity_);
  std::swap(used_, other.used_);
  return *this;
}

void* Arena::take(size_t bytes) {
  const size_t at = used_;
  used_ += padded(bytes);
  if (!block_) return nullptr;
  if (used_ > capacity_)
    fail(Code::kInternal, "arena of %zu bytes asked for %zu: measured and allocated sizes differ", capacity_,
         used_);
  return block_ + at;
}

}  // namespace rdm
