// Pictures of an episode under a shield: a red border where it stepped in, in a strip since the picture before; nothing of
// it where it did not.
#include <gtest/gtest.h>

#include "play/scene.hpp"

namespace tool {
namespace {

constexpr int32_t kWidth = 48, kHeight = 36, kSteps = 24;

// The wall by its shipped policy, of a seed in which the first throw would touch it.
Scene wall(bool shielded) {
  PoolSettings pool;
  pool.task = "hand_over_wall";
  pool.seed = 2;
  ActorChoice choice = choose_actor("trained", pool.task);
  choice.shield = read_shield_word(shielded ? "predict" : "off");
  return {pool, choice, {"front", kWidth, kHeight}};
}

bool bordered(const Image& image) {
  const auto red = [&](int32_t x, int32_t y) {
    const unsigned char* rgb =
        image.rgb.data() + 3 * (static_cast<size_t>(y) * kWidth + static_cast<size_t>(x));
    return rgb[0] > 180 && rgb[1] == 0 && rgb[2] == 0;
  };
  const bool corner = red(0, 0);
  for (int32_t x = 0; x < kWidth; ++x) {
    EXPECT_EQ(red(x, 0), corner);
    EXPECT_EQ(red(x, kHeight - 1), corner);
  }
  for (int32_t y = 0; y < kHeight; ++y) {
    EXPECT_EQ(red(0, y), corner);
    EXPECT_EQ(red(kWidth - 1, y), corner);
  }
  EXPECT_FALSE(red(kWidth / 2, kHeight / 2));
  return corner;
}

TEST(ShieldedScene, HasARedBorderWhereTheShieldSteppedIn) {
  Scene scene = wall(true);
  EXPECT_FALSE(scene.stepped_in());
  EXPECT_FALSE(bordered(scene.picture()));
  int32_t red = 0, plain = 0;
  for (int32_t i = 0; i < kSteps && scene.advance(); ++i) {
    (scene.stepped_in() ? red : plain) += 1;
    EXPECT_EQ(bordered(scene.picture()), scene.stepped_in()) << "step " << scene.step();
  }
  EXPECT_GT(red, 0);
  EXPECT_GT(plain, 0);
  EXPECT_EQ(red % 2, 0) << "a decision is held for two steps";
}

TEST(ShieldedScene, StripsTellOfTheStepsBetweenPictures) {
  Scene steps = wall(true);
  int32_t last = 0;
  while (steps.step() < kSteps && steps.advance())
    if (steps.stepped_in()) last = steps.step();
  ASSERT_GT(last, 0);
  ASSERT_LT(last, kSteps);
  Scene strip = wall(true);
  EXPECT_FALSE(bordered(strip.picture()));
  strip.advance_to(last + 1);
  EXPECT_FALSE(strip.stepped_in());
  EXPECT_TRUE(bordered(strip.picture()));
  EXPECT_FALSE(bordered(strip.picture())) << "it was told";
  Scene one = wall(true);  // a single picture is of its step
  one.advance_to(last + 1);
  EXPECT_FALSE(bordered(one.picture()));
}

TEST(ShieldedScene, WithoutAShieldThereIsNone) {
  Scene scene = wall(false);
  EXPECT_EQ(scene.shielded(), nullptr);
  scene.advance_to(2);
  EXPECT_FALSE(scene.stepped_in());
  EXPECT_FALSE(bordered(scene.picture()));
}

}  // namespace
}  // namespace tool
