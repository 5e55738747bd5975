// Text of numbers by our own arithmetic against the standard library's, where that has it.
#include <gtest/gtest.h>

#include <bit>
#include <cfenv>
#include <cmath>
#include <cstdio>
#include <random>
#include <string>
#include <vector>

#include "base/chars.hpp"
#include "base/decimal.hpp"

namespace rdm {
namespace {

template <class T>
using Bits = typename decimal::Format<T>::Bits;

template <class T>
std::string shortest(T v) {
  char text[100];
  const auto r = decimal::to_chars(text, text + sizeof text, v);
  EXPECT_EQ(r.ec, std::errc());
  return {text, r.ptr};
}
template <class T>
std::string general(T v, int digits) {
  char text[100];
  const auto r = decimal::to_chars(text, text + sizeof text, v, digits);
  EXPECT_EQ(r.ec, std::errc());
  return {text, r.ptr};
}
template <class T>
T read(const std::string& text) {
  T v = 7;
  const auto r = decimal::from_chars(text.data(), text.data() + text.size(), v);
  EXPECT_EQ(r.ec, std::errc()) << text;
  EXPECT_EQ(r.ptr, text.data() + text.size()) << text;
  return v;
}

// A number whose bits are as good as any.
template <class T>
T any_number(std::mt19937_64& random) {
  return std::bit_cast<T>(static_cast<Bits<T>>(random()));
}

TEST(Decimal, KnownTexts) {
  EXPECT_EQ(shortest(0.0), "0");
  EXPECT_EQ(shortest(-0.0), "-0");
  EXPECT_EQ(shortest(0.1), "0.1");
  EXPECT_EQ(shortest(0.1f), "0.1");
  EXPECT_EQ(shortest(0.1 + 0.2), "0.30000000000000004");
  EXPECT_EQ(shortest(1e-4), "1e-04");
  EXPECT_EQ(shortest(0.00012), "0.00012");
  EXPECT_EQ(shortest(9.5367431640625e-7), "9.5367431640625e-07");
  EXPECT_EQ(shortest(5e-324), "5e-324");
  EXPECT_EQ(shortest(1e-45f), "1e-45");
  EXPECT_EQ(shortest(1.7976931348623157e308), "1.7976931348623157e+308");
  EXPECT_EQ(shortest(1152921504606846976.0), "1152921504606846976");  // 2^60, whole and exact
  EXPECT_EQ(shortest(1e22), "1e+22");
  EXPECT_EQ(shortest(9.5367431640625e23), "9.5367431640625e+23");
  EXPECT_EQ(shortest(9007199254740993.0), "9007199254740992");
  EXPECT_EQ(shortest(INFINITY), "inf");
  EXPECT_EQ(shortest(-INFINITY), "-inf");
  EXPECT_EQ(shortest(std::nan("")), "nan");
  EXPECT_EQ(general(0.1 + 0.2, 9), "0.3");
  EXPECT_EQ(general(0.5, 1), "0.5");
  EXPECT_EQ(general(2.5, 1), "2");  // a tie goes to the even digit
  EXPECT_EQ(general(3.5, 1), "4");
  EXPECT_EQ(general(999.5, 3), "1e+03");
  EXPECT_EQ(general(99999.5, 9), "99999.5");
  EXPECT_EQ(general(1e-5, 9), "1e-05");
  EXPECT_EQ(general(0.1, 17), "0.10000000000000001");
  EXPECT_EQ(general(0.1, 60), "0.1000000000000000055511151231257827021181583404541015625");
  EXPECT_EQ(read<double>("2.2250738585072011e-308"), 0x0.fffffffffffffp-1022);
  EXPECT_EQ(read<double>("9007199254740993"), 9007199254740992.0);  // a tie goes to the even fraction
  EXPECT_EQ(read<double>("9007199254740995"), 9007199254740996.0);
  EXPECT_EQ(read<double>("9007199254740993.00000000000000000000000000000000000001"), 9007199254740994.0);
  EXPECT_EQ(read<double>("2.4703282292062328e-324"), 5e-324);
  EXPECT_EQ(read<float>("16777217"), 16777216.0f);
  EXPECT_EQ(read<float>("16777217.0000000001"), 16777218.0f);  // and not by way of a double
  EXPECT_EQ(read<double>(std::string(5000, '0') + "1." + std::string(5000, '0')), 1.0);
  EXPECT_EQ(read<double>("0." + std::string(5000, '0') + "1e5001"), 1.0);
  EXPECT_EQ(read<double>("1" + std::string(5000, '0') + "e-5000"), 1.0);
}

TEST(Decimal, WhatIsWrittenReadsBackToTheSameBits) {
  std::mt19937_64 random(1);
  for (int i = 0; i < 20000; ++i) {
    const auto v = any_number<double>(random);
    const auto f = any_number<float>(random);
    if (std::isfinite(v)) {
      EXPECT_EQ(std::bit_cast<uint64_t>(read<double>(shortest(v))), std::bit_cast<uint64_t>(v)) << v;
      EXPECT_EQ(std::bit_cast<uint64_t>(read<double>(general(v, 17))), std::bit_cast<uint64_t>(v)) << v;
    }
    if (std::isfinite(f)) {
      EXPECT_EQ(std::bit_cast<uint32_t>(read<float>(shortest(f))), std::bit_cast<uint32_t>(f)) << f;
      EXPECT_EQ(std::bit_cast<uint32_t>(read<float>(general(f, 9))), std::bit_cast<uint32_t>(f)) << f;
    }
  }
}

TEST(Decimal, ARoundingModeChangesNothing) {
  const std::string text = shortest(0.1 + 0.2);
  for (const int mode : {FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO}) {
    std::fesetround(mode);
    EXPECT_EQ(shortest(read<double>(text)), text);
    EXPECT_EQ(read<double>("0.1"), 0x1.999999999999ap-4);
    std::fesetround(FE_TONEAREST);
  }
}

TEST(Decimal, ABufferThatIsTooSmallIsSaid) {
  char text[8] = "abcdefg";
  const auto r = decimal::to_chars(text, text + 5, 0.1234);
  EXPECT_EQ(r.ec, std::errc::value_too_large);
  EXPECT_EQ(r.ptr, text + 5);
  const auto good = decimal::to_chars(text, text + 6, 0.1234);
  EXPECT_EQ(good.ec, std::errc());
  EXPECT_EQ(std::string(text, good.ptr), "0.1234");
  EXPECT_EQ(text[6], 'g');
}

TEST(Chars, WholeNumbersAndReals) {
  char text[40];
  EXPECT_EQ(std::string(text, to_chars(text, text + 40, uint64_t{18446744073709551615u}).ptr),
            "18446744073709551615");
  EXPECT_EQ(std::string(text, to_chars(text, text + 40, 0.25f).ptr), "0.25");
  EXPECT_EQ(std::string(text, to_chars(text, text + 40, 1.0 / 3, 9).ptr), "0.333333333");
  int64_t i = 0;
  const char number[] = "-42x";
  EXPECT_EQ(from_chars(number, number + 4, i).ptr, number + 3);
  EXPECT_EQ(i, -42);
}

#if defined(__cpp_lib_to_chars)
template <class T>
void expect_written_as_std(T v) {
  char text[100];
  const std::string all(text, std::to_chars(text, text + sizeof text, v).ptr);
  ASSERT_EQ(shortest(v), all);
  for (const int digits : {1, 6, 9, 17}) {
    const std::string some(
        text, std::to_chars(text, text + sizeof text, v, std::chars_format::general, digits).ptr);
    ASSERT_EQ(general(v, digits), some) << digits << " digits of " << all;
  }
}

template <class T>
void expect_read_as_std(const std::string& text) {
  const char *begin = text.data(), *end = begin + text.size();
  T ours = 7, theirs = 7;
  const auto a = decimal::from_chars(begin, end, ours);
  const auto b = std::from_chars(begin, end, theirs);
  ASSERT_EQ(a.ec, b.ec) << text;
  ASSERT_EQ(a.ptr - begin, b.ptr - begin) << text;
  if (std::isnan(theirs)) {
    ASSERT_TRUE(std::isnan(ours)) << text;
    ASSERT_EQ(std::signbit(ours), std::signbit(theirs)) << text;
  } else {
    ASSERT_EQ(std::bit_cast<Bits<T>>(ours), std::bit_cast<Bits<T>>(theirs)) << text;
  }
}

TEST(Decimal, WritesWhatTheStandardLibraryWrites) {
  std::mt19937_64 random(2);
  for (int i = 0; i < 30000; ++i) {
    ASSERT_NO_FATAL_FAILURE(expect_written_as_std(any_number<double>(random)));
    ASSERT_NO_FATAL_FAILURE(expect_written_as_std(any_number<float>(random)));
    // as they stand in files: few digits, and what arithmetic on such makes of them
    const double few = static_cast<double>(random() % 2000001) / 1000 - 1000;
    ASSERT_NO_FATAL_FAILURE(expect_written_as_std(few));
    ASSERT_NO_FATAL_FAILURE(expect_written_as_std(few / 7));
    ASSERT_NO_FATAL_FAILURE(expect_written_as_std(static_cast<float>(few)));
    ASSERT_NO_FATAL_FAILURE(expect_written_as_std(static_cast<double>(random() >> random() % 64)));
  }
}

TEST(Decimal, WritesPowersAndTheirNeighboursAsTheStandardLibrary) {
  for (int e = -1074; e < 1024; ++e)
    for (const double to : {0.0, HUGE_VAL, 1.0}) {
      const double v = std::ldexp(1, e);
      ASSERT_NO_FATAL_FAILURE(expect_written_as_std(to == 1 ? v : std::nextafter(v, to)));
      ASSERT_NO_FATAL_FAILURE(
          expect_written_as_std(std::nextafter(static_cast<float>(v), static_cast<float>(to))));
    }
  for (int e = -323; e < 309; ++e) {
    const auto v = read<double>("1e" + std::to_string(e));
    for (const double x : {v, std::nextafter(v, 0), std::nextafter(v, INFINITY)}) {
      ASSERT_NO_FATAL_FAILURE(expect_written_as_std(x));
      ASSERT_NO_FATAL_FAILURE(expect_written_as_std(static_cast<float>(x)));
    }
  }
}

TEST(Decimal, ReadsWhatTheStandardLibraryReads) {
  std::mt19937_64 random(3);
  for (int i = 0; i < 60000; ++i) {
    std::string text;
    const auto digits = random() % 30;
    for (uint64_t k = 0; k < digits; ++k) {
      if (random() % 20 == 0) text += '.';
      text += static_cast<char>('0' + random() % 10);
    }
    if (random() % 2) text += "e" + std::to_string(static_cast<int64_t>(random() % 720) - 360);
    ASSERT_NO_FATAL_FAILURE(expect_read_as_std<double>(text));
    ASSERT_NO_FATAL_FAILURE(expect_read_as_std<float>(text));
  }
}

// The text of the middle between two numbers, exact, and of what is a little beside it.
template <class T>
void expect_middles_as_std(T v) {
  const auto next = std::nextafter(v, std::numeric_limits<T>::infinity());
  if (!std::isfinite(v) || !std::isfinite(next)) return;
  const long double middle = (static_cast<long double>(v) + next) / 2;
  char text[1200];
  std::snprintf(text, sizeof text, "%.1100Lg", middle);  // ends where its digits do
  const std::string exact = text;
  const size_t e = exact.find('e');
  const std::string tail = e == std::string::npos ? "" : exact.substr(e);
  std::string digits = exact.substr(0, e);
  ASSERT_NO_FATAL_FAILURE(expect_read_as_std<T>(exact));
  if (digits.find('.') == std::string::npos) digits += '.';
  ASSERT_NO_FATAL_FAILURE(expect_read_as_std<T>(digits + "1" + tail));
  ASSERT_NO_FATAL_FAILURE(expect_read_as_std<T>(digits + std::string(900, '0') + "1" + tail));
  digits.back() = digits.back() == '.' ? '.' : static_cast<char>(digits.back() - 1);
  ASSERT_NO_FATAL_FAILURE(expect_read_as_std<T>(digits + "9" + tail));
}

TEST(Decimal, ReadsTheMiddleBetweenTwoNumbersAsTheStandardLibrary) {
  std::mt19937_64 random(4);
  for (int i = 0; i < 1000; ++i) {
    ASSERT_NO_FATAL_FAILURE(expect_middles_as_std(any_number<double>(random)));
    ASSERT_NO_FATAL_FAILURE(expect_middles_as_std(any_number<float>(random)));
    ASSERT_NO_FATAL_FAILURE(expect_middles_as_std(std::bit_cast<double>(random() >> 12 >> random() % 52)));
  }
}

TEST(Decimal, RefusesWhatTheStandardLibraryRefuses) {
  for (const char* text : {"",
                           "-",
                           "+1",
                           "--1",
                           " 1",
                           ".",
                           "-.",
                           "e5",
                           ".e5",
                           "1e",
                           "1e+",
                           "1e-",
                           "1e5",
                           "1E5",
                           "1.e5",
                           ".5",
                           "5.",
                           "-.5e1",
                           "1e-5x",
                           "1_0",
                           "1..2",
                           "1.2.3",
                           "0x1p3",
                           "inf",
                           "-inf",
                           "Infinity",
                           "INFINIT",
                           "in",
                           "nan",
                           "-nan",
                           "NaN(12)",
                           "nan(a_Z9)",
                           "nan(",
                           "nan(-)",
                           "nan()",
                           "na",
                           "i",
                           "1e400",
                           "-1e400",
                           "1e-400",
                           "0e400",
                           "0e99999999999999999999",
                           "1e99999999999999999999",
                           "1e-99999999999999999999",
                           "0.0e-99999999999999999999",
                           "-0",
                           "00012",
                           "1e0000000000000000000000005",
                           "4.9e-324",
                           "2.4e-324",
                           "2.5e-324",
                           "1.7976931348623157e308",
                           "1.7976931348623158e308",
                           "1.7976931348623159e308",
                           "3.4028235e38",
                           "3.4028236e38",
                           "1.4e-45",
                           "0.7e-45",
                           "0.70064924e-45",
                           "0.8e-45",
                           "1,5",
                           "0000000.00000001e8"}) {
    EXPECT_NO_FATAL_FAILURE(expect_read_as_std<double>(text));
    EXPECT_NO_FATAL_FAILURE(expect_read_as_std<float>(text));
  }
}
#endif

}  // namespace
}  // namespace rdm
