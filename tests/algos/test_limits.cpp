// What limits are held against where episodes end, and where they do not.
#include <cmath>

#include "agents.hpp"
#include "algos/rollout/limits.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

AgentSetup lag(double limit) {
  AgentSetup s("ppo_lag", 1, 1, 1);
  s.options.push_back({"cost_limit", nullptr, limit});
  return s;
}

// 200 control steps at a cost of 0.1, in episodes that have run for 300 steps.
EpochTotals running() {
  EpochTotals t;
  t.cost[0] = 20, t.steps = 200, t.running = 300;
  return t;
}

EpisodeStats ended(double cost, double length) {
  EpisodeStats s;
  s.finished = 3, s.fresh = true, s.length = length, s.charged_cost[0] = cost;
  return s;
}

}  // namespace

TEST(Limits, SumsOfFinishedEpisodesAreHeldAgainstTheLimit) {
  AgentSetup s = lag(25);
  const JudgedCosts j = judge(resolve_config(s.ready()), ended(30, 100), running());
  EXPECT_TRUE(j.known[0] && j.fresh[0]);
  EXPECT_EQ(j.excess(0), 5);
  EXPECT_EQ(j.steps[0], 100);
}

TEST(Limits, RunningEpisodesCanOnlyBreakOne) {
  AgentSetup tight = lag(25), wide = lag(31);
  const JudgedCosts broken = judge(resolve_config(tight.ready()), {}, running());
  EXPECT_TRUE(broken.known[0] && broken.fresh[0]);
  EXPECT_DOUBLE_EQ(broken.excess(0), 0.1 * 300 - 25);
  EXPECT_FALSE(judge(resolve_config(wide.ready()), {}, running()).known[0]);
  EXPECT_TRUE(lacks_length(resolve_config(wide.ready()), {}));
  EXPECT_FALSE(lacks_length(resolve_config(wide.ready()), ended(1, 1)));
}

TEST(Limits, BeforeTheFirstEndOfALengthThatIsKnownNothingIs) {
  AgentSetup s = lag(25);
  s.config.max_steps = 1000;
  EXPECT_FALSE(judge(resolve_config(s.ready()), {}, running()).known[0]);
  EXPECT_FALSE(lacks_length(resolve_config(s.ready()), {}));
}

TEST(Limits, ALimitPerStepIsASumOverAnEpisodesLength) {
  for (const int32_t max_steps : {0, 50}) {
    AgentSetup s = lag(25);
    s.options.push_back({"cost_limit_per_step", nullptr, 0.05});
    s.config.max_steps = max_steps;
    const double steps = max_steps > 0 ? max_steps : kRateSteps;
    const JudgedCosts j = judge(resolve_config(s.ready()), ended(3, 7), running());
    EXPECT_TRUE(j.known[0] && j.fresh[0]);
    EXPECT_NEAR(j.cost[0], 0.1 * steps, 1e-12);
    EXPECT_NEAR(j.limit[0], 0.05 * steps, 1e-12);
    EXPECT_EQ(j.steps[0], steps);
    EXPECT_FALSE(judge(resolve_config(s.ready()), {}, {}).known[0]);
  }
}

// 4 environments, or 400 control steps of them in an epoch.
TEST(Limits, OnlyALimitOfZeroThatNothingBreaksIsSpotless) {
  struct Case {
    double limit, cost, paid, length;
    bool spotless;
  };
  const Case cases[] = {
      {0, 0, 0, 100, true},   {0, 0, 0, 101, true},     // whole episodes, or all of them clean
      {0, 0.5, 0, 100, true}, {0, 0.5, 0, 101, false},  // older costs: a whole one outweighs them
      {0, 0, 1, 100, false},  {0, 0.5, 1, 100, false}, {25, 0, 0, 100, false}, {1e-6, 0, 0, 100, false}};
  for (const Case& c : cases) {
    AgentSetup s = lag(c.limit);
    s.config.num_envs = 4;
    EpochTotals t;
    t.cost[0] = c.paid, t.steps = 400;
    const JudgedCosts j = judge(resolve_config(s.ready()), ended(c.cost, c.length), t);
    EXPECT_EQ(j.spotless[0], c.spotless) << c.limit << ' ' << c.cost << ' ' << c.paid << ' ' << c.length;
    EXPECT_FALSE(judge(resolve_config(s.ready()), {}, t).spotless[0]);
  }
}

TEST(Limits, TheLimitPerStepIsLiveWhereItWasGiven) {
  AgentSetup s = lag(25);
  s.options.push_back({"cost_limit_per_step", nullptr, 0.05});
  const AgentPtr a = s.make();
  a->set_option({"cost_limit_per_step", nullptr, 0.02});
  EXPECT_EQ(a->options().number("cost_limit_per_step"), 0.02);
  EXPECT_EQ(thrown([&] { a->set_option({"cost_limit_per_step", nullptr, -1}); }).code, Code::kState);
  EXPECT_EQ(thrown([&] { a->set_option({"cost_limit", nullptr, 3}); }).code, Code::kState);
  AgentSetup sums = lag(25);
  const AgentPtr b = sums.make();
  EXPECT_EQ(thrown([&] { b->set_option({"cost_limit_per_step", nullptr, 0.1}); }).code, Code::kState);
  b->set_option({"cost_limit", nullptr, 3});
}

// Options that came later are in a file only where they are used.
TEST(Limits, StatesKeepTheOptionsAndRefuseOthers) {
  AgentSetup with = lag(25), without = lag(25), other = lag(25);
  with.with("episode_steps", "100").with("cost_limit_per_step", "0.1");
  other.with("episode_steps", "50").with("cost_limit_per_step", "0.1");
  const AgentPtr a = with.make(), again = with.make(), b = without.make(), c = other.make();
  a->set_option({"cost_limit_per_step", nullptr, 0.25});
  const auto bytes = saved(*a), plain = saved(*b);
  EXPECT_GT(bytes.size(), plain.size());
  again->load(bytes.data(), bytes.size());
  EXPECT_EQ(again->options().number("cost_limit_per_step"), 0.25);
  EXPECT_EQ(thrown([&] { b->load(bytes.data(), bytes.size()); }).code, Code::kFormat);
  EXPECT_EQ(thrown([&] { c->load(bytes.data(), bytes.size()); }).code, Code::kFormat);
  EXPECT_EQ(thrown([&] { a->load(plain.data(), plain.size()); }).code, Code::kFormat);
}
