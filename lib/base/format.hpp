// printf into a buffer, with a decimal point whatever locale the host has set.
//
// Texts, notes and numbers that are read again must not depend on setlocale, which is the process's. Only the
// conversions of numbers with a point are touched: their digits are printf's.
#pragma once
#include <algorithm>
#include <cstdarg>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstring>

namespace rdm {

namespace format_parts {

// Where the text goes, cut at `size` - 1 bytes; counts what was meant.
struct Sink {
  char* out;
  size_t size, length = 0;
  void put(const char* text, size_t n) {
    for (size_t i = 0; i < n; ++i, ++length)
      if (length + 1 < size) out[length] = text[i];
  }
  void pad(size_t n) {
    for (size_t i = 0; i < n; ++i) put(" ", 1);
  }
};

// One conversion: "%-8.3f" without its length letters, which `length` has.
struct Conversion {
  char text[48] = "%";  // for printf, up to the letter
  size_t end = 1;
  char length = 0;  // 'l', 'q' for ll, 'z', 'j', 't'
  bool left = false;
  int width = 0, precision = -1;

  void add(char c) {
    if (end + 4 < sizeof text) text[end++] = c, text[end] = '\0';
  }
};

// A number's text as it stands, but for what the locale has in place of the point.
inline void put_number(Sink& sink, const char* text, size_t n) {
  const auto plain = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '+' ||
           c == '-' || c == '.' || c == ' ';
  };
  for (size_t i = 0; i < n; ++i) {
    if (plain(text[i])) {
      sink.put(text + i, 1);
      continue;
    }
    sink.put(".", 1);
    while (i + 1 < n && !plain(text[i + 1])) ++i;  // of several bytes
  }
}

template <class T>
void put_value(Sink& sink, Conversion& c, const char* letters, T value) {
  char number[512];
  while (*letters) c.add(*letters++);
  const int n = std::snprintf(number, sizeof number, c.text, value);
  put_number(sink, number, std::min(static_cast<size_t>(std::max(n, 0)), sizeof number - 1));
}

inline void put_string(Sink& sink, const Conversion& c, const char* text) {
  if (!text) text = "(null)";
  const size_t most = c.precision < 0 ? SIZE_MAX : static_cast<size_t>(c.precision);
  size_t n = 0;
  while (n < most && text[n]) ++n;
  const auto width = static_cast<size_t>(std::max(c.width, 0));
  if (!c.left && width > n) sink.pad(width - n);
  sink.put(text, n);
  if (c.left && width > n) sink.pad(width - n);
}

struct Arguments {
  va_list list;
  int integer() { return va_arg(list, int); }
};

// Reads what follows the '%' at p[-1], up to the letter; where that stands.
inline const char* read_conversion(const char* p, Arguments& args, Conversion& c) {
  bool fraction = false;
  const auto number = [&](int value) {
    (fraction ? c.precision : c.width) = value;
    char digits[16];
    std::snprintf(digits, sizeof digits, "%d", value);
    for (const char* d = digits; *d; ++d) c.add(*d);
  };
  for (; *p && !std::strchr("diuxXocspfFgGeE", *p); ++p) {
    if (std::strchr("lzjt", *p)) {
      c.length = c.length == 'l' ? 'q' : *p;
    } else if (*p == '*') {
      const int value = args.integer();
      if (value < 0 && !fraction) c.left = true, c.add('-');
      if (value >= 0 || !fraction) number(value < 0 ? -value : value);
    } else if (*p >= '1' && *p <= '9') {
      int value = 0;
      for (; *p >= '0' && *p <= '9'; ++p) value = std::min(10 * value + (*p - '0'), 1 << 20);
      --p;
      number(value);
    } else {
      if (*p == '-') c.left = true;
      if (*p == '.') fraction = true, c.precision = 0;
      c.add(*p);
    }
  }
  return p;
}

inline long long signed_argument(Arguments& args, char length) {
  switch (length) {
    case 'q':
      return va_arg(args.list, long long);
    case 'l':  // NOLINT(bugprone-branch-clone): types that are alike on some machines
      return va_arg(args.list, long);
    case 'j':
      return va_arg(args.list, intmax_t);
    case '\0':
      return args.integer();
    default:
      return va_arg(args.list, ptrdiff_t);
  }
}

inline unsigned long long unsigned_argument(Arguments& args, char length) {
  switch (length) {
    case 'q':
      return va_arg(args.list, unsigned long long);
    case 'l':  // NOLINT(bugprone-branch-clone)
      return va_arg(args.list, unsigned long);
    case 'j':
      return va_arg(args.list, uintmax_t);
    case '\0':
      return va_arg(args.list, unsigned);
    default:
      return va_arg(args.list, size_t);
  }
}

inline void put_conversion(Sink& sink, Conversion& c, char letter, Arguments& args) {
  const char letters[] = {letter, '\0'}, wide[] = {'l', 'l', letter, '\0'};
  if (letter == 's') return put_string(sink, c, va_arg(args.list, const char*));
  if (letter == 'd' || letter == 'i') return put_value(sink, c, wide, signed_argument(args, c.length));
  if (std::strchr("uxXo", letter)) return put_value(sink, c, wide, unsigned_argument(args, c.length));
  if (letter == 'p') return put_value(sink, c, letters, va_arg(args.list, const void*));
  if (letter != 'c') return put_value(sink, c, letters, va_arg(args.list, double));
  const char one = static_cast<char>(args.integer());
  sink.put(&one, 1);
}

}  // namespace format_parts

// As vsnprintf, for d i u x X o c s p f g e and their capitals, with flags, width, precision, '*' and the
// lengths l ll z j t.
[[gnu::format(printf, 3, 0)]] inline int print_list(char* out, size_t size, const char* pattern,
                                                    va_list list) {
  using namespace format_parts;
  Sink sink{out, size};
  Arguments args;
  va_copy(args.list, list);
  for (const char* p = pattern; *p; ++p) {
    if (*p != '%') {
      sink.put(p, 1);
      continue;
    }
    Conversion c;
    p = p[1] == '%' ? p + 1 : read_conversion(p + 1, args, c);
    if (!*p) break;
    if (*p == '%')
      sink.put(p, 1);
    else
      put_conversion(sink, c, *p, args);
  }
  va_end(args.list);
  if (size > 0) out[std::min(sink.length, size - 1)] = '\0';
  return static_cast<int>(std::min<size_t>(sink.length, INT32_MAX));
}

// As snprintf.
[[gnu::format(printf, 3, 4)]] inline int print_text(char* out, size_t size, const char* pattern, ...) {
  va_list list;
  va_start(list, pattern);
  const int n = print_list(out, size, pattern, list);
  va_end(list);
  return n;
}

}  // namespace rdm
