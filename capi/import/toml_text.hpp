// TOML as redman_import reads it: tables whose errors name line and key, and refuse what they do not know.
#pragma once
#include "import.hpp"

namespace rdm::import {
struct ParserFault {};  // what the parser takes to be impossible is not: it must not end the process
[[noreturn]] void parser_fault();
}  // namespace rdm::import
#undef NDEBUG
#define TOML_ASSERT(condition) ((condition) ? static_cast<void>(0) : ::rdm::import::parser_fault())
#define TOML_HEADER_ONLY 1
#define TOML_EXCEPTIONS 0  // an error that is thrown takes memory, and ends the process where there is none
#include <toml++/toml.h>

#include <initializer_list>

namespace rdm::import {

inline constexpr size_t kMostToml = size_t{1} << 22;  // bytes of a .task, .robot or .object
// FORMAT with the line for what is no TOML; RANGE, before it is parsed, for more than any of them has: commas,
// brackets and equal signs (400,000), parts of a dotted key (64).
toml::table parse_toml(const std::string& bytes);

inline int line_of(const toml::source_region& s) {
  return static_cast<int>(s.begin.line);
}
inline int line_of(const toml::node& n) {
  return line_of(n.source());
}

// What a text that begins with '$' stands for.
struct Lookup {
  virtual ~Lookup() = default;
  virtual double number(const std::string& key) const = 0;     // throws Refusal without a line
  virtual std::string text(const std::string& key) const = 0;  // likewise
};

constexpr size_t kMostRows = 4096;

struct Table {
  const toml::table& t;
  std::string what;  // "link knee"
  const Lookup* lookup = nullptr;

  [[noreturn]] [[gnu::format(printf, 4, 5)]] void bad(rdm_result code, int line, const char* pattern,
                                                      ...) const;
  void only(const std::vector<const char*>& known) const;
  const toml::node* find(const char* key) const { return t.get(key); }
  const toml::node& need(const char* key) const;
  double as_number(const toml::node& n, const char* key) const;
  void number(const char* key, double* out) const {
    if (const toml::node* n = find(key)) *out = as_number(*n, key);
  }
  int32_t integer(const char* key, int32_t otherwise, int32_t low, int32_t high) const;
  bool flag(const char* key, bool otherwise = false) const;
  std::vector<double> list(const toml::node& n, const char* key, size_t least, size_t most) const;
  void numbers(const char* key, double* out, size_t count) const {
    if (const toml::node* n = find(key)) {
      const auto x = list(*n, key, count, count);
      std::copy(x.begin(), x.end(), out);
    }
  }
  std::string as_text(const toml::node& n, const char* key) const;
  std::string text(const char* key, const char* otherwise) const {
    const toml::node* n = find(key);
    return n ? as_text(*n, key) : otherwise;
  }
  int32_t choice(const char* key, const char* const* names, int32_t count, int32_t otherwise) const;
  // [[key]]; a row's `what` is the key and its name.
  std::vector<Table> rows(const char* key) const;
  // [key], or an empty one.
  Table section(const char* key) const;
};

struct NamedKind {
  const char* name;
  int32_t kind;
};
// RDM_SPHERE ... as files name them; those that a robot's shape may have are the first kRobotShapes.
inline constexpr NamedKind kShapes[] = {
    {"sphere", RDM_SPHERE},       {"capsule", RDM_CAPSULE}, {"box", RDM_BOX},  {"cylinder", RDM_CYLINDER},
    {"ellipsoid", RDM_ELLIPSOID}, {"plane", RDM_PLANE},     {"hull", RDM_HULL}};
inline constexpr int32_t kRobotShapes = 5;
int32_t shape_kind(const Table& t, int32_t count);
// [3] of "color", each in [0, 255]; false: it is not there.
bool read_color(const Table& t, uint8_t color[4]);

// A .robot file, or a table of another file with the same keys and `others`.
void read_robot_table(const Table& file, const std::vector<const char*>& others, const Options& options,
                      Draft* out);

}  // namespace rdm::import
