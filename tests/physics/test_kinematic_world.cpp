#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "base/error.hpp"
#include "physics/kinematic_world.hpp"
#include "tasks/planar/planar_scene.hpp"
#include "two_hands.hpp"

namespace rdm {
namespace {

class KinematicWorldTest : public testing::Test {
 protected:
  KinematicWorldTest()
      : scene(PlanarScene(0.02)
                  .body("a", ShapeKind::kSphere, {0.1, 0, 0}, kMarkBlue)
                  .body("b", ShapeKind::kBox, {0.1, 0.1, 0.1}, kMarkRed, {{0, 0, 1}, {}})
                  .build()) {
    Arena measuring;
    World::measure(EngineKind::kKinematic, scene, measuring);
    arena = Arena(HostHooks{}, measuring.used());
    world = World::create(EngineKind::kKinematic, scene, arena, HostHooks{});
  }
  ~KinematicWorldTest() override { World::destroy(world, HostHooks{}); }
  Scene scene;
  Arena arena;
  World* world;
};

TEST_F(KinematicWorldTest, BodiesStayWhereTheyArePut) {
  EXPECT_EQ(arena.used(), arena.capacity());
  EXPECT_EQ(World::engine_bytes(EngineKind::kKinematic, scene), 0u);
  const Motion m = planar_motion({1, 2, 3}, 0.5, 4, 5, 6);
  world->set_body(1, m);
  for (int i = 0; i < 3; ++i) world->step();
  EXPECT_EQ(norm(world->body(1).X.p - m.X.p), 0);
  EXPECT_EQ(norm(world->body(1).v - m.v), 0);
  EXPECT_EQ(norm(world->body(0).X.p), 0);
  EXPECT_EQ(norm(world->shape_pose(1).p - Vec3{1, 2, 4}), 0);
  EXPECT_EQ(world->status(), 0u);
  EXPECT_EQ(world->num_contacts(), 0);
  EXPECT_EQ(world->joint_drift(), 0);
}

TEST_F(KinematicWorldTest, SavesAndLoads) {
  world->set_body(0, planar_motion({1, 2, 3}, 0.5));
  unsigned char bytes[1000];
  Writer out(bytes, sizeof bytes);
  world->save(out);
  ASSERT_TRUE(out.fits());
  world->set_body(0, {});
  Reader in(bytes, out.size(), "state");
  world->load(in);
  EXPECT_EQ(world->body(0).X.p.z, 3);
  EXPECT_EQ(in.left(), 0u);
}

TEST_F(KinematicWorldTest, EveryFieldOfAStateIsChecked) {
  world->set_body(0, planar_motion({1, 2, 3}, 0.5, 4, 5, 6));
  unsigned char good[1000];
  Writer out(good, sizeof good);
  world->save(out);
  ASSERT_EQ(out.size(), 2 * 13 * sizeof(double));
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (size_t at = 0; at < out.size(); at += sizeof(double))
    for (const double bad : {std::nan(""), kInfinity, -kInfinity, 1e300, -1e7}) {
      unsigned char bytes[sizeof good];
      std::memcpy(bytes, good, sizeof good);
      std::memcpy(bytes + at, &bad, sizeof bad);
      Reader in(bytes, out.size(), "state");
      EXPECT_THROW(world->load(in), Error) << at << ": " << bad;
      EXPECT_EQ(world->body(0).X.p.z, 3);
      EXPECT_EQ(world->body(0).w.z, 6);
    }
  Reader cut(good, out.size() - 1, "state");
  EXPECT_THROW(world->load(cut), Error);
  EXPECT_EQ(world->body(0).X.p.z, 3);
}

TEST_F(KinematicWorldTest, NothingCanBePushed) {
  EXPECT_THROW(world->push_body(0, {1, 0, 0}, {}), Error);
  EXPECT_THROW(world->push_link(0, {1, 0, 0}, {}), Error);
  EXPECT_THROW(world->push_base(0, {1, 0, 0}, {}), Error);
  EXPECT_THROW(world->set_base(0, {}), Error);
}

TEST_F(KinematicWorldTest, ArticulationsAreRefused) {
  const Scene hands = make_scene(test::two_hands_def());
  Arena measuring;
  EXPECT_THROW(World::measure(EngineKind::kKinematic, hands, measuring), Error);
}

}  // namespace
}  // namespace rdm
