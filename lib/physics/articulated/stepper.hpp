// The arithmetic of a control step in generalised coordinates, for one scalar type, lane count and
// instruction set. The results have the same bits for all lane counts and instruction sets.
#pragma once
#include "base/arena.hpp"
#include "physics/world.hpp"

namespace rdm {

class ArticulatedWorld;
struct ArticulatedShared;

struct StepperKind {
  bool double_precision = false;  // the reference: one lane
  int32_t lanes = 1;              // 1, 4 or 8 floats
};

class Stepper {
 public:
  virtual ~Stepper() = default;
  virtual int32_t group_size() const = 0;  // worlds that fill the lanes
  virtual void step(ArticulatedWorld* const* worlds, int32_t count) = 0;
  // Joints or base were set from outside: kinematics and momenta follow.
  virtual void refresh(ArticulatedWorld& world, int32_t articulation) = 0;
  virtual void read_link(const ArticulatedWorld& world, int32_t link, Motion* m, Mat3* R) const = 0;
  // Ends the object, which came from these hooks.
  virtual void end(const HostHooks& hooks) = 0;
};

// Bytes of a world's kinematics and sets, and of the stepper's object itself.
size_t keep_bytes(const Scene& scene, bool double_precision);

// Arrays come out of `arena` and the object out of the shared hooks; while the arena measures, null.
// The best instruction set of this machine, or the one chosen by set_stepper_isa.
Stepper* make_stepper(const StepperKind& kind, const Scene& scene, ArticulatedShared& shared, Arena& arena);

// "x86-64-v2", "x86-64-v3": what steppers made from now on use; false where this machine or build has it not.
bool set_stepper_isa(const char* name);
const char* stepper_isa();

}  // namespace rdm
