// States whose checksums are right and whose contents are not: no bytes lead to undefined behaviour, for any
// task and engine. What no world can have is RDM_ERROR_FORMAT and changes nothing.
#include <cmath>
#include <limits>

#include "contract.hpp"
#include "state_bytes.hpp"

namespace {

constexpr double kInf = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

class ContractState : public testing::TestWithParam<std::string> {
 protected:
  static constexpr int32_t kWorlds = 2;

  rdm_pool* started(int32_t autoreset = RDM_AUTORESET_SAME_STEP, const char* engine = nullptr) const {
    const rdm_option options[] = {{"engine", engine, 0}};
    rdm_pool_config c = pool_config(kWorlds);
    c.task = GetParam().c_str();
    c.autoreset = autoreset;
    c.options = options;
    c.num_options = engine ? 1 : 0;
    rdm_pool* p = nullptr;
    if (rdm_pool_create(&p, &c)) return nullptr;
    EXPECT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
    play(p, 5);
    return p;
  }
  static void play(rdm_pool* p, int steps, bool reset = false) {
    const rdm_buffers b = buffers_of(p);
    for (int i = 0; i < steps; ++i) {
      for (int env = 0; reset && env < kWorlds; ++env) {
        uint8_t ended[kWorlds] = {};
        ended[env] = b.terminated[env] || b.truncated[env];
        ASSERT_EQ(rdm_pool_reset(p, nullptr, ended), RDM_OK);
      }
      ASSERT_EQ(rdm_pool_baseline(p, RDM_BASELINE_RANDOM), RDM_OK);
      ASSERT_EQ(rdm_pool_step(p), RDM_OK) << rdm_pool_error(p);
    }
  }
  static rdm_result set(rdm_pool* p, const std::vector<unsigned char>& state) {
    return rdm_pool_read_state(p, 0, state.data(), state.size());
  }
  // Rows of both worlds are finite.
  static void expect_finite(const rdm_pool* p) {
    const rdm_spec s = spec_of(p);
    const rdm_buffers b = buffers_of(p);
    for (int i = 0; i < kWorlds * s.obs_dim; ++i) ASSERT_TRUE(std::isfinite(b.obs[i])) << i;
    for (int i = 0; i < kWorlds * s.cost_dim; ++i) ASSERT_TRUE(std::isfinite(b.episode_cost[i])) << i;
    for (int i = 0; i < kWorlds; ++i) {
      ASSERT_TRUE(std::isfinite(b.reward[i]));
      ASSERT_TRUE(std::isfinite(b.episode_return[i]));
    }
  }
  // Hostile values at up to `places` of [begin, end): each is refused or gone on with, never worse.
  void tamper(rdm_pool* p, size_t begin, size_t end, size_t places) const {
    const StateBytes good(p, 0);
    const uint64_t other = hash_of(p, 1);
    const size_t stride = 4 * std::max<size_t>(1, (end - begin) / 4 / places);
    const auto attempt = [&](size_t at, const auto& value) {
      if (at + sizeof value > end) return;
      SCOPED_TRACE(at - begin);
      const uint64_t before = hash_of(p);
      const rdm_result r = set(p, good.with(at, value));
      ASSERT_TRUE(r == RDM_OK || r == RDM_ERROR_FORMAT) << r << ' ' << rdm_pool_error(p);
      if (r == RDM_ERROR_FORMAT) {
        ASSERT_EQ(hash_of(p), before);
        return;
      }
      ASSERT_EQ(hash_of(p, 1), other);
      const uint8_t alone[kWorlds] = {1, 0};
      for (int i = 0; i < 2; ++i) {
        ASSERT_EQ(rdm_pool_step_masked(p, alone), RDM_OK) << rdm_pool_error(p);
        expect_finite(p);
      }
      ASSERT_EQ(set(p, good.bytes()), RDM_OK) << rdm_pool_error(p);
    };
    for (size_t at = begin; at < end; at += stride) {
      for (const uint32_t bits : {0x20000000u, 0x7fffffffu, 0xffffffffu, 0x7fc00000u, 0x7f7fffffu, 17u})
        ASSERT_NO_FATAL_FAILURE(attempt(at, bits));
      for (const double number : {kNan, -kInf, 1e308, -1e30, 1e9})
        ASSERT_NO_FATAL_FAILURE(attempt(at, number));
    }
  }
};

TEST_P(ContractState, AnEpisodeThatCannotBeIsRefused) {
  rdm_pool* p = started();
  const rdm_spec spec = spec_of(p);
  const StateBytes good(p, 0);
  play(p, 2);
  const uint64_t before = hash_of(p);
  const rdm_buffers b = buffers_of(p);
  const float reward = b.reward[0];
  const auto refused = [&](const char* what, const std::vector<unsigned char>& state) {
    EXPECT_EQ(set(p, state), RDM_ERROR_FORMAT) << what;
    EXPECT_EQ(hash_of(p), before) << what;
    EXPECT_EQ(b.reward[0], reward) << what;
  };
  refused("phase 3", good.with(good.phase(), uint32_t{3}));
  int32_t steps = 0;
  std::memcpy(&steps, good.bytes().data() + good.step(), sizeof steps);
  if (steps > 0) refused("new after some steps", good.with(good.phase(), uint32_t{0}));
  refused("ended without a flag", good.with(good.phase(), uint32_t{2}));
  refused("running with a flag", good.with(good.terminated(), uint8_t{1}));
  refused("flag 2", good.with(good.truncated(), uint8_t{2}));
  for (const int32_t step : {-1, INT32_MIN, spec.max_steps, INT32_MAX})
    refused("step", good.with(good.step(), step));
  for (int32_t k = 0; k <= spec.cost_dim; ++k)
    for (const double sum : {kNan, kInf, 1e39, -1e300})
      refused("sum", good.with(good.sums() + sizeof(double) * static_cast<size_t>(k), sum));
  for (int32_t i = 0; i < spec.obs_dim; ++i)
    for (const double x : {kNan, kInf, -kInf})
      refused("observation",
              good.with(good.obs() + sizeof(float) * static_cast<size_t>(i), static_cast<float>(x)));
  EXPECT_EQ(set(p, good.bytes()), RDM_OK) << rdm_pool_error(p);
  rdm_pool_destroy(p);
}

TEST_P(ContractState, TheTasksPartIsRefusedOrGoneOnWith) {
  rdm_pool* p = started();
  const StateBytes good(p, 0);
  tamper(p, good.task(), good.episode(), 1 << 20);
  rdm_pool_destroy(p);
}

TEST_P(ContractState, TheEnginesPartIsRefusedOrGoneOnWith) {
  for (const char* engine : {static_cast<const char*>(nullptr), "ode"}) {
    rdm_pool* p = started(RDM_AUTORESET_SAME_STEP, engine);
    if (!p) continue;  // a task that moves its bodies itself
    SCOPED_TRACE(engine ? engine : "default");
    const StateBytes good(p, 0);
    tamper(p, good.world(), good.task(), 60);
    rdm_pool_destroy(p);
  }
}

// Whatever a pool saves, it takes back: new, running, ended and lost worlds, in each mode.
TEST_P(ContractState, WhatWasSavedIsTakenBack) {
  for (const int32_t mode : {RDM_AUTORESET_SAME_STEP, RDM_AUTORESET_NEXT_STEP, RDM_AUTORESET_OFF}) {
    rdm_pool_config c = pool_config(kWorlds);
    c.task = GetParam().c_str();
    c.autoreset = mode;
    rdm_pool* p = make_pool(c);
    const auto round_trip = [&] {
      const uint64_t before = hash_of(p);
      ASSERT_EQ(set(p, StateBytes(p, 0).bytes()), RDM_OK) << rdm_pool_error(p);
      ASSERT_EQ(hash_of(p), before);
    };
    round_trip();
    ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
    round_trip();
    play(p, 3, mode == RDM_AUTORESET_OFF);
    round_trip();
    ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
    const rdm_buffers b = buffers_of(p);
    b.action[0] = static_cast<float>(kNan);
    ASSERT_EQ(rdm_pool_step(p), RDM_OK);
    ASSERT_EQ(b.truncated[0], 1);
    round_trip();
    rdm_pool_destroy(p);
  }
}

INSTANTIATE_TEST_SUITE_P(Every, ContractState, testing::ValuesIn(task_names()),
                         [](const auto& info) { return info.param; });

}  // namespace
