#include "common/posix.hpp"

#if !defined(_WIN32)
#include <cerrno>
#include <csignal>
#include <filesystem>
#include <fstream>

namespace tool {
namespace {

std::string folder_of(const std::string& path) {
  const std::string folder = std::filesystem::path(path).parent_path().string();
  return folder.empty() ? "." : folder;
}

}  // namespace

bool process_is_gone(int pid) {
  return kill(pid, 0) != 0 && errno == ESRCH;
}

int lock_folder(const std::string& path) {
  const int folder = open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (folder < 0 || flock(folder, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK) return folder;
  close(folder);
  errno = EWOULDBLOCK;
  return -1;
}

bool is_same_folder(int lock, const std::string& path) {
  struct stat held {
  }, there{};
  return fstat(lock, &held) == 0 && stat(path.c_str(), &there) == 0 && held.st_ino == there.st_ino &&
         held.st_dev == there.st_dev;
}

void sync_folder(const std::string& path) {
  const int f = open(path.empty() ? "." : path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC);
  if (f < 0) return;
  fsync(f);
  close(f);
}

int open_nameless(const std::string& target, const std::string& name) {
#if defined(O_TMPFILE)
  if (const int f = open(folder_of(target).c_str(), O_RDWR | O_TMPFILE | O_CLOEXEC, 0600); f >= 0) return f;
#endif
  // a system or a file system without such files: one whose name goes at once
  const int f = open(name.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
  if (f >= 0) unlink(name.c_str());
  return f;
}

size_t resident_bytes() {
  std::ifstream in("/proc/self/statm");
  size_t total = 0, resident = 0;
  in >> total >> resident;
  return resident * static_cast<size_t>(sysconf(_SC_PAGESIZE));
}

std::string path_of_program() {
  std::error_code none;
  return std::filesystem::read_symlink("/proc/self/exe", none).string();
}

}  // namespace tool
#endif
