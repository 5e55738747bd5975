// Functions of a host's task that fail: which world, what happens to it, and that the others go on.
#include <atomic>
#include <cmath>
#include <string>

#include "base/error.hpp"
#include "called_task.hpp"
#include "env/pool.hpp"
#include "task_pool.hpp"

namespace rdm::test {
namespace {

// Draws of a reset choose the worlds, so that they are the same for any threads.
struct Lottery {
  CalledTask task;
  explicit Lottery(const char* name) : task(name) {
    task.reset = [](rdm_world* world, rdm_random* random) {
      rdm_motion m{};
      m.pose.q[3] = 1, m.pose.p[2] = 1 + rdm_random_uniform(random, 0, 1);
      return rdm_world_set_body(world, 0, &m);
    };
  }
  static bool chosen(const rdm_world* world) {
    rdm_motion m;
    EXPECT_EQ(rdm_world_get_body(world, 0, &m), RDM_OK);
    return m.pose.p[2] > 1.5;
  }
};

TEST(OwnTaskFailures, OneWorldIsFlaggedAndTheOthersGoOn) {
  const char* functions[] = {"control", "judge", "observe"};
  for (const std::string function : functions)
    for (const int32_t threads : {0, 3}) {
      Lottery l("fails_alone");
      TaskPool p("fails_alone", 8, threads);
      EXPECT_EQ(rdm_pool_reset(p.pool, nullptr, nullptr), RDM_OK);
      const auto fails = [](const rdm_world* world) {
        return Lottery::chosen(world) ? rdm_fail(RDM_ERROR_IO, "sensor lost") : rdm_result{RDM_OK};
      };
      if (function == "control") l.task.control = [&](rdm_world* w, int64_t*) { return fails(w); };
      if (function == "judge")
        l.task.judge = [&](const rdm_world* w, int64_t, rdm_verdict*) { return fails(w); };
      if (function == "observe") l.task.observe = [&](const rdm_world* w) { return fails(w); };
      // of observe the autoreset's own call may fail, too: each episode has at least one step in any case
      EXPECT_EQ(rdm_pool_step(p.pool), RDM_OK);
      int32_t failed = 0, went_on = 0;
      for (int32_t i = 0; i < 8; ++i) {
        const auto e = static_cast<size_t>(i);
        if (!(p.b.status[e] & RDM_STATUS_TASK)) {
          ++went_on;
          EXPECT_EQ(p.b.episode_step[e], 1);
          EXPECT_EQ(p.b.reward[e], 1);
          EXPECT_EQ(p.text(i), "");
          continue;
        }
        ++failed;
        EXPECT_EQ(p.b.truncated[e], 1);
        EXPECT_EQ(p.b.terminated[e], 0);
        EXPECT_EQ(p.b.reward[e], 0);
        EXPECT_EQ(p.b.cost[e], 0);
        EXPECT_TRUE(std::isfinite(p.b.obs[e]) && std::isfinite(p.b.final_obs[e]));
        EXPECT_EQ(p.text(i),
                  "world " + std::to_string(i) + ": task fails_alone: " + function + ": sensor lost");
      }
      EXPECT_GT(failed, 0);
      EXPECT_GT(went_on, 0);
      l.task.control = nullptr, l.task.judge = nullptr, l.task.observe = nullptr;
      for (int k = 0; k < 2; ++k) EXPECT_EQ(rdm_pool_step(p.pool), RDM_OK);
      for (size_t e = 0; e < 8; ++e) EXPECT_EQ(p.b.status[e], 0u) << "autoreset mends it";
    }
}

// The same bytes for any threads, with failures in between, also through saved states.
TEST(OwnTaskFailures, SameBytesForAnyThreads) {
  Lottery l("fails_alike");
  l.task.judge = [](const rdm_world* w, int64_t steps, rdm_verdict*) {
    return Lottery::chosen(w) && steps > 3 ? RDM_ERROR_IO : RDM_OK;
  };
  auto fails_to_reset = [reset = l.task.reset](rdm_world* w, rdm_random* random) {
    if (rdm_random_uniform(random, 0, 1) < 0.3) return rdm_fail(RDM_ERROR_STATE, "no place");
    return reset(w, random);
  };
  for (const int32_t autoreset : {RDM_AUTORESET_SAME_STEP, RDM_AUTORESET_NEXT_STEP}) {
    l.task.reset = [&](rdm_world* w, rdm_random* random) { return fails_to_reset(w, random); };
    TaskPool one("fails_alike", 6, 0, autoreset), four("fails_alike", 6, 4, autoreset),
        again("fails_alike", 6, 0, autoreset);
    for (TaskPool* p : {&one, &four})
      for (int k = 0; rdm_pool_reset(p->pool, nullptr, nullptr) != RDM_OK; ++k) ASSERT_LT(k, 200);
    int32_t retried = 0;
    for (int step = 0; step < 120; ++step) {
      for (TaskPool* p : {&one, &four}) {
        EXPECT_EQ(rdm_pool_baseline(p->pool, RDM_BASELINE_RANDOM), RDM_OK);
        EXPECT_EQ(rdm_pool_step(p->pool), RDM_OK);
      }
      uint64_t a = 0, b = 1, c = 2;
      EXPECT_EQ(rdm_pool_get_hash(one.pool, -1, &a), RDM_OK);
      EXPECT_EQ(rdm_pool_get_hash(four.pool, -1, &b), RDM_OK);
      ASSERT_EQ(a, b) << step;
      for (int32_t i = 0; i < 6; ++i) {
        EXPECT_EQ(one.b.status[i], four.b.status[i]);
        EXPECT_EQ(one.text(i), four.text(i));
        retried += (one.b.status[i] & RDM_STATUS_TASK) && one.text(i).find("no place") != std::string::npos;
      }
      size_t size = 0;
      ASSERT_EQ(rdm_pool_write_state(one.pool, -1, nullptr, 0, &size), RDM_OK);
      std::vector<unsigned char> bytes(size);
      ASSERT_EQ(rdm_pool_write_state(one.pool, -1, bytes.data(), size, &size), RDM_OK);
      ASSERT_EQ(rdm_pool_read_state(again.pool, -1, bytes.data(), size), RDM_OK) << rdm_last_error();
      EXPECT_EQ(rdm_pool_get_hash(again.pool, -1, &c), RDM_OK);
      ASSERT_EQ(a, c) << step;
    }
    EXPECT_GT(retried, 0);
  }
}

TEST(OwnTaskFailures, AResetThatFails) {
  Lottery l("fails_reset");
  int calls = 0;
  const auto good = l.task.reset;
  TaskPool p("fails_reset", 3);
  l.task.reset = [&](rdm_world* w, rdm_random* random) {
    return ++calls == 2 ? rdm_fail(RDM_ERROR_IO, "no place") : good(w, random);
  };
  EXPECT_EQ(rdm_pool_reset(p.pool, nullptr, nullptr), RDM_ERROR_IO);
  EXPECT_STREQ(rdm_pool_error(p.pool), "world 1: task fails_reset: reset: no place");
  EXPECT_EQ(p.text(1), rdm_pool_error(p.pool));
  EXPECT_EQ(p.b.status[0], 0u);
  EXPECT_EQ(p.b.status[1], static_cast<uint32_t>(RDM_STATUS_TASK));
  EXPECT_EQ(p.b.status[2], 0u);
  EXPECT_EQ(rdm_pool_step(p.pool), RDM_ERROR_STATE);
  EXPECT_STREQ(rdm_pool_error(p.pool), "step: world 1 was not reset yet");
  const uint8_t mask[3] = {0, 1, 0};
  EXPECT_EQ(rdm_pool_reset(p.pool, nullptr, mask), RDM_OK);
  EXPECT_EQ(p.b.status[1], 0u);
  EXPECT_EQ(rdm_pool_step(p.pool), RDM_OK);
  for (size_t i = 0; i < 3; ++i) EXPECT_EQ(p.b.episode_step[i], 1);
}

// A world whose task fails to reset for a while keeps showing its end; what an agent learns from is the rest.
TEST(OwnTaskFailures, AResetThatFailsWithinAStep) {
  Lottery l("fails_later");
  bool fails = false;
  const auto good = l.task.reset;
  l.task.reset = [&](rdm_world* w, rdm_random* random) {
    return fails ? rdm_fail(RDM_ERROR_IO, "no place") : good(w, random);
  };
  TaskPool p("fails_later", 2);
  EXPECT_EQ(rdm_pool_reset(p.pool, nullptr, nullptr), RDM_OK);
  for (int k = 0; k < 19; ++k) EXPECT_EQ(rdm_pool_step(p.pool), RDM_OK);
  fails = true;
  EXPECT_EQ(rdm_pool_step(p.pool), RDM_OK);
  EXPECT_EQ(p.b.episode_return[0], 20);
  for (int k = 0; k < 3; ++k) {
    EXPECT_EQ(p.b.truncated[0], 1);
    EXPECT_EQ(p.b.status[0], static_cast<uint32_t>(RDM_STATUS_TASK));
    EXPECT_EQ(rdm_pool_step(p.pool), RDM_OK);
    EXPECT_EQ(p.b.reward[0], 0);
  }
  fails = false;
  EXPECT_EQ(rdm_pool_step(p.pool), RDM_OK);  // only resets
  EXPECT_EQ(p.b.status[0], 0u);
  EXPECT_EQ(p.b.truncated[0], 0);
  EXPECT_EQ(p.b.episode_step[0], 0);
  EXPECT_EQ(rdm_pool_step(p.pool), RDM_OK);
  EXPECT_EQ(p.b.episode_step[0], 1);

  rdm_agent_config c;
  EXPECT_EQ(rdm_agent_config_init(&c, sizeof c), RDM_OK);
  EXPECT_EQ(rdm_agent_config_for_pool(&c, p.pool), RDM_OK);
  c.settings = "horizon=60\nminibatches=1";
  rdm_agent* const agent = make_agent(c);
  EXPECT_EQ(rdm_pool_reset(p.pool, nullptr, nullptr), RDM_OK);
  int64_t steps = 0;
  l.task.judge = [&](const rdm_world*, int64_t, rdm_verdict*) {
    fails = ++steps > 30 && steps < 50;  // in the rows of some ends
    return rdm_result{RDM_OK};
  };
  rdm_epoch e{};
  e.struct_size = sizeof e;
  fails = false;
  EXPECT_EQ(rdm_agent_rollout(agent, p.pool, &e), RDM_OK) << rdm_agent_error(agent);
  EXPECT_EQ(e.length, 20) << "rows without an episode are in none";
  EXPECT_EQ(e.ret, 20);
  rdm_agent_destroy(agent);
}

TEST(OwnTaskFailures, ExceptionsAreTheHosts) {
  CalledTask t("throws");
  int released = 0;
  {
    TaskPool p("throws", 1);
    t.judge = [](const rdm_world*, int64_t, rdm_verdict*) -> rdm_result { throw 1; };
    EXPECT_EQ(rdm_pool_reset(p.pool, nullptr, nullptr), RDM_OK);
    EXPECT_EQ(rdm_pool_step(p.pool), RDM_OK);
    EXPECT_EQ(p.b.status[0], static_cast<uint32_t>(RDM_STATUS_TASK));
    EXPECT_EQ(p.text(0), "world 0: task throws: judge threw an exception");
    t.reset = [](rdm_world*, rdm_random*) -> rdm_result { throw 1; };
    EXPECT_EQ(rdm_pool_reset(p.pool, nullptr, nullptr), RDM_ERROR_ARGUMENT);
  }
  t.build = [](rdm_scene*) -> rdm_result { throw 1; };
  rdm_pool_config c = pool_config(1);
  c.task = "throws";
  rdm_pool* pool = nullptr;
  EXPECT_EQ(rdm_pool_create(&pool, &c), RDM_ERROR_ARGUMENT);
  EXPECT_STREQ(rdm_last_error(), "task throws: build threw an exception");
  t.release = [&] {
    ++released;
    throw 1;
  };
  EXPECT_EQ(rdm_task_destroy(t.number), RDM_OK);
  EXPECT_EQ(released, 1);
  t.release = nullptr;
}

TEST(OwnTaskFailures, TheTaskCheckNamesAFailureThatOnlyPoolsSee) {
  CalledTask t("fails_in_pools");
  std::atomic<int64_t> calls{0};  // worlds are judged by several threads
  t.judge = [&](const rdm_world*, int64_t, rdm_verdict*) {
    return ++calls > 2000 ? rdm_fail(RDM_ERROR_IO, "worn out") : rdm_result{RDM_OK};
  };
  rdm_result r = RDM_OK;
  for (int k = 0; k < 20 && r == RDM_OK; ++k)
    r = rdm_task_check("fails_in_pools", nullptr, nullptr, nullptr, nullptr, 0);
  EXPECT_EQ(r, RDM_ERROR_ARGUMENT);
  EXPECT_NE(std::string(rdm_last_error()).find("judge: worn out; step"), std::string::npos)
      << rdm_last_error();
}

TEST(OwnTaskFailures, ABuildThatMakesItsOwnPoolEnds) {
  CalledTask t("builds_itself");
  int32_t builds = 0;
  std::string text;
  t.build = [&](rdm_scene*) {
    ++builds;
    rdm_pool_config c = pool_config(1);
    c.task = "builds_itself";
    rdm_pool* p = nullptr;
    if (const rdm_result r = rdm_pool_create(&p, &c)) {
      if (text.empty()) text = rdm_last_error();
      return r;
    }
    rdm_pool_destroy(p);
    return rdm_result{RDM_OK};
  };
  rdm_pool_config c = pool_config(1);
  c.task = "builds_itself";
  rdm_pool* p = nullptr;
  EXPECT_EQ(rdm_pool_create(&p, &c), RDM_ERROR_STATE);
  EXPECT_EQ(builds, 8);
  EXPECT_EQ(text,
            "task builds_itself: build: 8 builds are nested: a build made a pool whose build made a pool, "
            "and so on");
  t.build = nullptr;
  EXPECT_EQ(rdm_pool_create(&p, &c), RDM_OK) << rdm_last_error();
  rdm_pool_destroy(p);
}

TEST(OwnTaskFailures, TextsAreOfWorldsThatThereAre) {
  CalledTask t("texts");
  TaskPool p("texts", 2);
  EXPECT_EQ(p.text(0), "");
  EXPECT_EQ(p.text(2), "env: no such world");
  EXPECT_EQ(p.text(-1), "env: no such world");
  EXPECT_STREQ(rdm_pool_world_error(nullptr, 0), rdm_pool_error(nullptr));
  rdm_pool_config c = pool_config(1);
  rdm_pool* own = make_pool(c);
  EXPECT_STREQ(rdm_pool_world_error(own, 0), "") << "the library's tasks do not fail";
  rdm_pool_destroy(own);
}

// ---- builds that failed stay failed
// ---------------------------------------------------------------------------

struct Build {
  CalledTask task{"builds"};
  rdm_result create() {
    rdm_pool_config c = pool_config(1);
    c.task = "builds";
    rdm_pool* pool = nullptr;
    const rdm_result r = rdm_pool_create(&pool, &c);
    rdm_pool_destroy(pool);
    return r;
  }
};

rdm_result add_static(rdm_scene* scene, const char* name) {
  rdm_shape_def s{};
  s.kind = RDM_SHAPE_SPHERE, s.size[0] = 0.1, s.name = name;
  return rdm_scene_add_static(scene, &s);
}

TEST(OwnTaskBuilds, AFailedOneStaysFailed) {
  Build b;
  std::vector<rdm_result> later;
  std::string first;
  b.task.build = [&](rdm_scene* scene) {
    rdm_scene_robot hand;
    EXPECT_EQ(rdm_scene_robot_init(&hand, sizeof hand), RDM_OK);
    hand.name = "hand";
    EXPECT_EQ(rdm_robot_find("shadow_hand", &hand.robot), RDM_OK);
    EXPECT_EQ(rdm_scene_add_robot(scene, &hand, nullptr), RDM_OK);
    for (int i = 0; i < 2; ++i)
      EXPECT_EQ(add_static(scene, "x"), RDM_OK) << "looked at when the scene is complete";
    int32_t k = 0;
    EXPECT_EQ(rdm_scene_find(scene, RDM_SCENE_SHAPE, "x", &k), RDM_ERROR_ARGUMENT);
    first = rdm_last_error();
    rdm_shape_def sphere{};
    sphere.kind = RDM_SHAPE_SPHERE, sphere.size[0] = 0.05;
    rdm_body_def ball{};
    ball.struct_size = sizeof ball, ball.name = "other", ball.shapes = &sphere, ball.num_shapes = 1;
    ball.mass = 0.1, ball.pose.p[2] = 2;
    rdm_joint_info joint = RDM_INIT(rdm_joint_info);
    const double p[3] = {};
    const rdm_pose pose{};
    later = {rdm_scene_add_body(scene, &ball, nullptr),
             rdm_scene_find(scene, RDM_SCENE_SHAPE, "x", &k),
             rdm_scene_joint_at(scene, 0, &joint),
             rdm_scene_add_touch(scene, "hand", "ball", &k),
             rdm_scene_add_material(scene, "wood"),
             rdm_scene_add_object(scene, 0, "thing", &pose, 1, nullptr),
             rdm_scene_add_robot(scene, &hand, nullptr),
             rdm_scene_set_gravity(scene, p),
             rdm_scene_set_actions(scene, 2, nullptr, nullptr),
             rdm_scene_set_field(scene, "steps", 2)};
    return rdm_result{RDM_OK};
  };
  EXPECT_EQ(b.create(), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(std::string(rdm_last_error()), "task builds: build: " + first);
  EXPECT_EQ(later, std::vector<rdm_result>(10, RDM_ERROR_ARGUMENT));
}

// Memory that is refused at each place in turn, to a build that goes on as if nothing had happened: it is
// made whole, or not at all.
TEST(OwnTaskBuilds, RefusedMemoryLeavesNoHalf) {
  Build b;
  b.task.build = [&](rdm_scene* scene) {
    const rdm_pose pose = {{0, 0, 3}, {}};
    rdm_scene_robot hand;
    rdm_scene_robot_init(&hand, sizeof hand);
    rdm_scene_add_material(scene, "wood");
    for (const char* name : {"left", "right"}) {
      hand.name = name;
      rdm_robot_find("allegro_hand", &hand.robot);
      rdm_scene_add_robot(scene, &hand, nullptr);
      hand.pose.p[0] = 1;
    }
    rdm_scene_add_object(scene, 0, "thing", &pose, 1, nullptr);
    int32_t k = 0;
    rdm_scene_find(scene, RDM_SCENE_BODY, "ball", &k);
    rdm_scene_add_touch(scene, "left*", "ball", &k);
    return rdm_result{RDM_OK};
  };
  int32_t refused = 0, made = 0;
  for (size_t at = 0;; ++at) {
    CountingHost host;
    host.refuse_at = at;
    PoolConfig c;  // rdm_pool_create asks its host once for all
    c.task = "builds";
    c.hooks.user = &host;
    c.hooks.release = CountingHost::release;
    // refused once alone, as where another part of the process frees some
    c.hooks.alloc = [](void* user, size_t bytes, size_t align) -> void* {
      auto* h = static_cast<CountingHost*>(user);
      if (h->calls == h->refuse_at) return ++h->calls, nullptr;
      const size_t keep = h->refuse_at;
      h->refuse_at = SIZE_MAX;
      void* const p = CountingHost::alloc(user, bytes, align);
      h->refuse_at = keep;
      return p;
    };
    rdm::Pool* pool = nullptr;
    const Code r = guard([&] { pool = rdm::Pool::create(c); });
    if (r == Code::kOk) {
      ++made;
      pool->reset(nullptr, nullptr);
      for (int k = 0; k < 3; ++k) pool->step(nullptr);
    } else {
      ++refused;
      EXPECT_EQ(r, Code::kMemory) << at << ": " << last_error();
    }
    rdm::Pool::destroy(pool);
    EXPECT_EQ(host.live, 0u) << at;
    if (host.calls <= at) break;
  }
  EXPECT_GT(refused, 100);
  std::printf("%d refused, %d made without what was refused\n", refused, made);
}

TEST(OwnTaskBuilds, ARobotThatWasLeftOutIsNoShadowHand) {
  Build b;
  rdm_result added = 99;
  std::string text;
  std::function<void(rdm_scene_robot&)> change;
  b.task.build = [&](rdm_scene* scene) {
    rdm_scene_robot r{};
    r.struct_size = sizeof r, r.name = "r";
    change(r);
    added = rdm_scene_add_robot(scene, &r, nullptr);
    text = rdm_last_error();
    return added;
  };
  change = [](rdm_scene_robot&) {};
  EXPECT_EQ(b.create(), RDM_ERROR_ARGUMENT);
  EXPECT_EQ(text,
            "robot.robot of r is not set: fill the struct by rdm_scene_robot_init, then set the number that "
            "rdm_robot_find gives");
  change = [](rdm_scene_robot& r) {
    EXPECT_EQ(rdm_scene_robot_init(&r, sizeof r), RDM_OK);
    r.name = "r";
  };
  EXPECT_EQ(b.create(), RDM_ERROR_ARGUMENT);
  change = [](rdm_scene_robot& r) {
    EXPECT_EQ(rdm_scene_robot_init(&r, sizeof r), RDM_OK);
    r.name = "r";
    EXPECT_EQ(rdm_robot_find("shadow_hand", &r.robot), RDM_OK);
  };
  EXPECT_EQ(b.create(), RDM_OK) << text;
  change = [](rdm_scene_robot& r) { EXPECT_EQ(rdm_robot_find("allegro_hand", &r.robot), RDM_OK); };
  EXPECT_EQ(b.create(), RDM_OK) << text;
}

}  // namespace
}  // namespace rdm::test
