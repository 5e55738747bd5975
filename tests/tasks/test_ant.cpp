// The ant, MuJoCo's and Bullet's.
#include <algorithm>
#include <cmath>
#include <string>

#include "small_world.hpp"
#include "tasks/bullet/ant.hpp"

namespace rdm::test {
namespace {

const ArticulationDef& robot_of(SmallWorld& w) {
  return w.pool()->task().scene().def.articulations[0];
}

TEST(Ant, WeighsWhatItShould) {
  for (const char* task : {"ant_velocity", "ant_run"}) {
    SmallWorld w(task);
    double mass = robot_of(w).base.mass;
    for (const LinkDef& link : robot_of(w).links) mass += link.inertia.mass;
    EXPECT_NEAR(mass, 0.91088, 1e-4);
  }
}

TEST(Ant, RowsAreAsLongAsPublished) {
  const std::pair<const char*, int> rows[] = {
      {"ant_velocity", 111}, {"ant_run", 33}, {"ant_circle", 34}, {"ant_gather", 65}, {"ant_reach", 83}};
  for (const auto& [task, count] : rows) EXPECT_EQ(SmallWorld(task).pool()->obs_dim(), count) << task;
}

TEST(Ant, StandsWithoutAnAction) {
  for (const char* task : {"ant_velocity", "ant_run", "ant_gather", "ant_reach"}) {
    SmallWorld w(task);
    for (int i = 0; i < 200; ++i) {
      w.step({0, 0, 0, 0, 0, 0, 0, 0});
      ASSERT_FALSE(w.terminated()) << task << " " << i;
    }
    const Motion& base = w.pool()->world(0).base(0);
    EXPECT_LT(norm(base.v), 0.02) << task;
    EXPECT_GT(base.X.p.z, 0.3) << task;
  }
}

TEST(Ant, VelocityIsPaidByTheFormula) {
  SmallWorld w("ant_velocity");
  double contacts = 0;
  for (int i = 0; i < 200; ++i) {
    const Vec3 from = w.pool()->world(0).base(0).X.p;
    w.pool()->baseline(Baseline::kRandom);
    double effort = 0, squares = 0;
    for (int k = 0; k < 8; ++k) effort += std::pow(static_cast<double>(w.pool().action(0)[k]), 2);
    w.pool()->step(nullptr);
    if (w.terminated()) continue;
    for (int k = 27; k < 111; ++k) {
      const double f = static_cast<double>(w.obs(k));
      ASSERT_LE(std::fabs(f), 1);
      squares += f * f;
    }
    const Vec3 d = w.pool()->world(0).base(0).X.p - from;
    ASSERT_NEAR(static_cast<double>(w.reward()), d.x / 0.05 + 1 - 0.5 * effort - 5e-4 * squares, 1e-4);
    ASSERT_EQ(w.cost(), std::hypot(d.x, d.y) / 0.05 > 2.6222);
    contacts += squares;
  }
  EXPECT_GT(contacts, 0);
}

// The same actions in MuJoCo 2.2.2 on the published model, for 0.3 s: height, quaternion, joints.
TEST(Ant, MovesAsInMuJoCo) {
  SmallWorld w("ant_velocity", {{"reset_noise", nullptr, 0}});
  for (int k = 0; k < 6; ++k) {
    for (int j = 0; j < 8; ++j) w.pool().action(0)[j] = static_cast<float>(0.3 * ((3 * j) % 5 - 2) / 2);
    w.pool()->step(nullptr);
  }
  const double rows[] = {0.62955,  0.99676,  -0.00365, -0.00425, 0.08018, -0.53345, 1.22267,
                         -0.00143, -1.22272, 0.53249,  -1.22235, -0.5253, 1.22235};
  for (int i = 0; i < 13; ++i) EXPECT_NEAR(static_cast<double>(w.obs(i)), rows[i], 0.02) << i;
}

// Gymnasium's motors begin with the last leg.
TEST(Ant, OrderIsGymnasiumsOrOurs) {
  SmallWorld theirs("ant_velocity", {{"reset_noise", nullptr, 0}}),
      ours("ant_velocity", {{"reset_noise", nullptr, 0}, {"order", "redman", 0}});
  EXPECT_NE(theirs.pool()->task().action_order(), ours.pool()->task().action_order());
  for (int i = 0; i < 20; ++i) {
    theirs.step({0.4f, -0.3f, 0.1f, 0.2f, -0.1f, 0.3f, 0.2f, -0.4f});
    ours.step({0.1f, 0.2f, -0.1f, 0.3f, 0.2f, -0.4f, 0.4f, -0.3f});
    for (int k = 0; k < 27; ++k) ASSERT_EQ(theirs.obs(k), ours.obs(k)) << k;
  }
  // the world's row
  for (int k = 27; k < 33; ++k) EXPECT_EQ(theirs.obs(k), 0);
  float felt = 0;
  for (int k = 27; k < 33; ++k) felt += std::fabs(ours.obs(k));
  EXPECT_GT(felt, 0);
}

TEST(Ant, RunIsPaidByTheWayAndItsEffort) {
  SmallWorld w("ant_run");
  for (int i = 0; i < 200; ++i) {
    const Vec3 from = w.pool()->world(0).base(0).X.p;
    w.pool()->baseline(Baseline::kRandom);
    double action[8];
    for (int k = 0; k < 8; ++k) action[k] = static_cast<double>(w.pool().action(0)[k]);
    w.pool()->step(nullptr);
    if (w.terminated()) continue;
    const World& world = w.pool()->world(0);
    const Vec3 at = world.base(0).X.p;
    double power = 0, square = 0, ends = 0;
    for (int k = 0; k < 8; ++k) {
      power += std::fabs(action[k] * 0.1 * world.qd()[k]) / 8;
      square += action[k] * action[k] / 8;
      ends += std::fabs(static_cast<double>(w.obs(13 + 2 * k))) > 0.5 * 0.99;
    }
    const double gain = std::hypot(1000 - from.x, from.y) - std::hypot(1000 - at.x, at.y);
    ASSERT_NEAR(static_cast<double>(w.reward()), 60 * gain - 2 * power - 0.1 * square - 0.1 * ends + 1, 2e-3);
    const Vec3 v = world.base(0).v;
    ASSERT_EQ(w.cost(), std::hypot(v.x, v.y) > 1.5 || std::fabs(at.y) > 2);
  }
}

// High above the floor nothing outside pushes it sideways, however hard its motors drive the legs into their
// stops: its momentum stays.
TEST(Ant, StopsOfItsJointsPushItNowhere) {
  for (const char* task : {"ant_run", "ant_reach"}) {
    SmallWorld w(task);
    World& world = w.pool()->world(0);
    const ArticulationDef& robot = robot_of(w);
    Motion m = world.base(0);
    m.X.p.z = 100;
    m.v = m.w = {};
    world.set_base(0, m);
    double fastest = 0, mass = robot.base.mass;
    for (const LinkDef& link : robot.links) mass += link.inertia.mass;
    for (int i = 0; i < 200 && !w.terminated(); ++i) {
      if (i % 20 == 0) w.pool()->baseline(Baseline::kRandom);
      for (int k = 0; k < 8; ++k) w.pool().action(0)[k] = w.pool().action(0)[k] < 0 ? -1.0f : 1.0f;
      w.pool()->step(nullptr);
      if (i % 20 < 19) continue;  // until the legs lie still at their stops
      Vec3 momentum;
      for (int32_t k = -1; k < 8; ++k) {
        const Motion& part = k < 0 ? world.base(0) : world.link(k);
        const Inertia& inertia = k < 0 ? robot.base : robot.links[static_cast<size_t>(k)].inertia;
        momentum += inertia.mass * (part.v + cross(part.w, rotate(part.X.q, inertia.com)));
      }
      fastest = std::max(fastest, std::hypot(momentum.x, momentum.y) / mass);
    }
    EXPECT_LT(fastest, 1e-3) << task;
  }
}

// A foot reads 1 where its leg touched the floor.
TEST(Ant, FeetFeelTheFloor) {
  SmallWorld w("ant_run");
  for (int k = 29; k < 33; ++k) EXPECT_EQ(w.obs(k), 0);
  for (int i = 0; i < 100; ++i) w.step({0, 0, 0, 0, 0, 0, 0, 0});
  float standing = 0;  // legs of drawn bends: three carry it
  for (int k = 29; k < 33; ++k) standing += w.obs(k);
  EXPECT_GE(standing, 3);
}

TEST(Ant, TheBoxOfReachPushesIt) {
  SmallWorld w("ant_reach", {{"max_steps", nullptr, 3000}});
  World& world = w.pool()->world(0);
  for (int i = 0; i < 60; ++i) w.step({0, 0, 0, 0, 0, 0, 0, 0});
  EXPECT_EQ(w.cost(2), 0);
  // into the circle of the box
  Motion m = world.base(0);
  const Vec3 box = w.body(0);
  m.X.p = {box.x + 0.9, box.y, m.X.p.z};
  m.v = m.w = {};
  world.set_base(0, m);
  bool hit = false;
  for (int i = 0; i < 400 && !w.terminated(); ++i) {
    w.step({0, 0, 0, 0, 0, 0, 0, 0});
    hit |= w.cost(2) > 0;
  }
  EXPECT_TRUE(hit);
}

}  // namespace
}  // namespace rdm::test
