#include "algos/trust_region/cpo_problem.hpp"
#include "subproblem.hpp"

using namespace rdm;
using namespace rdm::test;

namespace {

CpoStep solution_of(const Subproblem& s, const Solved& v) {
  return solve_cpo({v.q, v.r, v.s, s.c, s.delta});
}
Row step_of(const Subproblem& s) {
  const Solved v = s.solved();
  const CpoStep y = solution_of(s, v);
  return combine(y.along_x, v.x, y.along_p, v.p);
}

// The dual as the public libraries solve it: formulas of descent gradients with ascent gradients put in, and
// a clamp whose upper bound wins.
Row peers_step(const Subproblem& s) {
  const Solved v = s.solved();
  const double q = v.q, r = v.r, d = v.s + 1e-8, c = s.c;
  const double a = q - r * r / d, b = 2 * s.delta - c * c / d;
  const auto clamp = [](double x, double low, double high) { return std::min(std::max(x, low), high); };
  if (c >= 0 && b < 0) return combine(0, v.x, -std::sqrt(2 * s.delta / d), v.p);
  double lambda = std::sqrt(q / (2 * s.delta)), nu = 0;
  if (b >= 0) {
    const double la = std::sqrt(a / b), lb = lambda, bound = r / (c + 1e-8), inf = 1e300;
    const double in_a = c < 0 ? clamp(la, 0, bound) : clamp(la, bound, inf);
    const double in_b = c < 0 ? clamp(lb, bound, inf) : clamp(lb, 0, bound);
    const double fa = -0.5 * (a / (in_a + 1e-8) + b * in_a) - r * c / d;
    const double fb = -0.5 * (q / (in_b + 1e-8) + 2 * s.delta * in_b);
    lambda = fa >= fb ? in_a : in_b;
    nu = std::max(0.0, lambda * c - r) / d;
  }
  return combine(1 / (lambda + 1e-8), v.x, -nu / (lambda + 1e-8), v.p);
}

// Is y as good as the optimum, and allowed?
bool right(const Subproblem& s, const Optimum& best, const Row& y, double tolerance = 1e-6) {
  const Solved v = s.solved();
  const double reach = std::sqrt(2 * s.delta * v.s), climb = std::sqrt(2 * s.delta * v.q);
  if (!(quadratic(s.h, y) / 2 <= s.delta * (1 + tolerance))) return false;
  if (best.which == 0) return std::abs(inner(s.b, y) - inner(s.b, best.y)) <= tolerance * reach;
  return inner(s.b, y) + s.c <= tolerance * reach &&
         std::abs(inner(s.g, y) - inner(s.g, best.y)) <= tolerance * climb;
}

const Matrix kDiag = {{2, 0}, {0, 1}};

}  // namespace

TEST(CpoProblem, Golden) {
  struct Case {
    Subproblem s;
    int which;
    double step[2], lambda, nu;
  };
  const double l1 = 8.1649658093, l2 = 8.6602540378;
  const Case cases[] = {
      {{{1, 0}, {1, 0}, identity(2), -.05, .01}, 2, {.05, 0}, 0, 0},
      {{{1, 1}, {1, 0}, kDiag, -.05, .01}, 2, {.05, .1224744871}, l1, .1835034191},
      {{{1, .5}, {-1, 1}, {{2, .5}, {.5, 1}}, -.02, .02}, 2, {.1133893419, .0755928946}, 3.7796447301, 0},
      {{{1, 1}, {1, 0}, kDiag, .05, .01}, 1, {-.05, .1224744871}, l1, 1.8164965809},
      {{{-1, 1}, {1, 0}, kDiag, .05, .01}, 1, {-.0577350269, .1154700538}, l2, 0},
      {{{1, 1}, {1, 0}, kDiag, .5, .01}, 0, {-.1, 0}, 0, 0},
      {{{1, 1}, {1, 0}, kDiag, -.5, .01}, 3, {.0577350269, .1154700538}, l2, 0},
      {{{1, 1}, {0, 0}, kDiag, -.05, .01}, 4, {.0577350269, .1154700538}, l2, 0},
      {{{1, 1}, {1, 0}, kDiag, 0, .01}, 1, {0, .1414213562}, 7.0710678119, 1},
      {{{-1, 1}, {1, 0}, kDiag, 0, .01}, 1, {-.0577350269, .1154700538}, l2, 0}};
  int id = 0;
  for (const Case& t : cases) {
    ++id;
    const Solved v = t.s.solved();
    const CpoStep y = solution_of(t.s, v);
    EXPECT_EQ(static_cast<int>(y.which), t.which) << id;
    const Row step = combine(y.along_x, v.x, y.along_p, v.p);
    for (size_t j = 0; j < 2; ++j) EXPECT_NEAR(step[j], t.step[j], 1e-10) << id;
    EXPECT_NEAR(y.lambda, t.lambda, 1e-9) << id;
    if (id > 1) {
      EXPECT_NEAR(y.nu, t.nu, 1e-9) << id;
    }
    if (id == 6) {
      EXPECT_NEAR(-y.along_p, 0.2, 1e-12);
    }
  }
}

TEST(CpoProblem, GoldenScalarsOfTheTinyNet) {
  CpoProblem p{0.1134796044, 0.0750248207, 0.2062166918, -.5, .01};
  EXPECT_NEAR(solve_cpo(p).along_x, 0.4198132014, 1e-9);
  EXPECT_EQ(solve_cpo(p).along_p, 0);
  p.c = -.01;
  EXPECT_NEAR(solve_cpo(p).along_x, 0.4758507126, 1e-9);
  EXPECT_NEAR(solve_cpo(p).lambda, 2.1014994274, 1e-8);
  EXPECT_NEAR(solve_cpo(p).nu, 0.2619081218, 1e-8);
  p.c = .05;
  EXPECT_NEAR(solve_cpo(p).along_x, 0.3023161647, 1e-9);
  EXPECT_NEAR(solve_cpo(p).lambda, 3.3077953368, 1e-8);
  EXPECT_NEAR(solve_cpo(p).nu, 1.1658347610, 1e-8);
  p.c = .5;
  EXPECT_NEAR(solve_cpo(p).along_p, -0.3114247254, 1e-9);
}

// 10,000 random problems of 2 to 20 parameters against interior points: value and case of every one. The
// formulas of the public libraries on the same problems are counted beside.
TEST(CpoProblem, TenThousandAgainstInteriorPoints) {
  Stream stream(2026, 0, Purpose::kTest);
  int seen[4] = {}, wrong[4] = {}, peers_wrong[4] = {};
  for (int i = 0; i < 10000; ++i) {
    const Subproblem s = random_subproblem(stream);
    const Optimum best = interior_point(s);
    const CpoStep y = solution_of(s, s.solved());
    const auto k = static_cast<size_t>(best.which);
    // Within the interior points' own accuracy of the border both cases are right.
    const bool same_case = static_cast<int>(y.which) == best.which || best.margin < 1e-8;
    ++seen[k];
    wrong[k] += !same_case || !right(s, best, step_of(s));
    peers_wrong[k] += !right(s, best, peers_step(s));
  }
  std::printf("case           problems  wrong  wrong in the peers' formulas\n");
  const char* names[] = {"0 recovery", "1 infeasible", "2 boundary", "3 inside"};
  for (size_t k = 0; k < 4; ++k) {
    std::printf("%-14s %8d %6d %6d (%.1f %%)\n", names[k], seen[k], wrong[k], peers_wrong[k],
                100.0 * peers_wrong[k] / seen[k]);
    EXPECT_GT(seen[k], 1000);
    EXPECT_EQ(wrong[k], 0);
  }
  // A regression test of the defect itself: it is wrong nearly wherever the dual is used.
  EXPECT_GT(peers_wrong[1], 0.9 * seen[1]);
  EXPECT_GT(peers_wrong[2], 0.6 * seen[2]);
}

TEST(CpoProblem, ThePeersFormulasAreTheOnesDescribed) {
  const Row y = peers_step({{1, 1}, {1, 0}, kDiag, -.05, .01});
  EXPECT_NEAR(y[0], -.05, 1e-6);
  EXPECT_NEAR(y[1], -.1, 1e-6);
}

// In the plane there are few enough directions to look at all.
TEST(CpoProblem, TwoParametersAgainstTheWholeEllipse) {
  Stream stream(5, 0, Purpose::kTest);
  int found = 0;
  for (int i = 0; found < 300; ++i) {
    const Subproblem s = random_subproblem(stream);
    if (s.g.size() != 2) continue;
    ++found;
    const Row y = step_of(s);
    const CpoCase which = solution_of(s, s.solved()).which;
    double best = -1e300;
    for (int k = 0; k < 20000; ++k) {
      const double angle = 2 * 3.14159265358979 * k / 20000;
      Row d = {std::cos(angle), std::sin(angle)};
      d = combine(std::sqrt(2 * s.delta / quadratic(s.h, d)), d, 0, d);
      if (which == CpoCase::kRecovery)
        best = std::max(best, -inner(s.b, d));
      else if (inner(s.b, d) + s.c <= 0)
        best = std::max(best, inner(s.g, d));
    }
    const double got = which == CpoCase::kRecovery ? -inner(s.b, y) : inner(s.g, y);
    EXPECT_GE(got, best - 1e-9);
    const double scale = std::sqrt(2 * s.delta * (which == CpoCase::kRecovery ? s.solved().s : s.solved().q));
    if (best > -1e299) {
      EXPECT_LE(got, best + 2e-3 * scale);
    }
  }
}

TEST(CpoProblem, Properties) {
  Stream stream(6, 0, Purpose::kTest);
  for (int i = 0; i < 2000; ++i) {
    const Subproblem s = random_subproblem(stream);
    const Solved v = s.solved();
    const CpoStep y = solution_of(s, v);
    const Row step = step_of(s);
    if (y.which != CpoCase::kRecovery) {
      EXPECT_LE(inner(s.b, step) + s.c, 1e-9);
    }
    EXPECT_LE(quadratic(s.h, step) / 2, s.delta * (1 + 1e-9));
    if (y.which != CpoCase::kRecovery && y.lambda > 0) {
      // The dual's value at (lambda, nu) is the primal's.
      const double dual =
          (v.q - 2 * y.nu * v.r + y.nu * y.nu * v.s) / (2 * y.lambda) + y.lambda * s.delta - y.nu * s.c;
      EXPECT_NEAR(dual, inner(s.g, step), 1e-9 * (1 + std::abs(dual)));
    }
    const CpoStep free = solve_cpo({v.q, v.r, v.s, -1e9, s.delta});
    EXPECT_NEAR(free.along_x, std::sqrt(2 * s.delta / v.q), 1e-12);
    EXPECT_EQ(free.along_p, 0);
    Subproblem scaled = s;
    for (double& x : scaled.g) x *= 7;
    for (double& x : scaled.b) x *= 0.01;
    scaled.c *= 0.01;
    const Row other = step_of(scaled);
    for (size_t j = 0; j < step.size(); ++j) EXPECT_NEAR(other[j], step[j], 1e-9);
  }
}

// A regression test: peers divide by about zero where the cost gradient vanishes and the limit is exceeded.
TEST(CpoProblem, NoCostGradient) {
  for (const double c : {-1.0, 0.0, 1.0}) {
    const CpoStep y = solve_cpo({2, 0, 0, c, .01});
    EXPECT_EQ(y.which, CpoCase::kNoCost);
    EXPECT_NEAR(y.along_x, 0.1, 1e-12);
    EXPECT_EQ(y.along_p, 0);
    EXPECT_EQ(y.nu, 0);
  }
}

// A regression test: a clamp with its bounds crossed made the multiplier of the trust region negative.
TEST(CpoProblem, MultipliersAreNeverNegative) {
  Stream stream(8, 0, Purpose::kTest);
  for (int i = 0; i < 5000; ++i) {
    const Subproblem s = random_subproblem(stream);
    const CpoStep y = solution_of(s, s.solved());
    EXPECT_GE(y.lambda, 0);
    EXPECT_GE(y.nu, 0);
    EXPECT_GE(y.along_x, 0);
  }
}

TEST(CpoProblem, NoRewardGradientStillMindsTheCost) {
  const CpoStep inside = solve_cpo({0, 0, 1, -1, .01});
  EXPECT_EQ(inside.along_x, 0);
  EXPECT_EQ(inside.along_p, 0);
  const CpoStep out = solve_cpo({0, 0, 1, .1, .01});
  EXPECT_EQ(out.which, CpoCase::kInfeasible);
  EXPECT_NEAR(out.along_p, -.1, 1e-12);
}
