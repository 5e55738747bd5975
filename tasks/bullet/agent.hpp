// What an agent of Bullet-Safety-Gym is to the four tasks, Run, Circle, Gather and Reach: a struct A of
// constants and static functions. A task is a template over it, so an agent is one file and a task is one.
//
//   State                          of one world, plain; joins the task's own struct, first in it
//   kEngine, kActions, kActionOrder, kFields (AgentField[]), kSteps (of an episode), kSpeedLimit (m/s),
//   kSize (m, radius of the disc that collides), kPillars (obstacles of Reach stand up), kBodies (of the
//   scene that are the agent)
//   add(scene, drive)              its bodies, first of all in the scene
//   check(state)                   of a saved state: Error(kFormat)
//   start(at, stream, world, s)    a new episode
//   act(action, drive, world, s)   one control step, or what the engine needs to make it
//   show(world, s)                 puts its bodies where it is
//   settle(world, s)               after the step, before anyone looks: what it notes of the contacts
//   look, heading, effort, alive   after the step: where it is; cos and sin of its yaw; what it adds to the
//                                  rewards; whether its episode goes on
//   block(nx, ny, depth, away, s)  of one without an engine: back by `depth` m from what lies in direction n
//                                  and moves in it at `away` m/s
//   write(world, s, out)           its observation
#pragma once
#include <cmath>

#include "base/elementary.hpp"
#include "base/option.hpp"
#include "tasks/planar/planar_scene.hpp"

namespace rdm {

inline constexpr double kBulletDt = 1.0 / 60;     // s, a control step
inline constexpr double kAgentHeightLimit = 2.0;  // m; higher costs 1 in Gather and Reach

struct AgentField {
  const char* name;
  const char* unit;
  int32_t count;
  float low = kUnbounded, high = kUnbounded;
};
struct AgentStart {
  double x, y, yaw;  // m, rad
};
struct AgentPlace {
  double x, y, z, vx, vy, speed;  // m; m/s, speed in the plane
};
// Substeps of a control step; in the rooms of Gather and Reach the car has motors of its own.
struct AgentDrive {
  int32_t substeps;
  bool room;
};
inline constexpr AgentDrive kOpenDrive{4, false}, kGatherDrive{4, true}, kReachDrive{1, true};

// Cos and sin of the yaw of a body with its nose along x; of one that points straight up: 0.
inline elementary::SinCos flat_heading(const Quat& q) {
  const Vec3 nose = to_matrix(q).col(0);
  const double flat = std::sqrt(nose.x * nose.x + nose.y * nose.y);
  if (flat == 0) return {0, 1};
  return {nose.y / flat, nose.x / flat};
}

// The part of a task that follows from its agent.
template <class A>
class AgentTask : public PlanarTask {
 public:
  EngineKind engine() const override { return A::kEngine; }
  int32_t action_dim() const override { return A::kActions; }
  const char* action_order() const override { return A::kActionOrder; }

 protected:
  AgentTask(Scene&& scene, int32_t max_steps, std::initializer_list<FieldSpec> more = {})
      : PlanarTask(std::move(scene), max_steps, {}) {
    for (const AgentField& f : A::kFields) add({f.name, f.unit, f.count, f.low, f.high});
    for (const FieldSpec& f : more) add(f);
  }
  static constexpr int32_t kAgentObs = [] {
    int32_t sum = 0;
    for (const AgentField& f : A::kFields) sum += f.count;
    return sum;
  }();
};

}  // namespace rdm
