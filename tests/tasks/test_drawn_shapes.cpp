// What pictures for people add to a scene.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "prop_tasks.hpp"
#include "sense/drawn_shapes.hpp"
#include "sense/scene_shapes.hpp"

namespace rdm::test {
namespace {

std::vector<RenderShape> drawn(TestPool& p) {
  const World& world = p->world(0);
  std::vector<RenderShape> out(static_cast<size_t>(most_drawn_shapes(world.scene())));
  out.resize(static_cast<size_t>(gather_drawn(world, out.data())));
  return out;
}

size_t added(const char* task, std::vector<OptionInput> options) {
  TestPool p(task, 1, std::move(options));
  p->reset(nullptr, nullptr);
  return drawn(p).size() - p->world(0).scene().shapes.size();
}

TEST(DrawnShapes, HandsWithRoundFingersHaveBonesAndNails) {
  register_builtin_tasks();
  EXPECT_EQ(added("hand_over_safe_finger", {}), 20u);  // of each of ten fingers
  EXPECT_EQ(added("grasp", {}), 10u);
  EXPECT_EQ(added("grasp", {{"hand", "allegro", 0}, {"arm", "ur5e", 0}}), 0u);  // fingers of boxes
  EXPECT_EQ(added("ant_run", {}), 0u);                                          // legs are no fingers
  EXPECT_EQ(added("bandit", {}), 0u);
}

TEST(DrawnShapes, TheSceneIsAsItIs) {
  register_builtin_tasks();
  TestPool p("jenga", 1, {});
  p->reset(nullptr, nullptr);
  const World& world = p->world(0);
  const std::vector<RenderShape> all = drawn(p);
  int wood = 0;
  for (size_t i = 0; i < world.scene().shapes.size(); ++i) {
    const RenderShape true_one = shape_of(world, static_cast<int32_t>(i));
    EXPECT_EQ(all[i].kind, true_one.kind);
    EXPECT_EQ(all[i].id, true_one.id);
    EXPECT_EQ(norm(all[i].size - true_one.size), 0);
    EXPECT_EQ(norm(all[i].X_WS.p - true_one.X_WS.p), 0);
    if (all[i].kind == ShapeKind::kBox) {
      EXPECT_GT(all[i].round, 0);
      EXPECT_LE(all[i].round, std::min({all[i].size.x, all[i].size.y, all[i].size.z}));
    }
    wood += all[i].finish == Finish::kWood;
  }
  EXPECT_GT(wood, 10);
  for (size_t i = world.scene().shapes.size(); i < all.size(); ++i) {
    EXPECT_NEAR(all[i].X_WS.q.w * all[i].X_WS.q.w + dot({all[i].X_WS.q.x, all[i].X_WS.q.y, all[i].X_WS.q.z},
                                                        {all[i].X_WS.q.x, all[i].X_WS.q.y, all[i].X_WS.q.z}),
                1, 1e-12);
    EXPECT_LT(all[i].id, static_cast<int32_t>(world.scene().shapes.size()));
  }
}

// A nail is on the back of its tip: fingers bend to -y of their frames, of the left hand to +y.
TEST(DrawnShapes, NailsAreOnTheBackOfTheTips) {
  register_builtin_tasks();
  TestPool p("hand_over_safe_finger", 1, {});
  p->reset(nullptr, nullptr);
  const Scene& scene = p->world(0).scene();
  const std::vector<RenderShape> all = drawn(p);
  int nails = 0;
  for (const char* side : {"right", "left"}) {
    for (size_t i = scene.shapes.size(); i < all.size(); ++i) {
      if (all[i].kind != ShapeKind::kEllipsoid) continue;
      const RenderShape& tip = all[static_cast<size_t>(all[i].id)];
      const char* owner = scene.shapes[static_cast<size_t>(all[i].id)].def.name.text;
      if (std::strncmp(owner, side, std::strlen(side)) != 0 || std::strstr(owner, "th_")) continue;
      const double back = rotate(conjugate(tip.X_WS.q), all[i].X_WS.p - tip.X_WS.p).y;
      EXPECT_GT(*side == 'l' ? -back : back, 0.5 * tip.size.x) << owner;
      ++nails;
    }
  }
  EXPECT_EQ(nails, 8);
}

}  // namespace
}  // namespace rdm::test
