// Saving and loading an OdeWorld.
#include <gtest/gtest.h>
#include <malloc.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "base/error.hpp"
#include "base/rng.hpp"
#include "physics/ode/ode_world.hpp"
#include "two_hands.hpp"

namespace rdm {
namespace {

std::vector<unsigned char> saved(const World& world) {
  Writer count(nullptr, 0);
  world.save(count);
  std::vector<unsigned char> bytes(count.size());
  Writer out(bytes.data(), bytes.size());
  world.save(out);
  EXPECT_TRUE(out.fits());
  return bytes;
}

void load(World& world, const std::vector<unsigned char>& bytes) {
  Reader in(bytes.data(), bytes.size(), "state");
  world.load(in);
  EXPECT_EQ(in.left(), 0u);
}

// Random targets; now and then the ball is put back above the hand.
void drive(World& world, Stream& random, int k) {
  double share[24];
  for (int hand = 0; hand < 2; ++hand) {
    for (double& s : share) s = random.uniform();
    test::target_share(world, hand, share);
  }
  if (k % 75 != 10) return;
  const Vec3 p{0.01 * random.signed_unit(), -0.36 + 0.01 * random.signed_unit(), 0.56};
  world.set_body(0, {{p, normalized(Quat{1, random.uniform(), 0, 0})}, {}, {0, 0, random.uniform()}});
}

// 1,000 steps after `snapshot`, once unbroken and once in `other` that loads it: every state must agree.
void expect_exact(World& world, World& other, uint64_t seed) {
  const std::vector<unsigned char> snapshot = saved(world);
  Stream a(seed, 1, Purpose::kTest), b = a;
  std::vector<std::vector<unsigned char>> track;
  for (int k = 0; k < 1000; ++k) {
    drive(world, a, k);
    world.step();
    track.push_back(saved(world));
  }
  load(other, snapshot);
  ASSERT_EQ(saved(other), snapshot);
  for (int k = 0; k < 1000; ++k) {
    drive(other, b, k);
    other.step();
    ASSERT_EQ(saved(other), track[static_cast<size_t>(k)]) << "step " << k;
  }
}

TEST(OdeState, GoesOnToTheBitInAFreshWorldAndInAScrambledOne) {
  for (uint64_t seed = 1; seed <= 2; ++seed) {
    test::Simulation world(test::two_hands_def()), fresh(test::two_hands_def());
    Stream random(seed, 0, Purpose::kTest);
    for (int k = 0; k < 100 + 37 * static_cast<int>(seed); ++k) {
      drive(*world, random, k);
      world->step();
    }
    expect_exact(*world, *fresh, seed);
    Stream noise(99, 0, Purpose::kTest);
    for (int k = 0; k < 17; ++k) {
      drive(*fresh, noise, k);
      fresh->step();
    }
    expect_exact(*world, *fresh, seed + 10);
  }
}

// Hands whose bases float: the base is a body of its own then.
SceneDef floating() {
  SceneDef def = test::two_hands_def();
  for (ArticulationDef& a : def.articulations) {
    a.free_base = true;
    a.base_damping = 100;
  }
  return def;
}

TEST(OdeState, FreeBasesToo) {
  test::Simulation world(floating()), fresh(floating());
  Stream random(4, 0, Purpose::kTest);
  for (int k = 0; k < 100; ++k) {
    drive(*world, random, k);
    world->push_base(0, {20 * random.signed_unit(), 20 * random.signed_unit(), 0},
                     {0, 0, random.signed_unit()});
    world->step();
  }
  expect_exact(*world, *fresh, 5);
}

TEST(OdeState, RefusesOtherScenesAndBrokenBytes) {
  test::Simulation world(test::two_hands_def());
  test::TwoHands c;
  c.ball = false;
  test::Simulation other(test::two_hands_def(c));
  std::vector<unsigned char> bytes = saved(*world);
  EXPECT_THROW(load(*other, bytes), Error);
  std::vector<unsigned char> half(bytes.begin(), bytes.begin() + static_cast<long>(bytes.size() / 2));
  EXPECT_THROW(load(*world, half), Error);
  for (size_t i = 12; i < 20; ++i) bytes[i] = 0xff;  // q of the first joint is not a number
  EXPECT_THROW(load(*world, bytes), Error);
  world->step();
  EXPECT_EQ(world->status(), 0u);
}

// Every number of a state in turn becomes one that no step leads to: refused, and nothing has changed; or it
// is one that a world may have, and then the world goes on.
TEST(OdeState, EveryNumberIsChecked) {
  test::Simulation world(floating());
  Stream random(6, 0, Purpose::kTest);
  for (int k = 0; k < 20; ++k) {
    drive(*world, random, k);
    world->step();
  }
  const std::vector<unsigned char> good = saved(*world);
  constexpr size_t kHead = 3 * sizeof(int32_t);
  ASSERT_EQ((good.size() - kHead) % sizeof(double), 0u);
  int refused = 0, taken = 0;
  for (const double value :
       {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity(), 1e300, -1e7, 3.0})
    for (size_t at = kHead; at < good.size(); at += sizeof(double)) {
      std::vector<unsigned char> bytes = good;
      std::memcpy(bytes.data() + at, &value, sizeof value);
      Code code = Code::kOk;
      try {
        load(*world, bytes);
      } catch (const Error& error) {
        code = error.code;
      }
      if (code == Code::kOk) {
        ASSERT_TRUE(std::isfinite(value)) << at;
        world->step();
        ASSERT_EQ(world->status(), 0u) << at << ' ' << value;
        load(*world, saved(*world));
        load(*world, good);
        ++taken;
      } else {
        ASSERT_EQ(code, Code::kFormat) << at;
        ASSERT_EQ(saved(*world), good) << at << ' ' << value;
        ++refused;
      }
    }
  EXPECT_GT(refused, taken);
  EXPECT_GT(taken, 0);
  for (const uint32_t status : {4u, 1u << 31}) {
    std::vector<unsigned char> bytes = good;
    std::memcpy(bytes.data() + 2 * sizeof(int32_t), &status, sizeof status);
    EXPECT_THROW(load(*world, bytes), Error);
  }
}

size_t heap_in_use() {
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
}

TEST(OdeState, HeapIsAnnouncedFromAbove) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "a sanitizer has a heap of its own";
#endif
  test::Simulation first(test::two_hands_def());  // what ODE takes once per process and thread
  first->step();
  for (const int32_t contacts : {1, 64, 256})
    for (const bool hands : {false, true}) {
      SceneDef def = test::two_hands_def();
      def.solver.contacts_max = contacts;
      if (!hands) def.articulations.clear();
      const Scene scene = make_scene(std::move(def));
      Arena measure;
      World::measure(EngineKind::kOde, scene, measure);
      Arena arena(HostHooks{}, measure.used());
      const size_t before = heap_in_use();
      World* world = World::create(EngineKind::kOde, scene, arena, HostHooks{});
      world->step();
      const size_t taken = heap_in_use() - before;
      World::destroy(world, HostHooks{});
      EXPECT_LE(taken, World::engine_bytes(EngineKind::kOde, scene)) << contacts;
      EXPECT_GE(taken, World::engine_bytes(EngineKind::kOde, scene) / 2) << contacts;
    }
}

}  // namespace
}  // namespace rdm
