// The list of tasks by name.
#include <cstdio>
#include <cstring>
#include <mutex>
#include <utility>

#include "base/error.hpp"
#include "base/numbered.hpp"
#include "base/text.hpp"
#include "env/task.hpp"

namespace rdm {
namespace {

using Rows = Numbered<const TaskInfo*>;

std::mutex g_lock;
// Under the lock.
Rows& rows() {
  static auto* const list = new Rows("task");  // never ended: a pool may outlive all statics
  return *list;
}

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
  for (const Rows::Row& row : rows()) {
    if (!row.listed) continue;
    const TaskInfo& info = *row.what;
    if (same_name(info.name, name)) return row.number;
    if (info.alias && same_name(info.alias, id)) return row.number;
  }
  return -1;
}

void release(int32_t index) {
  const TaskInfo* last = nullptr;
  {
    const std::lock_guard<std::mutex> hold(g_lock);
    if (!rows().release(index, &last)) return;
  }
  last->source->end();
}

}  // namespace

void register_task(const TaskInfo& info) {
  const std::lock_guard<std::mutex> hold(g_lock);
  if (info.num_costs < 1 || info.num_costs > kMaxTaskCosts)
    fail(Code::kInternal, "task %s: it has %d cost columns, which is outside the bounds", info.name,
         info.num_costs);
  if (find(info.name) >= 0) fail(Code::kInternal, "task %s is registered twice", info.name);
  rows().add(&info);
}

int32_t add_task(TaskSource* source) {
  const TaskInfo& info = source->info();
  const std::lock_guard<std::mutex> hold(g_lock);
  if (find(info.name) >= 0) fail(Code::kArgument, "task %s: the name is already used", info.name);
  return rows().add(&info);
}

void remove_task(int32_t index) {
  {
    const std::lock_guard<std::mutex> hold(g_lock);
    Rows::Row& row = rows().listed(index);
    if (!row.what->source) fail(Code::kArgument, "task %s belongs to the library", row.what->name);
    row.listed = false;
  }
  release(index);
}

bool task_listed(int32_t index) {
  const std::lock_guard<std::mutex> hold(g_lock);
  const Rows::Row* const row = rows().find(index);
  return row && row->listed;
}

int32_t task_count() {
  const std::lock_guard<std::mutex> hold(g_lock);
  return rows().count();
}

const TaskInfo& task_at(int32_t index) {
  const std::lock_guard<std::mutex> hold(g_lock);
  return *rows().row(index).what;
}

int32_t task_find(const char* name) {
  if (!name) fail(Code::kArgument, "task: its name is NULL");
  const std::lock_guard<std::mutex> hold(g_lock);
  const int32_t i = find(name);
  if (i >= 0) return i;
  Vector<const char*> names;
  for (const Rows::Row& row : rows())
    if (row.listed) names.push_back(row.what->name);
  fail(Code::kNotFound, "task %s: unknown%s", Quoted(name).text,
       Nearest(name, names.data(), static_cast<int32_t>(names.size())).text);
}

TaskRef::TaskRef(int32_t index) {
  const std::lock_guard<std::mutex> hold(g_lock);
  Rows::Row& row = rows().listed(index);
  info_ = row.what;
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
