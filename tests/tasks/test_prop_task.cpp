#include "prop_tasks.hpp"
#include "tasks/hand/hands.hpp"

namespace rdm::test {
namespace {

constexpr const char* kTasks[] = {"jenga", "pick_bottles", "clean_house"};

// Velocity of the centre of mass of the right hand with its forearm.
Vec3 velocity(const World& world) {
  const Scene& scene = world.scene();
  const auto of = [](const Motion& m, const Inertia& i) {
    return i.mass * (m.v + cross(m.w, rotate(m.X.q, i.com)));
  };
  Vec3 sum = of(world.base(0), scene.def.articulations[0].base);
  double mass = scene.def.articulations[0].base.mass;
  for (int32_t i = 0; i < kHandJoints; ++i) {
    sum += of(world.link(i), scene.link(i).inertia);
    mass += scene.link(i).inertia.mass;
  }
  return (1 / mass) * sum;
}

// Specification, section 2.4: end speeds of a full force along each axis, and nothing moves without.
TEST(PropTask, BasesFlyAtTheirEndSpeed) {
  register_builtin_tasks();
  const double speeds[] = {0.333, 0.333, 0.667};
  for (int i = 0; i < 3; ++i) {
    TestPool p(kTasks[i], 1, i == 0 ? OptionList{} : OptionList{{"palm_limit", nullptr, 10}});
    p->reset(nullptr, nullptr);
    for (int t = 0; t < 12; ++t) {
      p->baseline(Baseline::kHold);
      p.action(0)[20] = i == 0 ? 0.0f : 1.0f;  // away from things
      p.action(0)[22] = 1;
      p->step(nullptr);
    }
    EXPECT_NEAR(velocity(p->world(0)).z, speeds[i], 0.05 * speeds[i]) << kTasks[i];
    EXPECT_LT(norm(p->world(0).base(1).v), 0.01) << kTasks[i];
  }
}

TEST(PropTask, HandsBeginWithTheThumbFolded) {
  register_builtin_tasks();
  for (const char* task : kTasks) {
    TestPool p(task, 1);
    p->reset(nullptr, nullptr);
    for (const int first : {0, kHandJoints}) {
      EXPECT_NEAR(p->world(0).q()[first + 19], -1.04, 1e-6);
      EXPECT_NEAR(p->world(0).q()[first + 20], 1.2, 1e-6);
      EXPECT_NEAR(p->world(0).q()[first + 23], -1.57, 1e-6);
    }
    run(p, Baseline::kHold, 30);
    EXPECT_NEAR(p->world(0).q()[19], -1.04, 0.02);
    EXPECT_LT(norm(p->world(0).base(0).v), 0.01) << task;
  }
}

TEST(PropTask, JointNoiseDrawsTheHands) {
  register_builtin_tasks();
  for (const char* task : kTasks) {
    TestPool p(task, 2, {{"joint_noise", nullptr, 0.05}});
    p->reset(nullptr, nullptr);
    EXPECT_NE(p->world(0).q()[3], p->world(1).q()[3]);
    EXPECT_NE(p->world(0).q()[3], p->world(0).q()[3 + kHandJoints]);
  }
}

TEST(PropTask, BothActionOrdersPushTheSameWay) {
  register_builtin_tasks();
  const auto place = [](const char* order, int entry) {
    TestPool p("clean_house", 1, {{"action_order", order, 0}});
    p->reset(nullptr, nullptr);
    for (int t = 0; t < 5; ++t) {
      p->baseline(Baseline::kHold);
      p.action(0)[entry] = 0.5f;
      p->step(nullptr);
    }
    return p->world(0).base(0).X.p;
  };
  EXPECT_EQ(norm(place("paper", 20) - place("legacy", 0)), 0);
}

}  // namespace
}  // namespace rdm::test
