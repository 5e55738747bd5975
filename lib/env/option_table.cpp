#include "env/option_table.hpp"

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

OptionTable::Key OptionTable::make_key(const char* first, const char* name, const char* last) {
  Key key;
  char *at = key.text, *const end = key.text + kKeySize - 1;
  for (const char* part : {first, name, last}) {
    if (!part) continue;
    if (at > key.text && at < end) *at++ = '.';
    while (*part && at < end) *at++ = *part++;
    if (*part) fail(Code::kInternal, "option %s.%s: the key is too long", first, name);
  }
  *at = '\0';
  return key;
}

void OptionTable::add(const char* first, const char* name, const char* last, OptionSpec row) {
  const Key key = make_key(first, name, last);
  const auto size = static_cast<int32_t>(std::strlen(key.text)) + 1;
  if (letters_used_ + size > room_.num_letters)
    fail(Code::kInternal, "option %s: keys of more than %d letters", key.text, room_.num_letters);
  row.key = std::strcpy(room_.letters + letters_used_, key.text);
  letters_used_ += size;
  add(row);
}

void OptionTable::set_default(const char* key, double number) {
  const int32_t i = find(key);
  if (i < 0) fail(Code::kInternal, "option %s: there is no such row", key);
  room_.rows[i].number = number;
}

}  // namespace rdm
