// Archives of numpy arrays (.npz): ZIP members that are stored as they are, each an array file of
// version 1 (.npy), whose header is a Python literal.
//
// Enough of ZIP for what numpy.savez writes and numpy.load opens, sizes beyond 4 GB in the 64-bit form; the
// fields are those of PKWARE's application note (APPNOTE.TXT), section 4.3. Compressed members are refused. No size
// in a file is trusted: each is checked against the bytes that there are.
#pragma once
#include <cstddef>
#include <cstdint>

#include "base/file.hpp"
#include "base/host.hpp"

namespace rdm {

inline constexpr int kMaxArrayDims = 4;

struct NpyArray {
  char type[12] = "";                   // "<f4", "|b1", "<i8", "|S12"
  int32_t dims = 0;                     // 0: one value
  uint64_t shape[kMaxArrayDims] = {};   // [dims]
  const unsigned char* data = nullptr;  // bytes() of them, at any address; of a header NULL
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

// The directory at the end is read first, then headers, and an array only when it is asked for. All sizes are thus
// known and checked before memory is allocated.
class NpzReader {
 public:
  // Error(kFormat), the text begins with `what`, for bytes that are no whole archive. Borrows the source.
  NpzReader(const ByteSource& source, const char* what);
  bool has(const char* name) const { return find(name) != nullptr; }
  // Type and shape; the numbers are as many as they say. Error(kFormat) when there is none, or it is packed.
  NpyArray header(const char* name) const;
  // With its numbers, which live until the next call. Error(kFormat) when its checksum is wrong too.
  NpyArray array(const char* name);

 private:
  struct Member {
    char name[40];
    uint64_t size, packed, offset;
    uint32_t checksum;
    uint16_t flags, method;
  };
  struct Place {  // of an array file in the archive
    uint64_t begin;
    size_t size, head;
    uint32_t checksum;
  };
  static constexpr size_t kMost = 256;  // further members are not looked at
  template <class T>
  T value(uint64_t at) const;  // Error(kFormat) past the end
  const Member* find(const char* name) const;
  void read_directory();
  uint64_t read_member(uint64_t at, uint64_t end);
  NpyArray read_header(const char* name, Place* place) const;
  [[noreturn]] void bad(const char* why) const;
  [[noreturn]] void refuse(const char* name, const char* why) const;
  const ByteSource& source_;
  uint64_t size_;
  const char* what_;
  Vector<Member> members_;
  Vector<unsigned char> bytes_;  // of the last array
};

}  // namespace rdm
