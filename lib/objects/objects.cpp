#include "objects/objects.hpp"

#include <mutex>
#include <utility>

#include "base/error.hpp"
#include "base/numbered.hpp"
#include "base/option.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

struct Added {
  ObjectCopy* object = nullptr;
  HostHooks hooks;
};

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

std::mutex g_lock;
// Under the lock; numbered behind our own.
Numbered<Added>& added() {
  static auto* const list =
      new Numbered<Added>("object", own().count);  // never ended: a pool may outlive all statics
  return *list;
}

void release(int32_t index) {
  Added last;
  {
    const std::lock_guard<std::mutex> hold(g_lock);
    if (!added().release(index, &last)) return;
  }
  host_delete(last.hooks, last.object);
}

// Calls f(object, number) for all that are listed, until it returns true.
template <class F>
bool any_listed(F&& f) {
  for (int32_t i = 0; i < own().count; ++i)
    if (f(own().at(i), i)) return true;
  for (const auto& row : added())
    if (row.listed && f(row.what.object->object(), row.number)) return true;
  return false;
}

// "mug" of "025_mug"; null: no number.
const char* without_number(const char* alias) {
  if (!alias || *alias < '0' || *alias > '9') return nullptr;
  while (*alias && *alias != '_') ++alias;
  return *alias ? alias + 1 : nullptr;
}

// Under the lock; -1: none. Names go before aliases, so that a short alias hides none.
int32_t find(const char* name) {
  int32_t found = -1;
  const auto take = [&](bool same, int32_t i) { return same && (found = i, true); };
  any_listed([&](const Object& o, int32_t i) { return take(same_name(o.name, name), i); }) ||
      any_listed([&](const Object& o, int32_t i) { return take(o.alias && same_name(o.alias, name), i); }) ||
      any_listed([&](const Object& o, int32_t i) {
        const char* bare = without_number(o.alias);
        return take(bare && same_name(bare, name), i);
      });
  return found;
}

}  // namespace

int32_t num_objects() {
  const std::lock_guard<std::mutex> hold(g_lock);
  return added().given();
}

ObjectRef::ObjectRef(int32_t index) {
  const std::lock_guard<std::mutex> hold(g_lock);
  added().need(index);
  if (index < own().count) {
    object_ = &own().at(index);
    return;
  }
  Numbered<Added>::Row& row = added().listed(index);
  object_ = &row.what.object->object();
  index_ = index;
  ++row.users;
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
  any_listed([&](const Object& o, int32_t) {
    names.push_back(o.name);
    if (o.alias) names.push_back(o.alias);
    return false;
  });
  fail(Code::kNotFound, "object %s: unknown%s", Quoted(name).text,
       Nearest(name, names.data(), static_cast<int32_t>(names.size())).text);
}

int32_t add_object(const Object& object) {
  check_object(object);
  const HostHooks hooks = host();
  ObjectCopy* copy = host_new<ObjectCopy>(hooks, object);
  try {
    const std::lock_guard<std::mutex> hold(g_lock);
    for (const char* name : {object.name, object.alias})
      if (name && find(name) >= 0) fail(Code::kArgument, "object %s: the name is taken", Quoted(name).text);
    return added().add({copy, hooks});
  } catch (...) {
    host_delete(hooks, copy);
    throw;
  }
}

void remove_object(int32_t index) {
  {
    const std::lock_guard<std::mutex> hold(g_lock);
    added().need(index);
    if (index < own().count) fail(Code::kArgument, "object %s is the library's own", own().at(index).name);
    added().listed(index).listed = false;
  }
  release(index);
}

}  // namespace rdm
