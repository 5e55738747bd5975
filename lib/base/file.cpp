#include "base/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstring>

#include "base/error.hpp"

namespace rdm {
namespace {

struct Descriptor {
  int fd;
  ~Descriptor() { close_now(); }
  int close_now() {
    const int r = fd >= 0 ? close(fd) : 0;
    fd = -1;
    return r;
  }
};

}  // namespace

Vector<unsigned char> read_file(const char* path) {
  Descriptor f{open(path, O_RDONLY | O_CLOEXEC)};
  if (f.fd < 0)
    fail(errno == ENOENT ? Code::kNotFound : Code::kIo, "%s: cannot open: %s", path, std::strerror(errno));
  struct stat st {};
  if (fstat(f.fd, &st) != 0 || !S_ISREG(st.st_mode)) fail(Code::kIo, "%s: not a regular file", path);
  Vector<unsigned char> out(static_cast<size_t>(st.st_size));
  size_t at = 0;
  while (at < out.size()) {
    const ssize_t n = read(f.fd, out.data() + at, out.size() - at);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) fail(Code::kIo, "%s: cannot read: %s", path, std::strerror(errno));
    if (n == 0) break;
    at += static_cast<size_t>(n);
  }
  out.resize(at);
  return out;
}

void write_file(const char* path, const void* data, size_t size) {
  char temporary[PATH_MAX];
  if (std::snprintf(temporary, sizeof temporary, "%s.tmp-%d", path, static_cast<int>(getpid())) >=
      static_cast<int>(sizeof temporary))
    fail(Code::kArgument, "path: longer than %d characters", PATH_MAX);
  Descriptor f{open(temporary, O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666)};
  if (f.fd < 0) fail(Code::kIo, "%s: cannot create: %s", temporary, std::strerror(errno));
  const auto give_up = [&](const char* what) {
    const int why = errno;
    unlink(temporary);
    fail(Code::kIo, "%s: cannot %s: %s", path, what, std::strerror(why));
  };
  const auto* p = static_cast<const unsigned char*>(data);
  for (size_t at = 0; at < size;) {
    const ssize_t n = write(f.fd, p + at, size - at);
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) give_up("write");
    at += static_cast<size_t>(n);
  }
  if (fsync(f.fd) != 0 && errno != EINVAL && errno != EROFS) give_up("sync");
  if (f.close_now() != 0) give_up("close");
  if (rename(temporary, path) != 0) give_up("rename");
  char folder[PATH_MAX];
  std::strncpy(folder, path, sizeof folder - 1);
  folder[sizeof folder - 1] = '\0';
  char* slash = std::strrchr(folder, '/');
  if (slash) *(slash == folder ? slash + 1 : slash) = '\0';
  const Descriptor d{open(slash ? folder : ".", O_RDONLY | O_DIRECTORY | O_CLOEXEC)};
  if (d.fd >= 0) fsync(d.fd);  // best effort: the rename itself is atomic
}

}  // namespace rdm
