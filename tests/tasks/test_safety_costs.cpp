#include <algorithm>
#include <cmath>
#include <string>

#include "tasks/catalog.hpp"
#include "tasks/throw/safety_costs.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

JointWindow make_window(int window, double low, double high) {
  SceneDef def;
  def.articulations.push_back(make_articulation(kShadowHand, Side::kRight, {}, ""));
  const Scene scene = make_scene(std::move(def));
  return rdm::make_window(find_hand(kShadowHand, scene, 0), window, low, high);
}

enum : int { kCost, kFf2, kFf3, kFf4, kEffort, kHeight, kAngle, kDrop };

// Windows are inclusive: 22.5 and 67.5 degrees are inside, 22.4 and 67.6 are not.
TEST(JointWindow, AnglesAtTheEnds) {
  for (const int joint : {rdm::kFf2, rdm::kFf3}) {
    const JointWindow w = make_window(joint, 22.5, 67.5);
    EXPECT_GT(w.excess(22.4 * kDegree), 0);
    EXPECT_LE(w.excess(22.5 * kDegree), 0);
    EXPECT_LE(w.excess(67.5 * kDegree), 0);
    EXPECT_GT(w.excess(67.6 * kDegree), 0);
    EXPECT_NEAR(w.excess(77.5 * kDegree), 10 * kDegree, 1e-12);
  }
  const JointWindow w = make_window(rdm::kFf4, -10, 10);
  EXPECT_LE(w.excess(10.0 * kDegree), 0);
  EXPECT_GT(w.excess(10.1 * kDegree), 0);
  EXPECT_LE(w.excess(-10.0 * kDegree), 0);
  EXPECT_GT(w.excess(-10.1 * kDegree), 0);
}

TEST(JointWindow, CommandsAtTheEndsAreExact) {
  for (int joint = 0; joint < kNumWindows; ++joint) {
    const JointWindow w = joint == rdm::kFf4 ? make_window(joint, -10, 10) : make_window(joint, 22.5, 67.5);
    EXPECT_EQ(w.command_low, -0.5);
    EXPECT_EQ(w.command_high, 0.5);
    EXPECT_LE(w.command_excess(0.5), 0);
    EXPECT_LE(w.command_excess(-0.5), 0);
    EXPECT_GT(w.command_excess(std::nextafter(0.5, 1)), 0);
  }
  EXPECT_NEAR(make_window(rdm::kFf2, 22.5, 67.5).command_excess(-1), 22.5 * kDegree, 1e-12);
  EXPECT_EQ(make_window(rdm::kFf4, -20, 5).command_high, 0.25);
  EXPECT_EQ(make_window(rdm::kFf2, 22.5, 67.5).act, 4);
  EXPECT_EQ(make_window(rdm::kFf3, 22.5, 67.5).act, 3);
  EXPECT_EQ(make_window(rdm::kFf4, -10, 10).act, 2);
}

class SafetyCost : public testing::Test {
 protected:
  void SetUp() override { register_builtin_tasks(); }
  static std::vector<float> one_step(const char* task, std::vector<OptionInput> options, float a2, float a3,
                                     float a4) {
    TestPool p(task, 1, options);
    p->reset(nullptr, nullptr);
    p.action(0)[2] = a2;
    p.action(0)[3] = a3;
    p.action(0)[4] = a4;
    p->step(nullptr);
    return {p.cost(0), p.cost(0) + p->cost_dim()};
  }
};

constexpr const char* kFinger = "hand_over_safe_finger";
constexpr const char* kJoint = "hand_over_safe_joint";
constexpr const char* kThrows[] = {kFinger, kJoint, "catch_underarm_safe_finger",
                                   "catch_underarm_safe_joint"};
bool of_finger(const char* task) {
  return std::string(task).find("finger") != std::string::npos;
}
bool flying(const char* task) {
  return std::string(task).find("catch") == 0;
}
const OptionInput kCommand = {"cost_mode", "command", 0};

// Column 0 and the windows' columns by the paper's equations and the angles alone.
struct ByAngle {
  float cost[1 + kNumWindows], raw[1 + kNumWindows];
};
ByAngle by_angle(bool finger, const World& world) {
  constexpr double kLow[] = {22.5, 22.5, -10}, kHigh[] = {67.5, 67.5, 10};  // degrees
  constexpr int kJoints[] = {4, 3, 2};                                      // FF2, FF3, FF4
  ByAngle out;
  double worst = -1e9;
  for (int i = 0; i < kNumWindows; ++i) {
    const double q = world.q()[kJoints[i]];
    const double excess = std::max(kLow[i] * kDegree - q, q - kHigh[i] * kDegree);
    if (finger || i == rdm::kFf4) worst = std::max(worst, excess);
    out.cost[1 + i] = excess > 0;
    out.raw[1 + i] = static_cast<float>(excess);
  }
  out.cost[0] = worst > 0;
  out.raw[0] = static_cast<float>(worst);
  return out;
}

// By default the windows test the measured angles, to the bit, whatever the action.
TEST_F(SafetyCost, IsTheWindowsOnTheMeasuredAngles) {
  constexpr int kEnvs = 8, kHeld = 8;
  PoolConfig c;
  c.autoreset = Autoreset::kOff;  // what is read is of the episode that was judged
  for (const char* task : kThrows)
    for (const char* start : {"window", "paper"}) {
      std::vector<OptionInput> options = {{"start_finger", start, 0}, {"fall_height", nullptr, -10}};
      if (flying(task)) options.push_back({"base_limit", nullptr, 100});
      TestPool p(task, kEnvs, options, c);
      p->reset(nullptr, nullptr);
      int outside = 0, inside = 0;
      for (int t = 0; t < 75; ++t) {
        if (t % kHeld == 0) p->baseline(Baseline::kRandom);
        p->step(nullptr);
        for (int i = 0; i < kEnvs; ++i) {
          const ByAngle want = by_angle(of_finger(task), p->world(i));
          for (int k = 0; k <= kNumWindows; ++k) {
            ASSERT_EQ(p.cost(i)[k], want.cost[k]) << task << ", " << start << ": column " << k;
            ASSERT_EQ(p.rows().cost_raw[i * p->cost_dim() + k], want.raw[k]) << task << ", " << start;
          }
          ++(want.cost[kCost] > 0 ? outside : inside);
        }
      }
      EXPECT_GT(outside, 0) << task << ", " << start;
      EXPECT_GT(inside, 0) << task << ", " << start;
    }
}

// A world's motion and costs under random actions, which no option chooses.
std::vector<float> course(const char* task, std::vector<OptionInput> options) {
  std::vector<float> rows;
  TestPool p(task, 2, options);
  p->reset(nullptr, nullptr);
  for (int t = 0; t < 20; ++t) {
    rows.insert(rows.end(), p.rows().obs, p.rows().obs + 2 * p->obs_dim());
    p->baseline(Baseline::kRandom);
    p->step(nullptr);
    rows.insert(rows.end(), p.rows().cost, p.rows().cost + 2 * p->cost_dim());
  }
  return rows;
}

// Words of older configurations are read, and mean what they say now.
TEST_F(SafetyCost, WordsOfTheMode) {
  for (const char* task : kThrows) {
    const auto usual = course(task, {}), command = course(task, {kCommand});
    for (const char* word : {"angle", "default", "paper"})
      EXPECT_EQ(course(task, {{"cost_mode", word, 0}}), usual) << task << ' ' << word;
    EXPECT_EQ(course(task, {kCommand, {"cost_signal", "angle", 0}}), usual) << task;
    EXPECT_EQ(course(task, {{"cost_signal", "target", 0}}), command) << task;
    EXPECT_NE(usual, command) << task;
  }
}

TEST_F(SafetyCost, CommandsAtAndBeyondTheWindows) {
  EXPECT_EQ(one_step(kFinger, {kCommand}, 0.5f, 0.5f, 0.5f)[kCost], 0);
  EXPECT_EQ(one_step(kJoint, {kCommand}, 0.5f, 0.5f, 0.5f)[kCost], 0);
  EXPECT_EQ(one_step(kFinger, {kCommand}, 0.51f, 0, 0)[kCost], 1);
  EXPECT_EQ(one_step(kJoint, {kCommand}, 0.51f, 0, 0)[kCost], 1);
  EXPECT_EQ(one_step(kFinger, {kCommand}, 0, 0, 0.51f)[kCost], 1);
  EXPECT_EQ(one_step(kJoint, {kCommand}, 0, 0, 0.51f)[kCost], 0);
  EXPECT_EQ(one_step(kFinger, {kCommand}, 0, -0.51f, 0)[kCost], 1);
  EXPECT_EQ(one_step(kJoint, {kCommand}, 0, -1, -1)[kCost], 0);
}

TEST_F(SafetyCost, EachWindowHasItsColumn) {
  const auto all = one_step(kJoint, {kCommand}, -0.6f, 0.6f, -0.7f);
  EXPECT_EQ(all[kFf2] + all[kFf3] + all[kFf4], 3);
  const auto one = one_step(kFinger, {kCommand}, 0, 0.6f, 0);
  EXPECT_EQ(one[kFf3], 1);
  EXPECT_EQ(one[kFf2] + one[kFf4], 0);
}

TEST_F(SafetyCost, ModesAndTheirOverrides) {
  const auto joint = [](std::vector<OptionInput> o, float a2, float a4) {
    return one_step(kJoint, o, a2, 0, a4)[kCost];
  };
  EXPECT_EQ(joint({{"cost_mode", "literal", 0}}, 0.51f, 0), 0);
  EXPECT_EQ(joint({{"cost_mode", "literal", 0}}, 0, 0.51f), 1);
  EXPECT_EQ(joint({kCommand, {"cost_joint", "legacy", 0}}, 0, 0.51f), 1);
  EXPECT_EQ(joint({{"cost_mode", "literal", 0}, {"cost_joint", "paper", 0}}, 0.51f, 0), 1);
  // measured angles lag behind: one step is not enough to bring FF4 out, nor FF2 and FF3 in
  for (const char* word : {"angle", "default", "paper"}) {
    const OptionInput mode = {"cost_mode", word, 0};
    EXPECT_EQ(joint({mode}, 1, 0), 0) << word;
    EXPECT_EQ(joint({mode, {"cost_signal", "target", 0}}, 1, 0), 1) << word;
    EXPECT_EQ(one_step(kFinger, {mode, {"start_finger", "paper", 0}}, 0, 0, 0)[kCost], 1) << word;
  }
  EXPECT_EQ(joint({kCommand}, 1, 0), 1);
  EXPECT_EQ(joint({kCommand, {"cost_signal", "angle", 0}}, 1, 0), 0);
  EXPECT_EQ(one_step(kFinger, {{"cost_mode", "literal", 0}}, 0, 0, 0)[kCost], 0);
}

TEST_F(SafetyCost, WindowsAreOptions) {
  EXPECT_EQ(one_step(kJoint, {kCommand, {"window.ff4.high", nullptr, 5}}, 0.3f, 0, 0)[kCost], 1);
  EXPECT_EQ(one_step(kJoint, {kCommand, {"window.ff4.high", nullptr, 15}}, 0.7f, 0, 0)[kCost], 0);
  PoolConfig c;
  c.task = kJoint;
  const OptionInput bad{"window.ff4.low", nullptr, 30};
  c.options = &bad;
  c.num_options = 1;
  EXPECT_EQ(code_of([&] { Pool::destroy(Pool::create(c)); }), Code::kArgument);
}

TEST_F(SafetyCost, FromThePapersStartItTakesAFewStepsToEnter) {
  TestPool p(kFinger, 1,
             {{"start_finger", "paper", 0}, {"start.x", nullptr, 1}, {"fall_height", nullptr, -10}});
  p->reset(nullptr, nullptr);
  int steps = 0;
  do {
    p->baseline(Baseline::kZero);
    p->step(nullptr);
    ++steps;
  } while (p.cost(0)[kCost] > 0 && steps < 75);
  EXPECT_GE(steps, 3);
  EXPECT_LE(steps, 15);
  EXPECT_LE(p.rows().cost_raw[kCost], 0);
}

// FF2 and FF3 begin at 27 degrees, a tenth of the window's width inside, and are drawn upwards from there.
TEST_F(SafetyCost, TheFirstFingerBeginsInside) {
  constexpr double kIn = (22.5 + 4.5) * kDegree, kMost = (67.5 - 4.5) * kDegree;
  for (const char* task : kThrows) {
    if (!of_finger(task)) continue;
    for (const char* noise : {"one_sided", "literal"})
      for (const double level : {0.0, 0.2, 1.0}) {
        constexpr int kEnvs = 64;
        TestPool p(task, kEnvs, {{"joint_noise_mode", noise, 0}, {"joint_noise", nullptr, level}});
        p->reset(nullptr, nullptr);
        for (int i = 0; i < kEnvs; ++i) {
          const World& w = p->world(i);
          for (const int joint : {3, 4}) {
            EXPECT_GE(w.q()[joint], kIn - 1e-6) << task;  // joints are kept as floats
            EXPECT_LE(w.q()[joint], (level == 0 ? kIn : kMost) + 1e-6) << task;
            EXPECT_NEAR(w.target()[joint], w.q()[joint], 1e-6) << task;
          }
          EXPECT_LE(std::abs(w.q()[2]), 8 * kDegree + 1e-6);
        }
      }
  }
}

// A hand that holds still, or does what learning starts from, costs nothing from the first step on.
TEST_F(SafetyCost, StillHandsCostNothing) {
  constexpr int kEnvs = 64;
  std::vector<uint64_t> seeds;
  for (uint64_t s = 0; s < kEnvs; ++s) seeds.push_back(s);
  for (const char* task : kThrows)
    for (const bool mean : {true, false}) {
      TestPool p(task, kEnvs);
      p->reset(seeds.data(), nullptr);
      for (int t = 0; t < 75; ++t) {
        if (mean)
          for (int i = 0; i < kEnvs; ++i) p->task().initial_mean(p.action(i));
        else
          p->baseline(Baseline::kHold);
        p->step(nullptr);
        for (int i = 0; i < kEnvs; ++i) EXPECT_EQ(p.cost(i)[kCost], 0) << task << ", world " << i;
      }
    }
}

// With the commands, and for whom it is asked, the finger begins straight.
TEST_F(SafetyCost, StartsThatAreThePapers) {
  const auto first = [](std::vector<OptionInput> o) {
    o.push_back({"joint_noise", nullptr, 0});
    TestPool p(kFinger, 1, o);
    p->reset(nullptr, nullptr);
    return p->world(0).q()[3];
  };
  EXPECT_GT(first({}), 0.4);
  EXPECT_EQ(first({kCommand}), 0);
  EXPECT_EQ(first({{"cost_mode", "literal", 0}}), 0);
  EXPECT_EQ(first({{"cost_signal", "target", 0}}), 0);
  EXPECT_EQ(first({{"start_finger", "paper", 0}}), 0);
  EXPECT_GT(first({kCommand, {"start_finger", "window", 0}}), 0.4);
  // where the joint cannot be inside, nothing is moved
  EXPECT_EQ(first({{"window.ff2.low", nullptr, 100}, {"window.ff2.high", nullptr, 120}}), 0);
}

// Hands with other joints begin inside too, where they have the joints.
TEST_F(SafetyCost, OtherHandsBeginInside) {
  constexpr int kEnvs = 16;
  for (const char* hand : {"allegro_hand", "schunk_svh", "barrett_bh282", "robotiq_3f"}) {
    TestPool p(kFinger, kEnvs, {{"hand", hand, 0}});
    p->reset(nullptr, nullptr);
    p->baseline(Baseline::kHold);
    p->step(nullptr);
    for (int i = 0; i < kEnvs; ++i) EXPECT_EQ(p.cost(i)[kCost], 0) << hand;
  }
}

TEST_F(SafetyCost, Effort) {
  TestPool p(kFinger, 1, {{"joint_noise", nullptr, 0}, {"joint.WRJ0.effort", nullptr, 0.5}});
  p->reset(nullptr, nullptr);
  p->baseline(Baseline::kHold);
  p->step(nullptr);
  EXPECT_EQ(p.cost(0)[kEffort], 0);
  p.action(0)[1] = -1;  // the wrist: 5 N m/rad times 0.7 rad asks for more than 0.5 N m
  p->step(nullptr);
  EXPECT_EQ(p.cost(0)[kEffort], 1);
  EXPECT_NEAR(p.rows().cost_raw[kEffort], 1, 0.01);
}

TEST_F(SafetyCost, Height) {
  TestPool p(kFinger, 1);
  p->reset(nullptr, nullptr);
  Motion m;
  for (const double z : {0.79, 0.81}) {
    m.X.p = {0, -0.5, z};
    p->world(0).set_body(0, m);
    p->step(nullptr);
    EXPECT_EQ(p.cost(0)[kHeight], z > 0.8 ? 1 : 0);
    EXPECT_NEAR(p.rows().cost_raw[kHeight], z, 0.003);  // it falls for one step
  }
}

TEST_F(SafetyCost, Drop) {
  TestPool p(kFinger, 1);
  p->reset(nullptr, nullptr);
  Motion m;
  m.X.p = {0, -0.5, 0.21};
  m.v = {0, 0, -1};
  p->world(0).set_body(0, m);
  p->step(nullptr);
  EXPECT_EQ(p.cost(0)[kDrop], 1);
  EXPECT_TRUE(p.rows().terminated[0]);
  EXPECT_LT(p.rows().cost_raw[kDrop], 0.2f);
  p->step(nullptr);
  EXPECT_EQ(p.cost(0)[kDrop], 0);
}

// The object rests on the right hand, then leaves it with the given velocity.
struct Release {
  float cost, raw;
  int count;
};
Release release(const Vec3& v) {
  TestPool p(kFinger, 1, {{"object", "ball", 0}, {"start_noise", nullptr, 0}});
  p->reset(nullptr, nullptr);
  for (int t = 0; t < 20; ++t) {
    p->baseline(Baseline::kHold);
    p->step(nullptr);
    EXPECT_EQ(p.cost(0)[kAngle], 0);
  }
  Motion m = p->world(0).body(0);
  m.v = v;
  m.X.p.z += 0.02;
  p->world(0).set_body(0, m);
  Release r{0, 0, 0};
  for (int t = 0; t < 5; ++t) {
    p->step(nullptr);
    if (p.rows().cost_raw[kAngle] != 0) r.raw = p.rows().cost_raw[kAngle];
    r.count += p.cost(0)[kAngle] > 0;
  }
  r.cost = p.rows().episode_cost[kAngle];
  return r;
}

TEST_F(SafetyCost, ThrowAngle) {
  const Release good = release({0, -1.2, 1.5});
  EXPECT_EQ(good.cost, 0);
  EXPECT_NEAR(good.raw, std::atan2(1.5, 1.2), 0.15);
  const Release flat = release({0, -2, 0.5});
  EXPECT_EQ(flat.cost, 1);
  EXPECT_EQ(flat.count, 1);
  EXPECT_LT(flat.raw, 30 * kDegree);
  const Release steep = release({0, -0.6, 3});
  EXPECT_EQ(steep.cost, 1);
  EXPECT_GT(steep.raw, 75 * kDegree);
  EXPECT_EQ(release({0, -0.3, 0.1}).cost, 0);  // too slow for a throw
  EXPECT_EQ(release({0, -0.1, 3}).cost, 0);    // straight up is none either
}

TEST_F(SafetyCost, AreZeroAfterReset) {
  for (const char* task : {kFinger, kJoint}) {
    TestPool p(task, 3);
    p->reset(nullptr, nullptr);
    p->baseline(Baseline::kRandom);
    p->step(nullptr);
    p->reset(nullptr, nullptr);
    for (int k = 0; k < 3 * p->cost_dim(); ++k) {
      EXPECT_EQ(p.rows().cost[k], 0);
      EXPECT_EQ(p.rows().cost_raw[k], 0);
    }
  }
}

TEST_F(SafetyCost, TablesNameColumnsAndLimits) {
  const TaskInfo& finger = task_at(task_find(kFinger));
  const TaskInfo& joint = task_at(task_find(kJoint));
  const char* names[] = {"cost",   "ff2_range",    "ff3_range",   "ff4_range",
                         "effort", "throw_height", "throw_angle", "drop"};
  ASSERT_EQ(finger.num_costs, 8);
  for (int k = 0; k < 8; ++k) {
    EXPECT_STREQ(finger.costs[k].name, names[k]);
    EXPECT_STREQ(joint.costs[k].name, names[k]);
    EXPECT_EQ(finger.costs[k].limit, k == 0 ? 40 : -1);
    EXPECT_EQ(joint.costs[k].limit, k == 0 ? 30 : -1);
  }
}

}  // namespace
}  // namespace rdm::test
