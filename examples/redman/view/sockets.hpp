// Sockets of this machine alone, over those of POSIX or of Windows. None waits but wait_for.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

namespace tool {

using Socket = intptr_t;
inline constexpr Socket kNoSocket = -1;

// Listens at 127.0.0.1; port 0: one that is free. Failure when it cannot be had.
Socket listen_here(uint16_t port, uint16_t* got);
// kNoSocket: nobody is there.
Socket accept_one(Socket listener);
void close_socket(Socket socket);
// Bytes that were taken; 0: none can be now; -1: the other side has gone.
int64_t receive_some(Socket socket, char* to, size_t size);
int64_t send_some(Socket socket, const char* from, size_t size);

struct Watched {
  Socket socket = kNoSocket;
  bool sends = false;  // to be told too when it takes bytes
  bool readable = false, writable = false;
};
// Until one of them is ready, a signal came, or the time is over.
void wait_for(std::vector<Watched>& all, double seconds);

// Opens the address in the browser of the desktop; false: nothing that could was found.
bool open_browser(const char* address);

}  // namespace tool
