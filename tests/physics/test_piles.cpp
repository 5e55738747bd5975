// Piles of free bodies: islands that sleep and wake, and contacts in lanes.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>

#include "articulated.hpp"
#include "base/error.hpp"
#include "isa_scope.hpp"
#include "quality_towers.hpp"

namespace rdm {
namespace {

constexpr EngineKind kEngine = EngineKind::kArticulated;
constexpr double kWeight = 0.020 * 9.81;  // N, of a tower's block
constexpr Vec3 kHalf{0.0375, 0.0125, 0.0075};

SceneDef tower_def(double sleep_time = 0.25) {
  SceneDef def = test::jenga_def();
  def.solver.sleep_time = sleep_time;
  return def;
}

// Two blocks on the ground, a metre apart.
SceneDef two_blocks() {
  SceneDef def = tower_def();
  def.bodies.clear();
  for (const double x : {0.0, 1.0}) def.bodies.push_back(test::make_box(0.020, kHalf, {{x, 0, kHalf.z}, {}}));
  return def;
}

// A slider along x whose block stands `gap` beside what is at the origin, 3 cm above the ground.
void add_hammer(double gap, SceneDef* def) {
  ArticulationDef hammer;
  hammer.X_WB.p = {-kHalf.x - 0.02 - gap, 0, 0.03};
  LinkDef link;
  link.inertia = box_inertia(0.3, {0.02, 0.02, 0.02});
  link.joint.kind = JointKind::kPrismatic;
  link.joint.axis = {1, 0, 0};
  link.joint.lower = -0.2;
  link.joint.upper = 0.2;
  link.joint.kp = 300;
  link.joint.kd = 15;
  link.joint.effort = 20;
  link.sensor = true;
  hammer.links.push_back(link);
  ArticulationShape shape;
  shape.link = 0;
  shape.shape.kind = ShapeKind::kBox;
  shape.shape.size = {0.02, 0.02, 0.02};
  hammer.shapes.push_back(shape);
  def->articulations.push_back(hammer);
}

bool still(const World& world, int32_t body) {
  const Motion& m = world.body(body);
  return dot(m.v, m.v) == 0 && dot(m.w, m.w) == 0;
}
int sleepers(const World& world) {
  int count = 0;
  for (int32_t i = 0; i < world.scene().num_bodies; ++i) count += still(world, i);
  return count;
}
void steps(World& world, int count) {
  for (int k = 0; k < count; ++k) world.step();
}
// Force of static shapes on bodies, world, N.
Vec3 support(const World& world) {
  Vec3 sum;
  for (int32_t i = 0; i < world.num_contacts(); ++i) {
    const Contact& c = world.contacts()[i];
    if (world.scene().shapes[static_cast<size_t>(c.shape_b)].carrier == Carrier::kStatic) sum += c.force;
  }
  return sum;
}

TEST(Sleep, ATowerSleepsWhereItStoodAndKeepsItsContacts) {
  test::Simulation tower(tower_def(), kEngine), awake(tower_def(0), kEngine);
  steps(*tower, 120);
  steps(*awake, 120);
  ASSERT_EQ(sleepers(*tower), test::kBlocks);
  EXPECT_EQ(sleepers(*awake), 0);
  for (int32_t i = 0; i < test::kBlocks; ++i)
    EXPECT_LT(norm(tower->body(i).X.p - awake->body(i).X.p), 5e-4) << i;
  EXPECT_NEAR(tower->num_contacts(), awake->num_contacts(), 12);
  EXPECT_GT(tower->num_contacts(), 150);
  EXPECT_NEAR(support(*tower).z, test::kBlocks * kWeight, 0.02 * test::kBlocks * kWeight);
  std::vector<uint8_t> touched;
  for (size_t k = 0; k < tower.scene().pairs.size(); ++k)
    touched.push_back(tower->pair_touched(static_cast<int32_t>(k)));
  std::vector<Contact> before(tower->contacts(), tower->contacts() + tower->num_contacts());
  const uint64_t state = test::state_hash(*tower);
  steps(*tower, 50);
  EXPECT_EQ(test::state_hash(*tower), state);  // nothing moves at all
  ASSERT_EQ(static_cast<size_t>(tower->num_contacts()), before.size());
  for (size_t i = 0; i < before.size(); ++i) {
    const Contact& now = tower->contacts()[i];
    EXPECT_EQ(now.shape_a, before[i].shape_a);
    EXPECT_EQ(norm(now.p - before[i].p), 0);
    EXPECT_EQ(norm(now.force - before[i].force), 0);
    EXPECT_TRUE(i == 0 || now.shape_a >= before[i - 1].shape_a);  // in the order of the pairs
  }
  for (size_t k = 0; k < touched.size(); ++k)
    EXPECT_EQ(tower->pair_touched(static_cast<int32_t>(k)), touched[k] != 0);
}

// Points on a rim are elsewhere after any motion: the forces must not go by where they are found.
TEST(Sleep, RoundThingsAreCarriedWhileTheySleep) {
  constexpr double kMass = 1, kRadius = 0.04, kHalf = 0.1, kWeightOfOne = kMass * 9.81;
  constexpr int kCount = 6;
  Inertia inertia;
  inertia.mass = kMass;
  inertia.moment[0] = inertia.moment[1] = kMass * (kRadius * kRadius / 4 + kHalf * kHalf / 3);
  inertia.moment[2] = kMass * kRadius * kRadius / 2;
  SceneDef def;
  def.solver.sleep_time = 0.25;
  ShapeDef table;
  table.kind = ShapeKind::kBox;
  table.size = {5, 5, 0.1};
  table.X_LS.p = {0, 0, -0.1};
  def.statics.push_back(table);
  for (int i = 0; i < kCount; ++i)
    def.bodies.push_back(test::make_body(ShapeKind::kCylinder, {kRadius, kHalf, 0}, inertia,
                                         {{0.5 * i, 0, kHalf + 0.002 * i}, {}}));
  for (const bool plane : {false, true}) {
    if (plane) {
      def.statics[0] = {};
      def.statics[0].kind = ShapeKind::kPlane;
    }
    for (const int32_t substeps : {1, 2, 4}) {
      def.solver.substeps = substeps;
      def.solver.h = 1.0 / 60 / substeps;
      test::Simulation sim(def, kEngine);
      steps(*sim, 120);
      ASSERT_EQ(sleepers(*sim), kCount) << substeps;
      double carried[kCount] = {}, moment[kCount] = {};
      for (int32_t k = 0; k < sim->num_contacts(); ++k) {
        const Contact& c = sim->contacts()[k];
        const int32_t i = sim.scene().shapes[static_cast<size_t>(c.shape_a)].index;
        carried[i] += c.force.z;
        moment[i] += cross(c.p - sim->body(i).X.p, c.force).x;
      }
      for (int i = 0; i < kCount; ++i) {
        EXPECT_NEAR(carried[i], kWeightOfOne, 0.01 * kWeightOfOne) << plane << substeps << ' ' << i;
        EXPECT_NEAR(moment[i], 0, 0.02 * kWeightOfOne * kRadius) << plane << substeps << ' ' << i;
      }
    }
  }
}

TEST(Sleep, AnIslandWakesAsAWholeAndAnotherSleepsOn) {
  SceneDef def = tower_def();
  const auto far = static_cast<int32_t>(def.bodies.size());
  def.bodies.push_back(test::make_box(0.020, kHalf, {{1, 0, kHalf.z}, {}}));
  test::Simulation sim(def, kEngine);
  steps(*sim, 120);
  ASSERT_EQ(sleepers(*sim), far + 1);
  const struct {
    const char* by;
    std::function<void(World&)> wake;
  } cases[] = {
      {"a push",
       [](World& w) {
         w.push_body(19, {0, 0, 0.05}, {});
       }},
      {"a torque",
       [](World& w) {
         w.push_body(0, {}, {0, 0, 1e-4});
       }},
      {"a motion", [](World& w) { w.set_body(3, w.body(3)); }},
  };
  for (const auto& c : cases) {
    c.wake(*sim);
    sim->step();
    int moving = 0;
    for (int32_t i = 0; i < far; ++i) moving += !still(*sim, i);
    EXPECT_EQ(moving, far) << c.by;
    EXPECT_TRUE(still(*sim, far)) << c.by;
    steps(*sim, 120);
    EXPECT_EQ(sleepers(*sim), far + 1) << c.by;
  }
  sim->push_body(19, {}, {});  // nothing at all wakes nobody
  sim->step();
  EXPECT_EQ(sleepers(*sim), far + 1);
}

TEST(Sleep, WhatLosesItsSupportFalls) {
  test::Simulation tower(tower_def(), kEngine);
  steps(*tower, 120);
  const double top = tower->body(19).X.p.z;
  for (const int32_t block : {6, 7}) {
    tower->set_body(block, {{{0.5 + 0.1 * block, 0, kHalf.z}, {}}, {}, {}});
    tower->step();
    EXPECT_FALSE(still(*tower, 19)) << block;
    steps(*tower, 60);
  }
  EXPECT_LT(tower->body(19).X.p.z, top - 5e-3);
}

TEST(Sleep, ABodyThatFallsOnSleepersWakesThem) {
  SceneDef def = two_blocks();
  test::Simulation sim(def, kEngine);
  steps(*sim, 60);
  ASSERT_EQ(sleepers(*sim), 2);
  sim->set_body(1, {{{0.05, 0, 0.1}, {}}, {}, {}});
  int falling = 0;
  while (still(*sim, 0) && falling < 60) {
    sim->step();
    ++falling;
  }
  EXPECT_GT(falling, 3);   // it sleeps while nothing touches it
  EXPECT_LT(falling, 15);  // 0.08 m take 0.13 s
  steps(*sim, 120);
  EXPECT_EQ(sleepers(*sim), 2);
  EXPECT_NEAR(support(*sim).z, 2 * kWeight, 0.02 * kWeight);
}

TEST(Sleep, ALinkWakesWhatItTouchesAndKeepsItAwake) {
  SceneDef def = tower_def();
  add_hammer(0.01, &def);
  test::Simulation sim(def, kEngine);
  steps(*sim, 90);
  ASSERT_EQ(sleepers(*sim), test::kBlocks);
  EXPECT_EQ(norm(sim->sensor(0).force), 0);
  sim->target()[0] = 0.014;
  int free = 0;
  while (sleepers(*sim) == test::kBlocks && free < 60) {
    sim->step();
    ++free;
  }
  EXPECT_GT(free, 2);
  EXPECT_LT(free, 40);
  EXPECT_GT(norm(sim->sensor(0).force), 0);  // felt in the same step
  steps(*sim, 120);
  EXPECT_EQ(sleepers(*sim), 0);  // pressed all the time
  sim->target()[0] = -0.1;
  steps(*sim, 120);
  EXPECT_EQ(sleepers(*sim), test::kBlocks);
}

TEST(Sleep, NothingSleepsInFreeFlightOrWithoutGravity) {
  SceneDef def = two_blocks();
  def.solver.sleep_time = def.solver.h;
  def.solver.sleep_speed = 0.3;  // as slow as 0.06 s about the apex
  def.solver.sleep_spin = 10;
  test::Simulation thrown(def, kEngine);
  thrown->set_body(0, {{{0, 0, 0.5}, {}}, {0, 0, 1}, {0, 0, 0.1}});
  double lowest = 1;
  for (int k = 0; k < 20; ++k) {
    thrown->step();
    lowest = std::min(lowest, norm(thrown->body(0).v));
    EXPECT_FALSE(still(*thrown, 0)) << k;
  }
  EXPECT_LT(lowest, 0.1);
  for (const bool floating : {false, true}) {
    SceneDef without = two_blocks();
    if (floating)
      without.bodies[0].gravity = false;
    else
      without.gravity = {};
    test::Simulation slow(without, kEngine);
    slow->set_body(0, {{{0, 0, kHalf.z - 2e-4}, {}}, {1e-3, 0, 0}, {}});  // on the ground
    steps(*slow, 120);
    EXPECT_FALSE(still(*slow, 0));
    EXPECT_TRUE(!floating || still(*slow, 1));
  }
}

TEST(Sleep, DynamicsWakeEverybody) {
  SceneDef def = two_blocks();
  def.adjustable = true;
  test::Simulation sim(def, kEngine);
  steps(*sim, 60);
  ASSERT_EQ(sleepers(*sim), 2);
  Dynamics& dynamics = sim->edit_dynamics();
  dynamics.bodies[0].mass = 2;
  sim->set_dynamics(dynamics);
  sim->step();
  EXPECT_EQ(sleepers(*sim), 0);
  steps(*sim, 60);
  EXPECT_EQ(sleepers(*sim), 2);
  EXPECT_NEAR(support(*sim).z, 3 * kWeight, 0.05 * kWeight);
}

TEST(Sleep, TooManyPointsKeepTheWorldAwake) {
  SceneDef def = tower_def();
  def.solver.contacts_max = 100;
  test::Simulation sim(def, kEngine);
  int over = 0;  // control steps: the tower, badly held, may come down until it has fewer points
  for (int k = 0; k < 60; ++k) {
    sim->step();
    if ((sim->status() & kStatusContactOverflow) == 0) continue;
    ++over;
    EXPECT_EQ(sleepers(*sim), 0) << k;
  }
  EXPECT_GT(over, 20);  // awake for longer than others before they sleep
  // sleepers and one that falls on them, for which there is no room
  SceneDef three = two_blocks();
  three.bodies.push_back(test::make_box(0.020, kHalf, {{0, 0, 5}, {}}));
  three.solver.contacts_max = 10;
  test::Simulation full(three, kEngine);
  steps(*full, 45);
  ASSERT_EQ(sleepers(*full), 2);
  EXPECT_EQ(full->num_contacts(), 8);
  full->set_body(2, {{{0, 0, 3 * kHalf.z + 1e-3}, {}}, {}, {}});
  uint32_t status = 0;
  for (int k = 0; k < 60; ++k) {
    full->step();
    status |= full->status();
    EXPECT_LE(full->num_contacts(), 10);
  }
  EXPECT_NE(status & kStatusContactOverflow, 0u);
  EXPECT_EQ(status & kStatusDiverged, 0u);
  EXPECT_EQ(sleepers(*full), 0);
}

// A hammer that knocks at a tower every second, a body thrown now and then, everything asleep in between.
SceneDef events_def() {
  SceneDef def = tower_def();
  add_hammer(0.01, &def);
  def.bodies.push_back(test::make_box(0.020, kHalf, {{0.3, 0, kHalf.z}, {}}));
  return def;
}
void drive(World& world, Stream& random, int k) {
  const double knock = 0.011 + 0.004 * random.uniform();
  if (k % 60 == 50) world.target()[0] = knock;
  if (k % 60 == 58) world.target()[0] = -0.05;
  if (k % 97 == 70) world.set_body(20, {{{0.25 + 0.05 * random.uniform(), 0, 0.1}, {}}, {}, {0, 0, 1}});
}

TEST(Sleep, SaveAndRestoreGoOnToTheBitAtAnyTime) {
  test::Simulation world(events_def(), kEngine), other(events_def(), kEngine);
  Stream random(5, 0, Purpose::kTest);
  std::vector<std::vector<unsigned char>> states;
  std::vector<Stream> streams;
  std::vector<uint64_t> contacts;
  const auto contact_hash = [](const World& w) {
    uint64_t h = kHashSeed;
    for (int32_t i = 0; i < w.num_contacts(); ++i) {
      const Contact& c = w.contacts()[i];
      h = hash_bytes(&c.p, sizeof c.p, h);
      h = hash_bytes(&c.force, sizeof c.force, h);
    }
    for (size_t k = 0; k < w.scene().pairs.size(); ++k) {
      const uint8_t touched = w.pair_touched(static_cast<int32_t>(k));
      h = hash_bytes(&touched, 1, h);
    }
    return h;
  };
  constexpr int kSteps = 200;
  int asleep = 0, awake = 0;
  for (int k = 0; k < kSteps; ++k) {
    states.push_back(test::saved(*world));
    streams.push_back(random);
    drive(*world, random, k);
    world->step();
    contacts.push_back(contact_hash(*world));
    const int n = sleepers(*world);
    asleep += n >= test::kBlocks;
    awake += n == 0;
  }
  EXPECT_GT(asleep, 20);
  EXPECT_GT(awake, 20);
  states.push_back(test::saved(*world));
  for (int from = 0; from < kSteps; from += 9) {
    test::load(*other, states[static_cast<size_t>(from)]);
    ASSERT_EQ(test::saved(*other), states[static_cast<size_t>(from)]);
    Stream again = streams[static_cast<size_t>(from)];
    for (int k = from; k < std::min(from + 25, kSteps); ++k) {
      drive(*other, again, k);
      other->step();
      ASSERT_EQ(test::saved(*other), states[static_cast<size_t>(k) + 1]) << from << ", step " << k;
      ASSERT_EQ(contact_hash(*other), contacts[static_cast<size_t>(k)]) << from << ", step " << k;
    }
  }
}

TEST(Sleep, StatesThatCannotBeAreRefused) {
  test::Simulation sim(two_blocks(), kEngine);
  steps(*sim, 60);
  ASSERT_EQ(sleepers(*sim), 2);
  const std::vector<unsigned char> good = test::saved(*sim);
  const uint64_t before = test::state_hash(*sim);
  // the rows of sleep are the last: island and quiet time of each body
  const size_t rows = good.size() - 4 * sizeof(int32_t);
  const auto code_with = [&](size_t word, int32_t value) {
    auto bad = good;
    std::memcpy(bad.data() + rows + word * sizeof value, &value, sizeof value);
    try {
      test::load(*sim, bad);
    } catch (const Error& e) {
      return e.code;
    }
    return Code::kOk;
  };
  for (const int32_t island : {-2, 1, 2, 1 << 30}) EXPECT_EQ(code_with(0, island), Code::kFormat) << island;
  EXPECT_EQ(code_with(2, 2), Code::kFormat);
  for (const int32_t quiet : {-1, 0, 31, 1 << 30}) EXPECT_EQ(code_with(1, quiet), Code::kFormat) << quiet;
  EXPECT_EQ(test::state_hash(*sim), before);
  EXPECT_EQ(code_with(0, -1), Code::kOk);  // awake now
  test::Simulation without(
      [] {
        SceneDef def = two_blocks();
        def.solver.sleep_time = 0;
        return def;
      }(),
      kEngine);
  EXPECT_THROW(test::load(*without, good), Error);
}

TEST(Sleep, IsWithinItsRanges) {
  for (double SolverDef::*field : {&SolverDef::sleep_time, &SolverDef::sleep_speed, &SolverDef::sleep_spin})
    for (const double value : {-1.0, 1e3, std::nan("")}) {
      SceneDef def = two_blocks();
      def.solver.*field = value;
      EXPECT_THROW(make_scene(def), Error);
    }
}

constexpr int32_t kWorlds = 3;

std::vector<uint64_t> play(SceneDef def, int32_t lanes, int32_t together) {
  def.solver.lanes = lanes;
  test::Partners worlds(std::move(def), kWorlds);
  std::vector<Stream> streams;
  for (int32_t i = 0; i < kWorlds; ++i) streams.emplace_back(9, static_cast<uint32_t>(i), Purpose::kTest);
  std::vector<uint64_t> hashes;
  for (int k = 0; k < 80; ++k) {
    for (int32_t i = 0; i < kWorlds; ++i) drive(worlds[i], streams[static_cast<size_t>(i)], k);
    for (int32_t first = 0; first < kWorlds; first += together)
      World::step_together(worlds.data() + first, std::min(together, kWorlds - first));
    for (int32_t i = 0; k % 10 == 9 && i < kWorlds; ++i) hashes.push_back(test::state_hash(worlds[i]));
  }
  return hashes;
}

TEST(Piles, LanesGroupsAndInstructionSetsChangeNoBit) {
  const IsaScope scope;
  for (const bool wide : {false, true}) {
    SceneDef def = events_def();
    def.solver.double_precision = wide;
    ASSERT_TRUE(set_stepper_isa(kBaseIsa));
    const std::vector<uint64_t> want = play(def, 1, 1);
    for (const char* isa : {kBaseIsa, kV3Isa, kV4Isa}) {
      if (!set_stepper_isa(isa)) continue;
      if (wide) {
        EXPECT_EQ(play(def, 0, 3), want) << isa;
        continue;
      }
      for (const int32_t lanes : {0, 4, 8, 16}) EXPECT_EQ(play(def, lanes, 3), want) << isa << ", " << lanes;
      EXPECT_EQ(play(def, 0, 2), want) << isa;
    }
  }
}

TEST(Piles, WeightsAreCarriedThroughEveryLayer) {
  test::Simulation sim(tower_def(0), kEngine);
  steps(*sim, 120);
  // what a layer carries is the weight of all above it and its own
  for (int layer = 0; layer < 6; ++layer) {
    double carried = 0;
    for (int32_t i = 0; i < sim->num_contacts(); ++i) {
      const Contact& c = sim->contacts()[i];
      const auto layer_of = [&](int32_t shape) {
        const SceneShape& s = sim.scene().shapes[static_cast<size_t>(shape)];
        return s.carrier == Carrier::kBody ? s.index / 3 : -1;
      };
      const int a = layer_of(c.shape_a), b = layer_of(c.shape_b);
      if (std::max(a, b) == layer && std::min(a, b) == layer - 1) carried += (a > b ? 1 : -1) * c.force.z;
      EXPECT_GE(dot(c.force, c.n), 0);
      const Vec3 side = c.force - dot(c.force, c.n) * c.n;
      EXPECT_LE(norm(side), 0.2 * dot(c.force, c.n) * 1.001 + 1e-9);
    }
    EXPECT_NEAR(carried, (test::kBlocks - 3 * layer) * kWeight, 0.02 * test::kBlocks * kWeight) << layer;
  }
}

}  // namespace
}  // namespace rdm
