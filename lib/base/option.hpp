// Typed options by string key: declared once in a table with default, bounds and help, given by a host as
// a list, read back as values. Discovery, `--help` and the README print the same table.
#pragma once
#include <cstdint>

#include "base/host.hpp"

namespace rdm {

enum class OptionKind : int32_t { kNumber = 0, kInteger = 1, kFlag = 2, kText = 3 };

// One row of an option table. Static data: the strings outlive the library.
struct OptionSpec {
  const char* key;
  OptionKind kind;
  double number;         // default of number, integer and flag
  double low, high;      // bounds, inclusive; unused for text
  const char* text;      // default of a text option, else null
  const char* choices;   // text: allowed words separated by '|', or null for free text
  const char* help;      // one line with unit
  bool live;             // may change after creation (rdm_agent_set)
  int32_t longest = 63;  // characters of a text
  bool chooses = false;  // what other rows the table has follows from it
};

constexpr OptionSpec number_option(const char* key, double value, double low, double high, const char* help,
                                   bool live = false) {
  return {key, OptionKind::kNumber, value, low, high, nullptr, nullptr, help, live};
}
constexpr OptionSpec integer_option(const char* key, double value, double low, double high, const char* help,
                                    bool live = false) {
  return {key, OptionKind::kInteger, value, low, high, nullptr, nullptr, help, live};
}
constexpr OptionSpec flag_option(const char* key, bool value, const char* help, bool live = false) {
  return {key, OptionKind::kFlag, value ? 1.0 : 0.0, 0, 1, nullptr, nullptr, help, live};
}
inline constexpr int kOptionTextSize = 64;
constexpr OptionSpec text_option(const char* key, const char* value, const char* choices, const char* help,
                                 int32_t longest = kOptionTextSize - 1) {
  return {key, OptionKind::kText, 0, 0, 0, value, choices, help, false, longest};
}

// What a host gives: either a number (number, integer, flag) or a text. A text for a numeric option is
// parsed ("0.5", "true").
struct OptionInput {
  const char* key;
  const char* text;  // null: use number
  double number;
};

// The values of one or more tables, after the host's list was laid over the defaults.
class Options {
 public:
  // Error(kNotFound) with the nearest key for an unknown key, kRange outside the bounds or the choices,
  // kArgument for a value that cannot be read or is not finite. Later duplicates win.
  void add_table(const OptionSpec* specs, int32_t count);
  // Makes room for `rows` rows in all: one block of bytes(rows) from the host.
  void reserve(int32_t rows) { rows_.reserve(static_cast<size_t>(rows)); }
  static size_t bytes(int32_t rows) { return static_cast<size_t>(rows) * sizeof(Row); }
  void set(const OptionInput& input, const char* owner);
  // Lines key=value; spaces about either, '\r' and empty lines do not count. NULL: none. The errors of set,
  // with the number of the line; kArgument for a line without '='.
  void set_lines(const char* lines, const char* owner);
  // The same for what a host gives, but for keys that are unknown: those are left for another table.
  void set_known(const OptionInput* inputs, int32_t count, const char* lines, const char* owner);
  bool chosen() const;  // a row that chooses others was given
  bool knows(const char* key) const { return find(key) >= 0; }

  double number(const char* key) const;
  int32_t integer(const char* key) const;
  bool flag(const char* key) const;
  const char* text(const char* key) const;
  bool given(const char* key) const;  // set by the host, not the default

  int32_t count() const { return static_cast<int32_t>(rows_.size()); }
  const OptionSpec& spec(int32_t i) const { return *rows_[static_cast<size_t>(i)].spec; }
  // Current value as text ("0.5", "true", "egg") of kOptionTextSize bytes, which reads back exactly. False
  // for a text that is longer: it is cut.
  bool print(int32_t i, char* out) const;
  // All values as lines for set_lines, into at most `capacity` bytes (none when it is less than all need);
  // the length without terminator.
  size_t print_lines(char* out, size_t capacity) const;
  // Changes the default of one key (a task's or an algorithm's own default); bounds are checked.
  void set_default(const char* key, double number);
  void set_default(const char* key, const char* text);

 private:
  void each_line(const char* lines, const char* owner, bool known);
  struct Row {
    const OptionSpec* spec;
    double number;
    char text[kOptionTextSize];
    Vector<char> long_text;  // in place of `text`, where that is too short
    bool given;
  };
  int32_t find(const char* key) const;
  const Row& need(const char* key, OptionKind kind) const;
  static void write(Row& row, const char* text);  // without the spaces at its ends
  void assign(Row& row, const OptionInput& input, const char* owner) const;
  Vector<Row> rows_;
};

// Keys and names match without regard to case, and '-' equals '_'.
bool same_name(const char* a, const char* b);
// Index of the nearest name by edit distance, -1 when none is near: about a third of its letters differ, or
// one of both begins with the other (three letters or more).
int32_t nearest_name(const char* name, const char* const* names, int32_t count);

// What an error text says of a name that is unknown: "; nearest is ppo_lag", or "" when none is near.
struct Nearest {
  Nearest(const char* name, const char* const* names, int32_t count);
  char text[2 * kOptionTextSize];
};

}  // namespace rdm
