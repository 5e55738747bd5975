// Rows that stand elsewhere: constant arrays of tables.
#pragma once
#include <cstdint>

namespace rdm {

template <class T>
struct Table {
  const T* rows = nullptr;
  int32_t count = 0;
  const T* begin() const { return rows; }
  const T* end() const { return rows + count; }
  const T& operator[](int32_t i) const { return rows[i]; }
};
template <class T, int32_t N>
constexpr Table<T> table(const T (&rows)[N]) {
  return {rows, N};
}

}  // namespace rdm
