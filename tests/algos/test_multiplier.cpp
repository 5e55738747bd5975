#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "algos/lagrange/multiplier.hpp"
#include "algos/lagrange/pid.hpp"

using namespace rdm;

namespace {

std::vector<double> respond(const MultiplierOptions& o, const std::vector<double>& costs, double limit = 25) {
  Multiplier m;
  m.reset(o);
  std::vector<double> values;
  for (const double cost : costs) {
    m.step(o, cost, limit, 1);
    values.push_back(m.value());
  }
  return values;
}

void expect_close(const std::vector<double>& got, const std::vector<double>& wanted) {
  ASSERT_EQ(got.size(), wanted.size());
  for (size_t i = 0; i < got.size(); ++i) EXPECT_NEAR(got[i], wanted[i], 1e-9) << i;
}

}  // namespace

// Numbers of an independent double-precision script: init 0.001, rate 0.035, limit 25.
TEST(Multiplier, AdamGolden) {
  const MultiplierOptions o;
  expect_close(respond(o, {50, 40, 30, 20, 10, 0}),
               {0.0360000000, 0.0695121562, 0.0988262233, 0.1191074400, 0.1258837906, 0.1196286925});
  expect_close(respond(o, {25.001, 25.001, 24.999}), {0.0359996500, 0.0709993000, 0.0801689500});
}

TEST(Multiplier, AdamStepsAreTheRateWhateverTheViolation) {
  const std::vector<double> l = respond(MultiplierOptions(), std::vector<double>(10, 50));
  for (size_t i = 0; i < l.size(); ++i) EXPECT_NEAR(l[i], 0.001 + 0.035 * static_cast<double>(i + 1), 1e-8);
}

TEST(Multiplier, SgdGolden) {
  MultiplierOptions o;
  o.optimizer = MultiplierOptimizer::kSgd;
  o.init = 0;
  o.rate = 0.01;
  expect_close(respond(o, {30, 30, 10}), {0.05, 0.10, 0});
  o.normalized = true;
  expect_close(respond(o, {30, 30, 10}), {0.002, 0.004, 0});
}

// A regression test: behind Adam a violation of 1 and one of 100 are the same.
TEST(Multiplier, SgdStepsAreInProportionToTheViolation) {
  MultiplierOptions o;
  o.optimizer = MultiplierOptimizer::kSgd;
  o.init = 0;
  const double one = respond(o, {26})[0], hundred = respond(o, {125})[0];
  EXPECT_NEAR(one, o.rate, 1e-12);
  EXPECT_NEAR(hundred, 100 * one, 1e-9);
  Pid small, large;
  const PidOptions pid{.init = 0};
  small.reset(pid), large.reset(pid);
  small.step(pid, 1, 0), large.step(pid, 100, 0);
  EXPECT_NEAR(large.value(), 100 * small.value(), 1e-9);
}

TEST(Multiplier, SoftplusStartsWhereItIsTold) {
  MultiplierOptions o;
  o.optimizer = MultiplierOptimizer::kSoftplus;
  o.init = 1;
  o.rate = 0.05;
  Multiplier m;
  m.reset(o);
  EXPECT_NEAR(m.value(), 1, 1e-12);
  // w0 = ln(e - 1) = 0.5413248546; Adam's first step is the rate.
  m.step(o, 50, 25, 1);
  EXPECT_NEAR(m.value(), std::log1p(std::exp(0.5413248546 + 0.05)), 1e-9);
  for (int i = 0; i < 1000; ++i) m.step(o, 0, 25, 1);
  EXPECT_GT(m.value(), 0);
  EXPECT_LT(m.value(), 1e-3);
}

TEST(Multiplier, StaysUnderItsBound) {
  for (const auto optimizer :
       {MultiplierOptimizer::kSgd, MultiplierOptimizer::kAdam, MultiplierOptimizer::kSoftplus}) {
    MultiplierOptions o;
    o.optimizer = optimizer;
    o.rate = 0.5;
    o.max = 2;
    const std::vector<double> l = respond(o, std::vector<double>(100, 1000));
    EXPECT_NEAR(l.back(), 2, 1e-12);
  }
}

TEST(Multiplier, GainAddsTheAugmentedTermWithinTheBounds) {
  MultiplierOptions o;
  o.optimizer = MultiplierOptimizer::kSgd;
  o.init = 0;
  o.rate = 0.01;
  o.gain = 0.1;
  o.max = 1;
  // l = 0.05, 0.10, 0, 0.20, 0.20; the term is not summed.
  expect_close(respond(o, {30, 30, 10, 45, 25}), {0.55, 0.60, 0, 1, 0.20});
}

TEST(Multiplier, WarmthScalesTheStep) {
  MultiplierOptions o;
  o.optimizer = MultiplierOptimizer::kSgd;
  o.init = 0;
  o.rate = 0.01;
  Multiplier m;
  m.reset(o);
  m.step(o, 35, 25, 0);
  EXPECT_EQ(m.value(), 0);
  m.step(o, 35, 25, 0.25);
  EXPECT_NEAR(m.value(), 0.025, 1e-15);
}

// A limit of 0 has no unit, and one near it makes any cost a thousand limits.
TEST(Multiplier, NormalizedExcessIsBounded) {
  MultiplierOptions o;
  o.optimizer = MultiplierOptimizer::kSgd;
  o.init = 0;
  o.rate = 0.1;
  o.normalized = true;
  expect_close(respond(o, {7, 0, 250, 0.01}, 0), {0.3, 0.3, 0.6, 0.9});
  expect_close(respond(o, {7, 0, 250}, 1e-3), {0.3, 0.2, 0.5});
  expect_close(respond(o, {50, 75, 250, 0}), {0.1, 0.3, 0.6, 0.5});
}
