// map.hpp: the owner of a map and views of what worlds see.
#include <gtest/gtest.h>

#include <redman/map.hpp>
#include <redman/sense.hpp>

namespace {

const float kFrom[3] = {0, 0, 0}, kWall[6] = {1, 0, 0, 1, 0.1f, 0}, kAhead[3] = {1, 0, 0};

TEST(RedmanMapHpp, AMapIsWrittenAskedAndKept) {
  redman::Map map(redman::map_config(0.05));
  EXPECT_EQ(map.insert(kFrom, kWall, 2), 0u);
  EXPECT_GT(map.query(kWall), 0.5f);
  const float between[3] = {0.5f, 0, 0}, unknown[3] = {0, 0, 1};
  EXPECT_LT(map.query(between), 0.5f);
  EXPECT_EQ(map.query(unknown), -1);
  EXPECT_NEAR(map.distance(between, 2), 0.5f, 0.05f);
  const float low[3] = {0.9f, -0.2f, -0.2f}, high[3] = {1.1f, 0.2f, 0.2f};
  EXPECT_EQ(map.box(low, high).size(), 2u);
  const rdm_pose pose = {{1, 0, 0}, {0, 0, 0, 1}}, aside = {{0.5, 0, 0}, {}};
  const float half[3] = {0.1f, 0.1f, 0.1f};
  EXPECT_TRUE(map.meets(pose, half));
  EXPECT_FALSE(map.meets(aside, half));
  float hit[3];
  EXPECT_TRUE(map.raycast(kFrom, kAhead, 2, hit));
  EXPECT_NEAR(hit[0], 1, 0.05);
  EXPECT_FALSE(map.raycast(kFrom, kAhead, 0.5f, hit));

  redman::Map other(redman::map_config(0.1));
  other.load(map.save(RDM_MAP_FULL));
  EXPECT_EQ(other.info().resolution, 0.05);
  EXPECT_EQ(other.query(kWall), map.query(kWall));
  map.clear();
  EXPECT_EQ(map.query(kWall), -1);
  EXPECT_THROW(map.load(redman::Bytes(7)), redman::Error);
  EXPECT_THROW(redman::Map(redman::map_config(-1)), redman::Error);
}

TEST(RedmanMapHpp, WorldsAreSeenAndScanned) {
  auto config = redman::pool_config("grasp", 2);
  const rdm_option seen[] = {{"modality", "points", 0}, {"points", nullptr, 64}};
  config.options = seen;
  config.num_options = 2;
  redman::Pool pool(config);
  pool.reset();
  const rdm_sensors s = redman::sensors(pool);
  ASSERT_EQ(s.num_points, 64);
  EXPECT_EQ(redman::points(s, 1)[3].data(), s.points + 3 * (64 + 3));
  redman::Pool blind(redman::pool_config("grasp"));
  EXPECT_EQ(redman::points(redman::sensors(blind), 0).data(), nullptr);

  rdm_camera_info camera = RDM_INIT(rdm_camera_info);
  ASSERT_EQ(rdm_pool_sensor_camera_at(pool.get(), 1, 0, &camera), RDM_OK);
  redman::Map map(redman::map_config(0.02));
  EXPECT_EQ(map.scan(pool, 0, camera.name, 64, 64), 0u);
  EXPECT_GT(map.info().nodes, 0u);
  EXPECT_THROW(map.scan(pool, 2, camera.name, 64, 64), redman::Error);
}

}  // namespace
