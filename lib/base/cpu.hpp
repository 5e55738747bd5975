// What the processor has of the instruction sets that the library has code for; the one place that asks it.
//
// Code for one set stands in a source of its own (articulated/stepper_v3.cpp, nn/kernels_v4.cpp) that hands
// out a table of functions with the set's name; who owns the tables takes the best that the processor runs.
#pragma once

namespace rdm {

// Names of the sets. The base set is what our flags compile everything for: x86-64-v2, or what the compiler
// assumes of other processors.
#if defined(__x86_64__)
inline constexpr const char* kBaseIsa = "x86-64-v2";
#else
inline constexpr const char* kBaseIsa = "base";
#endif
inline constexpr const char* kV3Isa = "x86-64-v3";
inline constexpr const char* kV4Isa = "x86-64-v4";

struct Cpu {
  bool carryless = false;  // PCLMULQDQ and SSE4.1
  bool avx2 = false;
  bool v3 = false;  // AVX2 and FMA
  bool v4 = false;  // these, and AVX-512 F, BW, DQ and VL
};
const Cpu& cpu();  // asked once

}  // namespace rdm
