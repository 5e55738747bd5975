#if defined(_WIN32)
#define _CRT_RAND_S
#include <windows.h>

#include "common/posix.hpp"
// after it
#include <psapi.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>

int64_t pread(int file, void* to, size_t size, int64_t offset) {
  if (_lseeki64(file, offset, SEEK_SET) < 0) return -1;
  return _read(file, to, static_cast<unsigned>(std::min<size_t>(size, 1u << 30)));
}

int64_t pwrite(int file, const void* bytes, size_t size, int64_t offset) {
  if (_lseeki64(file, offset, SEEK_SET) < 0) return -1;
  return _write(file, bytes, static_cast<unsigned>(std::min<size_t>(size, 1u << 30)));
}

int fsync(int file) {
  return _commit(file);
}

// Of one byte far beyond the end of any file: Windows keeps others from reading what is locked.
int flock(int file, int) {
  OVERLAPPED at{};
  at.OffsetHigh = 0x7fffffff;
  const auto handle = reinterpret_cast<HANDLE>(_get_osfhandle(file));
  if (LockFileEx(handle, LOCKFILE_EXCLUSIVE_LOCK | LOCKFILE_FAIL_IMMEDIATELY, 0, 1, 0, &at)) return 0;
  errno = EWOULDBLOCK;
  return -1;
}

int getentropy(void* to, size_t size) {
  for (size_t done = 0; done < size; done += sizeof(unsigned)) {
    unsigned bits = 0;
    if (rand_s(&bits) != 0) return -1;
    std::memcpy(static_cast<char*>(to) + done, &bits, std::min(size - done, sizeof bits));
  }
  return 0;
}

namespace tool {

bool process_is_gone(int pid) {
  const HANDLE process = OpenProcess(PROCESS_QUERY_LIMITED_INFORMATION, FALSE, static_cast<DWORD>(pid));
  if (!process) return GetLastError() == ERROR_INVALID_PARAMETER;
  DWORD code = 0;
  const bool gone = GetExitCodeProcess(process, &code) && code != STILL_ACTIVE;
  CloseHandle(process);
  return gone;
}

// A file in it that nobody else can open, and that goes with the process.
int lock_folder(const std::string& path) {
  if (!std::filesystem::is_directory(path)) {
    errno = ENOENT;
    return -1;
  }
  const std::wstring name = std::filesystem::path(path + "/.lock").wstring();
  const HANDLE lock = CreateFileW(name.c_str(), GENERIC_READ | GENERIC_WRITE, 0, nullptr, CREATE_ALWAYS,
                                  FILE_ATTRIBUTE_HIDDEN | FILE_FLAG_DELETE_ON_CLOSE, nullptr);
  if (lock == INVALID_HANDLE_VALUE) {
    errno = GetLastError() == ERROR_SHARING_VIOLATION ? EWOULDBLOCK : EACCES;
    return -1;
  }
  return _open_osfhandle(reinterpret_cast<intptr_t>(lock), _O_RDWR);
}

// What has an open file in it cannot be removed.
bool is_same_folder(int, const std::string& path) {
  return std::filesystem::is_directory(path);
}

void sync_folder(const std::string&) {}

int open_nameless(const std::string&, const std::string& name) {
  return open(name.c_str(), _O_RDWR | _O_CREAT | _O_EXCL | _O_TEMPORARY | O_CLOEXEC, 0600);
}

size_t resident_bytes() {
  PROCESS_MEMORY_COUNTERS memory{};
  return K32GetProcessMemoryInfo(GetCurrentProcess(), &memory, sizeof memory) ? memory.WorkingSetSize : 0;
}

std::string path_of_program() {
  wchar_t name[4096];
  const DWORD size = GetModuleFileNameW(nullptr, name, 4096);
  return size == 0 || size == 4096 ? "" : std::filesystem::path(name).string();
}

}  // namespace tool
#endif
