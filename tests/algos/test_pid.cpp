#include <gtest/gtest.h>

#include "algos/lagrange/pid.hpp"

using namespace rdm;

namespace {
void expect_run(const PidOptions& o, const std::vector<double>& cost, double limit,
                const std::vector<double>& wanted) {
  Pid p;
  p.reset(o);
  for (size_t i = 0; i < cost.size(); ++i) {
    p.step(o, cost[i], limit);
    EXPECT_NEAR(p.value(), wanted[i], 1e-8) << i;
  }
}
}  // namespace

TEST(Pid, GoldenConstantViolation) {
  expect_run(PidOptions(), std::vector<double>(12, 50.0), 25,
             {0.401, 0.7935, 1.178875, 1.55748125, 1.92965719, 2.29572433, 2.65598811, 3.01073871, 3.36025177,
              3.70478918, 4.01959972, 4.33116974});
}

TEST(Pid, GoldenLowThenHigh) {
  expect_run(PidOptions(), {10, 10, 10, 60, 60, 60}, 25, {0, 0, 0, 0.36530875, 0.91954331, 1.46356615});
}

TEST(Pid, NoCostNoMultiplier) {
  expect_run(PidOptions(), std::vector<double>(30, 0.0), 25, std::vector<double>(30, 0.0));
}

TEST(Pid, EachPartAlone) {
  PidOptions o;
  o.kp = o.kd = o.init = 0;
  o.ki = 0.1;
  expect_run(o, {30, 30, 20, 50}, 25, {0.5, 1, 0.5, 3});
  o.ki = 0;
  o.kp = 0.1;
  o.smooth_p = 0;
  expect_run(o, {30, 20, 50}, 25, {0.5, 0, 2.5});
  // Rises alone count: 0.5 of 10, then nothing while it falls.
  o.kp = 0;
  o.kd = 0.5;
  o.smooth_d = 0;
  o.delay = 1;
  expect_run(o, {10, 30, 20, 25}, 25, {5, 10, 0, 2.5});
}

TEST(Pid, Bounds) {
  PidOptions o;
  o.kp = o.kd = 0;
  o.ki = 1;
  o.max = 1;
  expect_run(o, {100, 100, 24.5}, 25, {1, 1, 0.5});  // comes down at once: the integral did not go beyond
}
