#include "base/option.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "base/error.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

char fold(char c) {
  if (c == '-') return '_';
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

int edit_distance(const char* a, const char* b) {
  constexpr size_t kMax = 64;
  const size_t n = std::min(std::strlen(a), kMax), m = std::min(std::strlen(b), kMax);
  int row[kMax + 1];
  for (size_t j = 0; j <= m; ++j) row[j] = static_cast<int>(j);
  for (size_t i = 1; i <= n; ++i) {
    int diagonal = row[0];
    row[0] = static_cast<int>(i);
    for (size_t j = 1; j <= m; ++j) {
      const int substitute = diagonal + (fold(a[i - 1]) != fold(b[j - 1]));
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, substitute});
    }
  }
  return row[m];
}

// Nine digits where they are enough, else as few as read back exactly.
void print_number(double v, char* out) {
  char* const last = out + kOptionTextSize - 1;
  const char* end = std::to_chars(out, last, v, std::chars_format::general, 9).ptr;
  double back = 0;
  std::from_chars(out, end, back);
  if (back != v) end = std::to_chars(out, last, v).ptr;
  out[end - out] = '\0';
}

bool is_near(const char* name, const char* known, int distance) {
  const size_t a = std::strlen(name), b = std::strlen(known), common = std::min(a, b);
  if (3 * static_cast<size_t>(distance) <= std::max(a, b) + 2) return true;
  size_t same = 0;
  while (same < common && fold(name[same]) == fold(known[same])) ++same;
  return same == common && common >= 3;
}

// The line from `begin` to `end` as key and value, blanks about them cut off; false when it is empty.
bool split_line(const char* begin, const char* end, Vector<char>* key, Vector<char>* value) {
  const auto blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  const auto trimmed = [&](const char* from, const char* to, Vector<char>* out) {
    while (from < to && blank(*from)) ++from;
    while (from < to && blank(to[-1])) --to;
    out->assign(from, to);
    out->push_back('\0');
  };
  trimmed(begin, end, key);
  if (key->size() == 1) return false;
  const char* equals = std::find(begin, end, '=');
  if (equals == end) fail(Code::kArgument, "'%s' is not key=value", Quoted(key->data()).text);
  trimmed(begin, equals, key);
  trimmed(equals + 1, end, value);
  return true;
}

// True when `word` is one of the '|'-separated `choices`; out gets the spelling of the list.
bool match_choice(const char* choices, const char* word, char* out) {
  for (const char* p = choices; *p;) {
    const char* end = std::strchr(p, '|');
    const size_t n = end ? static_cast<size_t>(end - p) : std::strlen(p);
    char choice[kOptionTextSize];
    std::snprintf(choice, sizeof choice, "%.*s", static_cast<int>(n), p);
    if (same_name(choice, word)) {
      std::strcpy(out, choice);
      return true;
    }
    p += n + (end ? 1 : 0);
  }
  return false;
}

}  // namespace

bool same_name(const char* a, const char* b) {
  for (; *a && *b; ++a, ++b)
    if (fold(*a) != fold(*b)) return false;
  return *a == *b;
}

int32_t nearest_name(const char* name, const char* const* names, int32_t count) {
  int32_t best = -1;
  int least = 1 << 30;
  for (int32_t i = 0; i < count; ++i) {
    const int d = edit_distance(name, names[i]);
    if (d < least && is_near(name, names[i], d)) least = d, best = i;
  }
  return best;
}

Nearest::Nearest(const char* name, const char* const* names, int32_t count) {
  const int32_t near = nearest_name(name, names, count);
  std::snprintf(text, sizeof text, "%s%s", near >= 0 ? "; nearest is " : "", near >= 0 ? names[near] : "");
}

int32_t Options::find(const char* key) const {
  for (size_t i = 0; i < rows_.size(); ++i)
    if (same_name(rows_[i].spec->key, key)) return static_cast<int32_t>(i);
  return -1;
}

void Options::add_table(const OptionSpec* specs, int32_t count) {
  for (int32_t i = 0; i < count; ++i) {
    if (find(specs[i].key) >= 0) fail(Code::kInternal, "option %s is declared twice", specs[i].key);
    Row row{&specs[i], specs[i].number, "", {}, false};
    if (specs[i].text) write(row, specs[i].text);
    rows_.push_back(row);
  }
}

void Options::write(Row& row, const char* text) {
  while (*text == ' ') ++text;
  size_t length = std::strlen(text);
  while (length > 0 && text[length - 1] == ' ') --length;
  row.long_text.clear();
  if (length >= sizeof row.text) {
    row.long_text.assign(text, text + length);
    row.long_text.push_back('\0');
    text = row.long_text.data();
    length = sizeof row.text - 1;
  }
  copy_text(row.text, length + 1, text);
}

void Options::assign(Row& row, const OptionInput& input, const char* owner) const {
  const OptionSpec& s = *row.spec;
  if (s.kind == OptionKind::kText) {
    if (!input.text) fail(Code::kArgument, "%s option %s: a text is needed", owner, s.key);
    if (std::strlen(input.text) > static_cast<size_t>(s.longest))
      fail(Code::kRange, "%s option %s: longer than %d characters", owner, s.key, s.longest);
    if (!is_clean_text(input.text))
      fail(Code::kArgument, "%s option %s: '%s' is not one line of UTF-8", owner, s.key,
           Quoted(input.text).text);
    if (!s.choices)
      write(row, input.text);
    else if (!match_choice(s.choices, input.text, row.text))
      fail(Code::kRange, "%s option %s: '%s' is not one of %s", owner, s.key, Quoted(input.text).text,
           s.choices);
    return;
  }
  double v = input.number;
  if (input.text) {
    // Not strtod: a host may have set a locale with a decimal comma.
    const char* begin = input.text + (input.text[0] == '+' ? 1 : 0);
    const char* stop = input.text + std::strlen(input.text);
    const auto [end, error] = std::from_chars(begin, stop, v);
    if (s.kind == OptionKind::kFlag && (same_name(input.text, "true") || same_name(input.text, "on")))
      v = 1;
    else if (s.kind == OptionKind::kFlag && (same_name(input.text, "false") || same_name(input.text, "off")))
      v = 0;
    else if (error != std::errc() || end != stop)
      fail(Code::kArgument, "%s option %s: '%s' is not a number", owner, s.key, Quoted(input.text).text);
  }
  if (!std::isfinite(v)) fail(Code::kArgument, "%s option %s: the value is not finite", owner, s.key);
  if (v < s.low || v > s.high)
    fail(Code::kRange, "%s option %s: %.9g is outside [%.9g, %.9g]", owner, s.key, v, s.low, s.high);
  if (s.kind != OptionKind::kNumber && v != std::floor(v))
    fail(Code::kRange, "%s option %s: %.9g is not a whole number", owner, s.key, v);
  row.number = v;
}

void Options::set(const OptionInput& input, const char* owner) {
  if (!input.key) fail(Code::kArgument, "%s option: the key is NULL", owner);
  const int32_t i = find(input.key);
  if (i < 0) {
    Vector<const char*> keys;
    for (const Row& r : rows_) keys.push_back(r.spec->key);
    fail(Code::kNotFound, "%s option %s: unknown%s", owner, Quoted(input.key).text,
         Nearest(input.key, keys.data(), static_cast<int32_t>(keys.size())).text);
  }
  Row& row = rows_[static_cast<size_t>(i)];
  assign(row, input, owner);
  row.given = true;
}

void Options::set_lines(const char* lines, const char* owner) {
  each_line(lines, owner, false);
}

void Options::set_known(const OptionInput* inputs, int32_t count, const char* lines, const char* owner) {
  for (int32_t i = 0; i < count; ++i)
    if (inputs[i].key && knows(inputs[i].key)) set(inputs[i], owner);
  each_line(lines, owner, true);
}

bool Options::chosen() const {
  return std::any_of(rows_.begin(), rows_.end(), [](const Row& r) { return r.given && r.spec->chooses; });
}

// `known`: other lines are left out.
void Options::each_line(const char* lines, const char* owner, bool known) {
  Vector<char> key, value;
  int32_t number = 0;
  for (const char* at = lines; at && *at;) {
    const char* end = at + std::strcspn(at, "\n");
    ++number;
    try {
      if (split_line(at, end, &key, &value) && (!known || knows(key.data())))
        set({key.data(), value.data(), 0}, owner);
    } catch (const Error& e) {
      fail(e.code, "settings line %d: %s", number, e.text);
    }
    at = *end ? end + 1 : end;
  }
}

const Options::Row& Options::need(const char* key, OptionKind kind) const {
  const int32_t i = find(key);
  if (i < 0 || rows_[static_cast<size_t>(i)].spec->kind != kind)
    fail(Code::kInternal, "option %s is not declared with this kind", key);
  return rows_[static_cast<size_t>(i)];
}

double Options::number(const char* key) const {
  return need(key, OptionKind::kNumber).number;
}
int32_t Options::integer(const char* key) const {
  return static_cast<int32_t>(need(key, OptionKind::kInteger).number);
}
bool Options::flag(const char* key) const {
  return need(key, OptionKind::kFlag).number != 0;
}
const char* Options::text(const char* key) const {
  const Row& row = need(key, OptionKind::kText);
  return row.long_text.empty() ? row.text : row.long_text.data();
}
bool Options::given(const char* key) const {
  const int32_t i = find(key);
  return i >= 0 && rows_[static_cast<size_t>(i)].given;
}

bool Options::print(int32_t i, char* out) const {
  const Row& r = rows_[static_cast<size_t>(i)];
  if (r.spec->kind == OptionKind::kText)
    copy_text(out, kOptionTextSize, r.text);
  else if (r.spec->kind == OptionKind::kFlag)
    std::snprintf(out, kOptionTextSize, "%s", r.number != 0 ? "true" : "false");
  else
    print_number(r.number, out);
  return r.long_text.empty();
}

size_t Options::print_lines(char* out, size_t capacity) const {
  size_t length = 0;
  for (const bool writes : {false, true}) {
    if (writes && length >= capacity) break;
    char* at = out;
    const auto put = [&](const char* text, size_t n) {
      if (writes)
        at = std::copy_n(text, n, at);
      else
        length += n;
    };
    for (int32_t i = 0; i < count(); ++i) {
      char text[kOptionTextSize];
      const char* value = print(i, text) ? text : rows_[static_cast<size_t>(i)].long_text.data();
      put(spec(i).key, std::strlen(spec(i).key));
      put("=", 1);
      put(value, std::strlen(value));
      put("\n", 1);
    }
    if (writes) *at = '\0';
  }
  return length;
}

void Options::set_default(const char* key, double number) {
  const int32_t i = find(key);
  if (i < 0) fail(Code::kInternal, "option %s is not declared", key);
  Row& row = rows_[static_cast<size_t>(i)];
  if (!row.given) assign(row, {key, nullptr, number}, "default");
}

void Options::set_default(const char* key, const char* text) {
  const int32_t i = find(key);
  if (i < 0) fail(Code::kInternal, "option %s is not declared", key);
  Row& row = rows_[static_cast<size_t>(i)];
  if (!row.given) assign(row, {key, text, 0}, "default");
}

}  // namespace rdm
