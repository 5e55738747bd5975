// The list of tasks by name.
#include <cstdio>
#include <cstring>
#include <mutex>
#include <utility>

#include "base/error.hpp"
#include "base/text.hpp"
#include "env/task.hpp"

namespace rdm {
namespace {

struct Row {
  const TaskInfo* info;
  int32_t users;  // of an added one: references, and one for the list
  bool listed;    // not removed
};

std::mutex g_lock;
Row g_rows[kMaxTasks];
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

// Under the lock; -1: none.
int32_t find(const char* name) {
  char id[kMaxName];
  strip_id(name, id);
  for (int32_t i = 0; i < g_count; ++i) {
    if (!g_rows[i].listed) continue;
    const TaskInfo& info = *g_rows[i].info;
    if (same_name(info.name, name)) return i;
    if (info.alias && same_name(info.alias, id)) return i;
  }
  return -1;
}

void need_row(int32_t index) {
  if (index < 0 || index >= g_count) fail(Code::kRange, "task: %d is outside [0, %d)", index, g_count);
}
[[noreturn]] void fail_removed(int32_t index) {
  fail(Code::kNotFound, "task %d was removed", index);
}

void release(int32_t index) {
  TaskSource* last = nullptr;
  {
    const std::lock_guard<std::mutex> hold(g_lock);
    Row& row = g_rows[index];
    if (--row.users > 0) return;
    last = std::exchange(row.info, nullptr)->source;
  }
  last->end();
}

}  // namespace

void register_task(const TaskInfo& info) {
  const std::lock_guard<std::mutex> hold(g_lock);
  if (g_count == kMaxTasks) fail(Code::kInternal, "task %s: more than %d tasks", info.name, kMaxTasks);
  if (info.num_costs < 1 || info.num_costs > kMaxTaskCosts)
    fail(Code::kInternal, "task %s: %d cost columns", info.name, info.num_costs);
  if (find(info.name) >= 0) fail(Code::kInternal, "task %s is registered twice", info.name);
  g_rows[g_count++] = {&info, 0, true};
}

int32_t add_task(TaskSource* source) {
  const TaskInfo& info = source->info();
  const std::lock_guard<std::mutex> hold(g_lock);
  if (find(info.name) >= 0) fail(Code::kArgument, "task %s: the name is taken", info.name);
  if (g_count == kMaxTasks)
    fail(Code::kRange, "task %s: more than %d tasks were added", info.name, kMaxTasks);
  g_rows[g_count] = {&info, 1, true};
  return g_count++;
}

void remove_task(int32_t index) {
  {
    const std::lock_guard<std::mutex> hold(g_lock);
    need_row(index);
    Row& row = g_rows[index];
    if (!row.listed) fail_removed(index);
    if (!row.info->source) fail(Code::kArgument, "task %s is the library's own", row.info->name);
    row.listed = false;
  }
  release(index);
}

int32_t task_count() {
  const std::lock_guard<std::mutex> hold(g_lock);
  return g_count;
}

const TaskInfo& task_at(int32_t index) {
  const std::lock_guard<std::mutex> hold(g_lock);
  need_row(index);
  if (!g_rows[index].info) fail_removed(index);
  return *g_rows[index].info;
}

int32_t task_find(const char* name) {
  if (!name) fail(Code::kArgument, "task: the name is NULL");
  const std::lock_guard<std::mutex> hold(g_lock);
  const int32_t i = find(name);
  if (i >= 0) return i;
  const char* names[kMaxTasks];
  int32_t count = 0;
  for (int32_t k = 0; k < g_count; ++k)
    if (g_rows[k].listed) names[count++] = g_rows[k].info->name;
  fail(Code::kNotFound, "task %s: unknown%s", Quoted(name).text, Nearest(name, names, count).text);
}

TaskRef::TaskRef(int32_t index) {
  const std::lock_guard<std::mutex> hold(g_lock);
  need_row(index);
  Row& row = g_rows[index];
  if (!row.listed) fail_removed(index);
  info_ = row.info;
  if (!info_->source) return;
  index_ = index;
  ++row.users;
}

TaskRef::TaskRef(TaskRef&& other) noexcept
    : index_(std::exchange(other.index_, -1)), info_(std::exchange(other.info_, nullptr)) {}

TaskRef& TaskRef::operator=(TaskRef&& other) noexcept {
  std::swap(index_, other.index_);
  std::swap(info_, other.info_);
  return *this;
}

TaskRef::~TaskRef() {
  if (index_ >= 0) release(index_);
}

const Vector<CameraSpec>& Task::mounted_cameras() const {
  static const Vector<CameraSpec> none;
  return none;
}

Vec3 Task::focus(const World& world, const void*) const {
  return world.scene().num_bodies > 0 ? world.body(0).X.p : Vec3{0, -0.5, 0.5};
}

}  // namespace rdm
