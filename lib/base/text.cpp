#include "base/text.hpp"

#include <cstdint>
#include <cstdio>
#include <cstring>

#include "base/chars.hpp"

namespace rdm {
namespace {

// Bytes that a character beginning with `lead` takes, 0 where none begins so (Unicode 15, table 3-7).
size_t length_of(unsigned char lead) {
  if (lead < 0x80) return 1;
  if (lead >= 0xC2 && lead <= 0xDF) return 2;
  if (lead >= 0xE0 && lead <= 0xEF) return 3;
  return lead >= 0xF0 && lead <= 0xF4 ? 4 : 0;
}

// The next byte after `lead` has a narrower range where overlong forms, surrogates or values above U+10FFFF
// would begin.
bool follows(unsigned char lead, size_t at, unsigned char byte) {
  unsigned char low = 0x80, high = 0xBF;
  if (at == 1 && lead == 0xE0) low = 0xA0;
  if (at == 1 && lead == 0xED) high = 0x9F;
  if (at == 1 && lead == 0xF0) low = 0x90;
  if (at == 1 && lead == 0xF4) high = 0x8F;
  return byte >= low && byte <= high;
}

// Bytes of the whole character at p, 0 when there is none. `cut`: the text ends before it is whole.
size_t character(const unsigned char* p, bool* cut) {
  const size_t n = length_of(p[0]);
  *cut = false;
  for (size_t i = 1; i < n; ++i) {
    if (p[i] == '\0') *cut = true;
    if (!follows(p[0], i, p[i])) return 0;
  }
  return n;
}

// C0, DEL and C1, of the character of n bytes at p.
bool is_control(const unsigned char* p, size_t n) {
  return *p < 0x20 || *p == 0x7F || (n == 2 && p[0] == 0xC2 && p[1] < 0xA0);
}

}  // namespace

bool is_clean_text(const char* text) {
  bool cut;
  size_t n;
  for (const auto* p = reinterpret_cast<const unsigned char*>(text); *p; p += n)
    if ((n = character(p, &cut)) == 0 || is_control(p, n)) return false;
  return true;
}

bool clean_text(char* out, size_t size, const char* text) {
  const auto* p = reinterpret_cast<const unsigned char*>(text);
  size_t left = size - 1;
  bool cut;
  while (*p) {
    const size_t n = character(p, &cut), room = n ? n : 4;
    if (room > left) break;
    if (n == 0)
      std::snprintf(out, room + 1, "\\x%02x", static_cast<unsigned>(*p));
    else if (is_control(p, n))
      std::memset(out, ' ', n);
    else
      std::memcpy(out, p, n);
    p += n ? n : 1;
    out += room;
    left -= room;
  }
  *out = '\0';
  return *p == '\0';
}

void copy_text(char* out, size_t size, const char* text) {
  size_t n = std::strlen(text);
  if (n >= size) {
    n = size - 1;
    // back to the first byte of the character that is cut, if there is one
    size_t lead = n;
    while (lead > 0 && n - lead < 3 && (static_cast<unsigned char>(text[lead]) & 0xC0) == 0x80) --lead;
    bool cut;
    const auto* p = reinterpret_cast<const unsigned char*>(text + lead);
    if (lead + character(p, &cut) > n) n = lead;
  }
  std::memcpy(out, text, n);
  out[n] = '\0';
}

Quoted::Quoted(const char* name) {
  if (!name) name = "NULL";
  if (!clean_text(text, sizeof text - 3, name)) std::strcat(text, "...");
}

Number::Number(double v) {
  char* const last = text + sizeof text - 1;
  char* end = to_chars(text, last, v, 9).ptr;
  double back = 0;
  from_chars(text, end, back);
  if (back != v) end = to_chars(text, last, v).ptr;
  *end = '\0';
}

}  // namespace rdm
