#include <algorithm>
#include <cmath>

#include "small_world.hpp"

namespace rdm::test {
namespace {

TEST(Bandit, RewardCostAndEnd) {
  SmallWorld w("bandit");
  EXPECT_EQ(w.obs(0), 1);
  for (const float u : {0.2f, 0.4f, -0.5f, 0.0f}) {
    w.step({u});
    EXPECT_NEAR(w.reward(), -(5 * u - 2) * (5 * u - 2), 1e-5);
    EXPECT_NEAR(w.cost(), std::max(5 * u, 0.0f), 1e-6);
    EXPECT_TRUE(w.terminated());
    EXPECT_FALSE(w.truncated());
    EXPECT_EQ(w.success(), u == 0.2f);
  }
}

// For a ~ N(m, 0.5^2): E r = -(m - 2)^2 - 0.25, E c = m Phi(2 m) + 0.5 phi(2 m), the closed form that the
// optimum under the limit 1 is from.
TEST(Bandit, MeansAreThoseOfTheClosedForm) {
  const int32_t n = 20000;
  SmallWorld w("bandit", {}, n);
  Stream random(3, 0, Purpose::kTest);
  std::vector<float> z(static_cast<size_t>(n));
  random.normals(z.data(), n);
  for (int32_t i = 0; i < n; ++i) w.pool().action(i)[0] = (0.99565f + 0.5f * z[static_cast<size_t>(i)]) / 5;
  w.pool()->step(nullptr);
  double reward = 0, cost = 0;
  for (int32_t i = 0; i < n; ++i) {
    reward += static_cast<double>(w.reward(i)) / n;
    cost += static_cast<double>(w.pool().cost(i)[0]) / n;
  }
  EXPECT_NEAR(reward, -1.25871, 4 * 1.0607 / std::sqrt(n));
  EXPECT_NEAR(cost, 1, 4 * 0.5 / std::sqrt(n));
}

}  // namespace
}  // namespace rdm::test
