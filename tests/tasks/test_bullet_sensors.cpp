#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "tasks/bullet/sensors.hpp"

namespace rdm {
namespace {

// angle = atan2(xa - xo, ya - yo) + pi, bin = floor(angle / (2 pi / n)): the published formula.
TEST(SectorSensor, EachThingFallsInTheSectorOfTheFormula) {
  Stream draw(1, 0, Purpose::kTest);
  for (int round = 0; round < 500; ++round) {
    const Spot from{draw.signed_unit(), draw.signed_unit()};
    const Spot thing{5 * draw.signed_unit(), 5 * draw.signed_unit()};
    float bins[16];
    SectorSensor(from, 10, 16, bins).add(thing);
    const double angle = std::atan2(from.x - thing.x, from.y - thing.y) + kPi;
    const auto bin = static_cast<int>(std::floor(angle / (2 * kPi / 16)));
    for (int k = 0; k < 16; ++k)
      EXPECT_NEAR(static_cast<double>(bins[k]), k == bin ? 1 - distance(from, thing) / 10 : 0, 1e-6);
  }
}

TEST(SectorSensor, AFullTurnIsNoneAndTheNearestCounts) {
  float bins[16];
  SectorSensor sensor({0, 0}, 10, 16, bins);
  sensor.add({0, 4});  // atan2(-0, -4) + pi or atan2(0, -4) + pi: 0 or a full turn
  sensor.add({0, 9});
  sensor.add({0, 40});
  EXPECT_NEAR(bins[0], 0.6, 1e-6);
  EXPECT_EQ(std::count(bins, bins + 16, 0.0f), 15);
}

// Every ray is walked along in millimetres.
TEST(RaySensor, RaysEndWhereAWalkerWould) {
  Stream draw(2, 0, Purpose::kTest);
  const Room room = square_room();
  for (int round = 0; round < 40; ++round) {
    const Spot from{9 * draw.signed_unit(), 9 * draw.signed_unit()};
    const Spot disc{from.x + 4 * draw.signed_unit(), from.y + 4 * draw.signed_unit()};
    const Spot box{from.x + 4 * draw.signed_unit(), from.y + 4 * draw.signed_unit()};
    const double yaw = 2 * kPi * draw.uniform();
    float out[RaySensor::kRays];
    RaySensor sensor(from, elementary::sincos(yaw), 5, out);
    sensor.add_room(room);
    sensor.add_disc(disc, 0.45);
    sensor.add_square(box, 0.5);
    for (int i = 0; i < RaySensor::kRays; ++i) {
      const double angle = yaw + 2 * kPi * i / RaySensor::kRays;
      // of things that are `grow` m larger: a ray that grazes one lies between smaller and larger ones
      const auto walk = [&](double grow) {
        double way = 0;
        for (; way < 5; way += 1e-3) {
          const Spot at{from.x + way * std::cos(angle), from.y + way * std::sin(angle)};
          if (std::max(std::fabs(at.x), std::fabs(at.y)) >= 10 || distance(at, disc) <= 0.45 + grow ||
              std::max(std::fabs(at.x - box.x), std::fabs(at.y - box.y)) <= 0.5 + grow)
            break;
        }
        return std::max(0.0, 1 - way / 5);
      };
      EXPECT_GE(static_cast<double>(out[i]), walk(-2e-3) - 1e-3) << round << " " << i;
      EXPECT_LE(static_cast<double>(out[i]), walk(2e-3) + 1e-3) << round << " " << i;
    }
  }
}

}  // namespace
}  // namespace rdm
