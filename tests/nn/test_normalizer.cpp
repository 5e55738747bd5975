#include <gtest/gtest.h>

#include <cstring>

#include "heap_count.hpp"
#include "nn/normalizer.hpp"
#include "nn_data.hpp"

using namespace rdm;

namespace {

struct OwnedNormalizer {
  explicit OwnedNormalizer(int32_t dim) {
    Arena measure;
    carve_normalizer(measure, dim);
    arena = Arena(HostHooks{}, measure.used());
    n = carve_normalizer(arena, dim);
  }
  Arena arena;
  Normalizer n;
};

// Rows far from zero and of very different scales: what a one-pass float sum would lose.
std::vector<float> make_rows(size_t rows, size_t dim, uint64_t seed) {
  auto x = random_floats(rows * dim, seed);
  for (size_t i = 0; i < x.size(); ++i)
    x[i] = x[i] * std::pow(10.0f, static_cast<float>(i % dim % 4)) + 1000 * static_cast<float>(i % dim % 7);
  return x;
}

struct Moments {
  double mean = 0, m2 = 0;
};
Moments moments_of(const std::vector<float>& x, size_t rows, size_t dim, size_t j, const uint8_t* mask) {
  Moments out;
  double count = 0;
  for (size_t r = 0; r < rows; ++r)
    if (!mask || mask[r]) out.mean += static_cast<double>(x[r * dim + j]), ++count;
  out.mean /= count;
  for (size_t r = 0; r < rows; ++r)
    if (!mask || mask[r]) {
      const double d = static_cast<double>(x[r * dim + j]) - out.mean;
      out.m2 += d * d;
    }
  return out;
}

}  // namespace

TEST(Normalizer, MergesGiveTheMomentsOfAllRows) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    for (const size_t dim : {1u, 3u, 7u, 8u, 30u, 398u, 1001u}) {
      const size_t rows = 640;
      const auto x = make_rows(rows, dim, 1);
      OwnedNormalizer one(static_cast<int32_t>(dim)), many(static_cast<int32_t>(dim));
      normalizer_merge(one.n, x.data(), 640, nullptr, 0);
      size_t at = 0;
      for (const int32_t batch : {1, 1, 2, 60, 64, 512}) {
        normalizer_merge(many.n, x.data() + at * dim, batch, nullptr, 0);
        at += static_cast<size_t>(batch);
      }
      ASSERT_EQ(at, rows);
      EXPECT_EQ(one.n.count, 640);
      EXPECT_EQ(many.n.count, 640);
      for (size_t j = 0; j < dim; ++j) {
        const Moments want = moments_of(x, rows, dim, j, nullptr);
        const double spread = std::sqrt(want.m2 / 639);
        for (const Normalizer* n : {&one.n, &many.n}) {
          EXPECT_NEAR(n->mean[j], want.mean, 1e-12 * (std::abs(want.mean) + spread));
          EXPECT_NEAR(n->m2[j], want.m2, 1e-11 * want.m2);
          EXPECT_EQ(n->shift[j], static_cast<float>(n->mean[j]));
          EXPECT_NEAR(n->scale[j] * spread, 1, 1e-6);
        }
      }
    }
  });
}

TEST(Normalizer, MaskedRowsDoNotCount) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    const size_t rows = 50, dim = 21;
    auto x = make_rows(rows, dim, 2);
    std::vector<uint8_t> mask(rows);
    double count = 0;
    for (size_t r = 0; r < rows; ++r) count += mask[r] = r % 3 == 1;
    for (size_t r = 0; r < rows; ++r)
      if (!mask[r]) x[r * dim] = NAN;
    OwnedNormalizer owned(21);
    normalizer_merge(owned.n, x.data(), 50, mask.data(), 0);
    EXPECT_EQ(owned.n.count, count);
    for (size_t j = 0; j < dim; ++j) {
      const Moments want = moments_of(x, rows, dim, j, mask.data());
      EXPECT_NEAR(owned.n.mean[j], want.mean, 1e-12 * (1 + std::abs(want.mean)));
      EXPECT_NEAR(owned.n.m2[j], want.m2, 1e-12 * want.m2);
    }
    const std::vector<uint8_t> none(rows, 0);
    normalizer_merge(owned.n, x.data(), 50, none.data(), 0);
    EXPECT_EQ(owned.n.count, count);
  });
}

// Moments of the largest floats, and any that a state may hold, give numbers that a policy file takes.
TEST(Normalizer, ExtremeMomentsGiveUsableScales) {
  const float most = std::numeric_limits<float>::max();
  const auto check = [](const Normalizer& n) {
    for (int j = 0; j < n.dim; ++j) {
      EXPECT_TRUE(std::isfinite(n.shift[j])) << n.mean[j];
      EXPECT_GE(n.scale[j], std::numeric_limits<float>::min()) << n.m2[j];
      EXPECT_LE(n.scale[j], 100.0f) << n.m2[j];
    }
  };
  for_each_isa([&](const char* isa) {
    SCOPED_TRACE(isa);
    OwnedNormalizer owned(3);
    const float x[] = {most, -most, 1, -most, most, -1, most, most, 0, -most, -most, 0};
    normalizer_merge(owned.n, x, 4, nullptr, 0);
    check(owned.n);
    float y[12];
    normalizer_apply(owned.n, x, 4, y);
    for (const float v : y) EXPECT_LE(std::abs(v), 5.0f);
    for (const double count : {1.5, 2.0, 1e9, 1e18})
      for (const double mean : {-static_cast<double>(most), 0.0, static_cast<double>(most)})
        for (const double m2 : {0.0, 1e-300, 1e76, 1e100}) {
          owned.n.count = count;
          for (int j = 0; j < 3; ++j) owned.n.mean[j] = mean, owned.n.m2[j] = m2;
          normalizer_refresh(owned.n);
          check(owned.n);
        }
  });
}

TEST(Normalizer, UnchangedUntilTwoSamplesAndClippedAlways) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    OwnedNormalizer owned(3);
    const float x[] = {2, -7, 4, 4, 1, 4};
    float y[6];
    normalizer_apply(owned.n, x, 1, y);
    EXPECT_EQ(y[0], 2);
    EXPECT_EQ(y[1], -5);
    normalizer_merge(owned.n, x, 1, nullptr, 0);
    normalizer_apply(owned.n, x, 1, y);
    EXPECT_EQ(y[0], 2);
    EXPECT_EQ(y[1], -5);
    normalizer_merge(owned.n, x + 3, 1, nullptr, 0);  // mean 3, -3, 4; std sqrt 2, sqrt 32, 0.01 (floor)
    const float z[] = {3 + std::sqrt(2.0f), -3 - std::sqrt(32.0f), 4.02f, 1e9f, -1e9f, NAN};
    normalizer_apply(owned.n, z, 2, y);
    EXPECT_NEAR(y[0], 1, 1e-6);
    EXPECT_NEAR(y[1], -1, 1e-6);
    EXPECT_NEAR(y[2], 2, 1e-4);
    EXPECT_EQ(y[3], 5);
    EXPECT_EQ(y[4], -5);
    EXPECT_TRUE(std::isnan(y[5]));
    normalizer_reset(owned.n);
    normalizer_apply(owned.n, x, 1, y);
    EXPECT_EQ(y[0], 2);
  });
}

TEST(Normalizer, AppliesInPlace) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    const size_t rows = 9, dim = 37;
    auto x = random_floats(rows * dim, 1);
    OwnedNormalizer owned(37);
    normalizer_merge(owned.n, x.data(), 9, nullptr, 0);
    std::vector<float> y(x.size());
    normalizer_apply(owned.n, x.data(), 9, y.data());
    for (size_t i = 0; i < x.size(); ++i)
      EXPECT_NEAR(y[i], (x[i] - owned.n.shift[i % dim]) * owned.n.scale[i % dim], 1e-6f);
    normalizer_apply(owned.n, x.data(), 9, x.data());
    EXPECT_EQ(x, y);
  });
}

// With a cap old samples fade: after a jump of the data the mean follows within some caps of samples, and
// the variance of unchanged data stays.
TEST(Normalizer, CountSaturatesAndOldDataFade) {
  OwnedNormalizer owned(1);
  for (uint64_t i = 0; i < 200; ++i) {
    const auto x = random_floats(50, i, 3);
    normalizer_merge(owned.n, x.data(), 50, nullptr, 1000);
    EXPECT_LE(owned.n.count, 1000);
  }
  EXPECT_EQ(owned.n.count, 1000);
  EXPECT_NEAR(std::sqrt(owned.n.m2[0] / 999), 3, 0.3);
  for (uint64_t i = 0; i < 200; ++i) {
    auto x = random_floats(50, i, 3);
    for (float& v : x) v += 100;
    normalizer_merge(owned.n, x.data(), 50, nullptr, 1000);
  }
  EXPECT_NEAR(owned.n.mean[0], 100, 0.5);
  EXPECT_NEAR(1 / owned.n.scale[0], 3, 0.4);
}

TEST(Normalizer, RefreshRestoresWhatASaveHolds) {
  OwnedNormalizer a(40), b(40);
  const auto x = make_rows(64, 40, 3);
  normalizer_merge(a.n, x.data(), 64, nullptr, 0);
  std::memcpy(b.n.mean, a.n.mean, 40 * sizeof(double));
  std::memcpy(b.n.m2, a.n.m2, 40 * sizeof(double));
  b.n.count = a.n.count;
  normalizer_refresh(b.n);
  EXPECT_EQ(std::memcmp(a.n.shift, b.n.shift, 160), 0);
  EXPECT_EQ(std::memcmp(a.n.scale, b.n.scale, 160), 0);
}

TEST(Normalizer, NothingIsAllocated) {
  if (!kHeapIsCounted) GTEST_SKIP() << "a sanitizer owns the heap";
  OwnedNormalizer owned(398);
  auto x = random_floats(64 * 398, 1);
  const int64_t before = heap_count();
  normalizer_merge(owned.n, x.data(), 64, nullptr, 1e6);
  normalizer_apply(owned.n, x.data(), 64, x.data());
  EXPECT_EQ(heap_count(), before);
}
