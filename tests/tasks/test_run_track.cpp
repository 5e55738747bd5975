#include <gtest/gtest.h>

#include "tasks/bullet/run_track.hpp"

namespace rdm {
namespace {

constexpr RunTrack kTrack = {2.5, 2, 9, 250};

TEST(RunTrack, CostIsOneForEitherFaultOrBoth) {
  struct {
    RunPlace place;
    double cost, speed, lane;
  } const rows[] = {{{0, 0, 2.5}, 0, 0, 0},
                    {{0, -2, 0}, 0, 0, 0},
                    {{0, 0, 2.51}, 1, 1, 0},
                    {{0, -2.01, 0}, 1, 0, 1},
                    {{0, 3, 9}, 1, 1, 1}};
  for (const auto& r : rows) {
    const Verdict v = judge_run(kTrack, r.place, 0, 0);
    EXPECT_EQ(v.cost[0], r.cost);
    EXPECT_EQ(v.cost[1], r.speed);
    EXPECT_EQ(v.cost[2], r.lane);
    EXPECT_EQ(v.cost_raw[1], r.place.speed);
    EXPECT_FALSE(v.terminated);
  }
}

TEST(RunTrack, RewardAndSuccess) {
  EXPECT_DOUBLE_EQ(judge_run(kTrack, {8.9, 0, 1}, 0.05, -0.25).reward, 2.75);
  EXPECT_FALSE(judge_run(kTrack, {8.9, 0, 1}, 0, 0).success);
  EXPECT_TRUE(judge_run(kTrack, {9.1, 0, 1}, 0, 0).success);
  EXPECT_FALSE(judge_run(kTrack, {9.1, 3, 1}, 0, 0).success);
  EXPECT_NEAR(track_distance(0, 0) - track_distance(1, 0), 1, 1e-12);
}

}  // namespace
}  // namespace rdm
