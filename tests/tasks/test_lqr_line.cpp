#include <cmath>

#include "small_world.hpp"

namespace rdm::test {
namespace {

struct Value {
  double ret, cost;
};

// Exact for a ~ N(-k x, 0.1^2): the variance of x obeys v' = (1 - k)^2 v + 0.1^2 + 0.1^2.
Value exact(double k) {
  double v = 1;
  Value out{0, 0};
  for (int step = 0; step < 20; ++step) {
    const double effort = k * k * v + 0.01;
    out.ret -= v + 0.1 * effort;
    out.cost += effort;
    v = (1 - k) * (1 - k) * v + 0.02;
  }
  return out;
}

TEST(LqrLine, TheStatedOptimaAreTheOptima) {
  EXPECT_NEAR(exact(0.915).ret, -1.52626, 1e-5);
  EXPECT_NEAR(exact(0.915).cost, 1.36366, 1e-5);
  for (double k = 0; k < 2; k += 0.01) EXPECT_LE(exact(k).ret, exact(0.915).ret + 1e-6) << k;
  EXPECT_NEAR(exact(0.734456).ret, -1.583058, 1e-6);
  EXPECT_NEAR(exact(0.734456).cost, 1, 1e-5);
  EXPECT_NEAR(exact(0.571281).ret, -1.760243, 1e-6);
  EXPECT_NEAR(exact(0.571281).cost, 0.75, 1e-5);
}

TEST(LqrLine, TheWorldFollowsTheFormula) {
  const int32_t n = 40000;
  SmallWorld w("lqr_line", {}, n, 5);
  Stream random(1, 0, Purpose::kTest);
  std::vector<float> z(static_cast<size_t>(n));
  for (int step = 0; step < 20; ++step) {
    random.normals(z.data(), n);
    for (int32_t i = 0; i < n; ++i)
      w.pool().action(i)[0] = (-0.734456f * w.pool().obs(i)[0] + 0.1f * z[static_cast<size_t>(i)]) / 5;
    w.pool()->step(nullptr);
  }
  double ret = 0, cost = 0;
  for (int32_t i = 0; i < n; ++i) {
    ASSERT_TRUE(w.pool().rows().truncated[i]);
    ret += static_cast<double>(w.pool().rows().episode_return[i]) / n;
    cost += static_cast<double>(w.pool().rows().episode_cost[i]) / n;
  }
  EXPECT_NEAR(ret, -1.583058, 0.03);  // four standard errors
  EXPECT_NEAR(cost, 1, 0.02);
}

}  // namespace
}  // namespace rdm::test
