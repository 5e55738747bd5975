// Typed options by string key: declared once in a table with default, bounds and help, given by a host as
// a list, read back as values. Discovery, `--help` and the pages print the same table.
//
// A number or integer that is declared as a range takes "0.7..1.3" too: what a world draws for itself at each
// reset. An open row "noise.FIELD" declares the keys "noise.NAME" for every NAME; whoever reads them says
// which names there are.
#pragma once
#include <cstdint>

#include "base/host.hpp"
#include "base/name_index.hpp"
#include "base/names.hpp"
#include "base/rng.hpp"

namespace rdm {

enum class OptionKind : int32_t { kNumber = 0, kInteger = 1, kFlag = 2, kText = 3 };
// Whom a row is for: all users, those who tune, those who compare with the paper, an older release or an engine.
enum class OptionLevel : int32_t { kBasic = 0, kAdvanced = 1, kLegacy = 2 };

// One row of an option table. Static data: the strings outlive the library.
struct OptionSpec {
  const char* key;
  OptionKind kind;
  double number;          // default of number, integer and flag
  double low, high;       // bounds, inclusive; unused for text
  const char* text;       // default of a text option; of a row that takes a range a default "a..b", else null
  const char* choices;    // text: allowed words separated by '|', or null for free text
  const char* help;       // one line with unit
  bool live;              // may change after creation (rdm_agent_set_option)
  int32_t longest = 63;   // characters of a text
  bool range = false;     // a number or integer that may be given as "a..b"
  bool levelled = false;  // option level says what is drawn of it, unless it is given
  bool open = false;      // what stands behind the last '.' of the key is any name
  bool chooses = false;   // what other rows the table has follows from it
  bool if_given = false;  // counts only where it was given: what it stands for may differ from the default
  OptionLevel level = OptionLevel::kAdvanced;
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
// The row, which then takes "a..b" as well: drawable(number_option("object_mass", 0.1, 0, 1, "kg")).
constexpr OptionSpec drawable(OptionSpec row) {
  row.range = true;
  return row;
}
// The same, of which option level draws a share unless the row is given.
constexpr OptionSpec levelled(OptionSpec row) {
  row.range = row.levelled = true;
  return row;
}
// The row of a key such as "noise.FIELD", whose last word stands for any name.
constexpr OptionSpec open_option(OptionSpec row) {
  row.open = true;
  return row;
}

// The row, from which follows what other rows there are.
constexpr OptionSpec choosing(OptionSpec row) {
  row.chooses = true;
  return row;
}

// The row, whose default is one of several values that it stands for.
constexpr OptionSpec counting_if_given(OptionSpec row) {
  row.if_given = true;
  return row;
}

// The row, which lists begin with.
constexpr OptionSpec basic(OptionSpec row) {
  row.level = OptionLevel::kBasic;
  return row;
}
// The row, which lists end with.
constexpr OptionSpec legacy(OptionSpec row) {
  row.level = OptionLevel::kLegacy;
  return row;
}

// The value of a number or integer: one number, or the bounds between which each world draws its own.
struct OptionRange {
  double low = 0, high = 0;
  bool drawn() const { return low != high; }
  double middle() const { return drawn() ? low + (high - low) / 2 : low; }
  // Uniform in [low, high); a single number takes nothing from the stream.
  double draw(Stream& stream) const { return drawn() ? stream.uniform(low, high) : low; }
  // Of an integer: uniform over low, low + 1, ... high.
  int32_t draw_integer(Stream& stream) const {
    const auto first = static_cast<int32_t>(low);
    return drawn() ? first + static_cast<int32_t>(stream.below(static_cast<uint32_t>(high - low) + 1))
                   : first;
  }
};

// What a host gives: either a number (number, integer, flag) or a text. A text for a numeric option is
// parsed ("0.5", "true", "0.7..1.3").
struct OptionInput {
  const char* key;
  const char* text;  // null: use number
  double number;
};

// Of "shield:noise", a default that a task has for shields, the key behind it; null: a default for agents.
const char* shield_key(const char* key);

// The values of one or more tables, after the host's list was laid over the defaults.
class Options {
 public:
  // Error(kNotFound) with the nearest key for an unknown key, kRange outside the bounds or the choices,
  // kArgument for a value that cannot be read or is not finite. Later duplicates win; of an open row, the key
  // that was set last is the last row.
  void add_table(const OptionSpec* specs, int32_t count);
  // Makes room for `rows` rows in all: one block for them from the host, and one to find them by.
  void reserve(int32_t rows) {
    rows_.reserve(static_cast<size_t>(rows));
    make_index();
  }
  size_t held_bytes() const;  // from the host
  void set(const OptionInput& input, const char* owner);
  // Lines key=value; spaces about either, '\r' and empty lines do not count. NULL: none. The errors of set,
  // with the number of the line; kArgument for a line without '='.
  void set_lines(const char* lines, const char* owner);
  // What a host gives: options, then lines.
  void set_all(const OptionInput* inputs, int32_t count, const char* lines, const char* owner) {
    for (int32_t i = 0; i < count; ++i) set(inputs[i], owner);
    set_lines(lines, owner);
  }
  // The same, but for keys that are unknown: those are left for another table.
  void set_known(const OptionInput* inputs, int32_t count, const char* lines, const char* owner);
  bool chosen() const;  // a row that chooses others was given
  bool knows(const char* key) const { return find(key) >= 0; }

  // Of a range the middle, for an integer rounded down: what stands where nothing is drawn.
  double number(const char* key) const;
  int32_t integer(const char* key) const;
  OptionRange range(const char* key) const;  // of a number or integer, {x, x} for a single one
  bool flag(const char* key) const;
  const char* text(const char* key) const;
  int32_t word(const char* key) const;  // of a text with choices: which of them it is, from 0
  bool given(const char* key) const;    // set by the host, not the default
  bool given(int32_t i) const { return row(i).given; }
  const OptionSpec* spec_of(const char* key) const {  // null: unknown
    const int32_t i = find(key);
    return i < 0 ? nullptr : row(i).spec;
  }

  // Rows of the tables in order, then the keys of open rows that were set.
  int32_t count() const { return static_cast<int32_t>(rows_.size()); }
  const OptionSpec& spec(int32_t i) const { return *row(i).spec; }
  const char* key(int32_t i) const { return key_of(row(i)); }
  // For a key of an open row the name that it was set for ("noise.tip_force": "tip_force"), else null.
  const char* open_name(int32_t i) const;
  OptionRange range(int32_t i) const { return row(i).value; }
  // Current value as text ("0.5", "0.7..1.3", "egg") of kOptionTextSize bytes, which reads back exactly.
  // False for a text that is longer: it is cut.
  bool print(int32_t i, char* out) const;
  // All values as lines for set_lines, but for those that count only if given and were not, and where a level
  // draws for those that it draws, into at most `capacity` bytes (none when it is less than all need); the
  // length without terminator.
  size_t print_lines(char* out, size_t capacity) const;
  Vector<char> lines() const;  // these, with the terminator
  // Changes the default of one key (a task's or an algorithm's own default); bounds are checked.
  void set_default(const char* key, double number);
  void set_default(const char* key, const char* text);

 private:
  void each_line(const char* lines, const char* owner, bool known);
  struct Row {
    const OptionSpec* spec;
    OptionRange value;
    char text[kOptionTextSize];
    Vector<char> long_text;  // in place of `text`, where that is too short
    Vector<char> own_key;    // of an open row's key that was set, else empty
    bool given;
  };
  const Row& row(int32_t i) const { return rows_[static_cast<size_t>(i)]; }
  static const char* key_of(const Row& row) {
    return row.own_key.empty() ? row.spec->key : row.own_key.data();
  }
  int32_t find(const char* key) const {
    return find_indexed(slots_.data(), slots_.size(), key, [&](int32_t i) { return key_of(row(i)); });
  }
  const OptionSpec* find_open(const char* key) const;
  void set_open(const OptionSpec& spec, const OptionInput& input, const char* owner);
  const Row& need(const char* key, OptionKind kind) const;
  static void write(Row& row, const char* text);  // without the spaces at its ends
  void assign(Row& row, const OptionInput& input, const char* owner) const;
  void push(const Row& row);
  void make_index();  // of all rows, for as many as there is room for
  Vector<Row> rows_;
  Vector<NameSlot> slots_;
};

}  // namespace rdm
