#include <gtest/gtest.h>

#include <functional>
#include <string>
#include <vector>

#include "base/bytes.hpp"
#include "base/error.hpp"

namespace rdm {
namespace {

constexpr char kMagic[8] = {'R', 'D', 'M', 't', 'e', 's', 't', '\n'};
using Bytes = std::vector<unsigned char>;

void write_sample(Writer& w) {
  w.begin_file(kMagic, 1);
  w.begin_section("HEAD");
  w.text("hand_over");
  w.value(uint32_t{7});
  w.end_section();
  w.begin_section("NONE");
  w.end_section();
  w.begin_section("DATA");
  const double x[3] = {1.5, -2.25, 1e-300};
  w.bytes(x, sizeof x);
  w.end_section();
  w.end_file();
}

Bytes sample() {
  Writer measure(nullptr, 0);
  write_sample(measure);
  Bytes out(measure.size());
  Writer real(out.data(), out.size());
  write_sample(real);
  EXPECT_TRUE(real.fits());
  EXPECT_EQ(real.size(), measure.size());
  return out;
}

// Reads everything that write_sample wrote, in another order.
void read_sample(const Bytes& bytes) {
  Reader r(bytes.data(), bytes.size(), "sample");
  EXPECT_EQ(r.begin_file(kMagic, 1), 1u);
  r.need_section("DATA");
  EXPECT_EQ(r.left(), 24u);
  EXPECT_EQ(r.value<double>(), 1.5);
  EXPECT_EQ(r.value<double>(), -2.25);
  EXPECT_EQ(r.value<double>(), 1e-300);
  r.expect_end();
  r.need_section("HEAD");
  char name[16];
  r.text(name, sizeof name);
  EXPECT_STREQ(name, "hand_over");
  EXPECT_EQ(r.value<uint32_t>(), 7u);
  r.expect_end();
  r.need_section("NONE");
  r.expect_end();
  EXPECT_FALSE(r.find_section("ELSE"));
}

Code code_of(const Bytes& bytes) {
  return guard([&] { read_sample(bytes); });
}

TEST(Crc32, CheckValueAndChaining) {
  EXPECT_EQ(crc32("123456789", 9), 0xCBF43926u);
  EXPECT_EQ(crc32("", 0), 0u);
  for (size_t cut = 0; cut <= 9; ++cut)
    EXPECT_EQ(crc32("123456789" + cut, 9 - cut, crc32("123456789", cut)), 0xCBF43926u);
}

// By tables or by products: the remainder bit by bit, for any length, place and start.
TEST(Bytes, ChecksumIsTheSameForEveryLength) {
  const auto plain = [](const unsigned char* p, size_t n, uint32_t crc) {
    crc = ~crc;
    for (size_t i = 0; i < n; ++i) {
      crc ^= p[i];
      for (int k = 0; k < 8; ++k) crc = (crc & 1u) ? 0xEDB88320u ^ (crc >> 1) : crc >> 1;
    }
    return ~crc;
  };
  unsigned char bytes[1100];
  uint32_t x = 1;
  for (unsigned char& b : bytes) b = static_cast<unsigned char>((x = x * 1664525u + 1013904223u) >> 24);
  for (size_t n = 0; n <= 1024; n += n < 300 ? 1 : 37)
    for (const size_t from : {0, 1, 7, 61})
      for (const uint32_t start : {0u, 0xdeadbeefu})
        ASSERT_EQ(crc32(bytes + from, n, start), plain(bytes + from, n, start)) << n << " from " << from;
}

TEST(Bytes, RoundTripInAnyOrder) {
  EXPECT_EQ(code_of(sample()), Code::kOk);
}

TEST(Bytes, LayoutIsFrozen) {
  const Bytes b = sample();
  ASSERT_EQ(b.size(), 24u + 16 + 17 + 16 + 16 + 24);
  const unsigned char head[24] = {'R', 'D', 'M', 't', 'e', 's', 't', '\n', 1, 0, 0, 0,
                                  4,   3,   2,   1,   89,  0,   0,   0,    0, 0, 0, 0};
  EXPECT_EQ(Bytes(b.begin(), b.begin() + 24), Bytes(head, head + 24));
  const unsigned char section[4] = {'H', 'E', 'A', 'D'};
  EXPECT_EQ(Bytes(b.begin() + 24, b.begin() + 28), Bytes(section, section + 4));
  const unsigned char length[8] = {17, 0, 0, 0, 0, 0, 0, 0};
  EXPECT_EQ(Bytes(b.begin() + 32, b.begin() + 40), Bytes(length, length + 8));
}

TEST(Bytes, EveryTruncationIsAFormatError) {
  const Bytes whole = sample();
  for (size_t n = 0; n < whole.size(); ++n) {
    // A copy of exactly n bytes, so that a sanitizer sees a read beyond.
    EXPECT_EQ(code_of(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(n))), Code::kFormat)
        << n;
  }
  Bytes tail = whole;
  tail.push_back(0);
  EXPECT_EQ(code_of(tail), Code::kFormat);
}

TEST(Bytes, EveryFlippedBitIsAnError) {
  const Bytes whole = sample();
  for (size_t bit = 0; bit < 8 * whole.size(); ++bit) {
    Bytes bad = whole;
    bad[bit / 8] = static_cast<unsigned char>(bad[bit / 8] ^ (1u << (bit % 8)));
    const bool in_version = bit / 8 >= 8 && bit / 8 < 12;
    EXPECT_EQ(code_of(bad), in_version ? Code::kVersion : Code::kFormat) << "byte " << bit / 8;
  }
}

TEST(Bytes, VersionsAreAWindow) {
  unsigned char b[64];
  for (const uint32_t version : {0u, 1u, 2u, 3u, 4u}) {
    Writer w(b, sizeof b);
    w.begin_file(kMagic, version);
    w.end_file();
    const Code code = guard([&] { Reader(b, w.size(), "f").begin_file(kMagic, 3); });
    EXPECT_EQ(code, version >= 1 && version <= 3 ? Code::kOk : Code::kVersion) << version;
  }
}

TEST(Bytes, ShortBufferIsMeasuredNotOverrun) {
  const size_t need = sample().size();
  for (size_t capacity = 0; capacity < need; ++capacity) {
    Bytes b(capacity + 1, 0xAA);
    Writer w(b.data(), capacity);
    write_sample(w);
    EXPECT_FALSE(w.fits());
    EXPECT_EQ(w.size(), need);
    EXPECT_EQ(b[capacity], 0xAA);
  }
}

TEST(Bytes, WhatIsReadPastASectionIsAnError) {
  const Bytes b = sample();
  const auto after = [&](const std::function<void(Reader&)>& f) {
    return guard([&] {
      Reader r(b.data(), b.size(), "sample");
      r.begin_file(kMagic, 1);
      f(r);
    });
  };
  EXPECT_EQ(after([](Reader& r) { r.need_section("ELSE"); }), Code::kFormat);
  EXPECT_STREQ(last_error(), "sample: section ELSE is missing");
  EXPECT_EQ(after([](Reader& r) { r.need_section("DATA"), r.view(25); }), Code::kFormat);
  EXPECT_EQ(after([](Reader& r) { r.need_section("DATA"), r.view(size_t{0} - 1); }), Code::kFormat);
  EXPECT_EQ(after([](Reader& r) { r.need_section("DATA"), r.value<float>(), r.expect_end(); }),
            Code::kFormat);
  char small[9];
  EXPECT_EQ(after([&](Reader& r) { r.need_section("HEAD"), r.text(small, sizeof small); }), Code::kFormat);
}

TEST(Bytes, ForeignByteOrderAndMagicAreNamed) {
  Bytes b = sample();
  std::swap(b[12], b[15]);
  std::swap(b[13], b[14]);
  EXPECT_EQ(code_of(b), Code::kFormat);
  EXPECT_STREQ(last_error(), "sample: it was written with another byte order");
  b = sample();
  b[0] = 'X';
  EXPECT_EQ(code_of(b), Code::kFormat);
  EXPECT_STREQ(last_error(), "sample: it is not a file of this kind (wrong magic number)");
}

}  // namespace
}  // namespace rdm
