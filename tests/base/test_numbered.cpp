// Numbers that come again only behind all others, rows as many as there are things.
#include <gtest/gtest.h>

#include <string>

#include "base/error.hpp"
#include "base/numbered.hpp"

namespace rdm {
namespace {

Code code_of(void (*f)(Numbered<int>&), Numbered<int>& list) {
  return guard([&] { f(list); });
}
void remove(Numbered<int>& list, int32_t number) {
  int what = 0;
  list.listed(number).listed = false;
  EXPECT_TRUE(list.release(number, &what));
}

TEST(Numbered, ANumberComesAgainBehindAllOthers) {
  Numbered<int> list("thing", 3, 8);
  EXPECT_EQ(list.count(), 3);
  for (int32_t i = 3; i < 8; ++i) {
    EXPECT_EQ(list.add(i), i);
    EXPECT_EQ(list.count(), i + 1);
    if (i != 4) remove(list, i);
  }
  EXPECT_EQ(list.count(), 5) << "one behind the last that is listed";
  // again, past the one that is in use
  for (const int32_t number : {3, 5, 6, 7, 3, 5}) {
    EXPECT_EQ(list.add(10 + number), number);
    EXPECT_EQ(list.row(number).what, 10 + number);
    EXPECT_EQ(list.row(4).what, 4);
    remove(list, number);
  }
}

TEST(Numbered, AsManyAsThereAreNumbersAndNoMore) {
  Numbered<int> list("thing", 3, 8);
  for (int32_t i = 3; i < 8; ++i) list.add(i);
  const auto add = [](Numbered<int>& l) { l.add(9); };
  EXPECT_EQ(code_of(add, list), Code::kRange);
  EXPECT_STREQ(last_error(), "thing: all 5 numbers are in use");
  remove(list, 6);
  EXPECT_EQ(list.add(60), 6);
  EXPECT_EQ(code_of(add, list), Code::kRange);
  for (int32_t i = 3; i < 8; ++i) EXPECT_EQ(list.row(i).what, i == 6 ? 60 : i);
}

TEST(Numbered, WhatWasDestroyedIsToldFromWhatNeverWas) {
  Numbered<int> list("thing", 3, 8);
  list.add(1);
  list.add(2);
  remove(list, 4);
  EXPECT_EQ(code_of([](Numbered<int>& l) { l.listed(4); }, list), Code::kNotFound);
  EXPECT_STREQ(last_error(), "thing 4 was destroyed");
  for (const auto outside :
       {+[](Numbered<int>& l) { l.listed(5); }, +[](Numbered<int>& l) { l.listed(-1); }}) {
    EXPECT_EQ(code_of(outside, list), Code::kRange);
    EXPECT_NE(std::string(last_error()).find("is outside [0, 5)"), std::string::npos) << last_error();
  }
}

TEST(Numbered, ARowGoesWithItsLastUser) {
  Numbered<int> list("thing", 0, 3);
  list.add(7);
  ++list.listed(0).users;
  list.listed(0).listed = false;
  EXPECT_EQ(list.count(), 0);
  int what = 0;
  EXPECT_FALSE(list.release(0, &what));
  for (const int32_t number : {1, 2, 1}) {  // 0 is in use still
    EXPECT_EQ(list.add(8), number);
    remove(list, number);
  }
  EXPECT_TRUE(list.release(0, &what));
  EXPECT_EQ(what, 7);
  EXPECT_EQ(list.add(9), 2);
  EXPECT_EQ(list.add(9), 0);
}

}  // namespace
}  // namespace rdm
