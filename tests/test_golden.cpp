// One number per task that says whether its physics, observations or rewards changed in any bit.
//
// Bits of sine, cosine and exponential differ between mathematics libraries and processors, so the numbers
// are kept per probe of the machine. A machine that is not in the list is a reported skip, never green.
#include <gtest/gtest.h>
#include <redman/redman.h>

#include <cinttypes>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <sstream>
#include <string>

#include "base/hash.hpp"

namespace {

uint64_t probe() {
  uint64_t h = rdm::kHashSeed;
  volatile double x = 0.1;  // not folded by the compiler
  for (int i = 0; i < 1000; ++i) {
    const double v[] = {std::sin(x), std::cos(x),        std::exp(-x),
                        std::log(x), std::asin(x / 200), std::atan2(x, 3.0)};
    h = rdm::hash_bytes(v, sizeof v, h);
    x = x + 0.137;
  }
  return h;
}

std::string hex(uint64_t v) {
  char text[20];
  std::snprintf(text, sizeof text, "%016" PRIx64, v);
  return text;
}

// Episodes of random actions in four worlds: everything that a host can see joins the hash.
uint64_t run(const char* task) {
  rdm_pool_config c;
  rdm_pool_config_init(&c, sizeof c);
  c.task = task;
  c.num_envs = 4;
  c.seed = 7;
  rdm_pool* p = nullptr;
  EXPECT_EQ(rdm_pool_create(&p, &c), RDM_OK) << rdm_last_error();
  rdm_spec spec{};
  spec.struct_size = sizeof spec;
  rdm_buffers b{};
  b.struct_size = sizeof b;
  EXPECT_EQ(rdm_pool_get_spec(p, &spec), RDM_OK);
  EXPECT_EQ(rdm_pool_buffers(p, &b), RDM_OK);
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
  EXPECT_EQ(rdm_pool_hash(p, -1, &state), RDM_OK);
  rdm_pool_destroy(p);
  return rdm::hash_bytes(&state, sizeof state, h);
}

TEST(Golden, EveryTaskGivesTheRecordedBytes) {
  const std::string machine = hex(probe());
  std::string missing;
  bool known = false;
  for (int32_t i = 0; i < rdm_task_count(); ++i) {
    rdm_task t{};
    t.struct_size = sizeof t;
    ASSERT_EQ(rdm_task_at(i, &t), RDM_OK);
    const std::string now = hex(run(t.name));
    std::ifstream file(RDM_TEST_DATA "/golden/tasks.txt");
    ASSERT_TRUE(file) << "tests/golden/tasks.txt is missing";
    bool found = false;
    for (std::string line; std::getline(file, line);) {
      std::istringstream words(line);
      std::string where, task, hash;
      words >> where >> task >> hash;
      if (where != machine || task != t.name) continue;
      found = known = true;
      EXPECT_EQ(now, hash) << t.name
                           << ": if the change is meant, write the new number into tests/golden/tasks.txt";
    }
    if (!found) missing += machine + " " + t.name + " " + now + "\n";
  }
  if (missing.empty()) return;
  std::fprintf(stderr, "not recorded for this machine (probe, task, hash):\n%s", missing.c_str());
  ASSERT_FALSE(known) << "a task is not recorded in tests/golden/tasks.txt";
  GTEST_SKIP() << "no numbers are recorded for this machine's mathematics";
}

}  // namespace
