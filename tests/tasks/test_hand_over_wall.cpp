#include <cmath>

#include "tasks/catalog.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

constexpr const char* kTask = "hand_over_wall";
constexpr const char* kEngines[] = {"ode", "articulated"};
enum : int { kCost, kObject, kHand, kHeight };

class HandOverWallTask : public testing::Test {
 protected:
  void SetUp() override { register_builtin_tasks(); }

  struct Shot {
    int costs = 0, contacts = 0;
    double end_y = 0, most_y = 9;  // most: the furthest to -y
  };
  // A ball from (x, -0.35, z) at 2 m/s to -y, gravity off, 20 steps.
  static Shot shoot(std::vector<OptionInput> options, double x, double z = 0.65) {
    options.push_back({"gravity", nullptr, 0});
    options.push_back({"object", "ball", 0});
    TestPool p(kTask, 1, options);
    p->reset(nullptr, nullptr);
    Motion m;
    m.X.p = {x, -0.35, z};
    m.v = {0, -2, 0};
    p->world(0).set_body(0, m);
    Shot s;
    for (int t = 0; t < 20; ++t) {
      p->baseline(Baseline::kZero);
      p->step(nullptr);
      s.costs += p.cost(0)[kCost] > 0;
      s.contacts += p.cost(0)[kObject] > 0;
      s.most_y = std::min(s.most_y, p->world(0).body(0).X.p.y);
    }
    s.end_y = p->world(0).body(0).X.p.y;
    return s;
  }
};

TEST_F(HandOverWallTask, Dimensions) {
  TestPool p(kTask, 1);
  EXPECT_EQ(p->obs_dim(), 398);
  EXPECT_EQ(p->task().action_dim(), 40);
  EXPECT_EQ(p->cost_dim(), 4);
  EXPECT_EQ(p->task().max_steps(), 75);
  EXPECT_EQ(p->task().scene().def.statics.size(), 5u);
  p->reset(nullptr, nullptr);
  EXPECT_EQ(p.obs(0)[388], -0.66f);
  // tips 2.5 cm from the wall on both sides
  EXPECT_NEAR(p->world(0).base(1).X.p.y, -1.05, 1e-12);
}

// A ball shot level through the middle of the hole.
TEST_F(HandOverWallTask, AShotThroughTheHoleCostsNothing) {
  for (const char* engine : kEngines) {
    const Shot s = shoot({{"engine", engine, 0}}, 0);
    EXPECT_EQ(s.costs, 0) << engine;
    EXPECT_LT(s.end_y, -0.9) << engine;
  }
}

TEST_F(HandOverWallTask, AShotAtTheWallCostsAndIsDeflected) {
  for (const char* engine : kEngines) {
    const Shot s = shoot({{"engine", engine, 0}}, 0.15);
    EXPECT_GT(s.costs, 0) << engine;
    EXPECT_EQ(s.costs, s.contacts);
    EXPECT_GT(s.most_y, -0.525) << engine;
  }
}

// Fast objects too: the wall is thicker than the way of a substep.
TEST_F(HandOverWallTask, SizesAreOptions) {
  EXPECT_GT(shoot({{"wall.hole.width", nullptr, 0.06}}, 0).costs, 0);
  EXPECT_EQ(shoot({{"wall.hole.width", nullptr, 0.5}}, 0.15).costs, 0);
  EXPECT_EQ(shoot({{"wall.hole.x", nullptr, 0.15}}, 0.15).costs, 0);
  EXPECT_GT(shoot({{"wall.hole.z", nullptr, 0.9}}, 0).costs, 0);
}

TEST_F(HandOverWallTask, LiteralIsAGhostWithASlabTest) {
  const std::vector<OptionInput> literal = {{"cost_mode", "literal", 0}};
  const Shot middle = shoot(literal, 0), side = shoot(literal, 0.3), high = shoot(literal, 0.2, 0.75);
  EXPECT_EQ(middle.costs, 0);
  EXPECT_LT(side.end_y, -0.9);
  EXPECT_EQ(side.contacts, 0);
  EXPECT_GE(side.costs, 0);  // 3.3 cm a step may skip 3 cm unseen
  EXPECT_LE(side.costs, 1);
  EXPECT_LE(high.costs, 1);
  TestPool p(kTask, 1, {{"cost_mode", "literal", 0}, {"gravity", nullptr, 0}});
  p->reset(nullptr, nullptr);
  const auto cost = [&](double x, double y, double z) {
    Motion m;
    m.X.p = {x, y, z};
    p->world(0).set_body(0, m);
    p->baseline(Baseline::kZero);
    p->step(nullptr);
    return p.cost(0)[kCost];
  };
  EXPECT_EQ(cost(0.26, -0.525, 0.65), 1);
  EXPECT_EQ(cost(0.24, -0.525, 0.65), 0);
  EXPECT_EQ(cost(0, -0.525, 0.71), 1);
  EXPECT_EQ(cost(0, -0.525, 0.59), 1);
  EXPECT_EQ(cost(0.26, -0.545, 0.65), 0);
  TestPool solid(kTask, 1, {{"cost_mode", "literal", 0}, {"wall", "solid", 0}});
  EXPECT_TRUE(solid->task().scene().def.statics[1].collides);
  EXPECT_FALSE(p->task().scene().def.statics[1].collides);
}

TEST_F(HandOverWallTask, HandsCountWhenAskedTo) {
  for (const char* count : {"false", "true"}) {
    TestPool p(kTask, 1,
               {{"count_hands", count, 0},
                {"start.x", nullptr, 0.8},
                {"fall_height", nullptr, -10},
                {"joint_noise", nullptr, 0},
                {"wall.y", nullptr, -0.49}});  // in the fingertips' way
    p->reset(nullptr, nullptr);
    int hand = 0, cost = 0;
    for (int t = 0; t < 40; ++t) {
      p->baseline(Baseline::kHold);
      p.action(0)[1] = 1;
      p->step(nullptr);
      hand += p.cost(0)[kHand] > 0;
      cost += p.cost(0)[kCost] > 0;
    }
    EXPECT_GT(hand, 0);
    EXPECT_EQ(cost, *count == 't' ? hand : 0);
  }
}

TEST_F(HandOverWallTask, FallsAtItsOwnHeight) {
  TestPool p(kTask, 1);
  p->reset(nullptr, nullptr);
  Motion m;
  m.X.p = {0.7, -0.3, 0.25};
  p->world(0).set_body(0, m);
  p->step(nullptr);
  while (!p.ended(0)) p->step(nullptr);
  EXPECT_TRUE(p.rows().terminated[0]);
  EXPECT_LE(p.final_obs(0)[376], 0.1f);
}

}  // namespace
}  // namespace rdm::test
