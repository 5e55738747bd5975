// Worlds with constants of their own: each factor does what the scene's number times the factor does.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "articulated.hpp"
#include "base/error.hpp"
#include "heap_count.hpp"
#include "hulls.hpp"
#include "quality_bodies.hpp"

namespace rdm {
namespace {

constexpr EngineKind kEngine = EngineKind::kArticulated;

// A hand on a fixed base and one on a free base, with weight; things of every form fall on them and on the
// ground.
SceneDef rich() {
  SceneDef def = test::two_hands_def();
  def.solver.contacts_max = 128;
  def.solver.limit_stiffness = 1e4;  // more than any mass asks for: ends do not follow factors
  def.articulations[1].free_base = true;
  def.articulations[1].base_damping = 3;
  for (ArticulationDef& a : def.articulations) a.gravity = true;
  for (LinkDef& link : def.articulations[0].links) link.joint.friction = 0.01;
  def.num_materials = 2;
  def.friction[0][0].mu = 0.9;
  def.friction[0][1].mu = def.friction[1][0].mu = 0.6;
  def.friction[1][1].mu = 0.3;
  const ShapeKind kinds[] = {ShapeKind::kCapsule, ShapeKind::kBox, ShapeKind::kCylinder,
                             ShapeKind::kEllipsoid, ShapeKind::kHull};
  for (int i = 0; i < 5; ++i) {
    BodyDef body;
    body.inertia = box_inertia(0.05 + 0.02 * i, {0.02, 0.03, 0.025});
    body.X_WB = {{0.05 * i - 0.1, -0.4 - 0.05 * i, 0.05 + 0.1 * i},
                 axis_angle(normalized(Vec3{1, 2, 0.5}), 0.3 * i)};
    body.linear_damping = 0.1;
    body.angular_damping = 0.2;
    ShapeDef shape;
    shape.kind = kinds[i];
    shape.material = i % 2;
    shape.size = {0.02, 0.03,
                  kinds[i] == ShapeKind::kCapsule || kinds[i] == ShapeKind::kCylinder ? 0 : 0.025};
    if (kinds[i] == ShapeKind::kHull) {
      shape.size = {};
      for (int k = 0; k < 8; ++k)
        shape.points.push_back({k & 1 ? 0.02 : -0.02, k & 2 ? 0.03 : -0.025, k & 4 ? 0.02 : -0.03});
    }
    shape.X_LS = {{0.004, -0.003, 0.002}, axis_angle(Vec3{0, 0, 1}, 0.2)};
    body.shapes.push_back(shape);
    def.bodies.push_back(body);
  }
  return def;
}

void drive(World& world, Stream& random, int k) {
  test::random_targets(world, random);
  world.push_base(1, {6 * random.signed_unit(), 6 * random.signed_unit(), 30}, {0, 0, 0});
  if (k % 30 == 10) {
    const Vec3 p{0.01 * random.signed_unit(), -0.36, 0.56};
    for (int32_t i = 0; i < world.scene().num_bodies; ++i)
      world.set_body(i, {{p + Vec3{0, 0.015 * i, 0.07 * i}, {}}, {}, {0, 0, random.uniform()}});
  }
}

// What a state says of places and rates: all but the record of factors behind it.
std::vector<unsigned char> motion_of(World& world) {
  std::vector<unsigned char> bytes = test::saved(world);
  if (!world.dynamics()) return bytes;
  Writer count(nullptr, 0);
  world.dynamics()->save(count);
  bytes.resize(bytes.size() - count.size());
  return bytes;
}

void scale(Inertia* inertia, double mass, double moment) {
  inertia->mass *= mass;
  for (double& m : inertia->moment) m *= moment;
}

struct Kind {
  const char* name;
  std::function<void(Dynamics&, double)> factor;
  std::function<void(SceneDef&, double)> build;
};
void PrintTo(const Kind& k, std::ostream* out) {
  *out << k.name;
}

std::vector<Kind> kinds() {
  const auto links = [](SceneDef& def, auto change) {
    for (ArticulationDef& a : def.articulations)
      for (LinkDef& link : a.links) change(link);
  };
  return {
      {"link_mass",
       [](Dynamics& d, double f) {
         for (int i = 0; i < d.num_links; ++i) d.links[i].mass = f;
       },
       [=](SceneDef& def, double f) { links(def, [=](LinkDef& l) { scale(&l.inertia, f, f); }); }},
      {"kp",
       [](Dynamics& d, double f) {
         for (int i = 0; i < d.num_links; ++i) d.links[i].kp = f;
       },
       [=](SceneDef& def, double f) { links(def, [=](LinkDef& l) { l.joint.kp *= f; }); }},
      {"kd",
       [](Dynamics& d, double f) {
         for (int i = 0; i < d.num_links; ++i) d.links[i].kd = f;
       },
       [=](SceneDef& def, double f) { links(def, [=](LinkDef& l) { l.joint.kd *= f; }); }},
      {"effort",
       [](Dynamics& d, double f) {
         for (int i = 0; i < d.num_links; ++i) d.links[i].effort = f;
       },
       [=](SceneDef& def, double f) { links(def, [=](LinkDef& l) { l.joint.effort *= f; }); }},
      {"joint_friction",
       [](Dynamics& d, double f) {
         for (int i = 0; i < d.num_links; ++i) d.links[i].friction = f;
       },
       [=](SceneDef& def, double f) { links(def, [=](LinkDef& l) { l.joint.friction *= f; }); }},
      {"base_mass", [](Dynamics& d, double f) { d.bases[1].mass = f; },
       [](SceneDef& def, double f) { scale(&def.articulations[1].base, f, f); }},
      {"base_damping", [](Dynamics& d, double f) { d.bases[1].damping = f; },
       [](SceneDef& def, double f) { def.articulations[1].base_damping *= f; }},
      {"body_mass",
       [](Dynamics& d, double f) {
         for (int i = 0; i < d.num_bodies; ++i) d.bodies[i].mass = f;
       },
       [](SceneDef& def, double f) {
         for (BodyDef& b : def.bodies) scale(&b.inertia, f, f);
       }},
      {"body_size",
       [](Dynamics& d, double f) {
         for (int i = 0; i < d.num_bodies; ++i) d.bodies[i].size = f;
       },
       [](SceneDef& def, double f) {
         for (BodyDef& b : def.bodies) {
           scale(&b.inertia, 1, f * f);
           for (ShapeDef& s : b.shapes) {
             s.size = f * s.size;
             s.X_LS.p = f * s.X_LS.p;
             for (Vec3& p : s.points) p = f * p;
           }
         }
       }},
      {"body_damping",
       [](Dynamics& d, double f) {
         for (int i = 0; i < d.num_bodies; ++i) d.bodies[i].linear_damping = d.bodies[i].angular_damping = f;
       },
       [](SceneDef& def, double f) {
         for (BodyDef& b : def.bodies) b.linear_damping *= f, b.angular_damping *= f;
       }},
      {"friction", [](Dynamics& d, double f) { d.friction[Dynamics::friction_index(0, 1)] = f; },
       [](SceneDef& def, double f) { def.friction[0][1].mu *= f, def.friction[1][0].mu *= f; }},
      {"gravity", [](Dynamics& d, double f) { d.gravity = f; },
       [](SceneDef& def, double f) { def.gravity = f * def.gravity; }},
  };
}

// Steps `worlds` alike; expects the same motion at every step. Returns a hash of the last one's end.
uint64_t expect_alike(const std::vector<World*>& worlds, int steps = 60) {
  std::vector<Stream> streams(worlds.size(), Stream(5, 0, Purpose::kTest));
  int64_t contacts = 0;
  for (int k = 0; k < steps; ++k) {
    for (size_t i = 0; i < worlds.size(); ++i) {
      drive(*worlds[i], streams[i], k);
      worlds[i]->step();
      EXPECT_EQ(worlds[i]->status() & ~kStatusUnconverged, 0u);
    }
    contacts += worlds[0]->num_contacts();
    const std::vector<unsigned char> want = motion_of(*worlds[0]);
    for (World* world : worlds)
      if (motion_of(*world) != want) {
        ADD_FAILURE() << "step " << k;
        return 0;
      }
  }
  EXPECT_GT(contacts, 3 * steps);
  const std::vector<unsigned char> end = motion_of(*worlds.back());
  return hash_bytes(end.data(), end.size());
}

class EachFactor : public testing::TestWithParam<Kind> {};
INSTANTIATE_TEST_SUITE_P(, EachFactor, testing::ValuesIn(kinds()),
                         [](const auto& info) { return info.param.name; });

TEST_P(EachFactor, IsTheSameAsABuiltSceneToTheBit) {
  SceneDef def = rich();
  test::Simulation plain(def, kEngine);
  const uint64_t before = expect_alike({&*plain});
  for (const double f : {0.5, 1.3}) {
    SceneDef built_def = rich();
    GetParam().build(built_def, f);
    test::Simulation built(built_def, kEngine);
    def.adjustable = true;
    test::Simulation own(def, kEngine);
    Dynamics& factors = own->edit_dynamics();
    GetParam().factor(factors, f);
    own->set_dynamics(factors);
    const uint64_t after = expect_alike({&*built, &*own});
    EXPECT_NE(after, before) << "the factor does nothing";
  }
}

TEST_P(EachFactor, IsTheSameInDouble) {
  SceneDef def = rich(), built_def = rich();
  GetParam().build(built_def, 2);
  def.adjustable = true;
  def.solver.double_precision = built_def.solver.double_precision = true;
  test::Simulation built(built_def, kEngine), own(def, kEngine);
  Dynamics& factors = own->edit_dynamics();
  GetParam().factor(factors, 2);
  own->set_dynamics(factors);
  expect_alike({&*built, &*own}, 40);
}

// Factors of all kinds, another in each world.
void randomise(World& world, uint32_t index) {
  Stream random(6, index, Purpose::kTest);
  Dynamics& d = world.edit_dynamics();
  const auto draw = [&](double& x) { x = random.uniform(0.7, 1.3); };
  draw(d.gravity);
  for (int i = 0; i < d.num_links; ++i) {
    LinkFactors& f = d.links[i];
    for (double* x : {&f.mass, &f.kp, &f.kd, &f.effort, &f.friction}) draw(*x);
  }
  for (int i = 0; i < d.num_bases; ++i) draw(d.bases[i].mass), draw(d.bases[i].damping);
  for (int i = 0; i < d.num_bodies; ++i) {
    BodyFactors& f = d.bodies[i];
    for (double* x : {&f.mass, &f.size, &f.linear_damping, &f.angular_damping}) draw(*x);
  }
  for (int i = 0; i < d.num_friction; ++i) draw(d.friction[i]);
  world.set_dynamics(d);
}

TEST(DynamicsWorlds, FactorsOfOneChangeNoBit) {
  SceneDef def = rich();
  test::Simulation plain(def, kEngine);
  def.adjustable = true;
  test::Simulation adjustable(def, kEngine), twice(def, kEngine);
  twice->set_dynamics(twice->edit_dynamics());
  expect_alike({&*plain, &*adjustable, &*twice});
}

TEST(DynamicsWorlds, LanesAndGroupsChangeNoBit) {
  constexpr int32_t kWorlds = 9;
  const auto play = [&](int32_t lanes, int32_t together) {
    SceneDef def = rich();
    def.adjustable = true;
    def.solver.lanes = lanes;
    test::Partners worlds(def, kWorlds);
    std::vector<Stream> streams;
    for (uint32_t i = 0; i < kWorlds; ++i) {
      randomise(worlds[static_cast<int32_t>(i)], i);
      streams.emplace_back(7, i, Purpose::kTest);
    }
    std::vector<uint64_t> hashes;
    for (int k = 0; k < 40; ++k) {
      for (int32_t i = 0; i < kWorlds; ++i) drive(worlds[i], streams[static_cast<size_t>(i)], k);
      if (k == 25) randomise(worlds[3], 77);  // under way
      for (int32_t i = 0; i < kWorlds; i += together)
        World::step_together(worlds.data() + i, std::min(together, kWorlds - i));
      if (k % 10 != 9) continue;
      for (int32_t i = 0; i < kWorlds; ++i) {
        EXPECT_EQ(worlds[i].status() & ~kStatusUnconverged, 0u);
        hashes.push_back(test::state_hash(worlds[i]));
      }
    }
    return hashes;
  };
  const auto want = play(1, 1);
  std::vector<uint64_t> distinct = want;
  std::sort(distinct.begin(), distinct.end());
  EXPECT_EQ(std::unique(distinct.begin(), distinct.end()), distinct.end());
  for (const int32_t lanes : {0, 1, 4, 8, 16})
    for (const int32_t together : {1, 3, 8, 9})
      EXPECT_EQ(play(lanes, together), want) << lanes << " " << together;
}

// Partners share geoms and bounds: what one world's size left there must not reach the next.
TEST(DynamicsWorlds, PartnersDoNotFeelEachOthersSizes) {
  SceneDef def = rich();
  def.adjustable = true;
  test::Partners group(def, 3);
  test::Simulation alone(def, kEngine);
  for (int32_t i = 0; i < 3; ++i) {
    Dynamics& d = group[i].edit_dynamics();
    for (int k = 0; k < d.num_bodies; ++k) d.bodies[k].size = 0.6 + 0.5 * i;
    group[i].set_dynamics(d);
    if (i == 1) alone->set_dynamics(d);
  }
  std::vector<Stream> streams(4, Stream(8, 0, Purpose::kTest));
  for (int k = 0; k < 50; ++k) {
    for (int32_t i = 0; i < 3; ++i) drive(group[i], streams[static_cast<size_t>(i)], k);
    drive(*alone, streams[3], k);
    World::step_together(group.data(), 3);
    alone->step();
    ASSERT_EQ(test::state_hash(group[1]), test::state_hash(*alone)) << k;
    for (int32_t body = 0; body < 6; ++body) {
      (void)group[2].body_overlap(body);
      ASSERT_EQ(group[1].body_overlap(body), alone->body_overlap(body)) << k;
    }
  }
}

TEST(DynamicsWorlds, ShapesAreToldInTheirOwnSize) {
  SceneDef def = rich();
  def.adjustable = true;
  test::Simulation sim(def, kEngine);
  Dynamics& d = sim->edit_dynamics();
  for (int k = 0; k < d.num_bodies; ++k) d.bodies[k].size = 1.5;
  sim->set_dynamics(d);
  int hulls = 0;
  for (int32_t i = 0; i < static_cast<int32_t>(sim.scene().shapes.size()); ++i) {
    const SceneShape& s = sim.scene().shapes[static_cast<size_t>(i)];
    const double f = s.carrier == Carrier::kBody ? 1.5 : 1;
    EXPECT_EQ(norm(sim->shape_size(i) - f * s.def.size), 0);
    if (s.carrier == Carrier::kBody) {
      const Pose want = sim->body(s.index).X * Pose{f * s.def.X_LS.p, s.def.X_LS.q};
      EXPECT_EQ(norm(sim->shape_pose(i).p - want.p), 0);
    }
    const Hull *hull = sim->shape_hull(i), *scene_hull = sim.scene().hull_of(s);
    ASSERT_EQ(hull != nullptr, scene_hull != nullptr);
    if (!hull) continue;
    ++hulls;
    EXPECT_NEAR(hull->volume, f * f * f * scene_hull->volume, 1e-15);
    EXPECT_EQ(norm(hull->points[3] - f * scene_hull->points[3]), 0);
  }
  EXPECT_EQ(hulls, 1);
}

TEST(DynamicsWorlds, StatesHoldThem) {
  SceneDef def = rich();
  def.adjustable = true;
  test::Simulation world(def, kEngine), other(def, kEngine);
  randomise(*world, 1);
  randomise(*other, 2);
  Stream a(9, 0, Purpose::kTest);
  for (int k = 0; k < 30; ++k) {
    drive(*world, a, k);
    world->step();
  }
  test::load(*other, test::saved(*world));
  Stream b = a;
  for (int k = 30; k < 80; ++k) {
    drive(*world, a, k);
    drive(*other, b, k);
    world->step();
    other->step();
    ASSERT_EQ(test::saved(*other), test::saved(*world)) << k;
  }
}

TEST(DynamicsWorlds, StatesWithFactorsOutOfBoundsAreRefused) {
  SceneDef def = rich();
  def.adjustable = true;
  test::Simulation world(def, kEngine);
  randomise(*world, 1);
  world->step();
  const std::vector<unsigned char> good = test::saved(*world);
  const size_t record = good.size() - motion_of(*world).size();
  for (size_t at = good.size() - record; at < good.size(); at += sizeof(double))
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), -11.0, 1001.0}) {
      std::vector<unsigned char> bytes = good;
      std::memcpy(bytes.data() + at, &bad, sizeof bad);
      try {
        test::load(*world, bytes);
        ADD_FAILURE() << "taken at " << at;
      } catch (const Error& e) {
        ASSERT_EQ(e.code, Code::kFormat);
      }
      ASSERT_EQ(test::saved(*world), good);
    }
  SceneDef plain = rich();
  test::Simulation without(plain, kEngine);
  const std::vector<unsigned char> cut(good.begin(), good.end() - static_cast<ptrdiff_t>(record));
  EXPECT_THROW(test::load(*world, cut), Error);
  EXPECT_EQ(test::saved(*world), good);
}

TEST(DynamicsWorlds, BadFactorsAreRefusedByName) {
  SceneDef def = rich();
  def.adjustable = true;
  test::Simulation sim(def, kEngine);
  const auto refused = [&](auto spoil, Code code, const char* words) {
    const std::vector<unsigned char> before = test::saved(*sim);
    Dynamics& d = sim->edit_dynamics();
    spoil(d);
    try {
      sim->set_dynamics(d);
      ADD_FAILURE() << words;
    } catch (const Error& e) {
      EXPECT_EQ(e.code, code);
      EXPECT_NE(std::strstr(e.text, words), nullptr) << e.text;
    }
    EXPECT_EQ(test::saved(*sim), before);
  };
  refused([](Dynamics& d) { d.links[30].mass = 0; }, Code::kRange, "factor 0 of mass of link 30");
  refused([](Dynamics& d) { d.links[3].kp = -1; }, Code::kRange, "kp of link 3");
  refused([](Dynamics& d) { d.links[0].effort = std::nan(""); }, Code::kRange, "effort of link 0");
  refused([](Dynamics& d) { d.bases[1].damping = 1e4; }, Code::kRange, "damping of base 1");
  refused([](Dynamics& d) { d.bodies[2].size = 0.01; }, Code::kRange, "size of body 2 is outside [0.05, 20]");
  refused([](Dynamics& d) { d.friction[2] = -0.1; }, Code::kRange, "friction of pair 2");
  refused([](Dynamics& d) { d.gravity = 11; }, Code::kRange, "gravity");
  refused([](Dynamics& d) { --d.num_bodies; }, Code::kArgument, "another scene");
  test::Simulation plain(rich(), kEngine);
  EXPECT_EQ(plain->dynamics(), nullptr);
  EXPECT_THROW(plain->edit_dynamics(), Error);
  EXPECT_THROW(plain->set_dynamics(*sim->dynamics()), Error);
}

TEST(DynamicsWorlds, EnginesWithoutThemRefuseTheScene) {
  SceneDef def = rich();
  def.adjustable = true;
  const auto code_of = [&](EngineKind kind) { return guard([&] { test::Simulation sim(def, kind); }); };
  EXPECT_EQ(code_of(EngineKind::kOde), Code::kUnsupported);
  def.articulations.clear();
  EXPECT_EQ(code_of(EngineKind::kKinematic), Code::kUnsupported);
}

TEST(DynamicsWorlds, AreDrawnAndStepWithoutTheHeap) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is not counted under sanitizers";
  SceneDef def = rich();
  def.adjustable = def.feedforward = true;
  test::Partners worlds(def, 4);
  const int64_t before = heap_count();
  for (uint32_t k = 0; k < 100; ++k) {
    randomise(worlds[static_cast<int32_t>(k % 4)], k);
    World::step_together(worlds.data(), 4);
  }
  EXPECT_EQ(heap_count() - before, 0);
}

TEST(DynamicsWorlds, PlainScenesPayNothing) {
  SceneDef def = rich();
  const Scene plain = make_scene(def);
  def.adjustable = true;
  const Scene own = make_scene(def);
  Arena small, large;
  World::measure(kEngine, plain, small, true);
  World::measure(kEngine, own, large, true);
  EXPECT_LT(small.used(), large.used());
  test::Simulation a(rich(), kEngine), b(def, kEngine);
  EXPECT_LT(test::saved(*a).size(), test::saved(*b).size());
}

}  // namespace
}  // namespace rdm
