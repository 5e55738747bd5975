// The page's server: one page behind an address that nobody can guess, and a WebSocket to each window that shows it.
//
// It listens at 127.0.0.1 alone. A request has to name this machine and this port as its host, to carry the token in its
// path, and where it says what page it comes from (a WebSocket always does), to come from this one: so pages of others,
// and names of others that lead here, get an empty refusal. Heads have at most kMostHead bytes and kHeadSeconds, messages
// kMostMessage bytes; there are at most kMostConnections at a time.
#pragma once
#include <memory>
#include <string>
#include <vector>

#include "common/clock.hpp"
#include "view/sockets.hpp"
#include "view/websocket.hpp"

namespace tool {

class ViewServer {
 public:
  static constexpr size_t kMostConnections = 32;
  static constexpr double kHeadSeconds = 5, kStuckSeconds = 20;

  // port 0: one that is free. Failure when it cannot be had.
  ViewServer(uint16_t port, std::string page);
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;
  std::string address() const;  // "http://127.0.0.1:41234/TOKEN/"

  struct Event {
    enum Kind { kOpened, kText, kClosed } kind;
    int window;  // a number of its own for each
    std::string text;
  };
  // What windows did; waits for it so long.
  std::vector<Event> wait(double seconds);
  size_t windows() const;
  bool ready(int window) const;  // all that it was sent has left
  void send_text(int window, const std::string& text) { send(window, kFrameText, text); }
  void send_bytes(int window, const std::string& bytes) { send(window, kFrameBytes, bytes); }

 private:
  struct Connection {
    int number = 0;
    Socket socket = kNoSocket;
    Clock::time_point since, moved;  // when it came, and when bytes last left
    std::string in, out;
    size_t sent = 0;  // of out
    WebsocketReader reader;
    bool window = false, ends = false, gone = false;  // ends: with the last byte of out
  };
  void send(int window, int kind, const std::string& payload);
  void read(Connection& c, std::vector<Event>* events);
  void read_messages(Connection& c, std::vector<Event>* events);
  void answer(Connection& c, std::vector<Event>* events);
  void flush(Connection& c);
  bool is_here(const std::string& host) const;

  uint16_t port_ = 0;
  int last_ = 0;
  std::string page_, token_;
  Socket listener_ = kNoSocket;
  std::vector<std::unique_ptr<Connection>> connections_;
};

}  // namespace tool
