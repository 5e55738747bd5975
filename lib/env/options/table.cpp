#include "env/options/table.hpp"

#include <cstdio>
#include <cstring>

#include "base/error.hpp"

namespace rdm {

void OptionTable::add(const OptionSpec& row) {
  if (count_ == kCapacity) fail(Code::kInternal, "option %s: more than %d rows", row.key, kCapacity);
  rows_[count_++] = row;
}

void OptionTable::add(const char* first, const char* name, const char* last, OptionSpec row) {
  char key[3 * kKeySize] = "";
  for (const char* part : {first, name, last}) {
    if (!part) continue;
    const size_t at = std::strlen(key);
    std::snprintf(key + at, sizeof key - at, "%s%s", at ? "." : "", part);
  }
  if (std::strlen(key) >= kKeySize) fail(Code::kInternal, "option %s: the key is too long", key);
  if (count_ == kCapacity) fail(Code::kInternal, "option %s: more than %d rows", key, kCapacity);
  row.key = std::strcpy(keys_[count_], key);
  add(row);
}

bool OptionTable::has(const char* key) const {
  for (int32_t i = 0; i < count_; ++i)
    if (same_name(rows_[i].key, key)) return true;
  return false;
}

void OptionTable::set_default(const char* key, double number) {
  for (int32_t i = 0; i < count_; ++i) {
    if (std::strcmp(rows_[i].key, key) != 0) continue;
    rows_[i].number = number;
    return;
  }
  fail(Code::kInternal, "option %s: there is no such row", key);
}

}  // namespace rdm
