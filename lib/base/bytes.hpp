// Flat little-endian byte streams with tagged, checked sections: the body of .rdm files and of states.
//
// File = magic[8], u32 version, u32 byte-order mark 0x01020304, u64 length of all sections;
// section = tag[4], u32 CRC-32 of the payload, u64 payload length, payload.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "base/hash.hpp"

namespace rdm {

// CRC-32, as of zip; `crc` is that of what came before (crc.cpp).
uint32_t crc32(const void* data, size_t size, uint32_t crc = 0);

// Writes into [data, data + capacity), or only counts when data is null or the end is passed: size()
// then is what it would have taken. Files and sections may be nested, up to kDepth open at once.
class Writer {
 public:
  Writer(void* data, size_t capacity)
      : data_(static_cast<unsigned char*>(data)), capacity_(data ? capacity : 0) {}
  // Keeps nothing: the bytes go on with *hash (base/hash.hpp). No files and sections.
  explicit Writer(uint64_t* hash) : data_(nullptr), capacity_(0), hash_(hash) {}

  void bytes(const void* src, size_t n) {
    if (n && at_ + n <= capacity_)
      std::memcpy(data_ + at_, src, n);
    else if (hash_)
      *hash_ = hash_bytes(src, n, *hash_);
    at_ += n;
  }
  template <class T>
  void value(const T& v) {
    static_assert(std::is_trivially_copyable_v<T>);
    bytes(&v, sizeof v);
  }
  void text(const char* s);  // u32 length, characters, no terminator

  void begin_file(const char magic[8], uint32_t version);
  void end_file();
  void begin_section(const char tag[4]);
  void end_section();
  // One that older readers pass over: its payload begins with the tag, which so has a checksum.
  void begin_later_section(const char tag[4]);

  size_t size() const { return at_; }
  bool fits() const { return at_ <= capacity_; }
  bool counts() const { return !data_ && !hash_; }  // and writes nothing

 private:
  static constexpr int kDepth = 8;
  void patch(size_t at, const void* src, size_t n);
  void push(size_t at);
  size_t pop();
  unsigned char* data_;
  size_t capacity_, at_ = 0;
  uint64_t* hash_ = nullptr;
  size_t open_[kDepth] = {};  // where the files and sections that are not ended began
  int depth_ = 0;
};

// Where a file says how many bytes follow that number.
inline constexpr size_t kFileLengthAt = 16;

// Reads what Writer wrote. Every way in which the bytes can be wrong is Error(kFormat), a newer version
// Error(kVersion); the text begins with `what`.
class Reader {
 public:
  Reader(const void* data, size_t size, const char* what)
      : data_(static_cast<const unsigned char*>(data)), size_(size), what_(what) {}

  void bytes(void* dst, size_t n) {
    const unsigned char* p = view(n);
    if (n) std::memcpy(dst, p, n);
  }
  const unsigned char* view(size_t n) {  // n bytes in place
    if (n > end_ - at_) bad("truncated");
    at_ += n;
    return data_ + at_ - n;
  }
  template <class T>
  T value() {
    static_assert(std::is_trivially_copyable_v<T>);
    T v;
    bytes(&v, sizeof v);
    return v;
  }
  // Copies at most capacity - 1 characters and a terminator; longer text is a format error.
  void text(char* dst, size_t capacity);

  uint32_t begin_file(const char magic[8], uint32_t newest_version);  // checks every section's CRC too
  // Goes to the section with this tag (they may be searched in any order); its payload is then all that
  // can be read.
  bool find_section(const char tag[4]);
  void need_section(const char tag[4]);
  // Of begin_later_section; what can be read then follows the tag.
  bool find_later_section(const char tag[4]);
  // Error unless each section is one of the `known` tags, which stand in one text, or a later one, whole.
  void need_whole_tags(const char* known) const;
  size_t left() const { return end_ - at_; }
  void expect_end();  // error when the section has bytes left over

 private:
  [[noreturn]] void bad(const char* why) const;
  const unsigned char* data_;
  size_t size_, at_ = 0, end_ = size_, file_begin_ = 0, file_end_ = 0;
  const char* what_;
};

}  // namespace rdm
