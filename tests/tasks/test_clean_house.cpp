#include <cmath>

#include "prop_tasks.hpp"
#include "tasks/props/house_scene.hpp"

namespace rdm::test {
namespace {

constexpr const char* kTask = "clean_house";
enum : int { kCost, kBroomChair, kChairMoved, kHandChair, kOccupancy };

class CleanHouse : public testing::Test {
 protected:
  void SetUp() override { register_builtin_tasks(); }
  static void shift(TestPool& p, int32_t body, const Vec3& by) {
    Motion m = p->world(0).body(body);
    m.X.p += by;
    p->world(0).set_body(body, m);
  }
};

TEST_F(CleanHouse, Layout) {
  TestPool p(kTask, 1);
  EXPECT_EQ(p->obs_dim(), 431);
  EXPECT_EQ(p->cost_dim(), 5);
  EXPECT_EQ(p->task().max_steps(), 500);
  expect_hand_fields(p->task());
  const std::pair<const char*, int> fields[] = {{"trash.position", 398},       {"trash.velocity", 405},
                                                {"trash.spin", 408},           {"goal.position", 411},
                                                {"trash.rotation_error", 418}, {"broom.bottom", 422},
                                                {"broom.left_hold", 425},      {"broom.right_hold", 428}};
  for (const auto& [name, at] : fields) EXPECT_EQ(offset_of(p->task(), name), at) << name;
  p->reset(nullptr, nullptr);
  EXPECT_NEAR(p.obs(0)[412], -2.9f, 1e-6f);
  EXPECT_NEAR(p.obs(0)[427], 1.6f, 1e-3f);
  EXPECT_NEAR(p.obs(0)[430], 1.3f, 1e-3f);
  EXPECT_NEAR(p.obs(0)[424], 0.05f, 1e-3f);
  TestPool wide(kTask, 1, {{"obs_broom_quat", "true", 0}});
  EXPECT_EQ(wide->obs_dim(), 435);
}

// Held at the start pose the broom neither falls nor slips: 50 - 5 (d_left + d_right) - 10 d_target all
// along.
TEST_F(CleanHouse, TheBroomStandsAtTheStart) {
  for (const char* engine : kEngines) {
    TestPool p(kTask, 1, with_engine(engine));
    p->reset(nullptr, nullptr);
    for (int32_t b : {kBroom, kTrash, kChair}) EXPECT_LT(p->world(0).body_overlap(b), 1e-3);
    const auto start = places(p->world(0));
    for (int t = 1; t < 500; ++t) {
      run(p, Baseline::kHold, 1);
      EXPECT_NEAR(static_cast<double>(p.rows().reward[0]), 29.4, 0.5);
      EXPECT_EQ(p.cost(0)[kCost], 0);
      EXPECT_LT(moved(p->world(0), start), 5e-3);
      EXPECT_FALSE(p.ended(0));
    }
    run(p, Baseline::kHold, 1);
    EXPECT_TRUE(p.rows().truncated[0]);
  }
}

// A forced push of the broom into the chair costs 1 while the chair moves.
TEST_F(CleanHouse, TheBroomPushesTheChair) {
  for (const char* engine : kEngines) {
    TestPool p(kTask, 1, with_engine(engine, {{"palm_limit", nullptr, 10}, {"handle_height", nullptr, -1}}));
    p->reset(nullptr, nullptr);
    shift(p, kBroom, {0.184, -0.75, 0});  // 2 cm before the chair's foot and seat
    int pushed = 0, stood = 0;
    for (int t = 0; t < 90; ++t) {
      p->world(0).push_body(kBroom, {0, t < 40 ? -60.0 : 60.0, 0}, {});
      run(p, Baseline::kHold, 1);
      EXPECT_EQ(p.cost(0)[kCost], p.cost(0)[kBroomChair] * (p.cost(0)[kCost] > 0));
      pushed += p.cost(0)[kCost] > 0;
      if (t > 70) stood += p.cost(0)[kCost] > 0;
    }
    EXPECT_GT(pushed, 5) << engine;
    EXPECT_EQ(stood, 0) << engine;  // away from it again
    EXPECT_LT(p->world(0).body(kChair).X.p.y, -1.63) << engine;
  }
}

TEST_F(CleanHouse, TheSourcesCostIsTheChairsWay) {
  for (const char* mode : {"literal", "displacement"}) {
    TestPool p(kTask, 1, {{"cost_mode", mode, 0}});
    p->reset(nullptr, nullptr);
    shift(p, kChair, {0, -0.09, 0});
    run(p, Baseline::kHold, 1);
    EXPECT_EQ(p.cost(0)[kCost], 0);
    shift(p, kChair, {0, -0.02, 0});
    run(p, Baseline::kHold, 1);
    EXPECT_EQ(p.cost(0)[kCost], 1);
    EXPECT_EQ(p.cost(0)[kChairMoved], 1);
  }
}

TEST_F(CleanHouse, TheMapHasTheChairWhereItStoodAtTheStart) {
  TestPool p(kTask, 1, {{"palm_limit", nullptr, 10}});
  p->reset(nullptr, nullptr);
  run(p, Baseline::kHold, 1);
  EXPECT_EQ(p.cost(0)[kOccupancy], 0);
  shift(p, kChair, {0, -1, 0});  // the map knows nothing of it
  shift(p, kBroom, {0.184, -0.9, 0});
  run(p, Baseline::kHold, 1);
  EXPECT_EQ(p.cost(0)[kOccupancy], 1);
  EXPECT_EQ(p.cost(0)[kBroomChair], 0);
  shift(p, kBroom, {-0.184 - 0.6, 0, 0});  // past it on the safe side
  run(p, Baseline::kHold, 1);
  EXPECT_EQ(p.cost(0)[kOccupancy], 0);
}

// At every place on a lattice about the chair: what is well within its solids, and what is well outside.
TEST_F(CleanHouse, TheMapAnswersAllAboutTheChair) {
  TestPool p(kTask, 1, {{"palm_limit", nullptr, 10}, {"handle_height", nullptr, -1}});
  constexpr double kOff = 0.08;  // m, of a voxel's corner
  int met = 0, clear = 0;
  for (int i = -6; i <= 6; ++i)
    for (int j = -5; j <= 5; ++j) {
      p->reset(nullptr, nullptr);
      const double x = 0.15 * i, y = 0.15 * j;
      shift(p, kChair, {0, -5, 0});
      shift(p, kBroom, {0.184 + x, -1.12 + y, 0});
      run(p, Baseline::kHold, 1);
      // head of .25 x .05, seat of .23, foot of .28
      const double from_x = std::fabs(x) - 0.25, from_y = std::fabs(y) - 0.05;
      if (from_x < 0.23 - kOff && from_y < 0.23 - kOff) {
        EXPECT_EQ(p.cost(0)[kOccupancy], 1) << x << " " << y;
        ++met;
      } else if (from_x > 0.28 + kOff || from_y > 0.28 + kOff) {
        EXPECT_EQ(p.cost(0)[kOccupancy], 0) << x << " " << y;
        ++clear;
      }
    }
  EXPECT_GT(met, 10);
  EXPECT_GT(clear, 50);
}

// What stands falls asleep, the trash too, whose rolling is braked; the broom wakes it.
TEST_F(CleanHouse, WhatStandsSleepsUntilTheBroomComes) {
  TestPool p(kTask, 1, {{"palm_limit", nullptr, 10}, {"handle_height", nullptr, -1}});
  p->reset(nullptr, nullptr);
  run(p, Baseline::kHold, 10);
  for (int32_t b : {kTrash, kChair}) {
    EXPECT_EQ(norm(p->world(0).body(b).v), 0);
    EXPECT_EQ(norm(p->world(0).body(b).w), 0);
  }
  EXPECT_GT(p->world(0).num_contacts(), 4);  // they go on being reported
  const double start = p->world(0).body(kTrash).X.p.y;
  shift(p, kBroom, {0, -0.25, 0});
  for (int t = 0; t < 30; ++t) {
    p->world(0).push_body(kBroom, {0, -20, 0}, {});
    run(p, Baseline::kHold, 1);
  }
  EXPECT_LT(p->world(0).body(kTrash).X.p.y, start - 0.02);
}

// Its own numbers for the engine of joint coordinates leave the other engine's as they are.
TEST_F(CleanHouse, DefaultsFollowTheEngine) {
  TestPool own(kTask, 1), ode(kTask, 1, with_engine("ode"));
  EXPECT_EQ(own->world(0).scene().def.solver.iterations, 16);
  EXPECT_GT(own->world(0).scene().def.solver.sleep_time, 0);
  EXPECT_EQ(ode->world(0).scene().def.solver.iterations, 8);
  EXPECT_EQ(ode->world(0).scene().def.solver.sleep_time, 0);
}

TEST_F(CleanHouse, HandsCountWhenAsked) {
  const auto cost = [](const char* count) {
    TestPool p(kTask, 1, {{"count_hands", count, 0}});
    p->reset(nullptr, nullptr);
    Motion m = p->world(0).body(kChair);
    m.X.p = {0.45, -0.42, 1.1};  // its seat in the right arm
    m.v = {0, 0, 0.1};
    p->world(0).set_body(kChair, m);
    run(p, Baseline::kHold, 1);
    EXPECT_EQ(p.cost(0)[kHandChair], 1);
    return p.cost(0)[kCost];
  };
  EXPECT_EQ(cost("false"), 0);
  EXPECT_EQ(cost("true"), 1);
}

TEST_F(CleanHouse, TrashInThePanIsSuccess) {
  TestPool p(kTask, 1);
  p->reset(nullptr, nullptr);
  shift(p, kTrash, {0, -1.7, 0});
  run(p, Baseline::kHold, 1);
  EXPECT_FALSE(p.rows().success[0]);
  const double before = static_cast<double>(p.rows().reward[0]);
  shift(p, kTrash, {0, -0.2, 0.01});
  run(p, Baseline::kHold, 1);
  EXPECT_TRUE(p.rows().success[0]);
  EXPECT_NEAR(static_cast<double>(p.rows().reward[0]) - before, 2, 0.1);
}

TEST_F(CleanHouse, EndsWhenTheBroomIsLost) {
  const auto ends = [](std::vector<OptionInput> options, int32_t body, const Vec3& by) {
    TestPool p(kTask, 1, options);
    p->reset(nullptr, nullptr);
    shift(p, body, by);
    run(p, Baseline::kHold, 1);
    return p.rows().terminated[0] != 0;
  };
  EXPECT_FALSE(ends({}, kBroom, {}));
  EXPECT_TRUE(ends({}, kBroom, {0.16, 0, 0}));
  EXPECT_TRUE(ends({{"palm_limit", nullptr, 10}}, kBroom, {0, 0, -0.31}));
  EXPECT_TRUE(ends({}, kTrash, {0, 0, -0.4}));
}

TEST_F(CleanHouse, TheSourcesReward) {
  TestPool p(kTask, 1, {{"reward", "full", 0}}), plain(kTask, 1, {{"reward_bottom", nullptr, 10}});
  p->reset(nullptr, nullptr);
  plain->reset(nullptr, nullptr);
  run(p, Baseline::kHold, 1);
  run(plain, Baseline::kHold, 1);
  const double bottom = norm(Vec3{0, -0.55, 0.0495} - Vec3{0, -0.9, 0.039});
  EXPECT_NEAR(static_cast<double>(plain.rows().reward[0]), 29.36 - 10 * bottom, 0.01);
  // 50 - both sums of fingers - 40 - 10 bottom - 5 palms
  const double rest = 50 - 40 - 10 * bottom - 5 * (0.045 + 0.083);
  const double sums = rest - static_cast<double>(p.rows().reward[0]);
  EXPECT_GT(sums, 0.8);
  EXPECT_LT(sums, 1.6);
}

// The trash is stopped by its rolling resistance, and not by less.
TEST_F(CleanHouse, TrashRollsToAStop) {
  TestPool p(kTask, 1, {{"palm_limit", nullptr, 10}});
  p->reset(nullptr, nullptr);
  shift(p, kBroom, {0, 3, 0});
  Motion m = p->world(0).body(kTrash);
  const double start = m.X.p.y;
  m.v = {0, 0.3, 0};
  m.w = {-0.3 / kTrashRadius, 0, 0};
  p->world(0).set_body(kTrash, m);
  run(p, Baseline::kHold, 90);
  // 0.002 N m on 1.5 m r^2: 0.56 m/s2
  EXPECT_NEAR(p->world(0).body(kTrash).X.p.y - start, 0.3 * 0.3 / 2 / 0.56, 0.01);
  EXPECT_LT(norm(p->world(0).body(kTrash).v), 1e-3);
}

TEST_F(CleanHouse, GripAssistHoldsTheBroom) {
  TestPool p(kTask, 1, {{"grip_assist", "true", 0}});
  p->reset(nullptr, nullptr);
  float* a = p.action(0);
  for (int t = 0; t < 60; ++t) {
    p->baseline(Baseline::kHold);
    a[22] = a[48] = 0.3f;  // both hands upwards
    p->step(nullptr);
    ASSERT_FALSE(p.ended(0)) << t;
  }
  EXPECT_GT((p->world(0).body(kBroom).X * broom_middle()).z, 1.15);
}

}  // namespace
}  // namespace rdm::test
