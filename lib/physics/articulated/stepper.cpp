#include "physics/articulated/stepper.hpp"

#include <atomic>
#include <cstring>

#include "base/cpu.hpp"

namespace rdm {
namespace {

constexpr int kTables = 3;

StepperTable table_at(int i) {
  return i == 0 ? steppers_v2() : i == 1 ? steppers_v3() : steppers_v4();
}

bool usable(const StepperTable& table) {
  if (!table.isa) return false;
  if (std::strcmp(table.isa, kV4Isa) == 0) return cpu().v4;
  return std::strcmp(table.isa, kV3Isa) != 0 || cpu().avx2;
}

// 0: the best there is; else an index into the tables, plus 1.
std::atomic<int> chosen{0};

}  // namespace

StepperTable best_steppers() {
  const int choice = chosen.load(std::memory_order_acquire);
  if (choice > 0) return table_at(choice - 1);
  int best = kTables - 1;
  while (best > 0 && !usable(table_at(best))) --best;
  return table_at(best);
}

bool set_stepper_isa(const char* name) {
  for (int i = 0; i < kTables; ++i) {
    const StepperTable t = table_at(i);
    if (usable(t) && std::strcmp(t.isa, name) == 0) {
      chosen.store(i + 1, std::memory_order_release);
      return true;
    }
  }
  return false;
}

const char* stepper_isa() {
  return best_steppers().isa;
}

int32_t widest_lanes() {
  return best_steppers().lanes;
}

}  // namespace rdm
