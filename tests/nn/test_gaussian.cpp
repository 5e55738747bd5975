#include <gtest/gtest.h>

#include "heap_count.hpp"
#include "nn/gaussian.hpp"
#include "nn_data.hpp"

using namespace rdm;

namespace {

constexpr double kTwoPi = 6.283185307179586;
using Row = std::vector<double>;

Row in_double(const std::vector<float>& v) {
  return {v.begin(), v.end()};
}

double log_prob(const Row& mean, const Row& log_std, const Row& action) {
  double sum = 0;
  for (size_t j = 0; j < mean.size(); ++j) {
    const double u = (action[j] - mean[j]) / std::exp(log_std[j]);
    sum += -0.5 * u * u - log_std[j] - 0.5 * std::log(kTwoPi);
  }
  return sum;
}

double divergence(const Row& mean0, const Row& l0, const Row& mean1, const Row& l1) {
  double sum = 0;
  for (size_t j = 0; j < l0.size(); ++j) {
    const double d = l1[j] - l0[j], u = (mean0[j] - mean1[j]) / std::exp(l1[j]);
    sum += d + 0.5 * std::expm1(-2 * d) + 0.5 * u * u;
  }
  return sum;
}

int32_t dim_of(const std::vector<float>& v) {
  return static_cast<int32_t>(v.size());
}

}  // namespace

TEST(Gaussian, GoldenLogProbs) {
  const float log_std[] = {-.2f, .1f}, mean[] = {0.5544050634f, 0.0508434906f, -0.1305623958f, 0.1668723753f},
              action[] = {.5f, -.2f, -.3f, .6f};
  for_each_isa([&](const char* isa) {
    SCOPED_TRACE(isa);
    EXPECT_NEAR(gaussian_log_prob(mean, log_std, action, 2), -1.7658431757, 4e-7);
    EXPECT_NEAR(gaussian_log_prob(mean + 2, log_std, action + 2, 2), -1.8360882960, 4e-7);
  });
}

TEST(Gaussian, LogProbAndItsGradientAgreeWithDouble) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    for (const size_t n : {1u, 3u, 4u, 8u, 17u, 40u}) {
      const auto mean = random_floats(n, 1), log_std = random_floats(n, 2, 0.5f),
                 action = random_floats(n, 3);
      const Row m = in_double(mean), l = in_double(log_std), a = in_double(action);
      const double want = log_prob(m, l, a);
      EXPECT_NEAR(gaussian_log_prob(mean.data(), log_std.data(), action.data(), dim_of(mean)), want,
                  1e-6 * (1 + std::abs(want)) * std::sqrt(static_cast<double>(n)));
      std::vector<float> dmean(n + 1, 9), dlog_std(n + 1, 2);
      gaussian_log_prob_grad(mean.data(), log_std.data(), action.data(), dim_of(mean), -1.5f, dmean.data(),
                             dlog_std.data());
      EXPECT_EQ(dmean[n], 9);
      EXPECT_EQ(dlog_std[n], 2);
      const double h = 1e-5;
      for (size_t j = 0; j < n; ++j) {
        Row up = m, down = m;
        up[j] += h, down[j] -= h;
        const double slope = (log_prob(up, l, a) - log_prob(down, l, a)) / (2 * h);
        EXPECT_NEAR(dmean[j], -1.5 * slope, 2e-6 * (1 + std::abs(slope)));
        up = l, down = l;
        up[j] += h, down[j] -= h;
        const double slope_std = (log_prob(m, up, a) - log_prob(m, down, a)) / (2 * h);
        EXPECT_NEAR(dlog_std[j], 2 - 1.5 * slope_std, 2e-6 * (2 + std::abs(slope_std)));
      }
    }
  });
}

TEST(Gaussian, DivergenceKeepsItsDigitsWhenSmall) {
  for_each_isa([](const char* isa) {
    SCOPED_TRACE(isa);
    for (const float gap : {1e-5f, 1e-3f, 0.1f, 0.4f, 0.6f, 2.0f})
      for (const size_t n : {1u, 5u, 40u}) {
        const auto mean0 = random_floats(n, 1), l0 = random_floats(n, 2, 0.5f),
                   step = random_floats(n, 3, gap), step_std = random_floats(n, 4, gap);
        auto mean1 = mean0, l1 = l0;
        for (size_t j = 0; j < n; ++j) mean1[j] += step[j], l1[j] += step_std[j];
        const double want = divergence(in_double(mean0), in_double(l0), in_double(mean1), in_double(l1));
        EXPECT_NEAR(gaussian_kl(mean0.data(), l0.data(), mean1.data(), l1.data(), dim_of(l0)), want,
                    1e-6 * want)
            << "gap " << gap << " dims " << n;
        EXPECT_EQ(gaussian_kl(mean0.data(), l0.data(), mean0.data(), l0.data(), dim_of(l0)), 0);
      }
  });
}

TEST(Gaussian, NothingIsAllocated) {
  if (!kHeapIsCounted) GTEST_SKIP() << "a sanitizer owns the heap";
  std::vector<float> v(40, 0.1f), a(40, 0.2f), d(40), e(40);
  const int64_t before = heap_count();
  float sum = gaussian_log_prob(v.data(), v.data(), a.data(), 40) +
              gaussian_kl(v.data(), v.data(), a.data(), a.data(), 40);
  gaussian_log_prob_grad(v.data(), v.data(), a.data(), 40, 1, d.data(), e.data());
  EXPECT_EQ(heap_count(), before);
  EXPECT_TRUE(std::isfinite(sum));
}
