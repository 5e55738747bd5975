#include <gtest/gtest.h>

#include <cstring>

#include "heap_count.hpp"
#include "nn/adam.hpp"
#include "nn_data.hpp"

using namespace rdm;

namespace {

struct OwnedAdam {
  explicit OwnedAdam(size_t size) {
    Arena measure;
    carve_adam(measure, size);
    arena = Arena(HostHooks{}, measure.used());
    adam = carve_adam(arena, size);
  }
  Arena arena;
  Adam adam;
};

// The textbook rule in double.
struct Reference {
  std::vector<double> m, v;
  int t = 0;
  double step(std::vector<double>& p, const std::vector<float>& grad, double rate, double max_norm) {
    m.resize(p.size());
    v.resize(p.size());
    double norm = 0;
    for (const float g : grad) norm += static_cast<double>(g) * static_cast<double>(g);
    norm = std::sqrt(norm);
    const double scale = max_norm > 0 ? std::min(1.0, max_norm / (norm + 1e-6)) : 1;
    ++t;
    for (size_t i = 0; i < p.size(); ++i) {
      const double g = static_cast<double>(grad[i]) * scale;
      m[i] = 0.9 * m[i] + 0.1 * g;
      v[i] = 0.999 * v[i] + 0.001 * g * g;
      p[i] -= rate * (m[i] / (1 - std::pow(0.9, t))) / (std::sqrt(v[i] / (1 - std::pow(0.999, t))) + 1e-8);
    }
    return norm;
  }
};

}  // namespace

TEST(Adam, FollowsTheScalarRule) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    for (const double max_norm : {0.0, 1.0, 1e3})
      for (const size_t n : {1u, 5u, 16u, 33u, 1000u}) {
        OwnedAdam owned(n);
        auto params = random_floats(n, 1);
        std::vector<double> want(params.begin(), params.end());
        Reference reference;
        for (uint64_t t = 0; t < 200; ++t) {
          const auto grad = random_floats(n, 10 + t, 0.3f);
          const double norm = adam_step(owned.adam, params.data(), grad.data(), 1e-2, max_norm);
          const double want_norm = reference.step(want, grad, 1e-2, max_norm);
          EXPECT_NEAR(norm, want_norm, 1e-12 * want_norm);
        }
        EXPECT_EQ(owned.adam.t, 200);
        for (size_t i = 0; i < n; ++i) EXPECT_NEAR(params[i], want[i], 2e-5) << i << " of " << n;
      }
  });
}

TEST(Adam, RangesInAnyOrderMakeTheSameBytes) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    const size_t n = 1000;
    OwnedAdam whole(n), cut(n);
    auto params = random_floats(n, 1), parts = params;
    for (uint64_t t = 0; t < 20; ++t) {
      const auto grad = random_floats(n, 10 + t, 0.3f);
      const double norm = adam_step(whole.adam, params.data(), grad.data(), 1e-2, 1);
      const AdamStep step = adam_begin(cut.adam, parts.data(), grad.data(), 1e-2, 1);
      EXPECT_EQ(step.norm, norm);
      adam_range(step, 333, 2 * n);  // what lies beyond the end is not there
      adam_range(step, 17, 333);
      adam_range(step, 0, 17);
      adam_range(step, n, 2 * n);
    }
    EXPECT_EQ(parts, params);
    EXPECT_EQ(cut.adam.t, whole.adam.t);
  });
}

TEST(Adam, TheFirstStepIsTheRateWhateverTheGradient) {
  OwnedAdam owned(3);
  float params[] = {0, 0, 0};
  const float grad[] = {1e-3f, -5, 700};
  adam_step(owned.adam, params, grad, 0.25, 0);
  EXPECT_NEAR(params[0], -0.25, 1e-5);
  EXPECT_NEAR(params[1], 0.25, 1e-6);
  EXPECT_NEAR(params[2], -0.25, 1e-6);
}

TEST(Adam, ClippingScalesTheMomentsByTheNorm) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    OwnedAdam clipped(2), small(2);
    float p[] = {0, 0}, q[] = {0, 0};
    const float grad[] = {30, 40}, within[] = {0.3f, 0.4f};
    EXPECT_NEAR(adam_step(clipped.adam, p, grad, 1, 1), 50, 1e-12);
    EXPECT_NEAR(clipped.adam.m[0], 0.1 * 0.6, 1e-7);
    EXPECT_NEAR(clipped.adam.m[1], 0.1 * 0.8, 1e-7);
    EXPECT_NEAR(clipped.adam.v[1], 0.001 * 0.64, 1e-9);
    EXPECT_NEAR(adam_step(small.adam, q, within, 1, 1), 0.5, 1e-7);
    EXPECT_NEAR(small.adam.m[0], 0.1 * 0.3, 1e-8);
  });
}

TEST(Adam, AGradientThatIsNotFiniteChangesNothing) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    for (const float poison : {INFINITY, -INFINITY, NAN})
      for (const size_t at : {0u, 17u, 19u}) {
        OwnedAdam owned(20);
        auto params = random_floats(20, 1), grad = random_floats(20, 2);
        adam_step(owned.adam, params.data(), grad.data(), 0.1, 1);
        const auto before = params;
        const std::vector<float> m(owned.adam.m, owned.adam.m + 20), v(owned.adam.v, owned.adam.v + 20);
        grad[at] = poison;
        EXPECT_FALSE(std::isfinite(adam_step(owned.adam, params.data(), grad.data(), 0.1, 1)));
        EXPECT_EQ(owned.adam.t, 1);
        EXPECT_EQ(params, before);
        EXPECT_EQ(std::memcmp(owned.adam.m, m.data(), 80), 0);
        EXPECT_EQ(std::memcmp(owned.adam.v, v.data(), 80), 0);
      }
  });
}

// The norm is summed in double: the squares of these leave the range of a float.
TEST(Adam, LargeGradientsAreClippedNotLost) {
  OwnedAdam owned(4);
  float params[] = {0, 0, 0, 0};
  const float grad[] = {3e30f, 0, 0, 4e30f};
  const double norm = adam_step(owned.adam, params, grad, 0.5, 1);
  EXPECT_NEAR(norm / 5e30, 1, 1e-6);
  EXPECT_NEAR(owned.adam.m[0], 0.06, 1e-7);
  EXPECT_NEAR(params[3], -0.5, 1e-5);
}

TEST(Adam, NothingIsAllocated) {
  if (!kHeapIsCounted) GTEST_SKIP() << "a sanitizer owns the heap";
  OwnedAdam owned(1000);
  auto params = random_floats(1000, 1);
  const auto grad = random_floats(1000, 2);
  const int64_t before = heap_count();
  adam_step(owned.adam, params.data(), grad.data(), 1e-3, 1);
  EXPECT_EQ(heap_count(), before);
}
