// What reading a file has in common on all systems: its first bytes are looked at before memory is taken.
#pragma once
#include <algorithm>
#include <cstdint>
#include <cstring>

#include "base/file.hpp"

namespace rdm {

// The file's bytes, as read_file gives them. read_to(out, size) reads on and returns how many bytes came,
// fewer at the end alone; `size` is what the system says of the whole file.
template <class ReadTo>
Vector<unsigned char> read_within(const char* path, uint64_t size, const FileLimits& limits,
                                  const ReadTo& read_to) {
  unsigned char head[64];
  const size_t looked = read_to(head, sizeof head), magic = std::min(limits.magic.size(), looked);
  if (std::memcmp(head, limits.magic.data(), magic) != 0)
    fail(Code::kFormat, "%s: it is not a file of this kind (wrong magic number)", path);
  if (const size_t end = limits.length_at + sizeof(uint64_t); limits.length_at > 0 && looked >= end) {
    uint64_t length;
    std::memcpy(&length, head + limits.length_at, sizeof length);
    if (length != size - end)
      fail(Code::kFormat, "%s: it is truncated or has extra bytes: its length does not match its header",
           path);
  }
  if (size > limits.longest)
    fail(limits.too_long, "%s: it has %lld bytes, but no file of this kind has more than %zu", path,
         static_cast<long long>(size), limits.longest);
  Vector<unsigned char> out(std::max(static_cast<size_t>(size), looked));
  std::copy_n(head, looked, out.begin());
  out.resize(looked + read_to(out.data() + looked, out.size() - looked));
  return out;
}

}  // namespace rdm
