#include <gtest/gtest.h>

#include "base/error.hpp"
#include "env/option_table.hpp"

namespace rdm {
namespace {

TEST(OptionTable, MakesKeysThatLast) {
  static SizedOptionTable<8> t;
  const OptionSpec rows[] = {number_option("alpha", 50, 0, 100, "weight"),
                             flag_option("beta", true, "switch")};
  t.add(rows);
  {
    const std::string name = "FFJ2";
    t.add("joint", name.c_str(), "kp", number_option("", 1, 0, 10, "stiffness"));
    t.add("start", "x", nullptr, number_option("", 0, -1, 1, "m"));
  }
  ASSERT_EQ(t.count(), 4);
  EXPECT_STREQ(t.rows()[2].key, "joint.FFJ2.kp");
  EXPECT_STREQ(t.rows()[3].key, "start.x");
  Options o;
  o.add_table(t.rows(), t.count());
  o.set({"JOINT.ffj2.KP", nullptr, 3}, "test");
  EXPECT_EQ(o.number("joint.FFJ2.kp"), 3);
  EXPECT_EQ(o.number("alpha"), 50);
  EXPECT_TRUE(t.has("joint.ffj2.kp"));
  EXPECT_FALSE(t.has("joint.FFJ2"));
}

TEST(OptionTable, ATaskMaySetADefaultOfItsOwn) {
  static SizedOptionTable<8> t;
  const OptionSpec rows[] = {number_option("alpha", 50, 0, 100, "weight")};
  t.add(rows);
  t.set_default("alpha", 7);
  Options o;
  o.add_table(t.rows(), t.count());
  EXPECT_EQ(o.number("alpha"), 7);
  EXPECT_FALSE(o.given("alpha"));
  EXPECT_EQ(guard([] { t.set_default("beta", 1); }), Code::kInternal);
}

TEST(OptionTable, RefusesWhatDoesNotFit) {
  static SizedOptionTable<8> t;
  const OptionSpec row = number_option("", 1, 0, 10, "");
  EXPECT_EQ(
      guard([&] { t.add("joint", "a_name_that_is_far_too_long_for_the_room_that_a_key_has", "kp", row); }),
      Code::kInternal);
  EXPECT_EQ(t.count(), 0);
  for (int i = 0; i < 8; ++i) t.add(row);
  EXPECT_EQ(guard([&] { t.add(row); }), Code::kInternal);
  EXPECT_EQ(guard([&] { t.add("a", "b", nullptr, row); }), Code::kInternal);
  static SizedOptionTable<4, 96> letters;
  const std::string half(40, 'k');
  for (int i = 0; i < 2; ++i) letters.add(half.c_str(), i ? "b" : "a", nullptr, row);
  EXPECT_EQ(guard([&] { letters.add(half.c_str(), "c", nullptr, row); }), Code::kInternal);
  EXPECT_EQ(letters.count(), 2);
}

}  // namespace
}  // namespace rdm
