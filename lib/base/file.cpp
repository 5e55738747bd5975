#include "base/file.hpp"

#if !defined(_WIN32)  // there: file_windows.cpp
#include <dirent.h>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <ctime>
#include <optional>

#include "base/file_within.hpp"

namespace rdm {
namespace {

struct Descriptor {
  explicit Descriptor(int fd) : fd(fd) {}
  ~Descriptor() {
    if (fd >= 0) close(fd);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  const int fd;
};

// A write beyond the process's file-size limit raises SIGXFSZ, which ends it; for this thread and while this
// lives it is a failed write (EFBIG) alone. Nothing of the process changes, and a signal that waited before
// goes on waiting.
class NoSizeSignal {
 public:
  NoSizeSignal() {
    sigset_t waiting;
    sigemptyset(&size_);
    sigaddset(&size_, SIGXFSZ);
    sigemptyset(&waiting);
    sigpending(&waiting);
    ours_ = sigismember(&waiting, SIGXFSZ) == 0 && pthread_sigmask(SIG_BLOCK, &size_, &mask_) == 0;
  }
  ~NoSizeSignal() {
    if (!ours_) return;
    const int error = errno;
    sigset_t waiting;
    sigemptyset(&waiting);
    sigpending(&waiting);
    int signal;
    if (sigismember(&waiting, SIGXFSZ) == 1) sigwait(&size_, &signal);
    pthread_sigmask(SIG_SETMASK, &mask_, nullptr);
    errno = error;
  }
  NoSizeSignal(const NoSizeSignal&) = delete;
  NoSizeSignal& operator=(const NoSizeSignal&) = delete;

 private:
  sigset_t size_, mask_;
  bool ours_;
};

[[noreturn]] void too_long_path() {
  fail(Code::kArgument, "path: it is longer than %d characters", PATH_MAX);
}
[[noreturn]] void refuse(const char* path, const char* what, int why) {
  fail(Code::kIo, "%s: cannot %s: %s", path, what, std::strerror(why));
}

// The part of `path` before its last name, with the slash.
int folder_length(const char* path) {
  const char* slash = std::strrchr(path, '/');
  return slash ? static_cast<int>(slash + 1 - path) : 0;
}

// The file that `path` leads to through links, which need not exist, and its permissions if it does; Error(kIo) when it
// is there and not a regular file, or may not be written.
std::optional<mode_t> find_target(const char* path, char target[PATH_MAX]) {
  if (*path == '\0') fail(Code::kArgument, "path: it is empty");
  if (std::snprintf(target, PATH_MAX, "%s", path) >= PATH_MAX) too_long_path();
  for (int links = 0; links < 40; ++links) {
    struct stat st {};
    if (lstat(target, &st) != 0) {
      if (errno == ENOENT) return {};  // new; or its folder is missing, which shows when it is made
      refuse(path, "look at it", errno);
    }
    if (S_ISREG(st.st_mode)) {
      // a rename asks for the right to change the folder alone
      if (access(target, W_OK) != 0) refuse(path, "write", errno);
      return st.st_mode & 0777;
    }
    if (!S_ISLNK(st.st_mode))
      fail(Code::kIo, "%s: it is not a regular file; folders, devices and pipes are not replaced", path);
    char aim[PATH_MAX], next[PATH_MAX];
    const ssize_t n = readlink(target, aim, sizeof aim - 1);
    if (n < 0) refuse(path, "read the link", errno);
    aim[n] = '\0';
    const int folder = aim[0] == '/' ? 0 : folder_length(target);
    if (std::snprintf(next, sizeof next, "%.*s%s", folder, target, aim) >= PATH_MAX) too_long_path();
    std::strcpy(target, next);
  }
  refuse(path, "follow it", ELOOP);
}

constexpr const char* kMark = ".tmp-";
constexpr size_t kDigits = 16;

uint64_t unpredictable() {
  uint64_t bits;
  if (getentropy(&bits, sizeof bits) == 0) return bits;
  timespec now{};
  clock_gettime(CLOCK_REALTIME, &now);
  return static_cast<uint64_t>(now.tv_nsec) << 32 ^ static_cast<uint64_t>(now.tv_sec) << 16 ^
         static_cast<uint64_t>(getpid());
}

// Makes <target>.tmp-<hex> with permissions `mode` and locks it: a locked one is being written, wherever its writer runs, and one
// without a lock is litter.
int make_temporary(const char* target, mode_t mode, char temporary[PATH_MAX]) {
  for (int tries = 0; tries < 100; ++tries) {
    if (std::snprintf(temporary, PATH_MAX, "%s%s%016llx", target, kMark,
                      static_cast<unsigned long long>(unpredictable())) >= PATH_MAX)
      too_long_path();
    const int fd = open(temporary, O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, mode);
    if (fd < 0 && errno != EEXIST) return -1;
    if (fd < 0) continue;
    // a process that sweeps may have come between: then the lock or the name is lost
    struct stat st {};
    const bool locked = flock(fd, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK;
    if (locked && fstat(fd, &st) == 0 && st.st_nlink > 0) return fd;
    close(fd);
  }
  errno = EEXIST;
  return -1;
}

// Removes what writers of `target` left that were killed. Best effort.
void sweep(const char* target) {
  char folder[PATH_MAX], path[PATH_MAX];
  const int length = folder_length(target);
  std::snprintf(folder, sizeof folder, "%.*s", length, target);
  const char* name = target + length;
  const size_t named = std::strlen(name), marked = named + std::strlen(kMark);
  DIR* list = opendir(length ? folder : ".");
  if (!list) return;
  while (const dirent* entry = readdir(list)) {
    const char* other = entry->d_name;
    if (std::strncmp(other, name, named) != 0 || std::strncmp(other + named, kMark, marked - named) != 0 ||
        std::strspn(other + marked, "0123456789abcdef") != kDigits || other[marked + kDigits])
      continue;
    if (std::snprintf(path, sizeof path, "%s%s", folder, other) >= PATH_MAX) continue;
    const Descriptor file(open(path, O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC));
    struct stat st {};
    if (file.fd >= 0 && fstat(file.fd, &st) == 0 && S_ISREG(st.st_mode) &&
        flock(file.fd, LOCK_EX | LOCK_NB) == 0)
      unlink(path);
  }
  closedir(list);
}

}  // namespace

namespace {

// The one place where a file is opened to be read; its size.
int open_regular(const char* path, uint64_t* size) {
  // without O_NONBLOCK a pipe would wait for a writer
  const int fd = open(path, O_RDONLY | O_CLOEXEC | O_NONBLOCK | O_NOCTTY);
  if (fd < 0)
    fail(errno == ENOENT ? Code::kNotFound : Code::kIo, "%s: cannot open: %s", path, std::strerror(errno));
  struct stat st {};
  if (fstat(fd, &st) != 0 || !S_ISREG(st.st_mode)) {
    close(fd);
    fail(Code::kIo, "%s: it is not a regular file", path);
  }
  *size = static_cast<uint64_t>(st.st_size);
  return fd;
}

}  // namespace

FileSource::FileSource(const char* path) : path_(path), handle_(open_regular(path, &size_)) {}

FileSource::~FileSource() {
  close(static_cast<int>(handle_));
}

void FileSource::read(uint64_t at, void* to, size_t count) const {
  auto* out = static_cast<unsigned char*>(to);
  while (count > 0) {
    const ssize_t n = pread(static_cast<int>(handle_), out, count, static_cast<off_t>(at));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) refuse(path_, "read", errno);
    if (n == 0) fail(Code::kIo, "%s: the file became shorter while it was read", path_);
    out += n, at += static_cast<uint64_t>(n), count -= static_cast<size_t>(n);
  }
}

Vector<unsigned char> read_file(const char* path, const FileLimits& limits) {
  uint64_t size;
  const Descriptor f(open_regular(path, &size));
  const auto read_to = [&](unsigned char* out, size_t size) {
    size_t at = 0;
    while (at < size) {
      const ssize_t n = read(f.fd, out + at, size - at);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) refuse(path, "read", errno);
      if (n == 0) break;
      at += static_cast<size_t>(n);
    }
    return at;
  };
  return read_within(path, size, limits, read_to);
}

void write_file(const char* path, const void* data, size_t size) {
  char target[PATH_MAX], temporary[PATH_MAX];
  const std::optional<mode_t> kept = find_target(path, target);
  sweep(target);
  const Descriptor f(make_temporary(target, kept.value_or(0666), temporary));
  if (f.fd < 0) fail(Code::kIo, "%s: cannot create: %s", temporary, std::strerror(errno));
  const auto give_up = [&](const char* what) {
    const int why = errno;
    unlink(temporary);
    refuse(path, what, why);
  };
  // what the umask took; where that cannot be, fewer may read the new file than the old one
  if (kept) fchmod(f.fd, *kept);
  const auto* p = static_cast<const unsigned char*>(data);
  for (size_t at = 0; at < size;) {
    const NoSizeSignal quiet;
    const ssize_t n = write(f.fd, p + at, size - at);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) give_up("write");
    at += static_cast<size_t>(n);
  }
  if (fsync(f.fd) != 0 && errno != EINVAL && errno != EROFS) give_up("sync");
  if (rename(temporary, target) != 0) give_up("rename");
  char folder[PATH_MAX];
  std::snprintf(folder, sizeof folder, "%.*s", folder_length(target), target);
  const Descriptor d(open(folder[0] ? folder : ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC));
  if (d.fd >= 0) fsync(d.fd);  // best effort: the rename itself is atomic
}

}  // namespace rdm
#endif
