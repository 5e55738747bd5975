// A task's option table, put together from shared parts: once with the task's own robots and kept for the
// life of the process, and once more for a pool whose options choose others.
#pragma once
#include <cstdint>

#include "base/option.hpp"

namespace rdm {

class OptionTable {
 public:
  // Two robots of 64 links have 768 rows.
  static constexpr int32_t kCapacity = 1024, kKeySize = 48;

  // What the host chose, null: nothing.
  explicit OptionTable(const Options* choices = nullptr) : choices_(choices) {}

  // Rows whose strings are static.
  template <int32_t N>
  void add(const OptionSpec (&rows)[N]) {
    for (const OptionSpec& row : rows) add(row);
  }
  void add(const OptionSpec& row);
  // A row whose key is made here: "first.name.last", parts may be null.
  void add(const char* first, const char* name, const char* last, OptionSpec row);

  // The text of a row that chooses others; "" when nothing was chosen.
  const char* choice(const char* key) const { return choices_ ? choices_->text(key) : ""; }
  bool has(const char* key) const;

  // Another default for a number or integer that is in the table already: a task's own.
  void set_default(const char* key, double number);

  const OptionSpec* rows() const { return rows_; }
  int32_t count() const { return count_; }

 private:
  OptionSpec rows_[kCapacity] = {};
  char keys_[kCapacity][kKeySize] = {};
  int32_t count_ = 0;
  const Options* choices_ = nullptr;
};

}  // namespace rdm
