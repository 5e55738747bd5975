#include "view/websocket.hpp"

#include <array>

#include "common/text.hpp"
#include "web/page.hpp"

namespace tool {
namespace {

// SHA-1 (FIPS 180-4), which the handshake wants; nothing is kept secret by it.
std::string sha1(std::string text) {
  std::array<uint32_t, 5> h = {0x67452301u, 0xefcdab89u, 0x98badcfeu, 0x10325476u, 0xc3d2e1f0u};
  const uint64_t bits = 8 * static_cast<uint64_t>(text.size());
  text += '\x80';
  while (text.size() % 64 != 56) text += '\0';
  for (int k = 7; k >= 0; --k) text += static_cast<char>(bits >> (8 * k) & 255);
  const auto turn = [](uint32_t x, int n) { return x << n | x >> (32 - n); };
  for (size_t at = 0; at < text.size(); at += 64) {
    std::array<uint32_t, 80> w{};
    for (size_t i = 0; i < 64; ++i) w[i / 4] = w[i / 4] << 8 | static_cast<unsigned char>(text[at + i]);
    for (size_t i = 16; i < 80; ++i) w[i] = turn(w[i - 3] ^ w[i - 8] ^ w[i - 14] ^ w[i - 16], 1);
    auto [a, b, c, d, e] = h;
    for (size_t i = 0; i < 80; ++i) {
      uint32_t f = b ^ c ^ d, k = 0xca62c1d6u;
      if (i < 20)
        f = (b & c) | (~b & d), k = 0x5a827999u;
      else if (i < 40)
        k = 0x6ed9eba1u;
      else if (i < 60)
        f = (b & c) | (b & d) | (c & d), k = 0x8f1bbcdcu;
      const uint32_t next = turn(a, 5) + f + e + k + w[i];
      e = d, d = c, c = turn(b, 30), b = a, a = next;
    }
    h[0] += a, h[1] += b, h[2] += c, h[3] += d, h[4] += e;
  }
  std::string out;
  for (const uint32_t x : h)
    for (int k = 3; k >= 0; --k) out += static_cast<char>(x >> (8 * k) & 255);
  return out;
}

}  // namespace

std::string websocket_accept(const std::string& key) {
  const std::string digest = sha1(key + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11");
  return base64(digest.data(), digest.size());
}

bool is_websocket_key(const std::string& key) {
  return key.size() == 24 && key.substr(22) == "==" &&
         key.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/") == 22;
}

std::string websocket_frame(int kind, const std::string& payload) {
  const uint64_t size = payload.size();
  std::string out(1, static_cast<char>(0x80 | kind));
  const int wide = size < 126 ? 0 : size < 65536 ? 2 : 8;
  out += static_cast<char>(wide == 0 ? size : wide == 2 ? 126 : 127);
  for (int k = wide - 1; k >= 0; --k) out += static_cast<char>(size >> (8 * k) & 255);
  return out + payload;
}

void WebsocketReader::add(const char* bytes, size_t size) {
  waiting_.erase(0, read_);
  read_ = 0;
  if (!broken_) waiting_.append(bytes, size);
}

bool WebsocketReader::fail() {
  broken_ = true;
  waiting_.clear();
  read_ = 0;
  part_ = {};
  return false;
}

bool WebsocketReader::next(Message* out) {
  while (!broken_ && waiting_.size() - read_ >= 2) {
    const size_t there = waiting_.size() - read_;
    const auto byte = [&](size_t i) {
      return static_cast<uint64_t>(static_cast<unsigned char>(waiting_[read_ + i]));
    };
    const bool last = byte(0) & 0x80, masked = byte(1) & 0x80, extended = byte(0) & 0x70;
    const int kind = static_cast<int>(byte(0) & 15);
    const bool control = kind >= 8;
    uint64_t size = byte(1) & 127;
    const size_t wide = size < 126 ? 0 : size == 126 ? 2 : 8, head = 2 + wide + 4;
    if (extended || !masked || (control && (!last || wide))) return fail();
    if (there < head) return false;
    for (size_t k = 0; k < wide; ++k) size = (k ? size << 8 : 0) | byte(2 + k);
    if (kind != 0 && kind != kFrameText && kind != kFrameBytes && kind != kFrameClose && kind != kFramePing &&
        kind != kFramePong)
      return fail();
    if (!control && (kind == 0) != (part_.kind != 0)) return fail();
    if (size > kMostMessage || (!control && part_.payload.size() + size > kMostMessage)) return fail();
    if (there < head + size) return false;
    std::string payload = waiting_.substr(read_ + head, size);
    for (size_t i = 0; i < payload.size(); ++i)
      payload[i] = static_cast<char>(payload[i] ^ waiting_[read_ + head - 4 + i % 4]);
    read_ += head + size;
    if (control) {
      *out = {kind, std::move(payload)};
      return true;
    }
    if (kind != 0) part_.kind = kind;
    part_.payload += payload;
    if (!last) continue;
    if (part_.kind == kFrameText && !is_utf8(part_.payload)) return fail();
    *out = std::move(part_);
    part_ = {};
    return true;
  }
  return false;
}

}  // namespace tool
