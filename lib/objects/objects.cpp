#include "objects/objects.hpp"

#include <mutex>
#include <utility>

#include "base/error.hpp"
#include "base/option.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

struct Added {
  ObjectCopy* object;
  HostHooks hooks;
  int32_t users;  // references, and one for the list
  bool listed;    // not removed; what is removed stays until its last user goes
};

std::mutex g_lock;
Added g_added[kMaxObjects];
int32_t g_num_added = 0;

constexpr int kNumTables = 5;
struct Own {
  Table<Object> tables[kNumTables] = {basic_objects(), ycb_food(), ycb_kitchen(), ycb_tools(), ycb_shapes()};
  int32_t count = 0;
  Own() {
    for (const Table<Object>& t : tables) count += t.count;
  }
  const Object& at(int32_t index) const {
    const Table<Object>* t = tables;
    while (index >= t->count) index -= (t++)->count;
    return (*t)[index];
  }
};
const Own& own() {
  static const Own tables;
  return tables;
}

// Under the lock.
int32_t given() {
  return own().count + g_num_added;
}
const Object* at(int32_t index) {
  if (index < own().count) return &own().at(index);
  return &g_added[index - own().count].object->object();
}
bool listed(int32_t index) {
  return index < own().count || g_added[index - own().count].listed;
}

void release(int32_t index) {
  ObjectCopy* last = nullptr;
  HostHooks hooks;
  {
    const std::lock_guard<std::mutex> hold(g_lock);
    Added& added = g_added[index - own().count];
    if (--added.users > 0) return;
    last = std::exchange(added.object, nullptr);
    hooks = added.hooks;
  }
  host_delete(hooks, last);
}

// "mug" of "025_mug"; null: no number.
const char* without_number(const char* alias) {
  if (!alias || *alias < '0' || *alias > '9') return nullptr;
  while (*alias && *alias != '_') ++alias;
  return *alias ? alias + 1 : nullptr;
}

// Under the lock; -1: none. Names go before aliases, so that a short alias hides none.
int32_t find(const char* name) {
  for (int32_t i = 0; i < given(); ++i)
    if (listed(i) && same_name(at(i)->name, name)) return i;
  for (int32_t i = 0; i < given(); ++i)
    if (listed(i) && at(i)->alias && same_name(at(i)->alias, name)) return i;
  for (int32_t i = 0; i < given(); ++i) {
    if (!listed(i)) continue;
    const char* bare = without_number(at(i)->alias);
    if (bare && same_name(bare, name)) return i;
  }
  return -1;
}

}  // namespace

int32_t num_objects() {
  const std::lock_guard<std::mutex> hold(g_lock);
  return given();
}

ObjectRef::ObjectRef(int32_t index) {
  const std::lock_guard<std::mutex> hold(g_lock);
  if (index < 0 || index >= given()) fail(Code::kRange, "object: %d is outside [0, %d)", index, given());
  if (!listed(index)) fail(Code::kNotFound, "object %d was removed", index);
  object_ = at(index);
  if (index < own().count) return;
  index_ = index;
  ++g_added[index - own().count].users;
}

ObjectRef::ObjectRef(ObjectRef&& other) noexcept
    : index_(std::exchange(other.index_, -1)), object_(std::exchange(other.object_, nullptr)) {}

ObjectRef& ObjectRef::operator=(ObjectRef&& other) noexcept {
  std::swap(index_, other.index_);
  std::swap(object_, other.object_);
  return *this;
}

ObjectRef::~ObjectRef() {
  if (index_ >= 0) release(index_);
}

int32_t find_object(const char* name) {
  if (!name) fail(Code::kArgument, "object: the name is NULL");
  const std::lock_guard<std::mutex> hold(g_lock);
  const int32_t i = find(name);
  if (i >= 0) return i;
  Vector<const char*> names;
  for (int32_t k = 0; k < given(); ++k) {
    if (!listed(k)) continue;
    names.push_back(at(k)->name);
    if (at(k)->alias) names.push_back(at(k)->alias);
  }
  fail(Code::kNotFound, "object %s: unknown%s", Quoted(name).text,
       Nearest(name, names.data(), static_cast<int32_t>(names.size())).text);
}

int32_t add_object(const Object& object) {
  check_object(object);
  const HostHooks hooks = host();
  ObjectCopy* copy = host_new<ObjectCopy>(hooks, object);
  const char* taken = nullptr;
  {
    const std::lock_guard<std::mutex> hold(g_lock);
    for (const char* name : {object.name, object.alias})
      if (name && !taken && find(name) >= 0) taken = name;
    if (!taken && g_num_added < kMaxObjects) {
      g_added[g_num_added] = {copy, hooks, 1, true};
      return own().count + g_num_added++;
    }
  }
  host_delete(hooks, copy);
  if (taken) fail(Code::kArgument, "object %s: the name is taken", Quoted(taken).text);
  fail(Code::kRange, "object %s: more than %d objects were added", Quoted(object.name).text, kMaxObjects);
}

void remove_object(int32_t index) {
  {
    const std::lock_guard<std::mutex> hold(g_lock);
    if (index < 0 || index >= given()) fail(Code::kRange, "object: %d is outside [0, %d)", index, given());
    if (index < own().count) fail(Code::kArgument, "object %s is the library's own", at(index)->name);
    if (!listed(index)) fail(Code::kNotFound, "object %d was removed", index);
    g_added[index - own().count].listed = false;
  }
  release(index);
}

}  // namespace rdm
