// Voxel keys, and the set of those that one scan touches: emptied at no cost, listed in the order they came.
#pragma once
#include <cstdint>
#include <cstring>

#include "base/arena.hpp"

namespace rdm {

// Three 16-bit numbers of a voxel, 32768 at the world's origin.
struct VoxelKey {
  int32_t k[3];
};
inline constexpr int32_t kKeyCount = 65536;

inline uint64_t pack(const VoxelKey& key) {
  return static_cast<uint64_t>(key.k[0]) << 32 | static_cast<uint64_t>(key.k[1]) << 16 |
         static_cast<uint64_t>(key.k[2]);
}
inline VoxelKey unpack(uint64_t packed) {
  return {{static_cast<int32_t>(packed >> 32 & 0xffff), static_cast<int32_t>(packed >> 16 & 0xffff),
           static_cast<int32_t>(packed & 0xffff)}};
}

class KeySet {
 public:
  KeySet() = default;
  // Holds up to `capacity` keys in 24 to 40 bytes each.
  KeySet(Arena& arena, size_t capacity) : capacity_(capacity) {
    while ((size_t{1} << bits_) < 2 * capacity) ++bits_;
    table_ = arena.make<uint64_t>(size_t{1} << bits_);
    list_ = arena.make<uint64_t>(capacity);
  }

  // Adds a key unless it is there or the set is full.
  void add(uint64_t key) {
    const uint64_t entry = key | epoch_ << 48;
    const size_t mask = (size_t{1} << bits_) - 1;
    for (auto at = static_cast<size_t>(key * 0x9e3779b97f4a7c15u >> (64 - bits_));; at = (at + 1) & mask) {
      if (table_[at] == entry) return;
      if (table_[at] >> 48 == epoch_) continue;
      if (full()) return;
      table_[at] = entry;
      list_[size_++] = key;
      return;
    }
  }
  bool full() const { return size_ == capacity_; }
  size_t size() const { return size_; }
  size_t capacity() const { return capacity_; }
  uint64_t operator[](size_t i) const { return list_[i]; }

  // Keeps the first `count` keys.
  void shrink(size_t count) {
    if (++epoch_ > 0xffff) {
      std::memset(table_, 0, sizeof(uint64_t) << bits_);
      epoch_ = 1;
    }
    size_ = 0;
    for (size_t i = 0; i < count; ++i) add(list_[i]);
  }

 private:
  uint64_t *table_ = nullptr, *list_ = nullptr;
  size_t capacity_ = 0, size_ = 0;
  uint64_t epoch_ = 1;
  int bits_ = 1;
};

}  // namespace rdm
