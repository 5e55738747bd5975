// The scene of the physics tests: two Shadow Hands face each other, a ball above the right one.
#pragma once
#include <gtest/gtest.h>

#include <cmath>

#include "base/arena.hpp"
#include "physics/model/inertia.hpp"
#include "physics/world.hpp"
#include "robot/robot.hpp"

namespace rdm::test {

struct TwoHands {
  SolverDef solver;
  double ball_mass = 0.05, ball_radius = 0.035;
  bool hand_hand = false;
  bool ball = true;
};

inline SceneDef two_hands_def(const TwoHands& c = {}) {
  SceneDef def;
  def.solver = c.solver;
  def.articulations_touch = c.hand_hand;
  def.articulations.push_back(make_articulation(kShadowHand, Side::kRight, {{0, 0, 0.5}, {}}, "right_"));
  def.articulations.push_back(
      make_articulation(kShadowHand, Side::kLeft, {{0, -1, 0.5}, {0, 1, 0, 0}}, "left_"));
  if (c.ball) {
    BodyDef ball;
    ball.name = "ball";
    ball.X_WB.p = {0, -0.35, 0.56};
    ball.inertia = sphere_inertia(c.ball_mass, c.ball_radius);
    ShapeDef shape;
    shape.name = "ball";
    shape.size = {c.ball_radius, 0, 0};
    ball.shapes.push_back(shape);
    def.bodies.push_back(ball);
  }
  ShapeDef ground;
  ground.name = "ground";
  ground.kind = ShapeKind::kPlane;
  def.statics.push_back(ground);
  return def;
}

// Owns a world and the arena it lives in. Error(kUnsupported) for an engine this build has not.
class Simulation {
 public:
  explicit Simulation(SceneDef def, EngineKind kind = EngineKind::kOde) : scene_(make_scene(std::move(def))) {
    Arena measure;
    World::measure(kind, scene_, measure);
    arena_ = Arena(HostHooks{}, measure.used());
    world_ = World::create(kind, scene_, arena_, HostHooks{});
  }
  ~Simulation() { World::destroy(world_, HostHooks{}); }
  Simulation(const Simulation&) = delete;
  Simulation& operator=(const Simulation&) = delete;
  World* operator->() { return world_; }
  World& operator*() { return *world_; }
  const Scene& scene() const { return scene_; }
  const Arena& arena() const { return arena_; }

 private:
  Scene scene_;
  Arena arena_;
  World* world_ = nullptr;
};

// Flat index of an articulation's link; fails the test where there is none of that name.
inline int32_t find_link(const Scene& scene, int32_t articulation, const char* name) {
  const auto a = static_cast<size_t>(articulation);
  const auto& links = scene.def.articulations[a].links;
  for (size_t i = 0; i < links.size(); ++i)
    if (links[i].name == name) return scene.link_offset[a] + static_cast<int32_t>(i);
  ADD_FAILURE() << "no link " << name;
  return 0;
}

// A hand held like a cup, share of each joint's range.
inline constexpr double kCup[24] = {0.8296, 0.5388, 0.3960, 0.5599, 0.5721, 0.5004, 0.3450, 0.5667,
                                    0.0009, 0.5639, 0.6649, 0.0613, 0.3113, 0.3295, 0.6505, 0.5976,
                                    0.5812, 0.4666, 0.5956, 0.8588, 0.0534, 0.3989, 0.3624, 0.0385};

inline void target_share(World& world, int32_t articulation, const double* share) {
  const int32_t first = world.scene().link_offset[static_cast<size_t>(articulation)];
  for (int32_t i = 0; i < 24; ++i) {
    const JointDef& joint = world.scene().link(first + i).joint;
    world.target()[first + i] = joint.lower + share[i] * (joint.upper - joint.lower);
  }
}

}  // namespace rdm::test
