#include "nn/kernels.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>

namespace rdm {
namespace {

const Kernels* usable_v3() {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) return kernels_v3();
#endif
  return nullptr;
}

const Kernels* usable_v4() {
#if defined(__x86_64__)
  if (usable_v3() && __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl"))
    return kernels_v4();
#endif
  return nullptr;
}

const Kernels* best() {
#if defined(__x86_64__)
  __builtin_cpu_init();  // a host's static objects may come here before the runtime has
#endif
  if (const Kernels* k = usable_v4()) return k;
  if (const Kernels* k = usable_v3()) return k;
  return kernels_v2();
}

std::atomic<const Kernels*> chosen{nullptr};

}  // namespace

const Kernels& kernels() {
  const Kernels* k = chosen.load(std::memory_order_acquire);
  if (!k) {
    const Kernels* none = nullptr;
    const Kernels* b = best();
    chosen.compare_exchange_strong(none, b);
    k = none ? none : b;
  }
  return *k;
}

const char* kernel_isa() {
  return kernels().isa;
}

bool set_kernel_isa(const char* name) {
  for (const Kernels* k : {kernels_v2(), usable_v3(), usable_v4()})
    if (k && std::strcmp(k->isa, name) == 0) {
      chosen.store(k, std::memory_order_release);
      return true;
    }
  return false;
}

size_t gemm_pack_floats(int32_t n, int32_t k) {
  const auto columns = static_cast<size_t>(std::min((n + 15) / 16 * 16, kPackColumns));
  return columns * static_cast<size_t>(std::min(k, kPackDepth));
}

}  // namespace rdm
