#include "agents.hpp"
#include "algos/core/option_tables.hpp"
#include "algos/core/schedule.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

Options options(const char* kind) {
  Options o;
  o.add_table(kSharedOptions.data(), static_cast<int32_t>(kSharedOptions.size()));
  o.set({"lr_schedule", kind, 0}, "test");
  o.set({"learning_rate", nullptr, 1e-3}, "test");
  return o;
}

}  // namespace

TEST(Schedule, ConstantStays) {
  RateSchedule s;
  s.reset(options("constant"));
  s.adapt(100, 0);
  EXPECT_EQ(s.rate(0), 1e-3);
  EXPECT_EQ(s.rate(500), 1e-3);
}

TEST(Schedule, LinearFallsToZeroAndStaysThere) {
  Options o = options("linear");
  o.set({"total_epochs", nullptr, 10}, "test");
  RateSchedule s;
  s.reset(o);
  EXPECT_DOUBLE_EQ(s.rate(0), 1e-3);
  EXPECT_DOUBLE_EQ(s.rate(4), 0.6e-3);
  EXPECT_EQ(s.rate(10), 0);
  EXPECT_EQ(s.rate(11), 0);
}

TEST(Schedule, KlGoesDownAboveTwiceTheTargetAndUpBelowHalf) {
  Options o = options("kl");
  o.set({"kl_target", nullptr, 0.04}, "test");
  RateSchedule s;
  s.reset(o);
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
  Options o = options("kl");
  for (const auto& [key, number] :
       {std::pair{"kl_target", 0.04}, {"kl_target_end", 0.01}, {"total_epochs", 6.0}})
    o.set({key, nullptr, number}, "test");
  RateSchedule s;
  s.reset(o);
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
  Options o = options("kl");
  RateSchedule s;
  s.reset(o);
  s.adapt(1, 0);
  s.read_live(o);
  EXPECT_LT(s.rate(0), 1e-3);
  o.set({"learning_rate", nullptr, 2e-3}, "test");
  s.read_live(o);
  EXPECT_EQ(s.rate(0), 2e-3);
}
