// Numbers as decimal text and back, exact: for standard libraries whose <charconv> has integers alone
// (base/chars.hpp says where).
//
// Whole numbers of any length stand for value, power of ten and half gaps to the neighbours, so every text is
// the one that exact arithmetic gives and no rounding mode, locale or machine changes it.
// Read: the nearest number, of two equally near the even one. Written: digit by digit, until what is written
// is nearer to the value than to any other number of its type (Steele and White 1990, "How to print
// floating-point numbers accurately"), or as many digits as are asked for, rounded like a number that is
// read.
#pragma once
#include <algorithm>
#include <bit>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <system_error>
#include <type_traits>

namespace rdm::decimal {

// A natural number below 2^5120. The largest that occurs: 800 digits and their sticky one against 10^1130,
// about 2^3900.
class Natural {
 public:
  explicit Natural(uint64_t v = 0) {
    for (; v; v >>= 32) word_[count_++] = static_cast<uint32_t>(v);
  }
  Natural(const Natural& b) : count_(b.count_) { std::copy_n(b.word_, count_, word_); }
  Natural& operator=(const Natural&) = delete;

  int bits() const { return count_ == 0 ? 0 : 32 * count_ - std::countl_zero(word_[count_ - 1]); }

  void multiply(uint32_t factor, uint32_t add = 0) {
    uint64_t carry = add;
    for (int i = 0; i < count_; ++i) {
      carry += uint64_t{factor} * word_[i];
      word_[i] = static_cast<uint32_t>(carry);
      carry >>= 32;
    }
    if (carry) word_[count_++] = static_cast<uint32_t>(carry);
  }
  void multiply_by_ten(int times) {
    for (; times >= 9; times -= 9) multiply(1000000000);
    for (; times > 0; --times) multiply(10);
  }
  void shift(int bits) {
    const int words = bits / 32;
    if (words > 0 && count_ > 0) {
      std::copy_backward(word_, word_ + count_, word_ + count_ + words);
      std::fill_n(word_, words, 0u);
      count_ += words;
    }
    multiply(1u << bits % 32);
  }
  void subtract(const Natural& b) {  // b <= *this
    int64_t carry = 0;
    for (int i = 0; i < count_; ++i) {
      carry += int64_t{word_[i]} - (i < b.count_ ? b.word_[i] : 0);
      word_[i] = static_cast<uint32_t>(carry);
      carry >>= 32;
    }
    while (count_ > 0 && word_[count_ - 1] == 0) --count_;
  }
  // The sign of a + b - c.
  friend int compare(const Natural& a, const Natural& b, const Natural& c) {
    int64_t left = 0;  // of the higher words; what the lower ones add is above -1 and below 2
    for (int i = std::max({a.count_, b.count_, c.count_}) - 1; i >= 0; --i) {
      left = left * (int64_t{1} << 32) + a.at(i) + b.at(i) - c.at(i);
      if (left >= 1 || left <= -2) return left < 0 ? -1 : 1;
    }
    return left < 0 ? -1 : 0;
  }
  friend int compare(const Natural& a, const Natural& b) {
    if (a.count_ != b.count_) return a.count_ < b.count_ ? -1 : 1;
    for (int i = a.count_ - 1; i >= 0; --i)
      if (a.word_[i] != b.word_[i]) return a.word_[i] < b.word_[i] ? -1 : 1;
    return 0;
  }

 private:
  int64_t at(int i) const { return i < count_ ? int64_t{word_[i]} : 0; }
  uint32_t word_[160];  // the first `count_` hold something, lowest first, the last of them not 0
  int count_ = 0;
};

// IEEE 754's binary32 and binary64: fraction * 2^exponent, with exponents from kLeast.
template <class T>
struct Format {
  static_assert(std::numeric_limits<T>::is_iec559 && (sizeof(T) == 4 || sizeof(T) == 8));
  using Bits = std::conditional_t<sizeof(T) == 4, uint32_t, uint64_t>;
  static constexpr int kDigits = std::numeric_limits<T>::digits;
  static constexpr int kLeast = std::numeric_limits<T>::min_exponent - kDigits;
  static constexpr Bits kHidden = Bits{1} << (kDigits - 1);
  static constexpr Bits kInfinity = static_cast<Bits>(2 * std::numeric_limits<T>::max_exponent - 1)
                                    << (kDigits - 1);
  static constexpr Bits kNan = kInfinity | kHidden >> 1;
  static constexpr Bits kSign = Bits{1} << (8 * sizeof(T) - 1);
};

// ---- reading ----

// More digits than this cannot move a number across the middle between two doubles, but for whether any is
// not 0.
inline constexpr int kDigitsKept = 800;

// The bits of the T nearest to whole * 10^exponent, whole > 0: 0 and infinity are such.
template <class T>
typename Format<T>::Bits nearest(Natural& whole, int exponent) {
  using F = Format<T>;
  Natural unit(1);
  (exponent < 0 ? unit : whole).multiply_by_ten(exponent < 0 ? -exponent : exponent);
  // whole / unit = ratio 2^q with the ratio in [1, 2)
  int q = whole.bits() - unit.bits();
  (q < 0 ? whole : unit).shift(q < 0 ? -q : q);
  if (compare(whole, unit) < 0) whole.shift(1), --q;
  const int least = std::max(q - F::kDigits + 1, F::kLeast);  // weight of the fraction's last bit
  if (q < least - 1) return 0;
  uint64_t fraction = 0;
  for (int i = q; i >= least; --i) {
    const bool bit = compare(whole, unit) >= 0;
    if (bit) whole.subtract(unit);
    whole.shift(1);
    fraction = fraction << 1 | bit;
  }
  const int half = compare(whole, unit);
  fraction += half > 0 || (half == 0 && fraction & 1);
  // the hidden bit, and a carry out of the fraction, each add one to the exponent's field
  const uint64_t bits = (static_cast<uint64_t>(least - F::kLeast) << (F::kDigits - 1)) + fraction;
  return static_cast<typename F::Bits>(std::min<uint64_t>(bits, F::kInfinity));
}

// Behind the word, in letters of either case, that the text begins with; else NULL.
inline const char* behind_word(const char* c, const char* end, const char* word) {
  for (; *word; ++word, ++c)
    if (c == end || (*c | 0x20) != *word) return nullptr;
  return c;
}

// As std::from_chars reads a number in its general format: no blanks, no leading plus. Where the text says a
// number beyond T's, or one that would round to 0, result_out_of_range, and `out` stays.
template <class T>
std::from_chars_result from_chars(const char* begin, const char* end, T& out) {
  using F = Format<T>;
  const auto digit = [end](const char* c) { return c != end && *c >= '0' && *c <= '9'; };
  const bool negative = begin != end && *begin == '-';
  const char* c = begin + negative;
  const auto give = [&](typename F::Bits bits, const char* after) -> std::from_chars_result {
    out = __builtin_bit_cast(T, static_cast<typename F::Bits>(bits | (negative ? F::kSign : 0)));
    return {after, std::errc()};
  };
  if (const char* after = behind_word(c, end, "inf")) {
    const char* all = behind_word(c, end, "infinity");
    return give(F::kInfinity, all ? all : after);
  }
  if (const char* after = behind_word(c, end, "nan")) {
    const char* p = after;
    if (p != end && *p == '(') {
      do ++p;
      while (p != end && (digit(p) || *p == '_' || ((*p | 0x20) >= 'a' && (*p | 0x20) <= 'z')));
      if (p != end && *p == ')') after = p + 1;
    }
    return give(F::kNan, after);
  }

  Natural whole;
  int kept = 0;
  int64_t exponent = 0;
  bool some = false, point = false, lost = false;
  for (; digit(c) || (c != end && *c == '.' && !point); ++c) {
    if (*c == '.') {
      point = true;
      continue;
    }
    const auto d = static_cast<uint32_t>(*c - '0');
    some = true;
    if (kept < kDigitsKept) {
      whole.multiply(10, d);
      kept += kept > 0 || d > 0;
      exponent -= point;
    } else {
      lost = lost || d > 0;
      exponent += !point;
    }
  }
  if (!some) return {begin, std::errc::invalid_argument};
  if (lost) whole.multiply(10, 1), ++kept, --exponent;
  if (c != end && (*c | 0x20) == 'e') {
    const char* p = c + 1;
    const bool down = p != end && *p == '-';
    p += p != end && (*p == '-' || *p == '+');
    if (digit(p)) {
      int64_t e = 0;
      for (; digit(p); ++p) e = std::min(10 * e + (*p - '0'), int64_t{1} << 50);
      exponent += down ? -e : e;
      c = p;
    }
  }
  if (kept == 0) return give(0, c);
  const int64_t top = kept + exponent;  // the number is below 10^top, and not below a tenth of that
  if (top > 310 || top < -330) return {c, std::errc::result_out_of_range};
  const auto bits = nearest<T>(whole, static_cast<int>(exponent));
  if (bits == 0 || bits == F::kInfinity) return {c, std::errc::result_out_of_range};
  return give(bits, c);
}

// ---- writing ----

inline constexpr int kMostDigits = 64;  // that to_chars is asked for

// d.ddd * 10^exponent, without zeros at the end.
struct Digits {
  char digit[kMostDigits];  // '0' to '9'
  int count, exponent;
};

// Of the number with these bits, positive and finite: as many digits as tell it from every other T, or, where
// count > 0, as many as that.
template <class T>
Digits digits_of(typename Format<T>::Bits bits, int count) {
  using F = Format<T>;
  const int field = static_cast<int>(bits >> (F::kDigits - 1));
  const uint64_t fraction = (bits & (F::kHidden - 1)) | (field > 0 ? F::kHidden : 0);
  const int exponent = std::max(field - 1, 0) + F::kLeast;
  // The number is whole / unit, and (above + below) / unit what is nearer to it than to its neighbours: below
  // a power of two they are half as far.
  Natural whole(4 * fraction), unit(4), above(2), below(fraction == F::kHidden && field > 1 ? 1 : 2);
  if (exponent < 0) unit.shift(-exponent);
  if (exponent > 0) whole.shift(exponent), above.shift(exponent), below.shift(exponent);
  Digits out{};
  // log10(2) = 78913 / 2^18 and a little: at most two too low
  out.exponent = ((63 - std::countl_zero(fraction) + exponent) * 78913 >> 18) - 1;
  if (out.exponent > 0) unit.multiply_by_ten(out.exponent);
  if (out.exponent < 0)
    for (Natural* n : {&whole, &above, &below}) n->multiply_by_ten(-out.exponent);
  for (Natural ten(unit);; unit.multiply(10), ++out.exponent) {
    ten.multiply(10);
    if (compare(whole, ten) < 0) break;
  }

  for (bool down = false, up = false; !down && !up;) {
    if (out.count > 0)
      for (Natural* n : {&whole, &above, &below}) n->multiply(10);
    char d = '0';
    for (; compare(whole, unit) >= 0; ++d) whole.subtract(unit);
    out.digit[out.count++] = d;
    if (count > 0) {
      down = up = out.count == count;
    } else {
      // the middle between two numbers is read as the even one
      const int even = fraction & 1 ? 0 : 1;
      down = compare(whole, below) < even;
      up = compare(whole, above, unit) > -even;
    }
    if (down && up) {
      const int half = compare(whole, whole, unit);
      up = half > 0 || (half == 0 && (d - '0') & 1);
    }
    if (!up) continue;
    int i = out.count - 1;
    while (i >= 0 && out.digit[i] == '9') out.digit[i--] = '0';
    if (i >= 0)
      ++out.digit[i];
    else
      out.digit[0] = '1', ++out.exponent;
  }
  while (out.count > 1 && out.digit[out.count - 1] == '0') --out.count;
  return out;
}

// The text of one number: long enough for 64 digits with zeros before them or an exponent behind.
struct Text {
  char text[kMostDigits + 16];
  int count = 0;

  void put(char c) { text[count++] = c; }
  void zeros(int n) {
    for (; n > 0; --n) put('0');
  }
  void fixed(const Digits& d) {
    if (d.exponent < 0) put('0');
    for (int i = 0; i < d.count && i <= d.exponent; ++i) put(d.digit[i]);
    zeros(d.exponent + 1 - d.count);
    if (d.count <= d.exponent + 1) return;
    put('.');
    zeros(-1 - d.exponent);
    for (int i = std::max(d.exponent + 1, 0); i < d.count; ++i) put(d.digit[i]);
  }
  void scientific(const Digits& d) {
    put(d.digit[0]);
    if (d.count > 1) put('.');
    for (int i = 1; i < d.count; ++i) put(d.digit[i]);
    put('e');
    put(d.exponent < 0 ? '-' : '+');
    const int e = d.exponent < 0 ? -d.exponent : d.exponent;
    if (e >= 100) put(static_cast<char>('0' + e / 100));
    put(static_cast<char>('0' + e / 10 % 10));
    put(static_cast<char>('0' + e % 10));
  }
  std::to_chars_result copy(char* begin, char* end) const {
    if (end - begin < count) return {end, std::errc::value_too_large};
    std::memcpy(begin, text, static_cast<size_t>(count));
    return {begin + count, std::errc()};
  }
};

// Sign, zero, infinity and not-a-number; true where they are all, else `bits` are those of |v|.
template <class T>
bool put_special(T v, Text& out, typename Format<T>::Bits* bits) {
  using F = Format<T>;
  *bits = __builtin_bit_cast(typename F::Bits, v);
  if (*bits & F::kSign) out.put('-');
  *bits &= F::kSign - 1;
  const char* word = *bits > F::kInfinity ? "nan" : *bits == F::kInfinity ? "inf" : *bits == 0 ? "0" : "";
  for (const char* c = word; *c; ++c) out.put(*c);
  return *word != '\0';
}

// As std::to_chars: the shortest text that reads back to the same bits, fixed where that is not longer than
// scientific.
template <class T>
std::to_chars_result to_chars(char* begin, char* end, T v) {
  Text out;
  typename Format<T>::Bits bits;
  if (!put_special(v, out, &bits)) {
    const Digits d = digits_of<T>(bits, 0);
    const int scientific = d.count + (d.count > 1) + (d.exponent >= 100 || d.exponent <= -100 ? 5 : 4);
    const int fixed = d.exponent < 0             ? d.count + 1 - d.exponent
                      : d.count > d.exponent + 1 ? d.count + 1
                                                 : d.exponent + 1;
    if (fixed > scientific)
      out.scientific(d);
    else
      out.fixed(d.exponent < d.count ? d : digits_of<T>(bits, d.exponent + 1));  // a whole number is exact
  }
  return out.copy(begin, end);
}

// As std::to_chars with general format: `digits` in [1, 64] significant ones, zeros at the end left out.
template <class T>
std::to_chars_result to_chars(char* begin, char* end, T v, int digits) {
  Text out;
  typename Format<T>::Bits bits;
  if (!put_special(v, out, &bits)) {
    const Digits d = digits_of<T>(bits, digits);
    if (d.exponent >= -4 && d.exponent < digits)
      out.fixed(d);
    else
      out.scientific(d);
  }
  return out.copy(begin, end);
}

}  // namespace rdm::decimal
