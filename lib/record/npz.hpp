// Archives of numpy arrays (.npz) in memory: ZIP members that are stored as they are, each an array file of
// version 1 (.npy), whose header is a Python literal.
//
// Enough of ZIP for what numpy.savez writes and numpy.load opens, sizes beyond 4 GB in the 64-bit form; the
// fields are those of PKWARE's application note (APPNOTE.TXT), section 4.3. Members that are packed are
// refused. Nothing that a file says is believed: every size is held against the bytes that are there.
#pragma once
#include <cstddef>
#include <cstdint>

#include "base/host.hpp"

namespace rdm {

inline constexpr int kMaxArrayDims = 4;

struct NpyArray {
  char type[12] = "";                   // "<f4", "|b1", "<i8", "|S12"
  int32_t dims = 0;                     // 0: one value
  uint64_t shape[kMaxArrayDims] = {};   // [dims]
  const unsigned char* data = nullptr;  // bytes() of them, at any address
  size_t item_bytes() const;            // 0: a type that is not read here
  uint64_t bytes() const;               // of all values; saturates
  bool is(const char* other, int32_t d) const;
};

class NpzWriter {
 public:
  explicit NpzWriter(Vector<unsigned char>& out) : out_(out) {}
  // array.data is copied. Names to 32 characters, 24 members at most.
  void add(const char* name, const NpyArray& array);
  void finish();  // the directory

 private:
  struct Member {
    char name[40];
    uint64_t size, offset;
    uint32_t checksum;
  };
  static constexpr int kMost = 24;
  template <class T>
  void put(T value);
  void bytes(const void* data, size_t size);
  Vector<unsigned char>& out_;
  Member members_[kMost] = {};
  int count_ = 0;
};

class NpzReader {
 public:
  // Error(kFormat), the text begins with `what`, for bytes that are no whole archive. Borrows the bytes.
  NpzReader(const unsigned char* data, size_t size, const char* what);
  bool has(const char* name) const { return find(name) != nullptr; }
  // Error(kFormat) when there is none, its checksum or header is wrong, or it is packed.
  NpyArray array(const char* name) const;

 private:
  struct Member {
    char name[40];
    uint64_t size, packed, offset;
    uint32_t checksum;
    uint16_t flags, method;
  };
  static constexpr size_t kMost = 256;  // further members are not looked at
  template <class T>
  T value(uint64_t at) const;  // Error(kFormat) past the end
  const Member* find(const char* name) const;
  void read_directory();
  uint64_t read_member(uint64_t at, uint64_t end);
  [[noreturn]] void bad(const char* why) const;
  const unsigned char* data_;
  uint64_t size_;
  const char* what_;
  Vector<Member> members_;
};

}  // namespace rdm
