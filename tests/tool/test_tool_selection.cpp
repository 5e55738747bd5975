// Which policy `train` keeps: one that holds its limits with a margin, chosen by episodes that no report
// plays, and nothing that is no policy.
#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <set>

#include "common/files.hpp"
#include "common/report.hpp"
#include "run/note.hpp"
#include "run/score.hpp"
#include "run/trainer.hpp"

namespace {

using namespace tool;

// Episodes with these sums of column 0, and 1 more each of column 1.
Summary summary(const std::vector<double>& costs, const std::vector<double>& limits) {
  std::vector<Episode> episodes;
  for (const double c : costs) {
    Episode e;
    e.ret = 10;
    e.length = 5;
    e.cost = {c, c + 1};
    episodes.push_back(e);
  }
  return summarise(episodes, limits);
}

TEST(Selection, StandardErrorsAreOfTheMean) {
  const Summary s = summary({1, 2, 3, 4}, {-1, -1});
  EXPECT_NEAR(s.cost_stderr[0], std::sqrt(5.0 / 3 / 4), 1e-12);  // sample variance 5/3
  EXPECT_EQ(s.return_stderr, 0);
  EXPECT_TRUE(std::isnan(summary({1}, {-1, -1}).cost_stderr[0]));
}

TEST(Selection, AMeanOnTheLimitIsNotFeasible) {
  const std::vector<double> first = {40, -1}, second = {-1, 40}, none = {-1, -1};
  const std::vector<double> steady(20, 39.0);
  std::vector<double> noisy = steady;  // the same mean, a standard error of 4.6
  for (size_t i = 0; i < noisy.size(); ++i) noisy[i] += i % 2 ? 20 : -20;
  EXPECT_TRUE(score_of(summary(steady, first), first).feasible);
  EXPECT_TRUE(score_of(summary(steady, second), second).feasible);
  EXPECT_FALSE(score_of(summary(noisy, first), first).feasible);
  EXPECT_FALSE(score_of(summary(noisy, second), second).feasible);
  EXPECT_TRUE(score_of(summary(noisy, none), none).feasible);
  const Score safe = score_of(summary(steady, first), first), risky = score_of(summary(noisy, first), first);
  EXPECT_TRUE(safe.better_than(risky));
  EXPECT_FALSE(risky.better_than(safe));
  EXPECT_GT(score_of(summary(noisy, second), second).excess, risky.excess);
}

TEST(Selection, EpisodesAreOfNoReportAndNoOtherRun) {
  std::set<uint64_t> seen;
  for (uint64_t run = 0; run < 50; ++run)
    for (size_t i = 0; i < kSelectionEpisodes * (1 + kConfirmations); ++i) {
      const uint64_t seed = selection_seed(run, i);
      EXPECT_GE(seed, uint64_t{1} << 63);
      EXPECT_TRUE(seen.insert(seed).second);
    }
  EXPECT_LT(49 + Trainer::kEvalSeed, uint64_t{1} << 63);
}

TEST(Selection, ABestPolicyThatIsNoneIsNotWrittenOut) {
  const std::string dir = testing::TempDir() + "redman_selection_" + std::to_string(getpid());
  RunSettings s;
  s.pool.task = "bandit";
  s.pool.envs = 2;
  s.agent.options = {{"hidden", "4"}, {"horizon", "8"}};
  s.steps = 64;
  s.eval_every = s.checkpoint_every = 1;
  {
    Trainer trainer(s);
    trainer.prepare();
    trainer.begin(RunFolder::create(dir, false));
    trainer.run();
  }
  redman::Pool pool = make_pool(s.pool, RDM_AUTORESET_SAME_STEP);
  const auto limits = cost_limits(pool, {});
  redman::Agent agent = make_agent(s.agent, pool, limits, s.pool.seed, s.pool.threads);
  const std::string checkpoint = dir + "/checkpoint.rdm";
  std::string bytes(1 << 20, '\0');
  size_t size = 0;
  redman::check(
      rdm_checkpoint_read(checkpoint.c_str(), agent.get(), pool.get(), bytes.data(), bytes.size(), &size));
  const Note good = parse_note(bytes.data(), size);
  ASSERT_TRUE(good.best);
  const std::string policy = read_file(dir + "/policy.rdm");
  EXPECT_EQ(std::string(good.best_policy.begin(), good.best_policy.end()), policy);

  Note cut = good, other = good;
  cut.best_policy.resize(cut.best_policy.size() / 2);
  PoolSettings wide = s.pool;
  wide.task = "two_state";
  const redman::Pool worlds = make_pool(wide, RDM_AUTORESET_SAME_STEP);
  other.best_policy = make_agent(s.agent, worlds, cost_limits(worlds, {}), 0, 0).policy();
  for (const Note* bad : {&cut, &other}) {
    const std::string note = note_bytes(*bad);
    redman::check(
        rdm_checkpoint_write(checkpoint.c_str(), agent.get(), pool.get(), note.data(), note.size()));
    EXPECT_THROW(
        {
          Trainer trainer(s);
          trainer.resume(RunFolder::go_on(dir));
          trainer.run();
        },
        Failure);
    EXPECT_EQ(read_file(dir + "/policy.rdm"), policy);
  }
  std::filesystem::remove_all(dir);
}

}  // namespace
