#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "articulated.hpp"
#include "isa_scope.hpp"

namespace rdm {
namespace {

constexpr int32_t kWorlds = 9;

SceneDef fixed_hands() {
  test::TwoHands config;
  config.hand_hand = true;
  config.solver.contacts_max = 128;
  return test::two_hands_def(config);
}

SceneDef free_hands() {
  SceneDef def = fixed_hands();
  for (ArticulationDef& a : def.articulations) {
    a.free_base = true;
    a.base_damping = 20;
  }
  def.articulations[1].X_WB.p = {0, -0.8, 0.5};
  return def;
}

// A fixed hand and a free one, which is a tree of its own, and a slider under a box.
SceneDef mixed() {
  SceneDef def = free_hands();
  def.articulations[0].free_base = false;
  ArticulationDef slider;
  slider.X_WB.p = {0, -0.4, 0.2};
  slider.gravity = true;
  LinkDef link;
  link.inertia = box_inertia(0.3, {0.1, 0.05, 0.02});
  link.joint.kind = JointKind::kPrismatic;
  link.joint.lower = -0.1;
  link.joint.upper = 0.1;
  link.joint.kp = 200;
  link.joint.kd = 5;
  link.joint.effort = 30;
  link.sensor = true;
  slider.links.push_back(link);
  ArticulationShape shape;
  shape.link = 0;
  shape.shape.kind = ShapeKind::kBox;
  shape.shape.size = {0.1, 0.05, 0.02};
  slider.shapes.push_back(shape);
  def.articulations.push_back(slider);
  BodyDef box;
  box.X_WB.p = {0.01, -0.4, 0.26};
  box.inertia = box_inertia(0.1, {0.03, 0.02, 0.04});
  shape.shape.size = {0.03, 0.02, 0.04};
  box.shapes.push_back(shape.shape);
  def.bodies.push_back(box);
  return def;
}

// World `i`'s own targets, pushes and changes from outside.
void drive(World& world, Stream& random, int k) {
  test::random_targets(world, random);
  const Scene& scene = world.scene();
  if (k % 3 == 0) {
    const auto link = static_cast<int32_t>(random.below(static_cast<uint32_t>(scene.num_links)));
    world.push_link(link, 3 * Vec3{random.signed_unit(), random.signed_unit(), random.signed_unit()},
                    world.link(link).X * Vec3{0, 0, 0.02});
    world.push_body(0, {0.1 * random.signed_unit(), 0, 0.2 * random.uniform()}, {0, 1e-3, 0});
  }
  for (int32_t a = 0; a < static_cast<int32_t>(scene.def.articulations.size()); ++a)
    if (k % 4 == 1 && scene.def.articulations[static_cast<size_t>(a)].free_base)
      world.push_base(a, {30 * random.signed_unit(), 30 * random.signed_unit(), 0},
                      {0, random.signed_unit(), 0});
  if (k % 25 == 0) {
    const double x = 0.01 * random.signed_unit();
    world.set_body(0, {{{x, -0.36, 0.55}, {}}, {}, {0, 0, 1}});
  }
  if (k == 20) {
    double q[24], still[24] = {};
    for (double& x : q) x = random.signed_unit();
    world.set_joints(1, q, still);
  }
}

struct Outcome {
  std::vector<uint64_t> hashes;  // of each world, each tenth step
  int64_t contacts = 0;
};

// Steps kWorlds worlds in groups of `together`; 0: each by World::step, in turn and all in memory of their
// own.
Outcome play(SceneDef def, int32_t lanes, int32_t together, int steps = 40) {
  def.solver.lanes = lanes;
  std::vector<std::unique_ptr<test::Simulation>> own;
  std::unique_ptr<test::Partners> shared;
  std::vector<World*> worlds;
  if (together == 0) {
    for (int32_t i = 0; i < kWorlds; ++i)
      own.push_back(std::make_unique<test::Simulation>(def, EngineKind::kArticulated));
    for (const auto& sim : own) worlds.push_back(&**sim);
  } else {
    shared = std::make_unique<test::Partners>(def, kWorlds);
    for (int32_t i = 0; i < kWorlds; ++i) worlds.push_back(&(*shared)[i]);
  }
  std::vector<Stream> streams;
  for (int32_t i = 0; i < kWorlds; ++i) streams.emplace_back(8, static_cast<uint32_t>(i), Purpose::kTest);
  Outcome out;
  for (int k = 0; k < steps; ++k) {
    for (size_t i = 0; i < worlds.size(); ++i) drive(*worlds[i], streams[i], k);
    for (int32_t first = 0; first < kWorlds; first += std::max(together, 1))
      if (together == 0)
        worlds[static_cast<size_t>(first)]->step();
      else
        World::step_together(worlds.data() + first, std::min(together, kWorlds - first));
    for (World* world : worlds) {
      EXPECT_EQ(world->status() & ~kStatusUnconverged, 0u);
      out.contacts += world->num_contacts();
      if (k % 10 == 9) out.hashes.push_back(test::state_hash(*world));
    }
  }
  return out;
}

struct SceneCase {
  const char* name;
  SceneDef (*def)();
};
void PrintTo(const SceneCase& c, std::ostream* out) {
  *out << c.name;
}
class StepperScenes : public testing::TestWithParam<SceneCase> {};
INSTANTIATE_TEST_SUITE_P(, StepperScenes,
                         testing::Values(SceneCase{"fixed", fixed_hands}, SceneCase{"free", free_hands},
                                         SceneCase{"mixed", mixed}),
                         [](const auto& info) { return info.param.name; });

TEST_P(StepperScenes, LanesGroupsAndInstructionSetsChangeNoBit) {
  const IsaScope scope;
  ASSERT_TRUE(set_stepper_isa(kBaseIsa));
  const Outcome want = play(GetParam().def(), 1, 0);
  EXPECT_GT(want.contacts, 500);
  std::vector<uint64_t> distinct = want.hashes;
  std::sort(distinct.begin(), distinct.end());
  EXPECT_EQ(std::unique(distinct.begin(), distinct.end()), distinct.end());  // no two worlds do the same
  for (const char* isa : {kBaseIsa, kV3Isa, kV4Isa}) {
    if (!set_stepper_isa(isa)) continue;
    EXPECT_STREQ(stepper_isa(), isa);
    const auto expect_same = [&](int32_t lanes, int32_t together) {
      EXPECT_EQ(play(GetParam().def(), lanes, together).hashes, want.hashes)
          << isa << ", " << lanes << " lanes, groups of " << together;
    };
    for (const int32_t lanes : {1, 4, 8, 16})
      for (const int32_t together : {0, 3, 9}) expect_same(lanes, together);
    for (int32_t together = 0; together <= kWorlds; ++together) expect_same(0, together);
  }
}

TEST_P(StepperScenes, AWorldDoesNotFeelWhatItsPartnersDiverge) {
  SceneDef def = GetParam().def();
  test::Partners group(def, 4);
  test::Simulation alone(def, EngineKind::kArticulated);
  Stream a(9, 0, Purpose::kTest), b = a;
  for (int k = 0; k < 30; ++k) {
    drive(group[1], a, k);
    drive(*alone, b, k);
    if (k % 7 == 3) group[2].push_link(3, {0, 1e30, 0}, {});
    if (k % 7 == 5) group[0].push_body(0, {1e300, 0, 0}, {});
    World::step_together(group.data(), 4);
    alone->step();
    EXPECT_EQ((group[2].status() & kStatusDiverged) != 0, k % 7 == 3) << k;
    EXPECT_EQ((group[0].status() & kStatusDiverged) != 0, k % 7 == 5) << k;
    ASSERT_EQ(test::state_hash(group[1]), test::state_hash(*alone)) << k;
  }
}

TEST(Stepper, DoublePrecisionIsCloseAtEveryStep) {
  double square = 0, worst = 0;
  int64_t count = 0;
  for (uint32_t seed = 0; seed < 8; ++seed) {
    test::Simulation single(fixed_hands(), EngineKind::kArticulated);
    SceneDef def = fixed_hands();
    def.solver.double_precision = true;
    test::Simulation wide(def, EngineKind::kArticulated);
    Stream a(10, seed, Purpose::kTest), b = a;
    for (int k = 0; k < 30; ++k) {
      if (k % 10 == 0) {
        test::random_targets(*single, a);
        test::random_targets(*wide, b);
      }
      single->step();
      wide->step();
      for (int32_t i = 0; i < single.scene().num_links; ++i, ++count) {
        const double off = single->q()[i] - wide->q()[i];
        square += off * off;
        worst = std::max(worst, std::fabs(off));
      }
    }
  }
  EXPECT_LT(std::sqrt(square / static_cast<double>(count)), 1e-5);
  EXPECT_GT(worst, 0);  // they are two
}

TEST(Stepper, GroupsFillTheLanes) {
  const auto size = [](SceneDef def, int32_t lanes, bool wide = false) {
    def.solver.lanes = lanes;
    def.solver.double_precision = wide;
    return test::Simulation(def, EngineKind::kArticulated)->group_size();
  };
  const bool sixteen = std::strcmp(stepper_isa(), kV4Isa) == 0;
  EXPECT_EQ(size(fixed_hands(), 0), sixteen ? 8 : 4);  // two hands a world
  EXPECT_EQ(size(fixed_hands(), 16), sixteen ? 8 : 4);
  EXPECT_EQ(size(fixed_hands(), 8), 4);
  EXPECT_EQ(size(fixed_hands(), 4), 2);
  EXPECT_EQ(size(fixed_hands(), 1), 1);
  EXPECT_EQ(size(fixed_hands(), 0, true), 1);
  EXPECT_EQ(size(mixed(), 8), 8);  // three trees of one member
}

TEST(Stepper, UnknownInstructionSetsAreRefused) {
  const std::string before = stepper_isa();
  EXPECT_FALSE(set_stepper_isa("x86-64-v9"));
  EXPECT_FALSE(set_stepper_isa(""));
  EXPECT_EQ(stepper_isa(), before);
}

}  // namespace
}  // namespace rdm
