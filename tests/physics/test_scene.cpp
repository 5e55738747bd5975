#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>

#include "base/error.hpp"
#include "physics/model/inertia.hpp"
#include "physics/model/scene.hpp"
#include "two_hands.hpp"

namespace rdm {
namespace {

Code code_of(const std::function<void(SceneDef&)>& spoil) {
  SceneDef def = test::two_hands_def();
  spoil(def);
  try {
    make_scene(std::move(def));
    return Code::kOk;
  } catch (const Error& e) {
    EXPECT_GT(std::strlen(e.text), 0u);
    return e.code;
  }
}

TEST(Scene, NumbersLinksAndShapesInOneRow) {
  const Scene scene = make_scene(test::two_hands_def());
  EXPECT_EQ(scene.num_links, 48);
  EXPECT_EQ(scene.num_bodies, 1);
  EXPECT_EQ(scene.link_offset[1], 24);
  EXPECT_EQ(scene.shapes.size(), 20u + 20u + 1u + 1u);
  EXPECT_EQ(scene.sensors.size(), 10u);
  EXPECT_TRUE(scene.link(24).name == "left_wrist");
  EXPECT_EQ(scene.frames[25].parent, 24);
  EXPECT_EQ(scene.frames[24].parent, -1);
  EXPECT_EQ(scene.shapes[0].carrier, Carrier::kBase);
  EXPECT_EQ(scene.shapes[1].carrier, Carrier::kLink);
  EXPECT_EQ(scene.shapes[40].carrier, Carrier::kBody);
  EXPECT_EQ(scene.shapes[41].carrier, Carrier::kStatic);
  EXPECT_EQ(test::find_link(scene, 1, "left_palm"), 25);
  EXPECT_EQ(scene.find_shape("ground"), 41);
  EXPECT_THROW(scene.find_shape("wall"), Error);
  EXPECT_DOUBLE_EQ(scene.control_dt(), 1.0 / 60);
}

TEST(Scene, PairsAreSelfPairsAndTheBodyWithEverything) {
  const Scene scene = make_scene(test::two_hands_def());
  // 18 in each hand; the ball with 40 hand shapes and the ground; no finger reaches the ground.
  EXPECT_EQ(scene.pairs.size(), 18u + 18u + 41u);
  for (const ShapePair& pair : scene.pairs) {
    EXPECT_TRUE(scene.moves(scene.shapes[static_cast<size_t>(pair.a)]));
    EXPECT_NE(pair.a, pair.b);
  }
  EXPECT_LT(scene.pairs.back().reach, 0);  // the ground
}

TEST(Scene, HandsTouchEachOtherOnlyWhenAsked) {
  test::TwoHands c;
  c.hand_hand = true;
  const Scene scene = make_scene(test::two_hands_def(c));
  // 20 x 20 pairs, but two fixed forearms cannot meet, nor a forearm the shapes that cannot reach it.
  size_t across = 0;
  for (const ShapePair& pair : scene.pairs) {
    const SceneShape &a = scene.shapes[static_cast<size_t>(pair.a)],
                     &b = scene.shapes[static_cast<size_t>(pair.b)];
    across += a.articulation >= 0 && b.articulation >= 0 && a.articulation != b.articulation;
    EXPECT_FALSE(a.carrier == Carrier::kBase && b.carrier == Carrier::kBase);
  }
  EXPECT_GE(across, 19u * 19u);
  EXPECT_LT(across, 400u);
}

TEST(Scene, ShapesOutOfReachOfAFixedHandAreLeftOut) {
  const auto ground_pairs = [](double z) {
    SceneDef def;
    def.articulations.push_back(make_articulation(kShadowHand, Side::kRight, {{0, 0, z}, {}}, ""));
    ShapeDef ground;
    ground.kind = ShapeKind::kPlane;
    def.statics.push_back(ground);
    return make_scene(std::move(def)).pairs.size() - 18u;
  };
  EXPECT_EQ(ground_pairs(0.6), 0u);
  EXPECT_EQ(ground_pairs(0.1), 19u);
}

TEST(Scene, FrictionComesFromTheMaterialTable) {
  SceneDef def = test::two_hands_def();
  def.num_materials = 2;
  def.friction[0][1].mu = def.friction[1][0].mu = 0.25;
  def.bodies[0].shapes[0].material = 1;
  const Scene scene = make_scene(std::move(def));
  for (const ShapePair& pair : scene.pairs) {
    const bool ball = pair.a == 40 || pair.b == 40;
    EXPECT_EQ(pair.mu, ball ? 0.25 : 1.0);
  }
}

TEST(Scene, ShapesThatDoNotCollideHaveNoPairs) {
  SceneDef def = test::two_hands_def();
  def.bodies[0].shapes[0].collides = false;
  EXPECT_EQ(make_scene(std::move(def)).pairs.size(), 36u);
}

TEST(Scene, NamesAreCut) {
  const Name name("a name that is longer than thirty-one characters");
  EXPECT_EQ(std::strlen(name.text), static_cast<size_t>(kNameSize - 1));
  EXPECT_TRUE(Name("palm") == "palm");
}

TEST(Scene, RefusesWhatCannotBeSimulated) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code_of([](SceneDef&) {}), Code::kOk);
  EXPECT_EQ(code_of([](SceneDef& d) { d.solver.iterations = 1001; }), Code::kRange);
  EXPECT_EQ(code_of([](SceneDef& d) { d.solver.substeps = 0; }), Code::kRange);
  EXPECT_EQ(code_of([](SceneDef& d) { d.solver.contacts_max = -1; }), Code::kRange);
  EXPECT_EQ(code_of([](SceneDef& d) { d.solver.contacts_max = 4097; }), Code::kRange);
  EXPECT_EQ(code_of([&](SceneDef& d) { d.solver.h = nan; }), Code::kRange);
  EXPECT_EQ(code_of([&](SceneDef& d) { d.gravity.z = nan; }), Code::kArgument);
  EXPECT_EQ(code_of([](SceneDef& d) { d.friction[0][0].mu = -1; }), Code::kRange);
  EXPECT_EQ(code_of([](SceneDef& d) { d.num_materials = 2, d.friction[0][1].mu = 0.5; }), Code::kArgument);
  EXPECT_EQ(code_of([](SceneDef& d) { d.articulations[0].links[3].parent = 3; }), Code::kArgument);
  EXPECT_EQ(code_of([](SceneDef& d) {
              d.articulations[0].links[3].joint.axis = {0, 0, 2};
            }),
            Code::kArgument);
  EXPECT_EQ(code_of([&](SceneDef& d) { d.articulations[0].links[3].joint.kp = nan; }), Code::kRange);
  EXPECT_EQ(code_of([](SceneDef& d) { d.articulations[0].links[3].joint.upper = -1; }), Code::kRange);
  EXPECT_EQ(code_of([](SceneDef& d) { d.articulations[0].links[3].joint.coupled_to = 3; }), Code::kArgument);
  EXPECT_EQ(code_of([](SceneDef& d) { d.articulations[0].links[3].inertia.moment[0] = -1; }),
            Code::kArgument);
  EXPECT_EQ(code_of([](SceneDef& d) { d.articulations[0].links[3].X_PL.q = {0, 0, 0, 0}; }), Code::kArgument);
  EXPECT_EQ(code_of([](SceneDef& d) { d.articulations[0].shapes[1].link = 24; }), Code::kArgument);
  EXPECT_EQ(code_of([](SceneDef& d) { d.articulations[0].shapes[1].shape.size = {}; }), Code::kRange);
  EXPECT_EQ(code_of([](SceneDef& d) { d.articulations[0].shapes[1].shape.kind = ShapeKind::kPlane; }),
            Code::kArgument);
  EXPECT_EQ(code_of([](SceneDef& d) { d.articulations[0].self_pairs[0].first = 20; }), Code::kArgument);
  EXPECT_EQ(code_of([](SceneDef& d) { d.bodies[0].inertia.mass = 0; }), Code::kRange);
  EXPECT_EQ(code_of([](SceneDef& d) { d.bodies[0].inertia.com = {0.1, 0, 0}; }), Code::kArgument);
  EXPECT_EQ(code_of([](SceneDef& d) { d.bodies[0].shapes[0].material = 1; }), Code::kRange);
  EXPECT_EQ(code_of([&](SceneDef& d) { d.bodies[0].X_WB.p.x = nan; }), Code::kArgument);
  EXPECT_EQ(code_of([](SceneDef& d) { d.articulations.clear(), d.bodies.clear(); }), Code::kArgument);
}

TEST(Scene, MaterialsMayPassEachOther) {
  const auto pairs = [](bool passes) {
    SceneDef def;
    def.num_materials = 2;
    def.friction[0][1].passes = def.friction[1][0].passes = passes;
    for (int32_t material : {0, 1}) {
      BodyDef body;
      body.inertia = sphere_inertia(1, 0.1);
      ShapeDef shape;
      shape.size = {0.1, 0, 0};
      shape.material = material;
      body.shapes.push_back(shape);
      def.bodies.push_back(body);
    }
    return make_scene(std::move(def)).pairs.size();
  };
  EXPECT_EQ(pairs(false), 1u);
  EXPECT_EQ(pairs(true), 0u);
  SceneDef def;
  def.num_materials = 2;
  def.friction[0][1].passes = true;
  EXPECT_EQ(guard([&] { make_scene(std::move(def)); }), Code::kArgument);
}

}  // namespace
}  // namespace rdm
