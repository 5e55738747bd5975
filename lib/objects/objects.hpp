// The objects that there are, by number and by name: the library's own tables and those that a host has added.
#pragma once
#include "base/registry.hpp"
#include "objects/object_copy.hpp"

namespace rdm {

struct Objects {
  using Thing = Object;
  using Copy = ObjectCopy;
  static constexpr const char* kNoun = "object";
  static constexpr int kRounds = 3;  // names before aliases, so that a short alias hides none
  static int32_t num_own();
  static const Object& own(int32_t index);
  static const Object& shown(const ObjectCopy& copy) { return copy.object(); }
  // Name, alias, or an alias without the number that it begins with.
  static bool called(const Object& object, const char* name, int round);
  static void check(const Object& object);
};
using ObjectRef = Ref<Objects>;

inline int32_t num_objects() {
  return Registry<Objects>::get().count();
}
inline int32_t find_object(const char* name) {
  return Registry<Objects>::get().find(name);
}
inline int32_t add_object(const Object& object) {
  return Registry<Objects>::get().add(object);
}
inline void remove_object(int32_t index) {
  Registry<Objects>::get().remove(index);
}

// The tables in the library.
Table<Object> basic_objects();
Table<Object> ycb_food();
Table<Object> ycb_kitchen();
Table<Object> ycb_tools();
Table<Object> ycb_shapes();

}  // namespace rdm
