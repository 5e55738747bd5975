#include "physics/articulated/stepper.hpp"

#include <atomic>
#include <cstring>

#include "base/cpu.hpp"

namespace rdm {
namespace {

bool usable(const StepperTable& table) {
  return table.isa && (std::strcmp(table.isa, kV3Isa) != 0 || cpu().avx2);
}

// 0: the best there is; else an index into the tables, plus 1.
std::atomic<int> chosen{0};

StepperTable table_at(int i) {
  return i == 0 ? steppers_v2() : steppers_v3();
}

StepperTable table() {
  const int choice = chosen.load(std::memory_order_acquire);
  if (choice > 0) return table_at(choice - 1);
  return usable(steppers_v3()) ? steppers_v3() : steppers_v2();
}

}  // namespace

Stepper* make_stepper(const StepperKind& kind, const ArticulatedModel& model, Collider* collider,
                      const HostHooks& hooks, Arena& arena) {
  return table().make(kind, model, collider, hooks, arena);
}

bool set_stepper_isa(const char* name) {
  for (int i = 0; i < 2; ++i) {
    const StepperTable t = table_at(i);
    if (usable(t) && std::strcmp(t.isa, name) == 0) {
      chosen.store(i + 1, std::memory_order_release);
      return true;
    }
  }
  return false;
}

const char* stepper_isa() {
  return table().isa;
}

}  // namespace rdm
