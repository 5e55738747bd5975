#include "base/cpu.hpp"

namespace rdm {
namespace {

Cpu ask() {
  Cpu c;
#if defined(__x86_64__) && !defined(RDM_BASE_CPU)  // check.sh older: as if it had none of them
  __builtin_cpu_init();  // a host's static objects may come here before the runtime has
  c.carryless = __builtin_cpu_supports("pclmul") && __builtin_cpu_supports("sse4.1");
  c.avx2 = __builtin_cpu_supports("avx2");
  c.v3 = c.avx2 && __builtin_cpu_supports("fma");
  c.v4 = c.v3 && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
         __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
#endif
  return c;
}

}  // namespace

const Cpu& cpu() {
  static const Cpu asked = ask();
  return asked;
}

}  // namespace rdm
