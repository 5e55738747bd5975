#include "base/option.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>

#include "base/chars.hpp"
#include "base/error.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

constexpr char kAnyName[] = ".FIELD";

void print_range(const OptionRange& v, char* out) {
  if (v.drawn())
    print_text(out, kOptionTextSize, "%s..%s", Number(v.low).text, Number(v.high).text);
  else
    copy_text(out, kOptionTextSize, Number(v.low).text);
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

// Of a number, integer or flag; not strtod: a host may have set a locale with a decimal comma.
bool read_number(const char* begin, const char* end, double* out) {
  if (begin < end && *begin == '+') ++begin;
  const auto [stop, error] = from_chars(begin, end, *out);
  return error == std::errc() && stop == end;
}

// A text as the value of a number, integer or flag: "0.5", "true", "0.7..1.3".
void read_value(const OptionSpec& s, const char* key, const char* text, const char* owner, OptionRange* out) {
  const char *end = text + std::strlen(text), *dots = std::strstr(text, "..");
  bool good = false;
  if (s.kind == OptionKind::kFlag && (same_name(text, "true") || same_name(text, "on"))) {
    out->low = 1, good = true;
  } else if (s.kind == OptionKind::kFlag && (same_name(text, "false") || same_name(text, "off"))) {
    out->low = 0, good = true;
  } else if (!dots) {
    good = read_number(text, end, &out->low);
  } else {
    const char *first_end = dots, *second = dots + 2;
    while (first_end > text && first_end[-1] == ' ') --first_end;
    while (*second == ' ') ++second;
    good = read_number(text, first_end, &out->low) && read_number(second, end, &out->high);
    if (good && !s.range) fail(Code::kArgument, "%s option %s: it takes one number, not a range", owner, key);
  }
  if (!good && s.kind == OptionKind::kFlag)
    fail(Code::kArgument, "%s option %s: '%s' is not one of true, false, on, off, 1, 0", owner, key,
         Quoted(text).text);
  if (!good)
    fail(Code::kArgument, "%s option %s: '%s' is not a number%s", owner, key, Quoted(text).text,
         s.range ? " or a range a..b" : "");
  if (!dots) out->high = out->low;
}

// Which of the '|'-separated `choices` the word is, from 0; -1: none. out gets the spelling of the list.
int32_t find_choice(const char* choices, const char* word, char* out) {
  int32_t i = 0;
  for (const char* p = choices; *p; ++i) {
    const char* end = std::strchr(p, '|');
    const size_t n = end ? static_cast<size_t>(end - p) : std::strlen(p);
    char choice[kOptionTextSize];
    print_text(choice, sizeof choice, "%.*s", static_cast<int>(n), p);
    if (same_name(choice, word)) {
      std::strcpy(out, choice);
      return i;
    }
    p += n + (end ? 1 : 0);
  }
  return -1;
}

}  // namespace

size_t Options::held_bytes() const {
  size_t bytes = rows_.capacity() * sizeof(Row) + slots_.capacity() * sizeof(NameSlot);
  for (const Row& r : rows_) bytes += r.long_text.capacity() + r.own_key.capacity();
  return bytes;
}

void Options::make_index() {
  slots_.assign(std::bit_ceil(2 * std::min(rows_.capacity(), kMostIndexed)), {});
  for (int32_t i = 0; i < count(); ++i) add_indexed(slots_.data(), slots_.size(), key(i), i);
}

void Options::push(const Row& row) {
  if (rows_.size() == kMostIndexed)
    fail(Code::kRange, "options: there are more than %d", static_cast<int>(kMostIndexed));
  rows_.push_back(row);
  if (2 * rows_.size() > slots_.size()) return make_index();
  add_indexed(slots_.data(), slots_.size(), key_of(row), count() - 1);
}

// The open row that this key is one of: up to the last '.' of the row's key they agree.
const OptionSpec* Options::find_open(const char* key) const {
  for (const Row& r : rows_) {
    if (!r.spec->open || !r.own_key.empty()) continue;
    const size_t n = static_cast<size_t>(std::strrchr(r.spec->key, '.') - r.spec->key) + 1;
    size_t same = 0;
    while (same < n && fold_letter(key[same]) == fold_letter(r.spec->key[same])) ++same;
    if (same == n && key[n]) return r.spec;
  }
  return nullptr;
}

const char* Options::open_name(int32_t i) const {
  const Row& r = row(i);
  return r.own_key.empty() ? nullptr : r.own_key.data() + (std::strrchr(r.spec->key, '.') - r.spec->key) + 1;
}

void Options::add_table(const OptionSpec* specs, int32_t count) {
  for (int32_t i = 0; i < count; ++i) {
    if (find(specs[i].key) >= 0) fail(Code::kInternal, "option %s is declared twice", specs[i].key);
    Row row{&specs[i], {specs[i].number, specs[i].number}, "", {}, {}, false};
    if (specs[i].text && specs[i].kind == OptionKind::kText)
      write(row, specs[i].text);
    else if (specs[i].text)
      assign(row, {specs[i].key, specs[i].text, 0}, "default");
    push(row);
  }
}

void Options::write(Row& row, const char* text) {
  while (*text == ' ') ++text;
  size_t length = std::strlen(text);
  while (length > 0 && text[length - 1] == ' ') --length;
  row.long_text.clear();
  row.long_text.shrink_to_fit();
  if (length >= sizeof row.text) {
    row.long_text.reserve(length + 1);  // held_bytes depends on what is set alone, not on how often
    row.long_text.assign(text, text + length);
    row.long_text.push_back('\0');
    text = row.long_text.data();
    length = sizeof row.text - 1;
  }
  copy_text(row.text, length + 1, text);
}

void Options::assign(Row& row, const OptionInput& input, const char* owner) const {
  const OptionSpec& s = *row.spec;
  const char* key = key_of(row);
  if (s.kind == OptionKind::kText) {
    if (!input.text) fail(Code::kArgument, "%s option %s: its text is NULL", owner, key);
    if (std::strlen(input.text) > static_cast<size_t>(s.longest))
      fail(Code::kRange, "%s option %s: its text is longer than %d characters", owner, key, s.longest);
    if (!is_clean_text(input.text))
      fail(Code::kArgument, "%s option %s: '%s' is not one line of UTF-8", owner, key,
           Quoted(input.text).text);
    if (!s.choices)
      write(row, input.text);
    else if (find_choice(s.choices, input.text, row.text) < 0)
      fail(Code::kRange, "%s option %s: '%s' is not one of %s", owner, key, Quoted(input.text).text,
           s.choices);
    return;
  }
  OptionRange v{input.number, input.number};
  if (input.text) read_value(s, key, input.text, owner, &v);
  for (const double x : {v.low, v.high}) {
    if (!std::isfinite(x)) fail(Code::kArgument, "%s option %s: its value is not finite", owner, key);
    if (x < s.low || x > s.high)
      fail(Code::kRange, "%s option %s: %s is outside [%s, %s]", owner, key, Number(x).text,
           Number(s.low).text, Number(s.high).text);
    if (s.kind != OptionKind::kNumber && x != std::floor(x))
      fail(Code::kRange, "%s option %s: %s is not a whole number", owner, key, Number(x).text);
  }
  if (v.low > v.high)
    fail(Code::kRange, "%s option %s: the range %s..%s begins above its end", owner, key, Number(v.low).text,
         Number(v.high).text);
  row.value = v;
}

void Options::set(const OptionInput& input, const char* owner) {
  if (!input.key) fail(Code::kArgument, "%s option: its key is NULL", owner);
  if (const OptionSpec* open = find_open(input.key)) return set_open(*open, input, owner);
  const int32_t i = find(input.key);
  if (i < 0) {
    Vector<const char*> keys;
    for (const Row& r : rows_) keys.push_back(key_of(r));
    const auto count = static_cast<int32_t>(keys.size());
    Nearest near(input.key, keys.data(), count);
    if (const char* dot = std::strchr(input.key, '.'); dot && !*near.text) {  // perhaps of an open row
      Vector<char> word(input.key, dot);
      word.insert(word.end(), kAnyName, kAnyName + sizeof kAnyName);
      near = Nearest(word.data(), keys.data(), count);
    }
    fail(Code::kNotFound, "%s option %s: unknown%s", owner, Quoted(input.key).text, near.text);
  }
  Row& row = rows_[static_cast<size_t>(i)];
  assign(row, input, owner);
  row.given = true;
}

// What is set last stands last, whatever was set for the same name before.
void Options::set_open(const OptionSpec& spec, const OptionInput& input, const char* owner) {
  if (std::strlen(input.key) >= kOptionTextSize)
    fail(Code::kRange, "%s option %s: its text is longer than %d characters", owner, Quoted(input.key).text,
         kOptionTextSize - 1);
  if (!is_clean_text(input.key) || std::strchr(input.key, '='))
    fail(Code::kArgument, "%s option %s: it is not a key", owner, Quoted(input.key).text);
  Row row{&spec, {}, "", {}, {}, true};
  row.own_key.assign(input.key, input.key + std::strlen(input.key) + 1);
  assign(row, input, owner);
  // the declared row itself, as lists of all options have it
  if (same_name(input.key, spec.key) && row.value.low == spec.number && !row.value.drawn()) return;
  const auto same = [&](const Row& r) {
    return !r.own_key.empty() && same_name(r.own_key.data(), input.key);
  };
  if (const auto old = std::find_if(rows_.begin(), rows_.end(), same); old != rows_.end()) {
    rows_.erase(old);
    make_index();
  }
  push(row);
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
    bool has_key = false;
    try {
      has_key = split_line(at, end, &key, &value);
    } catch (const Error& e) {
      fail(e.code, "settings line %d: %s", number, e.text);
    }
    // what is wrong with a value names its key: a host that holds a map knows of no lines
    if (has_key && (!known || knows(key.data()))) set({key.data(), value.data(), 0}, owner);
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
  return need(key, OptionKind::kNumber).value.middle();
}
int32_t Options::integer(const char* key) const {
  return static_cast<int32_t>(std::floor(need(key, OptionKind::kInteger).value.middle()));
}
OptionRange Options::range(const char* key) const {
  const int32_t i = find(key);
  return need(key,
              i >= 0 && spec(i).kind == OptionKind::kInteger ? OptionKind::kInteger : OptionKind::kNumber)
      .value;
}
bool Options::flag(const char* key) const {
  return need(key, OptionKind::kFlag).value.low != 0;
}
const char* Options::text(const char* key) const {
  const Row& row = need(key, OptionKind::kText);
  return row.long_text.empty() ? row.text : row.long_text.data();
}
int32_t Options::word(const char* key) const {
  const Row& row = need(key, OptionKind::kText);
  char spelling[kOptionTextSize];
  const int32_t i = row.spec->choices ? find_choice(row.spec->choices, row.text, spelling) : -1;
  if (i < 0) fail(Code::kInternal, "option %s: its default is none of its choices", key);
  return i;
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
    print_text(out, kOptionTextSize, "%s", r.value.low != 0 ? "true" : "false");
  else
    print_range(r.value, out);
  return r.long_text.empty();
}

size_t Options::print_lines(char* out, size_t capacity) const {
  size_t length = 0;
  const int32_t level = find("level");
  const bool drawn = level >= 0 && rows_[static_cast<size_t>(level)].value.low > 0;
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
      if (spec(i).open && !open_name(i)) continue;
      // given by its own value, the level would no more draw it
      if (drawn && spec(i).levelled && !given(i)) continue;
      if (spec(i).if_given && !given(i)) continue;
      char text[kOptionTextSize];
      const char* value = print(i, text) ? text : rows_[static_cast<size_t>(i)].long_text.data();
      put(key(i), std::strlen(key(i)));
      put("=", 1);
      put(value, std::strlen(value));
      put("\n", 1);
    }
    if (writes) *at = '\0';
  }
  return length;
}

Vector<char> Options::lines() const {
  Vector<char> out(print_lines(nullptr, 0) + 1);
  print_lines(out.data(), out.size());
  return out;
}

const char* shield_key(const char* key) {
  constexpr char kOwner[] = "shield:";
  return std::strncmp(key, kOwner, sizeof kOwner - 1) == 0 ? key + sizeof kOwner - 1 : nullptr;
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
