#include <algorithm>

#include "tasks/catalog.hpp"
#include "tasks/throw/wall.hpp"
#include "toy_task.hpp"

namespace rdm::test {
namespace {

constexpr Wall kWall = {-0.525, 0.03, 1, 0.15, 1.15, 0, 0.65, 0.2, 0.2};

bool covered(const Vector<ShapeDef>& panels, double x, double z) {
  return std::any_of(panels.begin(), panels.end(), [&](const ShapeDef& s) {
    return std::abs(x - s.X_LS.p.x) <= s.size.x && std::abs(z - s.X_LS.p.z) <= s.size.z;
  });
}

// The union of the panels is the wall without the hole, whatever the sizes.
TEST(Wall, PanelsAreTheWallWithoutTheHole) {
  Wall slot = kWall;
  slot.hole_x = 0.3;
  slot.hole_width = 0.4;  // to the wall's edge
  for (const Wall& w : {kWall, slot}) {
    const auto panels = wall_panels(w, 4);
    EXPECT_EQ(panels.size(), w.hole_x > 0 ? 3u : 4u);
    for (double x = -0.595; x < 0.6; x += 0.01)
      for (double z = 0.055; z < 1.3; z += 0.01) {
        const bool inside = x > w.low_x() && x < w.high_x() && z > w.low_z && z < w.high_z;
        const bool hole =
            std::abs(x - w.hole_x) < 0.5 * w.hole_width && std::abs(z - w.hole_z) < 0.5 * w.hole_height;
        EXPECT_EQ(covered(panels, x, z), inside && !hole) << x << " " << z;
      }
    for (const ShapeDef& s : panels) {
      EXPECT_EQ(s.size.y, 0.015);
      EXPECT_EQ(s.material, 4);
    }
  }
  Wall shut = kWall;
  shut.hole_width = 0;
  EXPECT_TRUE(covered(wall_panels(shut, 0), 0, 0.65));
}

TEST(Wall, BoxesAreRead) {
  ShapeDef s;
  ASSERT_TRUE(parse_box("0.1 -0.5 0.6  0.2 0.03 0.4", &s));
  EXPECT_EQ(s.X_LS.p.y, -0.5);
  EXPECT_EQ(s.size.z, 0.2);
  EXPECT_EQ(s.X_LS.q.w, 1);
  ASSERT_TRUE(parse_box("0 0 0 1 1 1 0 90 0", &s));
  EXPECT_NEAR(rotate(s.X_LS.q, {1, 0, 0}).z, -1, 1e-12);
  for (const char* bad :
       {"", "1 2 3", "0 0 0 1 1", "0 0 0 1 1 0", "0 0 0 1 1 1 x", "0 0 0 1 1 1 5", "a", "0 0 0 1 1 nan"})
    EXPECT_FALSE(parse_box(bad, &s)) << bad;
}

TEST(Wall, OwnBoxesReplaceTheWall) {
  register_builtin_tasks();
  TestPool p(
      "hand_over_wall", 1,
      {{"wall.box1", "0 -0.525 0.3 1 0.02 0.2", 0}, {"wall.box3", "0.2 -0.525 0.6 0.1 0.02 0.4 0 45 0", 0}});
  const Scene& scene = p->task().scene();
  EXPECT_EQ(scene.def.statics.size(), 3u);
  EXPECT_NEAR(scene.shapes[static_cast<size_t>(scene.find_shape("wall1"))].def.size.y, 0.01, 1e-12);
  EXPECT_EQ(code_of([&] { scene.find_shape("wall3"); }), Code::kNotFound);
}

TEST(Wall, BadOptionsSayWhich) {
  register_builtin_tasks();
  const auto make = [](std::vector<OptionInput> options) {
    return code_of([&] { TestPool p("hand_over_wall", 1, options); });
  };
  EXPECT_EQ(make({{"wall.box2", "a box", 0}}), Code::kArgument);
  EXPECT_NE(std::string(last_error()).find("wall.box2"), std::string::npos);
  EXPECT_EQ(make({{"wall.hole.width", nullptr, 1.2}}), Code::kArgument);
  EXPECT_EQ(make({{"wall.hole.z", nullptr, 1.1}}), Code::kArgument);
  EXPECT_EQ(make({{"wall.low", nullptr, 2}}), Code::kArgument);
  EXPECT_EQ(make({{"wall.hole.width", nullptr, 0.5}, {"wall.hole.height", nullptr, 0.1}}), Code::kOk);
}

}  // namespace
}  // namespace rdm::test
