#include "record/npz.hpp"

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <cstring>

#include "base/bytes.hpp"
#include "base/error.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

constexpr uint32_t kLocal = 0x04034b50, kCentral = 0x02014b50, kEnd = 0x06054b50, kEnd64 = 0x06064b50,
                   kLocator64 = 0x07064b50;
constexpr uint32_t kFull = 0xffffffff;  // the value stands in the 64-bit form
constexpr uint16_t kExtra64 = 1, kOld = 20, kNew = 45, kEncrypted = 1;
constexpr uint16_t kDate = 1 << 5 | 1;  // 1980-01-01: the same rows give the same bytes
constexpr uint64_t kEndBytes = 22, kEnd64Bytes = 56, kLocatorBytes = 20, kCentralBytes = 46, kLocalBytes = 30;
constexpr uint64_t kMostComment = 0xffff;
constexpr char kMagic[] = "\x93NUMPY\x01";  // and minor version 0
constexpr size_t kHead = 10;                // magic, version, length of the text

uint32_t low32(uint64_t v) {
  return v >= kFull ? kFull : static_cast<uint32_t>(v);
}

// All bytes of an array file before its numbers, a multiple of 64; returns their count.
size_t print_header(const NpyArray& a, char (&out)[192]) {
  char shape[96] = "";
  int at = 0;
  for (int32_t i = 0; i < a.dims; ++i)
    at += std::snprintf(shape + at, sizeof shape - static_cast<size_t>(at), "%" PRIu64 ", ", a.shape[i]);
  char text[192];
  const int n = std::snprintf(text, sizeof text, "{'descr': '%s', 'fortran_order': False, 'shape': (%s), }",
                              a.type, shape);
  const size_t length = (kHead + static_cast<size_t>(n) + 1 + 63) / 64 * 64 - kHead;
  std::memcpy(out, kMagic, 8);  // the terminator is the minor version
  out[8] = static_cast<char>(length & 255), out[9] = static_cast<char>(length >> 8);
  std::memset(out + kHead, ' ', length);
  std::memcpy(out + kHead, text, static_cast<size_t>(n));
  out[kHead + length - 1] = '\n';
  return kHead + length;
}

// The literal's tokens, one after the other.
class Literal {
 public:
  Literal(const char* text, size_t size) : at_(text), end_(text + size) {}
  bool take(const char* token) {
    skip();
    const size_t n = std::strlen(token);
    if (static_cast<size_t>(end_ - at_) < n || std::memcmp(at_, token, n) != 0) return false;
    at_ += n;
    return true;
  }
  bool quoted(char* out, size_t capacity) {
    if (!take("'")) return false;
    const char* begin = at_;
    while (at_ < end_ && *at_ != '\'') ++at_;
    const auto n = static_cast<size_t>(at_ - begin);
    if (at_ == end_ || n >= capacity) return false;
    std::memcpy(out, begin, n);
    out[n] = '\0';
    ++at_;
    return true;
  }
  bool number(uint64_t* out) {
    skip();
    const char* begin = at_;
    for (*out = 0; at_ < end_ && *at_ >= '0' && *at_ <= '9'; ++at_) {
      if (*out > UINT64_MAX / 100) return false;
      *out = 10 * *out + static_cast<uint64_t>(*at_ - '0');
    }
    return at_ > begin;
  }

 private:
  void skip() {
    while (at_ < end_ && (*at_ == ' ' || *at_ == '\n')) ++at_;
  }
  const char *at_, *end_;
};

bool parse_shape(Literal& text, NpyArray* a) {
  if (!text.take("(")) return false;
  while (!text.take(")")) {
    if (a->dims == kMaxArrayDims || !text.number(&a->shape[a->dims])) return false;
    ++a->dims;
    if (!text.take(",")) return text.take(")");
  }
  return true;
}

bool parse_header(Literal& text, NpyArray* a) {
  if (!text.take("{")) return false;
  unsigned seen = 0;  // a bit a key
  for (int i = 0; i < 3; ++i) {
    bool good;
    if (text.take("'descr'"))
      seen |= 1, good = text.take(":") && text.quoted(a->type, sizeof a->type);
    else if (text.take("'fortran_order'"))
      seen |= 2, good = text.take(":") && text.take("False");
    else
      seen |= 4, good = text.take("'shape'") && text.take(":") && parse_shape(text, a);
    if (!good) return false;
    if (!text.take(",")) break;
  }
  return text.take("}") && seen == 7;
}

}  // namespace

size_t NpyArray::item_bytes() const {
  for (const char* known : {"<f4", "<i4", "<u4"})
    if (std::strcmp(type, known) == 0) return 4;
  for (const char* known : {"<i8", "<u8", "<f8"})
    if (std::strcmp(type, known) == 0) return 8;
  if (std::strcmp(type, "<i2") == 0) return 2;
  if (std::strcmp(type, "|u1") == 0 || std::strcmp(type, "|b1") == 0) return 1;
  if (std::strncmp(type, "|S", 2) != 0 || !type[2]) return 0;
  size_t n = 0;
  for (const char* p = type + 2; *p; ++p) {
    if (*p < '0' || *p > '9') return 0;
    n = 10 * n + static_cast<size_t>(*p - '0');
  }
  return n;
}

uint64_t NpyArray::bytes() const {
  uint64_t out = item_bytes();
  for (int32_t i = 0; i < dims; ++i)
    out = shape[i] && out > UINT64_MAX / shape[i] ? UINT64_MAX : out * shape[i];
  return out;
}

bool NpyArray::is(const char* other, int32_t d) const {
  return dims == d && std::strcmp(type, other) == 0;
}

template <class T>
void NpzWriter::put(T value) {
  bytes(&value, sizeof value);  // little-endian, as the machine is
}

void NpzWriter::bytes(const void* data, size_t size) {
  const auto* p = static_cast<const unsigned char*>(data);
  if (size) out_.insert(out_.end(), p, p + size);
}

void NpzWriter::add(const char* name, const NpyArray& array) {
  char head[192];
  const size_t head_bytes = print_header(array, head);
  const auto data_bytes = static_cast<size_t>(array.bytes());
  Member& m = members_[count_++];
  std::snprintf(m.name, sizeof m.name, "%s.npy", name);
  m.size = head_bytes + data_bytes;
  m.offset = out_.size();
  m.checksum = crc32(array.data, data_bytes, crc32(head, head_bytes));
  const bool wide = m.size >= kFull;
  const size_t length = std::strlen(m.name);
  put(kLocal), put(wide ? kNew : kOld), put(uint16_t{0}), put(uint16_t{0}), put(uint16_t{0}), put(kDate);
  put(m.checksum), put(low32(m.size)), put(low32(m.size));
  put(static_cast<uint16_t>(length)), put(static_cast<uint16_t>(wide ? 20 : 0)), bytes(m.name, length);
  if (wide) put(kExtra64), put(uint16_t{16}), put(m.size), put(m.size);
  bytes(head, head_bytes);
  bytes(array.data, data_bytes);
}

void NpzWriter::finish() {
  const uint64_t begin = out_.size();
  for (int i = 0; i < count_; ++i) {
    const Member& m = members_[i];
    const auto extra = static_cast<uint16_t>((m.size >= kFull ? 16 : 0) + (m.offset >= kFull ? 8 : 0));
    const uint16_t version = extra ? kNew : kOld;
    const size_t length = std::strlen(m.name);
    put(kCentral), put(version), put(version), put(uint16_t{0}), put(uint16_t{0}), put(uint16_t{0}),
        put(kDate);
    put(m.checksum), put(low32(m.size)), put(low32(m.size)), put(static_cast<uint16_t>(length));
    put(static_cast<uint16_t>(extra ? extra + 4 : 0)), put(uint16_t{0}), put(uint16_t{0}), put(uint16_t{0});
    put(uint32_t{0}), put(low32(m.offset)), bytes(m.name, length);
    if (extra) put(kExtra64), put(extra);
    if (m.size >= kFull) put(m.size), put(m.size);
    if (m.offset >= kFull) put(m.offset);
  }
  const uint64_t size = out_.size() - begin;
  const auto count = static_cast<uint16_t>(count_);
  if (begin + size >= kFull) {
    put(kEnd64), put(uint64_t{kEnd64Bytes - 12}), put(kNew), put(kNew), put(uint32_t{0}), put(uint32_t{0});
    put(uint64_t{count}), put(uint64_t{count}), put(size), put(begin);
    put(kLocator64), put(uint32_t{0}), put(begin + size), put(uint32_t{1});
  }
  put(kEnd), put(uint16_t{0}), put(uint16_t{0}), put(count), put(count);
  put(low32(size)), put(low32(begin)), put(uint16_t{0});
}

NpzReader::NpzReader(const ByteSource& source, const char* what)
    : source_(source), size_(source.size()), what_(what) {
  read_directory();
}

void NpzReader::bad(const char* why) const {
  fail(Code::kFormat, "%s: %s", what_, why);
}

template <class T>
T NpzReader::value(uint64_t at) const {
  if (at > size_ || size_ - at < sizeof(T)) bad("the archive is truncated");
  T v;
  source_.read(at, &v, sizeof v);
  return v;
}

void NpzReader::read_directory() {
  // the end record is followed by a comment of up to 65,535 bytes, and comes after its 64-bit form
  if (size_ < kEndBytes) bad("it is not a complete archive (.npz)");
  const uint64_t first = size_ - std::min(size_, kMostComment + kEndBytes);
  Vector<unsigned char> tail(static_cast<size_t>(size_ - first));
  source_.read(first, tail.data(), tail.size());
  size_t back = tail.size() - kEndBytes;
  while (std::memcmp(tail.data() + back, &kEnd, sizeof kEnd) != 0) {
    if (back == 0) bad("it is not a complete archive (.npz)");
    --back;
  }
  const uint64_t end = first + back;
  uint64_t count = value<uint16_t>(end + 10), bytes = value<uint32_t>(end + 12),
           begin = value<uint32_t>(end + 16);
  if (end >= kLocatorBytes && value<uint32_t>(end - kLocatorBytes) == kLocator64) {
    const auto at = value<uint64_t>(end - kLocatorBytes + 8);
    if (at > size_ || size_ - at < kEnd64Bytes) bad("the archive's directory is truncated");
    count = value<uint64_t>(at + 32), bytes = value<uint64_t>(at + 40), begin = value<uint64_t>(at + 48);
  }
  if (begin > size_ || size_ - begin < bytes) bad("the archive's directory is truncated");
  uint64_t at = begin;
  for (uint64_t i = 0; i < std::min<uint64_t>(count, kMost); ++i) at = read_member(at, begin + bytes);
}

uint64_t NpzReader::read_member(uint64_t at, uint64_t end) {
  if (end - at < kCentralBytes) bad("the archive's directory is truncated");
  if (value<uint32_t>(at) != kCentral) bad("the archive's directory is damaged");
  Member m{};
  m.flags = value<uint16_t>(at + 8), m.method = value<uint16_t>(at + 10);
  m.checksum = value<uint32_t>(at + 16);
  m.packed = value<uint32_t>(at + 20), m.size = value<uint32_t>(at + 24);
  const uint64_t name = value<uint16_t>(at + 28), extra = value<uint16_t>(at + 30),
                 comment = value<uint16_t>(at + 32);
  m.offset = value<uint32_t>(at + 42);
  at += kCentralBytes;
  if (end - at < name + extra + comment) bad("the archive's directory is truncated");
  Vector<char> here(static_cast<size_t>(name)), there(static_cast<size_t>(name));
  source_.read(at, here.data(), here.size());
  std::copy_n(here.data(), std::min(here.size(), sizeof m.name - 1), m.name);
  const uint64_t stop = at + name + extra;
  for (uint64_t e = at + name; stop - e >= 4;) {
    const auto id = value<uint16_t>(e), length = value<uint16_t>(e + 2);
    if (length > stop - e - 4) bad("the archive's directory is damaged");
    uint64_t field = e + 4;
    for (uint64_t* v : {&m.size, &m.packed, &m.offset}) {
      if (id != kExtra64 || *v != kFull || field + 8 > e + 4 + length) continue;
      *v = value<uint64_t>(field);
      field += 8;
    }
    e += 4u + length;
  }
  // a damaged name would look like a missing member, so the two places that hold the name are compared
  const uint64_t local = m.offset + kLocalBytes;
  if (local > size_ || size_ - local < name || value<uint16_t>(m.offset + 26) != name)
    bad("the archive's directory is damaged");
  source_.read(local, there.data(), there.size());
  if (here != there) bad("the archive's directory is damaged");
  members_.push_back(m);
  return stop + comment;
}

const NpzReader::Member* NpzReader::find(const char* name) const {
  const size_t n = std::strlen(name);
  for (const Member& m : members_)
    if (std::strncmp(m.name, name, n) == 0 && std::strcmp(m.name + n, ".npy") == 0) return &m;
  return nullptr;
}

void NpzReader::refuse(const char* name, const char* why) const {
  fail(Code::kFormat, "%s: array %s %s", what_, name, why);
}

NpyArray NpzReader::read_header(const char* name, Place* place) const {
  const Member* m = find(name);
  if (!m) refuse(name, "is missing");
  if (m->method != 0 || (m->flags & kEncrypted))
    refuse(name, "is compressed: write the file with numpy.savez");
  if (m->size != m->packed || m->offset > size_ || size_ - m->offset < kLocalBytes)
    refuse(name, "is truncated");
  if (value<uint32_t>(m->offset) != kLocal) refuse(name, "is not where the archive's directory says");
  const uint64_t begin =
      m->offset + kLocalBytes + value<uint16_t>(m->offset + 26) + value<uint16_t>(m->offset + 28);
  if (begin > size_ || size_ - begin < m->size) refuse(name, "is truncated");
  if (m->size > SIZE_MAX / 2) refuse(name, "is longer than the memory of this machine can be");
  const auto size = static_cast<size_t>(m->size);
  unsigned char head[kHead];
  if (size < kHead) refuse(name, "is not a numpy array of format version 1");
  source_.read(begin, head, kHead);
  if (std::memcmp(head, kMagic, 8) != 0) refuse(name, "is not a numpy array of format version 1");
  const size_t length = head[8] + 256u * head[9];
  if (length > size - kHead) refuse(name, "ends within its header");
  Vector<char> literal(length);
  source_.read(begin + kHead, literal.data(), length);
  Literal text(literal.data(), length);
  NpyArray a;
  if (!parse_header(text, &a)) refuse(name, "has a header that cannot be read");
  if (a.item_bytes() == 0) refuse(name, "has a type that cannot be read");
  if (a.bytes() != size - kHead - length) refuse(name, "does not have the length that its header says");
  *place = {begin, size, kHead + length, m->checksum};
  return a;
}

NpyArray NpzReader::header(const char* name) const {
  Place place;
  return read_header(name, &place);
}

NpyArray NpzReader::array(const char* name) {
  Place place;
  NpyArray a = read_header(name, &place);
  Vector<unsigned char>().swap(bytes_);  // free the last array before the next one is allocated
  bytes_.resize(place.size);
  source_.read(place.begin, bytes_.data(), place.size);
  if (crc32(bytes_.data(), place.size) != place.checksum)
    refuse(name, "is damaged: its checksum does not match");
  a.data = bytes_.data() + place.head;
  return a;
}

}  // namespace rdm
