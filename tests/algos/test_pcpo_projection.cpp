#include "algos/trust_region/pcpo_projection.hpp"
#include "subproblem.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {
const std::vector<double> kG = {1, 1}, kB = {1, .2};
const Matrix kH = {{2, .5}, {.5, 1}};
constexpr double kDelta = .01;

std::vector<double> step_of(const Subproblem& s, bool kl, double* multiplier) {
  const Solved v = s.solved();
  const PcpoStep y = project_pcpo({v.q, v.r, s.c, s.delta, kl ? v.s : inner(s.b, s.b)});
  *multiplier = y.multiplier;
  return combine(y.along_x, v.x, -y.multiplier, kl ? v.p : s.b);
}
}  // namespace

TEST(PcpoProjection, Golden) {
  struct Case {
    double c, kl_multiplier, kl[2], l2_multiplier, l2[2];
  };
  const Case cases[] = {
      {-.2, 0, {0.0377964473, 0.1133893419}, 0, {0.0377964473, 0.1133893419}},
      {0, 0.1202614232, {-0.0240522846, 0.1202614232}, 0.0581483805, {-0.0203519332, 0.1017596658}},
      {.05, 0.2196932414, {-0.0751886483, 0.1259432414}, 0.1062253035, {-0.0684288562, 0.0921442812}}};
  for (const Case& t : cases)
    for (const bool kl : {true, false}) {
      double multiplier;
      const auto y = step_of({kG, kB, kH, t.c, kDelta}, kl, &multiplier);
      EXPECT_NEAR(multiplier, kl ? t.kl_multiplier : t.l2_multiplier, 1e-10) << t.c;
      for (size_t j = 0; j < 2; ++j) EXPECT_NEAR(y[j], (kl ? t.kl : t.l2)[j], 1e-10) << t.c;
    }
}

// A regression test: peers step along g scaled by sqrt(2 delta / q) where H^-1 g belongs.
TEST(PcpoProjection, TheRewardStepIsNaturalNotPlain) {
  double multiplier;
  const auto y = step_of({kG, kB, kH, -.2, kDelta}, true, &multiplier);
  EXPECT_GT(std::abs(y[0] * kG[1] - y[1] * kG[0]), 0.05);
  EXPECT_NEAR(quadratic(kH, y) / 2, kDelta, 1e-12);
}

// 10,000 random problems against a search for the nearest point of the half-space that knows no formula.
TEST(PcpoProjection, IsTheNearestPointOfTheHalfSpace) {
  Stream stream(77, 0, Purpose::kTest);
  int projected = 0;
  for (int i = 0; i < 10000; ++i) {
    const Subproblem s = random_subproblem(stream);
    const Solved v = s.solved();
    const auto half = combine(std::sqrt(2 * s.delta / v.q), v.x, 0, v.p);
    for (const bool kl : {true, false}) {
      double multiplier;
      const auto y = step_of(s, kl, &multiplier);
      const Matrix metric = kl ? s.h : identity(s.g.size());
      const auto wanted = nearest_point(metric, half, s.b, s.c);
      const double scale = std::sqrt(quadratic(metric, half)) + std::abs(s.c) / std::sqrt(inner(s.b, s.b));
      for (size_t j = 0; j < y.size(); ++j) ASSERT_NEAR(y[j], wanted[j], 1e-6 * scale) << i;
      const double outside = inner(s.b, half) + s.c;
      ASSERT_EQ(multiplier > 0, outside > 0) << i;
      if (multiplier > 0) {
        ASSERT_NEAR(inner(s.b, y) + s.c, 0, 1e-9 * (std::abs(s.c) + 1e-3)) << i;
      }
      projected += multiplier > 0;
    }
  }
  EXPECT_GT(projected, 5000);
}

TEST(PcpoProjection, NoGradientsNoStep) {
  const PcpoStep y = project_pcpo({0, 0, 1, kDelta, 0});
  EXPECT_EQ(y.along_x, 0);
  EXPECT_EQ(y.multiplier, 0);
}
