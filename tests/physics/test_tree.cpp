#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "articulated.hpp"
#include "base/error.hpp"
#include "physics/articulated/tree.hpp"

namespace rdm {
namespace {

Code code_of(const SceneDef& def) {
  const Scene scene = make_scene(def);
  try {
    (void)make_trees(scene);
  } catch (const Error& e) {
    return e.code;
  }
  return Code::kOk;
}

// `count` links one after the other, each 0.1 m along z from the last; axes along y.
SceneDef chain(int count) {
  ArticulationDef arm;
  for (int i = 0; i < count; ++i) {
    LinkDef link;
    link.parent = i - 1;
    link.X_PL.p = {0, 0, 0.1};
    link.inertia = box_inertia(0.1, {0.01, 0.02, 0.05});
    link.joint.axis = {0, 1, 0};
    link.joint.lower = -1;
    link.joint.upper = 1;
    arm.links.push_back(link);
  }
  SceneDef def;
  def.articulations.push_back(arm);
  return def;
}

// Every coordinate's row: its ancestors by the links' parents, root first, itself last.
void expect_paths(const Tree& tree) {
  for (int32_t i = 0; i < tree.num_links; ++i) {
    std::vector<int32_t> path;
    for (int32_t k = i; k >= 0; k = tree.links[static_cast<size_t>(k)].parent) path.push_back(tree.coord(k));
    for (int32_t k = tree.free_base ? 5 : -1; k >= 0; --k) path.push_back(k);
    std::reverse(path.begin(), path.end());
    const auto c = static_cast<size_t>(tree.coord(i));
    ASSERT_EQ(tree.depth[c] + 1, static_cast<int32_t>(path.size())) << i;
    for (size_t d = 0; d < path.size(); ++d)
      EXPECT_EQ(tree.path[static_cast<size_t>(tree.row[c]) + d], path[d]) << i;
  }
}

// Segments are runs of a path: no slot twice, and a slot's neighbour below is its parent.
void expect_slots(const Tree& tree) {
  std::set<std::pair<int, int>> seen;
  for (int32_t c = 0; c < tree.num_coords; ++c) {
    const TreeSlot slot = tree.slots[static_cast<size_t>(c)];
    EXPECT_TRUE(seen.insert({slot.segment, slot.slot}).second) << c;
    EXPECT_LT(slot.slot, kSegment);
    EXPECT_LT(slot.segment, tree.num_segments);
    if (slot.slot == 0) continue;
    const auto last =
        static_cast<size_t>(tree.row[static_cast<size_t>(c)] + tree.depth[static_cast<size_t>(c)]);
    const TreeSlot parent = tree.slots[static_cast<size_t>(tree.path[last - 1])];
    EXPECT_EQ(parent.segment, slot.segment);
    EXPECT_EQ(parent.slot + 1, slot.slot);
  }
}

TEST(Tree, MirroredHandsAreMembersOfOne) {
  const Scene scene = make_scene(test::two_hands_def());
  const Vector<Tree> trees = make_trees(scene);
  ASSERT_EQ(trees.size(), 1u);
  const Tree& tree = trees[0];
  ASSERT_EQ(tree.members.size(), 2u);
  for (int32_t m = 0; m < 2; ++m) {
    const TreeMember& member = tree.members[static_cast<size_t>(m)];
    EXPECT_EQ(member.articulation, m);
    EXPECT_EQ(member.first_link, 24 * m);
    EXPECT_EQ(member.first_shape, scene.first_shape[static_cast<size_t>(m)]);
    EXPECT_EQ(member.links.size(), 24u);
    EXPECT_EQ(norm(member.gravity), 0);
  }
  EXPECT_EQ(tree.num_coords, 24);
  expect_paths(tree);
  expect_slots(tree);
}

TEST(Tree, AHandIsATrunkOfTwoWithFiveFingers) {
  const Tree tree = make_trees(make_scene(test::two_hands_def()))[0];
  EXPECT_EQ(tree.num_segments, 6);
  EXPECT_EQ(tree.path_segments, 2);
  EXPECT_EQ(tree.slots[0].segment, tree.slots[1].segment);
  for (const int32_t finger : {2, 6, 10, 14, 19}) EXPECT_EQ(tree.slots[static_cast<size_t>(finger)].slot, 0);
  EXPECT_EQ(tree.depth[5], 5);
  EXPECT_EQ(tree.depth[18], 6);
}

TEST(Tree, AFreeBaseAndItsTrunkAreOneSegment) {
  SceneDef def = test::two_hands_def();
  for (ArticulationDef& a : def.articulations) a.free_base = true;
  const Tree tree = make_trees(make_scene(def))[0];
  EXPECT_EQ(tree.num_coords, 30);
  EXPECT_EQ(tree.num_segments, 6);
  for (int16_t c = 0; c < 8; ++c) {
    EXPECT_EQ(tree.slots[static_cast<size_t>(c)].segment, 0);
    EXPECT_EQ(tree.slots[static_cast<size_t>(c)].slot, c);
  }
  expect_paths(tree);
  expect_slots(tree);
}

TEST(Tree, LongChainsAreCutIntoSegments) {
  const Tree tree = make_trees(make_scene(chain(20)))[0];
  EXPECT_EQ(tree.num_segments, 3);
  EXPECT_EQ(tree.path_segments, 3);
  expect_paths(tree);
  expect_slots(tree);
  EXPECT_EQ(code_of(chain(512)), Code::kOk);
  EXPECT_EQ(code_of(chain(513)), Code::kUnsupported);
}

TEST(Tree, EveryDifferenceOfBuildMakesATreeOfItsOwn) {
  const auto trees_with = [](auto change) {
    SceneDef def = test::two_hands_def();
    change(def.articulations[1]);
    return make_trees(make_scene(def)).size();
  };
  EXPECT_EQ(trees_with([](ArticulationDef& a) { a.links[3].joint.kp *= 2; }), 1u);
  EXPECT_EQ(trees_with([](ArticulationDef& a) { a.free_base = true; }), 2u);
  EXPECT_EQ(trees_with([](ArticulationDef& a) { a.links[4].sensor = true; }), 2u);
  EXPECT_EQ(trees_with([](ArticulationDef& a) { a.links[4].weightless = true; }), 2u);
  EXPECT_EQ(trees_with([](ArticulationDef& a) { a.links[5].joint.coupled_to = -1; }), 2u);
  EXPECT_EQ(trees_with([](ArticulationDef& a) { a.links[7].parent = 2; }), 2u);
  EXPECT_EQ(trees_with([](ArticulationDef& a) { a.links[7].joint.kind = JointKind::kPrismatic; }), 2u);
  EXPECT_EQ(trees_with([](ArticulationDef& a) { a.shapes[4].link = 2; }), 2u);
  EXPECT_EQ(trees_with([](ArticulationDef& a) { a.shapes[4].shape.kind = ShapeKind::kCylinder; }), 2u);
  EXPECT_EQ(trees_with([](ArticulationDef& a) { a.self_pairs.clear(), a.shapes.pop_back(); }), 2u);
}

TEST(Tree, JointFramesGiveTheLinksPlaces) {
  SceneDef def = test::two_hands_def();
  const Scene scene = make_scene(def);
  const Tree tree = make_trees(scene)[0];
  test::Simulation sim(def);  // all joints at 0
  for (const TreeMember& member : tree.members) {
    const Pose& X_WB = sim->base(member.articulation).X;
    std::vector<Mat3> R_WJ;
    std::vector<Vec3> p;
    for (int32_t i = 0; i < tree.num_links; ++i) {
      const MemberLink& bone = member.links[static_cast<size_t>(i)];
      const int32_t up = tree.links[static_cast<size_t>(i)].parent;
      const Mat3 R = up < 0 ? to_matrix(X_WB.q) : R_WJ[static_cast<size_t>(up)];
      p.push_back((up < 0 ? X_WB.p : p[static_cast<size_t>(up)]) + R * bone.p_PJ);
      R_WJ.push_back(R * bone.R_PJ);
      const Motion& link = sim->link(member.first_link + i);
      const JointDef& joint = scene.link(member.first_link + i).joint;
      EXPECT_LT(norm(p.back() - link.X.p), 1e-14) << i;
      EXPECT_LT(norm(bone.R_LJ * Vec3{0, 0, 1} - joint.axis), 1e-14) << i;
      EXPECT_LT(norm(R_WJ.back() * Vec3{0, 0, 1} - rotate(link.X.q, joint.axis)), 1e-14) << i;
      const Inertia& inertia = scene.link(member.first_link + i).inertia;
      EXPECT_LT(norm(bone.R_LJ * bone.inertia.com - inertia.com), 1e-15);
      const Mat3 moment = bone.R_LJ * moment_matrix(bone.inertia) * transpose(bone.R_LJ);
      for (int k = 0; k < 9; ++k) EXPECT_NEAR(moment.m[k], moment_matrix(inertia).m[k], 1e-15) << i;
    }
  }
}

TEST(Tree, ShortcutsHoldForAllMembersOrNone) {
  SceneDef def = test::two_hands_def();
  const auto link = [&](int32_t i) { return make_trees(make_scene(def))[0].links[static_cast<size_t>(i)]; };
  EXPECT_TRUE(link(4).aligned);   // about x, like its parent
  EXPECT_FALSE(link(3).aligned);  // about x, its parent about y
  EXPECT_TRUE(link(4).isotropic);
  def.articulations[1].links[4].X_PL.q = axis_angle({1, 0, 0}, 0.1);
  EXPECT_FALSE(link(4).aligned);
  def.articulations[0].links[4].inertia.moment[0] *= 1.5;
  EXPECT_FALSE(link(4).isotropic);
  EXPECT_TRUE(link(5).isotropic);
  EXPECT_FALSE(link(2).massless);
  def.articulations[0].links[2].inertia = {};
  EXPECT_FALSE(link(2).massless);
  def.articulations[1].links[2].inertia = {};
  EXPECT_TRUE(link(2).massless);
}

TEST(Tree, HeavyJointsHaveStifferEnds) {
  SceneDef def = test::two_hands_def();
  const auto hands = make_trees(make_scene(def))[0].members[0].links;
  EXPECT_GT(hands[0].limit_stiffness, 1000);  // the wrist, which carries the hand
  EXPECT_GT(hands[1].limit_stiffness, 1000);
  int32_t light = 0;
  for (const MemberLink& link : hands) {
    EXPECT_GE(link.limit_stiffness, 100);
    light += link.limit_stiffness == 100;
  }
  EXPECT_EQ(light, 21);  // but for the little finger's metacarpal
  def = chain(8);
  const auto links = make_trees(make_scene(def))[0].members[0].links;
  // all stretched out, the moment about the first axis
  double moment = 0;
  for (int i = 0; i < 8; ++i) moment += 0.1 * 0.01 * i * i;
  const double h2 = def.solver.h * def.solver.h;
  EXPECT_GT(links[0].limit_stiffness, 20 * moment / h2);
  EXPECT_LT(links[0].limit_stiffness, 21 * moment / h2);
  for (size_t i = 1; i < 8; ++i) EXPECT_LE(links[i].limit_stiffness, links[i - 1].limit_stiffness);
  EXPECT_EQ(links[7].limit_stiffness, 100);
  def.solver.limit_stiffness = 0;
  EXPECT_EQ(make_trees(make_scene(def))[0].members[0].links[0].limit_stiffness, 0);
}

TEST(Tree, ALinkNeedsInertiaSomewhereBehindIt) {
  SceneDef def = chain(3);
  def.articulations[0].links[1].inertia = {};
  EXPECT_EQ(code_of(def), Code::kOk);  // the third link moves with it
  def.articulations[0].links[2].inertia = {};
  EXPECT_EQ(code_of(def), Code::kRange);
  def.articulations[0].links[2].joint.armature = 1e-4;
  EXPECT_EQ(code_of(def), Code::kOk);
}

}  // namespace
}  // namespace rdm
