// Every hand on every arm begins free: no arm in the ground, in things, in the other arm or in itself, no
// hand in things; and the task's own hands stand where they always stood.
#include <gtest/gtest.h>

#include <string>

#include "tasks/catalog.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

constexpr const char* kHands[] = {"shadow", "allegro", "svh", "barrett", "robotiq"};
constexpr const char* kArms[] = {"none", "panda", "irb4600",  "jaco", "iiwa",
                                 "xarm", "ur5e",  "crb15000", "ur10e"};

// What geometry forbids. An empty text stands for any.
struct Exception {
  const char *task, *hand, *arm, *shape, *reason;
};
constexpr Exception kExceptions[] = {
    {"", "allegro", "panda", "th_proximal", "the folded thumb lies 0.4 mm deep in the flange's collar"},
    // forearm and wrist of a 2.5 m arm do not fit between the ground and the hand
    {"grasp", "", "irb4600", "link_4", "the hand lies 0.1 m above the ground"},
    {"hand_over_safe_finger", "robotiq", "irb4600", "link_", "the gripper looks up, 0.5 m above it"},
    {"catch_underarm_safe_finger", "robotiq", "irb4600", "link_", "the gripper looks up, 0.5 m above it"},
    {"hand_over_wall", "robotiq", "irb4600", "link_", "the gripper looks up, 0.5 m above it"},
    {"reorient", "robotiq", "irb4600", "link_3", "the gripper looks up, 0.5 m above it"},
};

bool excepted(const std::string& task, const std::string& hand, const std::string& arm,
              const std::string& pair) {
  const auto is = [](const char* a, const std::string& b) { return !*a || a == b; };
  for (const Exception& e : kExceptions)
    if (is(e.task, task) && is(e.hand, hand) && is(e.arm, arm) && pair.find(e.shape) != std::string::npos)
      return true;
  return false;
}

class FreeStart : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override { register_builtin_tasks(); }
};

TEST_P(FreeStart, NothingTouches) {
  constexpr double kDeep = 0.002;  // m: a thing lies on a hand, or one that falls has met it
  const std::string task = GetParam();
  for (const char* hand : kHands)
    for (const char* arm : kArms) {
      if (std::string(arm) == "none" && std::string(hand) == "shadow") continue;  // the task's own
      TestPool p(GetParam(), 1, {{"hand", hand, 0}, {"arm", arm, 0}, {"joint_noise", nullptr, 0}});
      p->reset(nullptr, nullptr);
      p->baseline(Baseline::kHold);
      p->step(nullptr);
      const World& world = p->world(0);
      EXPECT_EQ(p.rows().status[0], 0u) << task << " " << hand << " on " << arm;
      for (int32_t i = 0; i < world.num_contacts(); ++i) {
        const Contact& c = world.contacts()[i];
        const SceneShape &a = world.scene().shapes[static_cast<size_t>(c.shape_a)],
                         &b = world.scene().shapes[static_cast<size_t>(c.shape_b)];
        if (a.articulation < 0 && b.articulation < 0) continue;
        const bool thing = a.carrier == Carrier::kBody || b.carrier == Carrier::kBody;
        if (thing && c.depth < kDeep) continue;
        const std::string pair = std::string(a.def.name.text) + " and " + b.def.name.text;
        if (excepted(task, hand, arm, pair)) continue;
        ADD_FAILURE() << task << ", " << hand << " on " << arm << ": " << pair << " are " << 1e3 * c.depth
                      << " mm in each other";
      }
    }
}
INSTANTIATE_TEST_SUITE_P(Tasks, FreeStart,
                         testing::Values("hand_over_safe_finger", "catch_underarm_safe_finger",
                                         "hand_over_wall", "grasp", "reorient", "jenga", "pick_bottles",
                                         "clean_house"),
                         [](const auto& info) { return std::string(info.param); });

// No pair of robots loses contacts in the tower.
TEST(FreeStartRoom, NoContactIsLost) {
  register_builtin_tasks();
  for (const char* hand : kHands)
    for (const char* arm : {"none", "ur5e"}) {
      TestPool p("jenga", 2, {{"hand", hand, 0}, {"arm", arm, 0}});
      p->reset(nullptr, nullptr);
      for (int t = 0; t < 60; ++t) p->baseline(Baseline::kRandom), p->step(nullptr);
      EXPECT_EQ(p->stats().overflowed, 0) << hand << " on " << arm << " " << p->stats().contacts_max;
    }
}

// Room for contacts follows from the robots; that of the task's own is what it always was.
TEST(FreeStartRoom, ContactsFollowFromTheRobots) {
  register_builtin_tasks();
  const auto most = [](std::initializer_list<OptionInput> options) {
    return TestPool("jenga", 1, options)->options().integer("contacts_max");
  };
  EXPECT_EQ(most({}), 256);
  EXPECT_EQ(most({{"hand", "shadow", 0}}), 256);
  EXPECT_GT(most({{"hand", "robotiq", 0}}), 256);
  EXPECT_GT(most({{"hand", "robotiq", 0}, {"arm", "ur5e", 0}}), most({{"hand", "robotiq", 0}}));
  EXPECT_EQ(most({{"arm", "ur5e", 0}, {"contacts_max", nullptr, 64}}), 64);
}

}  // namespace
}  // namespace rdm::test
