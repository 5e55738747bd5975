#include <algorithm>
#include <cmath>

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
  for (int32_t i = 0; i < kShadowHand.links.count; ++i) {
    sum += of(world.link(i), scene.link(i).inertia);
    mass += scene.link(i).inertia.mass;
  }
  return (1 / mass) * sum;
}

// End speeds of a full force, transition_scale 1e5/60 N over 100/s times the hand's 5.01 kg; and nothing
// moves without.
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
    for (const int first : {0, kShadowHand.links.count}) {
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
    EXPECT_NE(p->world(0).q()[3], p->world(0).q()[3 + kShadowHand.links.count]);
  }
}

// Starts within the draw, each its own, of which no two episodes are the same; the hands hold them.
TEST(PropTask, ResetNoiseMovesThingsWithinItsBound) {
  register_builtin_tasks();
  constexpr double kNoise = 0.005;
  for (const char* task : kTasks) {
    TestPool still(task, 1, {{"reset_noise", nullptr, 0}}),
        p(task, 6, {{"reset_noise", nullptr, kNoise}, {"joint_noise", nullptr, 0.01}});
    still->reset(nullptr, nullptr);
    p->reset(nullptr, nullptr);
    double most = 0, apart = 0;
    for (int32_t i = 0; i < 6; ++i)
      for (int32_t b = 0; b < p->task().scene().num_bodies; ++b) {
        const Vec3 way = p->world(i).body(b).X.p - still->world(0).body(b).X.p;
        EXPECT_LE(std::abs(way.x), kNoise) << task;
        EXPECT_LE(std::abs(way.y), kNoise) << task;
        EXPECT_EQ(way.z, 0) << task;
        most = std::max(most, norm(way));
        apart = std::max(apart, norm(way - (p->world(0).body(b).X.p - still->world(0).body(b).X.p)));
      }
    EXPECT_GT(most, 0.2 * kNoise) << task;
    EXPECT_GT(apart, 0.2 * kNoise) << task;
    run(p, Baseline::kHold, 20);
    EXPECT_EQ(p->stats().diverged, 0) << task;
    for (int32_t i = 0; i < 6; ++i) EXPECT_FALSE(p.ended(i)) << task;
  }
}

// With base_angles=signed they are the same angles in [-pi, pi], never cut at the bound of observations.
TEST(PropTask, SignedBaseAnglesAreNeverCut) {
  register_builtin_tasks();
  for (const char* task : kTasks) {
    TestPool p(task, 4, {{"base_angles", "signed", 0}}), q(task, 4);
    p->reset(nullptr, nullptr);
    q->reset(nullptr, nullptr);
    const float limit = p->task().obs_limit();
    int below = 0, cut = 0;
    for (int t = 0; t < 40; ++t) {
      for (int32_t i = 0; i < 4; ++i)
        for (const char* field : {"right.base_angles", "left.base_angles"})
          for (int k = 0; k < 3; ++k) {
            const int32_t at = offset_of(p->task(), field) + k;
            const float angle = p.obs(i)[at], positive = q.obs(i)[at];
            EXPECT_LE(std::abs(angle), 3.14160f) << task;
            below += angle < 0;
            cut += positive == limit;
            const double whole = static_cast<double>(angle) + (angle < 0 ? 2 * kPi : 0);
            EXPECT_NEAR(static_cast<double>(positive), std::min(static_cast<double>(limit), whole), 1e-6);
          }
      p->baseline(Baseline::kRandom);
      q->baseline(Baseline::kRandom);
      p->step(nullptr);
      q->step(nullptr);
    }
    EXPECT_GT(below, 0) << task;
    EXPECT_GT(cut, 0) << task << ": the default's angles reach the bound";
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
