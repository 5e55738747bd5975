// Where a ray enters each kind of shape, and the way the surface faces there.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "base/rng.hpp"
#include "hulls.hpp"
#include "sense/ray.hpp"

namespace rdm {
namespace {

constexpr double kFar = std::numeric_limits<double>::infinity();

// Bodies that stand where they are put, one of each kind.
struct Kinds {
  Scene scene;
  Arena arena;
  World* world;

  Kinds() {
    SceneDef def;
    const auto add = [&](const char* name, ShapeKind kind, const Vec3& size, const Pose& X) {
      BodyDef body;
      body.name = name;
      body.X_WB = X;
      body.inertia.mass = 1;
      for (int k = 0; k < 3; ++k) body.inertia.moment[k] = 1;
      ShapeDef shape;
      shape.name = name;
      shape.kind = kind;
      shape.size = size;
      if (kind == ShapeKind::kHull)
        for (int i = 0; i < 8; ++i)
          shape.points.push_back(
              {i & 1 ? size.x : -size.x, i & 2 ? size.y : -size.y, i & 4 ? size.z : -size.z});
      body.shapes.push_back(shape);
      def.bodies.push_back(body);
    };
    const Quat side = axis_angle({1, 0, 0}, 1.5707963267948966);  // z to -y
    add("sphere", ShapeKind::kSphere, {0.5, 0, 0}, {{0, 0, 1}, {}});
    add("capsule", ShapeKind::kCapsule, {0.25, 0.5, 0}, {{10, 0, 1}, side});
    add("box", ShapeKind::kBox, {0.5, 0.25, 0.125}, {{20, 0, 1}, {}});
    add("cylinder", ShapeKind::kCylinder, {0.25, 0.5, 0}, {{30, 0, 1}, {}});
    add("ellipsoid", ShapeKind::kEllipsoid, {0.5, 0.25, 0.125}, {{40, 0, 1}, {}});
    add("hull", ShapeKind::kHull, {0.5, 0.25, 0.125}, {{50, 0, 1}, {}});
    ShapeDef ground;
    ground.name = "ground";
    ground.kind = ShapeKind::kPlane;
    def.statics.push_back(ground);
    scene = make_scene(std::move(def));
    Arena measure;
    World::measure(EngineKind::kKinematic, scene, measure);
    arena = Arena(HostHooks{}, measure.used());
    world = World::create(EngineKind::kKinematic, scene, arena, HostHooks{});
  }
  ~Kinds() { World::destroy(world, HostHooks{}); }
};

void expect_hit(const World& world, const Vec3& from, const Vec3& along, const char* shape, double distance,
                const Vec3& n) {
  RayHit hit;
  ASSERT_TRUE(cast_ray(world, from, along, kFar, &hit)) << shape;
  EXPECT_STREQ(world.scene().shapes[static_cast<size_t>(hit.shape)].def.name.text, shape);
  EXPECT_NEAR(hit.distance, distance, 1e-6) << shape;
  EXPECT_NEAR(norm(hit.p - (from + distance * along)), 0, 1e-6) << shape;
  EXPECT_NEAR(norm(hit.n - n), 0, 1e-5) << shape << ' ' << hit.n.x << ' ' << hit.n.y << ' ' << hit.n.z;
}

TEST(Ray, MeetsEveryKindFromAbove) {
  const Kinds k;
  const Vec3 down{0, 0, -1}, up{0, 0, 1};
  expect_hit(*k.world, {0, 0, 3}, down, "sphere", 1.5, up);
  expect_hit(*k.world, {10, 0.4, 3}, down, "capsule", 1.75, up);
  expect_hit(*k.world, {20.4, 0.2, 3}, down, "box", 1.875, up);
  expect_hit(*k.world, {30.1, 0.1, 3}, down, "cylinder", 1.5, up);
  expect_hit(*k.world, {40, 0, 3}, down, "ellipsoid", 1.875, up);
  expect_hit(*k.world, {50.4, -0.2, 3}, down, "hull", 1.875, up);
  expect_hit(*k.world, {5, 0, 3}, down, "ground", 3, up);
}

TEST(Ray, MeetsEveryKindFromTheSide) {
  const Kinds k;
  const Vec3 west{-1, 0, 0}, north{0, 1, 0};
  expect_hit(*k.world, {0, -3, 1.3}, north, "sphere", 2.6, {0, -0.8, 0.6});
  expect_hit(*k.world, {10, -3, 1}, north, "capsule", 2.25, {0, -1, 0});  // the ball at its end
  expect_hit(*k.world, {13, 0.2, 1}, west, "capsule", 2.75, {1, 0, 0});
  expect_hit(*k.world, {23, 0.2, 1.1}, west, "box", 2.5, {1, 0, 0});
  expect_hit(*k.world, {20.2, -3, 1}, north, "box", 2.75, {0, -1, 0});
  expect_hit(*k.world, {30.15, -3, 1}, north, "cylinder", 2.8, {0.6, -0.8, 0});
  expect_hit(*k.world, {43, 0, 1}, west, "ellipsoid", 2.5, {1, 0, 0});
  expect_hit(*k.world, {50.2, -3, 1}, north, "hull", 2.75, {0, -1, 0});
}

// Floats stay out of it: as exact from far away.
TEST(Ray, IsExactFromFarAway) {
  const Kinds k;
  expect_hit(*k.world, {0, -90000, 1.3}, {0, 1, 0}, "sphere", 89999.6, {0, -0.8, 0.6});
  expect_hit(*k.world, {20.25, 0, 90001}, {0, 0, -1}, "box", 90000 - 0.125, {0, 0, 1});
}

TEST(Ray, EndsAtItsRange) {
  const Kinds k;
  RayHit hit;
  EXPECT_TRUE(cast_ray(*k.world, {0, 0, 3}, {0, 0, -1}, 1.5001, &hit));
  EXPECT_FALSE(cast_ray(*k.world, {0, 0, 3}, {0, 0, -1}, 1.4999, &hit));
  EXPECT_TRUE(cast_ray(*k.world, {5, 0, 3}, {0, 0, -1}, 3, &hit));
  EXPECT_FALSE(cast_ray(*k.world, {5, 0, 3}, {0, 0, -1}, 2.999, &hit));
  EXPECT_FALSE(cast_ray(*k.world, {5, 0, 3}, {0, 0, 1}, kFar, &hit));
  EXPECT_FALSE(cast_ray(*k.world, {0, 0, 3}, {0, 0, 1}, kFar, &hit));  // it is behind
}

// From within a shape, or from its surface outwards, it is not met.
TEST(Ray, LooksOutOfWhatHoldsIt) {
  const Kinds k;
  expect_hit(*k.world, {0, 0, 1}, {0, 0, -1}, "ground", 1, {0, 0, 1});
  expect_hit(*k.world, {20, 0, 1}, {0, 0, -1}, "ground", 1, {0, 0, 1});
  Stream draw(1, 0, Purpose::kReset);
  int32_t met = 0;
  for (int i = 0; i < 3000; ++i) {
    const double x = 10 * draw.below(6);
    const Vec3 from = Vec3{x, 0, 1} + 2 * Vec3{draw.signed_unit(), draw.signed_unit(), draw.signed_unit()};
    const Vec3 to = Vec3{x, 0, 1} + 0.1 * Vec3{draw.signed_unit(), draw.signed_unit(), draw.signed_unit()};
    if (from.z < 0.1) continue;
    RayHit hit, again;
    if (!cast_ray(*k.world, from, normalized(to - from), kFar, &hit)) continue;
    ++met;
    EXPECT_NEAR(norm(hit.n), 1, 1e-12);
    EXPECT_LT(dot(hit.n, normalized(to - from)), 1e-5);
    EXPECT_NEAR(norm(hit.p - (from + hit.distance * normalized(to - from))), 0, 1e-12);
    const bool reflected = cast_ray(*k.world, hit.p + 1e-5 * hit.n, hit.n, kFar, &again);
    EXPECT_TRUE(!reflected || again.shape != hit.shape);
  }
  EXPECT_GT(met, 1000);
}

}  // namespace
}  // namespace rdm
