// plan.hpp: the owner of a planner.
#include <gtest/gtest.h>

#include <redman/plan.hpp>

namespace {

constexpr const char* kSettings = "method=cem\nsamples=16\nhorizon=4\nknots=4\nnoise=0.1\n";

redman::Pool line() {
  redman::Pool pool(redman::pool_config("lqr_line"));
  pool.reset();
  return pool;
}

TEST(RedmanPlanHpp, APlanIsMadeShownAndGivenBack) {
  redman::Pool pool = line();
  redman::Planner planner(redman::planner_config(pool, kSettings));
  EXPECT_EQ(planner.spec().samples, 16);
  EXPECT_EQ(planner.spec().horizon, 4);
  EXPECT_EQ(planner.spec().action_dim, pool.spec().action_dim);
  EXPECT_NE(planner.settings().find("method=cem"), std::string::npos);

  float action = 9;
  const rdm_plan_info info = planner.act(pool, 0, &action);
  EXPECT_EQ(info.planned, 1);
  EXPECT_EQ(info.steps, 16 * 4);
  ASSERT_EQ(planner.plan().size(), 4u);
  EXPECT_EQ(planner.plan()[0], action);

  const float given[4] = {0.5f, -0.25f, 2, 0};
  planner.set_plan(given);
  EXPECT_EQ(planner.plan(), (std::vector<float>{0.5f, -0.25f, 1, 0}));
  planner.reset();
  EXPECT_NE(planner.plan()[0], 0.5f);
}

TEST(RedmanPlanHpp, AStateGoesOnWithTheSameBytes) {
  redman::Pool pool = line();
  redman::Planner planner(redman::planner_config(pool, kSettings)),
      other(redman::planner_config(pool, kSettings));
  float first = 0, second = 0, again = 0;
  planner.act(pool, 0, &first);
  const redman::Bytes state = planner.state();
  planner.act(pool, 0, &second);
  other.set_state(state);
  other.act(pool, 0, &again);
  EXPECT_EQ(again, second);
  EXPECT_EQ(other.state(), planner.state());
}

TEST(RedmanPlanHpp, WhatFailsThrows) {
  redman::Pool pool = line();
  EXPECT_THROW(redman::Planner(redman::planner_config(pool, "sampels=3")), redman::Error);
  EXPECT_THROW(redman::Planner(redman::planner_config(pool, "horizon=2\nreplan=3")), redman::Error);
  redman::Planner planner(redman::planner_config(pool, kSettings));
  float action = 0;
  EXPECT_THROW(planner.act(pool, 1, &action), redman::Error);
  planner.cancel();
  EXPECT_THROW(planner.act(pool, 0, &action), redman::Error);
  EXPECT_EQ(planner.act(pool, 0, &action).cut, 0);
  EXPECT_THROW(planner.set_state(redman::Bytes(7)), redman::Error);
}

}  // namespace
