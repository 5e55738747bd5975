#include <cmath>

#include "prop_tasks.hpp"

namespace rdm::test {
namespace {

constexpr const char* kTask = "pick_bottles";
enum : int { kCost, kHandBottle, kBottleBottle, kTipped };

class PickBottles : public testing::Test {
 protected:
  void SetUp() override { register_builtin_tasks(); }
  static void place(TestPool& p, int32_t body, const Vec3& at, const Quat& q = {}) {
    p->world(0).set_body(body, {{at, q}, {}, {}});
  }
};

TEST_F(PickBottles, Layout) {
  TestPool p(kTask, 1, {{"reset_noise", nullptr, 0}});
  EXPECT_EQ(p->obs_dim(), 424);
  EXPECT_EQ(p->cost_dim(), 4);
  EXPECT_EQ(p->task().max_steps(), 250);
  expect_hand_fields(p->task());
  EXPECT_EQ(offset_of(p->task(), "left_bottle.position"), 398);
  EXPECT_EQ(offset_of(p->task(), "left_bottle.velocity"), 405);
  EXPECT_EQ(offset_of(p->task(), "right_bottle.position"), 411);
  p->reset(nullptr, nullptr);
  EXPECT_NEAR(p.obs(0)[399], -0.5f, 1e-6f);
  EXPECT_NEAR(p.obs(0)[412], -0.7f, 1e-6f);
}

// The start pose holds for an episode: no bottle moves, none is touched, -(d_left + d_right) is the reward.
TEST_F(PickBottles, HoldingStillCostsNothing) {
  for (const char* engine : kEngines) {
    TestPool p(kTask, 1, with_engine(engine));
    p->reset(nullptr, nullptr);
    const auto start = places(p->world(0));
    for (int t = 1; t < 250; ++t) {
      run(p, Baseline::kHold, 1);
      EXPECT_EQ(p.cost(0)[kCost], 0);
      EXPECT_FALSE(p.ended(0)) << t;
      EXPECT_NEAR(static_cast<double>(p.rows().reward[0]), -0.14, 0.02);
      EXPECT_LT(moved(p->world(0), start), 2e-3);
    }
    run(p, Baseline::kHold, 1);
    EXPECT_TRUE(p.rows().truncated[0]);
  }
}

TEST_F(PickBottles, TheSourcesRewardAtTheStart) {
  for (const char* left : {"mirror", "right_copy"}) {
    TestPool p(kTask, 1, {{"reward", "fingers", 0}, {"left_model", left, 0}});
    p->reset(nullptr, nullptr);
    run(p, Baseline::kHold, 1);
    EXPECT_NEAR(static_cast<double>(p.rows().reward[0]), -1.27 + 0.05, 0.02) << left;
  }
}

TEST_F(PickBottles, LiftingBothPays) {
  TestPool p(kTask, 1, {{"gravity", nullptr, 0}, {"palm_limit", nullptr, 10}});
  p->reset(nullptr, nullptr);
  const double rest = p->world(0).body(0).X.p.z;
  const auto reward = [&](double right, double left) {
    place(p, 0, {0.6, -0.7, rest + right});
    place(p, 1, {0.6, -0.5, rest + left});
    run(p, Baseline::kHold, 1);
    return static_cast<double>(p.rows().reward[0]);
  };
  const double none = reward(0, 0);
  EXPECT_NEAR(reward(0.1, 0) - none, 0, 0.03);  // the palm's way changes a little
  EXPECT_FALSE(p.rows().success[0]);
  EXPECT_NEAR(reward(0.1, 0.1) - none, 2, 0.05);
  EXPECT_TRUE(p.rows().success[0]);
}

TEST_F(PickBottles, EndsByFallByPalmAndByFingers) {
  const auto ends = [](std::vector<OptionInput> options, int32_t body, const Vec3& at) {
    TestPool p(kTask, 1, options);
    p->reset(nullptr, nullptr);
    if (body >= 0) place(p, body, at);
    run(p, Baseline::kHold, 1);
    return p.rows().terminated[0] != 0;
  };
  EXPECT_FALSE(ends({}, -1, {}));
  EXPECT_TRUE(ends({}, 4, {0.5, -0.4, 0.44}));
  EXPECT_TRUE(ends({}, 0, {0.3, -0.7, 0.6}));
  EXPECT_TRUE(ends({{"palm_limit", nullptr, 0.05}}, -1, {}));
  EXPECT_TRUE(ends({{"finger_limit", nullptr, 0.6}}, -1, {}));
  EXPECT_FALSE(ends({{"finger_limit", nullptr, 0.7}}, -1, {}));
}

TEST_F(PickBottles, EveryContactThatCosts) {
  TestPool p(kTask, 1,
             {{"gravity", nullptr, 0}, {"palm_limit", nullptr, 10}, {"finger_limit", nullptr, 100}});
  p->reset(nullptr, nullptr);
  const Vec3 start[] = {p->world(0).body(0).X.p, p->world(0).body(1).X.p, p->world(0).body(2).X.p};
  const auto cost = [&](int column) {
    run(p, Baseline::kHold, 1);
    return p.cost(0)[column];
  };
  EXPECT_EQ(cost(kCost), 0);
  place(p, 0, start[0] + Vec3{0, -0.025, 0});  // bottle 2 in bottle 1
  EXPECT_EQ(cost(kBottleBottle), 1);
  EXPECT_EQ(p.cost(0)[kCost], 1);
  EXPECT_EQ(p.cost(0)[kHandBottle], 0);
  place(p, 0, {0.5, -0.7, 0.8});
  place(p, 2, start[2]);
  EXPECT_EQ(cost(kCost), 0);
  place(p, 1, {0.5, -0.625, 0.8});  // 4 in 2
  EXPECT_EQ(cost(kBottleBottle), 1);
  place(p, 1, start[1]);
  EXPECT_EQ(cost(kCost), 0);
  place(p, 2, p->world(0).link(1).X.p + Vec3{0, 0, 0.05});  // bottle 1 in the right palm
  EXPECT_EQ(cost(kHandBottle), 1);
  EXPECT_EQ(p.cost(0)[kCost], 1);
  place(p, 2, {0.8, 0, 0.8}, axis_angle({1, 0, 0}, 0.6));
  EXPECT_EQ(cost(kTipped), 1);
  // a hand may touch the bottle that it is to take
  place(p, 0, p->world(0).link(1).X.p + Vec3{0, 0, 0.05});
  EXPECT_EQ(cost(kHandBottle), 0);
}

TEST_F(PickBottles, TheSourcesCostIsALane) {
  for (const char* mode : {"literal", "lane"}) {
    TestPool p(kTask, 1, {{"gravity", nullptr, 0}, {"cost_mode", mode, 0}});
    p->reset(nullptr, nullptr);
    const Vec3 at = p->world(0).body(0).X.p;
    const auto cost = [&](double y, double angle) {
      place(p, 0, at + Vec3{0.05, y, 0.05}, axis_angle({1, 0, 0}, angle));
      run(p, Baseline::kHold, 1);
      return p.cost(0)[kCost];
    };
    EXPECT_EQ(cost(0.029, 0), 0);
    EXPECT_EQ(cost(0.031, 0), 1);
    EXPECT_EQ(cost(0, 0.15), 0);
    EXPECT_EQ(cost(0, 0.25), 1);  // the cap is 0.037 m aside
  }
}

TEST_F(PickBottles, FixedNeighboursStay) {
  TestPool p(kTask, 1, {{"fixed_neighbours", "true", 0}});
  EXPECT_EQ(p->task().scene().num_bodies, 2);
  EXPECT_EQ(p->obs_dim(), 424);
  p->reset(nullptr, nullptr);
  place(p, 0, p->world(0).body(0).X.p + Vec3{0, -0.025, 0});
  run(p, Baseline::kHold, 1);
  EXPECT_EQ(p.cost(0)[kBottleBottle], 1);
}

TEST_F(PickBottles, ResetNoiseMovesEachBottleItsOwnWay) {
  TestPool p(kTask, 1, {{"reset_noise", nullptr, 0.004}});
  p->reset(nullptr, nullptr);
  const Scene& s = p->task().scene();
  const auto way = [&](size_t i) {
    return p->world(0).body(static_cast<int32_t>(i)).X.p - s.def.bodies[i].X_WB.p;
  };
  for (size_t i = 0; i < 5; ++i) {
    EXPECT_LE(std::fabs(way(i).x), 0.004);
    EXPECT_GT(norm(way(i)), 0);
  }
  EXPECT_GT(norm(way(0) - way(1)), 1e-6);
}

}  // namespace
}  // namespace rdm::test
