// The tasks' hand is data: a made-up robot, the Shadow Hand without its ring finger and with the two wrist
// joints of another name, goes through every piece that tasks of hands are made of.
#include <algorithm>
#include <cmath>

#include "tasks/hand/single_hand.hpp"
#include "tasks/task_info.hpp"
#include "tasks/throw/safe_throw.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

constexpr int32_t kGone = 2, kFirstGone = 10, kNumGone = 4;  // finger; its rows of the Shadow Hand

// Tables of the Shadow Hand without one finger: 20 joints, 17 of them driven, four tips.
struct ThreeFingers {
  std::vector<RobotLink> links;
  std::vector<RobotShape> shapes;
  std::vector<RobotPair> pairs;
  std::vector<RobotCoupling> couplings;
  std::vector<RobotTip> tips;
  std::vector<RobotFinger> fingers;
  std::vector<double> folded;
  Robot robot = kShadowHand;

  static bool gone(int32_t link) { return link >= kFirstGone && link < kFirstGone + kNumGone; }
  static int32_t moved(int32_t link) { return link < kFirstGone ? link : link - kNumGone; }

  ThreeFingers() {
    const Robot& s = kShadowHand;
    for (int32_t i = 0; i < s.links.count; ++i) {
      if (gone(i)) continue;
      links.push_back(s.links[i]);
      links.back().parent = moved(links.back().parent);
      folded.push_back(s.poses.folded[i]);
    }
    links[0].joint = "SIDE", links[1].joint = "FLEX";
    std::vector<int32_t> row(static_cast<size_t>(s.shapes.count), -1);
    for (int32_t i = 0; i < s.shapes.count; ++i) {
      if (gone(s.shapes[i].link)) continue;
      row[static_cast<size_t>(i)] = static_cast<int32_t>(shapes.size());
      shapes.push_back(s.shapes[i]);
      shapes.back().link = moved(shapes.back().link);
    }
    for (const RobotPair& p : s.self_pairs) {
      const int32_t a = row[static_cast<size_t>(p.a)], b = row[static_cast<size_t>(p.b)];
      if (a >= 0 && b >= 0) pairs.push_back({a, b});
    }
    for (RobotCoupling c : s.couplings)
      if (!gone(c.link)) c.link = moved(c.link), c.other = moved(c.other), couplings.push_back(c);
    for (int32_t i = 0; i < s.tips.count; ++i) {
      if (i == kGone) continue;
      tips.push_back(s.tips[i]);
      tips.back().link = moved(tips.back().link);
      RobotFinger f = s.fingers[i];
      for (int32_t* link : {&f.first, &f.lateral, &f.proximal, &f.middle}) *link = moved(*link);
      fingers.push_back(f);
    }
    const auto rows = [](const auto& v) {
      return Table<std::decay_t<decltype(v[0])>>{v.data(), static_cast<int32_t>(v.size())};
    };
    robot.name = "three_fingers";
    robot.links = rows(links);
    robot.shapes = rows(shapes);
    robot.self_pairs = rows(pairs);
    robot.couplings = rows(couplings);
    robot.tips = rows(tips);
    robot.fingers = rows(fingers);
    robot.poses = {rows(folded), {}};
  }
};

const Robot& three_fingers() {
  static const ThreeFingers tables;
  return tables.robot;
}

constexpr int32_t kJoints = 20, kActions = 17, kTips = 4;

// Fields of a hand: three of the joints, a pose, two velocities and two forces of each tip, the action.
constexpr int32_t kFixedHand = 3 * kJoints + 19 * kTips + kActions, kFlyingHand = kFixedHand + 12;

HandControlConfig two_flying_hands() {
  HandControlConfig c;
  c.robot = &three_fingers();
  c.bases[0] = {{0, 0, 0.5}, {}};
  c.bases[1] = {{0, -1, 0.5}, {0, 1, 0, 0}};
  c.flying = true;
  c.transition_scale = c.orientation_scale = 0.1;
  c.folded = true;
  return c;
}

// A task of one hand that rewards nothing.
class OneHand final : public SingleHand {
 public:
  OneHand(const SingleHandConfig* config, const Options& o) : SingleHand(*config, o) {}

 private:
  void judge_step(const Step&, Verdict*) const override {}
};

// A row for the registry, so that a pool of it can step; also a throw with the windows on its first finger.
const SingleHandConfig kOneHand = {{.robot = &three_fingers(), .count = 1, .bases = {{{0, 0, 0.5}, {}}}},
                                   {.start = {0, -0.39, 0.60}, .goal = {0, -0.39, 0.56}},
                                   0.2};
const SafeThrowConfig kThrow = {{.hands = two_flying_hands(),
                                 .place = {{0, -0.39, 0.54}, {0, -0.64, 0.54}},
                                 .fall_height = 0.2,
                                 .base_limit = 0.5},
                                &flat_throw_mean,
                                {}};

constexpr CostSpec kOneCost[] = {{"cost", "none at all", 1}};
constexpr CameraSpec kOneCamera[] = {{"front", {1, 0, 1}, {0, 0, 0.5}, 1}};
constexpr LearnerDefault kNoDefaults[] = {{"hidden", "8"}};
void one_hand_options(OptionTable& table) {
  add_single_hand_options(kOneHand, table);
}
constinit const TaskInfo kOneHandTask = task_info<OneHand, kOneCost, kOneCamera, kNoDefaults, &kOneHand>(
    "one_made_up_hand", nullptr, "a made-up hand", &filled_options<one_hand_options>);
constinit const TaskInfo kThrowTask =
    task_info<SafeThrow, kFingerCosts, kOneCamera, kNoDefaults, &kThrow, SafetyKind::kFinger>(
        "made_up_hands_throw", nullptr, "two made-up hands", &filled_options<safe_throw_options<kThrow>>);

class OtherHand : public testing::Test {
 protected:
  void SetUp() override {
    static const bool done = [] {
      register_task(kOneHandTask);
      register_task(kThrowTask);
      return true;
    }();
    static_cast<void>(done);
  }
  static int32_t count_of(const Task& task, const char* field) {
    for (const FieldSpec& f : task.fields())
      if (same_name(f.name.text, field)) return f.count;
    return -1;
  }
  // Random actions; everything that is seen stays finite and within its bound.
  static void play(TestPool& p, int steps) {
    const float limit = p->task().obs_limit();
    p->reset(nullptr, nullptr);
    for (int t = 0; t < steps; ++t) {
      p->baseline(Baseline::kRandom);
      p->step(nullptr);
      for (int32_t i = 0; i < 3; ++i)
        for (int32_t k = 0; k < p->obs_dim(); ++k) ASSERT_LE(std::abs(p.obs(i)[k]), limit);
    }
    EXPECT_EQ(p->stats().diverged, 0);
  }
};

TEST_F(OtherHand, CountsAndFieldsAreThoseOfTheRobot) {
  EXPECT_EQ(three_fingers().num_actuated(), kActions);
  TestPool one("one_made_up_hand", 1), two("made_up_hands_throw", 1);
  const Task &a = one->task(), &b = two->task();
  EXPECT_EQ(a.action_dim(), kActions);
  EXPECT_EQ(b.action_dim(), 2 * (kActions + 6));
  EXPECT_EQ(obs_dim(a), kFixedHand + 24);
  EXPECT_EQ(obs_dim(b), 2 * kFlyingHand + 24);
  EXPECT_EQ(count_of(a, "right.joint_position"), kJoints);
  EXPECT_EQ(count_of(a, "right.action"), kActions);
  EXPECT_EQ(count_of(a, "right.mf_tip_force"), 3);
  EXPECT_EQ(count_of(a, "right.th_tip_force"), 3);
  EXPECT_EQ(count_of(a, "right.rf_tip_force"), -1);
  EXPECT_EQ(count_of(b, "left.action"), kActions + 6);
  EXPECT_EQ(b.scene().sensors.size(), 2u * kTips);
}

TEST_F(OtherHand, StepsOfEveryEngineStayFinite) {
  for (const char* engine : {"articulated", "ode"})
    for (const char* task : {"one_made_up_hand", "made_up_hands_throw"}) {
      TestPool p(task, 3, {{"engine", engine, 0}});
      play(p, 150);
    }
}

TEST_F(OtherHand, SavedStatesGoOn) {
  TestPool a("made_up_hands_throw", 2), b("made_up_hands_throw", 2);
  a->reset(nullptr, nullptr);
  b->reset(nullptr, nullptr);
  for (int t = 0; t < 20; ++t) a->baseline(Baseline::kRandom), a->step(nullptr);
  const auto state = a.state();
  b->set_state(-1, state.data(), state.size());
  for (int t = 0; t < 20; ++t)
    for (TestPool* p : {&a, &b}) (*p)->baseline(Baseline::kRandom), (*p)->step(nullptr);
  EXPECT_EQ(a->hash(-1), b->hash(-1));
}

// The roles: window costs on the first finger, a flat hand, the thumb across the palm, its own options.
TEST_F(OtherHand, RolesComeFromTheRobot) {
  const Robot& robot = three_fingers();
  EXPECT_EQ(robot.action_of(5), -1) << "coupled";
  TestPool p("made_up_hands_throw", 1,
             {{"cost_mode", "command", 0}, {"joint_noise", nullptr, 0}, {"joint.SIDE.kp", nullptr, 3}});
  EXPECT_EQ(p->task().scene().link(0).joint.kp, 3);
  const Hand hand = find_hand(robot, p->task().scene(), 0);
  EXPECT_EQ(make_window(hand, kFf4, -10, 10).act, robot.action_of(robot.fingers[0].lateral));
  p->reset(nullptr, nullptr);
  for (int32_t i = 0; i < kJoints; ++i)
    EXPECT_NEAR(p->world(0).q()[i], robot.poses.folded[i], 1e-6) << robot.links[i].name;
  std::vector<float> mean(static_cast<size_t>(p->task().action_dim()));
  p->task().initial_mean(mean.data());
  EXPECT_EQ(mean[2], 0) << "lateral";
  EXPECT_EQ(mean[5], 0) << "lateral";
  EXPECT_EQ(mean[6], -1) << "second finger";
  for (size_t i = 12; i < kActions; ++i) EXPECT_EQ(mean[i], 0) << "thumb";
  // a command out of the lateral joint's window
  p->baseline(Baseline::kZero);
  p.action(0)[2] = 0.51f;
  p->step(nullptr);
  EXPECT_EQ(p.cost(0)[0], 1);
}

TEST_F(OtherHand, WhatIsNoHandIsRefused) {
  Robot no_palm = three_fingers();
  no_palm.palm = kNoLink;
  Robot no_fingers = three_fingers();
  no_fingers.fingers = {};
  TestPool p("one_made_up_hand", 1);
  const Scene& scene = p->task().scene();
  for (const Robot* robot : {&no_palm, &no_fingers})
    EXPECT_EQ(code_of([&] { find_hand(*robot, scene, 0); }), Code::kUnsupported);
}

// The bytes of a task's own stand before doubles.
TEST_F(OtherHand, OwnBytesThatWouldMisalignAreRefused) {
  class Odd final : public HandTask {
   public:
    Odd(const Options& o, HandScene scene, size_t own_bytes)
        : HandTask(kOneHand.hands, o, 74, std::move(scene), own_bytes) {}
    void reset(World&, void*, Stream&) const override {}
    Verdict judge(World&, void*, int32_t) const override { return {}; }
    void observe(const World&, const void*, float*) const override {}
    void initial_mean(float*) const override {}

   private:
    void check_own_state(const void*) const override {}
  };
  int32_t count = 0;
  const OptionSpec* specs = kOneHandTask.options(&count, nullptr);
  Options o;
  o.add_table(specs, count);
  const auto make = [&](size_t own_bytes) {
    return code_of([&] { Odd(o, make_hand_scene(kOneHand.hands, o), own_bytes); });
  };
  EXPECT_EQ(make(16), Code::kOk);
  EXPECT_EQ(make(12), Code::kInternal);
}

}  // namespace
}  // namespace rdm::test
