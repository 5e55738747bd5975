// Steppers for the oldest supported machine, and for machines other than x86-64.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#include "base/cpu.hpp"
#include "physics/articulated/stepper.hpp"
#include "physics/articulated/stepper.inl"
#include "physics/model/drive.hpp"

namespace rdm {
StepperTable steppers_v2() {
  return stepper_table(kBaseIsa);
}
}  // namespace rdm
