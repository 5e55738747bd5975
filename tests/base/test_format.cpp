// Texts with numbers, as printf in the C locale has them, in any other.
#include <gtest/gtest.h>

#include <cfloat>
#include <climits>
#include <cmath>
#include <string>

#include "base/error.hpp"
#include "base/format.hpp"
#include "comma_locale.hpp"

namespace rdm {
namespace {

template <class... T>
std::string ours(const char* pattern, T... values) {
  char text[4096];
  const int n = print_text(text, sizeof text, pattern, values...);
  EXPECT_EQ(static_cast<size_t>(n), std::string(text).size()) << pattern;
  return text;
}

#define SAME_AS_PRINTF(...)                        \
  do {                                             \
    char want[4096];                               \
    std::snprintf(want, sizeof want, __VA_ARGS__); \
    EXPECT_EQ(ours(__VA_ARGS__), want);            \
  } while (false)

TEST(PrintText, SaysWhatPrintfSays) {
  SAME_AS_PRINTF("plain %% text");
  const double infinite = HUGE_VAL, none = std::nan("");
  for (const double x :
       {0.0, -0.0, 1.0, 0.5, -1234.56789, 1e-300, 1e22, DBL_MAX, infinite, -infinite, none}) {
    SAME_AS_PRINTF("%g", x);
    SAME_AS_PRINTF("[%.9g, %+e]", x, x);
    SAME_AS_PRINTF("%12.3f|%-12.3f|%012.3f|% .2E|%.0f|%.17g", x, x, x, x, x, x);
    SAME_AS_PRINTF("%*.*f|%-*.*g", 14, 2, x, -9, 4, x);
  }
  SAME_AS_PRINTF("%d %i %5d|%-5d|%05d|%+d", 1, -2, 3, 4, 5, 6);
  SAME_AS_PRINTF("%ld %lld %zu %zd %jd %td", LONG_MIN, LLONG_MAX, SIZE_MAX, ptrdiff_t{-1}, INTMAX_MIN,
                 ptrdiff_t{7});
  SAME_AS_PRINTF("%u %lu %llu %x %X %#o %016llx", UINT_MAX, ULONG_MAX, ULLONG_MAX, 255u, 255u, 8u, 0xabcull);
  SAME_AS_PRINTF("%c%s|%8s|%-8s|%.2s|%.*s|%10.3s", 'a', "b", "right", "left", "cut", 2, "cut", "wide");
  SAME_AS_PRINTF("%s %d %s %g %s", "a", 1, "b", 2.5, "c");
}

TEST(PrintText, IsCutWhereTheBufferEnds) {
  char text[6] = "?????";
  EXPECT_EQ(print_text(text, sizeof text, "%s", "0123456789"), 10);
  EXPECT_STREQ(text, "01234");
  EXPECT_EQ(print_text(nullptr, 0, "%d and %g", 12, 0.5), 10);
}

TEST(PrintText, HasAPointUnderEveryLocale) {
  const CommaLocale locale;
  if (!locale.set()) GTEST_SKIP() << "no locale with a decimal comma is installed";
  char printf_text[32];
  std::snprintf(printf_text, sizeof printf_text, "%.2f", 0.25);
  EXPECT_STRNE(printf_text, "0.25") << "the locale has no comma";
  EXPECT_EQ(ours("%g, %.2f, %e", 0.5, 1234567.25, -0.125), "0.5, 1234567.25, -1.250000e-01");
  EXPECT_EQ(ours("[%8.3f]", 0.5), "[   0.500]");
  EXPECT_EQ(guard([] { fail(Code::kRange, "%.9g is outside [%.9g, %.9g]", 1.5, 0.25, 0.75); }), Code::kRange);
  EXPECT_STREQ(last_error(), "1.5 is outside [0.25, 0.75]");
}

}  // namespace
}  // namespace rdm
