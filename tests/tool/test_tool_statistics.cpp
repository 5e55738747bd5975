// Numbers over episodes and runs, each on cases that can be worked out by hand. That they are Python's is for
// test_python_stats to say, which asks the tool.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <utility>

#include "common/statistics.hpp"

namespace {

using namespace tool;

void expect_interval(const Interval& i, double low, double high) {
  EXPECT_DOUBLE_EQ(i.low, low);
  EXPECT_DOUBLE_EQ(i.high, high);
}

TEST(Statistics, MeansAndTheirErrors) {
  EXPECT_EQ(mean_of({1, 2, 3, 6}), 3);
  EXPECT_DOUBLE_EQ(deviation_of({1, 2, 3, 6}), std::sqrt(14.0 / 3));  // squares about 3: 4, 1, 0, 9
  EXPECT_DOUBLE_EQ(standard_error_of({1, 2, 3, 6}), std::sqrt(14.0 / 3 / 4));
  EXPECT_EQ(standard_error_of({5, 5}), 0);
  EXPECT_TRUE(std::isnan(standard_error_of({5})));
  EXPECT_TRUE(std::isnan(deviation_of({})));
  EXPECT_TRUE(std::isnan(mean_of({})));
}

TEST(Statistics, TheMiddleHalf) {
  EXPECT_EQ(iqm_of({8, 1, 6, 3, 5, 4, 7, 2}), 4.5);  // of 3, 4, 5, 6
  EXPECT_EQ(iqm_of({0, 1, 5, 1000}), 3);
  EXPECT_EQ(iqm_of({1, 2, 6}), 3);  // floor(3 / 4) are left out
  EXPECT_EQ(iqm_of(Strata{{0, 1}, {5, 1000}}), 3);
  EXPECT_EQ(iqm_of(Sample{2.5}), 2.5);
  EXPECT_TRUE(std::isnan(iqm_of(Sample{})));
  EXPECT_TRUE(std::isnan(iqm_of({1, std::nan("")})));
}

TEST(Statistics, QuantilesLieOnLinesBetweenValues) {
  const Sample eleven = {10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0};
  EXPECT_EQ(quantile_of(eleven, 0.5), 5);
  EXPECT_DOUBLE_EQ(quantile_of(eleven, 0.9), 9);
  EXPECT_DOUBLE_EQ(quantile_of(eleven, 0.99), 9.9);
  EXPECT_EQ(quantile_of({3, 1}, 0), 1);
  EXPECT_EQ(quantile_of({3, 1}, 1), 3);
  EXPECT_EQ(quantile_of({7}, 0.9), 7);
}

TEST(Statistics, TheWorstTenth) {
  Sample values;
  for (int i = 0; i < 15; ++i) values.push_back(i);
  EXPECT_DOUBLE_EQ(cvar_of(values), (14 + 0.5 * 13) / 1.5);
  for (int i = 15; i < 20; ++i) values.push_back(i);
  EXPECT_DOUBLE_EQ(cvar_of(values), 18.5);
  EXPECT_DOUBLE_EQ(cvar_of(values, 1), 9.5);  // of all it is the mean
  EXPECT_EQ(cvar_of({0, 6, 3}), 6);           // of less than ten the largest
  EXPECT_TRUE(std::isnan(cvar_of({})));
}

TEST(Statistics, AnIntervalDrawsRunsWithinTasks) {
  // of {0, 1} and {10, 10} a quarter of the draws is {0, 0, 10, 10}: 5, the others leave out a lowest: 5.5
  expect_interval(iqm_interval({{0, 1}, {10, 10}}), 5, 5.5);
  expect_interval(iqm_interval({{0, 1}, {10, 10}}, 0.4), 5.5, 5.5);
  // of {0, 1} alone 0, 1/2 and 1 with 1/4, 1/2 and 1/4
  expect_interval(iqm_interval({{0, 1}}), 0, 1);
  expect_interval(iqm_interval({{0, 1}}, 0.4), 0.5, 0.5);
  expect_interval(iqm_interval({{3, 3, 3}, {3, 3}}), 3, 3);
  EXPECT_TRUE(std::isnan(iqm_interval({{1, 2}, {1}}).low));
  EXPECT_TRUE(std::isnan(iqm_interval({{1, std::nan("")}}).high));
  EXPECT_TRUE(std::isnan(iqm_interval({}).low));
}

TEST(Statistics, TheDrawsAreNumpys) {
  // numpy.random.RandomState(0).randint(5, size=(2, 5)), of 10,000 of which these are the first
  const std::vector<uint32_t> said = {4, 0, 3, 3, 3, 1, 3, 2, 4, 0};
  std::vector<uint32_t> drawn;
  const auto note = [&](const Draw& rows, double* out) {
    drawn.insert(drawn.end(), rows[0], rows[0] + 5);
    *out = 0;
  };
  bootstrap({5}, 1, note);
  ASSERT_EQ(drawn.size(), 50'000u);
  EXPECT_EQ(std::vector<uint32_t>(drawn.begin(), drawn.begin() + 10), said);
  const std::vector<uint32_t> first = std::exchange(drawn, {});
  bootstrap({5}, 1, note);
  EXPECT_EQ(drawn, first);  // the same in every call
  EXPECT_EQ(std::set<uint32_t>(drawn.begin(), drawn.end()), std::set<uint32_t>({0, 1, 2, 3, 4}));
}

TEST(Statistics, ADifferenceIsOfDrawsOfBoth) {
  expect_interval(difference_interval({{5, 5}}, {{3, 3}}), 2, 2);
  // {0, 1} less {0, 1}: -1 and 1 with 1/16 each, more than a fortieth
  expect_interval(difference_interval({{0, 1}}, {{0, 1}}), -1, 1);
  expect_interval(difference_interval({{0, 1}}, {{0, 1}}, 0.8), -0.5, 0.5);
  EXPECT_TRUE(std::isnan(difference_interval({{1, 2}}, {{1}}).low));
}

TEST(Statistics, ImprovementCountsPairs) {
  // 1 = 1, 1 < 3, 2 > 1, 2 < 3: a half and a whole of four
  EXPECT_EQ(improvement_of({{1, 2}}, {{1, 3}}).probability, 0.375);
  EXPECT_EQ(improvement_of({{1, 2}, {5, 5}}, {{1, 3}, {0, 0, 0}}).probability, (0.375 + 1) / 2);
  expect_interval(improvement_of({{1, 2, 3}}, {{0, 0}}).interval, 1, 1);
  // a draw of a is {0, 0}, {0, 1}, {1, 1} with 1/4, 1/2, 1/4
  const Improvement one = improvement_of({{0, 1}}, {{0.5, 0.5}});
  EXPECT_EQ(one.probability, 0.5);
  expect_interval(one.interval, 0, 1);
  expect_interval(improvement_of({{0, 1}}, {{0.5, 0.5}}, 0.4).interval, 0.5, 0.5);
  EXPECT_EQ(improvement_of({{1}}, {{0, 2}}).probability, 0.5);
  EXPECT_TRUE(std::isnan(improvement_of({{1}}, {{0, 2}}).interval.low));
}

using Letters = std::vector<std::string>;

// Of pairs that are told apart.
Letters letters(size_t count, const std::set<std::pair<size_t, size_t>>& pairs) {
  return group_letters(count, [&](size_t i, size_t j) { return pairs.count({i, j}) > 0; });
}

TEST(Statistics, GroupsHoldWhatIsNotToldApart) {
  EXPECT_EQ(letters(3, {}), Letters({"a", "a", "a"}));
  EXPECT_EQ(letters(3, {{0, 1}, {0, 2}, {1, 2}}), Letters({"a", "b", "c"}));
  EXPECT_EQ(letters(3, {{0, 2}}), Letters({"a", "ab", "b"}));
  EXPECT_EQ(letters(3, {{0, 1}}), Letters({"a", "b", "ab"}));  // the third is known too badly
  EXPECT_EQ(letters(4, {{0, 2}, {0, 3}, {1, 3}}), Letters({"a", "ab", "bc", "c"}));
  EXPECT_EQ(letters(0, {}), Letters());
  // every graph of five rows: two share a letter if and only if they are not told apart, and no group is part of another
  for (unsigned graph = 0; graph < 1u << 10; ++graph) {
    std::set<std::pair<size_t, size_t>> pairs;
    unsigned bit = 0;
    for (size_t i = 0; i < 5; ++i)
      for (size_t j = i + 1; j < 5; ++j)
        if (graph >> bit++ & 1) pairs.insert({i, j});
    const Letters of = letters(5, pairs);
    std::map<char, std::set<size_t>> groups;
    for (size_t i = 0; i < 5; ++i)
      for (const char c : of[i]) groups[c].insert(i);
    for (size_t i = 0; i < 5; ++i)
      for (size_t j = i + 1; j < 5; ++j)
        EXPECT_EQ(of[i].find_first_of(of[j]) == std::string::npos, pairs.count({i, j}) > 0) << graph;
    for (const auto& [a, one] : groups)
      for (const auto& [b, other] : groups)
        EXPECT_FALSE(a != b && std::includes(one.begin(), one.end(), other.begin(), other.end())) << graph;
  }
}

TEST(Statistics, GroupsAreByTheIntervalOfTheDifference) {
  // the best and the worst differ by 2 to 4, each from the middle one by 0 or more
  const Strata best = {{4, 5, 6}}, middle = {{1, 3, 6}}, worst = {{1, 2, 2}}, once = {{9}};
  EXPECT_EQ(group_letters({best, middle, worst}), Letters({"a", "ab", "b"}));
  EXPECT_EQ(group_letters({once, best, worst}), Letters({"", "a", "b"}));
  EXPECT_EQ(group_letters({once}), Letters({""}));
  // the tasks together tell what one alone does not
  const Strata high = {{2, 4}, {12, 14}}, low = {{1, 3}, {1, 3}};
  EXPECT_EQ(group_letters({{high[0]}, {low[0]}}), Letters({"a", "a"}));
  EXPECT_EQ(group_letters({high, low}), Letters({"a", "b"}));
}

}  // namespace
