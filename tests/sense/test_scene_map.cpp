// The map of a scene at its start: things that stand there are in it, what is to be left out is not.
#include <gtest/gtest.h>

#include <memory>

#include "physics/model/inertia.hpp"
#include "sense/map/scene_map.hpp"

namespace rdm {
namespace {

Scene room() {
  SceneDef def;
  ShapeDef floor, table, leg;
  floor.name = "floor";
  floor.kind = ShapeKind::kPlane;
  table.name = "table";
  table.kind = ShapeKind::kBox;
  table.size = {0.3, 0.2, 0.05};
  table.X_LS.p = {0, 0, 0.4};
  def.statics.push_back(floor);
  def.statics.push_back(table);
  for (const double y : {-1.0, 1.0}) {
    BodyDef body;
    body.name = y < 0 ? "chair" : "trash";
    body.X_WB.p = {0, y, 0.3};
    body.inertia = sphere_inertia(1, 0.2);
    ShapeDef ball;
    ball.name = y < 0 ? "seat" : "can";
    ball.size = {0.2, 0, 0};
    body.shapes.push_back(ball);
    def.bodies.push_back(body);
  }
  return make_scene(std::move(def));
}

TEST(SceneMap, HoldsWhatStandsThere) {
  const Scene scene = room();
  const Camera cameras[] = {{"a", {2, 0.1, 1.5}, {0, 0, 0.3}, 1.2}, {"b", {-2, -0.2, 1.5}, {0, 0, 0.3}, 1.2}};
  OccupancyConfig config;
  config.resolution = 0.05;
  config.memory = 4u << 20;
  const std::unique_ptr<Occupancy, void (*)(Occupancy*)> map(Occupancy::create(config, {}),
                                                             Occupancy::destroy);
  const int32_t chair = 0;
  scan_scene(scene, true, &chair, 1, cameras, 2, 128, map.get());
  const auto near = [&](const Vec3& p) { return map->distance(p, 1) < 0.06; };
  EXPECT_TRUE(near({0, 0, 0.45}));
  EXPECT_TRUE(near({0.3, 0.1, 0.4}));
  EXPECT_TRUE(near({0.2, -1, 0.3}));
  EXPECT_TRUE(near({-0.2, -1, 0.3}));
  EXPECT_FALSE(near({0.2, 1, 0.3})) << "the trash is left out";
  EXPECT_FALSE(near({0.6, 0.6, 0})) << "the floor is left out";
  // a broom's head that is swept along
  const Vec3 head{0.25, 0.05, 0.3};
  EXPECT_TRUE(map->meets_box({{0.35, -1, 0.3}, {}}, head));
  EXPECT_FALSE(map->meets_box({{0.6, -1, 0.3}, {}}, head));
  EXPECT_TRUE(map->meets_box({{0.3, -0.8, 0.3}, axis_angle({0, 0, 1}, 0.8)}, head));
  EXPECT_FALSE(map->meets_box({{0, 1, 0.3}, {}}, head));
  EXPECT_EQ(map->info().dropped, 0u);
  map->clear();
  scan_scene(scene, false, &chair, 1, cameras, 2, 128, map.get());
  EXPECT_FALSE(near({0.3, 0.1, 0.4})) << "what is at rest is left out";
  EXPECT_TRUE(near({0.2, -1, 0.3}));
}

}  // namespace
}  // namespace rdm
