// Furthest-point sampling against the plain quadratic form: the same points in the same order.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/error.hpp"
#include "base/rng.hpp"
#include "sense/cloud/furthest.hpp"

namespace rdm {
namespace {

using Points = std::vector<float>;

std::vector<int32_t> plain(const Points& p, int32_t wanted, int32_t start) {
  const auto count = static_cast<int32_t>(p.size() / 3);
  std::vector<float> distance(p.size() / 3, HUGE_VALF);
  std::vector<int32_t> chosen{start};
  while (static_cast<int32_t>(chosen.size()) < wanted) {
    const float* c = &p[3 * static_cast<size_t>(chosen.back())];
    int32_t best = 0;
    for (int32_t i = 0; i < count; ++i) {
      const float* q = &p[3 * static_cast<size_t>(i)];
      const float dx = q[0] - c[0], dy = q[1] - c[1], dz = q[2] - c[2];
      float& d = distance[static_cast<size_t>(i)];
      d = i == chosen.back() ? -1 : std::min(d, dx * dx + dy * dy + dz * dz);
      if (d > distance[static_cast<size_t>(best)]) best = i;
    }
    chosen.push_back(best);
  }
  return chosen;
}

std::vector<int32_t> bucketed(const Points& p, int32_t wanted, int32_t start) {
  const auto count = static_cast<int32_t>(p.size() / 3);
  Arena measure;
  carve_furthest_scratch(measure, count + 5);
  Arena arena({}, measure.used());
  const FurthestScratch scratch = carve_furthest_scratch(arena, count + 5);
  std::vector<int32_t> chosen(static_cast<size_t>(wanted));
  sample_furthest(p.data(), count, wanted, start, scratch, chosen.data());
  return chosen;
}

// Clouds of many kinds: in a box, on a surface, on a lattice (full of equal distances), all in one place.
Points cloud(int kind, int32_t count) {
  Stream stream(static_cast<uint64_t>(kind), static_cast<uint32_t>(count), Purpose::kTest);
  Points out;
  for (int32_t i = 0; i < count; ++i) {
    float v[3];
    stream.signed_units(v, 3);
    if (kind == 1) {
      const float n = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
      for (float& c : v) c /= n;
    }
    if (kind == 2)
      for (float& c : v) c = std::round(c * 4);
    if (kind == 3) v[0] = v[1] = v[2] = 0.25f;
    if (kind == 4) v[2] = v[1] = 0;
    out.insert(out.end(), v, v + 3);
  }
  return out;
}

TEST(Furthest, ChoosesWhatThePlainFormChooses) {
  for (int kind = 0; kind < 5; ++kind)
    for (const int32_t count : {1, 2, 3, 15, 16, 17, 33, 500, 3000}) {
      const Points p = cloud(kind, count);
      for (const int32_t wanted : {1, (count + 1) / 2, count})
        EXPECT_EQ(bucketed(p, wanted, count / 3), plain(p, wanted, count / 3))
            << "kind " << kind << ", " << wanted << " of " << count;
    }
}

// Also where all distances are zero: a cloud seen on a single pixel, say.
TEST(Furthest, NoPointIsChosenTwice) {
  for (int kind = 0; kind < 5; ++kind)
    for (const int32_t count : {2, 10, 17, 500}) {
      auto chosen = bucketed(cloud(kind, count), count, count / 3);
      std::sort(chosen.begin(), chosen.end());
      for (int32_t i = 0; i < count; ++i) EXPECT_EQ(chosen[static_cast<size_t>(i)], i) << "kind " << kind;
    }
  EXPECT_EQ(bucketed(cloud(3, 10), 5, 3), (std::vector<int32_t>{3, 0, 1, 2, 4}));
}

TEST(Furthest, CoversBetterThanChance) {
  const Points p = cloud(1, 3000);
  const auto chosen = bucketed(p, 100, 0);
  // every point of the sphere has a chosen one within the radius of 100 even caps
  float worst = 0;
  for (size_t i = 0; i < p.size(); i += 3) {
    float nearest = 9;
    for (const int32_t c : chosen) {
      const float* q = &p[3 * static_cast<size_t>(c)];
      nearest = std::min(nearest, std::hypot(q[0] - p[i], q[1] - p[i + 1], q[2] - p[i + 2]));
    }
    worst = std::max(worst, nearest);
  }
  EXPECT_LT(worst, 0.35f);
}

TEST(Furthest, BadNumbersAreRefused) {
  Arena measure;
  carve_furthest_scratch(measure, 10);
  Arena arena({}, measure.used());
  const FurthestScratch s = carve_furthest_scratch(arena, 10);
  const Points p = cloud(0, 20);
  int32_t chosen[20];
  EXPECT_EQ(guard([&] { sample_furthest(p.data(), 11, 1, 0, s, chosen); }), Code::kRange);
  EXPECT_EQ(guard([&] { sample_furthest(p.data(), 0, 1, 0, s, chosen); }), Code::kRange);
  EXPECT_EQ(guard([&] { sample_furthest(p.data(), 5, 6, 0, s, chosen); }), Code::kRange);
  EXPECT_EQ(guard([&] { sample_furthest(p.data(), 5, 0, 0, s, chosen); }), Code::kRange);
  EXPECT_EQ(guard([&] { sample_furthest(p.data(), 5, 5, 5, s, chosen); }), Code::kRange);
  EXPECT_EQ(guard([&] { carve_furthest_scratch(arena, -1); }), Code::kRange);
}

}  // namespace
}  // namespace rdm
