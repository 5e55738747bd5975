#include "view/sockets.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <string>

#include "common/report.hpp"

#if defined(_WIN32)
#include <winsock2.h>
// after it
#include <shellapi.h>
#include <ws2tcpip.h>
#else
#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <spawn.h>
#include <sys/socket.h>
#include <unistd.h>

#include <csignal>

extern char** environ;
#endif

namespace tool {
namespace {

#if defined(_WIN32)
SOCKET handle(Socket s) {
  return static_cast<SOCKET>(s);
}
bool would_wait() {
  return WSAGetLastError() == WSAEWOULDBLOCK;
}
std::string reason() {
  return "error " + std::to_string(WSAGetLastError());
}
bool begin() {
  WSADATA data;
  return WSAStartup(MAKEWORD(2, 2), &data) == 0;
}
bool unblock(Socket s) {
  u_long on = 1;
  return ioctlsocket(handle(s), FIONBIO, &on) == 0;
}
using Length = int;
using Flags = const char*;
constexpr int kQuiet = 0;
#else
int handle(Socket s) {
  return static_cast<int>(s);
}
bool would_wait() {
  return errno == EAGAIN || errno == EWOULDBLOCK || errno == EINTR;
}
std::string reason() {
  return std::strerror(errno);
}
bool begin() {
  return true;
}
bool unblock(Socket s) {
  const int f = handle(s);
  return fcntl(f, F_SETFL, O_NONBLOCK) == 0 && fcntl(f, F_SETFD, FD_CLOEXEC) == 0;
}
using Length = size_t;
using Flags = const void*;
#if defined(MSG_NOSIGNAL)
constexpr int kQuiet = MSG_NOSIGNAL;
#else
constexpr int kQuiet = 0;
#endif
#endif

bool turn_on(Socket s, int level, int option) {
  const int on = 1;
  return setsockopt(handle(s), level, option, reinterpret_cast<Flags>(&on), sizeof on) == 0;
}

}  // namespace

Socket listen_here(uint16_t port, uint16_t* got) {
  const auto fail = [&](Socket s) -> Socket {
    const std::string why = reason();
    if (s != kNoSocket) close_socket(s);
    throw Failure("cannot listen at 127.0.0.1, port " + std::to_string(port) + ": " + why);
  };
  if (!begin()) return fail(kNoSocket);
  const auto s = static_cast<Socket>(socket(AF_INET, SOCK_STREAM, 0));
  if (s == kNoSocket) return fail(s);
#if !defined(_WIN32)  // where it would let another program in
  turn_on(s, SOL_SOCKET, SO_REUSEADDR);
#endif
  sockaddr_in at{};
  at.sin_family = AF_INET;
  at.sin_port = htons(port);
  at.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof at;
  auto* address = reinterpret_cast<sockaddr*>(&at);
  if (!unblock(s) || bind(handle(s), address, size) != 0 || listen(handle(s), 16) != 0 ||
      getsockname(handle(s), address, &size) != 0)
    return fail(s);
  *got = ntohs(at.sin_port);
  return s;
}

Socket accept_one(Socket listener) {
  const auto s = static_cast<Socket>(accept(handle(listener), nullptr, nullptr));
  if (s == kNoSocket) return s;
  turn_on(s, IPPROTO_TCP, TCP_NODELAY);
#if defined(SO_NOSIGPIPE)
  turn_on(s, SOL_SOCKET, SO_NOSIGPIPE);
#endif
  if (unblock(s)) return s;
  close_socket(s);
  return kNoSocket;
}

void close_socket(Socket s) {
#if defined(_WIN32)
  closesocket(handle(s));
#else
  close(handle(s));
#endif
}

int64_t receive_some(Socket s, char* to, size_t size) {
  const auto n = static_cast<int64_t>(recv(handle(s), to, static_cast<Length>(size), 0));
  return n > 0 ? n : n < 0 && would_wait() ? 0 : -1;
}

int64_t send_some(Socket s, const char* from, size_t size) {
  const auto n = static_cast<int64_t>(
      send(handle(s), from, static_cast<Length>(std::min<size_t>(size, 1u << 20)), kQuiet));
  return n >= 0 ? n : would_wait() ? 0 : -1;
}

void wait_for(std::vector<Watched>& all, double seconds) {
  std::vector<pollfd> polled;
  for (const Watched& w : all) {
    pollfd p{};
    p.fd = handle(w.socket);
    p.events = static_cast<short>(POLLIN | (w.sends ? POLLOUT : 0));
    polled.push_back(p);
  }
  const int ms = static_cast<int>(std::ceil(1000 * std::clamp(seconds, 0.0, 10.0)));
#if defined(_WIN32)
  const int ready = WSAPoll(polled.data(), static_cast<ULONG>(polled.size()), ms);
#else
  const int ready = poll(polled.data(), static_cast<nfds_t>(polled.size()), ms);
#endif
  for (size_t i = 0; i < all.size(); ++i) {
    const int events = ready > 0 ? polled[i].revents : 0;
    all[i].readable = events & (POLLIN | POLLHUP | POLLERR | POLLNVAL);
    all[i].writable = events & POLLOUT;
  }
}

bool open_browser(const char* address) {
#if defined(_WIN32)
  return reinterpret_cast<intptr_t>(
             ShellExecuteA(nullptr, "open", address, nullptr, nullptr, SW_SHOWNORMAL)) > 32;
#else
#if defined(__APPLE__)
  const char* program = "open";
#else
  const char* program = "xdg-open";
#endif
  std::string name = program, what = address;
  char* words[] = {name.data(), what.data(), nullptr};
  posix_spawn_file_actions_t quiet;
  posix_spawn_file_actions_init(&quiet);
  posix_spawn_file_actions_addopen(&quiet, 1, "/dev/null", O_WRONLY, 0);
  posix_spawn_file_actions_addopen(&quiet, 2, "/dev/null", O_WRONLY, 0);
  pid_t child = 0;
  const bool good = posix_spawnp(&child, program, &quiet, nullptr, words, environ) == 0;
  posix_spawn_file_actions_destroy(&quiet);
  return good;
#endif
}

}  // namespace tool
