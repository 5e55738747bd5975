// Which course is better, the weights of MPPI and the deviations of CEM, against values computed by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "plan/ranking.hpp"

namespace rdm {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

Course course(double ret, double cost, double second = 0, bool lost = false) {
  Course c;
  c.ret = ret;
  c.cost[0] = cost;
  c.cost[1] = second;
  c.lost = lost;
  return c;
}

CourseRule rule_of(CostRule rule, double budget, double second = -1) {
  CourseRule r;
  r.rule = rule;
  r.multiplier = 2;
  r.num_costs = 2;
  r.budget[0] = budget;
  r.budget[1] = second;
  return r;
}

std::vector<Standing> standings_of(const std::vector<Course>& courses, const CourseRule& rule) {
  std::vector<Standing> out;
  for (const Course& c : courses) out.push_back(standing(c, rule));
  return out;
}

std::vector<int32_t> order_of(const std::vector<Course>& courses, const CourseRule& rule) {
  const std::vector<Standing> standings = standings_of(courses, rule);
  std::vector<int32_t> order(courses.size());
  rank_courses(standings.data(), static_cast<int32_t>(courses.size()), order.data());
  return order;
}

const std::vector<Course> kCourses = {course(10, 5), course(3, 1), course(7, 2), course(100, 9),
                                      course(500, 0, 0, true)};

TEST(Ranking, FeasibleCoursesComeFirstByReturnTheOthersByCost) {
  EXPECT_EQ(order_of(kCourses, rule_of(CostRule::kFeasible, 2)), (std::vector<int32_t>{2, 1, 0, 3, 4}));
  EXPECT_EQ(order_of(kCourses, rule_of(CostRule::kFeasible, 5)), (std::vector<int32_t>{0, 2, 1, 3, 4}));
  EXPECT_EQ(order_of(kCourses, rule_of(CostRule::kFeasible, 0)), (std::vector<int32_t>{1, 2, 0, 3, 4}));
  EXPECT_EQ(order_of(kCourses, rule_of(CostRule::kFeasible, -1)), (std::vector<int32_t>{3, 0, 2, 1, 4}));
}

TEST(Ranking, AMultiplierIsTakenOffTheReturn) {
  // 0, 1, 3, 82
  EXPECT_EQ(order_of(kCourses, rule_of(CostRule::kMultiplier, 2)), (std::vector<int32_t>{3, 2, 1, 0, 4}));
  EXPECT_EQ(standing(kCourses[2], rule_of(CostRule::kMultiplier, 2)).score, 3);
  EXPECT_EQ(order_of(kCourses, rule_of(CostRule::kIgnore, 2)), (std::vector<int32_t>{3, 0, 2, 1, 4}));
}

TEST(Ranking, EveryLimitedCostHasABudget) {
  const CourseRule both = rule_of(CostRule::kFeasible, 2, 1);
  EXPECT_TRUE(within(course(0, 2, 1), both));
  EXPECT_FALSE(within(course(0, 2, 1.5), both));
  EXPECT_TRUE(within(course(0, 2, 99), rule_of(CostRule::kFeasible, 2)));
  EXPECT_EQ(standing(course(9, 3, 4), both).score, -4);  // 1 + 3 beyond
  EXPECT_EQ(order_of({course(9, 3, 4), course(1, 5, 1), course(0, 0, 0)}, both),
            (std::vector<int32_t>{2, 1, 0}));
}

TEST(Ranking, EqualsStandByReturnThenByNumberAndWhatIsNoNumberIsLost) {
  EXPECT_EQ(order_of({course(1, 4), course(2, 4), course(1, 4)}, rule_of(CostRule::kFeasible, 1)),
            (std::vector<int32_t>{1, 0, 2}));
  EXPECT_EQ(order_of({course(kNan, 0), course(-5, 0), course(1, kNan)}, rule_of(CostRule::kMultiplier, 1)),
            (std::vector<int32_t>{1, 0, 2}));
}

TEST(PathIntegral, WeightsAreThoseOfTheFormula) {
  // scores 1, 2, 3: deviation sqrt(2/3); exp((score - 3) / (0.5 sqrt(2/3))): 0.00745, 0.08634, 1
  const auto s = standings_of({course(1, 0), course(200, 9), course(2, 0), course(3, 0)},
                              rule_of(CostRule::kFeasible, 5));
  double w[4];
  path_integral_weights(s.data(), 4, 0.5, w);
  EXPECT_NEAR(w[0], 0.0068150, 1e-6);
  EXPECT_EQ(w[1], 0);
  EXPECT_NEAR(w[2], 0.0789342, 1e-6);
  EXPECT_NEAR(w[3], 0.9142508, 1e-6);
  EXPECT_NEAR(w[0] + w[2] + w[3], 1, 1e-12);
}

TEST(PathIntegral, ATemperatureMeansTheSameForRewardsOfAnySize) {
  const CourseRule rule = rule_of(CostRule::kIgnore, 0);
  const auto small = standings_of({course(1, 0), course(2, 0), course(4, 0)}, rule);
  const auto large = standings_of({course(-900, 0), course(100, 0), course(2100, 0)}, rule);
  double a[3], b[3];
  path_integral_weights(small.data(), 3, 0.3, a);
  path_integral_weights(large.data(), 3, 0.3, b);
  for (int i = 0; i < 3; ++i) EXPECT_NEAR(a[i], b[i], 1e-12);
}

TEST(PathIntegral, EqualScoresShareAndWithoutAFeasibleOneCostsCount) {
  double w[3];
  auto s = standings_of({course(1, 0), course(1, 0), course(5, 7)}, rule_of(CostRule::kFeasible, 1));
  path_integral_weights(s.data(), 3, 0.5, w);
  EXPECT_EQ(w[0], 0.5);
  EXPECT_EQ(w[1], 0.5);
  EXPECT_EQ(w[2], 0);
  s = standings_of({course(9, 4), course(1, 2), course(0, 0, 0, true)}, rule_of(CostRule::kFeasible, 1));
  path_integral_weights(s.data(), 3, 1, w);  // scores -3, -1: deviation 1
  EXPECT_NEAR(w[0], std::exp(-2) / (1 + std::exp(-2)), 1e-12);
  EXPECT_NEAR(w[1], 1 / (1 + std::exp(-2)), 1e-12);
  EXPECT_EQ(w[2], 0);
  s = standings_of({course(0, 0, 0, true), course(3, 0, 0, true)}, rule_of(CostRule::kFeasible, 1));
  path_integral_weights(s.data(), 2, 1, w);
  EXPECT_EQ(w[0], 0.5);
}

TEST(CrossEntropy, DeviationIsThatOfTheElitesAboutTheirMean) {
  const float noise[] = {1, -1, 50, 60, 3, 5, 70, 80};  // [4][2]
  const int32_t order[] = {2, 0, 1, 3};
  const float floor[] = {0.5f, 4};
  float deviation[2];
  elite_deviation(noise, order, 2, 2, floor, deviation);
  EXPECT_FLOAT_EQ(deviation[0], 1);  // of 3 and 1
  EXPECT_FLOAT_EQ(deviation[1], 4);  // of 5 and -1 it is 3, the floor 4
  elite_deviation(noise, order, 1, 2, floor, deviation);
  EXPECT_FLOAT_EQ(deviation[0], 0.5f);
}

}  // namespace
}  // namespace rdm
