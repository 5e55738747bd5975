#include <gtest/gtest.h>

#include <iterator>

#include "base/error.hpp"
#include "base/option_rows.hpp"

namespace rdm {
namespace {

enum class Shape { kEgg, kBox };
struct Base {
  int32_t steps;
  bool noisy;
};
struct Values : Base {
  double mass;
  OptionRange friction, delay;
  Shape shape;
  bool open;
  const char* name;
};

constexpr auto kBase =
    option_rows<Base>(row<&Base::steps>(basic(integer_option("steps", 75, 1, 1000, "steps"))),
                      row<&Base::noisy>(flag_option("noisy", true, "noise")));
// A list may be made with numbers of its own.
consteval auto rows_of(double mass) {
  return option_rows<Values>(
      kBase, row<&Values::mass>(number_option("mass", mass, 0, 10, "kg")),
      row<&Values::friction>(drawable(number_option("friction", 1, 0, 10, "coefficient"))),
      row<&Values::delay>(drawable(integer_option("delay", 0, 0, 16, "steps"))),
      row<&Values::shape, Shape::kEgg, Shape::kBox, Shape::kBox>(
          legacy(text_option("shape", "egg", "egg|box|cube", "of the object"))),
      row<&Values::open, false, true>(text_option("lid", "shut", "shut|open", "of the box")),
      row<&Values::name>(text_option("name", "first", nullptr, "of the object")));
}
constexpr auto kRows = rows_of(0.1);

template <class Rows>
Options made(const Rows& rows, const char* lines = "") {
  Options o;
  o.add_table(rows.data(), static_cast<int32_t>(rows.size()));
  o.set_lines(lines, "task");
  return o;
}

TEST(OptionRows, TheTableHasTheRowsAsTheyWereSaidInTheirOrder) {
  const char* const keys[] = {"steps", "noisy", "mass", "friction", "delay", "shape", "lid", "name"};
  ASSERT_EQ(kRows.size(), std::size(keys));
  for (size_t i = 0; i < std::size(keys); ++i) EXPECT_STREQ(kRows.specs[i].key, keys[i]);
  EXPECT_EQ(kRows.specs[0].level, OptionLevel::kBasic);
  EXPECT_EQ(kRows.specs[2].number, 0.1);
  EXPECT_TRUE(kRows.specs[3].range);
  EXPECT_STREQ(kRows.specs[5].choices, "egg|box|cube");
  EXPECT_EQ(kRows.specs[5].level, OptionLevel::kLegacy);
}

TEST(OptionRows, EachMemberHasTheDefaultOrWhatWasGiven) {
  const Options plain = made(kRows);
  const Values v = kRows.read(plain);
  EXPECT_EQ(v.steps, 75);
  EXPECT_TRUE(v.noisy);
  EXPECT_EQ(v.mass, 0.1);
  EXPECT_EQ(v.friction.low, 1);
  EXPECT_FALSE(v.friction.drawn());
  EXPECT_EQ(v.shape, Shape::kEgg);
  EXPECT_FALSE(v.open);
  EXPECT_STREQ(v.name, "first");

  const Options given =
      made(kRows,
           "steps=7\nnoisy=off\nmass=2\nfriction=0.5..1.5\ndelay=1..3\nshape=Box\nlid=open\n"
           "name=second");
  const Values w = kRows.read(given);
  EXPECT_EQ(w.steps, 7);
  EXPECT_FALSE(w.noisy);
  EXPECT_EQ(w.mass, 2);
  EXPECT_EQ(w.friction.low, 0.5);
  EXPECT_EQ(w.friction.high, 1.5);
  EXPECT_EQ(w.delay.high, 3);
  EXPECT_EQ(w.shape, Shape::kBox);
  EXPECT_TRUE(w.open);
  EXPECT_STREQ(w.name, "second");
}

TEST(OptionRows, SeveralWordsMayStandForOne) {
  EXPECT_EQ(kRows.read(made(kRows, "shape=cube")).shape, Shape::kBox);
}

TEST(OptionRows, AListWithOtherDefaultsIsTheSameElse) {
  constexpr auto kOther =
      kRows.with<&Values::steps>(9).with<&Values::noisy>(false).with<&Values::name>("other");
  const Options o = made(kOther);
  const Values v = kOther.read(o);
  EXPECT_EQ(v.steps, 9);
  EXPECT_FALSE(v.noisy);
  EXPECT_STREQ(v.name, "other");
  EXPECT_EQ(v.mass, 0.1);
  EXPECT_EQ(kRows.specs[0].number, 75);
}

TEST(OptionRows, APartOfAListReadsItsOwnMembers) {
  EXPECT_EQ(kBase.read(made(kRows, "steps=3")).steps, 3);
}

TEST(OptionRows, OptionsMayBeWithoutThem) {
  EXPECT_TRUE(kBase.known_to(made(kRows)));
  EXPECT_FALSE(kBase.known_to(Options()));
}

// Where none of these holds, row<...>() does not compile.
static_assert(OptionValue<double>::fits(number_option("a", 0, 0, 1, "")));
static_assert(!OptionValue<double>::fits(integer_option("a", 0, 0, 1, "")));
static_assert(!OptionValue<double>::fits(drawable(number_option("a", 0, 0, 1, ""))));
static_assert(!OptionValue<int32_t>::fits(number_option("a", 0, 0, 1, "")));
static_assert(!OptionValue<int32_t>::fits(drawable(integer_option("a", 0, 0, 1, ""))));
static_assert(!OptionValue<OptionRange>::fits(number_option("a", 0, 0, 1, "")));
static_assert(!OptionValue<bool>::fits(integer_option("a", 0, 0, 1, "")));
static_assert(!OptionValue<const char*>::fits(flag_option("a", false, "")));
static_assert(OptionWords<bool, true, false>::fits(text_option("a", "on", "on|off", "")));
static_assert(!OptionWords<bool, true, false>::fits(text_option("a", "on", "on|off|auto", "")));
static_assert(!OptionWords<bool, true, false>::fits(text_option("a", "on", nullptr, "")));

TEST(OptionRows, AWordIsItsPlaceAmongTheChoices) {
  constexpr OptionSpec kWords[] = {text_option("shape", "Box", "egg|box", ""),
                                   text_option("note", "", nullptr, ""),
                                   text_option("wrong", "ball", "egg|box", "")};
  Options o;
  o.add_table(kWords, 3);
  EXPECT_EQ(o.word("shape"), 1);
  o.set({"shape", "EGG", 0}, "task");
  EXPECT_EQ(o.word("shape"), 0);
  EXPECT_EQ(guard([&] { o.word("note"); }), Code::kInternal);
  EXPECT_EQ(guard([&] { o.word("wrong"); }), Code::kInternal);
}

}  // namespace
}  // namespace rdm
