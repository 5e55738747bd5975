#include <gtest/gtest.h>

#include <limits>

#include "base/error.hpp"
#include "base/rng.hpp"
#include "heap_count.hpp"
#include "physics/articulated_world.hpp"
#include "two_hands.hpp"

namespace rdm {
namespace {

constexpr EngineKind kKind = EngineKind::kArticulated;

void random_targets(World& world, Stream& random) {
  double share[24];
  for (int hand = 0; hand < 2; ++hand) {
    for (double& s : share) s = random.uniform();
    test::target_share(world, hand, share);
  }
}

SceneDef box_on_ground(double mass) {
  SceneDef def;
  BodyDef body;
  body.X_WB.p = {0, 0, 0.05};
  body.inertia = box_inertia(mass, {0.05, 0.05, 0.05});
  ShapeDef shape;
  shape.kind = ShapeKind::kBox;
  shape.size = {0.05, 0.05, 0.05};
  body.shapes.push_back(shape);
  def.bodies.push_back(body);
  ShapeDef ground;
  ground.kind = ShapeKind::kPlane;
  def.statics.push_back(ground);
  return def;
}

TEST(ArticulatedWorld, StepsWithoutTheHeap) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is not counted under sanitizers";
  test::Simulation sim(test::two_hands_def(), kKind);
  Stream random(1, 0, Purpose::kTest);
  const double zero[24] = {};
  const int64_t before = heap_count();
  for (int k = 0; k < 500; ++k) {
    random_targets(*sim, random);
    if (k % 75 == 0) {
      sim->set_joints(0, zero, zero);
      sim->set_body(0, {{{0, -0.36, 0.56}, {}}, {}, {}});
      (void)sim->body_overlap(0);
    }
    sim->step();
  }
  EXPECT_EQ(heap_count() - before, 0);
}

TEST(ArticulatedWorld, TakesTheMemoryItAnnounces) {
  const Scene scene = make_scene(test::two_hands_def());
  Arena first, other;
  World::measure(kKind, scene, first);
  World::measure(kKind, scene, other, true);
  EXPECT_LT(other.used(), first.used() / 4);
  Arena arena(HostHooks{}, first.used() + other.used());
  World* one = World::create(kKind, scene, arena, HostHooks{});
  EXPECT_EQ(arena.used(), first.used());
  World* two = World::create(kKind, scene, arena, HostHooks{}, one);
  EXPECT_EQ(arena.used(), first.used() + other.used());
  World::destroy(one, HostHooks{});  // the other one goes on
  two->step();
  EXPECT_EQ(two->status(), 0u);
  World::destroy(two, HostHooks{});
}

TEST(ArticulatedWorld, NanTargetIsFlaggedAndReplaced) {
  test::Simulation sim(test::two_hands_def(), kKind);
  sim->target()[3] = std::numeric_limits<double>::quiet_NaN();
  sim->step();
  EXPECT_EQ(sim->status(), kStatusDiverged);
  EXPECT_TRUE(std::isfinite(sim->target()[3]));
  sim->step();
  EXPECT_EQ(sim->status(), 0u);
}

TEST(ArticulatedWorld, RefusesWhatIsNotFiniteOrFixed) {
  test::Simulation sim(test::two_hands_def(), kKind);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(sim->set_body(0, {{{nan, 0, 0}, {}}, {}, {}}), Error);
  EXPECT_THROW(sim->set_base(0, {}), Error);
  EXPECT_THROW(sim->push_base(0, {1, 0, 0}, {}), Error);
  EXPECT_THROW(sim->push_body(0, {nan, 0, 0}, {}), Error);
  EXPECT_THROW(sim->push_link(0, {nan, 0, 0}, {}), Error);
}

// A push lasts one control step of h x substeps.
TEST(ArticulatedWorld, APushGivesForceTimesTime) {
  test::TwoHands config;
  config.ball_mass = 0.5;
  SceneDef def = test::two_hands_def(config);
  def.gravity = {};
  def.bodies[0].X_WB.p = {3, 0, 3};
  test::Simulation sim(def, kKind);
  sim->push_body(0, {6, 0, 0}, {});
  sim->step();
  EXPECT_NEAR(sim->body(0).v.x, 6.0 / 60 / 0.5, 1e-12);
  sim->step();
  EXPECT_NEAR(sim->body(0).v.x, 6.0 / 60 / 0.5, 1e-12);
}

TEST(ArticulatedWorld, ContactForcesCarryTheWeight) {
  test::Simulation sim(box_on_ground(0.7), kKind);
  for (int k = 0; k < 600; ++k) sim->step();
  Vec3 sum;
  for (int32_t i = 0; i < sim->num_contacts(); ++i) sum += sim->contacts()[i].force;
  EXPECT_NEAR(sum.z, 0.7 * 9.81, 0.01 * 0.7 * 9.81);
  EXPECT_NEAR(sum.x, 0, 0.01);
  EXPECT_LT(norm(sim->body(0).v), 1e-4);
}

TEST(ArticulatedWorld, AJointHeldAtItsBoundGivesItsEffort) {
  SceneDef def = test::two_hands_def();
  def.hand_hand_contact = false;
  for (ArticulationDef& a : def.articulations) a.self_pairs.clear();
  test::Simulation sim(def, kKind);
  // 1 N m and more on the wrist's second joint, whose drive gives at most its effort
  const JointDef& joint = sim.scene().link(1).joint;
  const Motion palm = sim->link(1);
  for (int k = 0; k < 30; ++k) {
    sim->push_link(1, {0, 0, -60}, sim->link(1).X.p + 0.1 * normalized(sim->link(7).X.p - palm.X.p));
    sim->step();
  }
  EXPECT_GE(std::fabs(sim->torque()[1]), joint.effort * 0.999);
}

}  // namespace
}  // namespace rdm
