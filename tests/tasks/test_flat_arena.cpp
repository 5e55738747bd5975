#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tasks/planar/flat_arena.hpp"

namespace rdm {
namespace {

TEST(FlatArena, LayoutsKeepTheirDistances) {
  Stream stream(1, 0, Purpose::kTest);
  for (int round = 0; round < 200; ++round) {
    Keepout things[22];
    things[0].keepout = 0.4;
    for (int i = 1; i < 22; ++i) things[i].keepout = i < 11 ? 0.18 : 0.15;
    draw_layout(2, stream, things, 22);
    for (int i = 0; i < 22; ++i) {
      EXPECT_LE(std::fabs(things[i].at.x), 2 - things[i].keepout);
      EXPECT_LE(std::fabs(things[i].at.y), 2 - things[i].keepout);
      for (int j = 0; j < i; ++j)
        EXPECT_GE(distance(things[i].at, things[j].at), things[i].keepout + things[j].keepout);
    }
  }
}

TEST(FlatArena, AFullSquareIsReportedAndHangsNothing) {
  Stream stream(1, 0, Purpose::kTest);
  const Keepout wide = {{0, 0}, 2};
  Keepout spot{{}, 0.1};
  EXPECT_FALSE(draw_spot(1, &wide, 1, stream, &spot));
  Keepout many[30];
  for (Keepout& k : many) k.keepout = 0.5;
  draw_layout(1, stream, many, 30);
  for (const Keepout& k : many) EXPECT_LE(std::fabs(k.at.x), 0.5);
}

// What one thing at an angle and a distance shows in the bins.
std::vector<float> scan(double angle, double far, double yaw = 0) {
  FlatRobot r{};
  r.x = 0.3, r.y = -0.2, r.yaw = yaw;
  const elementary::SinCos heading = elementary::sincos(yaw);
  std::vector<float> bins(kLidarBins, -1);
  Lidar(r, heading, 3, bins.data())
      .add({r.x + far * std::cos(yaw + angle), r.y + far * std::sin(yaw + angle)});
  return bins;
}

TEST(FlatArena, ALidarSharesWithTheBinsBeside) {
  const double width = 2 * kPi / kLidarBins;
  for (const double yaw : {0.0, 1.0, -3.0})
    for (int bin = 0; bin < kLidarBins; ++bin) {
      const auto bins = scan((bin + 0.25) * width, 1.5, yaw);
      for (int k = 0; k < kLidarBins; ++k) {
        const int off = (k - bin + kLidarBins) % kLidarBins;
        const float expected = off == 0 ? 0.5f : off == 1 ? 0.125f : off == kLidarBins - 1 ? 0.375f : 0;
        EXPECT_NEAR(bins[static_cast<size_t>(k)], expected, 1e-6) << bin << " " << k;
      }
    }
}

TEST(FlatArena, NothingIsSeenOutOfRangeAndAnAngleJustBelowZeroIsAFullTurn) {
  for (const float b : scan(1, 3.01)) EXPECT_EQ(b, 0);
  const auto bins = scan(-1e-17, 1.5);
  float sum = 0;
  for (const float b : bins) sum += b;
  EXPECT_GE(sum, 0.5f);
  EXPECT_LE(sum, 1.01f);
}

TEST(FlatArena, TheNearestThingOfABinCounts) {
  FlatRobot r{};
  const elementary::SinCos heading{0, 1};
  float bins[kLidarBins];
  Lidar lidar(r, heading, 3, bins);
  lidar.add({2, 0.4});
  lidar.add({1, 0.2});
  lidar.add({2.5, 0.5});
  EXPECT_NEAR(bins[0], (3 - std::sqrt(1.04)) / 3, 1e-6);
}

}  // namespace
}  // namespace rdm
