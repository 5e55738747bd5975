// Steppers for the oldest supported machine, and for machines other than x86-64.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "physics/articulated/stepper.hpp"
#include "physics/articulated/stepper.inl"
#include "physics/model/drive.hpp"

namespace rdm {
StepperTable steppers_v2() {
  return stepper_table("x86-64-v2");
}
}  // namespace rdm
