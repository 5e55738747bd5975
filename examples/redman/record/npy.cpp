#include "record/npy.hpp"

#include <algorithm>
#include <cstring>

#include "common/report.hpp"

namespace tool {
namespace {

constexpr char kMagic[] = "\x93NUMPY\x01";  // and minor version 0
constexpr size_t kHeadBytes = 10;           // magic, version, length of the text
constexpr size_t kMostShape = 4;

std::u32string points_of(const std::string& utf8) {
  std::u32string out;
  for (size_t i = 0; i < utf8.size();) {
    const auto first = static_cast<unsigned char>(utf8[i]);
    const size_t size = first < 0x80 ? 1 : first < 0xe0 ? 2 : first < 0xf0 ? 3 : 4;
    char32_t point = size == 1 ? first : first & (0x7fu >> size);
    for (size_t k = 1; k < size && i + k < utf8.size(); ++k)
      point = point << 6 | (static_cast<unsigned char>(utf8[i + k]) & 0x3fu);
    out += point;
    i += size;
  }
  return out;
}

void append_point(std::string& out, char32_t point) {
  if (point > 0x10ffff || (point >= 0xd800 && point < 0xe000))
    throw Failure("a text contains an invalid character");
  const auto put = [&](char32_t bits) { out += static_cast<char>(bits); };
  if (point < 0x80) return put(point);
  if (point < 0x800) {
    put(0xc0 | point >> 6);
  } else if (point < 0x10000) {
    put(0xe0 | point >> 12);
    put(0x80 | (point >> 6 & 0x3f));
  } else {
    put(0xf0 | point >> 18);
    put(0x80 | (point >> 12 & 0x3f));
    put(0x80 | (point >> 6 & 0x3f));
  }
  put(0x80 | (point & 0x3f));
}

// The literal's tokens, one after the other: numpy writes {'descr': '<f4', 'fortran_order': False, 'shape':
// (3, 4), }.
class Literal {
 public:
  explicit Literal(std::string text) : text_(std::move(text)) {}
  bool take(const std::string& token) {
    skip();
    if (text_.compare(at_, token.size(), token) != 0) return false;
    at_ += token.size();
    return true;
  }
  void need(const std::string& token) {
    if (!take(token)) throw Failure("it is not a numpy array: its header has no " + token);
  }
  std::string quoted() {
    need("'");
    const size_t end = text_.find('\'', at_);
    if (end == std::string::npos || end - at_ > 16)
      throw Failure("it is not a numpy array: its type cannot be read");
    const std::string out = text_.substr(at_, end - at_);
    at_ = end + 1;
    return out;
  }
  uint64_t number() {
    skip();
    uint64_t out = 0;
    const size_t begin = at_;
    for (; at_ < text_.size() && text_[at_] >= '0' && text_[at_] <= '9'; ++at_) {
      if (out > UINT64_MAX / 100) throw Failure("it is not a numpy array: its shape cannot be read");
      out = 10 * out + static_cast<uint64_t>(text_[at_] - '0');
    }
    if (at_ == begin) throw Failure("it is not a numpy array: its shape cannot be read");
    return out;
  }
  bool digit() {
    skip();
    return at_ < text_.size() && text_[at_] >= '0' && text_[at_] <= '9';
  }

 private:
  void skip() {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\n')) ++at_;
  }
  std::string text_;
  size_t at_ = 0;
};

}  // namespace

size_t ArrayShape::item_bytes() const {
  for (const char* known : {"<f4", "<i4", "<u4"})
    if (type == known) return 4;
  for (const char* known : {"<i8", "<u8", "<f8"})
    if (type == known) return 8;
  if (type == "|u1" || type == "|b1") return 1;
  const bool bytes = type.compare(0, 2, "|S") == 0;
  if (type.size() < 3 || type.size() > 9 || (!bytes && type.compare(0, 2, "<U") != 0)) return 0;
  size_t points = 0;
  for (size_t i = 2; i < type.size(); ++i) {
    if (type[i] < '0' || type[i] > '9') return 0;
    points = 10 * points + static_cast<size_t>(type[i] - '0');
  }
  return bytes ? points : 4 * points;
}

uint64_t ArrayShape::bytes() const {
  uint64_t out = item_bytes();
  for (const uint64_t n : shape) out = n && out > UINT64_MAX / n ? UINT64_MAX : out * n;
  return out;
}

std::string npy_header(const ArrayShape& array) {
  std::string text = "{'descr': '" + array.type + "', 'fortran_order': False, 'shape': (";
  for (const uint64_t n : array.shape) text += std::to_string(n) + ", ";
  text += "), }";
  text.resize((kHeadBytes + text.size() + 1 + 63) / 64 * 64 - kHeadBytes - 1, ' ');
  text += '\n';
  std::string out(kMagic, 8);  // the terminator is the minor version
  out += static_cast<char>(text.size() & 255);
  out += static_cast<char>(text.size() >> 8);
  return out + text;
}

ArrayShape parse_npy_head(const char* bytes, size_t size, size_t* begin) {
  if (size < kHeadBytes || std::memcmp(bytes, kMagic, 8) != 0)
    throw Failure("it is not a numpy array of format version 1");
  const size_t length = static_cast<unsigned char>(bytes[8]) + 256u * static_cast<unsigned char>(bytes[9]);
  if (length > size - kHeadBytes) throw Failure("an array ends within its header");
  *begin = kHeadBytes + length;
  Literal text(std::string(bytes + kHeadBytes, length));
  ArrayShape out;
  text.need("{");
  unsigned seen = 0;  // a bit a key
  for (int i = 0; i < 3; ++i) {
    if (text.take("'descr'")) {
      seen |= 1;
      text.need(":");
      out.type = text.quoted();
    } else if (text.take("'fortran_order'")) {
      seen |= 2;
      text.need(":");
      if (!text.take("False")) throw Failure("an array is in Fortran order, which is not read");
    } else {
      text.need("'shape'");
      seen |= 4;
      text.need(":");
      text.need("(");
      while (text.digit() && out.shape.size() < kMostShape) {
        out.shape.push_back(text.number());
        if (!text.take(",")) break;
      }
      text.need(")");
    }
    if (!text.take(",")) break;
  }
  text.need("}");
  if (seen != 7) throw Failure("it is not a numpy array: its header is incomplete");
  if (out.item_bytes() == 0) throw Failure("the type of an array is unknown");
  return out;
}

ArrayShape parse_npy(const char* bytes, size_t size, size_t* begin) {
  ArrayShape out = parse_npy_head(bytes, size, begin);
  if (out.bytes() != size - *begin) throw Failure("an array does not have the length that its header says");
  return out;
}

ArrayShape text_shape(const std::string& utf8) {
  return {"<U" + std::to_string(std::max<size_t>(points_of(utf8).size(), 1)), {}};
}

std::string text_bytes(const std::string& utf8) {
  std::u32string points = points_of(utf8);
  if (points.empty()) points += char32_t{0};
  std::string out(points.size() * sizeof(char32_t), '\0');
  std::memcpy(out.data(), points.data(), out.size());
  return out;
}

std::string text_of_array(const ArrayShape& array, const char* bytes) {
  if (array.type.compare(0, 2, "<U") != 0 || !array.shape.empty()) throw Failure("an array is not a text");
  std::string out;
  for (size_t i = 0; i < array.item_bytes() / 4; ++i) {
    char32_t point;
    std::memcpy(&point, bytes + 4 * i, sizeof point);
    if (point == 0) break;  // numpy fills up with zeros
    append_point(out, point);
  }
  return out;
}

}  // namespace tool
