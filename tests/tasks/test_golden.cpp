// One number per task and engine that says whether its physics, observations, rewards or costs changed in any
// bit: the same on every machine. With RDM_WRITE_GOLDEN set, tests/golden/tasks.txt is written instead of
// compared; on Windows, tasks_windows.txt with the rows that differ there.
#include <gtest/gtest.h>
#include <redman/redman.h>

#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string>

#include "base/hash.hpp"

namespace {

// Episodes of random actions in four worlds: everything that a host can see joins the hash.
uint64_t run(const char* task, const rdm_option* engine) {
  rdm_pool_config c;
  rdm_pool_config_init(&c, sizeof c);
  c.task = task;
  c.options = engine;
  c.num_options = engine ? 1 : 0;
  c.num_envs = 4;
  c.seed = 7;
  rdm_pool* p = nullptr;
  EXPECT_EQ(rdm_pool_create(&p, &c), RDM_OK) << rdm_last_error();
  rdm_spec spec{};
  spec.struct_size = sizeof spec;
  rdm_buffers b{};
  b.struct_size = sizeof b;
  EXPECT_EQ(rdm_pool_get_spec(p, &spec), RDM_OK);
  EXPECT_EQ(rdm_pool_get_buffers(p, &b), RDM_OK);
  EXPECT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  uint64_t h = rdm::kHashSeed;
  for (int step = 0; step < 200; ++step) {
    EXPECT_EQ(rdm_pool_baseline(p, RDM_BASELINE_RANDOM), RDM_OK);
    EXPECT_EQ(rdm_pool_step(p), RDM_OK);
    h = rdm::hash_bytes(b.obs, sizeof(float) * 4 * static_cast<size_t>(spec.obs_dim), h);
    h = rdm::hash_bytes(b.reward, sizeof(float) * 4, h);
    h = rdm::hash_bytes(b.cost, sizeof(float) * 4 * static_cast<size_t>(spec.cost_dim), h);
  }
  uint64_t state = 0;
  EXPECT_EQ(rdm_pool_get_hash(p, -1, &state), RDM_OK);
  rdm_pool_destroy(p);
  return rdm::hash_bytes(&state, sizeof state, h);
}

bool has_engines(const rdm_task& task) {
  rdm_pool_config c;
  rdm_pool_config_init(&c, sizeof c);
  c.task = task.name;
  const rdm_option engine{"engine", "ode", 0};
  c.options = &engine;
  c.num_options = 1;
  rdm_spec spec{};
  spec.struct_size = sizeof spec;
  return rdm_pool_config_spec(&c, &spec) == RDM_OK;
}

constexpr const char* kRows = RDM_TEST_DATA "/golden/tasks.txt";
std::string text_of(const char* path) {
  std::ostringstream text;
  text << std::ifstream(path).rdbuf();
  return text.str();
}

#if defined(_WIN32)
// Another C library makes other rows: they stand in a file of their own.
constexpr const char* kWritten = RDM_TEST_DATA "/golden/tasks_windows.txt";
std::string recorded_rows() {
  std::string rows = text_of(kRows);
  std::ifstream others(kWritten);
  for (std::string row; std::getline(others, row);) {
    if (row[0] == '#') continue;
    const std::string key = row.substr(0, row.rfind(' ') + 1);
    const size_t at = rows.find(key);
    rows.replace(at, rows.find('\n', at) - at, row);
  }
  return rows;
}
std::string to_write(const std::string& now) {
  std::string out = "# rows of tasks.txt that differ on Windows: ODE asks the C library for arc tangents\n";
  const std::string rows = text_of(kRows);
  std::istringstream in(now);
  for (std::string row; std::getline(in, row);)
    if (rows.find(row + '\n') == std::string::npos) out += row + '\n';
  return out;
}
#else
constexpr const char* kWritten = kRows;
std::string recorded_rows() {
  return text_of(kRows);
}
std::string to_write(const std::string& now) {
  return now;
}
#endif

TEST(Golden, EveryTaskGivesTheRecordedBytes) {
  std::string now = "# task, engine, hash\n";
  for (int32_t i = 0; i < rdm_task_count(); ++i) {
    rdm_task t{};
    t.struct_size = sizeof t;
    ASSERT_EQ(rdm_task_at(i, &t), RDM_OK);
    const auto add = [&](const char* engine, const rdm_option* option) {
      char hash[20];
      std::snprintf(hash, sizeof hash, "%016" PRIx64, run(t.name, option));
      now += std::string(t.name) + " " + engine + " " + hash + "\n";
    };
    if (!has_engines(t)) {
      add("-", nullptr);
      continue;
    }
    for (const char* engine : {"articulated", "ode"}) {
      const rdm_option option{"engine", engine, 0};
      add(engine, &option);
    }
  }
  if (std::getenv("RDM_WRITE_GOLDEN")) {
    ASSERT_TRUE(std::ofstream(kWritten, std::ios::binary) << to_write(now)) << kWritten;
    GTEST_SKIP() << kWritten << " was written";
  }
  EXPECT_EQ(now, recorded_rows()) << "if the change is meant, run this test once with RDM_WRITE_GOLDEN=1";
}

}  // namespace
