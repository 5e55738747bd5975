// NumPy's array file, .npy version 1: a header that is a Python literal, then the numbers, little-endian.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace tool {

struct ArrayShape {
  std::string type;             // "<f4", "|u1", "<U12", "|S8" ...
  std::vector<uint64_t> shape;  // {}: one value
  size_t item_bytes() const;    // 0: not a type that is read or written here
  uint64_t bytes() const;       // of all values; saturates
};

// All bytes before the numbers; a multiple of 64.
std::string npy_header(const ArrayShape& array);
// The header of a file that begins with these bytes; `begin` is where its numbers are. Failure when it is
// none, is in Fortran's order, or is not as long as it says.
ArrayShape parse_npy(const char* bytes, size_t size, size_t* begin);

// The same of the file's first bytes alone, whose numbers need not be there.
ArrayShape parse_npy_head(const char* bytes, size_t size, size_t* begin);

// Text as an array of one value: UTF-8 to UTF-32 and back. Failure when it is no text.
ArrayShape text_shape(const std::string& utf8);
std::string text_bytes(const std::string& utf8);
std::string text_of_array(const ArrayShape& array, const char* bytes);

}  // namespace tool
