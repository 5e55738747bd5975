#include <gtest/gtest.h>

#include <cstring>

#include "capi/in_use.hpp"

namespace rdm::capi {
namespace {

// Version 1 of a struct, and how a newer header would have grown it.
struct Known {
  uint32_t struct_size;
  int32_t a;
  int64_t b;
};
struct Newer {
  Known known;
  int64_t c;
};
constexpr size_t kFirst = 8;  // as if b had been added in version 2
const Known kDefaults{sizeof(Known), 1, 2};

TEST(Shim, OlderCallersGetDefaultsBeyondTheirSize) {
  const Known in{8, 10, 99};
  const Known out = read_struct(&in, kFirst, kDefaults, "config");
  EXPECT_EQ(out.a, 10);
  EXPECT_EQ(out.b, 2);
  EXPECT_EQ(out.struct_size, sizeof(Known));
}

TEST(Shim, NewerCallersMustLeaveTheirTailZero) {
  Newer in{{sizeof(Newer), 10, 20}, 0};
  EXPECT_EQ(read_struct(&in.known, kFirst, kDefaults, "config").b, 20);
  in.c = 1;
  EXPECT_EQ(guard([&] { read_struct(&in.known, kFirst, kDefaults, "config"); }), Code::kVersion);
}

TEST(Shim, TooSmallAndNullAreNamed) {
  const Known in{7, 0, 0};
  EXPECT_EQ(guard([&] { read_struct(&in, kFirst, kDefaults, "config"); }), Code::kArgument);
  EXPECT_STREQ(last_error(), "config.struct_size: 7 is less than 8");
  EXPECT_EQ(guard([&] { read_struct<Known>(nullptr, kFirst, kDefaults, "config"); }), Code::kArgument);
  EXPECT_STREQ(last_error(), "config is NULL");
}

TEST(Shim, WritesEndAtTheCallersSize) {
  for (const uint32_t size : {8u, 12u, 16u, 24u}) {
    Newer io;
    std::memset(&io, 0x5a, sizeof io);
    io.known.struct_size = size;
    write_struct(&io.known, kDefaults, kFirst, "io");
    EXPECT_EQ(io.known.struct_size, size);
    EXPECT_EQ(io.known.a, 1);
    const auto* bytes = reinterpret_cast<const unsigned char*>(&io);
    for (size_t i = std::min<size_t>(size, sizeof(Known)); i < sizeof io; ++i)
      EXPECT_EQ(bytes[i], i < size ? 0 : 0x5a) << size;
  }
}

class ShimInit : public testing::TestWithParam<size_t> {};
INSTANTIATE_TEST_SUITE_P(Sizes, ShimInit, testing::Values(8, 12, 16, 24));

TEST_P(ShimInit, TouchesItsBytesAlone) {
  const size_t size = GetParam();
  Vector<unsigned char> bytes(64, 0x5a);
  auto* out = reinterpret_cast<Known*>(bytes.data());
  init_struct(out, size, kFirst, kDefaults, "config");
  EXPECT_EQ(out->struct_size, size);
  EXPECT_EQ(out->a, 1);
  for (size_t i = sizeof(Known); i < size; ++i) EXPECT_EQ(bytes[i], 0);
  for (size_t i = size; i < bytes.size(); ++i) EXPECT_EQ(bytes[i], 0x5a);
}

TEST(Shim, InitRefusesLessThanTheFirstVersion) {
  Known out = kDefaults;
  EXPECT_EQ(guard([&] { init_struct(&out, 7, kFirst, Known{}, "config"); }), Code::kArgument);
  EXPECT_EQ(out.b, 2);
}

struct Handle {
  static constexpr Tag kTag = Tag::kPool;
  static constexpr bool kOneAtATime = false;
  Tag tag = kTag;
  HostHooks hooks;
  mutable InUse in_use;
  char error[kErrorTextSize] = "";
};

TEST(Shim, CallKeepsTheHandlesTextAndTheHostsMode) {
  Handle h;
  EXPECT_EQ(call_on(&h, [] { need_index(5, 3, "i"); }), RDM_ERROR_RANGE);
  EXPECT_STREQ(h.error, "i: 5 is outside [0, 3)");
  EXPECT_EQ(call_on(&h, [] {}), RDM_OK);
  EXPECT_STREQ(h.error, "i: 5 is outside [0, 3)");
  EXPECT_EQ(call([] { throw 1; }), RDM_ERROR_INTERNAL);
}

TEST(Shim, OneCallChangesAHandleOrSeveralReadIt) {
  Handle h;
  const Handle& read = h;
  EXPECT_EQ(call_on(&h,
                    [&] {
                      EXPECT_EQ(call_on(&h, [] {}), RDM_ERROR_STATE);
                      EXPECT_EQ(call_on(&read, [] {}), RDM_ERROR_STATE);
                      EXPECT_FALSE(may_end(&h));
                    }),
            RDM_OK);
  EXPECT_EQ(call_on(&read,
                    [&] {
                      EXPECT_EQ(call_on(&read, [] {}), RDM_OK);
                      EXPECT_EQ(call_on(&h, [] {}), RDM_ERROR_STATE);
                      EXPECT_FALSE(may_end(&h));
                    }),
            RDM_OK);
  EXPECT_STREQ(h.error, "");
  EXPECT_EQ(call_on(&h, [] { throw 1; }), RDM_ERROR_INTERNAL);
  EXPECT_EQ(call_on(&h, [] {}), RDM_OK) << "a failure leaves it free";
  EXPECT_TRUE(may_end(&h));
}

TEST(Shim, WhoReadsWhileAnotherChangesIsTold) {
  Changes c;
  const auto read = [&] { return guard([&] { c.end_reading(c.begin_reading("it"), "it"); }); };
  EXPECT_EQ(read(), Code::kOk);
  const uint32_t begun = c.begin_reading("it");
  c.change("it", [&] {
    EXPECT_EQ(read(), Code::kState);
    EXPECT_STREQ(last_error(), "it is being changed by another call");
    EXPECT_EQ(guard([&] { c.change("it", [] {}); }), Code::kState);
  });
  EXPECT_EQ(guard([&] { c.end_reading(begun, "it"); }), Code::kState) << "begun before";
  EXPECT_EQ(read(), Code::kOk);
  EXPECT_EQ(guard([&] { c.change("it", [] { fail(Code::kRange, "no"); }); }), Code::kRange);
  EXPECT_EQ(read(), Code::kOk) << "a failure leaves it free";
}

TEST(Shim, OptionListsAreChecked) {
  const rdm_option list[2] = {{"a", nullptr, 1}, {"b", "x", 0}};
  EXPECT_EQ(read_options(list, 2, "options").size(), 2u);
  EXPECT_EQ(read_options(nullptr, 0, "options").size(), 0u);
  EXPECT_EQ(guard([&] { read_options(nullptr, 1, "options"); }), Code::kArgument);
  EXPECT_EQ(guard([&] { read_options(list, 4097, "options"); }), Code::kRange);
  EXPECT_EQ(guard([&] { read_options(list, -1, "options"); }), Code::kRange);
}

}  // namespace
}  // namespace rdm::capi
