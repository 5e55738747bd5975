// FNV-1a over raw bytes: the fingerprint of a state.
#pragma once
#include <cstddef>
#include <cstdint>

namespace rdm {

inline constexpr uint64_t kHashSeed = 14695981039346656037ull;

inline uint64_t hash_bytes(const void* data, size_t size, uint64_t hash = kHashSeed) {
  const auto* p = static_cast<const unsigned char*>(data);
  for (size_t i = 0; i < size; ++i) hash = (hash ^ p[i]) * 1099511628211ull;
  return hash;
}

}  // namespace rdm
