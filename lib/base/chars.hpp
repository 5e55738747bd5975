// Numbers as text and back, without a locale: <charconv>'s where the standard library has it whole, else its
// integers and base/decimal.hpp's numbers. The same text on every machine.
#pragma once
#include <charconv>
#include <type_traits>

#if !defined(__cpp_lib_to_chars)
#include "base/decimal.hpp"
#endif

namespace rdm {

// As std::from_chars, general format.
template <class T>
std::from_chars_result from_chars(const char* begin, const char* end, T& out) {
#if !defined(__cpp_lib_to_chars)
  if constexpr (std::is_floating_point_v<T>)
    return decimal::from_chars(begin, end, out);
  else
#endif
    return std::from_chars(begin, end, out);
}

// As std::to_chars: of a number the shortest text that reads back to the same bits.
template <class T>
std::to_chars_result to_chars(char* begin, char* end, T v) {
#if !defined(__cpp_lib_to_chars)
  if constexpr (std::is_floating_point_v<T>)
    return decimal::to_chars(begin, end, v);
  else
#endif
    return std::to_chars(begin, end, v);
}

// As std::to_chars, general format with `digits` in [1, 64] significant ones.
template <class T>
std::to_chars_result to_chars(char* begin, char* end, T v, int digits) {
#if !defined(__cpp_lib_to_chars)
  return decimal::to_chars(begin, end, v, digits);
#else
  return std::to_chars(begin, end, v, std::chars_format::general, digits);
#endif
}

}  // namespace rdm
