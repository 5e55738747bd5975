// The checked files of redman (magic, version, byte-order mark, length, sections with a CRC each) as bytes
// that can be changed and made whole again: what lies behind a checksum is then reached too.
#pragma once
#include <cstdint>
#include <cstring>
#include <vector>

#include "base/bytes.hpp"

namespace hard {

using Bytes = std::vector<unsigned char>;

inline constexpr size_t kFileHead = 24;     // magic 8, version 4, mark 4, length 8
inline constexpr size_t kSectionHead = 16;  // tag 4, CRC 4, length 8

inline bool is_file(const unsigned char* p, size_t size) {
  return size >= kFileHead && std::memcmp(p, "RDM", 3) == 0;
}

// Length and checksums of the file at p, and of files within its sections, made to agree with the contents. A
// section that runs past the end is cut there.
inline void mend(unsigned char* p, size_t size) {
  if (!is_file(p, size)) return;
  const uint64_t body = size - kFileHead;
  std::memcpy(p + 16, &body, sizeof body);
  for (size_t at = kFileHead; at + kSectionHead <= size;) {
    uint64_t length;
    std::memcpy(&length, p + at + 8, sizeof length);
    const size_t room = size - at - kSectionHead;
    if (length > room) {
      length = room;
      std::memcpy(p + at + 8, &length, sizeof length);
    }
    unsigned char* payload = p + at + kSectionHead;
    mend(payload, length);
    const uint32_t crc = rdm::crc32(payload, length);
    std::memcpy(p + at + 4, &crc, sizeof crc);
    at += kSectionHead + length;
  }
}

struct Span {
  size_t begin, end;
};

// Where the sections' contents lie, those of files within sections included, the inner ones alone.
inline void payloads(const unsigned char* p, size_t from, size_t size, std::vector<Span>& out) {
  for (size_t at = from + kFileHead; at + kSectionHead <= from + size;) {
    uint64_t length;
    std::memcpy(&length, p + at + 8, sizeof length);
    const size_t begin = at + kSectionHead;
    if (length > from + size - begin) return;
    if (is_file(p + begin, length))
      payloads(p, begin, length, out);
    else
      out.push_back({begin, begin + length});
    at = begin + length;
  }
}

}  // namespace hard
