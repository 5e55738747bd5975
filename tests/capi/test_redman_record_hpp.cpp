// record.hpp: the owner of a recording, through a whole lesson: rows of a pool, a file, a clone.
#include <gtest/gtest.h>

#include <filesystem>
#include <redman/record.hpp>
#include <redman/redman.hpp>

namespace {

constexpr float kTaught = 0.5f;

// Rows of `two_state`, in which the teacher always means kTaught.
redman::Recording lesson(redman::Pool& pool, int steps) {
  redman::Recording r(pool, 64);
  const std::vector<float> label(pool.num_envs() * pool.action().width(), kTaught);
  pool.reset();
  for (int t = 0; t < steps; ++t) {
    pool.baseline(RDM_BASELINE_RANDOM);
    r.begin_step(pool, label.data());
    pool.step();
    r.end_step(pool);
  }
  return r;
}

TEST(RedmanRecordHpp, HoldsRowsOfAPoolAndOfOthers) {
  redman::Pool pool(redman::pool_config("two_state", 3));
  redman::Recording r = lesson(pool, 10);
  EXPECT_EQ(r.info().rows, 30);
  EXPECT_STREQ(r.info().task, "two_state");
  EXPECT_EQ(r.rows().label[29], kTaught);
  redman::Recording twice(pool);
  twice.append(r);
  twice.append(r);
  EXPECT_EQ(twice.info().rows, 60);
  twice.append(r.rows());
  EXPECT_EQ(twice.info().rows, 90);
  twice.clear();
  EXPECT_EQ(twice.info().rows, 0);
}

TEST(RedmanRecordHpp, FilesComeBack) {
  redman::Pool pool(redman::pool_config("two_state", 2));
  const redman::Recording r = lesson(pool, 5);
  const std::string path = testing::TempDir() + "redman_record_hpp.npz";
  r.save(path.c_str());
  const redman::Recording back(path.c_str());
  EXPECT_EQ(back.info().fingerprint, r.info().fingerprint);
  std::filesystem::remove(path);
  try {
    redman::Recording none(path.c_str());
    FAIL() << "a file that is not there was read";
  } catch (const redman::Error& e) {
    EXPECT_EQ(e.code(), RDM_ERROR_NOT_FOUND);
  }
}

TEST(RedmanRecordHpp, FilterSaysHowManyEpisodesWent) {
  redman::Pool pool(redman::pool_config("bandit", 4));  // each step is an episode
  redman::Recording r = lesson(pool, 6);
  EXPECT_EQ(r.info().episodes, 24);
  const double any = -1, none = 0;
  EXPECT_EQ(r.filter(false, &any), 0);
  const int64_t dropped = r.filter(false, &none);
  EXPECT_GT(dropped, 0);
  EXPECT_EQ(r.info().episodes, 24 - dropped);
  EXPECT_EQ(r.filter(true), 24 - dropped);  // a bandit knows no success
}

TEST(RedmanRecordHpp, AnAgentClonesIt) {
  redman::Pool pool(redman::pool_config("two_state", 4));
  const redman::Recording r = lesson(pool, 200);
  redman::Agent agent(redman::agent_config(pool));
  rdm_clone_config how = redman::clone_config();
  how.epochs = 60;
  how.batch_rows = 64;
  const rdm_clone_report report = redman::clone(agent, r, how);
  EXPECT_EQ(report.train_rows + report.validation_rows, 800);
  EXPECT_LT(report.train_loss, 1e-3);
  const redman::Policy student(agent.policy());
  std::vector<float> action(pool.action().width());
  student.act(pool.obs()[0].data(), 1, nullptr, action.data());
  EXPECT_NEAR(action[0], kTaught, 0.05);
  EXPECT_FALSE(redman::Recording());
}

}  // namespace
