#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <cstring>
#include <string>

#include "base/error.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

std::string cleaned(const std::string& s) {
  char out[64];
  EXPECT_TRUE(clean_text(out, sizeof out, s.c_str()));
  return out;
}

TEST(Text, GoodTextStays) {
  for (const char* good : {"", "plain", "caf\u00e9 \u20ac \U0001F916", "\u07ff\u0800\uffff\U0010ffff"})
    EXPECT_EQ(cleaned(good), good);
}

TEST(Text, ControlCharactersBecomeSpaces) {
  EXPECT_EQ(cleaned("a\x1b[31mb\r\nc\td\x7f"), "a [31mb  c d ");
  EXPECT_EQ(cleaned("a\u0080b\u009bc\u00a0"), "a  b  c\u00a0");  // C1, then the first character beyond
}

TEST(Text, ForeignBytesAreWrittenOneByOne) {
  EXPECT_EQ(cleaned("\xff\xfez"), R"(\xff\xfez)");
  EXPECT_EQ(cleaned("\xc0\xafz"), R"(\xc0\xafz)");                          // overlong
  EXPECT_EQ(cleaned("\xe0\x9f\xbfz"), R"(\xe0\x9f\xbfz)");                  // overlong
  EXPECT_EQ(cleaned("\xed\xa0\x80z"), R"(\xed\xa0\x80z)");                  // a surrogate
  EXPECT_EQ(cleaned("\xf4\x90\x80\x80\xf5z"), R"(\xf4\x90\x80\x80\xf5z)");  // above U+10FFFF
  EXPECT_EQ(cleaned("\xc3 \xe2\x82 \x80z"), R"(\xc3 \xe2\x82 \x80z)");      // not whole, in the middle
  EXPECT_EQ(cleaned("x\xc3"), R"(x\xc3)");                                  // not whole, at the end
  EXPECT_EQ(cleaned("x\xe2\x82"), R"(x\xe2\x82)");
}

TEST(Text, CleanTextIsCutBetweenCharacters) {
  const std::string text = "a\u00e9\xffz";  // 1 + 2 + 4 + 1 bytes
  const size_t whole[] = {0, 1, 1, 3, 3, 3, 3, 7, 8, 8};
  for (size_t room = 0; room < std::size(whole); ++room) {
    char out[16];
    std::memset(out, 'x', sizeof out);
    EXPECT_EQ(clean_text(out, room + 1, text.c_str()), room >= 8) << room;
    EXPECT_EQ(std::string(out), std::string("a\u00e9\\xffz").substr(0, whole[room])) << room;
    EXPECT_EQ(out[room + 1], 'x') << room;
  }
}

TEST(Text, CopiesAreCutBetweenCharacters) {
  const std::string text = "a\u00e9\u20ac\U0001F916z";  // 1 + 2 + 3 + 4 + 1 bytes
  const size_t whole[] = {0, 1, 1, 3, 3, 3, 6, 6, 6, 6, 10, 11, 11};
  for (size_t room = 0; room < std::size(whole); ++room) {
    char out[16];
    std::memset(out, 'x', sizeof out);
    copy_text(out, room + 1, text.c_str());
    EXPECT_EQ(std::string(out), text.substr(0, whole[room])) << room;
    EXPECT_EQ(out[room + 1], 'x') << room;
  }
  char out[4];
  copy_text(out, sizeof out, "\x80\x80\x80\x80\x80");  // no characters at all: cut at the byte
  EXPECT_EQ(std::strlen(out), 3u);
}

TEST(Text, QuotedNamesAreShort) {
  EXPECT_STREQ(Quoted("egg").text, "egg");
  EXPECT_STREQ(Quoted(nullptr).text, "NULL");
  const std::string full(64, 'n');
  EXPECT_EQ(Quoted(full.c_str()).text, full);
  EXPECT_EQ(Quoted((full + "n").c_str()).text, full + "...");
  std::string accents = "x";
  for (int i = 0; i < 40; ++i) accents += "\u00e9";
  EXPECT_EQ(Quoted(accents.c_str()).text, accents.substr(0, 63) + "...");
}

TEST(Text, NumbersReadBackExactly) {
  for (const double v : {0.1, 1e5, 1048576.0, 2147483647.0, 68719476736.0, 1.0 / 3, 1e-300, -1.7e308}) {
    const Number n(v);
    EXPECT_EQ(std::strtod(n.text, nullptr), v) << n.text;
  }
  EXPECT_STREQ(Number(100000).text, "100000");
  EXPECT_STREQ(Number(0.1).text, "0.1");
  EXPECT_STREQ(Number(68719476736.0).text, "68719476736");
  EXPECT_STREQ(Number(std::nextafter(1.0, 2.0)).text, "1.0000000000000002");
  EXPECT_STREQ(Number(std::nan("")).text, "nan");
}

TEST(Text, ErrorTextsEndWithAWholeCharacter) {
  for (size_t shift = 0; shift < 4; ++shift) {
    std::string longer(shift, 'x');
    for (int i = 0; i < 100; ++i) longer += "\U0001F916";
    EXPECT_EQ(guard([&] { fail(Code::kIo, "%s", longer.c_str()); }), Code::kIo);
    const std::string text = last_error();
    EXPECT_EQ(text, longer.substr(0, text.size()));
    EXPECT_EQ(text.size() % 4, shift);
    set_last_error(longer.c_str());
    EXPECT_EQ(last_error(), text);
  }
}

}  // namespace
}  // namespace rdm
