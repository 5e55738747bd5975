#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <thread>
#include <utility>
#include <vector>

#include "base/error.hpp"
#include "base/hash.hpp"
#include "base/rng.hpp"
#include "heap_count.hpp"
#include "physics/ode/ode_world.hpp"
#include "two_hands.hpp"

namespace rdm {
namespace {

void random_targets(World& world, Stream& random) {
  double share[24];
  for (int hand = 0; hand < 2; ++hand) {
    for (double& s : share) s = random.uniform();
    test::target_share(world, hand, share);
  }
}

uint64_t state_hash(const World& world) {
  std::vector<unsigned char> bytes(Writer(nullptr, 0).size() + (size_t{1} << 16));
  Writer out(bytes.data(), bytes.size());
  world.save(out);
  EXPECT_TRUE(out.fits());
  return hash_bytes(bytes.data(), out.size());
}

TEST(OdeWorld, SameTargetsSameBytes) {
  uint64_t hash[2];
  for (uint64_t& h : hash) {
    test::Simulation sim(test::two_hands_def());
    Stream random(1, 0, Purpose::kTest);
    for (int k = 0; k < 200; ++k) {
      random_targets(*sim, random);
      sim->step();
    }
    h = state_hash(*sim);
  }
  EXPECT_EQ(hash[0], hash[1]);
}

TEST(OdeWorld, ThreadsChangeNothing) {
  constexpr int kWorlds = 8;
  uint64_t hashes[2] = {};
  for (const int threads : {1, 2}) {
    std::vector<std::unique_ptr<test::Simulation>> worlds;
    for (int i = 0; i < kWorlds; ++i)
      worlds.push_back(std::make_unique<test::Simulation>(test::two_hands_def()));
    const auto work = [&](int thread) {
      for (int i = thread; i < kWorlds; i += threads) {
        Stream random(2, static_cast<uint32_t>(i), Purpose::kTest);
        for (int k = 0; k < 100; ++k) {
          random_targets(**worlds[static_cast<size_t>(i)], random);
          (*worlds[static_cast<size_t>(i)])->step();
        }
      }
    };
    std::vector<std::thread> pool;
    for (int t = 1; t < threads; ++t) pool.emplace_back(work, t);
    work(0);
    for (std::thread& t : pool) t.join();
    uint64_t all = kHashSeed;
    for (auto& world : worlds) {
      const uint64_t one = state_hash(**world);
      all = hash_bytes(&one, sizeof one, all);
    }
    hashes[threads - 1] = all;
  }
  EXPECT_EQ(hashes[0], hashes[1]);
}

TEST(OdeWorld, StepsWithoutTheHeap) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is not counted under sanitizers";
  test::Simulation sim(test::two_hands_def());
  Stream random(1, 0, Purpose::kTest);
  const double zero[24] = {};
  const int64_t before = heap_count();
  for (int k = 0; k < 1000; ++k) {
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

TEST(OdeWorld, StepsAtTheContactCapWithoutTheHeap) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is not counted under sanitizers";
  // Many boxes dropped through each other: from the first step on there are more contacts than the cap.
  SceneDef def;
  for (int i = 0; i < 12; ++i) {
    BodyDef body;
    body.X_WB.p = {0.01 * i, 0, 0.05 + 0.02 * i};
    body.inertia = box_inertia(0.1, {0.05, 0.05, 0.05});
    ShapeDef shape;
    shape.kind = ShapeKind::kBox;
    shape.size = {0.05, 0.05, 0.05};
    body.shapes.push_back(shape);
    def.bodies.push_back(body);
  }
  ShapeDef ground;
  ground.kind = ShapeKind::kPlane;
  def.statics.push_back(ground);
  test::Simulation sim(def);
  const int64_t before = heap_count();
  bool full = false;
  for (int k = 0; k < 50; ++k) {
    sim->step();
    full |= (sim->status() & kStatusContactOverflow) != 0;
  }
  EXPECT_EQ(heap_count() - before, 0);
  EXPECT_TRUE(full);
}

TEST(OdeWorld, TakesTheMemoryItAnnounces) {
  const Scene scene = make_scene(test::two_hands_def());
  Arena measure;
  World::measure(EngineKind::kOde, scene, measure);
  Arena arena(HostHooks{}, measure.used());
  World* world = World::create(EngineKind::kOde, scene, arena, HostHooks{});
  EXPECT_EQ(arena.used(), measure.used());
  World::destroy(world, HostHooks{});
}

TEST(OdeWorld, TakesAtMostEightIterations) {
  SceneDef def = test::two_hands_def();
  def.solver.iterations = 9;
  EXPECT_THROW(test::Simulation sim(def), Error);
}

TEST(OdeWorld, NanTargetIsFlaggedAndReplaced) {
  test::Simulation sim(test::two_hands_def());
  sim->target()[3] = std::numeric_limits<double>::quiet_NaN();
  sim->step();
  EXPECT_EQ(sim->status(), kStatusDiverged);
  EXPECT_TRUE(std::isfinite(sim->target()[3]));
  sim->step();
  EXPECT_EQ(sim->status(), 0u);
  for (int i = 0; i < 48; ++i) EXPECT_TRUE(std::isfinite(sim->q()[i]));
}

TEST(OdeWorld, TargetsBeyondTheRangeActAsTheRangesEnd) {
  test::Simulation a(test::two_hands_def()), b(test::two_hands_def());
  a->target()[3] = 1e300;
  b->target()[3] = b.scene().link(3).joint.upper;
  for (int k = 0; k < 20; ++k) {
    a->step();
    b->step();
  }
  EXPECT_EQ(a->q()[3], b->q()[3]);
}

TEST(OdeWorld, DivergenceIsFlaggedAndTheWorldGoesOn) {
  test::Simulation sim(test::two_hands_def());
  sim->push_body(0, {1e300, 1e300, 0}, {});
  sim->step();
  EXPECT_EQ(sim->status() & kStatusDiverged, kStatusDiverged);
  EXPECT_TRUE(finite(sim->body(0).X.p) && finite(sim->body(0).v));
  sim->push_link(5, {0, 0, 1e300}, {1, 1, 1});
  sim->step();
  EXPECT_EQ(sim->status() & kStatusDiverged, kStatusDiverged);
  for (int i = 0; i < 48; ++i) EXPECT_TRUE(std::isfinite(sim->q()[i]) && std::isfinite(sim->qd()[i]));
  sim->step();
  EXPECT_EQ(sim->status(), 0u);
  // Reset, it moves like a new one.
  test::Simulation fresh(test::two_hands_def());
  const double zero[24] = {};
  for (World* world : {&*sim, &*fresh}) {
    for (int hand = 0; hand < 2; ++hand) world->set_joints(hand, zero, zero);
    world->set_body(0, {{{0, -0.36, 0.56}, {}}, {}, {}});
    for (int k = 0; k < 48; ++k) world->target()[k] = 0;
    for (int k = 0; k < 60; ++k) world->step();
  }
  EXPECT_EQ(state_hash(*sim), state_hash(*fresh));
}

TEST(OdeWorld, RefusesValuesThatAreNotFinite) {
  test::Simulation sim(test::two_hands_def());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  double q[24] = {}, still[24] = {};
  q[5] = nan;
  EXPECT_THROW(sim->set_joints(0, q, still), Error);
  EXPECT_THROW(sim->set_body(0, {{{nan, 0, 0}, {}}, {}, {}}), Error);
  EXPECT_THROW(sim->set_body(0, {{{}, {0, 0, 0, 0}}, {}, {}}), Error);
  EXPECT_THROW(sim->push_body(0, {nan, 0, 0}, {}), Error);
  EXPECT_THROW(sim->set_base(0, {}), Error);              // fixed
  EXPECT_THROW(sim->push_base(0, {1, 0, 0}, {}), Error);  // fixed
  sim->step();
  EXPECT_EQ(sim->status(), 0u);
}

TEST(OdeWorld, ManyWorldsComeAndGo) {
  for (int k = 0; k < 20; ++k) {
    test::Simulation a(test::two_hands_def()), b(test::two_hands_def());
    a->step();
    b->step();
  }
}

// v' = g - c v has x = v0 p + g (t - p) / c with p = (1 - e^-ct) / c; a parabola without damping.
TEST(OdeWorld, FreeBodiesFlyExactly) {
  for (const int32_t substeps : {1, 2, 16})
    for (const double damping : {0.0, 1e-3, 0.7, 30.0}) {
      SceneDef def;
      def.solver.substeps = substeps;
      def.solver.h = 1.0 / 60 / substeps;
      BodyDef ball;
      ball.inertia = box_inertia(0.3, {0.02, 0.02, 0.02});
      ball.linear_damping = damping;
      def.bodies.push_back(ball);
      test::Simulation sim(def);
      sim->set_body(0, {{}, {1, 0, 2}, {}});
      for (int k = 0; k < 60; ++k) sim->step();
      const double t = 1, p = damping > 0 ? -std::expm1(-damping * t) / damping : t;
      const double fall = damping > 1e-6 ? (t - p) / damping : t * t / 2;
      EXPECT_NEAR(sim->body(0).X.p.x, p, 1e-7) << substeps << ' ' << damping;
      EXPECT_NEAR(sim->body(0).X.p.z, 2 * p - 9.81 * fall, 1e-7) << substeps << ' ' << damping;
    }
}

}  // namespace
}  // namespace rdm
