// Joints from outside: what they are, where they are, and a world that goes on from where they are put, for
// both engines.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "called_task.hpp"
#include "contract.hpp"
#include "heap_count.hpp"

namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

rdm_joint_info info_at(const rdm_pool* p, int32_t i) {
  rdm_joint_info j{};
  j.struct_size = sizeof j;
  EXPECT_EQ(rdm_pool_joint_at(p, i, &j), RDM_OK) << rdm_last_error();
  return j;
}

struct Case {
  const char* task;
  const char* settings;
};
void PrintTo(const Case& c, std::ostream* out) {
  *out << c.task << ' ' << c.settings;
}

// A pool of so many worlds, reset.
struct JointsPool {
  rdm_pool* p;
  rdm_spec spec;
  rdm_buffers b;
  size_t n;

  explicit JointsPool(const Case& test, int32_t envs = 1, uint64_t seed = 0,
                      int32_t autoreset = RDM_AUTORESET_SAME_STEP) {
    rdm_pool_config c = pool_config(envs);
    c.task = test.task;
    c.settings = test.settings;
    c.seed = seed;
    c.autoreset = autoreset;
    p = make_pool(c);
    spec = spec_of(p);
    b = buffers_of(p);
    n = static_cast<size_t>(spec.num_joints);
    EXPECT_EQ(rdm_pool_reset(p, nullptr, nullptr), RDM_OK);
  }
  ~JointsPool() { rdm_pool_destroy(p); }
  void play(int steps) {
    for (int i = 0; i < steps; ++i) {
      ASSERT_EQ(rdm_pool_baseline(p, RDM_BASELINE_RANDOM), RDM_OK);
      ASSERT_EQ(rdm_pool_step(p), RDM_OK) << rdm_pool_error(p);
    }
  }
  std::vector<double> q(int32_t env = 0) const {
    std::vector<double> out(n);
    EXPECT_EQ(rdm_pool_get_joints(p, env, out.data(), nullptr, n), RDM_OK) << rdm_pool_error(p);
    return out;
  }
  std::vector<double> qd(int32_t env = 0) const {
    std::vector<double> out(n);
    EXPECT_EQ(rdm_pool_get_joints(p, env, nullptr, out.data(), n), RDM_OK) << rdm_pool_error(p);
    return out;
  }
  rdm_result set(const std::vector<double>& x, const std::vector<double>& rate, int32_t env = 0) {
    return rdm_pool_set_joints(p, env, x.empty() ? nullptr : x.data(), rate.empty() ? nullptr : rate.data(),
                               n);
  }
  std::vector<rdm_pose> poses(int32_t env = 0) const {
    std::vector<rdm_pose> out(static_cast<size_t>(spec.num_shapes));
    EXPECT_EQ(rdm_pool_get_poses(p, env, out.data()), RDM_OK);
    return out;
  }
  std::vector<float> obs(int32_t env = 0) const {
    return {b.obs + env * spec.obs_dim, b.obs + (env + 1) * spec.obs_dim};
  }
};

class Joints : public testing::TestWithParam<Case> {};

INSTANTIATE_TEST_SUITE_P(
    Tasks, Joints,
    testing::Values(Case{"hand_over_safe_finger", ""}, Case{"hand_over_safe_finger", "engine=ode"},
                    Case{"catch_underarm_safe_finger", "action_order=paper"},
                    Case{"grasp", "hand=barrett_bh282\narm=ur5e"}, Case{"grasp", "engine=ode"},
                    Case{"hand_over_safe_finger", "precision=double"}, Case{"ant_run", ""},
                    Case{"hopper_velocity", ""}, Case{"walker2d_velocity", ""}, Case{"bandit", ""}));

TEST_P(Joints, AreDescribed) {
  JointsPool pool(GetParam());
  std::set<std::string> names;
  std::set<int32_t> entries;
  for (int32_t i = 0; i < pool.spec.num_joints; ++i) {
    const rdm_joint_info j = info_at(pool.p, i);
    EXPECT_TRUE(names.insert(j.name).second) << j.name;
    EXPECT_GE(j.parent, -1);
    EXPECT_LT(j.parent, i);
    EXPECT_LT(j.lower, j.upper);
    EXPECT_TRUE(std::isnan(j.velocity) || j.velocity > 0) << j.velocity;
    EXPECT_TRUE(j.kind == RDM_JOINT_REVOLUTE || j.kind == RDM_JOINT_PRISMATIC);
    EXPECT_GE(j.kp, 0);
    EXPECT_LT(j.action, pool.spec.action_dim);
    EXPECT_TRUE(j.action == -1 || entries.insert(j.action).second) << j.name;
  }
  rdm_joint_info past{};
  past.struct_size = sizeof past;
  EXPECT_EQ(rdm_pool_joint_at(pool.p, pool.spec.num_joints, &past), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_joint_at(pool.p, -1, &past), RDM_ERROR_RANGE);
}

// Of all joints that have an entry, a changed one moves its own the most.
TEST_P(Joints, AreMovedByTheirEntries) {
  JointsPool pool(GetParam(), 2, 3);
  for (int32_t i = 0; i < pool.spec.num_joints; ++i) {
    const rdm_joint_info j = info_at(pool.p, i);
    if (j.action < 0) continue;
    ASSERT_EQ(rdm_pool_reset(pool.p, nullptr, nullptr), RDM_OK);
    ASSERT_EQ(rdm_pool_copy(pool.p, 1, pool.p, 0), RDM_OK);
    for (int k = 0; k < 3; ++k) {
      std::fill_n(pool.b.action, 2 * pool.spec.action_dim, 0.0f);
      pool.b.action[j.action] = -1;
      pool.b.action[pool.spec.action_dim + j.action] = 1;
      ASSERT_EQ(rdm_pool_step(pool.p), RDM_OK);
    }
    const std::vector<double> a = pool.q(0), b = pool.q(1);
    int32_t most = i;
    for (int32_t k = 0; k < pool.spec.num_joints; ++k)
      if (info_at(pool.p, k).action >= 0 &&
          std::fabs(b[static_cast<size_t>(k)] - a[static_cast<size_t>(k)]) >
              std::fabs(b[static_cast<size_t>(most)] - a[static_cast<size_t>(most)]))
        most = k;
    EXPECT_EQ(most, i) << j.name << " and " << info_at(pool.p, most).name;
    EXPECT_GT(std::fabs(b[static_cast<size_t>(i)] - a[static_cast<size_t>(i)]), 1e-4) << j.name;
  }
}

TEST_P(Joints, AreWhereTheyWerePut) {
  JointsPool from(GetParam(), 1, 5), to(GetParam(), 2, 5);
  from.play(20);
  const std::vector<double> q = from.q(), qd = from.qd();
  const std::vector<double> other = to.q(0);
  ASSERT_EQ(to.set(q, qd, 1), RDM_OK) << rdm_pool_error(to.p);
  EXPECT_EQ(to.q(1), q);  // floats are doubles
  EXPECT_EQ(to.qd(1), qd);
  EXPECT_EQ(to.q(0), other);

  // one array alone
  ASSERT_EQ(to.set(other, {}, 1), RDM_OK);
  EXPECT_EQ(to.q(1), other);
  EXPECT_EQ(to.qd(1), qd);
  ASSERT_EQ(to.set({}, std::vector<double>(to.n), 1), RDM_OK);
  EXPECT_EQ(to.q(1), other);
  EXPECT_EQ(to.qd(1), std::vector<double>(to.n));
  EXPECT_EQ(rdm_pool_get_joints(to.p, 0, nullptr, nullptr, to.n), RDM_OK);
}

// Links, rows and saved states follow.
TEST_P(Joints, TheWorldFollows) {
  JointsPool from(GetParam(), 1, 5), to(GetParam(), 1, 5), twin(GetParam(), 1, 9);
  from.play(20);
  const bool moves = from.n > 0;
  const std::vector<float> before = to.obs();
  to.play(1);
  ASSERT_EQ(to.set(from.q(), from.qd()), RDM_OK) << rdm_pool_error(to.p);
  // robots that stand on a base that is fixed have the other's poses
  const std::vector<rdm_pose> a = from.poses(), b = to.poses();
  const std::string task = GetParam().task;
  for (int32_t i = 0; i < from.spec.num_shapes && (task == "grasp" || task.rfind("hand_over", 0) == 0); ++i) {
    rdm_shape_info shape = RDM_INIT(rdm_shape_info);
    ASSERT_EQ(rdm_pool_shape_at(from.p, i, &shape), RDM_OK);
    if (std::strncmp(shape.name, "right_", 6) != 0 && std::strncmp(shape.name, "left_", 5) != 0) continue;
    const rdm_pose &at = a[static_cast<size_t>(i)], &there = b[static_cast<size_t>(i)];
    for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(at.p[k], there.p[k], 2e-5) << shape.name;
    for (size_t k = 0; k < 4; ++k) EXPECT_NEAR(at.q[k], there.q[k], 2e-5) << shape.name;
  }
  const std::vector<float> after = to.obs();
  EXPECT_TRUE(!moves || after != before);
  EXPECT_EQ(std::vector<float>(to.b.final_obs, to.b.final_obs + to.spec.obs_dim), after);
  EXPECT_EQ(to.b.reward[0], 0);
  EXPECT_EQ(to.b.status[0], 0u);
  for (const float x : after) EXPECT_TRUE(std::isfinite(x));

  size_t size = 0;
  ASSERT_EQ(rdm_pool_write_state(to.p, 0, nullptr, 0, &size), RDM_OK);
  std::vector<unsigned char> state(size);
  ASSERT_EQ(rdm_pool_write_state(to.p, 0, state.data(), size, &size), RDM_OK);
  ASSERT_EQ(rdm_pool_read_state(twin.p, 0, state.data(), size), RDM_OK) << rdm_pool_error(twin.p);
  EXPECT_EQ(twin.q(), to.q());
  EXPECT_EQ(twin.obs(), after);
  for (int i = 0; i < 10; ++i) {
    for (JointsPool* each : {&to, &twin}) {
      std::fill_n(each->b.action, each->spec.action_dim, 0.25f);
      ASSERT_EQ(rdm_pool_step(each->p), RDM_OK);
    }
    ASSERT_EQ(to.obs(), twin.obs()) << i;
  }
  EXPECT_FALSE(to.b.status[0] & RDM_STATUS_DIVERGED);
}

TEST_P(Joints, WhatNoWorldHasIsRefused) {
  JointsPool pool(GetParam(), 2);
  const size_t n = pool.n;
  std::vector<double> q(n + 1), qd(n + 1);
  EXPECT_EQ(rdm_pool_get_joints(pool.p, 2, q.data(), nullptr, n), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_get_joints(pool.p, -1, q.data(), nullptr, n), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_get_joints(pool.p, 0, q.data(), nullptr, n + 1), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_last_error(),
            "count: it is " + std::to_string(n + 1) + ", but the pool has " + std::to_string(n) + " joints");
  EXPECT_EQ(rdm_pool_set_joints(pool.p, 2, q.data(), nullptr, n), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_set_joints(pool.p, 0, q.data(), nullptr, n + 1), RDM_ERROR_RANGE);
  const uint64_t before = hash_of(pool.p, 0);
  const std::vector<float> row = pool.obs();
  for (size_t i = 0; i < n; ++i) {
    const rdm_joint_info j = info_at(pool.p, static_cast<int32_t>(i));
    const auto named = [&] { return std::string(rdm_last_error()).find(j.name) != std::string::npos; };
    q = pool.q(), qd = pool.qd();
    for (const double bad : {j.lower - 10.1, j.upper + 10.1}) {
      q[i] = bad;
      EXPECT_EQ(pool.set(q, qd), RDM_ERROR_RANGE) << j.name;
      EXPECT_TRUE(named()) << rdm_last_error();
    }
    q[i] = std::numeric_limits<double>::infinity();
    EXPECT_EQ(pool.set(q, qd), RDM_ERROR_ARGUMENT) << j.name;
    EXPECT_TRUE(named()) << rdm_last_error();
    q = pool.q();
    qd[i] = -2e6;
    EXPECT_EQ(pool.set(q, qd), RDM_ERROR_RANGE) << j.name;
    EXPECT_TRUE(named()) << rdm_last_error();
    qd[i] = -std::numeric_limits<double>::infinity();
    EXPECT_EQ(pool.set({}, qd), RDM_ERROR_ARGUMENT) << j.name;
  }
  EXPECT_EQ(hash_of(pool.p, 0), before);
  EXPECT_EQ(pool.obs(), row);
}

TEST_P(Joints, TakeNoMemory) {
  JointsPool pool(GetParam());
  std::vector<double> q(pool.n), qd(pool.n);
  const int64_t heap = heap_count();
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(rdm_pool_get_joints(pool.p, 0, q.data(), qd.data(), pool.n), RDM_OK);
    EXPECT_EQ(rdm_pool_set_joints(pool.p, 0, q.data(), qd.data(), pool.n), RDM_OK);
  }
  EXPECT_EQ(heap_count(), heap);
}

// Not even a little beyond where ends are hard; where hands have them, as far as they give way.
TEST(JointLimits, EndWhereTheyGiveWay) {
  JointsPool pool({"hand_over_safe_finger", ""});
  std::vector<double> q = pool.q();
  const rdm_joint_info j = info_at(pool.p, 3);
  q[3] = j.upper + 0.004;
  EXPECT_EQ(pool.set(q, {}), RDM_OK) << rdm_last_error();
  q[3] = j.upper + 0.006;
  EXPECT_EQ(pool.set(q, {}), RDM_ERROR_RANGE);
  EXPECT_NE(std::string(rdm_last_error()).find(std::string("of joint ") + j.name + " is outside ["),
            std::string::npos)
      << rdm_last_error();
}

TEST(JointLimits, OnlyOfAnEpisodeThatRuns) {
  const Case test = {"hand_over_safe_finger", "max_steps=3"};
  rdm_pool_config c = pool_config(1);
  c.settings = test.settings;
  rdm_pool* fresh = make_pool(c);
  std::vector<double> q(48);
  EXPECT_EQ(rdm_pool_set_joints(fresh, 0, q.data(), nullptr, 48), RDM_ERROR_STATE);
  EXPECT_STREQ(rdm_last_error(), "set_joints: world 0 was not reset yet");
  EXPECT_EQ(rdm_pool_get_joints(fresh, 0, q.data(), nullptr, 48), RDM_OK);
  rdm_pool_destroy(fresh);
  JointsPool pool(test, 1, 0, RDM_AUTORESET_OFF);
  pool.play(3);
  ASSERT_EQ(pool.b.truncated[0], 1);
  EXPECT_EQ(pool.set(pool.q(), {}), RDM_ERROR_STATE);
  EXPECT_STREQ(rdm_last_error(), "set_joints: world 0 has ended its episode; reset it first");
  EXPECT_EQ(pool.b.truncated[0], 1);
}

// A tendon leads it: NaN is where to, and what is off is drawn back.
TEST(CoupledJoints, FollowTheJointThatLeadsThem) {
  int32_t robot = -1;
  ASSERT_EQ(rdm_robot_find("shadow_hand", &robot), RDM_OK);
  rdm_robot_coupling c{};
  ASSERT_EQ(rdm_robot_coupling_at(robot, 0, &c), RDM_OK);
  for (const char* engine : {"engine=articulated", "engine=ode"}) {
    SCOPED_TRACE(engine);
    JointsPool pool({"hand_over_safe_finger", engine});
    const auto i = static_cast<size_t>(c.link), lead = static_cast<size_t>(c.other);
    const rdm_joint_info j = info_at(pool.p, c.link);
    EXPECT_EQ(j.kp, 0);
    EXPECT_EQ(j.action, -1);
    std::vector<double> q = pool.q(), qd(pool.n);
    q[lead] = 0.6, qd[lead] = 1.5;
    q[i] = qd[i] = kNan;
    ASSERT_EQ(pool.set(q, qd), RDM_OK) << rdm_last_error();
    EXPECT_NEAR(pool.q()[i], std::min(c.ratio * 0.6, j.upper), 1e-6);
    EXPECT_NEAR(pool.qd()[i], c.ratio * 1.5, 1e-5);
    q[i] = j.upper;
    qd.assign(pool.n, 0);
    ASSERT_EQ(pool.set(q, qd), RDM_OK);
    ASSERT_GT(std::fabs(pool.q()[i] - c.ratio * pool.q()[lead]), c.slack + 0.3);
    ASSERT_EQ(rdm_pool_baseline(pool.p, RDM_BASELINE_HOLD), RDM_OK);
    for (int k = 0; k < 30; ++k) ASSERT_EQ(rdm_pool_step(pool.p), RDM_OK);
    EXPECT_LT(std::fabs(pool.q()[i] - c.ratio * pool.q()[lead]), c.slack + 0.03);
    q[lead] = kNan;
    EXPECT_EQ(pool.set(q, {}), RDM_ERROR_ARGUMENT);
  }
}

TEST(RobotJoints, AreThoseOfTheDescription) {
  for (int32_t r = 0; r < rdm_robot_count(); ++r) {
    rdm_robot robot{};
    robot.struct_size = sizeof robot;
    if (rdm_robot_at(r, &robot) != RDM_OK) continue;
    rdm_joint_info j = RDM_INIT(rdm_joint_info);
    for (int32_t i = 0; i < robot.num_joints; ++i) {
      ASSERT_EQ(rdm_robot_joint_at(r, i, &j), RDM_OK) << rdm_last_error();
      rdm_robot_link link;
      ASSERT_EQ(rdm_robot_link_at(r, i, &link), RDM_OK);
      EXPECT_STREQ(j.name, link.joint);
      EXPECT_EQ(j.lower, link.lower);
      EXPECT_EQ(j.upper, link.upper);
      EXPECT_EQ(j.kd, link.kd);
      EXPECT_EQ(j.effort, link.effort);
      EXPECT_EQ(j.kind, link.kind);
      EXPECT_EQ(j.parent, link.parent);
      EXPECT_TRUE(link.velocity > 0 ? j.velocity == link.velocity : std::isnan(j.velocity));
    }
    EXPECT_EQ(rdm_robot_joint_at(r, robot.num_joints, &j), RDM_ERROR_RANGE);
  }
}

// Of two robots, row after row: what the robot says of each, and parents among the scene's rows.
TEST(SceneJoints, AreThoseOfItsRobots) {
  rdm::test::CalledTask task("joints_of_scene");
  int32_t built = 0;
  task.build = [&](rdm_scene* scene) {
    std::vector<std::pair<std::string, rdm_joint_info>> wanted;
    for (const char* name : {"shadow_hand", "ur5e"}) {
      rdm_scene_robot row;
      rdm_scene_robot_init(&row, sizeof row);
      row.name = name, row.pose.p[0] = 2.0 * static_cast<double>(wanted.size());
      if (const rdm_result r = rdm_robot_find(name, &row.robot)) return r;
      if (const rdm_result r = rdm_scene_add_robot(scene, &row, nullptr)) return r;
      const auto first = static_cast<int32_t>(wanted.size());
      rdm_joint_info j = RDM_INIT(rdm_joint_info);
      for (int32_t i = 0; rdm_robot_joint_at(row.robot, i, &j) == RDM_OK; ++i) {
        if (j.parent >= 0) j.parent += first;
        wanted.emplace_back(std::string(name) + '_' + j.name, j);
      }
    }
    EXPECT_EQ(wanted.size(), 30u);
    rdm_joint_info j = RDM_INIT(rdm_joint_info);
    int32_t i = 0;
    for (const auto& [name, w] : wanted) {
      if (const rdm_result r = rdm_scene_joint_at(scene, i++, &j)) return r;
      EXPECT_EQ(j.name, name);
      EXPECT_EQ(j.kind, w.kind) << name;
      EXPECT_EQ(j.parent, w.parent) << name;
      EXPECT_EQ(j.action, w.action) << name;
      EXPECT_EQ(j.lower, w.lower) << name;
      EXPECT_EQ(j.upper, w.upper) << name;
      EXPECT_TRUE(j.velocity == w.velocity || (std::isnan(j.velocity) && std::isnan(w.velocity))) << name;
      EXPECT_EQ(j.kp, w.kp) << name;
    }
    EXPECT_EQ(rdm_scene_joint_at(scene, i, &j), RDM_ERROR_RANGE);
    EXPECT_EQ(rdm_scene_joint_at(scene, 0, nullptr), RDM_ERROR_ARGUMENT);
    ++built;
    return rdm_result{RDM_OK};
  };
  rdm_pool_config c = pool_config(1);
  c.task = "joints_of_scene";
  rdm_pool_destroy(make_pool(c));
  EXPECT_GT(built, 0);
}

// A function of a host's own that fails, when it is asked for the new row.
TEST(JointsOfOwnTask, ObserveMayFail) {
  rdm::test::CalledTask task("joints_own");
  bool fails = false;
  task.observe = [&](const rdm_world*) {
    return fails ? rdm_fail(RDM_ERROR_IO, "the sensor is lost") : rdm_result{RDM_OK};
  };
  JointsPool pool({"joints_own", ""});
  pool.play(2);
  const std::vector<float> row = pool.obs();
  EXPECT_EQ(pool.set({}, {}), RDM_OK);
  fails = true;
  EXPECT_EQ(pool.set({}, {}), RDM_ERROR_IO);
  EXPECT_NE(std::string(rdm_last_error()).find("the sensor is lost"), std::string::npos);
  EXPECT_STREQ(rdm_pool_world_error(pool.p, 0), rdm_last_error());
  EXPECT_EQ(pool.obs(), row);
  EXPECT_EQ(pool.b.final_obs[0], row[0]);
  fails = false;
  EXPECT_EQ(pool.set({}, {}), RDM_OK);
}

}  // namespace
