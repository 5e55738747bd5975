// rdm_pool_draw: looks, several worlds in one picture, errors.
#include <gtest/gtest.h>
#include <redman/redman.h>
#include <redman/sense.h>

#include <set>
#include <string>
#include <vector>

namespace {

constexpr int32_t kWidth = 96, kHeight = 72;
constexpr size_t kPixels = 96 * 72;

struct Drawn {
  std::vector<uint8_t> rgb = std::vector<uint8_t>(3 * kPixels);
  std::vector<float> depth = std::vector<float>(kPixels);
  std::vector<int32_t> segmentation = std::vector<int32_t>(kPixels, -7);
};

class Pictures : public testing::Test {
 protected:
  void SetUp() override {
    rdm_pool_config config;
    rdm_pool_config_init(&config, sizeof config);
    config.task = "hand_over_safe_finger";
    config.num_envs = 5;
    config.seed = 3;
    ASSERT_EQ(rdm_pool_create(&pool, &config), RDM_OK) << rdm_last_error();
    ASSERT_EQ(rdm_pool_reset(pool, nullptr, nullptr), RDM_OK);
    spec.struct_size = sizeof spec;
    ASSERT_EQ(rdm_pool_get_spec(pool, &spec), RDM_OK);
  }
  void TearDown() override { rdm_pool_destroy(pool); }

  rdm_result draw(Drawn* out, int32_t look, int32_t env = 0, int32_t num_envs = 0) {
    rdm_picture picture = RDM_INIT(rdm_picture);
    picture.env = env;
    picture.num_envs = num_envs;
    picture.width = kWidth;
    picture.height = kHeight;
    picture.look = look;
    picture.camera = "front";
    picture.rgb = out->rgb.data();
    picture.depth = out->depth.data();
    picture.segmentation = out->segmentation.data();
    return rdm_pool_draw(pool, &picture);
  }

  rdm_pool* pool = nullptr;
  rdm_spec spec{};
};

TEST_F(Pictures, LooksDifferInColoursAlone) {
  Drawn fine, plain, again, rendered;
  ASSERT_EQ(draw(&fine, RDM_LOOK_FINE, 1), RDM_OK) << rdm_pool_error(pool);
  ASSERT_EQ(draw(&plain, RDM_LOOK_PLAIN, 1), RDM_OK);
  ASSERT_EQ(draw(&again, RDM_LOOK_FINE, 1, 1), RDM_OK);
  EXPECT_NE(fine.rgb, plain.rgb);
  EXPECT_EQ(fine.depth, plain.depth);
  EXPECT_EQ(fine.segmentation, plain.segmentation);
  EXPECT_EQ(fine.rgb, again.rgb);
  ASSERT_EQ(rdm_pool_render(pool, 1, "front", kWidth, kHeight, rendered.rgb.data(), rendered.depth.data(),
                            rendered.segmentation.data()),
            RDM_OK);
  EXPECT_EQ(rendered.rgb, fine.rgb);
  EXPECT_EQ(rendered.depth, fine.depth);
}

TEST_F(Pictures, SeveralWorldsStandSideBySide) {
  for (const int32_t count : {2, 4}) {
    Drawn grid;
    ASSERT_EQ(draw(&grid, RDM_LOOK_FINE, 1, count), RDM_OK) << rdm_pool_error(pool);
    std::set<int32_t> worlds;
    for (const int32_t s : grid.segmentation)
      if (s >= 0) worlds.insert(s / spec.num_shapes);
    EXPECT_EQ(worlds.size(), static_cast<size_t>(count));
    EXPECT_LT(*worlds.rbegin(), count);
    Drawn same;
    ASSERT_EQ(draw(&same, RDM_LOOK_FINE, 1, count), RDM_OK);
    EXPECT_EQ(grid.rgb, same.rgb);
  }
}

TEST_F(Pictures, ErrorsNameTheMember) {
  Drawn out;
  EXPECT_EQ(draw(&out, 2), RDM_ERROR_RANGE);
  EXPECT_NE(std::string(rdm_pool_error(pool)).find("look"), std::string::npos);
  EXPECT_EQ(draw(&out, RDM_LOOK_FINE, 5), RDM_ERROR_RANGE);
  EXPECT_EQ(draw(&out, RDM_LOOK_FINE, 3, 3), RDM_ERROR_RANGE);
  EXPECT_NE(std::string(rdm_pool_error(pool)).find("num_envs"), std::string::npos);
  EXPECT_EQ(draw(&out, RDM_LOOK_FINE, 0, -1), RDM_ERROR_RANGE);
  EXPECT_EQ(rdm_pool_draw(pool, nullptr), RDM_ERROR_ARGUMENT);
  rdm_picture picture = RDM_INIT(rdm_picture);
  picture.width = picture.height = 8;
  EXPECT_EQ(rdm_pool_draw(pool, &picture), RDM_ERROR_ARGUMENT);  // no camera
  picture.camera = "frnt";
  EXPECT_EQ(rdm_pool_draw(pool, &picture), RDM_ERROR_NOT_FOUND);
  picture.camera = "front";
  picture.width = 8193;
  EXPECT_EQ(rdm_pool_draw(pool, &picture), RDM_ERROR_RANGE);
  picture.width = 8;
  EXPECT_EQ(rdm_pool_draw(pool, &picture), RDM_OK);
  picture.struct_size = 4;
  EXPECT_NE(rdm_pool_draw(pool, &picture), RDM_OK);
  for (const int32_t s : out.segmentation) EXPECT_EQ(s, -7);
}

}  // namespace
