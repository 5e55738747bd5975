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
    EXPECT_NEAR(w.cost(), 5 * u, 1e-6);
    EXPECT_TRUE(w.terminated());
    EXPECT_FALSE(w.truncated());
    EXPECT_EQ(w.success(), u == 0.2f);
  }
}

// E r = -(mu - a*)^2 - sigma^2 and E c = mu for a ~ N(mu, sigma): the closed form that the optimum is from.
TEST(Bandit, MeansAreThoseOfTheClosedForm) {
  const int32_t n = 20000;
  SmallWorld w("bandit", {}, n);
  Stream random(3, 0, Purpose::kTest);
  std::vector<float> z(static_cast<size_t>(n));
  random.normals(z.data(), n);
  for (int32_t i = 0; i < n; ++i) w.pool().action(i)[0] = (1 + 0.5f * z[static_cast<size_t>(i)]) / 5;
  w.pool()->step(nullptr);
  double reward = 0, cost = 0;
  for (int32_t i = 0; i < n; ++i) {
    reward += static_cast<double>(w.reward(i)) / n;
    cost += static_cast<double>(w.pool().cost(i)[0]) / n;
  }
  EXPECT_NEAR(reward, -1.25, 4 * 1.0607 / std::sqrt(n));
  EXPECT_NEAR(cost, 1, 4 * 0.5 / std::sqrt(n));
}

}  // namespace
}  // namespace rdm::test
