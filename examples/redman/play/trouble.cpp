#include "play/trouble.hpp"

#include <cstdio>

#include "common/text.hpp"

namespace tool {

void Trouble::add(uint32_t status) {
  diverged |= (status & RDM_STATUS_DIVERGED) != 0;
  bad_actions |= (status & RDM_STATUS_BAD_ACTION) != 0;
  task_failed |= (status & RDM_STATUS_TASK) != 0;
  contacts_left_out += (status & RDM_STATUS_CONTACTS) != 0;
  unconverged += (status & RDM_STATUS_SOLVER) != 0;
  slowed += (status & RDM_STATUS_SLOWED) != 0;
}

void Trouble::add(const Trouble& other) {
  diverged += other.diverged;
  bad_actions += other.bad_actions;
  task_failed += other.task_failed;
  contacts_left_out += other.contacts_left_out;
  unconverged += other.unconverged;
  slowed += other.slowed;
}

void put_trouble(Json& json, const Trouble& t, const std::string& prefix) {
  json[prefix + "diverged"] = t.diverged;
  json[prefix + "contacts_left_out"] = t.contacts_left_out;
  json[prefix + "unconverged"] = t.unconverged;
  json[prefix + "slowed"] = t.slowed;
  json[prefix + "bad_actions"] = t.bad_actions;
  json[prefix + "task_failed"] = t.task_failed;
}

std::string trouble_text(const Trouble& t) {
  std::string text;
  const auto add = [&](int64_t count, const char* one, const char* several) {
    if (count == 0) return;
    text += (text.empty() ? "" : "; ") + std::to_string(count) + (count == 1 ? one : several);
  };
  add(t.diverged, " episode diverged", " episodes diverged");
  add(t.bad_actions, " episode got an action that is not finite",
      " episodes got an action that is not finite");
  add(t.task_failed, " episode ended as a function of the task failed",
      " episodes ended as a function of the task failed");
  add(t.contacts_left_out, " step left contacts out (option contacts_max)",
      " steps left contacts out (option contacts_max)");
  add(t.unconverged, " step did not solve its contacts (options iterations, substeps)",
      " steps did not solve their contacts (options iterations, substeps)");
  add(t.slowed, " step slowed a body that spun too fast (option substeps)",
      " steps slowed bodies that spun too fast (option substeps)");
  return text;
}

void say_trouble(const Trouble& t, const std::string& where) {
  if (t.any()) std::fprintf(stderr, "redman: %s: %s\n", where.c_str(), trouble_text(t).c_str());
}

Trouble trouble_of(const redman::Pool& pool) {
  const rdm_pool_stats s = pool.stats();
  return {s.diverged, s.bad_actions, s.task_failed, s.overflowed, s.unconverged, s.slowed};
}

}  // namespace tool
