#include <sstream>

#include "agents.hpp"
#include "algos/core/algo_row.hpp"
#include "algos/core/option_tables.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

Options read(AgentSetup& s, std::vector<OptionInput> defaults = {}) {
  s.ready();
  s.config.defaults = defaults.data();
  s.config.num_defaults = static_cast<int32_t>(defaults.size());
  return read_options(s.config, algo_row(algo_find(s.config.algo)));
}

}  // namespace

TEST(OptionTables, EveryRowHasHelpAndADefaultInsideItsBounds) {
  for (int32_t a = 0; a < algo_count(); ++a) {
    const AlgoInfo& info = algo_at(a);
    for (int32_t i = 0; i < info.num_options; ++i) {
      const OptionSpec& s = info.options[i];
      EXPECT_GT(std::strlen(s.help), 8u) << s.key;
      EXPECT_LT(std::strlen(s.help), 110u) << s.key;
      if (s.kind == OptionKind::kText) continue;
      EXPECT_GE(s.number, s.low) << s.key;
      EXPECT_LE(s.number, s.high) << s.key;
    }
    Options all;
    all.add_table(info.options, info.num_options);  // throws on a key that stands twice
    EXPECT_TRUE(all.knows("hidden"));
  }
}

// A row that names an algorithm or an option that is not there would be left out silently.
TEST(OptionTables, RowsOfPresetsAreForAlgorithmsAndOptionsThatExist) {
  for (const PresetValue& v : preset_values()) {
    std::istringstream names(v.algos ? v.algos : "");
    std::string name;
    while (std::getline(names, name, '|')) {
      const AlgoInfo& algo = algo_at(algo_find(name.c_str()));
      EXPECT_STREQ(algo.name, name.c_str());
      Options all;
      all.add_table(algo.options, algo.num_options);
      EXPECT_NO_THROW(all.set({v.key, v.text, 0}, "preset")) << name << ' ' << v.key;
    }
    int32_t known = 0;
    for (int32_t a = 0; a < algo_count(); ++a) {
      Options all;
      all.add_table(algo_at(a).options, algo_at(a).num_options);
      known += all.knows(v.key);
    }
    EXPECT_GT(known, 0) << v.preset << ' ' << v.key;
  }
}

TEST(OptionTables, ADefaultMayBelongToOneAlgorithm) {
  const std::vector<OptionInput> rows = {
      {"passes", "7", 0}, {"focops:passes", "3", 0}, {"cpo:trust_kl", nullptr, 0.5}};
  AgentSetup focops("focops", 1, 1, 4), lag("ppo_lag", 1, 1, 4), cpo("cpo", 1, 1, 4);
  EXPECT_EQ(read(focops, rows).integer("passes"), 3);
  EXPECT_EQ(read(lag, rows).integer("passes"), 7);
  EXPECT_EQ(read(cpo, rows).number("trust_kl"), 0.5);
  EXPECT_EQ(thrown([&] { read(lag, {{"fokops:passes", "3", 0}}); }).code, Code::kNotFound);
  EXPECT_EQ(thrown([&] { read(lag, {{"focops:trust_kl", "3", 0}}); }).code, Code::kNotFound);
}

TEST(OptionTables, AScheduleOfATaskGivesWayToDeviationsOfTheState) {
  const std::vector<OptionInput> rows = {{"std_schedule", "linear", 0}};
  AgentSetup free("ppo", 1, 1, 4), state("ppo", 1, 1, 4), both("ppo", 1, 1, 4);
  state.with("std_mode", "state");
  both.with("std_mode", "state").with("std_schedule", "linear");
  EXPECT_STREQ(read(free, rows).text("std_schedule"), "linear");
  EXPECT_STREQ(read(state, rows).text("std_schedule"), "none");
  EXPECT_STREQ(read(both, rows).text("std_schedule"), "linear");
}

TEST(OptionTables, GivenOverPresetOverDefaultsOverTable) {
  AgentSetup s("ppo_lag", 1, 1, 4);
  s.with("clip", "0.3").with("preset", "paper");
  const Options o = read(s, {{"clip", nullptr, 0.4},
                             {"passes", "7", 0},
                             {"lr_schedule", "linear", 0},
                             {"total_epochs", nullptr, 9}});
  EXPECT_EQ(o.number("clip"), 0.3);
  EXPECT_EQ(o.integer("passes"), 5);
  EXPECT_STREQ(o.text("lr_schedule"), "kl");
  EXPECT_STREQ(o.text("hidden"), "1024,1024,512");
  EXPECT_EQ(o.integer("total_epochs"), 9);
  EXPECT_EQ(o.number("lambda"), 0.95);
  EXPECT_TRUE(o.given("clip"));
  EXPECT_FALSE(o.given("passes"));
}

TEST(OptionTables, DefaultsMayBeOtherAlgorithms) {
  AgentSetup s("ppo", 1, 1, 4);
  EXPECT_NO_THROW(read(s, {{"multiplier_lr", nullptr, 0.1}}));
  const Thrown t = thrown([&] { read(s, {{"multiplier_rl", nullptr, 0.1}}); });
  EXPECT_EQ(t.code, Code::kNotFound);
  EXPECT_EQ(thrown([&] { read(s, {{nullptr, nullptr, 0.1}}); }).code, Code::kArgument);
  EXPECT_EQ(thrown([&] { read(s, {{"clip", nullptr, -1}}); }).code, Code::kRange);
}

TEST(OptionTables, UnknownOptionNamesTheNearest) {
  AgentSetup s("ppo", 1, 1, 4);
  s.with("learning_rat", "1");
  const Thrown t = thrown([&] { read(s); });
  EXPECT_EQ(t.code, Code::kNotFound);
  EXPECT_NE(t.text.find("learning_rate"), std::string::npos) << t.text;
  AgentSetup other("ppo", 1, 1, 4);
  other.with("multiplier_lr", "1");
  EXPECT_EQ(thrown([&] { read(other); }).code, Code::kNotFound);
}

TEST(OptionTables, SafePreset) {
  AgentSetup s("ppo_lag", 1, 1, 4);
  s.with("preset", "safe");
  EXPECT_FALSE(read(s).flag("terminal_cost"));  // the length of an episode is unknown
  s.config.max_steps = 75;
  EXPECT_TRUE(read(s).flag("terminal_cost"));
  EXPECT_GT(read(s).integer("multiplier_warmup"), 0);
  s.with("terminal-cost", "off");
  EXPECT_FALSE(read(s).flag("terminal_cost"));
}

TEST(OptionTables, OmnisafePresetHasMinibatchesOf64) {
  AgentSetup s("ppo_lag", 1, 1, 10);
  s.with("preset", "omnisafe").with("horizon", "2000");
  const Options o = read(s);
  EXPECT_EQ(o.integer("minibatches"), 312);
  EXPECT_EQ(o.integer("passes"), 40);
  EXPECT_EQ(o.number("max_grad_norm"), 40);
}

TEST(OptionTables, PresetsKnowTheAlgorithm) {
  AgentSetup paper("p3o", 1, 1, 10), cpo("cpo", 1, 1, 10), ipo("ipo", 1, 1, 10), pcpo("pcpo", 1, 1, 10);
  paper.with("preset", "paper");
  EXPECT_EQ(read(paper).number("penalty"), 1);
  EXPECT_EQ(read(paper).number("penalty_growth"), 1.05);
  for (AgentSetup* s : {&cpo, &ipo, &pcpo}) s->with("preset", "omnisafe").with("horizon", "2000");
  const Options o = read(cpo);
  EXPECT_EQ(o.integer("passes"), 10);
  EXPECT_EQ(o.integer("minibatches"), 156);
  EXPECT_EQ(o.number("critic_learning_rate"), 1e-3);
  EXPECT_TRUE(o.flag("kl_mean_over_dims"));
  EXPECT_STREQ(o.text("violation_scale"), "raw");
  EXPECT_EQ(o.integer("line_search_steps"), 20);
  EXPECT_EQ(read(pcpo).integer("line_search_steps"), 200);
  EXPECT_TRUE(read(ipo).flag("normalize_cost"));
  EXPECT_FALSE(read(cpo).flag("normalize_cost"));
}

// What the peers and the papers do differently, by key: each value is taken, one outside its bounds is not.
TEST(OptionTables, PeersCanBeMatched) {
  struct Choice {
    const char *algo, *key, *values, *outside;
  };
  const Choice choices[] = {
      {"cpo", "kl_mean_over_dims", "false|true", "2"},
      {"ppo", "scale_cost_adv", "center|std", "mean"},
      {"trpo_lag", "multiplier_optimizer", "sgd|adam|softplus", "rmsprop"},
      {"focops", "multiplier_optimizer", "sgd|adam|softplus", "rmsprop"},
      {"focops", "multiplier_divide", "false|true", "2"},
      {"ppo_lag", "cost_loss", "combined|split", "none"},
      {"trpo_lag", "cost_loss", "combined|split", "none"},
      {"ipo", "cost_loss", "combined|split", "none"},
      {"ipo", "barrier", "epoch|exact", "none"},
      {"p3o", "penalty_clip", "false|true", "2"},
      {"p3o", "violation_scale", "step|discount|raw", "none"},
      {"cpo", "violation_scale", "step|discount|raw", "none"},
      {"pcpo", "violation_scale", "step|discount|raw", "none"},
      {"pcpo", "projection", "kl|l2", "l1"},
      {"cppo_pid", "pid_norm", "sum|diff|none", "half"},
      {"ppo", "std_schedule", "none|linear", "cosine"},
      {"ppo", "std_mode", "free|state", "none"},
      {"ppo", "learn_std", "false|true", "2"},
      {"ppo", "lr_schedule", "constant|linear|kl", "cosine"},
      {"ppo", "critic_lr_schedule", "constant|actor", "kl"},
      {"ppo", "activation", "tanh|elu|relu", "gelu"},
      {"ppo", "value_clip", "0|0.2", "-1"},
      {"ppo", "joint_grad_norm", "false|true", "2"},
      {"ppo", "max_grad_norm", "0|40", "-1"},
      {"ppo", "critic_l2", "0|0.001", "-1"},
      {"ppo", "normalize_obs", "false|true", "2"},
      {"ppo", "normalize_reward", "false|true", "2"},
      {"ppo", "normalize_cost", "false|true", "2"},
      {"ppo", "reward_factor", "0.01|1", "0"},
      {"ppo", "preset", "default|paper|omnisafe|safe", "none"},
  };
  for (const Choice& c : choices) {
    std::istringstream values(c.values);
    for (std::string value; std::getline(values, value, '|');) {
      AgentSetup s(c.algo, 1, 1, 4);
      s.with(c.key, value.c_str());
      EXPECT_EQ(thrown([&] { read(s); }).text, "") << c.algo << " " << c.key;
    }
    AgentSetup s(c.algo, 1, 1, 4);
    s.with(c.key, c.outside);
    EXPECT_NE(thrown([&] { read(s); }).code, Code::kOk) << c.algo << " " << c.key;
    EXPECT_NE(thrown([&] { read(s); }).code, Code::kNotFound) << c.algo << " " << c.key;
  }
}

// Regression tests: a deviation is learned, not scheduled, and KL is summed over dimensions.
TEST(OptionTables, DefaultsAreNotThePeersDefects) {
  for (int32_t i = 0; i < algo_count(); ++i) {
    AgentSetup s(algo_at(i).name, 1, 1, 4);
    const Options o = read(s);
    if (s.off_policy()) continue;  // they have neither
    EXPECT_TRUE(o.flag("learn_std"));
    EXPECT_STREQ(o.text("std_schedule"), "none");
    EXPECT_FALSE(o.knows("kl_mean_over_dims") && o.flag("kl_mean_over_dims"));
  }
}

// An option of another algorithm is not a spelling mistake.
TEST(OptionTables, AnErrorNamesTheAlgorithmThatHasTheOption) {
  AgentSetup s("td3", 1, 1, 4);
  s.with("Passes", "2");
  EXPECT_EQ(thrown([&] { read(s); }).code, Code::kNotFound);
  EXPECT_EQ(thrown([&] { read(s); }).text, "agent option Passes: td3 has no such option; ppo has");
  s.options.clear();
  s.config.settings = "\n horizon = 8\n\t replay_rows=10\nmemory = gru:4";
  EXPECT_EQ(thrown([&] { read(s); }).text, "agent option memory: td3 has no such option; ppo has");
  s.config.settings = "memry = gru:4";
  EXPECT_EQ(thrown([&] { read(s); }).text, "agent option memry: unknown");
  s.config.algo = "ppo";
  s.config.settings = "replay_rows=10";
  EXPECT_EQ(thrown([&] { read(s); }).text, "agent option replay_rows: ppo has no such option; td3 has");
}

TEST(OptionTables, AlgorithmsHaveTheirOwnDefaults) {
  AgentSetup focops("focops", 1, 1, 4), lag("ppo_lag", 1, 1, 4), trpo("trpo", 1, 1, 4);
  EXPECT_STREQ(read(focops).text("multiplier_optimizer"), "sgd");
  EXPECT_EQ(read(focops).number("multiplier_max"), 2);
  EXPECT_EQ(read(focops).number("early_stop_kl"), 0.02);
  EXPECT_STREQ(read(lag).text("multiplier_optimizer"), "adam");
  EXPECT_EQ(read(trpo).number("critic_learning_rate"), 1e-3);
}
