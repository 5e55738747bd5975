// Changed ZIP files made whole: readers check the members' checksums first.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace hard {

inline uint32_t crc(const unsigned char* p, size_t size) {
  uint32_t c = ~0u;
  for (size_t i = 0; i < size; ++i) {
    c ^= p[i];
    for (int k = 0; k < 8; ++k) c = (c >> 1) ^ (c & 1 ? 0xedb88320u : 0);
  }
  return ~c;
}

// The checksums of the directory and of the members' heads become those of the bytes that stand in the
// members.
inline void mend_zip(unsigned char* data, size_t size) {
  const auto word = [&](size_t at) {
    uint32_t v = 0;
    if (at + sizeof v <= size) std::memcpy(&v, data + at, sizeof v);
    return v;
  };
  for (size_t at = 0; at + 46 <= size; ++at) {
    if (word(at) != 0x02014b50) continue;
    const size_t local = word(at + 42), length = word(at + 20);
    if (local + 30 > size) continue;
    const size_t begin = local + 30 + (word(local + 26) & 0xffff) + (word(local + 28) & 0xffff);
    if (begin > size || length > size - begin) continue;
    const uint32_t checksum = crc(data + begin, length);
    std::memcpy(data + at + 16, &checksum, sizeof checksum);
    std::memcpy(data + local + 14, &checksum, sizeof checksum);
  }
}

}  // namespace hard
