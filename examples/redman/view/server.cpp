#include "view/server.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "common/names.hpp"
#include "common/posix.hpp"
#include "common/report.hpp"
#include "common/text.hpp"
#include "view/http.hpp"

namespace tool {
namespace {

constexpr size_t kChunk = size_t{1} << 16;

std::string random_token() {
  unsigned char bytes[16];
  if (getentropy(bytes, sizeof bytes) != 0)
    throw Failure(std::string("cannot get random bytes for the page's address: ") + std::strerror(errno));
  std::string out;
  for (const unsigned char b : bytes) out += format("%02x", static_cast<unsigned>(b));
  return out;
}

// In a time that does not tell where they differ.
bool same_secret(const std::string& a, const std::string& b) {
  unsigned differs = a.size() != b.size();
  for (size_t i = 0; i < a.size() && i < b.size(); ++i)
    differs |= static_cast<unsigned>(static_cast<unsigned char>(a[i] ^ b[i]));
  return differs == 0;
}

// Whether one of the words between commas is this one.
bool has_word(const std::string& list, const std::string& word) {
  for (std::string each : cells_of(list, 16)) {
    each.erase(0, each.find_first_not_of(" \t"));
    each.erase(each.find_last_not_of(" \t") + 1);
    if (same_name(each, word)) return true;
  }
  return false;
}

}  // namespace

ViewServer::ViewServer(uint16_t port, std::string page) : page_(std::move(page)), token_(random_token()) {
  listener_ = listen_here(port, &port_);
}

ViewServer::~ViewServer() {
  for (const auto& c : connections_) close_socket(c->socket);
  close_socket(listener_);
}

std::string ViewServer::address() const {
  return "http://127.0.0.1:" + std::to_string(port_) + '/' + token_ + '/';
}

size_t ViewServer::windows() const {
  return static_cast<size_t>(std::count_if(connections_.begin(), connections_.end(),
                                           [](const auto& c) { return c->window && !c->gone && !c->ends; }));
}

bool ViewServer::ready(int window) const {
  for (const auto& c : connections_)
    if (c->number == window) return c->window && !c->gone && !c->ends && c->out.empty();
  return false;
}

void ViewServer::send(int window, int kind, const std::string& payload) {
  for (const auto& c : connections_) {
    if (c->number != window || !c->window || c->ends || c->gone) continue;
    if (c->out.empty()) c->moved = Clock::now();
    c->out += websocket_frame(kind, payload);
    flush(*c);
  }
}

void ViewServer::flush(Connection& c) {
  while (c.sent < c.out.size()) {
    const int64_t n = send_some(c.socket, c.out.data() + c.sent, c.out.size() - c.sent);
    if (n < 0) c.gone = true;
    if (n <= 0) return;
    c.sent += static_cast<size_t>(n);
    c.moved = Clock::now();
  }
  c.out.clear();
  c.sent = 0;
  if (c.ends) c.gone = true;
}

bool ViewServer::is_here(const std::string& host) const {
  const std::string port = ':' + std::to_string(port_);
  return host == "127.0.0.1" + port || host == "localhost" + port;
}

void ViewServer::answer(Connection& c, std::vector<Event>* events) {
  Request request;
  size_t used = 0;
  const Reading reading = read_request(c.in, &request, &used);
  if (reading == Reading::kMore) return;
  const auto end_with = [&](const std::string& text) {
    c.in.clear();
    c.ends = true;
    c.out = text;
    flush(c);
  };
  if (reading == Reading::kBad) return end_with(http_answer(400, "", ""));
  const std::string& origin = request.field("origin");
  const bool upgrades = same_name(request.field("upgrade"), "websocket");
  const bool ours = origin.empty() ? !upgrades : origin.rfind("http://", 0) == 0 && is_here(origin.substr(7));
  const std::string token = request.target.substr(1, request.target.find('/', 1) - 1);
  if (!is_here(request.field("host")) || !ours || !same_secret(token, token_))
    return end_with(http_answer(403, "", ""));
  const std::string rest = request.target.substr(1 + token.size());
  if (request.method != "GET") return end_with(http_answer(400, "", ""));
  if (rest == "/" && !upgrades) {
    const std::string socket = "ws://" + request.field("host");
    return end_with(http_answer(
        200, "text/html; charset=utf-8", page_,
        "default-src 'none'; script-src 'unsafe-inline'; style-src 'unsafe-inline'; img-src data: blob:; "
        "connect-src " +
            socket + "; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"));
  }
  if (rest != "/live" || !upgrades) return end_with(http_answer(404, "", ""));
  const std::string& key = request.field("sec-websocket-key");
  if (!has_word(request.field("connection"), "upgrade") || request.field("sec-websocket-version") != "13" ||
      !is_websocket_key(key))
    return end_with(http_answer(400, "", ""));
  c.window = true;
  c.out =
      "HTTP/1.1 101 Switching Protocols\r\nUpgrade: websocket\r\nConnection: "
      "Upgrade\r\nSec-WebSocket-Accept: " +
      websocket_accept(key) + "\r\n\r\n";
  events->push_back({Event::kOpened, c.number, ""});
  c.reader.add(c.in.data() + used, c.in.size() - used);
  c.in.clear();
  flush(c);
  read_messages(c, events);
}

void ViewServer::read_messages(Connection& c, std::vector<Event>* events) {
  WebsocketReader::Message m;
  while (!c.ends && c.reader.next(&m)) {
    if (m.kind == kFrameText) events->push_back({Event::kText, c.number, std::move(m.payload)});
    if (m.kind == kFramePing && c.out.size() < kChunk) c.out += websocket_frame(kFramePong, m.payload);
    if (m.kind == kFrameClose || m.kind == kFrameBytes) {
      c.ends = true;
      c.out += websocket_frame(kFrameClose, "");
    }
  }
  if (c.reader.broken()) c.gone = true;
  flush(c);
}

void ViewServer::read(Connection& c, std::vector<Event>* events) {
  char part[kChunk];
  const int64_t n = receive_some(c.socket, part, sizeof part);
  if (n < 0) c.gone = true;
  if (n <= 0 || c.ends) return;
  if (c.window) {
    c.reader.add(part, static_cast<size_t>(n));
    return read_messages(c, events);
  }
  c.in.append(part, static_cast<size_t>(n));
  answer(c, events);
}

std::vector<ViewServer::Event> ViewServer::wait(double seconds) {
  std::vector<Watched> watched = {{listener_}};
  for (const auto& c : connections_) watched.push_back({c->socket, !c->out.empty()});
  wait_for(watched, seconds);
  std::vector<Event> events;
  for (size_t i = 0; i < connections_.size(); ++i) {
    Connection& c = *connections_[i];
    if (watched[i + 1].writable) flush(c);
    if (watched[i + 1].readable) read(c, &events);
    if (!c.window && !c.ends && since(c.since) > kHeadSeconds) c.gone = true;
    if (!c.out.empty() && since(c.ends ? c.since : c.moved) > kStuckSeconds) c.gone = true;
  }
  for (Socket s; watched[0].readable && (s = accept_one(listener_)) != kNoSocket;) {
    if (connections_.size() == kMostConnections) {
      close_socket(s);
      continue;
    }
    auto c = std::make_unique<Connection>();
    c->number = ++last_;
    c->socket = s;
    c->since = c->moved = Clock::now();
    connections_.push_back(std::move(c));
  }
  for (const auto& c : connections_) {
    if (!c->gone) continue;
    close_socket(c->socket);
    if (c->window) events.push_back({Event::kClosed, c->number, ""});
  }
  connections_.erase(
      std::remove_if(connections_.begin(), connections_.end(), [](const auto& c) { return c->gone; }),
      connections_.end());
  return events;
}

}  // namespace tool
