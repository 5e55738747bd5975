#include "objects/objects.hpp"

namespace rdm {
namespace {

constexpr int kNumTables = 5;
struct Own {
  Table<Object> tables[kNumTables] = {basic_objects(), ycb_food(), ycb_kitchen(), ycb_tools(), ycb_shapes()};
  int32_t count = 0;
  Own() {
    for (const Table<Object>& t : tables) count += t.count;
  }
};
const Own& tables() {
  static const Own own;
  return own;
}

// "mug" of "025_mug"; null: no number.
const char* without_number(const char* alias) {
  if (!alias || *alias < '0' || *alias > '9') return nullptr;
  while (*alias && *alias != '_') ++alias;
  return *alias ? alias + 1 : nullptr;
}

}  // namespace

int32_t Objects::num_own() {
  return tables().count;
}
const Object& Objects::own(int32_t index) {
  const Table<Object>* t = tables().tables;
  while (index >= t->count) index -= (t++)->count;
  return (*t)[index];
}
bool Objects::called(const Object& object, const char* name, int round) {
  const char* const words[kRounds] = {object.name, object.alias, without_number(object.alias)};
  return words[round] && same_name(words[round], name);
}
void Objects::check(const Object& object) {
  check_object(object);
}

}  // namespace rdm
