// WebSocket (RFC 6455) as a server speaks it: the key of the handshake, and messages in both directions.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>

namespace tool {

inline constexpr size_t kMostMessage = size_t{1} << 16;  // bytes of one that is received

// What the handshake answers to a client's key.
std::string websocket_accept(const std::string& key);
// 16 bytes in base64, as the RFC wants a key to be.
bool is_websocket_key(const std::string& key);

enum : int { kFrameText = 1, kFrameBytes = 2, kFrameClose = 8, kFramePing = 9, kFramePong = 10 };
// A whole message as a frame.
std::string websocket_frame(int kind, const std::string& payload);

// Messages out of a client's bytes, which come in any portions. It holds one message and the bytes that were added since.
class WebsocketReader {
 public:
  struct Message {
    int kind = 0;
    std::string payload;
  };
  void add(const char* bytes, size_t size);
  // True: *out is the next message. False: more bytes are needed, or broken().
  bool next(Message* out);
  // The client kept no rule of the protocol's, or sent more than kMostMessage bytes: nothing more comes.
  bool broken() const { return broken_; }

 private:
  bool fail();
  std::string waiting_;
  size_t read_ = 0;  // of its bytes
  Message part_;     // of a message in several frames; kind 0: none
  bool broken_ = false;
};

}  // namespace tool
