// What an ArticulatedWorld promises as a World: memory, refused arguments, pushes, divergence. Its mechanics
// are in test_articulated_laws.cpp.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "articulated.hpp"
#include "base/error.hpp"
#include "heap_count.hpp"
#include "isa_scope.hpp"
#include "physics/articulated/articulated_world.hpp"
#include "quality_bodies.hpp"

namespace rdm {
namespace {

constexpr EngineKind kEngine = EngineKind::kArticulated;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <class F>
Code code_of(F&& f) {
  return guard(std::forward<F>(f));
}

SceneDef floating_hands() {
  SceneDef def = test::two_hands_def();
  for (ArticulationDef& a : def.articulations) a.free_base = true;
  return def;
}

TEST(ArticulatedWorld, StepsWithoutTheHeap) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is not counted under sanitizers";
  test::Partners worlds(floating_hands(), 4);
  Stream random(1, 0, Purpose::kTest);
  const double zero[24] = {};
  const int64_t before = heap_count();
  for (int k = 0; k < 500; ++k) {
    for (int32_t i = 0; i < 4; ++i) test::random_targets(worlds[i], random);
    worlds[0].push_link(5, {0, 0, 1}, worlds[0].link(5).X.p);
    if (k % 75 == 0) {
      worlds[1].set_joints(0, zero, zero);
      worlds[1].set_base(0, {{{0, 0, 0.5}, {}}, {}, {}});
      worlds[2].set_body(0, {{{0, -0.36, 0.56}, {}}, {}, {}});
      (void)worlds[2].body_overlap(0);
    }
    worlds[3].step();
    World::step_together(worlds.data(), 4);
  }
  EXPECT_EQ(heap_count() - before, 0);
}

TEST(ArticulatedWorld, StepsAtTheContactCapWithoutTheHeap) {
  SceneDef def;
  for (int i = 0; i < 12; ++i)
    def.bodies.push_back(test::make_box(0.1, {0.05, 0.05, 0.05}, {{0.01 * i, 0, 0.05 + 0.02 * i}, {}}));
  def.statics.push_back(test::make_plane());
  test::Simulation sim(def, kEngine);
  const int64_t before = heap_count();
  int full = 0;
  for (int k = 0; k < 50; ++k) {
    sim->step();
    const bool over = (sim->status() & kStatusContactOverflow) != 0;
    full += over;
    if (over) {
      EXPECT_EQ(sim->num_contacts() <= sim.scene().def.solver.contacts_max, true);
    }
  }
  if (kHeapIsCounted) {
    EXPECT_EQ(heap_count() - before, 0);
  }
  EXPECT_GT(full, 5);
}

TEST(ArticulatedWorld, TakesTheMemoryItAnnounces) {
  for (const int32_t lanes : {0, 1, 4, 8, 16})
    for (const bool wide : {false, true}) {
      SceneDef def = floating_hands();
      def.solver.lanes = lanes;
      def.solver.double_precision = wide;
      const Scene scene = make_scene(def);
      Arena first, second;
      World::measure(kEngine, scene, first);
      World::measure(kEngine, scene, second, true);
      EXPECT_LT(second.used(), first.used());
      Arena arena(HostHooks{}, first.used() + second.used());
      World* world = World::create(kEngine, scene, arena, HostHooks{});
      EXPECT_EQ(arena.used(), first.used()) << lanes << wide;
      World* partner = World::create(kEngine, scene, arena, HostHooks{}, world);
      EXPECT_EQ(arena.used(), first.used() + second.used()) << lanes << wide;
      // in either order: the last one that leaves takes the shared part along
      World::destroy(world, HostHooks{});
      partner->step();
      World::destroy(partner, HostHooks{});
    }
}

// Memory for so many worlds is memory for the widths that they are stepped in; any number goes on in it.
TEST(ArticulatedWorld, TakesMemoryForTheWorldsThatStepTogether) {
  const Scene scene = make_scene(floating_hands());
  size_t last = 0;
  for (const int32_t together : {1, 3, 12, 0}) {
    Arena first, second;
    World::measure(kEngine, scene, first, false, together);
    World::measure(kEngine, scene, second, true, together);
    EXPECT_GE(first.used(), last) << together;
    last = first.used();
    Arena arena(HostHooks{}, first.used() + 8 * second.used());
    World* worlds[9];
    for (int i = 0; i < 9; ++i)
      worlds[i] = World::create(kEngine, scene, arena, HostHooks{}, i ? worlds[0] : nullptr, together);
    EXPECT_EQ(arena.used(), first.used() + 8 * second.used()) << together;
    World::step_together(worlds, 9);
    for (int i = 1; i < 9; ++i) EXPECT_EQ(worlds[i]->q()[5], worlds[0]->q()[5]) << together;
    for (World* world : worlds) World::destroy(world, HostHooks{});
  }
  // one world has no lanes to fill; any number has the widest of the processor, or of a lesser one
  const IsaScope scope;
  for (const char* isa : {kBaseIsa, kV3Isa, kV4Isa}) {
    if (!set_stepper_isa(isa)) continue;
    Arena any, one;
    World::measure(kEngine, scene, any);
    World::measure(kEngine, scene, one, false, 1);
    printf("%s: %zu bytes of one world, %zu of any number\n", isa, one.used(), any.used());
    EXPECT_LT((widest_lanes() == 16 ? 3 : 2) * one.used(), any.used()) << isa;
  }
}

TEST(ArticulatedWorld, TooLittleMemoryIsAnError) {
  const Scene scene = make_scene(test::two_hands_def());
  Arena measure;
  World::measure(kEngine, scene, measure);
  for (const size_t share : {size_t{2}, size_t{5}, size_t{9}, size_t{10}}) {
    Arena arena(HostHooks{}, measure.used() * share / 10 - 64);
    EXPECT_THROW(World::create(kEngine, scene, arena, HostHooks{}), Error) << share;
  }
}

TEST(ArticulatedWorld, NanTargetIsFlaggedAndReplaced) {
  test::Simulation sim(test::two_hands_def(), kEngine);
  sim->target()[3] = kNan;
  sim->target()[30] = std::numeric_limits<double>::infinity();
  sim->step();
  EXPECT_EQ(sim->status(), kStatusDiverged);
  EXPECT_EQ(sim->target()[3], 0);
  EXPECT_EQ(sim->target()[30], 0);
  sim->step();
  EXPECT_EQ(sim->status(), 0u);
  for (int i = 0; i < 48; ++i) EXPECT_TRUE(std::isfinite(sim->q()[i]));
}

TEST(ArticulatedWorld, TargetsBeyondTheRangeActAsTheRangesEnd) {
  test::Simulation a(test::two_hands_def(), kEngine), b(test::two_hands_def(), kEngine);
  a->target()[3] = 1e300;
  b->target()[3] = b.scene().link(3).joint.upper;
  for (int k = 0; k < 20; ++k) {
    a->step();
    b->step();
  }
  EXPECT_EQ(a->q()[3], b->q()[3]);
  EXPECT_GT(a->q()[3], 0.1);
}

TEST(ArticulatedWorld, RefusesValuesThatAreNotFinite) {
  test::Simulation sim(floating_hands(), kEngine);
  const uint64_t before = test::state_hash(*sim);
  double q[24] = {}, still[24] = {};
  q[5] = kNan;
  EXPECT_EQ(code_of([&] { sim->set_joints(0, q, still); }), Code::kArgument);
  EXPECT_EQ(code_of([&] { sim->set_joints(1, still, q); }), Code::kArgument);
  const Motion bad[] = {{{{kNan, 0, 0}, {}}, {}, {}},
                        {{{}, {0, 0, 0, 0}}, {}, {}},
                        {{}, {0, kNan, 0}, {}},
                        {{}, {}, {0, 0, HUGE_VAL}}};
  for (const Motion& m : bad) {
    EXPECT_EQ(code_of([&] { sim->set_body(0, m); }), Code::kArgument);
    EXPECT_EQ(code_of([&] { sim->set_base(0, m); }), Code::kArgument);
  }
  const Vec3 nan{kNan, 0, 0};
  EXPECT_EQ(code_of([&] { sim->push_body(0, nan, {}); }), Code::kArgument);
  EXPECT_EQ(code_of([&] { sim->push_body(0, {}, nan); }), Code::kArgument);
  EXPECT_EQ(code_of([&] { sim->push_link(0, nan, {}); }), Code::kArgument);
  EXPECT_EQ(code_of([&] { sim->push_link(0, {}, nan); }), Code::kArgument);
  EXPECT_EQ(code_of([&] { sim->push_base(0, nan, {}); }), Code::kArgument);
  EXPECT_EQ(test::state_hash(*sim), before);
  sim->step();
  EXPECT_EQ(sim->status(), 0u);
}

TEST(ArticulatedWorld, AFixedBaseIsNotMoved) {
  test::Simulation sim(test::two_hands_def(), kEngine);
  EXPECT_EQ(code_of([&] { sim->set_base(0, {}); }), Code::kState);
  EXPECT_EQ(code_of([&] { sim->push_base(0, {1, 0, 0}, {}); }), Code::kState);
}

TEST(ArticulatedWorld, DivergenceIsFlaggedAndTheWorldGoesOn) {
  test::Simulation sim(floating_hands(), kEngine);
  const auto expect_flag = [&](const char* what) {
    sim->step();
    EXPECT_EQ(sim->status() & kStatusDiverged, kStatusDiverged) << what;
    for (int i = 0; i < 48; ++i) EXPECT_TRUE(std::isfinite(sim->q()[i]) && sim->qd()[i] == 0) << what;
    EXPECT_TRUE(finite(sim->body(0).X.p) && finite(sim->base(0).X.p)) << what;
    sim->step();
    EXPECT_EQ(sim->status(), 0u) << what;
  };
  sim->push_body(0, {1e300, 1e300, 0}, {});
  expect_flag("body");
  sim->push_link(5, {0, 0, 1e300}, {1, 1, 1});
  expect_flag("link");
  sim->push_base(1, {0, 1e300, 0}, {});
  expect_flag("base");
  // Reset, it moves like a new one.
  test::Simulation fresh(floating_hands(), kEngine);
  const double zero[24] = {};
  for (World* world : {&*sim, &*fresh}) {
    for (int hand = 0; hand < 2; ++hand) {
      world->set_base(hand, {world->scene().def.articulations[static_cast<size_t>(hand)].X_WB, {}, {}});
      world->set_joints(hand, zero, zero);
    }
    world->set_body(0, {{{0, -0.36, 0.56}, {}}, {}, {}});
    for (int k = 0; k < 48; ++k) world->target()[k] = 0;
  }
  for (int k = 0; k < 60; ++k) {
    for (World* world : {&*sim, &*fresh}) world->step();
    for (int i = 0; i < 48; ++i) ASSERT_NEAR(sim->q()[i], fresh->q()[i], 1e-5) << k;
  }
}

// dv = F t / m and dw = T t / I about a principal axis, for one step alone.
TEST(ArticulatedWorld, APushedBodyAcceleratesByItsMass) {
  SceneDef def;
  def.bodies.push_back(test::make_box(0.4, {0.05, 0.03, 0.02}, {{0, 0, 1}, {}}));
  def.bodies[0].gravity = false;
  test::Simulation sim(def, kEngine);
  const Vec3 force{1, -2, 3}, torque{0, 0, 0.01};
  sim->push_body(0, 0.25 * force, torque);
  sim->push_body(0, 0.75 * force, {});
  for (int k = 0; k < 3; ++k) {
    sim->step();
    EXPECT_LT(norm(sim->body(0).v - (sim.scene().control_dt() / 0.4) * force), 1e-12);
    const double moment = def.bodies[0].inertia.moment[2];
    EXPECT_LT(norm(sim->body(0).w - (sim.scene().control_dt() / moment) * torque), 1e-12);
  }
}

// Largest error of a floating hand's momentum against the sum of pushes at its base or on a fingertip, as a
// share. The joints start in the middle of their ranges and stay off the clamp at the end, which stops them
// without a reaction.
double momentum_error(bool on_base, int32_t finer) {
  SceneDef def = floating_hands();
  def.bodies.clear();
  for (ArticulationDef& a : def.articulations) a.self_pairs.clear();
  def.solver.h /= finer;
  def.solver.substeps *= finer;
  test::Simulation sim(def, kEngine);
  double middle[24];
  const double still[24] = {};
  std::fill_n(middle, 24, 0.5);
  test::target_share(*sim, 1, middle);
  std::copy_n(sim->target() + 24, 24, middle);
  sim->set_joints(1, middle, still);
  const Vec3 force = on_base ? Vec3{3, -4, 5} : Vec3{0.15, -0.2, 0.25};
  Vec3 impulse;
  double worst = 0;
  for (int k = 0; k < 30; ++k) {
    if (k % 2 == 0) {
      if (on_base)
        sim->push_base(1, force, {});
      else
        sim->push_link(24 + 5, force, sim->link(24 + 5).X.p);
      impulse += sim.scene().control_dt() * force;
    }
    sim->step();
    worst = std::max(worst, norm(test::momentum(*sim, 1).linear - impulse) / norm(impulse));
    EXPECT_EQ(norm(test::momentum(*sim, 0).linear), 0);
  }
  return worst;
}

TEST(ArticulatedWorld, APushedFloatingRobotGainsForceTimesTime) {
  EXPECT_LT(momentum_error(true, 1), 1e-4);
  // A turning robot's velocities belong to the pose before the last move: an error of the step's length.
  const double coarse = momentum_error(false, 1), fine = momentum_error(false, 8);
  EXPECT_LT(coarse, 2e-3);
  EXPECT_LT(fine, 2e-4);
  printf("%g %g %g\n", momentum_error(true, 1), coarse, fine);
}

// A push on a link without mass moves what hangs on it.
TEST(ArticulatedWorld, LinksWithoutMassArePushedToo) {
  const auto angle = [](double mass) {
    SceneDef def = test::rod_def();
    ArticulationDef& rod = def.articulations[0];
    rod.gravity = false;
    LinkDef first = rod.links[0];
    first.inertia = mass > 0 ? sphere_inertia(mass, 0.01) : Inertia{};
    first.joint.axis = {1, 0, 0};
    rod.links.insert(rod.links.begin(), first);
    rod.links[1].parent = 0;
    test::Simulation sim(def, kEngine);
    for (int k = 0; k < 30; ++k) {
      sim->push_link(0, {0, 0.2, 0}, sim->link(0).X * Vec3{0, 0, -0.2});
      sim->step();
    }
    return sim->q()[0];
  };
  EXPECT_GT(std::fabs(angle(1e-6)), 0.1);
  EXPECT_NEAR(angle(0), angle(1e-6), 1e-3);
}

TEST(ArticulatedWorld, SetJointsClampsAndMovesTheLinks) {
  test::Simulation sim(test::two_hands_def(), kEngine), ode(test::two_hands_def());
  Stream random(2, 0, Purpose::kTest);
  double q[24], qd[24];
  for (int i = 0; i < 24; ++i) {
    q[i] = 2 * random.signed_unit();
    qd[i] = random.signed_unit();
  }
  for (World* world : {&*sim, &*ode}) world->set_joints(1, q, qd);
  for (int32_t i = 0; i < 48; ++i) {
    const Motion &a = sim->link(i), &b = ode->link(i);
    EXPECT_NEAR(sim->q()[i], ode->q()[i], 1e-6);
    EXPECT_LT(norm(a.X.p - b.X.p), 1e-6) << i;
    EXPECT_LT(norm(a.v - b.v), 1e-5) << i;
    EXPECT_LT(norm(a.w - b.w), 1e-5) << i;
    EXPECT_LT(norm(rotate(a.X.q, {1, 2, 3}) - rotate(b.X.q, {1, 2, 3})), 1e-5) << i;
  }
}

}  // namespace
}  // namespace rdm
