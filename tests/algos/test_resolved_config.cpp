#include <cmath>
#include <limits>

#include "agents.hpp"
#include "algos/core/resolved_config.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

AgentSetup good() {
  return AgentSetup("ppo_lag", 4, 2, 8);
}
Thrown plan_of(AgentSetup& s) {
  return thrown([&] { resolve_config(s.ready()); });
}
Thrown with_option(const char* key, const char* value) {
  AgentSetup s = good();
  return plan_of(s.with(key, value));
}

}  // namespace

TEST(ResolvedAgentConfig, DimensionsAreCheckedByName) {
  struct Case {
    const char* name;
    int32_t AgentConfig::*field;
    int32_t low, high;
  };
  const Case cases[] = {{"obs_dim", &AgentConfig::obs_dim, 1, 16384},
                        {"action_dim", &AgentConfig::action_dim, 1, 1024},
                        {"num_envs", &AgentConfig::num_envs, 1, 65536},
                        {"num_threads", &AgentConfig::num_threads, 0, 256},
                        {"cost_dim", &AgentConfig::cost_dim, 1, 16}};
  for (const Case& c : cases) {
    for (const int32_t bad : {c.low - 1, c.high + 1, std::numeric_limits<int32_t>::min()}) {
      AgentSetup s = good();
      s.config.*c.field = bad;
      const Thrown t = plan_of(s);
      if (c.field == &AgentConfig::cost_dim && bad == 0) {
        EXPECT_EQ(t.code, Code::kArgument)
            << t.text;  // allowed in itself, but ppo_lag needs a limited column
        continue;
      }
      EXPECT_EQ(t.code, Code::kRange) << c.name << " " << bad;
      EXPECT_NE(t.text.find(c.name), std::string::npos) << t.text;
    }
    for (const int32_t fine : {c.low, c.high}) {
      AgentSetup s = good();
      s.config.*c.field = fine;
      EXPECT_EQ(plan_of(s).code, Code::kOk) << c.name << " " << plan_of(s).text;
    }
  }
}

TEST(ResolvedAgentConfig, NumbersThatAreNotFinite) {
  const float bad_mean[] = {0, std::numeric_limits<float>::quiet_NaN()};
  const double bad_limit[] = {std::numeric_limits<double>::infinity()};
  AgentSetup s = good();
  s.config.initial_mean = bad_mean;
  EXPECT_EQ(plan_of(s).code, Code::kArgument);
  AgentSetup l = good();
  l.config.cost_limits = bad_limit;
  EXPECT_EQ(plan_of(l).code, Code::kArgument);
  AgentSetup d = good();
  d.config.control_dt = std::nanf("");
  EXPECT_EQ(plan_of(d).code, Code::kRange);
}

TEST(ResolvedAgentConfig, HiddenLayers) {
  AgentSetup s = good();
  s.with("hidden", " 128 , 64,32").with("activation", "elu").with("critic_hidden", "16");
  const ResolvedAgentConfig p = resolve_config(s.ready());
  EXPECT_EQ(p.actor.num_hidden, 3);
  EXPECT_EQ(p.actor.hidden[0], 128);
  EXPECT_EQ(p.actor.hidden[2], 32);
  EXPECT_EQ(p.actor.activation, Activation::kElu);
  EXPECT_EQ(p.reward_critic.num_hidden, 1);
  EXPECT_EQ(p.reward_critic.hidden[0], 16);
  EXPECT_EQ(p.cost_critic.out, 1);
  EXPECT_EQ(with_option("hidden", "").code, Code::kOk);
  for (const char* bad : {"64,", "64;64", "abc", "6 4", ",64", "64,,64"})
    EXPECT_EQ(with_option("hidden", bad).code, Code::kArgument) << bad;
  for (const char* bad : {"0", "5000", "-3", "1,1,1,1,1"})
    EXPECT_EQ(with_option("hidden", bad).code, Code::kRange) << bad;
}

TEST(ResolvedAgentConfig, PairsOfOptions) {
  EXPECT_EQ(with_option("std_min", "20").code, Code::kRange);
  EXPECT_EQ(with_option("init_std", "0.001").code, Code::kRange);
  EXPECT_EQ(with_option("lr_min", "1").code, Code::kRange);
  EXPECT_EQ(with_option("terminal_cost", "true").code, Code::kArgument);
  EXPECT_EQ(with_option("horizon", "1000000").code, Code::kOk);
  AgentSetup s = good();
  s.config.num_envs = 65536;
  EXPECT_EQ(plan_of(s.with("horizon", "1000000")).code, Code::kRange);
}

TEST(ResolvedAgentConfig, LimitsOfCosts) {
  AgentSetup s = good();
  EXPECT_EQ(resolve_config(s.ready()).limit[0], 25);
  const double limits[] = {40, -1, 3};
  s.config.cost_dim = 3;
  s.config.cost_limits = limits;
  ResolvedAgentConfig p = resolve_config(s.ready());
  EXPECT_EQ(p.num_limited, 2);
  EXPECT_EQ(p.limit[0], 40);
  EXPECT_EQ(p.options.number("cost_limit"), 40);
  s.with("cost-limit", "12");
  EXPECT_EQ(resolve_config(s.ready()).limit[0], 12);
  s.with("cost_limit", "-1");
  p = resolve_config(s.ready());
  EXPECT_EQ(p.num_limited, 1);
  EXPECT_EQ(p.column[0], 2);
  AgentSetup none = good();
  EXPECT_EQ(plan_of(none.with("cost_limit", "-1")).code, Code::kArgument);
}

TEST(ResolvedAgentConfig, ChunksDoNotDependOnThreads) {
  AgentSetup s = good();
  s.config.num_envs = 64;
  s.with("horizon", "128").with("minibatches", "8");
  for (const int32_t threads : {0, 1, 2, 16}) {
    s.config.num_threads = threads;
    const ResolvedAgentConfig p = resolve_config(s.ready());
    EXPECT_EQ(p.minibatch_rows, 1024);
    EXPECT_EQ(p.chunk_rows, 256);
    EXPECT_EQ(p.workers, std::clamp(threads, 1, 4));
  }
}

TEST(ResolvedAgentConfig, NamesAreCopied) {
  AgentSetup s = good();
  std::string task = "my_world";
  s.config.task = task.c_str();
  const ResolvedAgentConfig p = resolve_config(s.ready());
  task[0] = 'X';
  EXPECT_STREQ(p.task, "my_world");
  EXPECT_STREQ(p.config.algo, "ppo_lag");
  const std::string longest(64, 'a');
  s.config.task = longest.c_str();
  EXPECT_EQ(plan_of(s).code, Code::kRange);
}
