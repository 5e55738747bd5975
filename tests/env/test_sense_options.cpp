// From the options' words to what a pool makes.
#include <gtest/gtest.h>

#include "base/error.hpp"
#include "env/options/sense.hpp"
#include "toy_task.hpp"

namespace rdm {
namespace {

constexpr CameraSpec kCameras[] = {{"front", {1, 0, 0}, {0, 0, 0}, 1}, {"above", {0, 0, 3}, {0, 0, 1}, 0.5}};
TaskInfo task() {
  TaskInfo t{};
  t.name = "test";
  t.cameras = kCameras;
  t.num_cameras = 2;
  return t;
}

SenseConfig read(std::vector<OptionInput> inputs) {
  Options options;
  int32_t count = 0;
  const OptionSpec* rows = sense_options(&count);
  options.add_table(rows, count);
  for (const OptionInput& input : inputs) options.set(input, "test");
  test::register_toy();
  test::TestPool toy("toy_push", 1);
  return sense_from(options, task(), toy->task());
}

Code code_of(std::vector<OptionInput> inputs) {
  return guard([&] { read(inputs); });
}

TEST(SenseOptions, NothingIsSeenByDefault) {
  const SenseConfig c = read({});
  EXPECT_FALSE(c.any());
  EXPECT_EQ(c.num_points, 0);
  EXPECT_EQ(c.num_cameras, 0);
  EXPECT_EQ(c.grid, 0);
}

TEST(SenseOptions, WordsAreJoined) {
  const SenseConfig c = read({{"modality", "RGB+depth,voxels", 0}, {"cameras", "front+side-left", 0}});
  EXPECT_TRUE(c.rgb && c.depth && c.voxels);
  EXPECT_FALSE(c.segmentation || c.points);
  ASSERT_EQ(c.num_cameras, 2);
  EXPECT_STREQ(c.cameras[0].name.text, "front");
  EXPECT_STREQ(c.cameras[1].name.text, "side_left");
  EXPECT_EQ(c.num_cloud_cameras, 3);
  EXPECT_EQ(c.grid, 16);
  EXPECT_EQ(c.num_points, 0);
}

TEST(SenseOptions, PointsHaveTheirDefaults) {
  const SenseConfig c = read({{"modality", "points", 0}});
  EXPECT_EQ(c.num_points, 2048);
  EXPECT_EQ(c.thinning, Thinning::kFurthest);
  EXPECT_EQ(c.cloud_width, 96);
  EXPECT_EQ(c.num_cameras, 0);
  // the task's own camera of that name comes before the one for all
  EXPECT_EQ(c.cloud_cameras[0].eye.z, 3);
  EXPECT_EQ(c.cloud_cameras[1].eye.x, 0.4);
  EXPECT_EQ(read({{"modality", "points", 0}, {"sampling", "voxel", 0}}).thinning, Thinning::kVoxel);
  EXPECT_EQ(read({{"modality", "points", 0}, {"sampling", "random", 0}}).thinning, Thinning::kRandom);
}

TEST(SenseOptions, UnknownWordsAreNamed) {
  EXPECT_EQ(code_of({{"modality", "pionts", 0}}), Code::kArgument);
  EXPECT_NE(std::string(last_error()).find("points"), std::string::npos) << last_error();
  EXPECT_EQ(code_of({{"modality", "rgb", 0}, {"cameras", "fornt", 0}}), Code::kNotFound);
  EXPECT_NE(std::string(last_error()).find("front"), std::string::npos) << last_error();
  EXPECT_EQ(code_of({{"modality", "rgb", 0}, {"cameras", "", 0}}), Code::kArgument);
  EXPECT_EQ(code_of({{"modality", "rgb", 0},
                     {"cameras", "front+front+front+front+front+front+front+front+front", 0}}),
            Code::kRange);
  EXPECT_EQ(code_of({{"cameras", "fornt", 0}}), Code::kOk) << "not asked for";
  EXPECT_EQ(code_of({{"points", nullptr, 0}}), Code::kRange);
}

}  // namespace
}  // namespace rdm
