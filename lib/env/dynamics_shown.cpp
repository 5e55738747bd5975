#include "env/dynamics_shown.hpp"

#include "base/error.hpp"
#include "base/hash.hpp"

namespace rdm {
namespace {

constexpr auto kShownRows = option_rows<DynamicsOptions>(row<&DynamicsOptions::show>(basic(flag_option(
    "show_dynamics", false,
    "what a world draws at its resets is observed, as fields dynamics.OPTION in [-1, 1]: for each option "
    "with a range or drawn by level, and action_delay"))));

}  // namespace

const OptionSpec* dynamics_options(int32_t* count) {
  *count = static_cast<int32_t>(kShownRows.size());
  return kShownRows.specs;
}

bool shows_dynamics(const Options& options) {
  return kShownRows.read(options).show;
}

uint64_t hash_dynamics(const Options& options, uint64_t hash) {
  const char* const key = kShownRows.specs[0].key;
  return shows_dynamics(options) ? hash_bytes(key, std::strlen(key) + 1, hash) : hash;
}

DynamicsTask::DynamicsTask(const Task& inner, Disturbance& plan, const char* owner)
    : TaskAround(inner), delay_(plan.action_delay.drawn()) {
  if (const DynamicsDraws* draws = inner.draws()) draws->list(shown_);
  if (shown_.empty() && !delay_)
    fail(Code::kArgument,
         "%s option show_dynamics: nothing is drawn at a reset; give an option of the dynamics a range, such "
         "as "
         "action_delay=0..4, or level=1 to a task of hands",
         owner);
  for (const DynamicsDraws::Shown& s : shown_)
    add_field(own_fields(), "dynamics", s.spec->key, "1", 1, -1, 1);
  if (!delay_) return;
  plan.delay_entry = field_total(fields());
  add_field(own_fields(), "dynamics", "action_delay", "1", 1, -1, 1);
}

void DynamicsTask::show(const World& world, const void*, float* out) const {
  if (!shown_.empty()) DynamicsDraws::show(*world.dynamics(), shown_, out);
  if (delay_) out[shown_.size()] = 0;  // the world's disturbance knows it
}

}  // namespace rdm
