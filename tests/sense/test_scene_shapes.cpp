#include <gtest/gtest.h>

#include "sense/scene_shapes.hpp"
#include "sense_shapes.hpp"
#include "two_hands.hpp"

namespace rdm {
namespace {

std::vector<RenderShape> gather(const World& world) {
  std::vector<RenderShape> out(world.scene().shapes.size() + 1);
  out.back().id = -77;
  EXPECT_EQ(gather_shapes(world, out.data()), static_cast<int32_t>(out.size()) - 1);
  EXPECT_EQ(out.back().id, -77);
  out.pop_back();
  return out;
}

TEST(SceneShapes, EveryShapeWithItsNumberColourAndPose) {
  test::Simulation sim(test::two_hands_def());
  const std::vector<RenderShape> shapes = gather(*sim);
  ASSERT_GT(shapes.size(), 40u);
  for (size_t i = 0; i < shapes.size(); ++i) {
    const SceneShape& s = sim.scene().shapes[i];
    EXPECT_EQ(shapes[i].id, static_cast<int32_t>(i));
    EXPECT_EQ(shapes[i].kind, s.def.kind);
    EXPECT_EQ(norm(shapes[i].size - s.def.size), 0);
    for (int k = 0; k < 3; ++k) EXPECT_EQ(shapes[i].color[k], s.def.color[k]);
    Pose X_WS = s.def.X_LS;
    if (s.carrier == Carrier::kLink) X_WS = sim->link(s.index).X * s.def.X_LS;
    if (s.carrier == Carrier::kBody) X_WS = sim->body(s.index).X * s.def.X_LS;
    if (s.carrier == Carrier::kBase) X_WS = sim->base(s.articulation).X * s.def.X_LS;
    EXPECT_NEAR(norm(shapes[i].X_WS.p - X_WS.p), 0, 1e-12) << s.def.name.text;
  }
}

TEST(SceneShapes, FollowsTheWorld) {
  test::Simulation sim(test::two_hands_def());
  const std::vector<RenderShape> before = gather(*sim);
  test::target_share(*sim, 0, test::kCup);
  for (int i = 0; i < 30; ++i) sim->step();
  const std::vector<RenderShape> after = gather(*sim);
  int moved = 0;
  for (size_t i = 0; i < before.size(); ++i) moved += norm(after[i].X_WS.p - before[i].X_WS.p) > 1e-3;
  EXPECT_GT(moved, 10);
  EXPECT_LT(moved, static_cast<int>(before.size()));
}

TEST(SceneShapes, AreOfTheSizeThatTheWorldGivesThem) {
  SceneDef def = test::two_hands_def();
  def.adjustable = true;
  test::Simulation sim(def, EngineKind::kArticulated);
  const std::vector<RenderShape> before = gather(*sim);
  Dynamics& factors = sim->edit_dynamics();
  factors.bodies[0].size = 1.5;
  sim->set_dynamics(factors);
  const std::vector<RenderShape> after = gather(*sim);
  for (size_t i = 0; i < before.size(); ++i) {
    const double factor = sim.scene().shapes[i].carrier == Carrier::kBody ? 1.5 : 1;
    EXPECT_EQ(norm(after[i].size - factor * before[i].size), 0) << i;
  }
}

// What a viewer of `top` must see: two hands, each the other's mirror image, fingers towards each other,
// thumbs on the same side, and the ball over the right one.
TEST(SceneShapes, HandsLookLikeHandsFromAbove) {
  test::Simulation sim(test::two_hands_def());
  const std::vector<RenderShape> shapes = gather(*sim);
  const Picture p = take(shapes, {"top", {0, -0.5, 1.8}, {0, -0.5, 0.5}, kPi / 4}, 320, 240);
  struct Blob {
    double x = 0, y = 0;
    int n = 0;
  };
  const auto blob = [&](int32_t articulation, const char* part) {
    Blob b;
    for (int32_t y = 0; y < p.height; ++y)
      for (int32_t x = 0; x < p.width; ++x) {
        const int32_t id = p.segmentation[p.at(x, y)];
        if (id < 0) continue;
        const SceneShape& s = sim.scene().shapes[static_cast<size_t>(id)];
        if (s.articulation != articulation || !std::strstr(s.def.name.text, part)) continue;
        b.x += x;
        b.y += y;
        ++b.n;
      }
    b.x /= b.n;
    b.y /= b.n;
    return b;
  };
  for (int32_t hand = 0; hand < 2; ++hand) {
    const Blob palm = blob(hand, "palm"), tip = blob(hand, "mf_distal"), thumb = blob(hand, "th_distal");
    const Blob first = blob(hand, "ff_proximal"), little = blob(hand, "lf_proximal");
    ASSERT_TRUE(palm.n > 20 && tip.n > 3 && thumb.n > 3 && first.n > 3 && little.n > 3) << hand;
    EXPECT_GT((tip.x - palm.x) * (hand == 0 ? -1 : 1), 10) << hand;  // towards the other hand
    EXPECT_LT(thumb.y, palm.y) << hand;                              // both towards -x
    EXPECT_LT(first.y, little.y) << hand;                            // first finger beside the thumb
  }
  const Blob right = blob(0, "distal"), left = blob(1, "distal");
  EXPECT_NEAR(right.x - 159.5, 159.5 - left.x, 8);
  EXPECT_NEAR(right.y, left.y, 2);
}

}  // namespace
}  // namespace rdm
