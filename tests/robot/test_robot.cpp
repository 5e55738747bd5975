#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "base/error.hpp"
#include "robot/robots.hpp"
#include "robot_rows.hpp"
#include "two_hands.hpp"

namespace rdm {
namespace {

TEST(Robot, IsFoundByNumber) {
  EXPECT_EQ(&*RobotRef(0), &kShadowHand);
  EXPECT_THROW(RobotRef{-1}, Error);
  EXPECT_THROW(RobotRef{num_robots()}, Error);
}

TEST(Robot, TablesAreSound) {
  for (int32_t r = 0; r < num_robots(); ++r) {
    const RobotRef ref(r);
    const Robot& table = *ref;
    SceneDef def;
    def.articulations.push_back(make_articulation(table, Side::kRight, {}, ""));
    def.articulations[0].free_base = true;
    const Scene scene = make_scene(std::move(def));  // checks every number
    EXPECT_EQ(scene.num_links, table.links.count);
    for (const RobotTip& tip : table.tips) EXPECT_LT(tip.link, table.links.count);
    for (const RobotCoupling& c : table.couplings) {
      EXPECT_LT(c.link, table.links.count);
      EXPECT_FALSE(table.coupled(c.other)) << table.name;
    }
    EXPECT_GT(std::strlen(table.help), 0u);
    for (int32_t i = 0; i < table.links.count; ++i) {
      EXPECT_EQ(joint_row(table, table.links[i].joint), i);  // no name stands twice
      EXPECT_EQ(link_row(table, table.links[i].name), i);
    }
  }
}

// Fingers, roles and poses of every robot that has them.
TEST(Robot, HandsNameTheirFingers) {
  int hands = 0;
  for (int32_t r = 0; r < num_robots(); ++r) {
    const RobotRef ref(r);
    const Robot& table = *ref;
    if (table.fingers.count == 0) continue;
    ++hands;
    EXPECT_NE(table.palm, kNoLink) << table.name;
    ASSERT_EQ(table.fingers.count, table.tips.count) << table.name;
    for (int32_t i = 0; i < table.fingers.count; ++i) {
      const RobotFinger& f = table.fingers[i];
      EXPECT_GT(f.first, table.palm) << f.name;
      EXPECT_LE(f.first, table.tips[i].link) << f.name;
      for (const int32_t role : {f.lateral, f.proximal, f.middle}) {
        if (role < 0) continue;
        EXPECT_GE(role, f.first) << f.name;
        EXPECT_LE(role, table.tips[i].link) << f.name;
        EXPECT_GE(table.leading_action(role), 0) << f.name;
      }
      // what stands between a finger's first row and its tip belongs to it
      for (int32_t link = table.tips[i].link; link > f.first; --link)
        EXPECT_GE(table.links[link].parent, f.first) << f.name;
    }
    const int32_t folded = table.poses.folded.count, closed = table.poses.closed.count;
    EXPECT_TRUE(folded == 0 || folded == table.links.count) << table.name;
    EXPECT_TRUE(closed == 0 || closed == table.num_actuated()) << table.name;
    for (int32_t i = 0; i < folded; ++i) {
      EXPECT_GE(table.poses.folded[i], table.links[i].lower) << table.links[i].name;
      EXPECT_LE(table.poses.folded[i], table.links[i].upper) << table.links[i].name;
    }
    for (const float command : table.poses.closed) EXPECT_LE(std::abs(command), 1);
  }
  EXPECT_GT(hands, 0);
}

TEST(Robot, ActionsAndLinksAreInverse) {
  for (int32_t r = 0; r < num_robots(); ++r) {
    const RobotRef ref(r);
    const Robot& table = *ref;
    for (int32_t i = 0; i < table.num_actuated(); ++i) EXPECT_EQ(table.action_of(table.actuated(i)), i);
    for (const RobotCoupling& c : table.couplings) EXPECT_EQ(table.action_of(c.link), -1);
    EXPECT_EQ(table.action_of(-1), -1);
    EXPECT_EQ(table.action_of(table.links.count), -1);
  }
}

TEST(Robot, NamesGetThePrefix) {
  const ArticulationDef def = make_articulation(kShadowHand, Side::kLeft, {}, "left_");
  EXPECT_TRUE(def.name == "left_shadow_hand");
  EXPECT_TRUE(def.links[0].name == "left_wrist");
  EXPECT_TRUE(def.links[0].joint.name == "left_WRJ1");
  EXPECT_TRUE(def.shapes[0].shape.name == "left_forearm");
}

TEST(Robot, MirrorTwiceIsTheSame) {
  const Quat q = normalized(Quat{0.3, 0.5, -0.2, 0.7});
  const Vec3 v{1, 2, 3};
  for (int32_t axis = 0; axis < 3; ++axis) {
    const Vec3 back = mirrored_point(mirrored_point(v, axis), axis);
    EXPECT_EQ(norm(back - v), 0);
    // A turned point, mirrored, is the mirrored point turned by the mirrored turn.
    const Vec3 a = mirrored_point(rotate(q, v), axis),
               b = rotate(mirrored_turn(q, axis), mirrored_point(v, axis));
    EXPECT_LT(norm(a - b), 1e-12);
    // And so does an angular velocity times an arm.
    const Vec3 w{0.4, -0.1, 0.9};
    EXPECT_LT(
        norm(mirrored_point(cross(w, v), axis) - cross(mirrored_axis(w, axis), mirrored_point(v, axis))),
        1e-12);
  }
}

TEST(Robot, BothSidesShareLimitsAndMoments) {
  const ArticulationDef right = make_articulation(kShadowHand, Side::kRight, {}, ""),
                        left = make_articulation(kShadowHand, Side::kLeft, {}, "");
  for (size_t i = 0; i < right.links.size(); ++i) {
    EXPECT_EQ(right.links[i].joint.lower, left.links[i].joint.lower);
    EXPECT_EQ(right.links[i].joint.upper, left.links[i].joint.upper);
    EXPECT_EQ(right.links[i].inertia.mass, left.links[i].inertia.mass);
    EXPECT_EQ(right.links[i].inertia.com.y, -left.links[i].inertia.com.y);
  }
  // The hanging of the root turns y of the hand to -z of the base.
  EXPECT_NEAR(right.base.com.z, -left.base.com.z, 1e-15);
  EXPECT_NEAR(right.base.com.y, left.base.com.y, 1e-15);
  EXPECT_TRUE(positive_definite(moment_matrix(left.base)));
}

SceneDef floating_hand() {
  SceneDef def;
  def.articulations.push_back(make_articulation(kShadowHand, Side::kRight, {{0, 0, 0.5}, {}}, ""));
  def.articulations[0].free_base = true;
  def.articulations[0].base_damping = 100;
  return def;
}

TEST(Robot, PushedFreeBaseReachesTheSpeedOfItsDamping) {
  test::Simulation sim(floating_hand());
  for (int k = 0; k < 60; ++k) {
    sim->push_base(0, {0, 83.3, 0}, {});
    sim->step();
  }
  EXPECT_NEAR(sim->base(0).v.y, 83.3 / (100 * 5.01), 0.05 * 0.166);
  const double moved = sim->base(0).X.p.y;
  EXPECT_NEAR(moved, 0.166, 0.02);
  EXPECT_LT(sim->joint_drift(), 1e-12);
}

TEST(Robot, FreeBaseRestsWhenNothingPushes) {
  test::Simulation sim(floating_hand());
  for (int k = 0; k < 120; ++k) sim->step();
  EXPECT_LT(norm(sim->base(0).X.p - Vec3{0, 0, 0.5}), 1e-6);
  EXPECT_LT(norm(sim->base(0).v), 1e-6);
}

TEST(Robot, FreeBaseCarriesItsLinksAlong) {
  test::Simulation sim(floating_hand());
  const Pose X = {{1, 2, 3}, axis_angle({0, 0, 1}, 0.7)};
  sim->set_base(0, {X, {0.1, 0, 0}, {0, 0, 1}});
  test::Simulation fixed([&] {
    SceneDef def;
    def.articulations.push_back(make_articulation(kShadowHand, Side::kRight, X, ""));
    return def;
  }());
  for (int32_t i = 0; i < 24; ++i) {
    EXPECT_LT(norm(sim->link(i).X.p - fixed->link(i).X.p), 1e-12);
    const Vec3 v = Vec3{0.1, 0, 0} + cross({0, 0, 1}, sim->link(i).X.p - X.p);
    EXPECT_LT(norm(sim->link(i).v - v), 1e-12);
  }
  EXPECT_LT(norm(sim->shape_pose(0).p - fixed->shape_pose(0).p), 1e-12);
}

TEST(Robot, UndampedFreeBaseKeepsItsMomentum) {
  SceneDef def = floating_hand();
  def.articulations[0].base_damping = 0;
  def.solver.exact = true;
  def.solver.link_armature = 0;
  test::Simulation sim(def);
  const auto momentum = [&] {
    const Inertia& base = sim.scene().def.articulations[0].base;
    const auto of = [](const Inertia& inertia, const Motion& m) {
      return inertia.mass * (m.v + cross(m.w, rotate(m.X.q, inertia.com)));
    };
    Vec3 p = of(base, sim->base(0));
    for (int32_t i = 0; i < 24; ++i) p += of(sim.scene().link(i).inertia, sim->link(i));
    return p;
  };
  // Slowly curling fingers: inner forces only.
  for (int k = 0; k < 60; ++k) {
    for (int32_t i = 0; i < 24; ++i) {
      const JointDef& joint = sim.scene().link(i).joint;
      sim->target()[i] = 0.3 * k / 60 * joint.upper;
    }
    sim->step();
    EXPECT_LT(norm(momentum()), 5.01 * 0.01) << k;
  }
}

}  // namespace
}  // namespace rdm
