#include <gtest/gtest.h>

#include <cstring>
#include <set>
#include <type_traits>
#include <vector>

#include "base/rng.hpp"

namespace rdm {
namespace {

// A stream as a saved state holds it: seed, counter, world, purpose.
struct Saved {
  uint64_t seed, counter;
  uint32_t world, purpose;
};
static_assert(sizeof(Saved) == sizeof(Stream) && std::is_trivially_copyable_v<Stream>);

Stream restore(const Saved& saved) {
  Stream stream;
  std::memcpy(static_cast<void*>(&stream), &saved, sizeof stream);
  return stream;
}

// The published Philox 4x32-10 vectors of Random123 (counter words, key words, first two output words).
TEST(Stream, PhiloxKnownAnswers) {
  EXPECT_EQ(restore({0, 0, 0, 0}).next(), 0xe169c58d6627e8d5ull);
  EXPECT_EQ(restore({~0ull, ~0ull, ~0u, ~0u}).next(), 0x41c83b0e408f276dull);
  EXPECT_EQ(restore({0x299f31d0a4093822ull, 0x85a308d3243f6a88ull, 0x13198a2eu, 0x03707344u}).next(),
            0x94fdccebd16cfe09ull);
}

TEST(Stream, TwentyFourBytesAreTheWholeState) {
  Stream a(42, 7, Purpose::kReset);
  for (int i = 0; i < 100; ++i) a.next();
  Saved bytes;
  std::memcpy(&bytes, &a, sizeof bytes);
  EXPECT_EQ(bytes.counter, 100u);
  Stream b = restore(bytes);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(a.next(), b.next());
}

TEST(Stream, NameDecidesTheDraws) {
  std::set<uint64_t> first;
  for (const uint64_t seed : {0ull, 1ull, 1ull << 32})
    for (const uint32_t world : {0u, 1u, 2u})
      for (const Purpose purpose : {Purpose::kReset, Purpose::kPolicyNoise, Purpose::kTest})
        first.insert(Stream(seed, world, purpose).next());
  EXPECT_EQ(first.size(), 27u);
  EXPECT_EQ(Stream(5, 3, Purpose::kSense).next(), Stream(5, 3, Purpose::kSense).next());
}

TEST(Stream, UniformMomentsAndRange) {
  Stream s(1, 0, Purpose::kTest);
  const int n = 200000;
  double sum = 0, square = 0;
  for (int i = 0; i < n; ++i) {
    const double u = s.uniform();
    ASSERT_GE(u, 0.0);
    ASSERT_LT(u, 1.0);
    sum += u;
    square += u * u;
  }
  // Five standard errors of the mean (1/sqrt(12 n)) and of the second moment (sqrt(4/45 / n)).
  EXPECT_NEAR(sum / n, 0.5, 5 * std::sqrt(1.0 / 12 / n));
  EXPECT_NEAR(square / n, 1.0 / 3, 5 * std::sqrt(4.0 / 45 / n));
  for (int i = 0; i < 1000; ++i) {
    const double v = s.uniform(-3, -2);
    ASSERT_GE(v, -3.0);
    ASSERT_LT(v, -2.0);
    ASSERT_LE(std::abs(s.signed_unit()), 1.0);
  }
}

// Also where the counter passes 32 and 64 bits, and for counts that fill no vector.
TEST(Stream, ManySignedUnitsAreTheSameNumbers) {
  for (const uint64_t counter : {0ull, 5ull, 0xfffffffdull, ~0ull - 20})
    for (int count = 0; count < 20; ++count) {
      Stream one = restore({0x123456789abcdef0ull, counter, 77, 5}), many = one;
      float row[21];
      for (float& x : row) x = 9;
      many.signed_units(row, count);
      for (int i = 0; i < count; ++i) ASSERT_EQ(row[i], static_cast<float>(one.signed_unit())) << counter;
      EXPECT_EQ(row[count], 9);
      EXPECT_EQ(many.counter(), one.counter());
    }
  Stream one(1, 2, Purpose::kTest), many = one;
  std::vector<float> row(100000);
  many.signed_units(row.data(), static_cast<int>(row.size()));
  for (const float x : row) ASSERT_EQ(x, static_cast<float>(one.signed_unit()));
}

TEST(Stream, BelowIsUnbiased) {
  Stream s(2, 0, Purpose::kTest);
  const int sides = 7, n = 140000;
  std::vector<int> seen(sides, 0);
  for (int i = 0; i < n; ++i) {
    const uint32_t side = s.below(sides);
    ASSERT_LT(side, static_cast<uint32_t>(sides));
    ++seen[side];
  }
  double chi2 = 0;
  for (const int count : seen)
    chi2 += (count - n / sides) * (count - n / sides) / (static_cast<double>(n) / sides);
  EXPECT_LT(chi2, 27.9);  // 6 degrees of freedom, probability 1e-4
  EXPECT_EQ(s.below(1), 0u);
}

TEST(Stream, NormalsHaveUnitMoments) {
  Stream s(3, 0, Purpose::kPolicyNoise);
  const int n = 200000;
  std::vector<float> x(n);
  s.normals(x.data(), n);
  EXPECT_EQ(s.counter(), static_cast<uint64_t>(n / 2));
  double m1 = 0, m2 = 0, m4 = 0, pairs = 0;
  for (const float v : x) {
    ASSERT_TRUE(std::isfinite(v));
    m1 += v, m2 += v * v, m4 += v * v * v * v;
  }
  for (size_t i = 0; i < x.size(); i += 2) pairs += x[i] * x[i + 1];
  EXPECT_NEAR(m1 / n, 0, 5 * std::sqrt(1.0 / n));
  EXPECT_NEAR(m2 / n, 1, 5 * std::sqrt(2.0 / n));
  EXPECT_NEAR(m4 / n, 3, 5 * std::sqrt(96.0 / n));
  EXPECT_NEAR(pairs / (n / 2), 0, 5 * std::sqrt(2.0 / n));
}

TEST(Stream, OddCountOfNormalsWritesNoMore) {
  Stream a(4, 0, Purpose::kTest), b(4, 0, Purpose::kTest);
  float odd[4] = {0, 0, 0, -99}, even[4];
  a.normals(odd, 3);
  b.normals(even, 4);
  EXPECT_EQ(odd[3], -99);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(odd[i], even[i]);
  EXPECT_EQ(a.counter(), b.counter());
}

}  // namespace
}  // namespace rdm
