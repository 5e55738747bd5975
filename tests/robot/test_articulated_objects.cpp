// Things that move and are no robots: nothing is commanded, they move where they are pushed, stay where they
// are left, stop at their ends, and make no energy.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "base/error.hpp"
#include "physics/model/drive.hpp"
#include "robot/kinematics.hpp"
#include "robot/robots.hpp"
#include "robot_rows.hpp"
#include "two_hands.hpp"

namespace rdm {
namespace {

const char* const kNames[] = {"drawer", "door", "screw_bottle", "scissors", "tap"};

const Robot& named(const char* name) {
  return *RobotRef(find_robot(name));
}
SceneDef scene_of(const Robot& robot, bool gravity = true) {
  SceneDef def;
  def.articulations.push_back(make_articulation(robot, Side::kRight, {}, ""));
  def.articulations[0].gravity = gravity;
  def.solver.exact = true;  // of ODE
  return def;
}
template <class F>
void for_all(F&& f) {
  for (const EngineKind engine : {EngineKind::kArticulated, EngineKind::kOde})
    for (const char* name : kNames) f(named(name), engine);
}

// The joints at a share of their ranges, at rest.
std::vector<double> share_of(const Robot& robot, double share) {
  std::vector<double> q;
  for (const RobotLink& l : robot.links) q.push_back(l.lower + share * (l.upper - l.lower));
  return q;
}
void set(World& world, const std::vector<double>& q, std::vector<double> qd = {}) {
  qd.resize(q.size());
  world.set_joints(0, q.data(), qd.data());
}

// Acts on link i as a force (N) along, or a moment (N m) about, its joint's axis.
void push(World& world, const Robot& robot, int32_t i, double effort) {
  const RobotLink& l = robot.links[i];
  const Pose X = world.link(i).X;
  const Vec3 axis = rotate(X.q, l.axis);
  if (l.kind == JointKind::kPrismatic) return world.push_link(i, effort * axis, X.p);
  const Vec3 side = normalized(cross(axis, std::abs(axis.z) < 0.9 ? Vec3{0, 0, 1} : Vec3{1, 0, 0}));
  const double arm = 0.1;  // m, a couple of two forces
  const Vec3 force = effort / (2 * arm) * cross(axis, side);
  world.push_link(i, force, X.p + arm * side);
  world.push_link(i, -force, X.p - arm * side);
}

TEST(ArticulatedObjects, TakeNoCommands) {
  for (const char* name : kNames) {
    const Robot& robot = named(name);
    EXPECT_EQ(robot.kind, RobotKind::kOther) << name;
    EXPECT_EQ(robot.num_actuated(), 0) << name;
    for (int32_t i = 0; i < robot.links.count; ++i) {
      EXPECT_EQ(robot.action_of(i), -1) << name;
      EXPECT_GT(robot.links[i].friction, 0) << name;
    }
    EXPECT_THROW(robot.actuated(0), Error) << name;
    EXPECT_NO_THROW(check_robot(robot)) << name;
  }
}

// How far a point of each link goes from one end of its joint to the other.
TEST(ArticulatedObjects, RangesTakeThemWhereTheyShouldBe) {
  const auto at = [](const char* name, const std::vector<double>& q, const char* link, const Vec3& p) {
    const Robot& robot = named(name);
    return link_pose(robot, q.data(), link_row(robot, link)) * p;
  };
  EXPECT_LT(norm(at("drawer", {0.35}, "drawer", {}) - at("drawer", {0}, "drawer", {}) - Vec3{0.35, 0, 0}),
            1e-12);
  // the door's free edge comes out of the front, its lever's tip goes down
  EXPECT_LT(norm(at("door", {kPi / 2, 0}, "leaf", {0, -0.5, 0}) - Vec3{0.5, 0.25, 0.42}), 1e-9);
  const Vec3 tip{0.039, 0.09, 0};
  EXPECT_NEAR(std::abs(at("door", {0, 0.8}, "lever", tip).z - at("door", {0, 0}, "lever", tip).z),
              0.09 * std::sin(0.8), 1e-9);
  EXPECT_NEAR(named("screw_bottle").links[0].upper, 3 * kPi, 1e-12);
  // scissors open by turning one blade away from the other
  EXPECT_GT(norm(at("scissors", {1.2}, "upper", {0.095, 0, 0}) - at("scissors", {0}, "upper", {0.095, 0, 0})),
            0.1);
  EXPECT_GT(at("tap", {0, 0.6}, "lever", {0.1, 0, 0}).z, at("tap", {0, 0}, "lever", {0.1, 0, 0}).z + 0.05);
  EXPECT_GT(at("tap", {0.9, 0}, "lever", {0.1, 0, 0}).y, 0.07);
}

TEST(ArticulatedObjects, StayWhereTheyAreLeft) {
  for_all([](const Robot& robot, EngineKind engine) {
    test::Simulation sim(scene_of(robot), engine);
    const auto q = share_of(robot, 0.5);
    set(*sim, q);
    for (int k = 0; k < 120; ++k) sim->step();
    for (int32_t i = 0; i < robot.links.count; ++i) {
      const RobotLink& l = robot.links[i];
      if (l.kp > 0) {  // a spring brings it back
        EXPECT_NEAR(sim->q()[i], 0, 0.02) << robot.name << " " << l.joint;
        continue;
      }
      EXPECT_NEAR(sim->q()[i], q[static_cast<size_t>(i)], 0.02 * (l.upper - l.lower))
          << robot.name << " " << l.joint;
      EXPECT_LT(std::abs(sim->qd()[i]), 0.01) << robot.name << " " << l.joint;
    }
  });
}

// A push of half the friction does not move it but for creep where friction is beside a spring or, on engine ode, a
// push; one of three times that moves it, that way.
TEST(ArticulatedObjects, MoveWhereTheyArePushed) {
  for_all([](const Robot& robot, EngineKind engine) {
    for (int32_t i = 0; i < robot.links.count; ++i)
      for (const double times : {0.5, -0.5, 3.0, -3.0}) {
        const RobotLink& l = robot.links[i];
        test::Simulation sim(scene_of(robot, false), engine);
        auto q = share_of(robot, 0.5);
        for (int32_t k = 0; k < robot.links.count; ++k)
          if (robot.links[k].kp > 0) q[static_cast<size_t>(k)] = 0;  // sprung ones begin at rest
        set(*sim, q);
        const double before = sim->q()[i], range = l.upper - l.lower;
        double effort = times * l.friction;
        if (l.kp > 0 && std::abs(times) > 1) effort += (times > 0 ? 0.5 : -0.5) * l.kp * range;
        for (int k = 0; k < 15; ++k) {
          push(*sim, robot, i, effort);
          sim->step();
        }
        const double moved = sim->q()[i] - before;
        if (std::abs(times) < 1) {
          EXPECT_LT(std::abs(moved), 0.55 * kFrictionSpeed * 0.25) << robot.name << " " << l.joint;
        } else if (l.kp == 0 || times > 0) {  // the spring's own rest is an end of its range
          EXPECT_GT(moved * times, 0.004 * range) << robot.name << " " << l.joint;
        }
      }
  });
}

TEST(ArticulatedObjects, StopAtTheirEnds) {
  for_all([](const Robot& robot, EngineKind engine) {
    for (int32_t i = 0; i < robot.links.count; ++i)
      for (const double way : {1.0, -1.0}) {
        const RobotLink& l = robot.links[i];
        test::Simulation sim(scene_of(robot), engine);
        set(*sim, share_of(robot, 0.5));
        const double effort = way * (4 * l.friction + l.kp * l.upper);
        double low = 1e9, high = -1e9;
        for (int k = 0; k < 300; ++k) {
          push(*sim, robot, i, effort);
          sim->step();
          low = std::min(low, sim->q()[i]), high = std::max(high, sim->q()[i]);
        }
        EXPECT_EQ(sim->status() & kStatusDiverged, 0u) << robot.name << " " << l.joint;
        EXPECT_LT(high, l.upper + 0.02) << robot.name << " " << l.joint;
        EXPECT_GT(low, l.lower - 0.02) << robot.name << " " << l.joint;
        EXPECT_NEAR(sim->q()[i], way > 0 ? l.upper : l.lower, 0.03)
            << robot.name << " " << l.joint << " " << (engine == EngineKind::kOde ? "ode" : "articulated");
      }
  });
}

// Kinetic, and of springs; in the articulated engine's coordinates and the inertia of links.
double energy(World& world, const Robot& robot) {
  double sum = 0;
  for (int32_t i = 0; i < robot.links.count; ++i) {
    const RobotLink& l = robot.links[i];
    const Motion& m = world.link(i);
    const Vec3 v = m.v + cross(m.w, rotate(m.X.q, l.com)), w = rotate(conjugate(m.X.q), m.w);
    sum += 0.5 * l.mass * dot(v, v);
    for (int k = 0; k < 3; ++k) sum += 0.5 * l.moment[k] * w[k] * w[k];
    sum += 0.5 * l.armature * world.qd()[i] * world.qd()[i] + 0.5 * l.kp * world.q()[i] * world.q()[i];
  }
  return sum;
}

TEST(ArticulatedObjects, MakeNoEnergy) {
  for (const char* name : kNames) {
    const Robot& robot = named(name);
    test::Simulation sim(scene_of(robot, false), EngineKind::kArticulated);
    std::vector<double> qd;
    for (const RobotLink& l : robot.links) qd.push_back(2 * (l.upper - l.lower));
    set(*sim, share_of(robot, 0.3), qd);
    for (int32_t i = 0; i < robot.links.count; ++i) sim->target()[i] = 0;
    double now = energy(*sim, robot);
    const double first = now;
    EXPECT_GT(first, 0) << name;
    for (int k = 0; k < 240; ++k) {
      sim->step();
      const double next = energy(*sim, robot);
      EXPECT_LT(next, now + 1e-3 * first) << name << " step " << k;
      now = next;
    }
    EXPECT_LT(now, 0.01 * first) << name;  // friction takes it all
  }
}

// Half a second of the same push: the engines end near each other.
TEST(ArticulatedObjects, EnginesAgree) {
  for (const char* name : kNames) {
    const Robot& robot = named(name);
    for (int32_t i = 0; i < robot.links.count; ++i) {
      const RobotLink& l = robot.links[i];
      double q[2] = {};
      for (const EngineKind engine : {EngineKind::kArticulated, EngineKind::kOde}) {
        SceneDef def = scene_of(robot);
        def.solver.link_armature = 0;
        test::Simulation sim(std::move(def), engine);
        auto start = share_of(robot, 0.1);
        for (int32_t k = 0; k < robot.links.count; ++k)
          if (robot.links[k].kp > 0) start[static_cast<size_t>(k)] = 0;
        set(*sim, start);
        for (int k = 0; k < 30; ++k) {
          push(*sim, robot, i, 1.6 * l.friction + 0.4 * l.kp);
          sim->step();
        }
        q[engine == EngineKind::kOde] = sim->q()[i];
      }
      std::printf("%-14s %-8s %8.4f %8.4f of %.3f\n", name, l.joint, q[0], q[1], l.upper);
      EXPECT_NEAR(q[0], q[1], 0.1 * (l.upper - l.lower)) << name << " " << l.joint;
    }
  }
}

// A bottle or scissors lie about and can be carried.
TEST(ArticulatedObjects, MayStandOnABaseThatMoves) {
  for (const char* name : {"screw_bottle", "scissors"}) {
    SceneDef def = scene_of(named(name));
    def.articulations[0].free_base = true;
    def.articulations[0].X_WB.p.z = 0.02;
    ShapeDef ground;
    ground.name = "ground";
    ground.kind = ShapeKind::kPlane;
    def.statics.push_back(ground);
    test::Simulation sim(std::move(def), EngineKind::kArticulated);
    for (int k = 0; k < 180; ++k) sim->step();
    EXPECT_EQ(sim->status() & kStatusDiverged, 0u) << name;
    EXPECT_LT(norm(sim->base(0).v), 0.02) << name;
    EXPECT_GT(sim->base(0).X.p.z, -0.005) << name;
  }
}

}  // namespace
}  // namespace rdm
