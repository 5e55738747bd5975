// Policy files whose numbers are changed, for tests.
#pragma once
#include <algorithm>
#include <cstring>
#include <vector>

#include "base/bytes.hpp"
#include "nn/policy.hpp"

namespace rdm::test {

struct Tried {
  int32_t refused = 0, taken = 0;
};

// Each number of a section becomes each of some values, with the section's checksum mended; both counts are 0 where the
// file has no such section. A policy that is read stays within its memory, as it acts on the file's example then.
inline Tried try_numbers(const std::vector<unsigned char>& good, const char* tag) {
  Tried out;
  const auto at = static_cast<size_t>(std::search(good.begin(), good.end(), tag, tag + 4) - good.begin());
  if (at == good.size()) return out;
  uint64_t length = 0;
  std::memcpy(&length, &good[at + 8], sizeof length);
  for (size_t word = 0; word < length; word += 4)
    for (const int32_t value : {-1, 0, 1, 2, 3, 7, 65536, 1 << 30}) {
      auto bytes = good;
      unsigned char* payload = &bytes[at + 16];
      std::memcpy(payload + word, &value, sizeof value);
      const uint32_t sum = crc32(payload, length);
      std::memcpy(&bytes[at + 4], &sum, sizeof sum);
      try {
        Policy::destroy(Policy::read(bytes.data(), bytes.size(), HostHooks{}));
        ++out.taken;
      } catch (const Error&) {
        ++out.refused;
      }
    }
  return out;
}

}  // namespace rdm::test
