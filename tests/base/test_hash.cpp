#include <gtest/gtest.h>

#include "base/hash.hpp"

namespace rdm {
namespace {

// Published FNV-1a 64-bit vectors.
TEST(Hash, KnownAnswers) {
  EXPECT_EQ(hash_bytes("", 0), 0xcbf29ce484222325ull);
  EXPECT_EQ(hash_bytes("a", 1), 0xaf63dc4c8601ec8cull);
  EXPECT_EQ(hash_bytes("foobar", 6), 0x85944171f73967e8ull);
}

TEST(Hash, ChainsOverPieces) {
  const char text[] = "one state, in two pieces";
  const uint64_t whole = hash_bytes(text, sizeof text);
  for (size_t cut = 0; cut <= sizeof text; ++cut)
    EXPECT_EQ(hash_bytes(text + cut, sizeof text - cut, hash_bytes(text, cut)), whole) << cut;
}

TEST(Hash, SeesEveryBit) {
  unsigned char state[16] = {};
  const uint64_t clean = hash_bytes(state, sizeof state);
  for (size_t bit = 0; bit < 8 * sizeof state; ++bit) {
    state[bit / 8] = static_cast<unsigned char>(1u << (bit % 8));
    EXPECT_NE(hash_bytes(state, sizeof state), clean) << bit;
    state[bit / 8] = 0;
  }
}

}  // namespace
}  // namespace rdm
