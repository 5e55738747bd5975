#include <gtest/gtest.h>

#include "base/error.hpp"
#include "env/options/table.hpp"

namespace rdm {
namespace {

TEST(OptionTable, MakesKeysThatLast) {
  static OptionTable t;
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
}

TEST(OptionTable, ATaskMaySetADefaultOfItsOwn) {
  static OptionTable t;
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
  static OptionTable t;
  const OptionSpec row = number_option("", 1, 0, 10, "");
  EXPECT_EQ(
      guard([&] { t.add("joint", "a_name_that_is_far_too_long_for_the_room_that_a_key_has", "kp", row); }),
      Code::kInternal);
  EXPECT_EQ(t.count(), 0);
  for (int i = 0; i < OptionTable::kCapacity; ++i) t.add(row);
  EXPECT_EQ(guard([&] { t.add(row); }), Code::kInternal);
  EXPECT_EQ(guard([&] { t.add("a", "b", nullptr, row); }), Code::kInternal);
}

}  // namespace
}  // namespace rdm
