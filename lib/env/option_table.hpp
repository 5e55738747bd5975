// A task's option table, put together from shared parts: once with the task's own robots and kept for the
// life of the process, and once more for a pool whose options choose others.
#pragma once
#include <bit>
#include <cstdint>

#include "base/name_index.hpp"
#include "base/option_rows.hpp"

namespace rdm {

class OptionTable {
 public:
  static constexpr int32_t kKeySize = 48;  // of a key, with its end
  struct Key {
    char text[kKeySize];
  };
  // "first.name.last", parts may be null. Error(kInternal) when it is too long.
  static Key make_key(const char* first, const char* name, const char* last);

  OptionTable(const OptionTable&) = delete;
  OptionTable& operator=(const OptionTable&) = delete;

  // Rows whose strings are static.
  template <int32_t N>
  void add(const OptionSpec (&rows)[N]) {
    for (const OptionSpec& row : rows) add(row);
  }
  template <class S, class... M>
  void add(const OptionRows<S, M...>& rows) {
    add(rows.specs);
  }
  void add(const OptionSpec& row);
  // A row whose key is made here: "first.name.last", parts may be null.
  void add(const char* first, const char* name, const char* last, OptionSpec row);

  // The text of a row that chooses others; "" when nothing was chosen.
  const char* choice(const char* key) const { return choices_ ? choices_->text(key) : ""; }
  bool has(const char* key) const { return find(key) >= 0; }

  // Another default for a number or integer that is in the table already: a task's own.
  void set_default(const char* key, double number);

  const OptionSpec* rows() const { return room_.rows; }
  int32_t count() const { return count_; }

 protected:
  struct Room {
    OptionSpec* rows;
    char* letters;  // of the keys that are made here
    NameSlot* slots;
    int32_t num_rows, num_letters, num_slots;
  };
  OptionTable(const Room& room, const Options* choices) : room_(room), choices_(choices) {}
  ~OptionTable() = default;

 private:
  int32_t find(const char* key) const;

  Room room_;
  const Options* choices_;  // null: the host chose nothing
  int32_t count_ = 0, letters_used_ = 0;
};

// With room for so many rows, and letters of keys that are made here.
template <int32_t kRows, int32_t kLetters = kRows* OptionTable::kKeySize>
class SizedOptionTable : public OptionTable {
 public:
  explicit SizedOptionTable(const Options* choices = nullptr)
      : OptionTable({own_rows_, letters_, slots_, kRows, kLetters, kSlots}, choices) {}

 private:
  static constexpr auto kSlots = static_cast<int32_t>(std::bit_ceil(2u * kRows));
  OptionSpec own_rows_[kRows] = {};
  char letters_[kLetters] = {};
  NameSlot slots_[kSlots] = {};
};

// Of a task with its own robots, and with any: two of 64 links have 768 rows.
using OwnOptionTable = SizedOptionTable<256, 256 * 24>;
using ChosenOptionTable = SizedOptionTable<1024>;

}  // namespace rdm
