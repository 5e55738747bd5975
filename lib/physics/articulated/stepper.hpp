// The arithmetic of a control step in generalised coordinates, for one scalar type, lane count and
// instruction set. The results have the same bits for all lane counts and instruction sets.
//
// The stepper is written once, as a template over lanes (stepper.inl), and compiled once per instruction set
// (stepper_v*.cpp), as Box2D does with its wide contact solver. It reads the model and reads and writes the
// worlds' data it is handed; it calls nobody back.
#pragma once
#include "base/arena.hpp"
#include "physics/articulated/world_state.hpp"

namespace rdm {

inline constexpr int32_t kMostLanes = 16;

class Stepper;

struct StepperKind {
  bool double_precision = false;  // the reference: one lane
  int32_t lanes = 1;              // 1, 4, 8 or 16 floats; 16 are 8 where the set has not so many
  // Contacts are solved in the memory of `lender`, of the same scene, precision and table, which must outlive this
  // stepper; the two never step at the same time. While the arena measures, lender is null.
  bool borrows = false;
  Stepper* lender = nullptr;
};

class Stepper {
 public:
  virtual ~Stepper() = default;
  virtual int32_t group_size() const = 0;  // worlds that fill the lanes
  // One control step of `count` worlds, at most group_size().
  virtual void step(WorldState* const* worlds, int32_t count) = 0;
  // Joints or base were set from outside: kinematics and momenta follow.
  virtual void refresh(WorldState* world, int32_t articulation) = 0;
  virtual void read_link(const WorldState& world, int32_t link, Motion* m) const = 0;
  virtual Mat3 link_rotation(const WorldState& world, int32_t link) const = 0;  // R_WL
  // Ends the object, which came from these hooks.
  virtual void end(const HostHooks& hooks) = 0;
};

// kBaseIsa, kV3Isa, kV4Isa (base/cpu.hpp): what steppers made from now on use; false where this machine or
// build has it not.
bool set_stepper_isa(const char* name);
const char* stepper_isa();
int32_t widest_lanes();  // of that set: 8, or 16

// The steppers of one instruction set: what stepper_v*.cpp hand to stepper.cpp.
struct StepperTable {
  const char* isa = nullptr;  // null: not in this build
  int32_t lanes = 0;          // the most
  // Arrays come out of `arena` and the object out of the hooks; while the arena measures, null. `model` and
  // `collider` must outlive it.
  Stepper* (*make)(const StepperKind& kind, const ArticulatedModel& model, Collider* collider,
                   const HostHooks& hooks, Arena& arena) = nullptr;
};
// Of the best instruction set of this machine, or the one chosen by set_stepper_isa.
StepperTable best_steppers();
StepperTable steppers_v2();
StepperTable steppers_v3();
StepperTable steppers_v4();

}  // namespace rdm
