// Arms that are led by the palms of their hands (control=ik): the palm goes where its six entries say, stays
// where they say nothing, and does what it can at limits; what cannot be led is refused.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "robot/robots.hpp"
#include "tasks/catalog.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

constexpr const char* kArms[] = {"panda", "iiwa", "xarm", "ur5e"};
constexpr double kDt = 1.0 / 60;  // s

class PalmControl : public testing::Test {
 protected:
  void SetUp() override { register_builtin_tasks(); }
};

// One Shadow Hand on an arm that may go anywhere, without gravity for what could drive it off its commands.
struct Led {
  explicit Led(const char* arm, std::vector<OptionInput> more = {})
      : pool("grasp", 1, options(arm, std::move(more))), arm_links(RobotRef(find_robot(arm))->links.count) {
    pool->reset(nullptr, nullptr);
    pool->task().hold_action(held.data());
  }
  static std::vector<OptionInput> options(const char* arm, std::vector<OptionInput> more) {
    std::vector<OptionInput> out = {{"arm", arm, 0},
                                    {"control", "ik", 0},
                                    {"arm_range", nullptr, 0},
                                    {"joint_noise", nullptr, 0},
                                    {"max_steps", nullptr, 1000}};
    out.insert(out.end(), more.begin(), more.end());
    return out;
  }
  const Motion& palm() {
    return pool->world(0).link(pool->task().scene().link_offset[0] + arm_links + kShadowHand.palm);
  }
  Vec3 point() { return palm().X * kShadowHand.p_hold; }
  // `steps` with these entries of the palm, the fingers as they are held, then 1.5 s for the arm to arrive.
  void go(const double (&entries)[6], int steps) {
    for (int t = 0; t < steps + 90; ++t) {
      std::copy(held.begin(), held.end(), pool.action(0));
      for (int k = 0; k < 6; ++k) pool.action(0)[k] = t < steps ? static_cast<float>(entries[k]) : 0.0f;
      pool->step(nullptr);
    }
  }
  TestPool pool;
  int32_t arm_links;
  std::vector<float> held = std::vector<float>(26);
};

// Angle of the turn from a to b, rad.
double turn(const Quat& a, const Quat& b) {
  const Quat d = b * conjugate(a);
  return 2 * std::atan2(std::hypot(d.x, d.y, d.z), std::abs(d.w));
}

TEST_F(PalmControl, SixEntriesStandInsteadOfTheArms) {
  for (const char* arm : kArms) {
    Led led(arm);
    EXPECT_EQ(led.pool->task().action_dim(), 6 + 20) << arm;
    const std::string order = led.pool->task().action_order();
    EXPECT_EQ(order, std::string("right palm velocity, palm angular velocity, joints of ") + arm + "+shadow");
    const int32_t first = led.pool->task().scene().link_offset[0];
    EXPECT_EQ(led.pool->task().action_of(first), -1);
    EXPECT_EQ(led.pool->task().action_of(first + led.arm_links), 6);  // the wrist's first joint
    for (int k = 0; k < 6; ++k) EXPECT_EQ(led.held[static_cast<size_t>(k)], 0);
    for (const FieldSpec& f : led.pool->task().fields())
      if (f.name == "right.action") {
        EXPECT_EQ(f.count, 26);
      }
  }
}

TEST_F(PalmControl, ThePalmGoesAsFarAsItIsTold) {
  constexpr int kSteps = 12;
  for (const char* arm : kArms)
    for (int axis = 0; axis < 3; ++axis)
      for (const double sign : {-1.0, 1.0}) {
        Led led(arm);
        led.go({0, 0, 1, 0, 0, 0}, 15);  // clear of cube and ground
        const Vec3 before = led.point();
        const Quat facing = led.palm().X.q;
        double entries[6] = {};
        entries[axis] = sign;
        led.go(entries, kSteps);
        Vec3 way = led.point() - before;
        way[axis] -= sign * 0.5 * kSteps * kDt;  // ik_speed
        EXPECT_LT(norm(way), 0.003) << arm << ' ' << axis << ' ' << sign;
        EXPECT_LT(turn(facing, led.palm().X.q), 0.01) << arm << ' ' << axis << ' ' << sign;
      }
}

TEST_F(PalmControl, ThePalmTurnsAboutWhatItHolds) {
  constexpr int kSteps = 24;  // slowly: near a singular pose joints are at their speeds' limits
  for (const char* arm : kArms)
    for (int axis = 0; axis < 3; ++axis) {
      Led led(arm, {{"ik_spin", nullptr, 0.75}});
      led.go({0, 0, 1, 0, 0, 0}, 15);
      const Vec3 before = led.point();
      const Quat facing = led.palm().X.q;
      double entries[6] = {};
      entries[3 + axis] = 1;
      led.go(entries, kSteps);
      EXPECT_LT(norm(led.point() - before), 0.003) << arm << ' ' << axis;
      Vec3 along{};
      along[axis] = 1;
      EXPECT_LT(turn(axis_angle(along, 0.75 * kSteps * kDt) * facing, led.palm().X.q), 0.03)
          << arm << ' ' << axis;
    }
}

TEST_F(PalmControl, NothingDriftsWhereNothingIsSaid) {
  for (const char* arm : kArms) {
    Led led(arm);
    led.go({}, 10);
    const Vec3 before = led.point();
    led.go({}, 300);
    EXPECT_LT(norm(led.point() - before), 1e-4) << arm;
  }
}

// Out of its reach the arm ends stretched, within its limits, and comes back, slowly at first.
TEST_F(PalmControl, TheEndOfItsReachIsNoTrap) {
  for (const char* arm : kArms) {
    Led led(arm);
    led.go({0, 0, 1, 0, 0, 0}, 400);
    const World& w = led.pool->world(0);
    for (int32_t i = 0; i < led.arm_links; ++i) {
      const JointDef& j = w.scene().link(i).joint;
      EXPECT_GE(w.q()[i], j.lower - 1e-2) << arm << ' ' << i;
      EXPECT_LE(w.q()[i], j.upper + 1e-2) << arm << ' ' << i;
    }
    const double high = led.point().z;
    led.go({0, 0, -1, 0, 0, 0}, 90);
    EXPECT_LT(led.point().z, high - 0.1) << arm;
    EXPECT_EQ(led.pool->stats().diverged, 0) << arm;
  }
}

TEST_F(PalmControl, BytesAreTheSameForAnyThreadsAndAfterARestore) {
  const auto options = Led::options("ur5e", {});
  PoolConfig three;
  three.num_threads = 3;
  TestPool a("grasp", 4, options), b("grasp", 4, options, three);
  for (TestPool* p : {&a, &b}) {
    (*p)->reset(nullptr, nullptr);
    for (int t = 0; t < 20; ++t) (*p)->baseline(Baseline::kRandom), (*p)->step(nullptr);
  }
  EXPECT_EQ(a->hash(-1), b->hash(-1));
  const auto saved = a.state();
  const auto play = [](TestPool& p) {
    for (int t = 0; t < 10; ++t) p->baseline(Baseline::kRandom), p->step(nullptr);
    return p->hash(-1);
  };
  const uint64_t after = play(a);
  b->set_state(-1, saved.data(), saved.size());
  EXPECT_EQ(play(b), after);
}

TEST_F(PalmControl, HandsWithoutArmsAreRefused) {
  try {
    TestPool p("grasp", 1, {{"control", "ik", 0}});
    ADD_FAILURE();
  } catch (const Error& e) {
    EXPECT_EQ(e.code, Code::kUnsupported);
    EXPECT_NE(std::string(e.text).find("arm=NAME"), std::string::npos) << e.text;
  }
}

// One hand on an arm, the other without: its joints keep their entries.
TEST_F(PalmControl, EachHandByItself) {
  TestPool p("hand_over_safe_finger", 1, {{"left.arm", "ur5e", 0}, {"control", "ik", 0}});
  EXPECT_EQ(p->task().action_dim(), 20 + 6 + 20);
  p->reset(nullptr, nullptr);
  for (int t = 0; t < 8; ++t) p->baseline(Baseline::kRandom), p->step(nullptr);
  EXPECT_EQ(p->stats().diverged, 0);
}

}  // namespace
}  // namespace rdm::test
