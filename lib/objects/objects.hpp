// The objects that there are, by number and by name: the library's own tables and those that a host has
// added.
//
// Any number of threads may look while others add and remove. A number is never given twice.
#pragma once
#include "objects/object_copy.hpp"

namespace rdm {

int32_t num_objects();  // numbers that were given; those of removed objects count

// While it lives, the object stays.
class ObjectRef {
 public:
  ObjectRef() = default;
  explicit ObjectRef(int32_t index);  // Error(kRange); Error(kNotFound): it was removed
  ObjectRef(const ObjectRef&) = delete;
  ObjectRef& operator=(const ObjectRef&) = delete;
  ObjectRef(ObjectRef&& other) noexcept;
  ObjectRef& operator=(ObjectRef&& other) noexcept;
  ~ObjectRef();
  const Object& operator*() const { return *object_; }
  const Object* operator->() const { return object_; }

 private:
  int32_t index_ = -1;  // of an added one
  const Object* object_ = nullptr;
};

// Name, alias, or an alias without the number that it begins with; Error(kNotFound) with the nearest.
int32_t find_object(const char* name);

// A deep copy joins the list. Error(kArgument), Error(kRange) as check_object, also for a name that is taken.
int32_t add_object(const Object& object);
// Whoever holds a reference keeps it. Error(kArgument) for one of the library's own.
void remove_object(int32_t index);

// The tables in the library.
Table<Object> basic_objects();
Table<Object> ycb_food();
Table<Object> ycb_kitchen();
Table<Object> ycb_tools();
Table<Object> ycb_shapes();

}  // namespace rdm
