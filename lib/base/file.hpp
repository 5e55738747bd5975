// Files: read one whole or in parts, or replace one so that a kill at any moment leaves the old or the new content.
#pragma once
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string_view>

#include "base/error.hpp"
#include "base/host.hpp"

namespace rdm {

// What a file must be to be read at all: looked at before memory is taken, so that no file, however long it
// says it is, takes more than its reader can use.
struct FileLimits {
  std::string_view magic;  // its first bytes, 48 at most; a shorter file is left to the reader
  size_t length_at = 0;    // where a u64 says how many bytes follow it; 0: nowhere
  size_t longest = 0;      // bytes
  Code too_long = Code::kFormat;
};

// Error(kNotFound) when there is none, kFormat when its first bytes are not those, `too_long` beyond the
// longest size, kIo for any other failure: folders, devices and pipes are refused, and none of them is waited
// for.
Vector<unsigned char> read_file(const char* path, const FileLimits& limits);

// Bytes that are read in parts.
class ByteSource {
 public:
  virtual ~ByteSource() = default;
  virtual uint64_t size() const = 0;
  // Copies `count` bytes from `at` on, which are there: at + count <= size().
  virtual void read(uint64_t at, void* to, size_t count) const = 0;
};

// A regular file. Errors as read_file's; Error(kIo) where it has become shorter.
class FileSource : public ByteSource {
 public:
  explicit FileSource(const char* path);
  ~FileSource() override;
  FileSource(const FileSource&) = delete;
  FileSource& operator=(const FileSource&) = delete;
  uint64_t size() const override { return size_; }
  void read(uint64_t at, void* to, size_t count) const override;

 private:
  const char* path_;   // the caller's
  uint64_t size_ = 0;  // before handle_, whose opening sets it
  intptr_t handle_;
};

class MemorySource : public ByteSource {
 public:
  MemorySource(const unsigned char* data, size_t size) : data_(data), size_(size) {}
  uint64_t size() const override { return size_; }
  void read(uint64_t at, void* to, size_t count) const override {
    if (count) std::memcpy(to, data_ + at, count);
  }

 private:
  const unsigned char* data_;
  size_t size_;
};

// Writes <path>.tmp-<16 hex digits>, syncs, renames, syncs the folder. A link stays, what it leads to is
// replaced by one with the same permissions. On Error(kIo) (full disk, file-size limit, no right to write the
// file or its folder, not a regular file) the old file is
// untouched and the temporary one is gone; those that killed processes left beside it are removed.
void write_file(const char* path, const void* data, size_t size);

}  // namespace rdm
