// A task of a host's own is a task: pools, threads, states, sensors, learners and discovery hold for it, and
// it stays while a pool has it.
#include <gtest/gtest.h>
#include <redman/redman.h>

#include <algorithm>
#include <thread>

#include "env/pool.hpp"
#include "own_task.hpp"

namespace rdm::test {
namespace {

struct Rows {
  rdm_pool* pool = nullptr;
  rdm_buffers b{};
  rdm_spec spec{};

  Rows(const char* task, int32_t envs, int32_t threads = 0, const char* settings = nullptr) {
    rdm_pool_config c;
    EXPECT_EQ(rdm_pool_config_init(&c, sizeof c), RDM_OK);
    c.task = task;
    c.num_envs = envs;
    c.num_threads = threads;
    c.settings = settings;
    c.seed = 3;
    EXPECT_EQ(rdm_pool_create(&pool, &c), RDM_OK) << rdm_last_error();
    b.struct_size = sizeof b;
    spec.struct_size = sizeof spec;
    if (!pool) return;
    EXPECT_EQ(rdm_pool_get_buffers(pool, &b), RDM_OK);
    EXPECT_EQ(rdm_pool_get_spec(pool, &spec), RDM_OK);
    EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK) << rdm_last_error();
  }
  ~Rows() { rdm_pool_destroy(pool); }
  Rows(const Rows&) = delete;
  Rows& operator=(const Rows&) = delete;
  void step(int count = 1) {
    for (int i = 0; i < count; ++i) {
      ASSERT_EQ(rdm_pool_baseline(pool, RDM_BASELINE_RANDOM), RDM_OK);
      ASSERT_EQ(rdm_pool_step(pool), RDM_OK) << rdm_last_error();
    }
  }
  uint64_t hash() const {
    uint64_t h = 0;
    EXPECT_EQ(rdm_pool_get_hash(pool, -1, &h), RDM_OK);
    return h;
  }
};

TEST(OwnTask, IsFoundAndDescribed) {
  BallTask t("own_ball");
  const int32_t count = rdm_task_count();
  const Registered made(t.def);
  EXPECT_GE(made.index(), count);
  EXPECT_EQ(rdm_task_count(), made.index() + 1);
  int32_t found = -1;
  ASSERT_EQ(rdm_task_find("Own-Ball", &found), RDM_OK);
  EXPECT_EQ(found, made.index());
  rdm_task task{};
  task.struct_size = sizeof task;
  ASSERT_EQ(rdm_task_at(found, &task), RDM_OK) << rdm_last_error();
  EXPECT_STREQ(task.name, "own_ball");
  EXPECT_EQ(task.obs_dim, kBallObs);
  EXPECT_EQ(task.action_dim, kBallActions);
  EXPECT_EQ(task.cost_dim, kBallCosts);
  EXPECT_EQ(task.max_steps, 40);
  EXPECT_EQ(task.control_dt, 0.02f);  // its own default of an option that every task has
  rdm_field_info field = RDM_INIT(rdm_field_info);
  ASSERT_EQ(rdm_task_field_at(found, 3, &field), RDM_OK);
  EXPECT_STREQ(field.name, "action");
  EXPECT_EQ(field.offset, 7);
  ASSERT_EQ(rdm_task_field_at(found, 2, &field), RDM_OK);
  EXPECT_EQ(field.low, -0.4f);
  ASSERT_EQ(rdm_task_field_at(found, 0, &field), RDM_OK);
  EXPECT_EQ(field.high, 5);
  rdm_cost_info cost = RDM_INIT(rdm_cost_info);
  ASSERT_EQ(rdm_task_cost_at(found, 0, &cost), RDM_OK);
  EXPECT_STREQ(cost.name, "touch");
  EXPECT_EQ(cost.limit, 5);
  rdm_option_spec option = RDM_INIT(rdm_option_spec);
  ASSERT_EQ(rdm_task_option_at(found, 1, &option), RDM_OK);
  EXPECT_STREQ(option.choices, "calm|wild");
  ASSERT_EQ(rdm_task_option_at(found, 2, &option), RDM_OK);
  EXPECT_STREQ(option.key, "max_steps");
  EXPECT_EQ(option.number, 40);
  rdm_camera_info camera = RDM_INIT(rdm_camera_info);
  ASSERT_EQ(rdm_task_camera_at(found, 0, &camera), RDM_OK);
  EXPECT_EQ(camera.eye[1], -1);
  rdm_option given;
  ASSERT_EQ(rdm_task_default_at(found, 1, &given), RDM_OK);
  EXPECT_STREQ(given.text, "64");
}

TEST(OwnTask, LearnersAndPlannersKeepTheLimitOfEachCost) {
  for (const double limit : {-1.0, 1e-3}) {
    BallTask t("own_limits");
    t.costs = {{"touch", "the paddle touches the ball", 1000}, {"speed", "of the ball", limit}};
    t.bind();
    const Registered made(t.def);
    Rows rows("own_limits", 2);
    rdm_agent_config c;
    ASSERT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
    ASSERT_EQ(rdm_agent_config_for_pool(&c, rows.pool), RDM_OK) << rdm_last_error();
    ASSERT_EQ(c.cost_dim, kBallCosts);
    EXPECT_EQ(c.cost_limits[0], 1000);
    EXPECT_EQ(c.cost_limits[1], limit);
    c.algo = "ppo_lag";
    rdm_agent* agent = nullptr;
    ASSERT_EQ(rdm_agent_create(&agent, &c), RDM_OK) << rdm_last_error();
    rdm_epoch e = RDM_INIT(rdm_epoch);
    ASSERT_EQ(rdm_agent_rollout(agent, rows.pool, &e), RDM_OK) << rdm_last_error();
    EXPECT_GT(e.cost[1], 1e-3);
    EXPECT_EQ(e.multiplier[1] > 0, limit > 0);
    rdm_agent_destroy(agent);
    rdm_planner_config p;
    ASSERT_EQ(rdm_planner_config_init(&p, sizeof p), RDM_OK);
    p.pool = rows.pool;
    p.settings = "samples=4\nhorizon=8\nknots=1";
    rdm_planner* planner = nullptr;
    ASSERT_EQ(rdm_planner_create(&planner, &p), RDM_OK) << rdm_last_error();
    float action[kBallActions];
    rdm_plan_info info = RDM_INIT(rdm_plan_info);
    ASSERT_EQ(rdm_planner_act(planner, rows.pool, 0, action, &info), RDM_OK) << rdm_last_error();
    EXPECT_EQ(info.feasible_share, limit > 0 ? 0 : 1);
    rdm_planner_destroy(planner);
  }
}

TEST(OwnTask, TheDescriptionIsCopied) {
  auto t = std::make_unique<BallTask>("own_copied");
  BallUser user;
  t->def.user = &user;
  const Registered made(t->def);
  std::memset(static_cast<void*>(&t->def), 0xff, sizeof t->def);
  t.reset();
  Rows rows("own_copied", 2);
  rows.step(5);
}

TEST(OwnTask, StaysWhileAPoolHasIt) {
  BallTask t("own_kept");
  int32_t task = -1, found = -1;
  ASSERT_EQ(rdm_task_create(&task, &t.def), RDM_OK) << rdm_last_error();
  EXPECT_EQ(rdm_task_create(&found, &t.def), RDM_ERROR_ARGUMENT);
  EXPECT_STREQ(rdm_last_error(), "task own_kept: the name is already used");
  {
    Rows rows("own_kept", 2);
    rows.step(3);
    ASSERT_EQ(rdm_task_destroy(task), RDM_OK) << rdm_last_error();
    EXPECT_EQ(rdm_task_destroy(task), RDM_ERROR_NOT_FOUND);
    EXPECT_EQ(rdm_task_find("own_kept", &found), RDM_ERROR_NOT_FOUND);
    rdm_task io{};
    io.struct_size = sizeof io;
    EXPECT_EQ(rdm_task_at(task, &io), RDM_ERROR_NOT_FOUND);
    EXPECT_EQ(t.user.released, 0);
    rows.step(60);  // into the next episode
    rdm_pool_config c;
    rdm_pool_config_init(&c, sizeof c);
    c.task = "own_kept";
    rdm_pool* none = nullptr;
    EXPECT_EQ(rdm_pool_create(&none, &c), RDM_ERROR_NOT_FOUND);
    BallTask again("own_kept");  // another one may have the name
    const Registered other(again.def);
    EXPECT_GT(other.index(), task);
    Rows both("own_kept", 1);
    both.step();
    rows.step();
  }
  EXPECT_EQ(t.user.released, 1);
  EXPECT_EQ(rdm_task_destroy(0), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(rdm_task_destroy(-1), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_task_destroy(INT32_MAX), RDM_ERROR_RANGE);
}

TEST(OwnTask, SameBytesForAnyThreadsAndGroups) {
  BallTask t("own_threads");
  const Registered made(t.def);
  uint64_t first = 0;
  for (const int32_t threads : {1, 2, 4}) {
    Rows rows("own_threads", 12, threads);
    rows.step(100);
    if (threads == 1) first = rows.hash();
    EXPECT_EQ(rows.hash(), first) << threads;
    std::printf("threads %d: hash %016llx\n", threads, static_cast<unsigned long long>(rows.hash()));
  }
  for (const int32_t group : {1, 3, 8}) {
    PoolConfig c;
    c.task = "own_threads";
    c.num_envs = 12;
    c.seed = 3;
    c.group_size = group;
    rdm::Pool* p = rdm::Pool::create(c);
    p->reset(nullptr, nullptr);
    for (int i = 0; i < 100; ++i) {
      p->baseline(Baseline::kRandom);
      p->step(nullptr);
    }
    EXPECT_EQ(p->hash(-1), first) << group;
    std::printf("group %d: hash %016llx\n", group, static_cast<unsigned long long>(p->hash(-1)));
    rdm::Pool::destroy(p);
  }
}

TEST(OwnTask, GoesOnFromAState) {
  BallTask t("own_state");
  const Registered made(t.def);
  Rows a("own_state", 3), b("own_state", 3);
  a.step(17);
  size_t size = 0;
  ASSERT_EQ(rdm_pool_write_state(a.pool, -1, nullptr, 0, &size), RDM_OK);
  std::vector<unsigned char> bytes(size);
  ASSERT_EQ(rdm_pool_write_state(a.pool, -1, bytes.data(), size, &size), RDM_OK);
  ASSERT_EQ(rdm_pool_read_state(b.pool, -1, bytes.data(), size), RDM_OK) << rdm_last_error();
  for (int i = 0; i < 50; ++i) {
    a.step();
    b.step();
    ASSERT_EQ(a.hash(), b.hash()) << i;
  }
  // a state that check_state refuses, with a checksum that is right, changes nothing
  t.user.fault = Fault::kStateOutside;
  Rows bad("own_state", 3);
  bad.step(6);
  ASSERT_EQ(rdm_pool_write_state(bad.pool, -1, bytes.data(), size, &size), RDM_OK);
  const uint64_t before = a.hash();
  EXPECT_EQ(rdm_pool_read_state(a.pool, -1, bytes.data(), size), RDM_ERROR_FORMAT);
  EXPECT_STREQ(rdm_last_error(), "task own_state: check_state: start is not within +-1");
  EXPECT_EQ(a.hash(), before);
  // of a task of that name whose state has another size
  t.user.fault = Fault::kNone;
  ASSERT_EQ(rdm_pool_write_state(a.pool, -1, bytes.data(), size, &size), RDM_OK);
  ASSERT_EQ(rdm_task_destroy(made.index()), RDM_OK);
  BallTask larger("own_state");
  larger.def.state_bytes += 8;
  const Registered other(larger.def);
  Rows c("own_state", 3);
  EXPECT_EQ(rdm_pool_read_state(c.pool, -1, bytes.data(), size), RDM_ERROR_FORMAT);
}

TEST(OwnTask, ARowThatIsNotFiniteEndsTheEpisode) {
  for (const Fault fault : {Fault::kRowNan, Fault::kJudgeNan}) {
    BallTask t("own_nan", fault);
    const Registered made(t.def);
    Rows rows("own_nan", 1);
    const int at = fault == Fault::kRowNan ? 2 : 3;
    for (int i = 1; i <= at; ++i) {
      rows.step();
      EXPECT_EQ((rows.b.status[0] & RDM_STATUS_DIVERGED) != 0, i == at);
    }
    EXPECT_EQ(rows.b.truncated[0], 1);
    for (int i = 0; i < kBallObs; ++i) EXPECT_TRUE(std::isfinite(rows.b.obs[i]));
  }
}

TEST(OwnTask, IsSeenAndLearned) {
  BallTask t("own_seen");
  const Registered made(t.def);
  Rows rows("own_seen", 8, 2, "modality=rgb+points+voxels\ncloud_cameras=front\npoints=64\npush=1");
  rdm_sensors s{};
  s.struct_size = sizeof s;
  ASSERT_EQ(rdm_pool_get_sensors(rows.pool, &s), RDM_OK);
  EXPECT_GT(s.point_count[0], 10);
  std::vector<uint8_t> rgb(3 * 32 * 32);
  EXPECT_EQ(rdm_pool_render(rows.pool, 0, "front", 32, 32, rgb.data(), nullptr, nullptr), RDM_OK);
  rdm_agent_config c;
  ASSERT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  ASSERT_EQ(rdm_agent_config_for_pool(&c, rows.pool), RDM_OK);
  EXPECT_EQ(c.cost_limits[0], 5);
  rdm_agent* agent = nullptr;
  ASSERT_EQ(rdm_agent_create(&agent, &c), RDM_OK) << rdm_last_error();
  rdm_epoch e{};
  e.struct_size = sizeof e;
  for (int i = 0; i < 3; ++i) ASSERT_EQ(rdm_agent_rollout(agent, rows.pool, &e), RDM_OK) << rdm_last_error();
  EXPECT_EQ(e.env_steps, 3 * 8 * 64);
  rdm_agent_destroy(agent);
}

TEST(OwnTask, CountsFollowFromOptions) {
  BallTask t("own_counts");
  t.options.push_back({"entries", "of the action's field", nullptr, nullptr, 2, 1, 5, RDM_KIND_INTEGER, 0});
  t.bind();
  t.def.build = [](void* user, rdm_scene* scene, void* instance) {
    double n = 0;
    rdm_result r = rdm_scene_get_number(scene, "entries", &n);
    const float mean[5] = {0.5f, 0.5f, 0.5f, 0.5f, 0.5f};
    if (r == RDM_OK) r = rdm_scene_set_field(scene, "action", static_cast<size_t>(n));
    if (r == RDM_OK) r = rdm_scene_set_actions(scene, static_cast<size_t>(n), nullptr, mean);
    return r != RDM_OK ? r : ball_build(user, scene, instance);
  };
  const Registered made(t.def);
  Rows two("own_counts", 1), same("own_counts", 1, 0, "push=0.1");
  rdm_pool_config c;
  rdm_pool_config_init(&c, sizeof c);
  c.task = "own_counts";
  c.settings = "entries=5";
  rdm_spec spec{};
  spec.struct_size = sizeof spec;
  ASSERT_EQ(rdm_pool_config_spec(&c, &spec), RDM_OK) << rdm_last_error();
  EXPECT_EQ(spec.obs_dim, kBallObs + 3);
  EXPECT_EQ(spec.action_dim, 5);
  EXPECT_NE(spec.layout_hash, two.spec.layout_hash);
  EXPECT_EQ(same.spec.layout_hash, two.spec.layout_hash);
  float mean[2] = {};
  ASSERT_EQ(rdm_pool_get_initial_mean(two.pool, mean), RDM_OK);
  EXPECT_EQ(mean[1], 0.5f);
}

TEST(OwnTask, AnInstanceIsZeroedToTheLastByte) {
  BallTask t("own_zeroed");
  t.def.instance_bytes = 8192;
  t.def.build = [](void* user, rdm_scene* scene, void* instance) {
    const auto* bytes = static_cast<const unsigned char*>(instance);
    if (std::any_of(bytes, bytes + 8192, [](unsigned char b) { return b != 0; }))
      return rdm_fail(RDM_ERROR_INTERNAL, "not zeroed");
    const rdm_result r = ball_build(user, scene, instance);
    std::memset(static_cast<unsigned char*>(instance) + sizeof(BallIds), 0xa5, 8192 - sizeof(BallIds));
    return r;  // what is freed now is what the next one is made of
  };
  const Registered made(t.def);
  for (int i = 0; i < 4; ++i) Rows rows("own_zeroed", 1);
}

TEST(OwnTask, OptionsMayBeRanges) {
  BallTask t("own_ranges");
  t.options[0].choices = "a..b";
  t.def.build = [](void* user, rdm_scene* scene, void* instance) {
    double low = 0, high = 0;
    rdm_result r = rdm_scene_get_range(scene, "push", &low, &high);
    if (r == RDM_OK && (low != 0.5 || high != 2))
      r = rdm_fail(RDM_ERROR_RANGE, "not the range that was given");
    return r != RDM_OK ? r : ball_build(user, scene, instance);
  };
  const Registered made(t.def);
  Rows rows("own_ranges", 1, 0, "push=0.5..2");
  rdm_option_spec option = RDM_INIT(rdm_option_spec);
  ASSERT_EQ(rdm_task_option_at(made.index(), 0, &option), RDM_OK);
  EXPECT_STREQ(option.choices, "a..b");
  rdm_pool_config c;
  rdm_pool_config_init(&c, sizeof c);
  c.task = "own_ranges";
  rdm_pool* p = nullptr;
  EXPECT_EQ(rdm_pool_create(&p, &c), RDM_ERROR_RANGE);
  EXPECT_STREQ(rdm_last_error(), "task own_ranges: build: not the range that was given");
  {  // a default may be one as well
    BallTask ranged("own_ranged");
    ranged.options[0].choices = "a..b", ranged.options[0].text = "0.5..2";
    ranged.def.build = t.def.build;
    const Registered by_default(ranged.def);
    ASSERT_EQ(rdm_task_option_at(by_default.index(), 0, &option), RDM_OK);
    EXPECT_STREQ(option.text, "0.5..2");
    Rows("own_ranged", 1);
  }
  // of an option that every task has, each world draws by itself
  Rows heavy("own_ranges", 2, 0, "push=0.5..2\ngravity=5..15"), plain("own_ranges", 2, 0, "push=0.5..2");
  heavy.step(20);
  plain.step(20);
  EXPECT_NE(heavy.b.obs[2], plain.b.obs[2]);
  EXPECT_EQ(rdm_task_check("own_ranges", "push=0.5..2\ngravity=5..15", nullptr, nullptr, nullptr, 0), RDM_OK)
      << rdm_last_error();
}

// A world with factors goes as one of a scene with the products.
TEST(OwnTask, WorldsHaveConstantsOfTheirOwn) {
  static double factor = 1;  // given to the world, or to the scene
  static bool by_world = false;
  uint64_t bytes[3] = {};
  for (const int way : {0, 1, 2}) {  // as it is; by the scene; by the world
    factor = way == 0 ? 1 : 2;
    by_world = way == 2;
    BallTask t("own_scaled");
    t.def.build = [](void*, rdm_scene* scene, void* instance) {
      auto* ids = static_cast<BallIds*>(instance);
      rdm_shape_def sphere{};
      sphere.kind = RDM_SHAPE_SPHERE, sphere.size[0] = 0.05;
      rdm_body_def ball{};
      ball.struct_size = sizeof ball, ball.name = "ball", ball.shapes = &sphere, ball.num_shapes = 1;
      ball.mass = 0.5 * (by_world ? 1 : factor), ball.pose.p[2] = 0.05;
      rdm_shape_def ground{};
      ground.name = "ground", ground.kind = RDM_SHAPE_PLANE;
      rdm_result r = rdm_scene_set_adjustable(scene);
      if (r == RDM_OK) r = rdm_scene_add_body(scene, &ball, &ids->ball);
      return r != RDM_OK ? r : rdm_scene_add_static(scene, &ground);
    };
    t.def.reset = [](void*, const void* instance, rdm_world* world, void*, rdm_random*) {
      const rdm_factor bad = {RDM_SCALE_BODY_MASS, 1, 0, 0, 2};
      const rdm_factor f[] = {
          {RDM_SCALE_BODY_MASS, static_cast<const BallIds*>(instance)->ball, 0, 0, factor},
          {RDM_SCALE_FRICTION, 0, 0, 0, 1}};
      EXPECT_EQ(rdm_world_set_factors(world, &bad, 1), RDM_ERROR_RANGE);
      return by_world ? rdm_world_set_factors(world, f, 2) : static_cast<rdm_result>(RDM_OK);
    };
    t.def.control = [](void*, const void* instance, rdm_world* world, void*, const float* action) {
      const double force[3] = {static_cast<double>(action[0]), 0, 0}, none[3] = {0, 0, 0};
      return rdm_world_push_body(world, static_cast<const BallIds*>(instance)->ball, force, none);
    };
    t.def.judge = [](void*, const void*, rdm_world*, void*, int32_t, rdm_verdict*) -> rdm_result {
      return RDM_OK;
    };
    t.def.observe = [](void*, const void* instance, const rdm_world* world, const void*, float* obs) {
      rdm_motion m;
      const rdm_result r = rdm_world_get_body(world, static_cast<const BallIds*>(instance)->ball, &m);
      for (int i = 0; i < kBallObs; ++i) obs[i] = i < 3 ? static_cast<float>(m.pose.p[i]) : 0;
      return r;
    };
    const Registered made(t.def);
    Rows rows("own_scaled", 1);
    rows.step(30);
    uint32_t x = 0;
    std::memcpy(&x, rows.b.obs, sizeof x);
    bytes[way] = x;
    EXPECT_EQ(rdm_task_check("own_scaled", nullptr, nullptr, nullptr, nullptr, 0), RDM_OK)
        << rdm_last_error();
  }
  EXPECT_NE(bytes[0], bytes[1]);
  EXPECT_EQ(bytes[2], bytes[1]);
}

// An arm with weight, whose drives are too soft for it: by its gravity as feed-forward it stays where it is.
struct Arm {
  bool held = false;
  int32_t joints = 0;
  double home[RDM_MAX_LINKS] = {};
};

rdm_result arm_build(void* user, rdm_scene* scene, void*) {
  auto* arm = static_cast<Arm*>(user);
  rdm_scene_robot robot;
  rdm_scene_robot_init(&robot, sizeof robot);
  robot.name = "arm", robot.gravity = 1;
  rdm_robot_def d;
  rdm_robot_def_init(&d, sizeof d);
  rdm_result r = rdm_robot_find("ur5e", &robot.robot);
  if (r == RDM_OK) r = rdm_robot_get_def(robot.robot, &d);
  if (r == RDM_OK) r = rdm_robot_get_postures(robot.robot, nullptr, arm->home, nullptr, nullptr);
  arm->joints = d.num_links;
  if (r == RDM_OK) r = rdm_scene_add_robot(scene, &robot, nullptr);
  return r != RDM_OK ? r : rdm_scene_set_feedforward(scene);
}

TEST(OwnTask, AnArmIsHeldByFeedForward) {
  static const rdm_field_def field = {"one", "1", 1, 0, 0, 0};
  static const rdm_cost_def cost = {"sag", "0; raw: how far a joint is from home, rad", -1};
  double sag[2];
  for (const bool held : {false, true}) {
    Arm arm;
    arm.held = held;
    rdm_task_def d;
    rdm_task_def_init(&d, sizeof d);
    d.name = "own_arm", d.fields = &field, d.num_fields = 1, d.costs = &cost, d.num_costs = 1,
    d.action_dim = 1;
    d.max_steps = 1000, d.user = &arm, d.build = arm_build;
    d.reset = [](void* user, const void*, rdm_world* world, void*, rdm_random*) {
      const auto* a = static_cast<const Arm*>(user);
      return rdm_world_set_joints(world, 0, a->home, nullptr, a->joints);
    };
    d.control = [](void* user, const void*, rdm_world* world, void*, const float*) {
      const auto* a = static_cast<const Arm*>(user);
      double efforts[RDM_MAX_LINKS];
      const rdm_result r = rdm_world_get_gravity(world, 0, efforts, a->joints);
      return r != RDM_OK || !a->held ? r : rdm_world_set_feedforward(world, 0, efforts, a->joints);
    };
    d.judge = [](void* user, const void*, rdm_world* world, void*, int32_t, rdm_verdict* out) {
      const auto* a = static_cast<const Arm*>(user);
      rdm_joints joints{};
      joints.struct_size = sizeof joints;
      const rdm_result r = rdm_world_get_joints(world, &joints);
      for (int32_t i = 0; i < a->joints; ++i)
        out->cost_raw[0] = std::max(out->cost_raw[0], std::fabs(joints.q[i] - a->home[i]));
      return r;
    };
    d.observe = [](void*, const void*, const rdm_world*, const void*, float* obs) -> rdm_result {
      obs[0] = 0;
      return RDM_OK;
    };
    const Registered made(d);
    Rows rows("own_arm", 1);
    rows.step(120);
    sag[held] = static_cast<double>(rows.b.cost_raw[0]);
    EXPECT_EQ(rdm_task_check("own_arm", nullptr, nullptr, nullptr, nullptr, 0), RDM_OK) << rdm_last_error();
  }
  std::printf("sag of an arm after 2 s: %.3g rad, held %.3g rad\n", sag[0], sag[1]);
  EXPECT_GT(sag[0], 10 * sag[1]);
  EXPECT_LT(sag[1], 2e-3);
}

TEST(OwnTask, ManyThreadsAddAndRemove) {
  std::vector<std::thread> threads;
  for (int k = 0; k < 4; ++k)
    threads.emplace_back([k] {
      const std::string name = "own_thread_" + std::to_string(k);
      for (int round = 0; round < 5; ++round) {
        BallTask t(name.c_str());
        int32_t task = -1;
        ASSERT_EQ(rdm_task_create(&task, &t.def), RDM_OK) << rdm_last_error();
        {
          Rows rows(name.c_str(), 1);
          ASSERT_EQ(rdm_task_destroy(task), RDM_OK);
          rows.step(3);
        }
        EXPECT_EQ(t.user.released, 1);
      }
    });
  for (std::thread& t : threads) t.join();
}

TEST(OwnTask, StepsWithoutTheHostsMemory) {
  struct Count {
    int calls = 0;
  } count;
  rdm_host host{};
  host.struct_size = sizeof host;
  host.user = &count;
  host.alloc = [](void* user, size_t bytes, size_t align) -> void* {
    ++static_cast<Count*>(user)->calls;
    void* p = nullptr;
    return posix_memalign(&p, align < sizeof(void*) ? sizeof(void*) : align, bytes) ? nullptr : p;
  };
  host.release = [](void*, void* p, size_t, size_t) { std::free(p); };
  BallTask t("own_heap");
  const Registered made(t.def);
  rdm_pool_config c;
  rdm_pool_config_init(&c, sizeof c);
  c.task = "own_heap";
  c.num_envs = 4;
  c.host = &host;
  size_t told = 0;
  ASSERT_EQ(rdm_pool_config_memory(&c, &told, nullptr), RDM_OK) << rdm_last_error();
  EXPECT_GT(told, 0u);
  rdm_pool* p = nullptr;
  ASSERT_EQ(rdm_pool_create(&p, &c), RDM_OK) << rdm_last_error();
  EXPECT_GT(count.calls, 0);
  ASSERT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  count.calls = 0;
  for (int i = 0; i < 60; ++i) {
    rdm_pool_baseline(p, RDM_BASELINE_RANDOM);
    ASSERT_EQ(rdm_pool_step(p), RDM_OK);
  }
  EXPECT_EQ(count.calls, 0);
  rdm_pool_destroy(p);
}

}  // namespace
}  // namespace rdm::test
