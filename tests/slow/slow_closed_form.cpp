// Each algorithm for one agent on three worlds with a known optimum, five seeds: return within 2 % of the
// constrained optimum and cost within 2 % of its limit or below in every seed (PPO and TRPO: the optimum
// without a limit). Learners from a replay memory: by the mean action. CLOSED_FORM_ALGO=name runs one alone.
#include <algorithm>
#include <iterator>
#include <sstream>

#include "closed_form.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

constexpr double kWithin = 0.02;

struct Key {
  const char *key, *text;
};
// Options for the algorithms of a list, a later line wins.
struct Setting {
  const char* algos;
  std::vector<Key> keys;
};
using Settings = std::vector<Setting>;

constexpr const char* kAlgos[] = {"ppo",    "trpo", "ppo_lag", "trpo_lag", "cppo_pid", "cpo", "pcpo",
                                  "focops", "p3o",  "ipo",     "pdo",      "rcpo",     "cup", "crpo"};
constexpr const char* kFree = "ppo trpo";
constexpr const char* kLimited = "ppo_lag trpo_lag cppo_pid cpo pcpo focops p3o ipo pdo rcpo cup crpo";
constexpr const char* kEvery = "ppo trpo ppo_lag trpo_lag cppo_pid cpo pcpo focops p3o ipo pdo rcpo cup crpo";
constexpr const char* kClipped = "ppo ppo_lag cppo_pid p3o ipo rcpo cup";
constexpr const char* kTrust = "trpo trpo_lag cpo pcpo crpo";
constexpr const char* kDual = "ppo_lag trpo_lag focops pdo rcpo cup";

bool lists(const char* algos, const char* algo) {
  std::istringstream words(algos);
  return std::find(std::istream_iterator<std::string>(words), {}, algo) !=
         std::istream_iterator<std::string>();
}

// What all worlds share. Policies are linear in the observation, as the optima are. Dual variables start at
// their least and settle by an integral and a proportional term; without the second they circle.
Settings with(const Settings& world) {
  Settings all = {
      {kEvery,
       {{"hidden", ""},
        {"last_layer_scale", "0"},
        {"normalize_obs", "false"},
        {"learn_std", "false"},
        {"critic_l2", "0"},
        {"lr_schedule", "linear"},
        {"passes", "2"}}},
      {kDual, {{"multiplier_optimizer", "sgd"}, {"multiplier_init", "0"}}},
      {"focops", {{"multiplier_max", "100"}, {"temperature", "0.7"}}},
      {"cppo_pid", {{"pid_init", "0"}, {"pid_kd", "0"}, {"pid_smooth_p", "0"}}},
  };
  all.insert(all.end(), world.begin(), world.end());
  return all;
}

// Rate and proportional gain of the dual variables.
Settings dual(const char* rate, const char* gain, Settings more) {
  more.push_back({kDual, {{"multiplier_lr", rate}, {"multiplier_gain", gain}}});
  more.push_back({"cppo_pid", {{"pid_ki", rate}, {"pid_kp", gain}}});
  return more;
}

template <class World>
Judged learn(const char* algo, uint64_t seed, const Settings& settings, const char* epochs) {
  AgentSetup s(algo, World::kObs, 1, 50);
  s.config.seed = seed;
  const std::string limit = std::to_string(World::kLimit + World::kShift);
  s.with("cost_limit", limit.c_str()).with("total_epochs", epochs);
  for (const Setting& line : settings)
    for (const Key& k : line.keys)
      if (lists(line.algos, algo)) s.with(k.key, k.text);
  return learn_world<World>(s, std::atoi(epochs));
}

// Judges five seeds of each of `algos`, and says how far they are from the optimum; learn(algo, seed).
template <class World, class Algos, class Learn>
void judge(const char* world, const Algos& algos, double free, Learn&& learn) {
  const char* only = std::getenv("CLOSED_FORM_ALGO");
  for (const char* algo : algos) {
    if (only && std::strcmp(only, algo) != 0) continue;
    const bool limited = !lists(kFree, algo);
    const double best = limited ? World::kBest : free;
    double worst_ret = -1e9, worst_cost = -1e9, mean_ret = 0, mean_cost = 0;
    for (uint64_t seed = 1; seed <= 5; ++seed) {
      const Judged j = learn(algo, seed);
      const double off = (best - j.ret) / std::abs(best), over = (j.cost - World::kLimit) / World::kLimit;
      worst_ret = std::max(worst_ret, off);
      worst_cost = std::max(worst_cost, over);
      mean_ret += j.ret / 5, mean_cost += j.cost / 5;
      EXPECT_LT(off, kWithin) << algo << "seed" << seed << ": return " << j.ret;
      if (limited) {
        EXPECT_LT(over, kWithin) << algo << "seed" << seed << ": cost " << j.cost;
      }
    }
    std::printf("%-10s %-9s return %9.4f (best %9.4f, worst seed %5.2f %% below) cost %7.4f", world, algo,
                mean_ret, best, 100 * worst_ret, mean_cost);
    if (limited) std::printf(" (limit %g, worst seed %+.2f %%)", World::kLimit, 100 * worst_cost);
    std::printf("\n");
    std::fflush(stdout);
  }
}

template <class World>
void run(const char* world, const char* epochs, const Settings& settings) {
  judge<World>(world, kAlgos, World::kFree,
               [&](const char* algo, uint64_t seed) { return learn<World>(algo, seed, settings, epochs); });
}

// Learners from a replay memory: 50 worlds, an epoch of 20 decisions each, 100 gradient steps after it. Their actions have
// noise of kNoise while they collect, of which the limit that they are told has its part.
template <class World>
void run_off_policy(const char* world, int epochs, const std::vector<Key>& multipliers) {
  constexpr const char* kOffPolicy[] = {"td3_lag", "td3_pid", "sac_lag", "sac_pid"};
  constexpr double kNoise = 0.05;
  static constexpr Key kShared[] = {{"hidden", ""},
                                    {"critic_hidden", "32,32"},
                                    {"activation", "elu"},
                                    {"horizon", "20"},
                                    {"normalize_obs", "false"},
                                    {"start_steps", "2000"},
                                    {"batch_rows", "256"},
                                    {"updates_per_step", "0.1"},
                                    {"replay_rows", "20000"},
                                    {"learning_rate", "3e-4"},
                                    {"critic_learning_rate", "1e-3"},
                                    {"tau", "0.02"},
                                    {"discount", "0.9"},
                                    {"explore_std", "0.05"},
                                    {"target_std", "0.05"},
                                    {"init_std", "0.05"},
                                    {"std_min", "0.0499"},
                                    {"std_max", "0.0501"},
                                    {"temperature", "0"},
                                    {"temperature_learning_rate", "0"},
                                    {"multiplier_optimizer", "sgd"},
                                    {"multiplier_init", "0"},
                                    {"pid_init", "0"},
                                    {"pid_kd", "0"},
                                    {"pid_smooth_p", "0"}};
  judge<World>(world, kOffPolicy, World::kBest, [&](const char* algo, uint64_t seed) {
    AgentSetup s(algo, World::kObs, 1, 50);
    s.config.seed = seed;
    const std::string limit = std::to_string(World::limit(kNoise * static_cast<double>(kBound)));
    s.with("cost_limit", limit.c_str());
    for (const Key& k : kShared) s.with_known(k.key, k.text);
    for (const Key& k : multipliers) s.with_known(k.key, k.text);
    return learn_world<World>(s, epochs, kBound);
  });
}

}  // namespace

// Steps that chase the batch's own optimum need a larger batch.
TEST(ClosedForm, Bandit) {
  run<BanditWorld>(
      "bandit", "100",
      with(dual("0.15", "0.5",
                {{kEvery, {{"init_std", "0.5"}, {"horizon", "160"}, {"learning_rate", "5e-2"}}},
                 {kTrust, {{"trust_kl", "0.05"}}},
                 {kLimited, {{"multiplier_window", "8000"}}},
                 {"trpo_lag focops", {{"horizon", "480"}, {"multiplier_window", "24000"}}},
                 {"trpo_lag", {{"trust_kl", "0.02"}}},
                 // The projection has to get as far as the improvement, of whose moments it begins.
                 {"cup", {{"passes", "4"}, {"projection_passes", "16"}, {"learning_rate", "1e-2"}}},
                 // A barrier whose slope cannot reach the optimal multiplier does not hold.
                 {"ipo", {{"barrier_max", "4"}, {"learning_rate", "1e-2"}}}})));
}

TEST(ClosedForm, TwoState) {
  run<TwoStateWorld>(
      "two_state", "150",
      with(dual(
          "0.03", "0.3",
          {{kEvery, {{"init_std", "1"}, {"horizon", "300"}, {"discount", "1"}, {"learning_rate", "2e-2"}}},
           {kLimited, {{"multiplier_window", "1500"}}},
           {"ppo_lag trpo_lag cppo_pid focops pdo cup",
            {{"horizon", "450"}, {"multiplier_window", "2250"}, {"learning_rate", "1e-2"}}},
           {"rcpo crpo", {{"horizon", "900"}, {"multiplier_window", "4500"}}},
           {"rcpo", {{"learning_rate", "1e-2"}}},
           {"cup", {{"passes", "4"}, {"projection_passes", "8"}, {"projection_factor", "1"}}},
           // With the whole batch the penalty switches where the predicted cost meets the limit.
           {"p3o", {{"penalty", "1"}, {"minibatches", "1"}, {"passes", "8"}, {"multiplier_window", "3000"}}},
           {"ipo", {{"barrier_max", "0.5"}, {"multiplier_window", "4500"}}}})));
}

// Rewards are not standardised: the deviation of the advantage falls while the critic learns, and the optimal
// multiplier would rise with it.
TEST(ClosedForm, LqrLine) {
  run<LqrWorld>("lqr_line", "120",
                with(dual("0.1", "1.5",
                          {{kEvery,
                            {{"init_std", "0.1"},
                             {"critic_hidden", "16"},
                             {"activation", "relu"},
                             {"horizon", "600"},
                             {"discount", "1"},
                             {"standardize_reward_adv", "false"},
                             {"learning_rate", "2e-2"},
                             {"critic_learning_rate", "1e-2"},
                             {"minibatches", "8"}}},
                           {kClipped, {{"clip", "0.5"}}},
                           {kTrust, {{"trust_kl", "0.02"}}},
                           {kLimited, {{"multiplier_window", "1500"}}},
                           {"focops", {{"temperature", "0.2"}}},
                           {"p3o", {{"penalty", "1"}, {"minibatches", "2"}, {"multiplier_window", "3000"}}},
                           {"ipo", {{"multiplier_window", "3000"}}}})));
}

// Linear policies and smooth critics of two hidden layers; the noise of SAC's policies is held where TD3's is.
TEST(ClosedForm, OffPolicyBandit) {
  run_off_policy<BoundedBandit>("bandit", 300,
                                {{"multiplier_window", "200"},
                                 {"multiplier_lr", "0.2"},
                                 {"multiplier_gain", "0.5"},
                                 {"pid_ki", "0.2"},
                                 {"pid_kp", "0.5"}});
}

// Uniform actions at the beginning cost a hundred times the limit: the multipliers are bounded, so that their integral
// comes down again.
TEST(ClosedForm, OffPolicyLqrLine) {
  run_off_policy<BoundedLqr>("lqr_line", 600,
                             {{"multiplier_window", "1000"},
                              {"multiplier_lr", "0.01"},
                              {"multiplier_gain", "0.3"},
                              {"multiplier_max", "0.6"},
                              {"pid_ki", "0.01"},
                              {"pid_kp", "0.3"},
                              {"pid_max", "0.6"}});
}
