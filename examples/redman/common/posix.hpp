// The calls of POSIX that the tool makes, where the system has them; on Windows the same names over its own.
#pragma once
#if !defined(_WIN32)
#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>
#else
#include <fcntl.h>
#include <io.h>
#include <process.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdint>

// Files are bytes, no child gets them; there is nothing to wait for in opening one, and a link is followed.
inline constexpr int O_CLOEXEC = _O_BINARY | _O_NOINHERIT, O_NONBLOCK = 0, O_NOFOLLOW = 0;
inline constexpr int LOCK_EX = 1, LOCK_NB = 2;

// As POSIX says, but that they move the file's place: for files that one thread uses.
int64_t pread(int file, void* to, size_t size, int64_t offset);
int64_t pwrite(int file, const void* bytes, size_t size, int64_t offset);
int fsync(int file);
int flock(int file, int how);  // LOCK_EX | LOCK_NB alone
int getentropy(void* to, size_t size);
#endif

#include <string>

namespace tool {

bool process_is_gone(int pid);  // false where it cannot be told
// The folder with this process's lock on it, as a file that the system closes when the process ends, however
// it does; -1: it cannot be opened, errno says why (EWOULDBLOCK: another process has the lock). File systems
// that know no locks are taken as they are.
int lock_folder(const std::string& path);
// Whether that folder still stands at `path`.
bool is_same_folder(int lock, const std::string& path);
void sync_folder(const std::string& path);  // best effort
// A new file for reading and writing whose name is gone, or goes with it, beside `target`; -1: errno.
int open_nameless(const std::string& target, const std::string& name);
size_t resident_bytes();        // of this process
std::string path_of_program();  // "" where it cannot be told

}  // namespace tool
