// Objects of several shapes in the engines, in pictures and where a start is looked for.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "objects/objects.hpp"
#include "sense/render/raycast.hpp"
#include "sense/scene_shapes.hpp"
#include "two_hands.hpp"

namespace rdm {
namespace {

SceneDef on_ground(const char* name, double height, const Quat& q = {}) {
  SceneDef def;
  const ObjectRef object(find_object(name));
  def.bodies.push_back(make_object_body(*object, "object", {{0, 0, height}, q}));
  def.bodies[0].angular_damping = 0.1;
  ShapeDef ground;
  ground.name = "ground";
  ground.kind = ShapeKind::kPlane;
  def.statics.push_back(ground);
  return def;
}

// What moves along a way out of the world, J.
double energy(const World& world) {
  const Motion& m = world.body(0);
  const Inertia& inertia = world.scene().def.bodies[0].inertia;
  const Vec3 w = rotate(conjugate(m.X.q), m.w);
  const Mat3 i = moment_matrix(inertia);
  return 0.5 * inertia.mass * dot(m.v, m.v) + 0.5 * dot(w, i * w) + 9.81 * inertia.mass * m.X.p.z;
}

// From 0.3 m: no energy comes out of nothing, and after four seconds it lies, in neither engine within the
// ground.
TEST(CompoundBody, EveryObjectFallsAndLies) {
  for (const EngineKind engine : {EngineKind::kArticulated, EngineKind::kOde})
    for (int32_t i = 0; i < num_objects(); ++i) {
      const char* name = ObjectRef(i)->name;
      test::Simulation sim(on_ground(name, 0.3, axis_angle({1, 0, 0}, 0.3)), engine);
      const double mass = sim.scene().def.bodies[0].inertia.mass;
      double most = energy(*sim);
      const double first = most;
      for (int k = 0; k < 240; ++k) {
        sim->step();
        most = std::max(most, energy(*sim));
      }
      EXPECT_EQ(sim->status() & kStatusDiverged, 0u) << name;
      EXPECT_LT(most, first + 0.02 * 9.81 * mass) << name;
      EXPECT_LT(sim->body_overlap(0), 0.002) << name;
      EXPECT_GT(sim->num_contacts(), 0) << name;
      EXPECT_GT(sim->body(0).X.p.z, 0) << name;
      EXPECT_LT(std::abs(sim->body(0).v.z), 0.1) << name;  // balls roll on, an egg rocks
    }
}

TEST(CompoundBody, StandsUprightWhereItIsPut) {
  for (const EngineKind engine : {EngineKind::kArticulated, EngineKind::kOde})
    for (const char* name : {"mug_with_handle", "bowl", "pitcher_base", "plate", "cup_j", "bleach_cleanser",
                             "wine_glass", "skillet_lid", "timer"}) {
      const ObjectRef object(find_object(name));
      const double height = object_inertia(*object).com.z;  // its table begins at the foot
      test::Simulation sim(on_ground(name, height), engine);
      uint32_t status = 0;
      for (int k = 0; k < 120; ++k) {
        sim->step();
        status |= sim->status();
      }
      EXPECT_EQ(status & kStatusContactOverflow, 0u) << name;
      const Motion& m = sim->body(0);
      EXPECT_GT(rotate(m.X.q, {0, 0, 1}).z, 0.9995) << name;
      EXPECT_NEAR(m.X.p.z, height, 0.002) << name;
      EXPECT_LT(norm(m.v), 0.01) << name;
    }
}

// A ball that is let go in a bowl stays in it: hollow things are hollow.
TEST(CompoundBody, ABallStaysInTheBowl) {
  for (const EngineKind engine : {EngineKind::kArticulated, EngineKind::kOde}) {
    const ObjectRef bowl(find_object("bowl")), ball(find_object("golf_ball"));
    SceneDef def = on_ground("bowl", object_inertia(*bowl).com.z);
    def.bodies.push_back(make_object_body(*ball, "ball", {{0.02, 0, 0.045}, {}}));
    def.bodies[1].angular_damping = 2;
    test::Simulation sim(std::move(def), engine);
    for (int k = 0; k < 240; ++k) sim->step();
    const Vec3 p = sim->body(1).X.p - sim->body(0).X.p;
    EXPECT_LT(std::hypot(p.x, p.y), 0.045);
    EXPECT_LT(sim->body(1).X.p.z, 0.05);
    EXPECT_GT(sim->body(1).X.p.z, 0.02);
    EXPECT_EQ(sim->status() & kStatusContactOverflow, 0u);
  }
}

TEST(CompoundBody, OverlapIsOfItsDeepestShape) {
  for (const EngineKind engine : {EngineKind::kArticulated, EngineKind::kOde}) {
    test::Simulation sim(on_ground("hammer", 0.5), engine);
    const ObjectRef hammer(find_object("hammer"));
    const double foot = 0.312 + object_inertia(*hammer).com.z;  // the end of its handle, under the centre
    EXPECT_EQ(sim->body_overlap(0), 0);
    sim->set_body(0, {{{0, 0, foot + 0.001}, {}}, {}, {}});
    EXPECT_EQ(sim->body_overlap(0), 0);
    sim->set_body(0, {{{0, 0, foot - 0.01}, {}}, {}, {}});
    EXPECT_NEAR(sim->body_overlap(0), 0.01, 1e-6);
  }
}

// Two ways to the same solid: a box, and two boxes.
TEST(CompoundBody, PartsFlyAndTurnAsTheWhole) {
  const ObjectShape whole{ShapeKind::kBox, {0.05, 0.02, 0.03}, {}, {}, {}};
  const ObjectShape halves[] = {{ShapeKind::kBox, {0.02, 0.02, 0.03}, {-0.03, 0, 0}, {}, {}},
                                {ShapeKind::kBox, {0.03, 0.02, 0.03}, {0.02, 0, 0}, {}, {}}};
  Motion end[2];
  for (int k = 0; k < 2; ++k) {
    Object o{};
    o.name = "box", o.mass = 0.3;
    o.shapes = k ? table(halves) : Table<ObjectShape>{&whole, 1};
    SceneDef def;
    def.bodies.push_back(make_object_body(o, "object", {{0, 0, 1}, {}}));
    test::Simulation sim(std::move(def), EngineKind::kArticulated);
    sim->set_body(0, {{{0, 0, 1}, {}}, {0.3, 0, 1}, {5, 1, 3}});
    for (int s = 0; s < 60; ++s) sim->step();
    end[k] = sim->body(0);
  }
  EXPECT_LT(norm(end[0].X.p - end[1].X.p), 1e-5);
  EXPECT_LT(norm(end[0].w - end[1].w), 1e-3);
}

TEST(CompoundBody, AllItsShapesAreSeen) {
  test::Simulation sim(on_ground("mug_with_handle", 0.05));
  const auto count = static_cast<int32_t>(sim.scene().shapes.size());
  std::vector<RenderShape> shapes(sim.scene().shapes.size());
  ASSERT_EQ(gather_shapes(*sim, shapes.data()), count);
  Arena measure;
  carve_raycast_scratch(measure, count);
  Arena arena(HostHooks{}, measure.used());
  const RaycastScratch scratch = carve_raycast_scratch(arena, count);
  std::vector<bool> seen(sim.scene().shapes.size());
  for (const Vec3& eye : {Vec3{0.3, 0.1, 0.3}, {-0.3, -0.2, 0.2}, {0.2, -0.3, 0.1}, {-0.1, 0.3, 0.1}}) {
    std::vector<int32_t> segmentation(160 * 160);
    Image image{160, 160, nullptr, nullptr, segmentation.data()};
    Camera camera;
    camera.eye = eye, camera.target = {0, 0, 0.04}, camera.fov_y = 40 * kDegree;
    render(shapes.data(), count, camera, image, {}, scratch);
    for (const int32_t id : segmentation)
      if (id >= 0) seen[static_cast<size_t>(id)] = true;
  }
  for (size_t i = 1; i < seen.size(); ++i) EXPECT_TRUE(seen[i]) << i;  // 0 is the inside of its foot
}

}  // namespace
}  // namespace rdm
