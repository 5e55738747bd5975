// Bullet-Safety-Gym's Gather, with each of its agents.
#include <cmath>

#include "small_world.hpp"

namespace rdm::test {
namespace {

constexpr int kThings = 8;

bool there(SmallWorld& w, int body) {
  return w.body(body).z > 0;
}
double far(SmallWorld& w, int body) {
  const Vec3 d = w.body(body) - w.body(0);
  return std::hypot(d.x, d.y);
}
// Pushes towards a place, slowing down near it.
void push_to(SmallWorld& w, const Vec3& p) {
  const Vec3 at = w.body(0), v = w.pool()->world(0).body(0).v;
  const auto pull = [](double d, double rate) {
    return static_cast<float>(std::clamp(1.5 * d - 1.0 * rate, -1.0, 1.0));
  };
  w.step({pull(p.x - at.x, v.x), pull(p.y - at.y, v.y)});
}

TEST(Gather, LayoutsKeepTheirDistances) {
  for (const char* task : {"ball_gather", "car_gather", "drone_gather"})
    for (uint64_t seed = 0; seed < 30; ++seed) {
      SmallWorld w(task, {}, 1, seed);
      for (int i = 1; i <= 2 * kThings; ++i) {
        const Vec3 p = w.body(i);
        EXPECT_LE(std::max(std::fabs(p.x), std::fabs(p.y)), 7);
        EXPECT_GE(std::hypot(p.x, p.y), 1);
        for (int j = 1; j < i; ++j) EXPECT_GE(norm(p - w.body(j)), 2);
      }
      EXPECT_EQ(norm({w.body(0).x, w.body(0).y, 0}), 0);
    }
}

TEST(Gather, RowsAreAsLongAsPublished) {
  EXPECT_EQ(SmallWorld("ball_gather").pool()->obs_dim(), 39);
  EXPECT_EQ(SmallWorld("car_gather").pool()->obs_dim(), 39);
  EXPECT_EQ(SmallWorld("drone_gather").pool()->obs_dim(), 49);
}

// Every apple, one after the other: 10 each, bombs cost 1 and are gone, the last apple ends the episode.
TEST(Gather, ApplesPayBombsCostAndTheLastAppleEndsIt) {
  int struck = 0;
  for (uint64_t seed = 0; seed < 8; ++seed) {
    SmallWorld w("ball_gather", {{"max_steps", nullptr, 20000}}, 1, seed);
    int eaten = 0;
    for (int step = 0; step < 19999 && !w.terminated(); ++step) {
      int next = 0;
      for (int i = 1; i <= kThings; ++i)
        if (there(w, i) && (next == 0 || far(w, i) < far(w, next))) next = i;
      bool was[2 * kThings + 1];
      Vec3 at[2 * kThings + 1];
      for (int i = 1; i <= 2 * kThings; ++i) was[i] = there(w, i), at[i] = w.body(i);
      push_to(w, w.body(next));
      const Vec3 now = {10 * static_cast<double>(w.pool().final_obs(0)[0]),
                        10 * static_cast<double>(w.pool().final_obs(0)[1]), 0};
      int apples = 0, bombs = 0;
      for (int i = 1; i <= 2 * kThings; ++i) {
        const bool hit = was[i] && std::hypot(at[i].x - now.x, at[i].y - now.y) < 1;
        (i <= kThings ? apples : bombs) += hit;
        if (!w.terminated()) {
          ASSERT_EQ(there(w, i), was[i] && !hit);
        }
      }
      ASSERT_EQ(w.reward(), static_cast<float>(10 * apples));
      ASSERT_EQ(w.cost(), bombs > 0);
      ASSERT_EQ(w.success(), apples > 0);
      eaten += apples, struck += bombs;
    }
    EXPECT_TRUE(w.terminated());
    EXPECT_EQ(eaten, kThings);
  }
  EXPECT_GT(struck, 0);
}

// What is sensed is 1 - distance / 10 of what is still there.
TEST(Gather, TheNearestOfASectorIsSensed) {
  SmallWorld w("car_gather");
  for (int i = 0; i < 100; ++i) {
    w.step({0.1f, 0.4f});
    for (int kind = 0; kind < 2; ++kind) {
      float most = 0, nearest = 0;
      for (int k = 0; k < 16; ++k) most = std::max(most, w.obs(7 + 16 * kind + k));
      for (int k = 1; k <= kThings; ++k)
        if (there(w, kThings * kind + k))
          nearest = std::max(nearest, static_cast<float>(1 - far(w, kThings * kind + k) / 10));
      ASSERT_NEAR(most, nearest, 1e-6);
    }
  }
}

TEST(Gather, TheRoomHoldsCarAndBall) {
  for (const char* task : {"ball_gather", "car_gather"}) {
    SmallWorld w(task, {{"bombs", nullptr, 0}});
    double farthest = 0;
    for (int i = 0; i < 240 && !w.terminated(); ++i) {
      w.step({1, 0.05f});
      farthest = std::max({farthest, std::fabs(w.body(0).x), std::fabs(w.body(0).y)});
    }
    EXPECT_GT(farthest, 9) << task;
    EXPECT_LE(farthest, 9.66) << task;
  }
}

TEST(Gather, AFallenDroneGetsMinusTenAndAHighOneACost) {
  SmallWorld w("drone_gather", {{"max_steps", nullptr, 5000}});
  for (int i = 0; i < 200; ++i) w.step({1, 1, 1, 1});
  EXPECT_GT(w.body(0).z, 2);
  EXPECT_EQ(w.cost(), 1);
  EXPECT_EQ(w.cost(2), 1);
  for (int i = 0; i < 400 && !w.terminated(); ++i) w.step({0, 1, 0, -1});
  EXPECT_TRUE(w.terminated());
  EXPECT_EQ(w.reward(), -10);
}

}  // namespace
}  // namespace rdm::test
