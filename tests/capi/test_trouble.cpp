// What went wrong in worlds: flagged in the step, kept of the episode, counted by the pool and by the epoch.
#include <cmath>
#include <limits>

#include "called_task.hpp"
#include "task_pool.hpp"
#include "written.hpp"

namespace rdm::test {
namespace {

constexpr int32_t kWorlds = 3;

struct Pool : TaskPool {
  explicit Pool(const char* task, const char* settings = nullptr, int32_t autoreset = RDM_AUTORESET_SAME_STEP)
      : TaskPool(task, kWorlds, 0, autoreset, settings) {
    EXPECT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
  }

  void step(int32_t times = 1) {
    for (int32_t i = 0; i < times; ++i) ASSERT_EQ(rdm_pool_step(pool), RDM_OK) << rdm_pool_error(pool);
  }
  rdm_pool_stats stats() const {
    rdm_pool_stats s{};
    s.struct_size = sizeof s;
    EXPECT_EQ(rdm_pool_get_stats(pool, &s), RDM_OK);
    return s;
  }
  void expect_status(uint32_t of_step, uint32_t of_episode) const {
    for (size_t e = 0; e < kWorlds; ++e) {
      EXPECT_EQ(b.status[e], of_step) << e;
      EXPECT_EQ(b.episode_status[e], of_episode) << e;
    }
  }
};

// One epoch of an agent in it.
rdm_epoch learn(rdm_pool* pool) {
  rdm_agent_config c;
  rdm_agent* agent = nullptr;
  rdm_epoch e{};
  e.struct_size = sizeof e;
  EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  EXPECT_EQ(rdm_agent_config_for_pool(&c, pool), RDM_OK);
  c.settings = "horizon=40\nhidden=8\nminibatches=1";
  EXPECT_EQ(rdm_agent_create(&agent, &c), RDM_OK) << rdm_last_error();
  EXPECT_EQ(rdm_agent_rollout(agent, pool, &e), RDM_OK) << rdm_agent_error(agent);
  rdm_agent_destroy(agent);
  return e;
}

// A box of `mass` kg and 10 cm.
rdm_result add_box(rdm_scene* scene, const char* name, double mass, double height) {
  rdm_shape_def box{};
  box.kind = RDM_SHAPE_BOX, box.size[0] = box.size[1] = box.size[2] = 0.05;
  rdm_body_def body{};
  body.struct_size = sizeof body, body.name = name, body.shapes = &box, body.num_shapes = 1;
  body.mass = mass, body.pose.p[0] = 1, body.pose.p[2] = height;
  return rdm_scene_add_body(scene, &body, nullptr);
}

rdm_result add_ground(rdm_scene* scene) {
  rdm_shape_def ground{};
  ground.name = "ground", ground.kind = RDM_SHAPE_PLANE;
  return rdm_scene_add_static(scene, &ground);
}

// A task of one ball, and boxes that stand on each other.
struct Pile {
  CalledTask task;
  Pile(const char* name, const std::vector<double>& masses) : task(name) {
    task.build = [masses](rdm_scene* scene) {
      rdm_result r = add_ground(scene);
      const char* names[] = {"a", "b", "c", "d", "e", "f", "g", "h", "i", "j", "k", "l"};
      for (size_t i = 0; r == RDM_OK && i < masses.size(); ++i)
        r = add_box(scene, names[i], masses[i], 0.05 + 0.1 * static_cast<double>(i));
      return r;
    };
  }
};

}  // namespace

TEST(Trouble, AStepThatIsNotFiniteIsOfItsEpisode) {
  CalledTask task("nan_reward");
  task.judge = [](const rdm_world*, int64_t steps, rdm_verdict* out) {
    if (steps == 3) out->reward = std::nan("");
    return RDM_OK;
  };
  Pool p("nan_reward");
  p.step(2);
  p.expect_status(0, 0);
  p.step();
  p.expect_status(RDM_STATUS_DIVERGED, RDM_STATUS_DIVERGED);
  EXPECT_EQ(p.b.truncated[0], 1);
  p.step();
  p.expect_status(0, 0);
  EXPECT_EQ(p.stats().diverged, kWorlds);
  const rdm_epoch e = learn(p.pool);
  EXPECT_EQ(e.diverged, kWorlds * 13);
  EXPECT_EQ(e.flags, RDM_EPOCH_DIVERGED);
}

// Of a host's own environment, whose rewards no pool has looked at.
TEST(Trouble, GradientsThatAreLeftOutAreCounted) {
  rdm_agent_config c;
  rdm_agent* agent = nullptr;
  ASSERT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  c.obs_dim = c.action_dim = c.num_envs = 1;
  c.settings = "horizon=16\nhidden=4\nminibatches=1";
  ASSERT_EQ(rdm_agent_create(&agent, &c), RDM_OK) << rdm_last_error();
  const float obs = 0, cost = 0;
  for (const float reward : {3e38f, 1.0f}) {  // finite; two of the first are not
    for (int32_t t = 0; t < 16; ++t) {
      float action = 0;
      ASSERT_EQ(rdm_agent_act(agent, &obs, RDM_ACT_SAMPLE, &action), RDM_OK);
      rdm_transition row{};
      row.struct_size = sizeof row, row.reward = &reward, row.cost = &cost;
      ASSERT_EQ(rdm_agent_record(agent, &row), RDM_OK) << rdm_agent_error(agent);
    }
    rdm_epoch e{};
    e.struct_size = sizeof e;
    ASSERT_EQ(rdm_agent_update(agent, &obs, &e), RDM_OK) << rdm_agent_error(agent);
    EXPECT_EQ(e.skipped_gradients > 0, reward > 1) << reward;
    EXPECT_EQ((e.flags & RDM_EPOCH_SKIPPED_GRADIENTS) != 0, reward > 1) << reward;
  }
  rdm_agent_destroy(agent);
}

TEST(Trouble, ActionsThatAreNotFiniteAreCounted) {
  CalledTask task("nan_action");
  Pool p("nan_action", nullptr, RDM_AUTORESET_NEXT_STEP);
  for (size_t e = 0; e < kWorlds; ++e) p.b.action[e] = std::numeric_limits<float>::infinity();
  p.step();
  p.expect_status(RDM_STATUS_BAD_ACTION, RDM_STATUS_BAD_ACTION);
  p.step();  // only resets
  p.expect_status(0, 0);
  EXPECT_EQ(p.stats().bad_actions, kWorlds);
}

TEST(Trouble, FailuresOfTheTaskAreCounted) {
  CalledTask task("fails_counted");
  Pool p("fails_counted");
  task.control = [](rdm_world*, int64_t*) { return RDM_ERROR_IO; };
  p.step(2);
  p.expect_status(RDM_STATUS_TASK, RDM_STATUS_TASK);
  EXPECT_EQ(p.stats().task_failed, 2 * kWorlds);
  task.control = nullptr;
}

TEST(Trouble, AFirstObservationThatIsNotFiniteIsFlaggedAndMended) {
  CalledTask task("nan_reset");
  float shown = std::nanf("");
  task.shows = [&](int64_t steps) { return steps == 0 ? shown : 1.0f; };
  Pool p("nan_reset");
  p.expect_status(RDM_STATUS_DIVERGED, RDM_STATUS_DIVERGED);
  for (size_t e = 0; e < kWorlds; ++e) EXPECT_EQ(p.b.obs[e], 0);
  const auto state = written_bytes(
      [&](void* out, size_t n, size_t* size) { return rdm_pool_write_state(p.pool, -1, out, n, size); });
  EXPECT_EQ(rdm_pool_read_state(p.pool, -1, state.data(), state.size()), RDM_OK) << rdm_pool_error(p.pool);
  p.step();
  p.expect_status(0, RDM_STATUS_DIVERGED);
  EXPECT_EQ(p.stats().diverged, kWorlds);
  // the end of an episode shows the start of the next one, and what is wrong with it
  p.step(19);
  p.expect_status(RDM_STATUS_DIVERGED, RDM_STATUS_DIVERGED);
  shown = 0;
  p.step(20);
  p.expect_status(0, RDM_STATUS_DIVERGED);
  p.step();
  p.expect_status(0, 0);
}

TEST(Trouble, ContactsThatAreLeftOutAreKeptOfTheEpisode) {
  Pile pile("crowded", {1, 1, 1});
  Pool p("crowded", "contacts_max=6");
  p.step(5);
  p.expect_status(RDM_STATUS_CONTACTS, RDM_STATUS_CONTACTS);
  EXPECT_EQ(p.stats().overflowed, 5 * kWorlds);
  EXPECT_EQ(learn(p.pool).flags, RDM_EPOCH_CONTACTS);
}

// A pool makes room for all that a scene's things can touch each other with.
TEST(Trouble, AScenesOwnNumberOfContactsIsEnough) {
  Pile pile("tall", std::vector<double>(12, 0.1));
  Pool p("tall");
  p.step(60);
  EXPECT_EQ(p.stats().overflowed, 0);
  EXPECT_GE(p.stats().contacts_max, 48);
}

TEST(Trouble, ContactsThatAreNotSolvedAreFlagged) {
  std::vector<double> masses(12, 1);
  masses.back() = 19;
  Pile light("equal", {1, 1}), heavy("crushed", masses);
  Pool good("equal"), bad("crushed", "iterations=1");
  good.step(60);
  EXPECT_EQ(good.stats().unconverged, 0);
  bad.step(60);
  EXPECT_GT(bad.stats().unconverged, 0);
  EXPECT_NE(learn(bad.pool).flags & RDM_EPOCH_SOLVER, 0u);
}

// Engine ode says nothing of its sweeps.
TEST(Trouble, TheSolversResidualIsOfEnginesThatMeasureIt) {
  Pile pile("measured", {1});
  Pool ours("measured"), ode("measured", "engine=ode");
  for (Pool* p : {&ours, &ode}) p->step(20);
  EXPECT_GE(ours.stats().solver_residual, 0);
  EXPECT_LT(ours.stats().solver_residual, 1e-3);
  EXPECT_TRUE(std::isnan(ode.stats().solver_residual));
}

// A body may turn by 3 rad in a substep of 1/120 s: 360 rad/s.
TEST(Trouble, ThingsThatAreSlowedAreFlagged) {
  for (const char* engine : {"engine=articulated", "engine=ode"}) {
    double spin = 350;
    CalledTask task("spun");
    task.build = [](rdm_scene* scene) { return add_box(scene, "a", 1, 2); };
    task.reset = [&](rdm_world* world, rdm_random*) {
      rdm_motion m{};
      m.pose.p[2] = 2, m.pose.q[0] = 1, m.w[2] = spin;
      return rdm_world_set_body(world, 0, &m);
    };
    Pool within("spun", engine);
    within.step(3);
    within.expect_status(0, 0);
    EXPECT_EQ(within.stats().slowed, 0) << engine;
    spin = 400;
    Pool beyond("spun", engine);
    beyond.step(1);
    beyond.expect_status(RDM_STATUS_SLOWED, RDM_STATUS_SLOWED);
    EXPECT_EQ(beyond.stats().slowed, kWorlds) << engine;
  }
}

// What an episode's status was is part of its state, so that one that is gone on with is not taken for sound.
TEST(Trouble, StatesAndCopiesKeepTheEpisodesStatus) {
  Pile pile("kept", {1, 1, 1});
  Pool p("kept", "contacts_max=6");
  p.step(3);
  std::vector<unsigned char> state(1 << 20);
  size_t size = 0;
  EXPECT_EQ(rdm_pool_write_state(p.pool, 1, state.data(), state.size(), &size), RDM_OK);
  EXPECT_EQ(rdm_pool_reset(p.pool, nullptr, nullptr), RDM_OK);
  p.expect_status(0, 0);
  EXPECT_EQ(rdm_pool_read_state(p.pool, 2, state.data(), size), RDM_OK);
  EXPECT_EQ(p.b.episode_status[2], uint32_t{RDM_STATUS_CONTACTS});
  EXPECT_EQ(rdm_pool_copy(p.pool, 0, p.pool, 2), RDM_OK);
  EXPECT_EQ(p.b.episode_status[0], uint32_t{RDM_STATUS_CONTACTS});
  EXPECT_EQ(p.b.episode_status[1], 0u);
}

}  // namespace rdm::test
