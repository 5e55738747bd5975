// The steppers of one instruction set.
#pragma once
#include "physics/articulated/stepper.hpp"

namespace rdm {

struct StepperTable {
  const char* isa = nullptr;  // null: not in this build
  Stepper* (*make)(const StepperKind& kind, const Scene& scene, ArticulatedShared& shared,
                   Arena& arena) = nullptr;
};

StepperTable steppers_v2();
StepperTable steppers_v3();

}  // namespace rdm
