// Hands on arms, two different ones in a scene; trees of 64 joints; arms of a third of a ton.
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.hpp"
#include "large_robots.hpp"
#include "physics/articulated/tree.hpp"
#include "physics/gravity_torques.hpp"
#include "quality_bodies.hpp"

namespace rdm {
namespace {

constexpr EngineKind kEngine = EngineKind::kArticulated;

// 31 joints each: a light arm with a right hand that hangs over the ground, and one on a rail, heavier, with
// a left one; boxes that both push about.
SceneDef mounted_pair() {
  SceneDef def;
  def.solver.contacts_max = 128;
  def.feedforward = true;
  def.articulations.push_back(
      test::with_hand(test::make_arm(test::kLightArm, {{0, 0, 0.05}, {}}), Side::kRight));
  ArticulationDef other = test::make_arm(test::kLightArm, {{0.6, 0, 0.05}, axis_angle({0, 0, 1}, 3)});
  JointDef& rail = other.links[0].joint;
  rail.kind = JointKind::kPrismatic;
  rail.axis = {0, 1, 0};
  rail.lower = -0.2;
  rail.upper = 0.2;
  rail.kp = 40000;
  rail.kd = 4000;
  rail.effort = 3000;
  for (LinkDef& link : other.links) link.inertia = transformed(link.inertia, {});
  def.articulations.push_back(test::with_hand(other, Side::kLeft, true));
  for (int i = 0; i < 4; ++i)
    def.bodies.push_back(test::make_box(0.2, {0.04, 0.05, 0.06},
                                        {{0.3, 0.15 * i - 0.2, 0.06}, axis_angle({0, 0, 1}, 0.5 * i)}));
  def.statics.push_back(test::make_plane());
  return def;
}

// A tree of 64 joints on a free base, another on a fixed one, one chain of 64; boxes fall on them.
SceneDef many_joints() {
  SceneDef def;
  def.solver.contacts_max = 256;
  def.articulations.push_back(test::make_bush(8, 7, 8, {{0, 0, 0.1}, {}}));
  def.articulations.push_back(test::make_bush(1, 9, 7, {{1, 0, 0.5}, axis_angle({0, 1, 0}, 1.5)}));
  def.articulations[1].free_base = true;
  def.articulations[1].base = box_inertia(1, {0.1, 0.1, 0.1});
  def.articulations.push_back(test::make_bush(64, 0, 0, {{-2, 0, 0.05}, axis_angle({0, 1, 0}, 1.4)}));
  for (int i = 0; i < 4; ++i)
    def.bodies.push_back(test::make_box(0.1, {0.05, 0.05, 0.05}, {{-0.6 * i, 0.02, 1.2}, {}}));
  def.statics.push_back(test::make_plane());
  return def;
}

void drive(World& world, Stream& random, int k) {
  const Scene& scene = world.scene();
  if (k % 10 == 0) test::random_targets(world, random);
  if (k % 3 == 0) {
    const auto link = static_cast<int32_t>(random.below(static_cast<uint32_t>(scene.num_links)));
    world.push_link(link, {random.signed_unit(), random.signed_unit(), 0}, world.link(link).X.p);
  }
  if (world.feedforward())
    for (int32_t a = 0; a < 2; ++a)
      gravity_torques(world, a, world.feedforward() + scene.link_offset[static_cast<size_t>(a)]);
}

std::vector<uint64_t> play(SceneDef def, int32_t lanes, int32_t together, int64_t* contacts = nullptr) {
  constexpr int32_t kWorlds = 5;
  def.solver.lanes = lanes;
  test::Partners worlds(def, kWorlds);
  std::vector<Stream> streams;
  for (uint32_t i = 0; i < kWorlds; ++i) streams.emplace_back(11, i, Purpose::kTest);
  std::vector<uint64_t> hashes;
  for (int k = 0; k < 40; ++k) {
    for (int32_t i = 0; i < kWorlds; ++i) drive(worlds[i], streams[static_cast<size_t>(i)], k);
    for (int32_t i = 0; i < kWorlds; i += together)
      World::step_together(worlds.data() + i, std::min(together, kWorlds - i));
    for (int32_t i = 0; i < kWorlds; ++i) {
      EXPECT_EQ(worlds[i].status() & ~kStatusUnconverged, 0u) << k;
      if (contacts) *contacts += worlds[i].num_contacts();
      if (k % 10 == 9) hashes.push_back(test::state_hash(worlds[i]));
    }
  }
  return hashes;
}

struct SceneCase {
  const char* name;
  SceneDef (*def)();
};
void PrintTo(const SceneCase& c, std::ostream* out) {
  *out << c.name;
}
class LargeRobots : public testing::TestWithParam<SceneCase> {};
INSTANTIATE_TEST_SUITE_P(, LargeRobots,
                         testing::Values(SceneCase{"mounted", mounted_pair}, SceneCase{"many", many_joints}),
                         [](const auto& info) { return info.param.name; });

TEST_P(LargeRobots, LanesAndGroupsChangeNoBit) {
  int64_t contacts = 0;
  const auto want = play(GetParam().def(), 1, 1, &contacts);
  EXPECT_GT(contacts, 1000);
  for (const int32_t lanes : {0, 4, 8, 16})
    for (const int32_t together : {1, 5}) EXPECT_EQ(play(GetParam().def(), lanes, together), want) << lanes;
}

TEST_P(LargeRobots, AdjustableOnesWithoutFactorsAreTheSame) {
  SceneDef def = GetParam().def();
  test::Simulation plain(def, kEngine);
  def.adjustable = true;
  test::Simulation own(def, kEngine);
  Stream a(12, 0, Purpose::kTest), b = a;
  for (int k = 0; k < 40; ++k) {
    drive(*plain, a, k);
    drive(*own, b, k);
    plain->step();
    own->step();
  }
  for (int32_t i = 0; i < plain.scene().num_links; ++i) ASSERT_EQ(own->q()[i], plain->q()[i]) << i;
}

TEST_P(LargeRobots, StatesGoOnToTheBit) {
  test::Simulation world(GetParam().def(), kEngine), other(GetParam().def(), kEngine);
  Stream a(13, 0, Purpose::kTest);
  for (int k = 0; k < 30; ++k) {
    drive(*world, a, k);
    world->step();
  }
  test::load(*other, test::saved(*world));
  Stream b = a;
  for (int k = 30; k < 60; ++k) {
    drive(*world, a, k);
    drive(*other, b, k);
    world->step();
    other->step();
    ASSERT_EQ(test::state_hash(*other), test::state_hash(*world)) << k;
  }
}

TEST(LargeRobotTrees, TwoMountedRobotsAreTwoTrees) {
  const auto trees = make_trees(make_scene(mounted_pair()));
  ASSERT_EQ(trees.size(), 2u);
  for (const Tree& tree : trees) {
    EXPECT_EQ(tree.num_links, 31);
    EXPECT_EQ(tree.num_segments, 7);  // an arm and a wrist of nine joints, five fingers
    EXPECT_EQ(tree.path_segments, 3);
  }
}

// Joint angles of the lanes against those in double, with arms that jump from target to target.
void expect_close_to_double(SceneDef def, double rms_bound, double worst_bound) {
  def.feedforward = true;
  test::Simulation single(def, kEngine);
  def.solver.double_precision = true;
  test::Simulation wide(def, kEngine);
  Stream a(10, 0, Purpose::kTest), b = a;
  double square = 0, worst = 0;
  int count = 0;
  for (int k = 0; k < 300; ++k) {
    if (k % 30 == 0) {
      test::random_targets(*single, a);
      test::random_targets(*wide, b);
    }
    for (World* w : {&*single, &*wide}) {
      gravity_torques(*w, 0, w->feedforward());
      w->step();
      ASSERT_EQ(w->status() & ~kStatusUnconverged, 0u);
    }
    for (int32_t i = 0; i < single.scene().num_links; ++i, ++count) {
      const double off = single->q()[i] - wide->q()[i];
      square += off * off;
      worst = std::max(worst, std::fabs(off));
    }
  }
  EXPECT_LT(std::sqrt(square / count), rms_bound);
  EXPECT_LT(worst, worst_bound);
  EXPECT_GT(worst, 0);
}

TEST(LargeRobotLanes, AreCloseToDouble) {
  SceneDef def;
  def.articulations = {test::with_hand(test::make_arm(test::kLightArm, {}), Side::kRight)};
  expect_close_to_double(def, 2e-5, 5e-4);
  def.articulations = {test::with_hand(test::make_arm(test::kHeavyArm, {}), Side::kLeft)};
  expect_close_to_double(def, 1e-4, 4e-3);
  def.articulations = {test::make_bush(8, 7, 8, {})};
  expect_close_to_double(def, 1e-6, 1e-5);
  def.articulations = {test::make_bush(64, 0, 0, {})};
  def.articulations[0].gravity = false;
  expect_close_to_double(def, 5e-5, 5e-4);
}

// A joint that ran into its end beyond the margin was stopped by decree; a chain took its energy from that.
TEST(LargeRobotLimits, AChainThatThrashesAboutGainsNoEnergy) {
  for (const bool wide : {false, true}) {
    SceneDef def;
    def.articulations = {test::make_bush(64, 0, 0, {})};
    def.articulations[0].gravity = false;
    def.solver.double_precision = wide;
    test::Simulation sim(def, kEngine);
    Stream random(10, 0, Purpose::kTest);
    double fastest = 0;
    for (int k = 0; k < 900; ++k) {
      if (k % 30 == 0 && k < 600) test::random_targets(*sim, random);
      sim->step();
      for (int32_t i = 0; i < 64; ++i) fastest = std::max(fastest, std::fabs(sim->qd()[i]));
    }
    EXPECT_LT(fastest, 20);
    for (int32_t i = 0; i < 64; ++i) EXPECT_LT(std::fabs(sim->qd()[i]), 2) << i;
  }
}

ArticulationDef heavy_arm(double lean) {
  ArticulationDef arm = test::make_arm(test::kHeavyArm, {{0, 0, 0}, axis_angle({0, 1, 0}, lean)});
  return arm;
}

TEST(HeavyArm, FallsIntoItsEndsAndStaysThere) {
  SceneDef def;
  def.articulations = {heavy_arm(0.5)};
  for (LinkDef& link : def.articulations[0].links) link.joint.kp = link.joint.kd = 0;
  test::Simulation sim(def, kEngine);
  double beyond = 0;
  for (int k = 0; k < 600; ++k) {
    sim->step();
    ASSERT_EQ(sim->status(), 0u);
    for (int32_t i = 0; i < 6; ++i) {
      const JointDef& joint = sim.scene().link(i).joint;
      beyond = std::max({beyond, sim->q()[i] - joint.upper, joint.lower - sim->q()[i]});
      ASSERT_LT(std::fabs(sim->qd()[i]), 60);
    }
  }
  EXPECT_GT(beyond, 0);  // it did fall
  EXPECT_LE(beyond, def.solver.limit_margin + 1e-6);
}

// With gravity compensated the target is held; without, the drive gives way by torque over kp.
TEST(HeavyArm, HoldsItsPose) {
  for (const bool hand : {false, true}) {
    SceneDef def;
    def.feedforward = true;
    def.articulations = {hand ? test::with_hand(heavy_arm(0), Side::kRight) : heavy_arm(0)};
    const double pose[6] = {0.4, 0.6, 0.3, -0.5, 0.8, 0.2};
    for (const bool compensated : {true, false}) {
      test::Simulation sim(def, kEngine);
      double q[30] = {}, still[30] = {}, need[30];
      std::copy_n(pose, 6, q);
      for (int32_t i = 6; i < sim.scene().num_links; ++i)
        q[i] = std::max(0.0, sim.scene().link(i).joint.lower);
      sim->set_joints(0, q, still);
      for (int32_t i = 0; i < sim.scene().num_links; ++i) sim->target()[i] = q[i];
      double early[6];
      for (int k = 0; k < 1200; ++k) {
        if (compensated) gravity_torques(*sim, 0, sim->feedforward());
        sim->step();
        ASSERT_EQ(sim->status(), 0u);
        if (k == 600) std::copy_n(sim->q(), 6, early);
      }
      gravity_torques(*sim, 0, need);
      EXPECT_GT(std::fabs(need[1]), 1000);
      for (int32_t i = 0; i < 6; ++i) {
        const double sag = compensated ? 0 : need[i] / sim.scene().link(i).joint.kp;
        EXPECT_NEAR(sim->target()[i] - sim->q()[i], sag, 1e-5 + 0.01 * std::fabs(sag)) << i;
        EXPECT_LT(std::fabs(sim->q()[i] - early[i]), 2e-6) << i;  // 10 s: no drift
        EXPECT_NEAR(sim->torque()[i], need[i], 0.01 * std::fabs(need[1])) << i;
      }
    }
  }
}

TEST(HeavyArm, FollowsMovingTargetsAndComesBackFromAPush) {
  SceneDef def;
  def.feedforward = true;
  def.articulations = {heavy_arm(0)};
  test::Simulation sim(def, kEngine);
  const double dt = sim.scene().control_dt(), kAmplitude = 0.3, kRate = 1.5;
  double worst = 0;
  for (int k = 0; k < 900; ++k) {
    for (int32_t i = 0; i < 6; ++i) {  // the drive is told the rate too
      const double phase = kRate * dt * k + i;
      sim->target()[i] = kAmplitude * std::sin(phase);
    }
    gravity_torques(*sim, 0, sim->feedforward());
    for (int32_t i = 0; i < 6; ++i)
      sim->feedforward()[i] +=
          sim.scene().link(i).joint.kd * kAmplitude * kRate * std::cos(kRate * dt * k + i);
    if (k >= 300 && k < 312) sim->push_link(3, {2000, -3000, 1000}, sim->link(3).X.p);
    sim->step();
    ASSERT_EQ(sim->status(), 0u);
    if ((k > 200 && k < 300) || k > 500)
      for (int32_t i = 0; i < 6; ++i) worst = std::max(worst, std::fabs(sim->q()[i] - sim->target()[i]));
  }
  EXPECT_LT(worst, 0.02);
}

// Contacts give way to a force, by what scenes say: contact_cfm h / erp.
TEST(HeavyArm, PressesOnTheGround) {
  SceneDef def;
  def.solver.contact_cfm = 1e-6;
  def.articulations = {heavy_arm(0)};
  def.statics.push_back(test::make_plane());
  test::Simulation sim(def, kEngine);
  const double start[6] = {0, 1.3, 0.5, 0, 0.5, 0}, still[6] = {};
  sim->set_joints(0, start, still);
  for (int32_t i = 0; i < 6; ++i) sim->target()[i] = start[i];
  sim->target()[1] = 2.2;  // far below the ground
  double force = 0, depth = 0;
  for (int k = 0; k < 600; ++k) {
    sim->step();
    ASSERT_EQ(sim->status() & ~kStatusUnconverged, 0u);  // it strikes
    if (k < 300) continue;
    force = 0;
    for (int32_t c = 0; c < sim->num_contacts(); ++c) {
      force += sim->contacts()[c].force.z;
      depth = std::max(depth, sim->contacts()[c].depth);
    }
    EXPECT_GT(force, 4500) << k;  // the effort's bound over the lever, and the weight
    for (int32_t i = 0; i < 6; ++i) EXPECT_LT(std::fabs(sim->qd()[i]), 1e-3) << k;
  }
  EXPECT_LT(depth, def.solver.contact_layer + 1e-3);
}

// What a passive arm conserves: energy, to the order of the substep.
TEST(HeavyArm, FreeFallKeepsItsEnergy) {
  SceneDef def;
  def.articulations = {heavy_arm(0.5)};
  for (LinkDef& link : def.articulations[0].links) {
    link.joint.kp = link.joint.kd = 0;
    link.joint.lower = -1000;
    link.joint.upper = 1000;
  }
  const auto energy = [](World& world, double height) {
    double e = 0;
    for (int32_t i = 0; i < world.scene().num_links; ++i) {
      const Inertia& inertia = world.scene().link(i).inertia;
      const Motion& m = world.link(i);
      const Vec3 arm = rotate(m.X.q, inertia.com), v = m.v + cross(m.w, arm),
                 w = rotate(conjugate(m.X.q), m.w);
      e += 0.5 * inertia.mass * dot(v, v) + 0.5 * dot(w, moment_matrix(inertia) * w) +
           height * inertia.mass * 9.81 * (m.X.p + arm).z;
    }
    return e;
  };
  const auto most_gained = [&] {  // share of the energy that went from height to motion
    test::Simulation sim(def, kEngine);
    const double start = energy(*sim, 1), seconds = 1;
    double gained = 0, swung = 0;
    for (int k = 0; k < seconds / sim.scene().control_dt(); ++k) {
      sim->step();
      gained = std::max(gained, energy(*sim, 1) - start);
      swung = std::max(swung, energy(*sim, 0));
    }
    EXPECT_GT(swung, 1500);
    EXPECT_GT(energy(*sim, 1) - start, -0.05 * swung);
    return gained / swung;
  };
  for (const bool wide : {false, true}) {
    def.solver.double_precision = wide;
    def.solver.h = 1.0 / 120;
    const double coarse = most_gained();
    def.solver.h = 1.0 / 480;
    EXPECT_LT(coarse, 0.1);
    EXPECT_LT(most_gained(), 0.4 * coarse);
  }
}

// On a free base nothing outside holds it: momentum stays, and the centre of mass falls as a stone does.
TEST(HeavyArm, KeepsItsMomentumOnAFreeBase) {
  SceneDef def;
  def.feedforward = true;
  def.articulations = {heavy_arm(0.5)};
  ArticulationDef& arm = def.articulations[0];
  arm.free_base = true;
  arm.base = box_inertia(70, {0.3, 0.25, 0.1});
  const double damping[6] = {2000, 2000, 1000, 100, 10, 1};
  for (size_t i = 0; i < 6; ++i) {
    arm.links[i].joint.kp = 0;
    arm.links[i].joint.kd = damping[i];
  }
  test::Simulation sim(def, kEngine);
  struct Sums {
    Vec3 linear, angular;  // about the centre of mass
  };
  const auto sums = [&] {
    double mass = 0;
    Vec3 first, linear, angular;
    for (int32_t i = -1; i < 6; ++i) {
      const Inertia& inertia = i < 0 ? arm.base : sim.scene().link(i).inertia;
      const Motion& m = i < 0 ? sim->base(0) : sim->link(i);
      const Vec3 off = rotate(m.X.q, inertia.com), c = m.X.p + off,
                 p = inertia.mass * (m.v + cross(m.w, off));
      mass += inertia.mass;
      first += inertia.mass * c;
      linear += p;
      angular += cross(c, p) + rotate(m.X.q, moment_matrix(inertia) * rotate(conjugate(m.X.q), m.w));
    }
    return Sums{linear, angular - cross((1 / mass) * first, linear)};
  };
  Stream random(14, 0, Purpose::kTest);
  double fastest = 0, mass = arm.base.mass;
  for (const LinkDef& link : arm.links) mass += link.inertia.mass;
  for (int k = 1; k <= 180; ++k) {
    for (int32_t i = 0; i < 6; ++i) sim->feedforward()[i] = k <= 60 ? damping[i] * random.signed_unit() : 0;
    sim->step();
    ASSERT_EQ(sim->status(), 0u);
    for (int32_t i = 0; i < 6; ++i) fastest = std::max(fastest, std::fabs(sim->qd()[i]));
  }
  EXPECT_GT(fastest, 0.5);
  // the joints have come to rest by now: what is left is the momentum of one rigid body
  const Sums now = sums();
  const Vec3 want = mass * 180 * sim.scene().control_dt() * Vec3{0, 0, -9.81};
  EXPECT_LT(norm(now.linear - want), 1e-5 * norm(want));
  EXPECT_LT(norm(now.angular), 0.02);  // kg m2/s, of hundreds that the links had
}

// --- Joints that follow others.

// Two fingers on the ground, the second row follows the first, or the first the second.
TEST(CoupledJoints, MayStandBeforeTheOnesTheyFollow) {
  for (const EngineKind engine : {EngineKind::kArticulated, EngineKind::kOde}) {
    const auto play = [&](bool follower_first) {
      SceneDef def;
      ArticulationDef two = test::make_bush(2, 0, 0, {});
      two.gravity = false;
      two.links[0].parent = two.links[1].parent = -1;
      two.links[0].joint.axis = two.links[1].joint.axis = {1, 0, 0};
      two.links[0].X_PL.p = {follower_first ? 0.1 : -0.1, 0, 0};
      two.links[1].X_PL.p = {follower_first ? -0.1 : 0.1, 0, 0};
      const size_t follower = follower_first ? 0 : 1;
      two.links[follower].joint.coupled_to = static_cast<int32_t>(1 - follower);
      two.links[follower].joint.ratio = 0.5;
      def.articulations = {two};
      test::Simulation sim(def, engine);
      sim->target()[1 - follower] = 0.6;
      std::vector<double> track;
      for (int k = 0; k < 120; ++k) {  // the leader moves both
        sim->step();
        track.push_back(sim->q()[1 - follower]);
        track.push_back(sim->q()[follower]);
      }
      EXPECT_NEAR(track.back(), 0.3, 1e-3);
      return track;
    };
    const std::vector<double> before = play(true), behind = play(false);
    for (size_t k = 0; k < before.size(); ++k) EXPECT_NEAR(before[k], behind[k], 1e-9) << k;
  }
}

TEST(CoupledJoints, ChainsAndCyclesAreRefused) {
  const auto code_of = [](std::initializer_list<int32_t> others) {
    SceneDef def;
    def.articulations = {test::make_bush(static_cast<int>(others.size()), 0, 0, {})};
    size_t i = 0;
    for (const int32_t other : others) def.articulations[0].links[i++].joint.coupled_to = other;
    return guard([&] { (void)make_scene(def); });
  };
  EXPECT_EQ(code_of({-1, 0, 0}), Code::kOk);
  EXPECT_EQ(code_of({2, 2, -1}), Code::kOk);
  EXPECT_EQ(code_of({1, 0, -1}), Code::kArgument);
  EXPECT_EQ(code_of({1, 2, -1}), Code::kArgument);
  EXPECT_EQ(code_of({-1, 0, 1}), Code::kArgument);
}

}  // namespace
}  // namespace rdm
