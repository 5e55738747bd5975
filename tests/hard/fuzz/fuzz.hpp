// What a fuzz target is: where it starts, what one input does, and how a changed input is made whole.
//
// Built with clang and -fsanitize=fuzzer the inputs are led by coverage; built otherwise, driver.cpp changes
// the seeds blindly, which is what the short share of the checks does.
#pragma once
#include "worlds.hpp"

namespace hard {

// Inputs to begin with, made by the library itself: they cannot fall behind its formats.
std::vector<Bytes> seeds();
// One input. Nothing may be reported by a sanitizer, no HARD_REQUIRE broken.
void one(const unsigned char* data, size_t size);
// Mends what the format checks first: lengths and checksums.
void whole(unsigned char* data, size_t size);
// Bytes of an input that are not worth changing at random: heads of files.
size_t fixed_bytes();

// A number for a choice: the input's first byte.
inline size_t pick(const unsigned char* data, size_t size, size_t count) {
  return size == 0 ? 0 : data[0] % count;
}

inline Bytes with_pick(size_t choice, const Bytes& rest) {
  Bytes out{static_cast<unsigned char>(choice)};
  out.insert(out.end(), rest.begin(), rest.end());
  return out;
}

inline Bytes bytes_of(const std::string& text) {
  return {text.begin(), text.end()};
}

}  // namespace hard
