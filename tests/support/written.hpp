// What a function of the C ABI writes into its caller's memory: `call(out, capacity, &size)` is asked for the size, then for the rest.
#pragma once
#include <gtest/gtest.h>
#include <redman/redman.h>

#include <string>
#include <vector>

template <class Byte = unsigned char, class Call>
std::vector<Byte> written_bytes(const Call& call) {
  size_t size = 0;
  EXPECT_EQ(call(static_cast<Byte*>(nullptr), size_t{0}, &size), RDM_OK) << rdm_last_error();
  std::vector<Byte> bytes(size);
  EXPECT_EQ(call(bytes.data(), bytes.size(), &size), RDM_OK) << rdm_last_error();
  return bytes;
}

// Of a text, whose size is without its terminator.
template <class Call>
std::string written_text(const Call& call) {
  size_t size = 0;
  EXPECT_EQ(call(static_cast<char*>(nullptr), size_t{0}, &size), RDM_OK) << rdm_last_error();
  std::string text(size + 1, '#');
  EXPECT_EQ(call(text.data(), text.size(), &size), RDM_OK) << rdm_last_error();
  EXPECT_EQ(text.back(), '\0');
  text.pop_back();
  return text;
}
