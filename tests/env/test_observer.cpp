// Pictures, points and voxels of a pool: what they show, that they agree with each other, and that threads,
// saved states and the heap make no difference.
#include <array>
#include <cmath>
#include <set>

#include "env/observer.hpp"
#include "heap_count.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

constexpr const char* kAll = "rgb+depth+segmentation+points+voxels";

// The toy's ball has a radius of 0.1 m; the cloud cameras look at it from 1 m.
std::vector<OptionInput> all_of_it(const char* modality = kAll) {
  return {{"modality", modality, 0},     {"image_width", nullptr, 48}, {"image_height", nullptr, 32},
          {"cloud_cameras", "front", 0}, {"cloud_width", nullptr, 64}, {"cloud_height", nullptr, 64},
          {"points", nullptr, 100},      {"voxels", nullptr, 9},       {"voxel_size", nullptr, 0.04}};
}

PoolConfig with(int32_t threads = 0) {
  register_toy();
  PoolConfig c;
  c.num_threads = threads;
  return c;
}

template <class T>
std::vector<T> copy(const T* from, size_t count) {
  return std::vector<T>(from, from + count);
}

TEST(Observer, EachModalityShowsTheBall) {
  TestPool p("toy_push", 3, all_of_it(), with());
  p->reset(nullptr, nullptr);
  const SenseBuffers& b = p->sensed();
  const SenseConfig& c = p->sense();
  EXPECT_EQ(c.num_cameras, 1);
  for (size_t env = 0; env < 3; ++env) {
    const Vec3 ball = p->world(static_cast<int32_t>(env)).body(0).X.p;
    size_t seen = 0;
    for (size_t i = env * 48 * 32; i < (env + 1) * 48 * 32; ++i) {
      EXPECT_EQ(b.depth[i] > 0, b.segmentation[i] == 0);
      seen += b.depth[i] > 0;
    }
    EXPECT_GT(seen, 5u);
    EXPECT_GT(b.point_count[env], 50);
    for (size_t i = env * 100; i < (env + 1) * 100; ++i) {
      const Vec3 at{b.points[3 * i], b.points[3 * i + 1], b.points[3 * i + 2]};
      EXPECT_NEAR(norm(at - ball), 0.1, 1e-5);
      EXPECT_EQ(b.point_shape[i], 0);
    }
    // the grid's middle is the ball's
    const int8_t* grid = b.voxels + env * 9 * 9 * 9;
    const auto cell = [&](int x, int y, int z) { return grid[(x * 9 + y) * 9 + z]; };
    EXPECT_EQ(cell(4, 4, 4), -1) << "inside the ball";
    EXPECT_EQ(cell(8, 4, 4), 0) << "between camera and ball";
    EXPECT_EQ(cell(0, 4, 4), -1) << "behind it";
    int occupied = 0;
    for (int x = 4; x < 9; ++x) occupied += cell(x, 4, 4) == 1;
    EXPECT_GE(occupied, 1);
    // and colours differ from the sky's somewhere
    const uint8_t* rgb = b.rgb + env * 48 * 32 * 3;
    EXPECT_NE(copy(rgb, 3), copy(rgb + 3 * (16 * 48 + 24), 3));
  }
}

TEST(Observer, WhatIsNotAskedForIsNotMade) {
  TestPool p("toy_push", 2, all_of_it("points"), with());
  EXPECT_EQ(p->sensed().rgb, nullptr);
  EXPECT_EQ(p->sensed().depth, nullptr);
  EXPECT_EQ(p->sensed().voxels, nullptr);
  EXPECT_NE(p->sensed().points, nullptr);
  TestPool none("toy_push", 2, {}, with());
  EXPECT_EQ(none->sensed().points, nullptr);
  EXPECT_FALSE(none->sense().any());
}

TEST(Observer, RowsFollowTheWorldsAlsoThroughAutoreset) {
  TestPool p("toy_push", 2, all_of_it(), with());
  p->reset(nullptr, nullptr);
  bool ended = false;
  for (int t = 0; t < 200; ++t) {
    p.action(0)[0] = 1;
    p.action(1)[0] = 0;
    p->step(nullptr);
    ended |= p.rows().terminated[0] || p.rows().truncated[0];
    for (size_t env = 0; env < 2; ++env) {
      const Vec3 ball = p->world(static_cast<int32_t>(env)).body(0).X.p;
      if (p->sensed().point_count[env] == 0) continue;  // it came too near to the camera
      const float* at = p->sensed().points + 300 * env;
      EXPECT_NEAR(norm(Vec3{at[0], at[1], at[2]} - ball), 0.1, 1e-5);
    }
  }
  EXPECT_TRUE(ended);
}

TEST(Observer, MaskedWorldsKeepTheirRows) {
  TestPool p("toy_push", 2, all_of_it(), with());
  p->reset(nullptr, nullptr);
  p.action(0)[0] = p.action(1)[0] = 1;
  for (int t = 0; t < 5; ++t) p->step(nullptr);
  const auto before = copy(p->sensed().points, 600);
  const uint8_t second[] = {0, 1};
  p->step(second);
  const auto after = copy(p->sensed().points, 600);
  EXPECT_TRUE(std::equal(before.begin(), before.begin() + 300, after.begin()));
  EXPECT_FALSE(std::equal(before.begin() + 300, before.end(), after.begin() + 300));
}

TEST(Observer, ThreadsChangeNoByte) {
  TestPool one("toy_push", 5, all_of_it(), with(0)), three("toy_push", 5, all_of_it(), with(3));
  for (TestPool* p : {&one, &three}) {
    (*p)->reset(nullptr, nullptr);
    for (int t = 0; t < 7; ++t) {
      (*p)->baseline(Baseline::kRandom);
      (*p)->step(nullptr);
    }
  }
  const SenseBuffers &a = one->sensed(), &b = three->sensed();
  EXPECT_EQ(copy(a.rgb, 5 * 48 * 32 * 3), copy(b.rgb, 5 * 48 * 32 * 3));
  EXPECT_EQ(copy(a.depth, 5 * 48 * 32), copy(b.depth, 5 * 48 * 32));
  EXPECT_EQ(copy(a.segmentation, 5 * 48 * 32), copy(b.segmentation, 5 * 48 * 32));
  EXPECT_EQ(copy(a.points, 1500), copy(b.points, 1500));
  EXPECT_EQ(copy(a.point_shape, 500), copy(b.point_shape, 500));
  EXPECT_EQ(copy(a.voxels, 5 * 729), copy(b.voxels, 5 * 729));
}

TEST(Observer, ASavedStateShowsTheSameAgainWhateverElseIsSeen) {
  TestPool p("toy_push", 1, all_of_it(), with()), blind("toy_push", 1, {}, with());
  p->reset(nullptr, nullptr);
  blind->reset(nullptr, nullptr);
  EXPECT_EQ(p->hash(-1), blind->hash(-1)) << "seeing changes no world";
  p.action(0)[0] = blind.action(0)[0] = 0.3f;
  std::vector<unsigned char> state(blind->state_size(-1));
  blind->step(nullptr);
  Writer out(state.data(), state.size());
  blind->get_state(-1, out);
  p->step(nullptr);
  p->step(nullptr);
  const auto want = copy(p->sensed().points, 300);
  p->step(nullptr);
  p->set_state(-1, state.data(), state.size());  // of a pool that sees nothing
  p->step(nullptr);
  EXPECT_EQ(copy(p->sensed().points, 300), want);
}

TEST(Observer, SeeingTakesNothingFromTheHeap) {
  if (!kHeapIsCounted) GTEST_SKIP() << "the sanitizer has the heap";
  TestPool p("toy_push", 2, all_of_it(), with());
  p->reset(nullptr, nullptr);
  for (int t = 0; t < 3; ++t) p->step(nullptr);
  const int64_t before = heap_count();
  for (int t = 0; t < 20; ++t) p->step(nullptr);
  EXPECT_EQ(heap_count(), before);
}

// Its own place in each episode, the same all through it: the ball lies still, so the first pixel that sees
// it does too.
TEST(Observer, CamerasThatStandElsewhere) {
  auto options = all_of_it("points");
  options.push_back({"camera_noise", nullptr, 0.05});
  TestPool p("toy_push", 2, options, with()), again("toy_push", 2, options, with(2)),
      nominal("toy_push", 2, all_of_it("points"), with());
  for (TestPool* pool : {&p, &again, &nominal}) (*pool)->reset(nullptr, nullptr);
  EXPECT_EQ(copy(p->sensed().points, 600), copy(again->sensed().points, 600));
  EXPECT_NE(copy(p->sensed().points, 300), copy(nominal->sensed().points, 300));
  const auto cloud = [&](const TestPool& pool) {
    std::set<std::array<float, 3>> seen;
    const float* at = const_cast<TestPool&>(pool)->sensed().points;
    for (int i = 0; i < 100; ++i) seen.insert({at[3 * i], at[3 * i + 1], at[3 * i + 2]});
    return seen;
  };
  for (size_t env = 0; env < 2; ++env) {
    const Vec3 ball = p->world(static_cast<int32_t>(env)).body(0).X.p;
    for (size_t i = env * 100; i < env * 100 + 100; ++i) {
      const float* at = p->sensed().points + 3 * i;
      EXPECT_NEAR(norm(Vec3{at[0], at[1], at[2]} - ball), 0.1, 1e-5) << "points are where they are";
    }
  }
  p->reset(nullptr, nullptr);
  EXPECT_NE(cloud(p), cloud(again)) << "another episode, another place";
}

TEST(Observer, NoisyPointsAreFewerAndOffTheBall) {
  auto options = all_of_it("points");
  options.push_back({"point_noise", nullptr, 0.01});
  options.push_back({"point_dropout", nullptr, 0.5});
  TestPool p("toy_push", 1, options, with());
  p->reset(nullptr, nullptr);
  EXPECT_GT(p->sensed().point_count[0], 20);
  EXPECT_LT(p->sensed().point_count[0], 80);
  double off = 0;
  for (int i = 0; i < 100; ++i) {
    const float* at = p->sensed().points + 3 * i;
    off = std::max(off, std::abs(norm(Vec3{at[0], at[1], at[2]} - p->world(0).body(0).X.p) - 0.1));
  }
  EXPECT_GT(off, 0.005);
  EXPECT_LT(off, 0.08);
}

}  // namespace
}  // namespace rdm::test
