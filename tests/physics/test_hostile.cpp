// Pools under hard treatment, through the C ABI, by both engines: every number stays finite, every value is
// bounded or its step is flagged, and a world that was flagged goes on as a new one would.
#include <gtest/gtest.h>

#include "hostile.hpp"
#include "written.hpp"

namespace {

using hostile::Case;
using hostile::Trial;

constexpr const char* kEngines[] = {"articulated", "ode"};
constexpr const char* kTasks[] = {"hand_over_safe_finger", "hand_over_safe_joint"};

class Hostile : public testing::TestWithParam<const char*> {};

std::vector<unsigned char> state_of(const rdm_pool* p, int32_t env) {
  return written_bytes(
      [&](void* out, size_t n, size_t* size) { return rdm_pool_write_state(p, env, out, n, size); });
}

rdm_pool* make_pool(const char* engine, int32_t envs) {
  const rdm_option options[] = {{"engine", engine, 0}};
  rdm_pool_config c;
  rdm_pool_config_init(&c, sizeof c);
  c.task = "hand_over_safe_finger";
  c.num_envs = envs;
  c.seed = 5;
  c.options = options;
  c.num_options = 1;
  rdm_pool* p = nullptr;
  EXPECT_EQ(rdm_pool_create(&p, &c), RDM_OK) << rdm_last_error();
  EXPECT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  return p;
}

int32_t shape_named(const rdm_pool* p, const std::string& name) {
  rdm_shape_info s = RDM_INIT(rdm_shape_info);
  for (int32_t i = 0; rdm_pool_shape_at(p, i, &s) == RDM_OK; ++i)
    if (name == s.name) return i;
  ADD_FAILURE() << "no shape " << name;
  return 0;
}

TEST_P(Hostile, EveryCaseStaysFiniteAndBoundedOrIsFlagged) {
  int k = 0;
  for (const Case& c : hostile::cases()) {
    const char* task = kTasks[k++ % 2];
    SCOPED_TRACE(std::string(c.name) + ", " + task);
    Trial trial(task, GetParam(), c, 16, 3);
    ASSERT_NE(trial.pool(), nullptr) << rdm_last_error();
    for (int i = 0; i < 160; ++i) trial.step();
    trial.finish();
    const hostile::Figures& f = trial.figures();
    EXPECT_EQ(trial.result(), RDM_OK) << rdm_pool_error(trial.pool());
    EXPECT_GT(f.episodes, 16);
    EXPECT_GT(f.contacts_max, 0);
    EXPECT_EQ(f.not_finite, 0);
    EXPECT_EQ(f.unflagged, 0) << "speed " << f.object_speed << " m/s, joints " << f.joint_excess
                              << " rad outside, rotation " << f.rotation_error;
    EXPECT_EQ(f.other, 0);
    EXPECT_LE(f.stuck, 1);
    // a state is refused when a number in it is not finite
    const auto bytes = state_of(trial.pool(), -1);
    EXPECT_EQ(rdm_pool_read_state(trial.pool(), -1, bytes.data(), bytes.size()), RDM_OK)
        << rdm_pool_error(trial.pool());
  }
}

// One world of eight is pushed with all that a float can say: its step is flagged, its neighbours do not
// notice, and after its reset it is what a new world is.
TEST_P(Hostile, ALostWorldIsFlaggedAloneAndIsUsableAfterwards) {
  constexpr int32_t kWorlds = 8, kPushed = 3;
  for (const char* name : {"object", "right_palm", "left_ff_distal"})
    for (const float newtons : {1e12f, 1e25f, 3e38f}) {
      SCOPED_TRACE(std::string(name) + ", " + std::to_string(newtons) + " N");
      rdm_pool *pool = make_pool(GetParam(), kWorlds), *twin = make_pool(GetParam(), kWorlds);
      rdm_buffers b{}, t{};
      b.struct_size = t.struct_size = sizeof b;
      ASSERT_EQ(rdm_pool_get_buffers(pool, &b), RDM_OK);
      ASSERT_EQ(rdm_pool_get_buffers(twin, &t), RDM_OK);
      const auto step_both = [&](int steps) {
        for (int i = 0; i < steps; ++i) {
          for (rdm_pool* p : {pool, twin}) {
            ASSERT_EQ(rdm_pool_baseline(p, RDM_BASELINE_RANDOM), RDM_OK);
            ASSERT_EQ(rdm_pool_step(p), RDM_OK);
          }
        }
      };
      step_both(10);
      const float force[3] = {0, newtons, newtons};
      ASSERT_EQ(rdm_pool_push(pool, kPushed, shape_named(pool, name), force), RDM_OK);
      step_both(1);
      for (int32_t env = 0; env < kWorlds; ++env) {
        EXPECT_EQ((b.status[env] & RDM_STATUS_DIVERGED) != 0, env == kPushed) << env;
        if (env == kPushed) continue;
        EXPECT_EQ(state_of(pool, env), state_of(twin, env)) << env;
      }
      EXPECT_EQ(b.truncated[kPushed], 1);
      EXPECT_EQ(b.reward[kPushed], 0);
      const std::vector<uint64_t> seeds(kWorlds, 11);
      const uint8_t mask[kWorlds] = {0, 0, 0, 1};
      for (rdm_pool* p : {pool, twin}) ASSERT_EQ(rdm_pool_reset(p, seeds.data(), mask), RDM_OK);
      step_both(20);
      EXPECT_EQ(b.status[kPushed], 0u);
      for (int32_t env = 0; env < kWorlds; ++env) EXPECT_EQ(state_of(pool, env), state_of(twin, env)) << env;
      rdm_pool_destroy(pool);
      rdm_pool_destroy(twin);
    }
}

// Forces between the ordinary and the absurd: whichever side of the engine's bound a step ends on.
TEST_P(Hostile, PushesOfAnySizeLeaveFiniteNumbers) {
  for (double newtons = 1e3; newtons < 1e38; newtons *= 100) {
    SCOPED_TRACE(newtons);
    Trial trial(kTasks[0], GetParam(), {"any", hostile::Actions::kRandom, newtons, {}}, 8, 9);
    ASSERT_NE(trial.pool(), nullptr) << rdm_last_error();
    for (int i = 0; i < 24; ++i) trial.step();
    trial.finish();
    EXPECT_EQ(trial.result(), RDM_OK) << rdm_pool_error(trial.pool());
    EXPECT_EQ(trial.figures().not_finite, 0);
    EXPECT_EQ(trial.figures().unflagged, 0);
    EXPECT_TRUE(newtons < 1e9 || trial.figures().diverged > 0);
  }
}

TEST_P(Hostile, EveryShapeTakesAPushOrRefusesIt) {
  rdm_pool* pool = make_pool(GetParam(), 1);
  const float force[3] = {0, 0, 1000};
  const int32_t base = shape_named(pool, "right_forearm"), ground = shape_named(pool, "ground");
  rdm_shape_info s = RDM_INIT(rdm_shape_info);
  for (int32_t i = 0; rdm_pool_shape_at(pool, i, &s) == RDM_OK; ++i) {
    const bool rests = i == base || i == ground || i == shape_named(pool, "left_forearm");
    EXPECT_EQ(rdm_pool_push(pool, 0, i, force), rests ? RDM_ERROR_ARGUMENT : RDM_OK) << s.name;
  }
  ASSERT_EQ(rdm_pool_step(pool), RDM_OK);
  rdm_pool_destroy(pool);
}

INSTANTIATE_TEST_SUITE_P(Engines, Hostile, testing::ValuesIn(kEngines),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
