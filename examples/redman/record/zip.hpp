// ZIP archives, as far as arrays of numpy need them: members are stored as they are; deflated ones are read
// too. Sizes beyond 4 GB are in the 64-bit form.
#pragma once
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "common/files.hpp"

namespace tool {

// CRC-32 of bytes behind others whose one was `before`.
uint32_t checksum_of(uint32_t before, const void* bytes, size_t size);

class ZipWriter {
 public:
  explicit ZipWriter(PreparedFile& file) : file_(file) {}
  // A member of so many bytes; that many have to be written before the next one.
  void begin(const std::string& name, uint64_t size);
  void write(const void* bytes, size_t size);
  void finish();  // the directory

 private:
  struct Member {
    std::string name;
    uint64_t size, offset;
    uint32_t checksum;
  };
  void close_member();
  PreparedFile& file_;
  std::vector<Member> members_;
};

// Reads through `read(offset, to, size)` of a file of so many bytes. Failure when it is no archive; nothing
// that it says is believed.
class ZipReader {
 public:
  using Read = std::function<void(uint64_t offset, void* to, size_t size)>;
  ZipReader(uint64_t size, Read read);
  bool has(const std::string& name) const;
  // The whole member. Failure when there is none, it has more than `most` bytes, or its checksum is another.
  std::string member(const std::string& name, uint64_t most) const;
  // Its first bytes, at most `most`; the checksum is not looked at.
  std::string head(const std::string& name, size_t most) const;
  uint64_t size(const std::string& name) const;  // of the whole member
  uint64_t size() const { return size_; }        // of the archive

 private:
  struct Member {
    std::string name;
    uint64_t size, packed, offset;
    uint32_t checksum;
    bool deflated;
  };
  void add_member(const std::string& directory, size_t& at);
  const Member& find(const std::string& name) const;
  uint64_t begin_of(const Member& m) const;
  uint64_t size_;
  Read read_;
  std::vector<Member> members_;
};

}  // namespace tool
