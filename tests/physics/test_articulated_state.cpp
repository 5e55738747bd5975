// Saving and loading an ArticulatedWorld.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "articulated.hpp"
#include "base/error.hpp"

namespace rdm {
namespace {

constexpr EngineKind kEngine = EngineKind::kArticulated;

// Random targets; now and then the ball is put back above the hand.
void drive(World& world, Stream& random, int k) {
  test::random_targets(world, random);
  for (int32_t a = 0; a < 2; ++a)
    if (world.scene().def.articulations[static_cast<size_t>(a)].free_base)
      world.push_base(a, {20 * random.signed_unit(), 20 * random.signed_unit(), 0},
                      {0, 0, random.signed_unit()});
  if (k % 75 != 10) return;
  const Vec3 p{0.01 * random.signed_unit(), -0.36 + 0.01 * random.signed_unit(), 0.56};
  world.set_body(0, {{p, normalized(Quat{1, random.uniform(), 0, 0})}, {}, {0, 0, random.uniform()}});
}

// 200 steps after `snapshot`, once unbroken and once in `other` that loads it: every state must agree.
void expect_exact(World& world, World& other, uint64_t seed) {
  const std::vector<unsigned char> snapshot = test::saved(world);
  Stream a(seed, 1, Purpose::kTest), b = a;
  std::vector<uint64_t> track;
  int touching = 0;
  for (int k = 0; k < 200; ++k) {
    drive(world, a, k);
    world.step();
    touching += world.num_contacts() > 0;
    track.push_back(test::state_hash(world));
  }
  EXPECT_GT(touching, 20);
  test::load(other, snapshot);
  ASSERT_EQ(test::saved(other), snapshot);
  for (int k = 0; k < 200; ++k) {
    drive(other, b, k);
    other.step();
    ASSERT_EQ(test::state_hash(other), track[static_cast<size_t>(k)]) << "step " << k;
  }
}

struct Variant {
  const char* name;
  bool free_base = false, wide = false;
};
void PrintTo(const Variant& v, std::ostream* out) {
  *out << v.name;
}

SceneDef def_of(const Variant& v) {
  SceneDef def = test::two_hands_def();
  def.solver.double_precision = v.wide;
  for (ArticulationDef& a : def.articulations) {
    a.free_base = v.free_base;
    a.base_damping = v.free_base ? 100 : 0;
  }
  return def;
}

class ArticulatedState : public testing::TestWithParam<Variant> {};

INSTANTIATE_TEST_SUITE_P(, ArticulatedState,
                         testing::Values(Variant{"fixed"}, Variant{"free", true},
                                         Variant{"wide", false, true}, Variant{"free_wide", true, true}),
                         [](const auto& info) { return info.param.name; });

TEST_P(ArticulatedState, GoesOnToTheBitInAFreshWorldAndInAScrambledOne) {
  test::Simulation world(def_of(GetParam()), kEngine), fresh(def_of(GetParam()), kEngine);
  Stream random(3, 0, Purpose::kTest);
  for (int k = 0; k < 137; ++k) {
    drive(*world, random, k);
    world->step();
  }
  expect_exact(*world, *fresh, 5);
  Stream noise(99, 0, Purpose::kTest);
  for (int k = 0; k < 17; ++k) {
    drive(*fresh, noise, k);
    fresh->step();
  }
  fresh->push_body(0, {1, 2, 3}, {});  // not yet acted on: gone after a load
  expect_exact(*world, *fresh, 6);
}

TEST_P(ArticulatedState, LinksAreThoseThatWereSaved) {
  test::Simulation world(def_of(GetParam()), kEngine), fresh(def_of(GetParam()), kEngine);
  Stream random(4, 0, Purpose::kTest);
  for (int k = 0; k < 20; ++k) {
    drive(*world, random, k);
    world->step();
  }
  for (int32_t i = 0; i < world.scene().num_links; ++i) (void)fresh->link(i);  // kept from before the load
  test::load(*fresh, test::saved(*world));
  for (int32_t i = 0; i < world.scene().num_links; ++i) {
    const Motion &a = world->link(i), &b = fresh->link(i);
    EXPECT_EQ(norm(a.X.p - b.X.p), 0);
    EXPECT_EQ(norm(a.v - b.v), 0);
    EXPECT_EQ(norm(a.w - b.w), 0);
    EXPECT_EQ(a.X.q.w, b.X.q.w);
  }
}

TEST(ArticulatedStateBytes, SizeIsTheSameAtAnyTime) {
  test::Simulation world(def_of({"fixed"}), kEngine);
  const size_t size = test::saved(*world).size();
  Stream random(5, 0, Purpose::kTest);
  int most = 0;
  for (int k = 0; k < 100; ++k) {
    drive(*world, random, k);
    world->step();
    most = std::max(most, world->num_contacts());
    ASSERT_EQ(test::saved(*world).size(), size);
  }
  EXPECT_GT(most, 4);
}

Code code_of(World& world, const std::vector<unsigned char>& bytes) {
  try {
    test::load(world, bytes);
  } catch (const Error& e) {
    return e.code;
  }
  return Code::kOk;
}

TEST(ArticulatedStateBytes, ThoseOfAnotherEngineSceneOrPrecisionAreRefused) {
  test::Simulation world(def_of({"fixed"}), kEngine);
  const uint64_t before = test::state_hash(*world);
  test::Simulation ode(def_of({"fixed"}), EngineKind::kOde);
  EXPECT_EQ(code_of(*world, test::saved(*ode)), Code::kFormat);
  EXPECT_EQ(code_of(*ode, test::saved(*world)), Code::kFormat);
  test::Simulation wide(def_of({"wide", false, true}), kEngine);
  EXPECT_EQ(code_of(*world, test::saved(*wide)), Code::kFormat);
  test::TwoHands config;
  config.ball = false;
  test::Simulation less(test::two_hands_def(config), kEngine);
  EXPECT_EQ(code_of(*world, test::saved(*less)), Code::kFormat);
  EXPECT_EQ(test::state_hash(*world), before);
}

// A world that was given bytes it refused steps like one that never saw them.
TEST(ArticulatedStateBytes, CutShortTheyAreRefusedAndTheWorldStaysAsItWas) {
  test::Simulation world(def_of({"free", true}), kEngine), other(def_of({"free", true}), kEngine);
  Stream random(6, 0, Purpose::kTest);
  for (int k = 0; k < 30; ++k) {
    drive(*other, random, k);
    other->step();
  }
  const std::vector<unsigned char> bytes = test::saved(*other);
  const uint64_t before = test::state_hash(*world);
  for (size_t size = 0; size < bytes.size(); size += 97) {
    const std::vector<unsigned char> part(bytes.begin(), bytes.begin() + static_cast<ptrdiff_t>(size));
    ASSERT_EQ(code_of(*world, part), Code::kFormat) << size;
    ASSERT_EQ(test::state_hash(*world), before) << size;
  }
  world->step();
  EXPECT_EQ(world->status(), 0u);
}

TEST(ArticulatedStateBytes, BrokenNumbersAreRefusedAndTheWorldStaysUsable) {
  test::Simulation world(def_of({"free", true}), kEngine);
  Stream random(7, 0, Purpose::kTest);
  for (int k = 0; k < 15; ++k) {
    drive(*world, random, k);
    world->step();
  }
  const std::vector<unsigned char> bytes = test::saved(*world);
  const uint64_t before = test::state_hash(*world);
  int refused = 0;
  for (size_t at = 0; at + 8 <= bytes.size(); at += 8) {
    std::vector<unsigned char> broken = bytes;
    for (size_t i = at; i < at + 8; ++i) broken[i] = 0xff;  // not a number in any row
    const Code code = code_of(*world, broken);
    if (code != Code::kOk) {
      ASSERT_EQ(code, Code::kFormat) << at;
      ASSERT_EQ(test::state_hash(*world), before) << at;
      ++refused;
    }
    world->step();
    for (int32_t i = 0; i < world.scene().num_links; ++i)
      ASSERT_TRUE(std::isfinite(world->q()[i]) && std::isfinite(world->qd()[i])) << at;
    ASSERT_TRUE(finite(world->body(0).X.p) && finite(world->base(0).X.p)) << at;
    test::load(*world, bytes);
  }
  EXPECT_GT(refused, 100);
}

// Numbers that no field of the type may hold.
template <class T>
std::vector<T> bad_numbers() {
  constexpr T kInfinity = std::numeric_limits<T>::infinity(), kMax = std::numeric_limits<T>::max();
  return {std::numeric_limits<T>::quiet_NaN(), kInfinity, -kInfinity, kMax / 100, -kMax / 100};
}

// Puts each of `values` where `at` points, one at a time: refused each time, and the world as it was.
template <class T>
void expect_refused(World& world, const std::vector<unsigned char>& good, size_t at,
                    const std::vector<T>& values, const char* field) {
  const uint64_t before = test::state_hash(world);
  for (const T& value : values) {
    std::vector<unsigned char> bytes = good;
    std::memcpy(bytes.data() + at, &value, sizeof value);
    ASSERT_EQ(code_of(world, bytes), Code::kFormat) << field << " at " << at << ": " << value;
    ASSERT_EQ(test::state_hash(world), before) << field << " at " << at;
  }
}

template <class S>
void expect_every_field_checked(World& world) {
  const Scene& scene = world.scene();
  const std::vector<unsigned char> good = test::saved(world);
  size_t at = 0;
  const auto check = [&](const auto& values, size_t count, const char* field) {
    for (size_t i = 0; i < count && !testing::Test::HasFatalFailure(); ++i, at += sizeof values[0])
      expect_refused(world, good, at, values, field);
  };
  const std::vector<double> wide = bad_numbers<double>();
  const auto links = static_cast<size_t>(scene.num_links);
  check(std::vector<int32_t>{0, -1}, 1, "engine");
  check(std::vector<int32_t>{-1, 0, scene.num_links + 1}, 1, "links");
  check(std::vector<int32_t>{-1, 0, scene.num_bodies + 1}, 1, "bodies");
  check(std::vector<uint32_t>{4, 0x80000000u, ~0u}, 1, "status");
  check(wide, links, "q");
  check(wide, links, "qd");
  check(wide, links, "target");
  check(wide, links, "torque");
  check(wide, 6 * scene.sensors.size(), "sensor");
  check(wide, 13 * scene.def.articulations.size(), "base");
  check(wide, 13 * static_cast<size_t>(scene.num_bodies), "body");
  const std::vector<S> words = bad_numbers<S>();
  const std::vector<S> sets = {S(0.5), S(-2), S(1e9), words[0]};
  for (const ArticulationDef& a : scene.def.articulations) {
    check(words, 6, "momentum of a base");
    for (size_t i = 0; i < a.links.size(); ++i) {
      check(words, 24, "motion of a link");
      check(sets, 2, "active set");
      check(words, 4, "quaternion of a link");
    }
  }
  const int32_t most = scene.def.solver.contacts_max;
  check(std::vector<int32_t>{-1, most + 1, std::numeric_limits<int32_t>::max()}, 1, "number of impulses");
  for (int32_t i = 0; i < most; ++i) {
    check(std::vector<int32_t>{-1, static_cast<int32_t>(scene.pairs.size()), 1 << 30}, 1, "pair");
    check(bad_numbers<float>(), 6, "point and impulse");
  }
  ASSERT_EQ(at, good.size());
  EXPECT_EQ(code_of(world, good), Code::kOk);
}

TEST_P(ArticulatedState, EveryFieldIsCheckedAndARefusedStateChangesNothing) {
  test::Simulation world(def_of(GetParam()), kEngine);
  Stream random(8, 0, Purpose::kTest);
  for (int k = 0; k < 30 || (k < 300 && world->num_contacts() == 0); ++k) {
    drive(*world, random, k);
    world->step();
  }
  ASSERT_GT(world->num_contacts(), 0);
  if (GetParam().wide)
    expect_every_field_checked<double>(*world);
  else
    expect_every_field_checked<float>(*world);
}

// What is in range is taken, even where the fields contradict each other: the world goes on, finite.
TEST_P(ArticulatedState, AStateThatIsTakenStepsFinite) {
  test::Simulation world(def_of(GetParam()), kEngine);
  Stream random(9, 0, Purpose::kTest);
  for (int k = 0; k < 30; ++k) {
    drive(*world, random, k);
    world->step();
  }
  const std::vector<unsigned char> good = test::saved(*world);
  int taken = 0;
  for (int k = 0; k < 3000; ++k) {
    std::vector<unsigned char> bytes = good;
    const auto size = static_cast<uint32_t>(bytes.size());
    for (int flips = 0; flips < 3; ++flips)
      bytes[random.below(size)] ^= static_cast<unsigned char>(1u << random.below(8));
    if (code_of(*world, bytes) != Code::kOk) continue;
    ++taken;
    world->step();
    for (int32_t i = 0; i < world.scene().num_links; ++i)
      ASSERT_TRUE(std::isfinite(world->q()[i]) && std::isfinite(world->qd()[i])) << k;
    ASSERT_TRUE(finite(world->body(0).X.p) && finite(world->base(0).X.p)) << k;
    ASSERT_EQ(code_of(*world, test::saved(*world)), Code::kOk) << k;
  }
  EXPECT_GT(taken, 500);
}

}  // namespace
}  // namespace rdm
