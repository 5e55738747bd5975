// Functions of a host's task that take many worlds at once: the same bytes as one world at a time, in every mode of a
// pool; which world fails; that rdm_task_check sees a row that depends on others.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <string>
#include <thread>

#include "own_task.hpp"
#include "task_pool.hpp"

namespace rdm::test {
namespace {

unsigned char* state_of(const rdm_task_rows* rows, int32_t i) {
  return static_cast<unsigned char*>(rows->states) + static_cast<size_t>(i) * sizeof(BallState);
}

rdm_result reset_many(void* user, const void* instance, const rdm_task_rows* rows) {
  for (int32_t i = 0; i < rows->count; ++i)
    rows->results[i] = ball_reset(user, instance, rows->worlds[i], state_of(rows, i), rows->randoms + i);
  return RDM_OK;
}
rdm_result control_many(void* user, const void* instance, const rdm_task_rows* rows) {
  for (int32_t i = 0; i < rows->count; ++i)
    rows->results[i] =
        ball_control(user, instance, rows->worlds[i], state_of(rows, i), rows->actions + i * kBallActions);
  return RDM_OK;
}
rdm_result judge_many(void* user, const void* instance, const rdm_task_rows* rows) {
  for (int32_t i = 0; i < rows->count; ++i)
    rows->results[i] =
        ball_judge(user, instance, rows->worlds[i], state_of(rows, i), rows->steps[i], rows->verdicts + i);
  return RDM_OK;
}
rdm_result observe_many(void* user, const void* instance, const rdm_task_rows* rows) {
  for (int32_t i = 0; i < rows->count; ++i)
    rows->results[i] =
        ball_observe(user, instance, rows->worlds[i], state_of(rows, i), rows->obs + i * kBallObs);
  return RDM_OK;
}

// Functions of many, bits: 1 reset, 2 control, 4 judge, 8 observe; the others take one world.
struct ManyBall : BallTask {
  explicit ManyBall(const char* name, int32_t many = 15, Fault fault = Fault::kNone) : BallTask(name, fault) {
    if (many & 1) def.reset_many = reset_many, def.reset = nullptr;
    if (many & 2) def.control_many = control_many, def.control = nullptr;
    if (many & 4) def.judge_many = judge_many, def.judge = nullptr;
    if (many & 8) def.observe_many = observe_many, def.observe = nullptr;
  }
};

struct Mode {
  rdm_autoreset autoreset;
  int32_t threads;
  const char* settings;
};

class Twin {
 public:
  Twin(const char* task, int32_t envs, const Mode& mode) {
    rdm_pool_config_init(&config_, sizeof config_);
    config_.task = task, config_.num_envs = envs, config_.num_threads = mode.threads;
    config_.autoreset = mode.autoreset, config_.settings = mode.settings, config_.seed = 5;
    EXPECT_EQ(rdm_pool_create(&pool, &config_), RDM_OK) << rdm_last_error();
    b.struct_size = sizeof b;
    EXPECT_EQ(rdm_pool_get_buffers(pool, &b), RDM_OK);
    EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK) << rdm_last_error();
  }
  ~Twin() { rdm_pool_destroy(pool); }
  Twin(const Twin&) = delete;
  Twin& operator=(const Twin&) = delete;
  // All that a host sees of a step, and the worlds.
  uint64_t hash() const {
    uint64_t h = 0;
    EXPECT_EQ(rdm_pool_get_hash(pool, -1, &h), RDM_OK);
    const auto add = [&](const void* p, size_t bytes) {
      for (size_t i = 0; i < bytes; ++i) h = (h ^ static_cast<const unsigned char*>(p)[i]) * 0x100000001b3;
    };
    const auto n = static_cast<size_t>(config_.num_envs);
    add(b.obs, n * kBallObs * sizeof(float));
    add(b.final_obs, n * kBallObs * sizeof(float));
    add(b.reward, n * sizeof(float));
    add(b.cost, n * kBallCosts * sizeof(float));
    add(b.cost_raw, n * kBallCosts * sizeof(float));
    add(b.episode_cost, n * kBallCosts * sizeof(float));
    add(b.terminated, n);
    add(b.truncated, n);
    add(b.success, n);
    add(b.status, n * sizeof(uint32_t));
    add(b.episode_status, n * sizeof(uint32_t));
    add(b.episode_step, n * sizeof(int32_t));
    return h;
  }
  rdm_pool* pool = nullptr;
  rdm_buffers b{};

 private:
  rdm_pool_config config_;
};

void need_twins(const char* one, const char* many, const Mode& mode, int32_t envs, const std::string& what) {
  Twin a(one, envs, mode), c(many, envs, mode);
  ASSERT_EQ(a.hash(), c.hash()) << what;
  for (int step = 0; step < 130; ++step) {
    std::vector<uint8_t> mask(static_cast<size_t>(envs), 1), ended(mask);
    const bool masked = step % 7 == 3;
    for (size_t i = 0; i < mask.size(); ++i) mask[i] = !masked || i % 3 != 0, ended[i] = 0;
    if (mode.autoreset == RDM_AUTORESET_OFF) {
      bool any = false;
      for (size_t i = 0; i < ended.size(); ++i)
        ended[i] = a.b.terminated[i] || a.b.truncated[i], any |= ended[i] != 0;
      for (const Twin* t : {&a, &c}) {
        ASSERT_EQ(any ? rdm_pool_reset(t->pool, nullptr, ended.data()) : RDM_OK, RDM_OK);
      }
    }
    for (Twin* t : {&a, &c}) {
      ASSERT_EQ(rdm_pool_baseline(t->pool, RDM_BASELINE_RANDOM), RDM_OK);
      if (step == 50) t->b.action[0] = NAN;
      ASSERT_EQ(masked ? rdm_pool_step_masked(t->pool, mask.data()) : rdm_pool_step(t->pool), RDM_OK);
    }
    ASSERT_EQ(a.hash(), c.hash()) << what << ", step " << step;
  }
}

TEST(OwnTaskRows, SameBytesAsOneWorldAtATime) {
  const BallTask one("rows_one");
  const Registered first(one.def);
  const Mode modes[] = {{RDM_AUTORESET_SAME_STEP, 0, "max_steps=23\n"},
                        {RDM_AUTORESET_NEXT_STEP, 3, "max_steps=23\naction_repeat=3\n"},
                        {RDM_AUTORESET_OFF, 2, "action_delay=2\nnoise.ball.position=0.01\n"},
                        {RDM_AUTORESET_SAME_STEP, 2, "end_on_cost=true\n"}};
  for (const int32_t many : {15, 1, 2, 4, 8, 7}) {
    const ManyBall task("rows_many", many);
    const Registered second(task.def);
    for (const Mode& mode : modes)
      need_twins("rows_one", "rows_many", mode, 7, std::string(mode.settings) + std::to_string(many));
  }
}

TEST(OwnTaskRows, MoreWorldsThanOneCallTakes) {
  const BallTask one("rows_one");
  const Registered first(one.def);
  const ManyBall many("rows_many");
  const Registered second(many.def);
  need_twins("rows_one", "rows_many", {RDM_AUTORESET_SAME_STEP, 2, "max_steps=9\n"}, 300, "300 worlds");
}

// The functions of many run on the thread that called the pool, for all of its worlds.
TEST(OwnTaskRows, OneCallAStepOnTheCallersThread) {
  static std::vector<int32_t> counts;
  static std::vector<std::thread::id> threads;
  counts.clear(), threads.clear();
  ManyBall many("rows_many");
  many.def.control_many = [](void* user, const void* instance, const rdm_task_rows* rows) {
    counts.push_back(rows->count);
    threads.push_back(std::this_thread::get_id());
    return control_many(user, instance, rows);
  };
  const Registered made(many.def);
  Twin t("rows_many", 40, {RDM_AUTORESET_SAME_STEP, 4, nullptr});
  for (int i = 0; i < 3; ++i) ASSERT_EQ(rdm_pool_step(t.pool), RDM_OK);
  EXPECT_EQ(counts, (std::vector<int32_t>{40, 40, 40}));
  for (const std::thread::id id : threads) EXPECT_EQ(id, std::this_thread::get_id());
}

TEST(OwnTaskRows, ARowThatFailsIsItsWorldsAlone) {
  ManyBall many("rows_fail");
  many.def.judge_many = [](void* user, const void* instance, const rdm_task_rows* rows) {
    judge_many(user, instance, rows);
    for (int32_t i = 0; i < rows->count; ++i) {
      if (rdm_world_number(rows->worlds[i]) == 2) rows->results[i] = RDM_ERROR_IO;
      if (rdm_world_number(rows->worlds[i]) == 4) rows->verdicts[i].cost[1] = -1;
    }
    return rdm_result{RDM_OK};
  };
  const Registered made(many.def);
  Twin t("rows_fail", 6, {RDM_AUTORESET_OFF, 0, nullptr});
  ASSERT_EQ(rdm_pool_step(t.pool), RDM_OK);
  for (size_t i = 0; i < 6; ++i) {
    const bool failed = i == 2 || i == 4;
    EXPECT_EQ((t.b.status[i] & RDM_STATUS_TASK) != 0, failed) << i;
    EXPECT_EQ(t.b.truncated[i] != 0, failed) << i;
  }
  const auto text = [&](int32_t env) { return std::string(rdm_pool_world_error(t.pool, env)); };
  EXPECT_EQ(text(2), std::string("world 2: task rows_fail: judge: ") + rdm_result_string(RDM_ERROR_IO));
  EXPECT_EQ(text(4), "world 4: task rows_fail: judge: cost speed is -1, but it must be 0 or more");
  EXPECT_EQ(text(3), "");
}

TEST(OwnTaskRows, WhatTheFunctionReturnsIsOfAllRows) {
  ManyBall many("rows_fail");
  many.def.control_many = [](void*, const void*, const rdm_task_rows*) {
    return rdm_fail(RDM_ERROR_STATE, "the interpreter is gone");
  };
  const Registered made(many.def);
  Twin t("rows_fail", 3, {RDM_AUTORESET_SAME_STEP, 0, nullptr});
  ASSERT_EQ(rdm_pool_step(t.pool), RDM_OK);
  for (size_t i = 0; i < 3; ++i) EXPECT_EQ(t.b.status[i], RDM_STATUS_TASK);
  ManyBall never("rows_never");
  never.def.reset_many = [](void*, const void*, const rdm_task_rows*) {
    return rdm_fail(RDM_ERROR_STATE, "no start");
  };
  const Registered other(never.def);
  rdm_pool_config c;
  rdm_pool_config_init(&c, sizeof c);
  c.task = "rows_never", c.num_envs = 2;
  rdm_pool* pool = nullptr;
  ASSERT_EQ(rdm_pool_create(&pool, &c), RDM_OK);
  EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_ERROR_STATE);
  EXPECT_STREQ(rdm_last_error(), "world 0: task rows_never: reset: no start");
  rdm_pool_destroy(pool);
}

TEST(OwnTaskRows, HandlesEndWithTheCall) {
  static rdm_world* kept = nullptr;
  ManyBall many("rows_kept");
  many.def.control_many = [](void* user, const void* instance, const rdm_task_rows* rows) {
    kept = rows->worlds[0];
    return control_many(user, instance, rows);
  };
  const Registered made(many.def);
  Twin t("rows_kept", 2, {RDM_AUTORESET_SAME_STEP, 0, nullptr});
  ASSERT_EQ(rdm_pool_step(t.pool), RDM_OK);
  rdm_motion m;
  EXPECT_EQ(rdm_world_get_body(kept, 0, &m), RDM_ERROR_ARGUMENT);
}

TEST(OwnTaskRows, CheckPassesAndSeesARowThatDependsOnOthers) {
  const ManyBall good("rows_good");
  const Registered first(good.def);
  char text[512];
  EXPECT_EQ(rdm_task_check("rows_good", nullptr, nullptr, nullptr, text, sizeof text), RDM_OK) << text;
  ManyBall bad("rows_bad");
  bad.def.judge_many = [](void* user, const void* instance, const rdm_task_rows* rows) {
    judge_many(user, instance, rows);
    for (int32_t i = 0; i < rows->count; ++i) rows->verdicts[i].reward += rows->count;
    return rdm_result{RDM_OK};
  };
  const Registered second(bad.def);
  EXPECT_EQ(rdm_task_check("rows_bad", nullptr, nullptr, nullptr, text, sizeof text), RDM_ERROR_ARGUMENT);
  EXPECT_NE(std::string(text).find("computed together with other worlds"), std::string::npos) << text;
}

TEST(OwnTaskRows, GettersAndSettersOfMany) {
  static double seen[2][13], links[2][13], q[2], touch[2][2];
  static rdm_result results[6];
  ManyBall many("rows_many");
  many.def.control_many = [](void* user, const void* instance, const rdm_task_rows* rows) {
    const auto* ids = static_cast<const BallIds*>(instance);
    const auto n = static_cast<size_t>(rows->count);
    double motions[2 * 13] = {};
    for (size_t i = 0; i < n; ++i)
      motions[13 * i] = 0.5 + static_cast<double>(i), motions[13 * i + 2] = 0.3, motions[13 * i + 6] = 1;
    results[0] = rdm_world_set_many(rows->worlds, n, RDM_QUANTITY_BODY, ids->ball, 1, motions);
    results[1] = rdm_world_get_many(rows->worlds, n, RDM_QUANTITY_BODY, ids->ball, 1, &seen[0][0]);
    const double place[4] = {0.1, 0, 0.2, 0};
    results[2] = rdm_world_set_many(rows->worlds, n, RDM_QUANTITY_JOINT, ids->paddle, 1, place);
    results[3] = rdm_world_get_many(rows->worlds, n, RDM_QUANTITY_Q, ids->rail, 1, q);
    results[4] = rdm_world_get_many(rows->worlds, n, RDM_QUANTITY_LINK, ids->rail, 1, &links[0][0]);
    results[5] = rdm_world_get_many(rows->worlds, n, RDM_QUANTITY_TOUCH, ids->touch, 1, &touch[0][0]);
    EXPECT_EQ(rdm_world_get_many(rows->worlds, n, RDM_QUANTITY_COMMAND, 0, 1, q), RDM_ERROR_RANGE);
    EXPECT_EQ(rdm_world_set_many(rows->worlds, n, RDM_QUANTITY_LINK, 0, 1, q), RDM_ERROR_RANGE);
    EXPECT_EQ(rdm_world_set_many(rows->worlds, n, 99, 0, 1, q), RDM_ERROR_RANGE);
    EXPECT_EQ(rdm_world_get_many(rows->worlds, n, RDM_QUANTITY_BODY, 7, 1, motions), RDM_ERROR_RANGE);
    EXPECT_EQ(rdm_world_get_many(rows->worlds, n, RDM_QUANTITY_Q, 0, 2, motions), RDM_ERROR_RANGE);
    EXPECT_EQ(rdm_world_get_many(nullptr, n, RDM_QUANTITY_Q, 0, 1, motions), RDM_ERROR_ARGUMENT);
    EXPECT_EQ(rdm_world_get_many(rows->worlds, n, RDM_QUANTITY_Q, 0, 1, nullptr), RDM_ERROR_ARGUMENT);
    (void)user;
    return rdm_result{RDM_OK};
  };
  const Registered made(many.def);
  Twin t("rows_many", 2, {RDM_AUTORESET_SAME_STEP, 0, nullptr});
  ASSERT_EQ(rdm_pool_step(t.pool), RDM_OK);
  for (const rdm_result r : results) EXPECT_EQ(r, RDM_OK);
  for (size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(seen[i][0], 0.5 + static_cast<double>(i));
    EXPECT_EQ(seen[i][2], 0.3);
    EXPECT_EQ(seen[i][6], 1);
    EXPECT_EQ(q[i], static_cast<double>(i == 0 ? 0.1f : 0.2f));  // an engine keeps coordinates as floats
    EXPECT_NEAR(links[i][0], q[i], 1e-12);
    EXPECT_EQ(touch[i][0], 0);
  }
}

}  // namespace
}  // namespace rdm::test
