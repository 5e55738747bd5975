#include <cmath>

#include "prop_tasks.hpp"

namespace rdm::test {
namespace {

constexpr const char* kTask = "jenga";
enum : int { kCost, kMoved, kContact, kFall };
constexpr OptionInput kNominal = {"reset_noise", nullptr, 0};

class Jenga : public testing::Test {
 protected:
  void SetUp() override { register_builtin_tasks(); }
};

TEST_F(Jenga, Layout) {
  TestPool p(kTask, 1);
  EXPECT_EQ(p->obs_dim(), 411);
  EXPECT_EQ(p->cost_dim(), 4);
  EXPECT_EQ(p->task().max_steps(), 250);
  expect_hand_fields(p->task());
  EXPECT_EQ(offset_of(p->task(), "target.position"), 398);
  EXPECT_EQ(offset_of(p->task(), "target.rotation"), 401);
  EXPECT_EQ(offset_of(p->task(), "target.velocity"), 405);
  EXPECT_EQ(offset_of(p->task(), "target.spin"), 408);
  TestPool wide(kTask, 1, {{"extended_obs", "true", 0}});
  EXPECT_EQ(wide->obs_dim(), 459);
  wide->reset(nullptr, nullptr);
  EXPECT_EQ(wide.obs(0)[458], static_cast<float>(wide->world(0).body(16).X.p.z));
}

// The tower stands for an episode; 0.5 mm deeper than at first is what a contact is allowed.
TEST_F(Jenga, TheTowerStandsStill) {
  for (const char* preset : {"redman", "real"}) {
    TestPool p(kTask, 1, with_engine("articulated", {{"preset", preset, 0}}));
    p->reset(nullptr, nullptr);
    const auto start = places(p->world(0));
    for (int t = 1; t < 250; ++t) {
      run(p, Baseline::kHold, 1);
      EXPECT_EQ(p.cost(0)[kCost], 0);
      EXPECT_LT(moved(p->world(0), start), 1e-3) << preset << t;
      if (t == 1 && same_name(preset, "redman")) {
        EXPECT_NEAR(static_cast<double>(p.rows().reward[0]), -0.029, 0.005);
      }
    }
    EXPECT_FALSE(p.ended(0));
    run(p, Baseline::kHold, 1);
    EXPECT_TRUE(p.rows().truncated[0]);
  }
}

TEST_F(Jenga, NothingIsInsideAnythingAtTheStart) {
  for (const char* left : {"mirror", "right_copy"})
    for (const char* preset : {"redman", "real"}) {
      TestPool p(kTask, 1, {{"left_model", left, 0}, {"preset", preset, 0}, kNominal});
      p->reset(nullptr, nullptr);
      for (int32_t b = 0; b < 17; ++b) EXPECT_LT(p->world(0).body_overlap(b), 5.1e-4) << left << preset << b;
    }
}

TEST_F(Jenga, TheRewardPaysThePushAndTheTouch) {
  TestPool p(kTask, 1, {{"gravity", nullptr, 0}, kNominal});
  p->reset(nullptr, nullptr);
  const auto reward_at = [&](double y) {
    Motion m = p->world(0).body(0);
    m.X.p = {0.3, -0.6 + y, 1};
    m.v = m.w = {};
    p->world(0).set_body(0, m);
    p->baseline(Baseline::kHold);
    p->step(nullptr);
    const Vec3 tip = p->world(0).link(9).X * Vec3{0, 0, 0.02}, end = Vec3{0.3, -0.68 + y, 1};
    return static_cast<double>(p.rows().reward[0]) + norm(tip - end);
  };
  EXPECT_NEAR(reward_at(0), 0, 1e-4);
  EXPECT_FALSE(p.rows().success[0]);
  EXPECT_NEAR(reward_at(0.16), 4.8, 1e-4);
  EXPECT_TRUE(p.rows().success[0]);
  EXPECT_NEAR(reward_at(0.5), 9, 1e-4);  // bounded at 0.3 m
  EXPECT_NEAR(reward_at(-0.1), -3, 1e-4);
}

// Cost of the step after block 5 was put `way` aside, by mode.
double cost_after(const char* mode, double way, int blocks) {
  TestPool p(kTask, 1, {{"gravity", nullptr, 0}, {"cost_mode", mode, 0}, kNominal});
  p->reset(nullptr, nullptr);
  for (int32_t b = 1; b <= blocks; ++b) {
    Motion m = p->world(0).body(b);
    m.X.p.x += way;
    p->world(0).set_body(b, m);
  }
  run(p, Baseline::kHold, 1);
  return static_cast<double>(p.cost(0)[kCost]);
}

TEST_F(Jenga, EveryCostMode) {
  EXPECT_EQ(cost_after("default", 0.009, 1), 0);
  EXPECT_EQ(cost_after("default", 0.011, 1), 1);
  EXPECT_EQ(cost_after("any", 0.011, 1), 1);
  EXPECT_EQ(cost_after("paper", 0.011, 15), 0);
  EXPECT_EQ(cost_after("paper", 0.002, 16), 1);
  EXPECT_EQ(cost_after("all", 0.002, 16), 1);
  EXPECT_EQ(cost_after("literal", 0.012, 16), 0);
  EXPECT_EQ(cost_after("sum", 0.018, 16), 1);
  EXPECT_EQ(cost_after("contact", 0.018, 1), 0);
}

TEST_F(Jenga, ColumnsOfContactAndFall) {
  TestPool p(kTask, 1, {{"cost_mode", "contact", 0}, kNominal});
  p->reset(nullptr, nullptr);
  run(p, Baseline::kHold, 1);
  EXPECT_EQ(p.cost(0)[kContact], 0);
  Motion m;
  m.X.p = p->world(0).link(9).X.p + Vec3{0, 0, 0.02};  // in the right middle finger
  p->world(0).set_body(7, m);
  run(p, Baseline::kHold, 1);
  EXPECT_EQ(p.cost(0)[kContact], 1);
  EXPECT_EQ(p.cost(0)[kCost], 1);
  EXPECT_EQ(p.cost(0)[kMoved], 1);
  m.X.p = {0.1, -0.6, 0.02};  // under the table
  p->world(0).set_body(16, m);
  run(p, Baseline::kHold, 1);
  EXPECT_EQ(p.cost(0)[kFall], 1);
}

TEST_F(Jenga, EndsWhenAllIsDown) {
  TestPool p(kTask, 1, {{"gravity", nullptr, 0}});
  p->reset(nullptr, nullptr);
  const auto drop = [&](int32_t first) {
    for (int32_t b = first; b <= 16; ++b) {
      Motion m = p->world(0).body(b);
      m.X.p += Vec3{0.5 + 0.1 * b, 0, -0.02};
      m.v = m.w = {};
      p->world(0).set_body(b, m);
    }
    run(p, Baseline::kHold, 1);
  };
  run(p, Baseline::kHold, 1);
  drop(2);
  EXPECT_FALSE(p.rows().terminated[0]);
  drop(1);
  EXPECT_TRUE(p.rows().terminated[0]);
}

TEST_F(Jenga, ResetNoiseMovesTheTowerAsOne) {
  TestPool p(kTask, 2, {{"reset_noise", nullptr, 0.005}});
  p->reset(nullptr, nullptr);
  const Vec3 way = p->world(0).body(0).X.p - p->task().scene().def.bodies[0].X_WB.p;
  EXPECT_GT(norm(way), 0);
  EXPECT_EQ(way.z, 0);
  for (int32_t b = 0; b < 17; ++b)
    EXPECT_LT(
        norm(p->world(0).body(b).X.p - p->task().scene().def.bodies[static_cast<size_t>(b)].X_WB.p - way),
        1e-12);
  EXPECT_NE(p->world(0).body(0).X.p.x, p->world(1).body(0).X.p.x);
}

// More than the thirty numbers that the throw tasks make room for are used, and none are left out.
TEST_F(Jenga, ThereIsRoomForItsContacts) {
  for (const char* engine : kEngines) {
    TestPool p(kTask, 2, with_engine(engine));
    p->reset(nullptr, nullptr);
    run(p, Baseline::kRandom, 300);
    EXPECT_GT(p->stats().contacts_max, 80);
    EXPECT_EQ(p->stats().overflowed, 0);
  }
}

// tower=off: the target lies on the table, and no block costs anything.
TEST_F(Jenga, WithoutItsTower) {
  for (const char* mode : {"default", "paper", "literal", "contact"}) {
    TestPool p(
        kTask, 1,
        {{"tower", "off", 0}, {"cost_mode", mode, 0}, {"extended_obs", nullptr, 1}, {"pair", "paper", 0}});
    p->reset(nullptr, nullptr);
    ASSERT_EQ(p->task().scene().num_bodies, 1);
    const Vec3 before = p->world(0).body(0).X.p;
    for (int t = 0; t < 30; ++t) {
      p->baseline(Baseline::kHold);
      p->step(nullptr);
      EXPECT_EQ(p.rows().cost[0], 0) << mode;
      EXPECT_EQ(p.rows().terminated[0], 0) << mode;
    }
    EXPECT_LT(norm(p->world(0).body(0).X.p - before), 1e-3);
    EXPECT_NEAR(before.z, 0.2557, 1e-3);
  }
}

}  // namespace
}  // namespace rdm::test
