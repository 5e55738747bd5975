#include "base/bytes.hpp"

#include "base/error.hpp"

namespace rdm {
namespace {

constexpr uint32_t kByteOrder = 0x01020304u;
constexpr size_t kFileHeader = 8 + 4 + 4 + 8, kSectionHeader = 4 + 4 + 8;

template <class T>
T load(const unsigned char* p) {
  T v;
  std::memcpy(&v, p, sizeof v);
  return v;
}

}  // namespace

void Writer::text(const char* s) {
  const size_t n = std::strlen(s);
  value(static_cast<uint32_t>(n));
  bytes(s, n);
}

void Writer::patch(size_t at, const void* src, size_t n) {
  if (at + n <= capacity_) std::memcpy(data_ + at, src, n);
}

void Writer::push(size_t at) {
  if (depth_ == kDepth) fail(Code::kInternal, "sections are nested deeper than %d", kDepth);
  open_[depth_++] = at;
}

size_t Writer::pop() {
  if (depth_ == 0) fail(Code::kInternal, "a section is ended that was not begun");
  return open_[--depth_];
}

void Writer::begin_file(const char magic[8], uint32_t version) {
  push(at_);
  bytes(magic, 8);
  value(version);
  value(kByteOrder);
  value(uint64_t{0});
}

void Writer::end_file() {
  const size_t file = pop();
  const uint64_t length = at_ - file - kFileHeader;
  patch(file + kFileLengthAt, &length, 8);
}

void Writer::begin_section(const char tag[4]) {
  push(at_);
  bytes(tag, 4);
  value(uint32_t{0});
  value(uint64_t{0});
}

void Writer::begin_later_section(const char tag[4]) {
  begin_section(tag);
  bytes(tag, 4);
}

void Writer::end_section() {
  const size_t section = pop();
  const size_t begin = section + kSectionHeader;
  const size_t size = at_ - begin;
  const uint64_t length = size;
  const uint32_t crc = at_ <= capacity_ ? crc32(data_ + begin, size) : 0;
  patch(section + 4, &crc, 4);
  patch(section + 8, &length, 8);
}

void Reader::bad(const char* why) const {
  fail(Code::kFormat, "%s: %s", what_, why);
}

void Reader::text(char* dst, size_t capacity) {
  const auto n = value<uint32_t>();
  if (n >= capacity) bad("a text in it is too long");
  bytes(dst, n);
  dst[n] = '\0';
}

uint32_t Reader::begin_file(const char magic[8], uint32_t newest_version) {
  if (size_ - at_ < kFileHeader) bad("its header is truncated");
  if (std::memcmp(view(8), magic, 8) != 0) bad("it is not a file of this kind (wrong magic number)");
  const auto version = value<uint32_t>();
  if (value<uint32_t>() != kByteOrder) bad("it was written with another byte order");
  if (version == 0 || version > newest_version)
    fail(Code::kVersion, "%s: its format version is %u, but this library reads 1 to %u", what_, version,
         newest_version);
  const auto length = value<uint64_t>();
  if (length != size_ - at_) bad("it is truncated or has extra bytes: its length does not match its header");
  file_begin_ = at_;
  file_end_ = size_;
  for (size_t p = file_begin_; p < file_end_;) {
    if (file_end_ - p < kSectionHeader) bad("a section is truncated");
    const auto length = load<uint64_t>(data_ + p + 8);
    if (length > file_end_ - p - kSectionHeader) bad("a section is truncated");
    const auto n = static_cast<size_t>(length);
    if (crc32(data_ + p + kSectionHeader, n) != load<uint32_t>(data_ + p + 4))
      bad("its checksum does not match: the file is damaged");
    p += kSectionHeader + n;
  }
  return version;
}

bool Reader::find_section(const char tag[4]) {
  for (size_t p = file_begin_; p < file_end_;) {
    const auto n = static_cast<size_t>(load<uint64_t>(data_ + p + 8));  // within the file: begin_file
    if (std::memcmp(data_ + p, tag, 4) == 0) {
      at_ = p + kSectionHeader;
      end_ = at_ + n;
      return true;
    }
    p += kSectionHeader + n;
  }
  return false;
}

void Reader::need_section(const char tag[4]) {
  if (!find_section(tag)) fail(Code::kFormat, "%s: section %.4s is missing", what_, tag);
}

bool Reader::find_later_section(const char tag[4]) {
  return find_section(tag) && std::memcmp(view(4), tag, 4) == 0;
}

void Reader::need_whole_tags(const char* known) const {
  for (size_t p = file_begin_; p < file_end_;) {
    const auto n = static_cast<size_t>(load<uint64_t>(data_ + p + 8));
    bool good = n >= 4 && std::memcmp(data_ + p, data_ + p + kSectionHeader, 4) == 0;
    for (const char* tag = known; !good && *tag; tag += 4) good = std::memcmp(data_ + p, tag, 4) == 0;
    if (!good) bad("a section's tag is damaged");
    p += kSectionHeader + n;
  }
}

void Reader::expect_end() {
  if (at_ != end_) bad("a section is longer than expected");
}

}  // namespace rdm
