// Hopper and Walker2d: their bodies against the published figures, reward and ends written out.
#include <cmath>
#include <vector>

#include "small_world.hpp"
#include "tasks/legged/flat_walker.hpp"

namespace rdm::test {
namespace {

double mass_of(const ArticulationDef& robot) {
  double sum = 0;
  for (const LinkDef& link : robot.links) sum += link.inertia.mass;
  return sum;
}

TEST(FlatWalker, MassesAreThePublishedOnes) {
  SmallWorld hopper("hopper_velocity"), walker("walker2d_velocity");
  const ArticulationDef& h = hopper.pool()->task().scene().def.articulations[0];
  const double masses[] = {3.66519, 4.05789, 2.78136, 5.31557};
  for (size_t i = 0; i < 4; ++i) EXPECT_NEAR(h.links[2 + i].inertia.mass, masses[i], 1e-5) << i;
  const ArticulationDef& w = walker.pool()->task().scene().def.articulations[0];
  EXPECT_NEAR(mass_of(w), 23.677, 1e-3);
  EXPECT_NEAR(w.links[5].inertia.mass, 3.16673, 1e-5);
  EXPECT_EQ(hopper.pool()->obs_dim(), 11);
  EXPECT_EQ(walker.pool()->obs_dim(), 17);
}

// MuJoCo from the pose without noise: 1.218608 after 10 steps, in the air still, where its RK4 falls g t^2 /
// 2 and semi-implicit steps of h fall g t (t + h) / 2; 1.206457 after 50, standing on a floor that gives way;
// no fall by 100.
TEST(FlatWalker, TheHopperStandsWithoutAnAction) {
  SmallWorld w("hopper_velocity", {{"reset_noise", nullptr, 0}});
  for (int i = 0; i < 10; ++i) w.step({0, 0, 0});
  const double t = 0.08, h = 0.001;
  EXPECT_NEAR(static_cast<double>(w.obs(0)), 1.25 - 0.5 * 9.81 * t * (t + h), 1e-5);
  EXPECT_NEAR(static_cast<double>(w.obs(0)), 1.218608, 5e-4);
  for (int i = 10; i < 50; ++i) w.step({0, 0, 0});
  EXPECT_NEAR(static_cast<double>(w.obs(0)), 1.206457, 5e-4);
  for (int i = 50; i < 100; ++i) {
    w.step({0, 0, 0});
    ASSERT_FALSE(w.terminated());
  }
}

// The same actions in MuJoCo 2.2.2 on the published models, for a quarter of a second: all coordinates but x.
void replay(const char* task, double size, int32_t motors, const std::vector<double>& expected,
            double tolerance) {
  SmallWorld w(task, {{"reset_noise", nullptr, 0}});
  for (int k = 0; k < 31; ++k) {
    for (int32_t j = 0; j < motors; ++j)
      w.pool().action(0)[j] = static_cast<float>(size * ((7 * (k / 10) + 3 * j) % 5 - 2) / 2);
    w.pool()->step(nullptr);
    ASSERT_FALSE(w.terminated()) << k;
  }
  for (size_t i = 0; i < expected.size(); ++i)
    EXPECT_NEAR(static_cast<double>(w.obs(static_cast<int32_t>(i))), expected[i], tolerance) << task << i;
}
TEST(FlatWalker, MovesAsInMuJoCo) {
  replay("hopper_velocity", 0.06, 3, {1.20343, -0.16431, -0.11241, -0.09625, 0.04331}, 0.005);
  replay("walker2d_velocity", 0.3, 6,
         {1.08179, -0.87142, -0.00762, -1.69301, -0.61554, -0.38753, -0.9317, 0.92151}, 0.05);
}

// A torque alone in the air: what the joint gains is gear over the armature that outweighs the limb, roughly.
TEST(FlatWalker, AMotorTurnsItsJoint) {
  SmallWorld w("hopper_velocity", {{"reset_noise", nullptr, 0}});
  w.step({0, 0, 0.5f});
  const double rate = static_cast<double>(w.obs(10));
  EXPECT_GT(rate, 0.3);
  EXPECT_LT(rate, 100 * 0.008);  // armature 1 kg m2 alone
  EXPECT_NEAR(w.obs(4), 0.5 * 0.008 * rate, 0.3 * 0.008 * rate);
}

TEST(FlatWalker, RewardAndCostFollowTheFormula) {
  for (const char* task : {"hopper_velocity", "walker2d_velocity"}) {
    SmallWorld w(task);
    const bool hopper = w.pool()->obs_dim() == 11;
    const double limit = hopper ? 0.7402 : 2.3415;
    int ended = 0;
    for (int i = 0; i < 300; ++i) {
      const double x = w.pool()->world(0).q()[0];
      w.pool()->baseline(Baseline::kRandom);
      double effort = 0;
      for (int k = 0; k < w.pool()->task().action_dim(); ++k) {
        const double a = static_cast<double>(w.pool().action(0)[k]);
        effort += a * a;
      }
      w.pool()->step(nullptr);
      const float* o = w.pool().final_obs(0);
      ended += w.terminated();
      const double z = static_cast<double>(o[0]), tilt = std::fabs(static_cast<double>(o[1]));
      const bool healthy = hopper ? z > 0.7 && tilt < 0.2 : z > 0.8 && z < 2 && tilt < 1;
      if (w.terminated()) {
        EXPECT_FALSE(healthy);
        continue;  // x is that of the next episode
      }
      const double speed = (w.pool()->world(0).q()[0] - x) / 0.008;
      ASSERT_NEAR(static_cast<double>(w.reward()), speed + 1 - 1e-3 * effort, 1e-5);
      ASSERT_EQ(w.cost(), speed > limit);
    }
    EXPECT_GT(ended, 0) << task;
  }
}

}  // namespace
}  // namespace rdm::test
