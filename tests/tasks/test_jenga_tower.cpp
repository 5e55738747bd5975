#include <gtest/gtest.h>

#include "tasks/props/jenga_tower.hpp"

namespace rdm {
namespace {

JengaTower tower(std::vector<OptionInput> inputs = {}) {
  static OwnOptionTable* table = nullptr;
  if (!table) {
    table = new OwnOptionTable;
    add_tower_options(*table);
  }
  Options o;
  o.add_table(table->rows(), table->count());
  for (const OptionInput& input : inputs) o.set(input, "test");
  return jenga_tower_from(o, 0.0005);
}

double top(const JengaTower& t, int i) {
  return t.place[i].z + t.half[i].z;
}
double bottom(const JengaTower& t, int i) {
  return t.place[i].z - t.half[i].z;
}
bool over(const JengaTower& t, int i, int k) {
  bool both = true;
  for (int axis = 0; axis < 2; ++axis)
    both = both && std::abs(t.place[i][axis] - t.place[k][axis]) < t.half[i][axis] + t.half[k][axis];
  return both;
}

TEST(JengaTower, EveryBlockRestsOnWhatIsBelow) {
  for (const char* preset : {"redman", "real"}) {
    const JengaTower t = tower({{"preset", preset, 0}});
    const double sink =
        preset[1] == 'e' && preset[2] == 'a' ? 0.0075 / 20 : 0.0005;  // the layer of blocks so thin
    const double table = t.table.z + t.table_half.z;
    EXPECT_NEAR(table, 0.2357, 1e-12);
    for (int i = 0; i <= kJengaBlocks; ++i) {
      int carriers = 0;
      const bool lowest = bottom(t, i) < table;
      if (lowest) {
        EXPECT_NEAR(bottom(t, i), table - sink, 1e-9);
      }
      for (int k = 0; k <= kJengaBlocks; ++k) {
        if (k == i || !over(t, i, k)) continue;
        const double gap = bottom(t, i) - top(t, k);
        EXPECT_TRUE(std::abs(gap + sink) < 1e-9 || gap > 0.005 || gap < -0.01) << preset << i << " " << k;
        carriers += std::abs(gap + sink) < 1e-9;
      }
      EXPECT_TRUE(lowest || carriers >= 2) << preset << " " << i;
      for (int axis = 0; axis < 2; ++axis)
        EXPECT_LE(std::abs(t.place[i][axis] - t.table[axis]) + t.half[i][axis], t.table_half[axis]);
    }
  }
}

// The released tower, and one of real blocks: 15 mm high, 75 mm long, 20 g.
TEST(JengaTower, Presets) {
  const JengaTower t = tower();
  EXPECT_NEAR(t.place[0].z, 0.4157 - 5 * 0.0005, 1e-12);
  EXPECT_NEAR(t.place[0].y, -0.6, 1e-12);
  EXPECT_EQ(t.target_end(), 0.08);
  EXPECT_NEAR(top(t, 16), 0.5557, 0.005);
  EXPECT_EQ(t.mass[0], 0.128);
  EXPECT_EQ(t.mass[16], 0.208);
  EXPECT_EQ(t.friction, 0.05);
  EXPECT_EQ(t.moved, 0.01);
  const JengaTower r = tower({{"preset", "real", 0}});
  EXPECT_NEAR(top(r, 16), 0.2357 + 0.09, 0.004);
  EXPECT_NEAR(norm(r.place[0] - Vec3{0, -0.6, 0.2357 + 2.5 * 0.015}), 0, 0.002);
  EXPECT_EQ(r.mass[0], 0.020);
  EXPECT_EQ(r.friction, 0.4);
  EXPECT_EQ(r.moved, 0.005);
}

TEST(JengaTower, NumbersReplaceThePresets) {
  const JengaTower t = tower(
      {{"block_mass", nullptr, 0.104}, {"friction.block_block", nullptr, 0}, {"block_limit", nullptr, 0.02}});
  EXPECT_NEAR(t.mass[1], 0.104, 1e-12);
  EXPECT_NEAR(t.mass[0], 0.064, 1e-12);
  EXPECT_EQ(t.friction, 0);
  EXPECT_EQ(t.moved, 0.02);
}

TEST(JengaTower, TheSceneHasTheTargetFirst) {
  SceneDef scene;
  add_tower(tower(), 1, 2, 3, &scene);
  ASSERT_EQ(scene.bodies.size(), 17u);
  EXPECT_TRUE(scene.bodies[0].name == "target");
  EXPECT_TRUE(scene.bodies[16].name == "block_16");
  EXPECT_EQ(scene.bodies[0].shapes[0].material, 1);
  EXPECT_EQ(scene.bodies[1].shapes[0].material, 2);
  EXPECT_EQ(scene.statics[0].material, 3);
}

}  // namespace
}  // namespace rdm
