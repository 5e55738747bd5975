// Signatures and fields are those of PKWARE's application note (APPNOTE.TXT), section 4.3.
#include "record/zip.hpp"

#include <zlib.h>

#include <algorithm>
#include <cstring>

#include "common/report.hpp"

namespace tool {
namespace {

constexpr uint32_t kLocal = 0x04034b50, kCentral = 0x02014b50, kEnd = 0x06054b50, kEnd64 = 0x06064b50,
                   kLocator64 = 0x07064b50;
constexpr uint32_t kFull = 0xffffffff;  // the value stands in the 64-bit form
constexpr uint16_t kFull16 = 0xffff, kExtra64 = 1, kOld = 20, kNew = 45, kDeflated = 8;
constexpr uint16_t kDate = 1 << 5 | 1;  // 1980-01-01: the same rollout gives the same bytes
constexpr size_t kEndBytes = 22, kEnd64Bytes = 56, kLocatorBytes = 20, kCentralBytes = 46, kLocalBytes = 30;
constexpr size_t kMostDirectory = size_t{1} << 20;
constexpr uint64_t kMostRatio = 1100;  // deflate packs no tighter

class Bytes {
 public:
  template <class T>
  Bytes& add(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof value);  // little-endian, as the machine is
    return *this;
  }
  Bytes& add(const std::string& text) {
    bytes_ += text;
    return *this;
  }
  const std::string& text() const { return bytes_; }

 private:
  std::string bytes_;
};

uint32_t low32(uint64_t v) {
  return v >= kFull ? kFull : static_cast<uint32_t>(v);
}

// Little-endian; Failure past the end.
template <class T>
T value_at(const std::string& bytes, size_t at) {
  T value;
  if (at > bytes.size() || bytes.size() - at < sizeof value)
    throw Failure("the archive's directory is truncated");
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

// The first `size` bytes of what is packed; `whole`: it ends there.
std::string inflated(const std::string& packed, size_t size, bool whole) {
  std::string out(size, '\0');
  z_stream z{};
  if (inflateInit2(&z, -MAX_WBITS) != Z_OK) throw Failure("zlib reports an error");
  constexpr size_t kPart = size_t{1} << 30;  // its counters have 32 bits
  size_t in = 0, done = 0;
  int state = Z_OK;
  while (state == Z_OK) {
    const size_t give = std::min(kPart, packed.size() - in), room = std::min(kPart, out.size() - done);
    z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + in));
    z.next_out = reinterpret_cast<Bytef*>(out.data() + done);
    z.avail_in = static_cast<uInt>(give);
    z.avail_out = static_cast<uInt>(room);
    state = inflate(&z, Z_NO_FLUSH);
    in += give - z.avail_in;
    done += room - z.avail_out;
    if (state == Z_OK && give == z.avail_in && room == z.avail_out) break;
  }
  inflateEnd(&z);
  const bool ended = state == Z_STREAM_END;
  if (done != size || (whole && !ended)) throw Failure("a compressed array is damaged");
  return out;
}

}  // namespace

uint32_t checksum_of(uint32_t before, const void* bytes, size_t size) {
  return static_cast<uint32_t>(crc32_z(before, static_cast<const Bytef*>(bytes), size));
}

void ZipWriter::begin(const std::string& name, uint64_t size) {
  close_member();
  const bool wide = size >= kFull;
  Bytes head;
  head.add(kLocal).add(wide ? kNew : kOld).add(uint16_t{0}).add(uint16_t{0}).add(uint16_t{0}).add(kDate);
  head.add(uint32_t{0}).add(low32(size)).add(low32(size));
  head.add(static_cast<uint16_t>(name.size())).add(static_cast<uint16_t>(wide ? 20 : 0)).add(name);
  if (wide) head.add(kExtra64).add(uint16_t{16}).add(size).add(size);
  members_.push_back({name, size, file_.size(), 0});
  file_.write(head.text().data(), head.text().size());
}

void ZipWriter::write(const void* bytes, size_t size) {
  members_.back().checksum = checksum_of(members_.back().checksum, bytes, size);
  file_.write(bytes, size);
}

void ZipWriter::close_member() {
  if (members_.empty()) return;
  const Member& m = members_.back();
  file_.write_at(m.offset + 14, &m.checksum, sizeof m.checksum);
}

void ZipWriter::finish() {
  close_member();
  const uint64_t begin = file_.size();
  Bytes all;
  for (const Member& m : members_) {
    Bytes extra;
    if (m.size >= kFull) extra.add(m.size).add(m.size);
    if (m.offset >= kFull) extra.add(m.offset);
    const auto length = static_cast<uint16_t>(extra.text().size());
    const uint16_t version = length ? kNew : kOld;
    all.add(kCentral).add(version).add(version).add(uint16_t{0}).add(uint16_t{0}).add(uint16_t{0}).add(kDate);
    all.add(m.checksum).add(low32(m.size)).add(low32(m.size)).add(static_cast<uint16_t>(m.name.size()));
    all.add(static_cast<uint16_t>(length ? length + 4 : 0))
        .add(uint16_t{0})
        .add(uint16_t{0})
        .add(uint16_t{0});
    all.add(uint32_t{0}).add(low32(m.offset)).add(m.name);
    if (length) all.add(kExtra64).add(length).add(extra.text());
  }
  const uint64_t size = all.text().size(), count = members_.size();
  if (begin + size >= kFull) {
    all.add(kEnd64).add(uint64_t{kEnd64Bytes - 12}).add(kNew).add(kNew).add(uint32_t{0}).add(uint32_t{0});
    all.add(count).add(count).add(size).add(begin);
    all.add(kLocator64).add(uint32_t{0}).add(begin + size).add(uint32_t{1});
  }
  all.add(kEnd).add(uint16_t{0}).add(uint16_t{0}).add(static_cast<uint16_t>(count));
  all.add(static_cast<uint16_t>(count)).add(low32(size)).add(low32(begin)).add(uint16_t{0});
  file_.write(all.text().data(), all.text().size());
}

ZipReader::ZipReader(uint64_t size, Read read) : size_(size), read_(std::move(read)) {
  // the end stands before a comment of up to 65,535 bytes, and after the 64-bit form of itself
  const auto tail_bytes = static_cast<size_t>(std::min<uint64_t>(size, kFull16 + kEndBytes));
  std::string tail(tail_bytes, '\0');
  read_(size - tail_bytes, tail.data(), tail_bytes);
  constexpr uint32_t kSignature = kEnd;
  const size_t end = tail.rfind(std::string(reinterpret_cast<const char*>(&kSignature), 4));
  if (end == std::string::npos || tail.size() - end < kEndBytes)
    throw Failure("it is not a complete archive (.npz)");
  uint64_t count = value_at<uint16_t>(tail, end + 10), bytes = value_at<uint32_t>(tail, end + 12),
           begin = value_at<uint32_t>(tail, end + 16);
  if (end >= kLocatorBytes && value_at<uint32_t>(tail, end - kLocatorBytes) == kLocator64) {
    const auto at = value_at<uint64_t>(tail, end - kLocatorBytes + 8);
    if (at > size || size - at < kEnd64Bytes) throw Failure("the archive's directory is truncated");
    std::string wide(kEnd64Bytes, '\0');
    read_(at, wide.data(), wide.size());
    count = value_at<uint64_t>(wide, 32);
    bytes = value_at<uint64_t>(wide, 40);
    begin = value_at<uint64_t>(wide, 48);
  }
  if (bytes > kMostDirectory || begin > size || size - begin < bytes)
    throw Failure("the archive's directory is truncated");
  std::string directory(static_cast<size_t>(bytes), '\0');
  read_(begin, directory.data(), directory.size());
  size_t at = 0;
  for (uint64_t i = 0; i < count; ++i) add_member(directory, at);
}

void ZipReader::add_member(const std::string& directory, size_t& at) {
  if (value_at<uint32_t>(directory, at) != kCentral) throw Failure("the archive's directory is damaged");
  Member m;
  const auto flags = value_at<uint16_t>(directory, at + 8), method = value_at<uint16_t>(directory, at + 10);
  m.deflated = method == kDeflated;
  m.checksum = value_at<uint32_t>(directory, at + 16);
  m.packed = value_at<uint32_t>(directory, at + 20);
  m.size = value_at<uint32_t>(directory, at + 24);
  const size_t name = value_at<uint16_t>(directory, at + 28), extra = value_at<uint16_t>(directory, at + 30),
               comment = value_at<uint16_t>(directory, at + 32);
  m.offset = value_at<uint32_t>(directory, at + 42);
  at += kCentralBytes;
  if (directory.size() - at < name + extra + comment) throw Failure("the archive's directory is truncated");
  m.name = directory.substr(at, name);
  const size_t end = at + name + extra;
  for (size_t e = at + name; end - e >= 4;) {
    const auto id = value_at<uint16_t>(directory, e), length = value_at<uint16_t>(directory, e + 2);
    if (length > end - e - 4) throw Failure("the archive's directory is damaged");
    size_t field = e + 4;
    for (uint64_t* value : {&m.size, &m.packed, &m.offset}) {
      if (id != kExtra64 || *value != kFull || field + 8 > e + 4 + length) continue;
      *value = value_at<uint64_t>(directory, field);
      field += 8;
    }
    e += 4u + length;
  }
  at = end + comment;
  if ((flags & 1) || (method != 0 && !m.deflated))
    throw Failure("member " + m.name + " is compressed in an unknown way");
  if (m.packed > size_ || (m.deflated ? m.size / kMostRatio > m.packed : m.size != m.packed))
    throw Failure("member " + m.name + " is truncated");
  members_.push_back(std::move(m));
}

bool ZipReader::has(const std::string& name) const {
  return std::any_of(members_.begin(), members_.end(), [&](const Member& m) { return m.name == name; });
}

const ZipReader::Member& ZipReader::find(const std::string& name) const {
  const auto found =
      std::find_if(members_.begin(), members_.end(), [&](const Member& m) { return m.name == name; });
  if (found == members_.end()) throw Failure("it has no " + name);
  return *found;
}

// Where its bytes are.
uint64_t ZipReader::begin_of(const Member& m) const {
  if (m.offset > size_ || size_ - m.offset < kLocalBytes) throw Failure("member " + m.name + " is truncated");
  std::string head(kLocalBytes, '\0');
  read_(m.offset, head.data(), head.size());
  if (value_at<uint32_t>(head, 0) != kLocal)
    throw Failure("member " + m.name + " is not where the archive's directory says");
  const uint64_t begin = m.offset + kLocalBytes + value_at<uint16_t>(head, 26) + value_at<uint16_t>(head, 28);
  if (begin > size_ || size_ - begin < m.packed) throw Failure("member " + m.name + " is truncated");
  return begin;
}

uint64_t ZipReader::size(const std::string& name) const {
  return find(name).size;
}

std::string ZipReader::head(const std::string& name, size_t most) const {
  const Member& m = find(name);
  const auto size = static_cast<size_t>(std::min<uint64_t>(most, m.size));
  // so few bytes are packed in no more than this
  const size_t packed =
      m.deflated ? static_cast<size_t>(std::min<uint64_t>(2 * most + 4096, m.packed)) : size;
  std::string bytes(packed, '\0');
  read_(begin_of(m), bytes.data(), bytes.size());
  return m.deflated ? inflated(bytes, size, false) : bytes;
}

std::string ZipReader::member(const std::string& name, uint64_t most) const {
  const Member& m = find(name);
  if (m.size > most) throw Failure("member " + name + " has more than " + std::to_string(most) + " bytes");
  std::string bytes(static_cast<size_t>(m.packed), '\0');
  read_(begin_of(m), bytes.data(), bytes.size());
  if (m.deflated) bytes = inflated(bytes, static_cast<size_t>(m.size), true);
  if (checksum_of(0, bytes.data(), bytes.size()) != m.checksum)
    throw Failure("member " + name + " is damaged");
  return bytes;
}

}  // namespace tool
