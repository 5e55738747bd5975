// The list of tasks by name.
#include <cstdio>
#include <cstring>

#include "base/error.hpp"
#include "base/text.hpp"
#include "env/task.hpp"

namespace rdm {
namespace {

constexpr int32_t kMaxTasks = 64;
const TaskInfo* g_tasks[kMaxTasks];
int32_t g_count = 0;

constexpr size_t kMaxName = 96;

// Safety-Gymnasium's ids carry a leading word and a version that say nothing here:
// "SafetyShadowHandOverSafeFinger-v0" is "ShadowHandOverSafeFinger".
void strip_id(const char* id, char* out) {
  constexpr char kLead[] = "Safety";
  constexpr size_t kLeadSize = sizeof kLead - 1;
  if (std::strncmp(id, kLead, kLeadSize) == 0) id += kLeadSize;
  std::snprintf(out, kMaxName, "%s", id);
  char* dash = std::strrchr(out, '-');
  if (!dash || dash[1] != 'v' || !dash[2]) return;
  if (std::strspn(dash + 2, "0123456789") == std::strlen(dash + 2)) *dash = '\0';
}

int32_t find(const char* name) {
  char id[kMaxName];
  strip_id(name, id);
  for (int32_t i = 0; i < g_count; ++i) {
    if (same_name(g_tasks[i]->name, name)) return i;
    if (g_tasks[i]->alias && same_name(g_tasks[i]->alias, id)) return i;
  }
  return -1;
}

}  // namespace

void register_task(const TaskInfo& info) {
  if (g_count == kMaxTasks) fail(Code::kInternal, "task %s: more than %d tasks", info.name, kMaxTasks);
  if (info.num_costs < 1 || info.num_costs > kMaxTaskCosts)
    fail(Code::kInternal, "task %s: %d cost columns", info.name, info.num_costs);
  if (find(info.name) >= 0) fail(Code::kInternal, "task %s is registered twice", info.name);
  g_tasks[g_count++] = &info;
}

int32_t task_count() {
  return g_count;
}

const TaskInfo& task_at(int32_t index) {
  if (index < 0 || index >= g_count) fail(Code::kRange, "task: %d is outside [0, %d)", index, g_count);
  return *g_tasks[index];
}

int32_t task_find(const char* name) {
  if (!name) fail(Code::kArgument, "task: the name is NULL");
  const int32_t i = find(name);
  if (i >= 0) return i;
  const char* names[kMaxTasks];
  for (int32_t k = 0; k < g_count; ++k) names[k] = g_tasks[k]->name;
  fail(Code::kNotFound, "task %s: unknown%s", Quoted(name).text, Nearest(name, names, g_count).text);
}

Vec3 Task::focus(const World& world, const void*) const {
  return world.scene().num_bodies > 0 ? world.body(0).X.p : Vec3{0, -0.5, 0.5};
}

}  // namespace rdm
