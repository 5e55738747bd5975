#include "toml_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>

#include "base/format.hpp"

namespace rdm::import {

namespace {

constexpr size_t kMostValues = 400000;  // each becomes about 100 bytes
constexpr size_t kMostParts = 64;       // of a dotted key: each is a table in a table, which end by recursion

// Counted without the parser, and so rather too many: in texts and comments too.
void check_cost(const std::string& bytes) {
  size_t values = 0, parts = 0;
  int line = 1;
  bool key = true;  // what stands before a line's '='
  for (const char c : bytes) {
    if (c == '\n')
      ++line, parts = 0, key = true;
    else if (c == ',' || c == '[' || c == '{' || c == '=')
      ++values, parts = 0, key = c != '=';
    else if (c == '.' && key)  // a.b.c = is a table in a table in a table
      ++parts;
    else if (c == '#' && parts == 0)  // the dots of a comment are none of a key
      key = false;
    if (parts > kMostParts)
      refuse(RDM_ERROR_RANGE, "line %d: a key has more than %zu parts", line, kMostParts);
    if (values > kMostValues)
      refuse(RDM_ERROR_RANGE, "line %d: there are more than %zu values", line, kMostValues);
  }
}

}  // namespace

void parser_fault() {
  throw ParserFault{};
}

toml::table parse_toml(const std::string& bytes) {
  if (bytes.size() > kMostToml) refuse(RDM_ERROR_RANGE, "it has more than %zu bytes", kMostToml);
  check_cost(bytes);
  try {
    toml::parse_result first = toml::parse(std::string_view(bytes));
    if (first) return std::move(first).table();
    // The parser's streams take refused memory for a wrong number: what is wrong is wrong a second time.
    const toml::parse_result again = toml::parse(std::string_view(bytes));
    const toml::parse_error& e = first.error();
    if (again || again.error().source().begin != e.source().begin) throw std::bad_alloc();
    refuse(RDM_ERROR_FORMAT, "line %d: %s", line_of(e.source()),
           clean(std::string(e.description()), 200).c_str());
  } catch (const ParserFault&) {
    refuse(RDM_ERROR_FORMAT, "line %ld: this is not TOML", std::count(bytes.begin(), bytes.end(), '\n') + 1);
  }
}

void Table::bad(rdm_result code, int line, const char* pattern, ...) const {
  char text[400];
  va_list list;
  va_start(list, pattern);
  print_list(text, sizeof text, pattern, list);
  va_end(list);
  refuse(code, "line %d: %s%s%s", line, what.c_str(), what.empty() ? "" : ": ", text);
}

void Table::only(const std::vector<const char*>& known) const {
  for (const auto& [key, value] : t) {
    const std::string name(key.str());
    bool found = false;
    std::vector<std::string> names;
    for (const char* k : known) found = found || name == k, names.emplace_back(k);
    if (!found)
      bad(RDM_ERROR_FORMAT, line_of(key.source()), "%s is not a known key%s", clean(name).c_str(),
          nearest_hint(name, names).c_str());
  }
}

const toml::node& Table::need(const char* key) const {
  const toml::node* n = find(key);
  if (!n) bad(RDM_ERROR_FORMAT, line_of(t), "%s is missing", key);
  return *n;
}

double Table::as_number(const toml::node& n, const char* key) const {
  if (const auto* x = n.as_floating_point()) return x->get();
  if (const auto* x = n.as_integer())  // beyond 2^53 a double would be another number
    if (std::abs(static_cast<double>(x->get())) <= 9007199254740992.0) return static_cast<double>(x->get());
  // "$mass" is the option of that name. While the task is registered there is no lookup: no option has a value.
  if (const auto* x = n.as_string(); x && lookup && x->get().size() > 1 && x->get()[0] == '$') {
    try {
      return lookup->number(x->get().substr(1));
    } catch (const Refusal& r) {
      bad(r.code, line_of(n), "%s: %s", key, r.text.c_str());
    }
  }
  bad(RDM_ERROR_FORMAT, line_of(n), "%s is not a number", key);
}

int32_t Table::integer(const char* key, int32_t otherwise, int32_t low, int32_t high) const {
  const toml::node* n = find(key);
  if (!n) return otherwise;
  const double x = as_number(*n, key);
  if (!(x >= low && x <= high) || x != std::floor(x))
    bad(RDM_ERROR_RANGE, line_of(*n), "%s: %g is not a whole number in [%d, %d]", key, x, low, high);
  return static_cast<int32_t>(x);
}

bool Table::flag(const char* key, bool otherwise) const {
  const toml::node* n = find(key);
  if (!n) return otherwise;
  if (const auto* x = n->as_boolean()) return x->get();
  if (const auto* x = n->as_string(); x && lookup && x->get().size() > 1 && x->get()[0] == '$')
    return as_number(*n, key) != 0;
  bad(RDM_ERROR_FORMAT, line_of(*n), "%s is neither true nor false", key);
}

std::vector<double> Table::list(const toml::node& n, const char* key, size_t least, size_t most) const {
  const toml::array* a = n.as_array();
  if (!a || a->size() < least || a->size() > most)
    bad(RDM_ERROR_FORMAT, line_of(n),
        least == most ? "%s is not a list of %zu numbers" : "%s is not a list of %zu to %zu numbers", key,
        least, most);
  std::vector<double> out;
  for (const toml::node& x : *a) out.push_back(as_number(x, key));
  return out;
}

std::string Table::as_text(const toml::node& n, const char* key) const {
  const auto* x = n.as_string();
  if (!x) bad(RDM_ERROR_FORMAT, line_of(n), "%s is not a string", key);
  // it would end the name for C, and two names could be the same
  if (x->get().find('\0') != std::string::npos)
    bad(RDM_ERROR_FORMAT, line_of(n), "%s contains a character 0", key);
  if (!lookup || x->get().size() < 2 || x->get()[0] != '$') return x->get();
  try {
    return lookup->text(x->get().substr(1));
  } catch (const Refusal& r) {
    bad(r.code, line_of(n), "%s: %s", key, r.text.c_str());
  }
}

int32_t Table::choice(const char* key, const char* const* names, int32_t count, int32_t otherwise) const {
  const toml::node* n = find(key);
  if (!n) return otherwise;
  const std::string text = as_text(*n, key);
  std::vector<std::string> all;
  for (int32_t i = 0; i < count; ++i) {
    if (text == names[i]) return i;
    all.emplace_back(names[i]);
  }
  bad(RDM_ERROR_FORMAT, line_of(*n), "%s: %s is unknown%s", key, clean(text).c_str(),
      nearest_hint(text, all).c_str());
}

std::vector<Table> Table::rows(const char* key) const {
  std::vector<Table> all;
  const toml::node* n = find(key);
  if (!n) return all;
  const toml::array* a = n->as_array();
  if (!a) bad(RDM_ERROR_FORMAT, line_of(*n), "%s must be written as [[%s]]", key, key);
  if (a->size() > kMostRows)
    bad(RDM_ERROR_RANGE, line_of(*n), "there are more than %zu rows of %s", kMostRows, key);
  for (const toml::node& x : *a) {
    const toml::table* row = x.as_table();
    if (!row) bad(RDM_ERROR_FORMAT, line_of(x), "%s must be written as [[%s]]", key, key);
    std::string name = what.empty() ? key : what + ": " + key;
    // what a reader of an error finds the row by
    for (const char* naming : {"name", "link", "term"})
      if (const toml::node* given = row->get(naming); given && given->is_string()) {
        name += ' ' + clean(given->as_string()->get());
        break;
      }
    all.push_back({*row, name, lookup});
  }
  return all;
}

Table Table::section(const char* key) const {
  static const toml::table kEmpty;  // so that all keys of a section that is not there have their defaults
  const toml::node* n = find(key);
  const std::string name = what.empty() ? key : what + ": " + key;
  if (!n) return {kEmpty, name, lookup};
  if (!n->is_table()) bad(RDM_ERROR_FORMAT, line_of(*n), "%s must be written as [%s]", key, key);
  return {*n->as_table(), name, lookup};
}

int32_t shape_kind(const Table& t, int32_t count) {
  const char* names[std::size(kShapes)];
  for (size_t i = 0; i < std::size(kShapes); ++i) names[i] = kShapes[i].name;
  t.need("kind");
  return kShapes[static_cast<size_t>(t.choice("kind", names, count, 0))].kind;
}

namespace {
size_t size_count(int32_t kind) {
  switch (kind) {
    case RDM_SHAPE_SPHERE:
      return 1;
    case RDM_SHAPE_CAPSULE:
    case RDM_SHAPE_CYLINDER:
      return 2;
    case RDM_SHAPE_BOX:
    case RDM_SHAPE_ELLIPSOID:
      return 3;
    default:
      return 0;
  }
}

}  // namespace

std::array<double, 3> used_size(int32_t kind, const double size[3]) {
  std::array<double, 3> used{};
  std::copy_n(size, size_count(kind), used.begin());
  return used;
}

void read_size(const Table& t, int32_t kind, double size[3]) {
  const bool hull = kind == RDM_SHAPE_HULL;
  if (const toml::node* n = t.find("points"); n && !hull)
    t.bad(RDM_ERROR_FORMAT, line_of(*n), "points: only a hull has points");
  const size_t used = size_count(kind);
  if (used == 0) {
    if (const toml::node* n = t.find("size"))
      t.bad(RDM_ERROR_FORMAT, line_of(*n), "size: a %s has none", hull ? "hull, which has points," : "plane");
    return;
  }
  const toml::node& n = t.need("size");
  const auto given = t.list(n, "size", 1, 3);
  for (size_t i = used; i < given.size(); ++i)
    if (given[i] != 0)
      t.bad(RDM_ERROR_FORMAT, line_of(n), "size: this kind has %zu number%s", used, used == 1 ? "" : "s");
  std::copy(given.begin(), given.end(), size);
}

bool read_color(const Table& t, uint8_t color[4]) {
  const toml::node* n = t.find("color");
  if (!n) return false;
  const auto c = t.list(*n, "color", 3, 3);
  for (size_t k = 0; k < 3; ++k) {
    if (!(c[k] >= 0 && c[k] <= 255))
      t.bad(RDM_ERROR_RANGE, line_of(*n), "color: %g is outside [0, 255]", c[k]);
    color[k] = static_cast<uint8_t>(c[k]);
  }
  color[3] = 255;
  return true;
}

}  // namespace rdm::import
