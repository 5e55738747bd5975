// Cost limits of environments of a host's own that never end, or that end in rows which are not learned from.
#include <cmath>

#include "contract.hpp"

namespace {

enum class Ends { kNever, kInValidRows, kInInvalidRows };

// Four environments in which an action above 0 pays 1 and costs 1 in a control step, and one below pays and
// costs nothing: without a limit the best policy costs 1 per control step.
struct Temptation {
  static constexpr int32_t kEnvs = 4, kHorizon = 200, kLength = 100;
  rdm_agent* agent = nullptr;
  rdm_epoch epoch = {};
  double cost_per_step = 0;  // of the last epoch
  Ends ends;

  Temptation(const char* algo, const std::string& settings, int32_t max_steps, bool limited, Ends where)
      : ends(where) {
    const double limit = 5;
    const std::string all = "horizon=200\nhidden=8\nlearning_rate=0.003\n" + settings;
    rdm_agent_config c;
    EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
    c.algo = algo;
    c.obs_dim = c.action_dim = 1;
    c.num_envs = kEnvs;
    c.seed = 1;
    c.max_steps = max_steps;
    c.cost_limits = limited ? &limit : nullptr;
    c.settings = all.c_str();
    EXPECT_EQ(rdm_agent_create(&agent, &c), RDM_OK) << rdm_last_error();
    epoch.struct_size = sizeof epoch;
  }
  Temptation(const Temptation&) = delete;
  Temptation& operator=(const Temptation&) = delete;
  ~Temptation() { rdm_agent_destroy(agent); }

  void learn() {
    const float obs[kEnvs] = {1, 1, 1, 1};
    float action[kEnvs], paid[kEnvs];
    uint8_t over[kEnvs], valid[kEnvs];
    rdm_transition t = {};
    t.struct_size = sizeof t;
    t.reward = t.cost = paid;
    t.truncated = over, t.valid = valid, t.final_obs = obs;
    double cost = 0;
    for (int32_t step = 0; step < kHorizon; ++step) {
      ASSERT_EQ(rdm_agent_act(agent, obs, RDM_ACT_SAMPLE, action), RDM_OK);
      const bool last = step % kLength == kLength - 1;
      for (int32_t i = 0; i < kEnvs; ++i) {
        cost += paid[i] = action[i] > 0 ? 1.0f : 0.0f;
        over[i] = ends != Ends::kNever && last;
        valid[i] = ends != Ends::kInInvalidRows || !last;
      }
      ASSERT_EQ(rdm_agent_record(agent, &t), RDM_OK) << rdm_agent_error(agent);
    }
    ASSERT_EQ(rdm_agent_update(agent, obs, &epoch), RDM_OK) << rdm_agent_error(agent);
    cost_per_step = cost / (kEnvs * kHorizon);
  }

  // Mean cost of 100 control steps in the last third of so many epochs.
  double settle(int32_t epochs) {
    double sum = 0;
    int32_t count = 0;
    for (int32_t e = 0; e < epochs; ++e) {
      learn();
      if (3 * e >= 2 * epochs) sum += 100 * cost_per_step, ++count;
    }
    return sum / count;
  }
};

// An algorithm that keeps limits cannot be made without one.
bool keeps_limits(const char* algo) {
  rdm_agent_config c;
  size_t bytes = 0;
  EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  c.algo = algo;
  c.obs_dim = c.action_dim = c.num_envs = 1;
  c.settings = "cost_limit=-1";
  return rdm_agent_config_memory(&c, &bytes) == RDM_ERROR_ARGUMENT;
}

// Where all or nothing is best, as here, what learns from a replay memory acts almost without noise and does one of
// the two in turn: its limits are looked at where a mean can be kept (tests/algos/test_off_policy.cpp, the manual).
bool replays(int32_t algo) {
  return has_option(algo, "replay_rows");
}

std::vector<std::string> safe_algos() {
  std::vector<std::string> names;
  for (int32_t i = 0; i < rdm_algo_count(); ++i) {
    rdm_algo algo = {};
    algo.struct_size = sizeof algo;
    EXPECT_EQ(rdm_algo_at(i, &algo), RDM_OK);
    if (keeps_limits(algo.name) && !replays(i)) names.emplace_back(algo.name);
  }
  return names;
}

// The barrier's slope of IPO ends at barrier_max, 1: no more than the reward that each cost comes with here. RCPO learns
// from what is left of that reward, all or nothing of it on either side of a multiplier of 1: a multiplier that comes from
// below in small steps finds a policy that never tries anything else.
std::string own_settings(const std::string& algo) {
  if (algo == "rcpo")
    return "multiplier_optimizer=sgd\nmultiplier_init=1\nmultiplier_lr=0.002\nmultiplier_gain=0.1\n";
  return algo == "ipo" ? "barrier_max=5\n" : "";
}

class ContractLimits : public testing::TestWithParam<std::string> {};

}  // namespace

TEST_P(ContractLimits, HoldWhereNoEpisodeEnds) {
  const struct {
    const char* settings;
    int32_t max_steps;
    bool limited;
    uint32_t flags;
  } rows[] = {{"", 100, true, RDM_EPOCH_CUT},
              {"episode_steps=100", 0, true, RDM_EPOCH_CUT},
              {"cost_limit_per_step=0.05", 0, false, RDM_EPOCH_NO_EPISODE}};
  for (const auto& row : rows) {
    Temptation t(GetParam().c_str(), own_settings(GetParam()) + row.settings, row.max_steps, row.limited,
                 Ends::kNever);
    EXPECT_LE(t.settle(300), 1.2 * 5) << row.settings << ", max_steps " << row.max_steps;
    EXPECT_EQ(t.epoch.flags, row.flags);
    EXPECT_EQ(std::isnan(t.epoch.cost[0]), (row.flags & RDM_EPOCH_NO_EPISODE) != 0);
    EXPECT_NEAR(t.epoch.cost_per_step, 0.05, 0.1);
  }
}

// A sum over an episode that never ends has no value, but it is at least what those that run came to.
TEST_P(ContractLimits, OnSumsWithoutAnEndAreBrokenByThoseThatRun) {
  Temptation t(GetParam().c_str(), own_settings(GetParam()), 0, true, Ends::kNever);
  EXPECT_LE(t.settle(150), 1.2 * 5);
  EXPECT_EQ(t.epoch.flags, RDM_EPOCH_NO_EPISODE);
  EXPECT_EQ(t.epoch.episodes, 0);
  for (const double x :
       {t.epoch.ret, t.epoch.cost[0], t.epoch.length, t.epoch.fall_rate, t.epoch.success_rate})
    EXPECT_TRUE(std::isnan(x));
  EXPECT_NEAR(t.epoch.cost_per_step, t.cost_per_step, 1e-12);
}

// An emergency stop: the row is bad, and it ends the episode.
TEST_P(ContractLimits, AnEndInARowThatIsNotLearnedFromIsAnEnd) {
  Temptation good(GetParam().c_str(), "", 0, true, Ends::kInValidRows);
  Temptation bad(GetParam().c_str(), "", 0, true, Ends::kInInvalidRows);
  good.learn();
  bad.learn();
  EXPECT_EQ(good.epoch.flags, 0u);
  EXPECT_EQ(bad.epoch.flags, RDM_EPOCH_INVALID_ROWS);
  EXPECT_EQ(bad.epoch.invalid_rows, 2 * Temptation::kEnvs);
  EXPECT_EQ(good.epoch.episodes, 2 * Temptation::kEnvs);
  EXPECT_EQ(bad.epoch.episodes, good.epoch.episodes);
  EXPECT_EQ(bad.epoch.length, good.epoch.length);
  EXPECT_NEAR(bad.epoch.cost[0], 2 * 100 * bad.cost_per_step / 2, 1e-9);  // the bad rows' costs too
  EXPECT_NEAR(bad.epoch.cost[0], good.epoch.cost[0], 1e-9);
  EXPECT_NEAR(bad.epoch.multiplier[0], good.epoch.multiplier[0], 1e-3 * std::abs(good.epoch.multiplier[0]));
}

INSTANTIATE_TEST_SUITE_P(SafeAlgos, ContractLimits, testing::ValuesIn(safe_algos()),
                         [](const auto& each) { return each.param; });
