#include "env/options/table.hpp"

#include <cstdio>
#include <cstring>

#include "base/error.hpp"

namespace rdm {

int32_t OptionTable::find(const char* key) const {
  return find_indexed(room_.slots, static_cast<size_t>(room_.num_slots), key,
                      [&](int32_t i) { return room_.rows[i].key; });
}

void OptionTable::add(const OptionSpec& row) {
  if (count_ == room_.num_rows)
    fail(Code::kInternal, "option %s: more than %d rows", row.key, room_.num_rows);
  add_indexed(room_.slots, static_cast<size_t>(room_.num_slots), row.key, count_);
  room_.rows[count_++] = row;
}

void OptionTable::add(const char* first, const char* name, const char* last, OptionSpec row) {
  char key[3 * kKeySize] = "";
  for (const char* part : {first, name, last}) {
    if (!part) continue;
    const size_t at = std::strlen(key);
    std::snprintf(key + at, sizeof key - at, "%s%s", at ? "." : "", part);
  }
  const auto size = static_cast<int32_t>(std::strlen(key)) + 1;
  if (size > kKeySize) fail(Code::kInternal, "option %s: the key is too long", key);
  if (letters_used_ + size > room_.num_letters)
    fail(Code::kInternal, "option %s: keys of more than %d letters", key, room_.num_letters);
  row.key = std::strcpy(room_.letters + letters_used_, key);
  letters_used_ += size;
  add(row);
}

void OptionTable::set_default(const char* key, double number) {
  const int32_t i = find(key);
  if (i < 0) fail(Code::kInternal, "option %s: there is no such row", key);
  room_.rows[i].number = number;
}

}  // namespace rdm
