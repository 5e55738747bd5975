#include <gtest/gtest.h>

#include <cfenv>
#include <limits>

#include "base/fpmode.hpp"

namespace rdm {
namespace {

volatile double g_tiny = std::numeric_limits<double>::min();

#if defined(__SSE2__) || defined(__aarch64__)
TEST(FpMode, FlushesDenormalsWhileItLivesAndPutsTheHostsBack) {
  EXPECT_GT(g_tiny / 2, 0.0);
  {
    const FpMode mode;
    EXPECT_EQ(g_tiny / 2, 0.0);
  }
  EXPECT_GT(g_tiny / 2, 0.0);
}

TEST(FpMode, RoundsToNearestWhateverTheHostUses) {
  const int before = std::fegetround();
  ASSERT_EQ(std::fesetround(FE_UPWARD), 0);
  volatile double one = 1.0, small = 1e-30;
  EXPECT_GT(one + small, 1.0);
  {
    const FpMode mode;
    EXPECT_EQ(one + small, 1.0);
  }
  EXPECT_GT(one + small, 1.0);
  std::fesetround(before);
}
#endif

}  // namespace
}  // namespace rdm
