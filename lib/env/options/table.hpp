// A task's option table, put together once from shared parts and kept for the life of the process.
#pragma once
#include <cstdint>

#include "base/option.hpp"

namespace rdm {

class OptionTable {
 public:
  static constexpr int32_t kCapacity = 288, kKeySize = 32;

  // Rows whose strings are static.
  template <int32_t N>
  void add(const OptionSpec (&rows)[N]) {
    for (const OptionSpec& row : rows) add(row);
  }
  void add(const OptionSpec& row);
  // A row whose key is made here: "first.name.last", parts may be null.
  void add(const char* first, const char* name, const char* last, OptionSpec row);

  // Another default for a number or integer that is in the table already: a task's own.
  void set_default(const char* key, double number);

  const OptionSpec* rows() const { return rows_; }
  int32_t count() const { return count_; }

 private:
  OptionSpec rows_[kCapacity] = {};
  char keys_[kCapacity][kKeySize] = {};
  int32_t count_ = 0;
};

}  // namespace rdm
