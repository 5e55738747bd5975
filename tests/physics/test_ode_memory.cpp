// Memory that is refused inside ODE, at every one of its allocations, and throws through its solver.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "heap_count.hpp"
#include "physics/model/inertia.hpp"
#include "two_hands.hpp"

namespace rdm {
namespace {

// Two worlds that share their working memory, in arenas that were there before.
class Couple {
 public:
  explicit Couple(EngineKind kind, SceneDef def = test::two_hands_def())
      : kind_(kind), scene_(make_scene(std::move(def))) {
    for (int i = 0; i < 2; ++i) {
      Arena measure;
      World::measure(kind_, scene_, measure, i == 1);
      size_[i] = measure.used();
      renew(i);
    }
  }
  ~Couple() { destroy(); }
  Couple(const Couple&) = delete;
  Couple& operator=(const Couple&) = delete;
  void create() {
    for (int i = 0; i < 2; ++i)
      worlds_[i] = World::create(kind_, scene_, arenas_[i], HostHooks{}, worlds_[0]);
  }
  // `first` of the two goes first.
  void destroy(int first = 1) {
    for (const int i : {first, 1 - first}) {
      World::destroy(worlds_[i], HostHooks{});
      worlds_[i] = nullptr;
    }
    for (int i = 0; i < 2; ++i) renew(i);
  }
  World* world(int i) { return worlds_[i]; }

 private:
  void renew(int i) { arenas_[i] = Arena(HostHooks{}, size_[i]); }
  EngineKind kind_;
  Scene scene_;
  Arena arenas_[2];
  size_t size_[2] = {};
  World* worlds_[2] = {};
};

class OdeMemory : public testing::TestWithParam<EngineKind> {};

TEST_P(OdeMemory, EveryRefusalIsAnErrorAndLeaksNothing) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is not ours under sanitizers";
  test::Simulation other(test::two_hands_def(), GetParam());  // what is taken once per process is there now
  other->step();
  Couple couple(GetParam());
  couple.create();
  couple.destroy();
  for (const int64_t refusals : {int64_t{1}, INT64_MAX}) {
    bool made = false;
    for (int64_t k = 0; !made; ++k) {
      const int64_t before = heap_blocks();
      refuse_heap(k, refusals);
      const Code code = guard([&] { couple.create(); });
      made = !allow_heap();
      ASSERT_EQ(code, made ? Code::kOk : Code::kMemory) << k << ' ' << refusals;
      couple.destroy(static_cast<int>(k % 2));
      ASSERT_EQ(heap_blocks(), before) << k << ' ' << refusals;
      ASSERT_LT(k, 5000);
    }
  }
  other->step();
  EXPECT_EQ(other->status(), 0u);
}

INSTANTIATE_TEST_SUITE_P(Engines, OdeMemory, testing::Values(EngineKind::kOde, EngineKind::kArticulated));

// A push no number can hold makes ODE complain in the middle of its solver, or must not get there.
TEST(OdeMemoryStep, AWorldThatDivergesLeaksNothing) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is not ours under sanitizers";
  Couple couple(EngineKind::kOde);
  couple.create();
  couple.destroy();
  const int64_t before = heap_blocks();
  couple.create();
  int64_t made = 0;
  for (int k = 0; k < 20; ++k) {
    World& world = *couple.world(k % 2);
    world.push_body(0, {1e306, 0, 0}, {0, 1e306, 0});
    world.step();
    ASSERT_EQ(world.status(), kStatusDiverged) << k;
    for (int i = 0; i < 3; ++i) world.step();
    ASSERT_EQ(world.status(), 0u) << k;
    if (k == 1) made = heap_blocks();  // both have met their first throw
    if (k > 1) {
      ASSERT_EQ(heap_blocks(), made) << k;
    }
  }
  couple.destroy();
  EXPECT_EQ(heap_blocks(), before);
}

// Memory refused while the solver is made anew: the world says so, and goes on when there is memory again.
TEST(OdeMemoryStep, AWorldThatCannotRestartTriesAgain) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the heap is not ours under sanitizers";
  const int64_t before = heap_blocks();
  {
    Couple couple(EngineKind::kOde);
    bool done = false;
    for (int k = 0; !done; ++k) {
      couple.create();
      World& world = *couple.world(k % 2);
      world.push_body(0, {1e306, 0, 0}, {0, 1e306, 0});
      refuse_heap(k, INT64_MAX);
      world.step();
      done = !allow_heap();
      ASSERT_EQ(world.status(), kStatusDiverged) << k;
      couple.world((k + 1) % 2)->step();
      ASSERT_EQ(couple.world((k + 1) % 2)->status(), 0u) << k;
      if (k % 3 == 0) world.step(), world.step();
      ASSERT_EQ(world.status(), k % 3 == 0 ? 0u : kStatusDiverged) << k;
      couple.destroy(k % 4 < 2);
      ASSERT_LT(k, 1000);
    }
  }
  EXPECT_EQ(heap_blocks(), before);
}

}  // namespace
}  // namespace rdm
