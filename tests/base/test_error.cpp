#include <gtest/gtest.h>

#include <cstring>
#include <stdexcept>
#include <string>
#include <thread>

#include "base/error.hpp"

namespace rdm {
namespace {

TEST(Error, FailCarriesCodeAndOneLine) {
  try {
    fail(Code::kRange, "dt: %g is outside\n[%g, %g]", 2.5, 0.0, 1.0);
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code, Code::kRange);
    EXPECT_STREQ(e.text, "dt: 2.5 is outside [0, 1]");
  }
}

TEST(Error, LongTextIsCut) {
  const std::string longer(1000, 'x');
  EXPECT_EQ(guard([&] { fail(Code::kIo, "%s", longer.c_str()); }), Code::kIo);
  EXPECT_EQ(std::strlen(last_error()), static_cast<size_t>(kErrorTextSize) - 1);
  set_last_error(longer.c_str());
  EXPECT_EQ(std::strlen(last_error()), static_cast<size_t>(kErrorTextSize) - 1);
}

TEST(Error, GuardTurnsEveryExceptionIntoACode) {
  EXPECT_EQ(guard([] {}), Code::kOk);
  EXPECT_EQ(guard([] { fail(Code::kState, "wrong order"); }), Code::kState);
  EXPECT_STREQ(last_error(), "wrong order");
  EXPECT_EQ(guard([] { throw std::bad_alloc(); }), Code::kMemory);
  EXPECT_STREQ(last_error(), "out of memory");
  EXPECT_EQ(guard([] { throw std::runtime_error("inner"); }), Code::kInternal);
  EXPECT_EQ(guard([] { throw 7; }), Code::kInternal);
}

TEST(Error, SuccessLeavesTheTextAlone) {
  set_last_error("old news");
  EXPECT_EQ(guard([] {}), Code::kOk);
  EXPECT_STREQ(last_error(), "old news");
}

TEST(Error, EachThreadHasItsOwnText) {
  set_last_error("mine");
  std::thread([] {
    EXPECT_STREQ(last_error(), "");
    EXPECT_EQ(guard([] { fail(Code::kIo, "theirs"); }), Code::kIo);
    EXPECT_STREQ(last_error(), "theirs");
  }).join();
  EXPECT_STREQ(last_error(), "mine");
}

TEST(Error, CodesAreFrozenAndEachHasItsOwnString) {
  EXPECT_EQ(static_cast<int32_t>(Code::kArgument), -1);
  EXPECT_EQ(static_cast<int32_t>(Code::kCancelled), -11);
  EXPECT_EQ(static_cast<int32_t>(Code::kInternal), -99);
  for (int32_t code = -1000; code <= 1000; ++code) {
    ASSERT_NE(code_string(code), nullptr);
    ASSERT_GT(std::strlen(code_string(code)), 0u);
  }
  for (int32_t a = -11; a <= 0; ++a)
    for (int32_t b = -11; b < a; ++b) EXPECT_STRNE(code_string(a), code_string(b));
  EXPECT_STREQ(code_string(-50), "unknown error");
}

}  // namespace
}  // namespace rdm
