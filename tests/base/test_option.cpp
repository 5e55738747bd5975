#include <gtest/gtest.h>

#include <clocale>
#include <cmath>
#include <cstring>
#include <limits>
#include <string>

#include "base/error.hpp"
#include "base/option.hpp"
#include "comma_locale.hpp"

namespace rdm {
namespace {

constexpr OptionSpec kTable[] = {
    number_option("gamma", 0.96, 0, 1, "discount per control step"),
    integer_option("minibatches", 4, 1, 64, "parts of a pass"),
    flag_option("reset_noise", false, "random start poses"),
    text_option("object", "egg", "egg|ball|soup_can", "what is thrown"),
    text_option("note", "", nullptr, "free text"),
    number_option("learning_rate", 1e-3, 1e-8, 1, "Adam step", true),
    text_option("points", "0,0,0", nullptr, "a long text", 200),
};
constexpr OptionSpec kRanges[] = {
    drawable(number_option("mass", 0.1, 1e-3, 10, "kg")),
    drawable(integer_option("delay", 0, 0, 16, "steps")),
    open_option(drawable(number_option("noise.FIELD", 0, 0, 100, "deviation"))),
    {"friction", OptionKind::kNumber, 1, 0, 10, "0.5..1.5", nullptr, "a default that is drawn", false, 63,
     true},
};

Options made() {
  Options o;
  o.add_table(kTable, 7);
  return o;
}
Options drawn() {
  Options o;
  o.add_table(kRanges, 4);
  return o;
}
std::string lines(const Options& o) {
  std::string text(o.print_lines(nullptr, 0), '#');
  o.print_lines(text.data(), text.size() + 1);
  return text;
}
Code set(Options& o, const char* key, const char* text, double number = 0) {
  return guard([&] { o.set({key, text, number}, "task"); });
}
std::string printed(const Options& o, int32_t i) {
  char out[kOptionTextSize];
  o.print(i, out);
  return out;
}

TEST(Options, DefaultsStandUntilGiven) {
  Options o = made();
  EXPECT_EQ(o.count(), 7);
  EXPECT_EQ(o.number("gamma"), 0.96);
  EXPECT_EQ(o.integer("minibatches"), 4);
  EXPECT_FALSE(o.flag("reset_noise"));
  EXPECT_STREQ(o.text("object"), "egg");
  EXPECT_FALSE(o.given("gamma"));
  EXPECT_TRUE(o.spec(5).live);
  EXPECT_FALSE(o.spec(0).live);
  ASSERT_EQ(set(o, "gamma", nullptr, 0.5), Code::kOk);
  EXPECT_EQ(o.number("gamma"), 0.5);
  EXPECT_TRUE(o.given("gamma"));
  EXPECT_FALSE(o.given("unknown"));
}

TEST(Options, TextIsParsed) {
  Options o = made();
  EXPECT_EQ(set(o, "gamma", "2.5e-1"), Code::kOk);
  EXPECT_EQ(o.number("gamma"), 0.25);
  EXPECT_EQ(set(o, "minibatches", "16"), Code::kOk);
  EXPECT_EQ(o.integer("minibatches"), 16);
  EXPECT_EQ(set(o, "minibatches", "+8"), Code::kOk);
  EXPECT_EQ(o.integer("minibatches"), 8);
  for (const char* yes : {"true", "on", "1", "TRUE"}) {
    EXPECT_EQ(set(o, "reset_noise", yes), Code::kOk);
    EXPECT_TRUE(o.flag("reset_noise")) << yes;
    EXPECT_EQ(set(o, "reset_noise", "off"), Code::kOk);
    EXPECT_FALSE(o.flag("reset_noise"));
  }
  for (const char* bad : {"", "x", "0.5x", "0,5", "1 2", "true", "1e999", "+", "0x1"})
    EXPECT_EQ(set(o, "gamma", bad), Code::kArgument) << bad;
  EXPECT_EQ(o.number("gamma"), 0.25);
}

TEST(Options, BoundsAreInclusiveAndKept) {
  Options o = made();
  EXPECT_EQ(set(o, "gamma", nullptr, 0), Code::kOk);
  EXPECT_EQ(set(o, "gamma", nullptr, 1), Code::kOk);
  EXPECT_EQ(set(o, "gamma", nullptr, std::nextafter(1.0, 2.0)), Code::kRange);
  EXPECT_STREQ(last_error(), "task option gamma: 1.0000000000000002 is outside [0, 1]");
  EXPECT_EQ(set(o, "gamma", "-0.1"), Code::kRange);
  EXPECT_STREQ(last_error(), "task option gamma: -0.1 is outside [0, 1]");
  EXPECT_EQ(o.number("gamma"), 1.0);
  EXPECT_EQ(set(o, "minibatches", nullptr, 2.5), Code::kRange);
  EXPECT_EQ(set(o, "reset_noise", nullptr, 0.5), Code::kRange);
  EXPECT_EQ(set(o, "reset_noise", nullptr, 2), Code::kRange);
  for (const double v : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    EXPECT_EQ(set(o, "gamma", nullptr, v), Code::kArgument);
  EXPECT_EQ(set(o, "gamma", "nan"), Code::kArgument);
}

TEST(Options, ChoicesTakeTheSpellingOfTheTable) {
  Options o = made();
  EXPECT_EQ(set(o, "object", "Soup-Can"), Code::kOk);
  EXPECT_STREQ(o.text("object"), "soup_can");
  for (const char* bad : {"", "eg", "eggs", "egg|ball", "soup"})
    EXPECT_EQ(set(o, "object", bad), Code::kRange) << bad;
  EXPECT_STREQ(o.text("object"), "soup_can");
  EXPECT_EQ(set(o, "object", nullptr, 1), Code::kArgument);
}

TEST(Options, FreeTextHasAnEnd) {
  Options o = made();
  const std::string fits(kOptionTextSize - 1, 'a'), over(kOptionTextSize, 'a');
  EXPECT_EQ(set(o, "note", fits.c_str()), Code::kOk);
  EXPECT_EQ(o.text("note"), fits);
  EXPECT_EQ(set(o, "note", over.c_str()), Code::kRange);
  EXPECT_EQ(o.text("note"), fits);
}

TEST(Options, TextsAreOneLineOfUtf8) {
  Options o = made();
  EXPECT_EQ(set(o, "note", "caf\xC3\xA9"), Code::kOk);
  for (const char* bad : {"fro\xC9t", "\xC3", "two\nlines", "\x1B[31m", "\xC2\x85", "\xED\xA0\x80"})
    EXPECT_EQ(set(o, "note", bad), Code::kArgument) << bad;
  EXPECT_STREQ(o.text("note"), "caf\xC3\xA9");
}

TEST(Options, ALongTextIsKeptWholeAndPrintedCut) {
  Options o = made();
  const std::string fits(200, 'b'), over(201, 'b');
  EXPECT_EQ(set(o, "points", fits.c_str()), Code::kOk);
  EXPECT_EQ(set(o, "points", over.c_str()), Code::kRange);
  const Options copy = o;
  EXPECT_EQ(copy.text("points"), fits);
  EXPECT_EQ(printed(copy, 6), fits.substr(0, kOptionTextSize - 1));
  EXPECT_EQ(set(o, "points", "short"), Code::kOk);
  EXPECT_STREQ(o.text("points"), "short");
}

TEST(Options, AFlagSaysItsWords) {
  OptionSpec flag = flag_option("push", true, "");
  Options o;
  o.add_table(&flag, 1);
  EXPECT_EQ(guard([&] { o.set({"push", "yes", 0}, "task"); }), Code::kArgument);
  EXPECT_STREQ(last_error(), "task option push: 'yes' is not one of true, false, on, off, 1, 0");
}

TEST(Options, UnknownKeyNamesTheNearest) {
  Options o = made();
  EXPECT_EQ(set(o, "lerning-rate", nullptr, 1), Code::kNotFound);
  EXPECT_STREQ(last_error(), "task option lerning-rate: unknown; nearest is learning_rate");
  EXPECT_EQ(set(o, nullptr, nullptr, 1), Code::kArgument);
  EXPECT_EQ(set(o, std::string(5000, 'k').c_str(), nullptr, 1), Code::kNotFound);
  Options none;
  EXPECT_EQ(set(none, "gamma", nullptr, 1), Code::kNotFound);
}

TEST(Options, KeysMatchWithoutCaseAndHyphens) {
  Options o = made();
  EXPECT_EQ(set(o, "Learning-Rate", nullptr, 0.1), Code::kOk);
  EXPECT_EQ(o.number("learning_rate"), 0.1);
  EXPECT_TRUE(o.knows("LEARNING_RATE"));
  EXPECT_TRUE(same_name("hand-over", "HAND_over"));
  EXPECT_FALSE(same_name("hand", "hand_"));
  EXPECT_FALSE(same_name("hand_", "hand"));
}

TEST(Options, LaterDuplicatesWin) {
  Options o = made();
  set(o, "gamma", nullptr, 0.1);
  set(o, "GAMMA", nullptr, 0.2);
  EXPECT_EQ(o.number("gamma"), 0.2);
}

TEST(Options, DeclaredTwiceOrReadAsAnotherKindIsOurOwnFault) {
  Options o = made();
  EXPECT_EQ(guard([&] { o.add_table(kTable + 3, 1); }), Code::kInternal);
  EXPECT_EQ(guard([&] { o.integer("gamma"); }), Code::kInternal);
  EXPECT_EQ(guard([&] { o.text("unknown"); }), Code::kInternal);
}

TEST(Options, OwnDefaultsYieldToTheHost) {
  Options o = made();
  o.set_default("gamma", 0.9);
  o.set_default("object", "ball");
  EXPECT_EQ(o.number("gamma"), 0.9);
  EXPECT_STREQ(o.text("object"), "ball");
  EXPECT_FALSE(o.given("gamma"));
  set(o, "gamma", nullptr, 0.8);
  o.set_default("gamma", 0.7);
  EXPECT_EQ(o.number("gamma"), 0.8);
  EXPECT_EQ(guard([&] { o.set_default("minibatches", 1000); }), Code::kRange);
  EXPECT_EQ(guard([&] { o.set_default("unknown", 1.0); }), Code::kInternal);
}

TEST(Options, PrintReadsBack) {
  Options o = made();
  set(o, "gamma", nullptr, 0.123456789);
  set(o, "learning_rate", nullptr, 3e-4);
  EXPECT_EQ(printed(o, 0), "0.123456789");
  EXPECT_EQ(printed(o, 1), "4");
  EXPECT_EQ(printed(o, 2), "false");
  EXPECT_EQ(printed(o, 3), "egg");
  EXPECT_EQ(printed(o, 5), "0.0003");
  for (int32_t i = 0; i < o.count(); ++i)
    EXPECT_EQ(set(o, o.spec(i).key, printed(o, i).c_str()), Code::kOk) << o.spec(i).key;
  EXPECT_EQ(o.number("gamma"), 0.123456789);
}

TEST(Options, NumbersAreAsShortAsReadsBackExactly) {
  Options o = made();
  for (const double value : {0.0512345678901234, 1.0 / 3, 0.1, 1e-7, 0.1 + 0.2}) {
    set(o, "gamma", nullptr, value);
    const std::string text = printed(o, 0);
    EXPECT_EQ(std::stod(text), value) << text;
    EXPECT_LE(text.size(), 20u);
  }
  EXPECT_EQ(printed(o, 0), "0.30000000000000004");
  set(o, "gamma", nullptr, 0.1);
  EXPECT_EQ(printed(o, 0), "0.1");
}

TEST(Options, LinesAreLaidOverWhatWasGiven) {
  Options o = made();
  set(o, "gamma", nullptr, 0.5);
  o.set_lines("  gamma =\t0.25\r\n\n   \r\nObject=ball\nnote = a = b \nminibatches=8", "task");
  EXPECT_EQ(o.number("gamma"), 0.25);
  EXPECT_STREQ(o.text("object"), "ball");
  EXPECT_STREQ(o.text("note"), "a = b");
  EXPECT_EQ(o.integer("minibatches"), 8);
  o.set_lines("gamma=0.1\ngamma=0.2\n", "task");
  EXPECT_EQ(o.number("gamma"), 0.2);
  o.set_lines("note=", "task");
  EXPECT_STREQ(o.text("note"), "");
  o.set_lines(nullptr, "task");
  o.set_lines("", "task");
}

TEST(Options, ErrorsOfLinesNameTheKeyOrTheLine) {
  Options o = made();
  EXPECT_EQ(guard([&] { o.set_lines("gamma=0.1\n\ngama=1", "task"); }), Code::kNotFound);
  EXPECT_STREQ(last_error(), "task option gama: unknown; nearest is gamma");
  EXPECT_EQ(guard([&] { o.set_lines("\nnonsense\n", "task"); }), Code::kArgument);
  EXPECT_STREQ(last_error(), "settings line 2: 'nonsense' is not key=value");
  EXPECT_EQ(guard([&] { o.set_lines("gamma=2", "task"); }), Code::kRange);
  EXPECT_EQ(guard([&] { o.set_lines("gamma=", "task"); }), Code::kArgument);
  EXPECT_EQ(guard([&] { o.set_lines("=1", "task"); }), Code::kNotFound);
}

TEST(Options, LinesReadBackWhole) {
  Options o = made();
  o.set_lines(("points=  " + std::string(150, 'p') + " \ngamma=0.0512345678901234\nnote= x y ").c_str(),
              "task");
  const size_t length = o.print_lines(nullptr, 0);
  std::string text(length + 1, '#'), less(length, '#');
  EXPECT_EQ(o.print_lines(less.data(), length), length);
  EXPECT_EQ(less, std::string(length, '#'));
  EXPECT_EQ(o.print_lines(text.data(), length + 1), length);
  EXPECT_EQ(std::strlen(text.c_str()), length);
  Options back = made();
  back.set_lines(text.c_str(), "task");
  EXPECT_EQ(back.number("gamma"), 0.0512345678901234);
  EXPECT_EQ(back.text("points"), std::string(150, 'p'));
  EXPECT_STREQ(back.text("note"), "x y");
  std::string again(length + 1, '#');
  back.print_lines(again.data(), length + 1);
  EXPECT_EQ(again, text);
}

TEST(Options, ARangeIsTwoNumbersInOneText) {
  Options o = drawn();
  EXPECT_FALSE(o.range("mass").drawn());
  EXPECT_EQ(o.range("mass").low, 0.1);
  EXPECT_EQ(o.range("mass").high, 0.1);
  struct Case {
    const char* text;
    double low, high;
  };
  const Case cases[] = {{"0.7..1.3", 0.7, 1.3},    {"1..3", 1, 3},         {"1e-2..1e0", 0.01, 1},
                        {"0.5 .. +2", 0.5, 2},     {".25...5", 0.25, 0.5}, {"0.001..10", 0.001, 10},
                        {"0.25..0.25", 0.25, 0.25}};
  for (const Case& c : cases) {
    EXPECT_EQ(set(o, "mass", c.text), Code::kOk) << c.text;
    EXPECT_EQ(o.range("mass").low, c.low) << c.text;
    EXPECT_EQ(o.range("mass").high, c.high) << c.text;
    EXPECT_DOUBLE_EQ(o.number("mass"), (c.low + c.high) / 2) << c.text;
  }
  EXPECT_EQ(printed(o, 0), "0.25");
  EXPECT_EQ(set(o, "delay", "2..5"), Code::kOk);
  EXPECT_EQ(o.integer("delay"), 3);
  EXPECT_EQ(set(o, "delay", nullptr, 4), Code::kOk);
  EXPECT_FALSE(o.range("delay").drawn());
  EXPECT_EQ(o.integer("delay"), 4);
}

TEST(Options, ARangeThatIsNoneIsAnError) {
  Options o = drawn();
  for (const char* bad : {"..", "1..", "..1", "1..x", "x..1", "0.1..0.2..0.3", "1. .2", "nan..1", "1..inf"})
    EXPECT_EQ(set(o, "mass", bad), Code::kArgument) << bad;
  EXPECT_EQ(set(o, "mass", "1.3..0.7"), Code::kRange);
  EXPECT_STREQ(last_error(), "task option mass: the range 1.3..0.7 begins above its end");
  EXPECT_EQ(set(o, "mass", "0..1"), Code::kRange);
  EXPECT_STREQ(last_error(), "task option mass: 0 is outside [0.001, 10]");
  EXPECT_EQ(set(o, "mass", "1..11"), Code::kRange);
  EXPECT_EQ(set(o, "delay", "1..2.5"), Code::kRange);
  EXPECT_EQ(o.range("mass").high, 0.1);
  Options plain = made();
  EXPECT_EQ(set(plain, "gamma", "0.1..0.2"), Code::kArgument);
  EXPECT_STREQ(last_error(), "task option gamma: it takes one number, not a range");
  EXPECT_EQ(set(plain, "reset_noise", "0..1"), Code::kArgument);
}

TEST(Options, RangesReadBack) {
  Options o = drawn();
  EXPECT_EQ(printed(o, 3), "0.5..1.5");
  EXPECT_FALSE(o.given("friction"));
  set(o, "mass", "0.0512345678901234..0.30000000000000004");
  set(o, "delay", "1..3");
  EXPECT_EQ(lines(o), "mass=0.0512345678901234..0.30000000000000004\ndelay=1..3\nfriction=0.5..1.5\n");
  Options back = drawn();
  back.set_lines(lines(o).c_str(), "task");
  EXPECT_EQ(lines(back), lines(o));
  EXPECT_EQ(back.range("mass").low, 0.0512345678901234);
  EXPECT_EQ(back.range("mass").high, 0.1 + 0.2);
  set(o, "mass", "-0x", 0);
  o.set_default("mass", "0.2..0.4");  // it was given
  EXPECT_EQ(o.range("mass").high, 0.1 + 0.2);
  back.set_default("friction", "0.9..1.1");
  EXPECT_EQ(drawn().range("friction").low, 0.5);
}

TEST(Options, ARangeIsDrawnFromItsStreamASingleNumberIsNot) {
  Options o = drawn();
  Stream stream(1, 0, Purpose::kTest);
  EXPECT_EQ(o.range("mass").draw(stream), 0.1);
  EXPECT_EQ(o.range("delay").draw_integer(stream), 0);
  EXPECT_EQ(stream.counter(), 0u);
  set(o, "mass", "0.7..1.3");
  set(o, "delay", "2..4");
  int32_t seen[5] = {};
  double sum = 0;
  for (int i = 0; i < 3000; ++i) {
    const double x = o.range("mass").draw(stream);
    ASSERT_TRUE(x >= 0.7 && x < 1.3);
    sum += x;
    const int32_t k = o.range("delay").draw_integer(stream);
    ASSERT_TRUE(k >= 2 && k <= 4);
    ++seen[k];
  }
  EXPECT_NEAR(sum / 3000, 1, 0.02);
  for (int k = 2; k <= 4; ++k) EXPECT_NEAR(seen[k], 1000, 150) << k;
}

TEST(Options, AnOpenRowTakesAnyName) {
  Options o = drawn();
  EXPECT_EQ(set(o, "noise.tip", "0.1..0.2"), Code::kOk);
  EXPECT_EQ(set(o, "Noise.right.*_tip_*", nullptr, 3), Code::kOk);
  ASSERT_EQ(o.count(), 6);
  EXPECT_STREQ(o.key(4), "noise.tip");
  EXPECT_STREQ(o.open_name(4), "tip");
  EXPECT_STREQ(o.open_name(5), "right.*_tip_*");
  EXPECT_EQ(o.open_name(2), nullptr);
  EXPECT_EQ(o.range(4).high, 0.2);
  EXPECT_EQ(o.range(5).low, 3);
  EXPECT_TRUE(o.given("noise.tip"));
  EXPECT_EQ(set(o, "noise.tip", nullptr, 101), Code::kRange);
  EXPECT_STREQ(last_error(), "task option noise.tip: 101 is outside [0, 100]");
  EXPECT_EQ(set(o, "noise.", nullptr, 1), Code::kNotFound);
  EXPECT_EQ(set(o, "noise", nullptr, 1), Code::kNotFound);
  EXPECT_EQ(set(o, "noisy.tip", nullptr, 1), Code::kNotFound);
  EXPECT_EQ(set(o, ("noise." + std::string(60, 'x')).c_str(), nullptr, 1), Code::kRange);
  EXPECT_EQ(set(o, "noise.a\nb", nullptr, 1), Code::kArgument);
  EXPECT_EQ(set(o, "noise.a=b", nullptr, 1), Code::kArgument);
  EXPECT_EQ(o.count(), 6);
}

TEST(Options, OfOpenKeysTheLastLineIsTheLastRow) {
  Options o = drawn();
  o.set_lines("noise.a=1\nnoise.*=2\nnoise.a=3\nnoise.FIELD=0\nnoise.b=4", "task");
  EXPECT_EQ(lines(o), "mass=0.1\ndelay=0\nfriction=0.5..1.5\nnoise.*=2\nnoise.a=3\nnoise.b=4\n");
  Options back = drawn();
  back.set_lines(lines(o).c_str(), "task");
  EXPECT_EQ(lines(back), lines(o));
}

TEST(Options, DecimalPointInEveryLocale) {
  const CommaLocale locale;
  if (!locale.set()) GTEST_SKIP() << "no locale with a decimal comma is installed, and none can be made";
  Options o = made();
  EXPECT_EQ(set(o, "gamma", "0.25"), Code::kOk);
  EXPECT_EQ(o.number("gamma"), 0.25);
  EXPECT_EQ(printed(o, 0), "0.25");
}

}  // namespace
}  // namespace rdm
