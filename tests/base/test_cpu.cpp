#include <gtest/gtest.h>

#include <string>

#include "base/cpu.hpp"

namespace rdm {
namespace {

TEST(Cpu, SetsContainEachOther) {
  EXPECT_TRUE(!cpu().v3 || cpu().avx2);
  EXPECT_TRUE(!cpu().v4 || cpu().v3);
}

TEST(Cpu, TheBaseSetIsNamedByTheProcessorsFamily) {
#if defined(__x86_64__)
  EXPECT_EQ(std::string(kBaseIsa), "x86-64-v2");
#else
  EXPECT_EQ(std::string(kBaseIsa), "base");
  EXPECT_FALSE(cpu().avx2);
#endif
}

}  // namespace
}  // namespace rdm
