#include "nn/kernels.hpp"

#include <algorithm>
#include <atomic>
#include <cstring>

#include "base/cpu.hpp"

#ifndef RDM_WIDEST_KERNELS
#define RDM_WIDEST_KERNELS 4
#endif

namespace rdm {
namespace {

// What is wider than the build's widest is not even linked.
const Kernels* usable_v3() {
  return RDM_WIDEST_KERNELS >= 3 && cpu().v3 ? kernels_v3() : nullptr;
}
const Kernels* usable_v4() {
  return RDM_WIDEST_KERNELS >= 4 && cpu().v4 ? kernels_v4() : nullptr;
}
const Kernels* best() {
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

size_t gemm_pack_floats(int32_t n, int32_t k, int32_t pack_columns) {
  const auto columns = static_cast<size_t>(std::min((n + 15) / 16 * 16, pack_columns));
  return columns * static_cast<size_t>(std::min(k, kPackDepth));
}

}  // namespace rdm
