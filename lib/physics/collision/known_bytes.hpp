// Whether ODE and libccd compute the bytes here that they compute where the recorded hashes come from.
//
// Both are compiled by others: with fused multiply-adds (GCC's way on ARM, POWER and RISC-V), another version
// or another option they round otherwise, and worlds with contacts go other ways than on every other machine.
#pragma once

namespace rdm {

struct KnownBytes {
  bool ode = false;  // as recorded
  bool ccd = false;
};
// From contacts of a few fixed pairs of shapes, found at the first call, in some tens of microseconds.
// Error(kMemory); Error(kVersion) for an ODE of single precision.
const KnownBytes& known_bytes();

}  // namespace rdm
