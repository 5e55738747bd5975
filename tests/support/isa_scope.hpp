// Steppers of another instruction set for the length of a test.
#pragma once

#include <string>

#include "base/cpu.hpp"
#include "physics/articulated/stepper.hpp"

namespace rdm {

// Puts the choice of instruction set back.
class IsaScope {
 public:
  ~IsaScope() { set_stepper_isa(before_.c_str()); }

 private:
  std::string before_ = stepper_isa();
};

}  // namespace rdm
