#include "agents.hpp"
#include "algos/core/option_tables.hpp"
#include "algos/core/schedule.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

SharedOptions options(RateKind kind) {
  Options o;
  o.add_table(kSharedRows.data(), static_cast<int32_t>(kSharedRows.size()));
  SharedOptions shared = kSharedRows.read(o);
  shared.rate_kind = kind;
  shared.learning_rate = 1e-3;
  return shared;
}

}  // namespace

TEST(Schedule, ConstantStays) {
  const SharedOptions o = options(RateKind::kConstant);
  RateSchedule s;
  s.open(o);
  s.adapt(100, 0);
  EXPECT_EQ(s.rate(0), 1e-3);
  EXPECT_EQ(s.rate(500), 1e-3);
}

TEST(Schedule, LinearFallsToZeroAndStaysThere) {
  SharedOptions o = options(RateKind::kLinear);
  o.total_epochs = 10;
  RateSchedule s;
  s.open(o);
  EXPECT_DOUBLE_EQ(s.rate(0), 1e-3);
  EXPECT_DOUBLE_EQ(s.rate(4), 0.6e-3);
  EXPECT_EQ(s.rate(10), 0);
  EXPECT_EQ(s.rate(11), 0);
}

TEST(Schedule, KlGoesDownAboveTwiceTheTargetAndUpBelowHalf) {
  SharedOptions o = options(RateKind::kKl);
  o.kl_target = 0.04;
  RateSchedule s;
  s.open(o);
  s.adapt(0.079, 0);
  s.adapt(0.021, 0);
  EXPECT_EQ(s.rate(7), 1e-3);
  s.adapt(0.081, 0);
  EXPECT_DOUBLE_EQ(s.rate(7), 1e-3 / 1.3);
  s.adapt(0.019, 0);
  EXPECT_DOUBLE_EQ(s.rate(7), 1e-3);
  for (int i = 0; i < 50; ++i) s.adapt(0, 0);
  EXPECT_EQ(s.rate(7), 3e-3);
  for (int i = 0; i < 50; ++i) s.adapt(1, 0);
  EXPECT_EQ(s.rate(7), 1e-5);
}

TEST(Schedule, TheTargetGoesToItsEndOverTheRun) {
  SharedOptions o = options(RateKind::kKl);
  o.kl_target = 0.04, o.kl_target_end = 0.01, o.total_epochs = 6;
  RateSchedule s;
  s.open(o);
  // 0.04, half way 0.025, from epoch 6 on 0.01
  s.adapt(0.079, 0);
  s.adapt(0.049, 3);
  s.adapt(0.013, 3);
  s.adapt(0.019, 6);
  s.adapt(0.0051, 99);
  EXPECT_EQ(s.rate(7), 1e-3);
  s.adapt(0.051, 3);
  EXPECT_DOUBLE_EQ(s.rate(7), 1e-3 / 1.3);
  s.adapt(0.012, 3);
  EXPECT_DOUBLE_EQ(s.rate(7), 1e-3);
  s.adapt(0.021, 6);
  EXPECT_DOUBLE_EQ(s.rate(7), 1e-3 / 1.3);
  s.adapt(0.0049, 99);
  EXPECT_DOUBLE_EQ(s.rate(7), 1e-3);
}

TEST(Schedule, ANewRateRestartsTheAdaption) {
  SharedOptions o = options(RateKind::kKl);
  RateSchedule s;
  s.open(o);
  s.adapt(1, 0);
  s.read_live();
  EXPECT_LT(s.rate(0), 1e-3);
  o.learning_rate = 2e-3;
  s.read_live();
  EXPECT_EQ(s.rate(0), 2e-3);
}
