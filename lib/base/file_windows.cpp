// The same promises on Windows: paths are UTF-8, a file being written is open to nobody else, and a link is
// replaced like the file it is.
#include "base/file.hpp"

#if defined(_WIN32)
#define _CRT_RAND_S
#include <windows.h>

#include <climits>
#include <cstdlib>
#include <string>
#include <system_error>

#include "base/file_within.hpp"

namespace rdm {
namespace {

class Handle {
 public:
  explicit Handle(HANDLE h) : h_(h) {}
  ~Handle() { close(); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  HANDLE get() const { return h_; }
  bool open() const { return h_ != INVALID_HANDLE_VALUE; }
  void close() {
    if (open()) CloseHandle(h_);
    h_ = INVALID_HANDLE_VALUE;
  }

 private:
  HANDLE h_;
};

[[noreturn]] void refuse(const char* path, const char* what, DWORD why) {
  std::string text = std::system_category().message(static_cast<int>(why));
  while (!text.empty() && (text.back() < ' ' || text.back() == '.')) text.pop_back();
  const bool missing = why == ERROR_FILE_NOT_FOUND || why == ERROR_PATH_NOT_FOUND;
  fail(missing && std::strcmp(what, "open") == 0 ? Code::kNotFound : Code::kIo, "%s: cannot %s: %s", path,
       what, text.c_str());
}

std::wstring wide(const char* path) {
  const int size = MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, nullptr, 0);
  if (size < 1) fail(Code::kArgument, "path: it is not UTF-8");
  if (size > PATH_MAX) fail(Code::kArgument, "path: it is longer than %d characters", PATH_MAX);
  std::wstring out(static_cast<size_t>(size), L'\0');
  MultiByteToWideChar(CP_UTF8, MB_ERR_INVALID_CHARS, path, -1, out.data(), size);
  out.pop_back();
  return out;
}

// Error(kIo) for what is there and no file.
void need_file_or_nothing(const char* path, const std::wstring& name) {
  const DWORD attributes = GetFileAttributesW(name.c_str());
  if (attributes != INVALID_FILE_ATTRIBUTES &&
      (attributes & (FILE_ATTRIBUTE_DIRECTORY | FILE_ATTRIBUTE_DEVICE)))
    fail(Code::kIo, "%s: it is not a regular file; folders, devices and pipes are not replaced", path);
}

constexpr const wchar_t* kMark = L".tmp-";
constexpr size_t kDigits = 16;

std::wstring random_digits() {
  std::wstring out;
  for (size_t i = 0; i < kDigits; ++i) {
    unsigned bits = 0;
    rand_s(&bits);
    out += L"0123456789abcdef"[bits & 15];
  }
  return out;
}

// Removes what writers of `name` left that were killed: nobody has those open.
void sweep(const std::wstring& name) {
  const size_t slash = name.find_last_of(L"/\\");
  const std::wstring folder = slash == std::wstring::npos ? L"" : name.substr(0, slash + 1);
  const size_t marked = name.size() - folder.size() + std::wcslen(kMark);
  WIN32_FIND_DATAW entry;
  const HANDLE list = FindFirstFileW((name + kMark + L"*").c_str(), &entry);
  if (list == INVALID_HANDLE_VALUE) return;
  do {
    const std::wstring other = entry.cFileName;
    if (other.size() == marked + kDigits &&
        other.find_first_not_of(L"0123456789abcdef", marked) == std::wstring::npos)
      DeleteFileW((folder + other).c_str());
  } while (FindNextFileW(list, &entry));
  FindClose(list);
}

}  // namespace

namespace {

// The one place where a file is opened to be read; its size.
HANDLE open_regular(const char* path, uint64_t* size) {
  const std::wstring name = wide(path);
  const DWORD attributes = GetFileAttributesW(name.c_str());
  if (attributes != INVALID_FILE_ATTRIBUTES && (attributes & FILE_ATTRIBUTE_DIRECTORY))
    fail(Code::kIo, "%s: it is not a regular file", path);
  const HANDLE f =
      CreateFileW(name.c_str(), GENERIC_READ, FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE, nullptr,
                  OPEN_EXISTING, FILE_ATTRIBUTE_NORMAL, nullptr);
  if (f == INVALID_HANDLE_VALUE) refuse(path, "open", GetLastError());
  LARGE_INTEGER length;
  if (GetFileType(f) != FILE_TYPE_DISK || !GetFileSizeEx(f, &length)) {
    CloseHandle(f);
    fail(Code::kIo, "%s: it is not a regular file", path);
  }
  *size = static_cast<uint64_t>(length.QuadPart);
  return f;
}

}  // namespace

FileSource::FileSource(const char* path)
    : path_(path), handle_(reinterpret_cast<intptr_t>(open_regular(path, &size_))) {}

FileSource::~FileSource() {
  CloseHandle(reinterpret_cast<HANDLE>(handle_));
}

void FileSource::read(uint64_t at, void* to, size_t count) const {
  auto* out = static_cast<unsigned char*>(to);
  while (count > 0) {
    OVERLAPPED place{};
    place.Offset = static_cast<DWORD>(at), place.OffsetHigh = static_cast<DWORD>(at >> 32);
    DWORD n = 0;
    const auto most = static_cast<DWORD>(std::min<size_t>(count, size_t{1} << 30));
    if (!ReadFile(reinterpret_cast<HANDLE>(handle_), out, most, &n, &place) &&
        GetLastError() != ERROR_HANDLE_EOF)
      refuse(path_, "read", GetLastError());
    if (n == 0) fail(Code::kIo, "%s: the file became shorter while it was read", path_);
    out += n, at += n, count -= n;
  }
}

Vector<unsigned char> read_file(const char* path, const FileLimits& limits) {
  uint64_t size;
  Handle f(open_regular(path, &size));
  const auto read_to = [&](unsigned char* out, size_t wanted) {
    size_t at = 0;
    while (at < wanted) {
      DWORD n = 0;
      const auto most = static_cast<DWORD>(std::min<size_t>(wanted - at, size_t{1} << 30));
      if (!ReadFile(f.get(), out + at, most, &n, nullptr)) refuse(path, "read", GetLastError());
      if (n == 0) break;
      at += n;
    }
    return at;
  };
  return read_within(path, size, limits, read_to);
}

void write_file(const char* path, const void* data, size_t size) {
  if (*path == '\0') fail(Code::kArgument, "path: it is empty");
  const std::wstring name = wide(path);
  need_file_or_nothing(path, name);
  sweep(name);
  const std::wstring temporary = name + kMark + random_digits();
  Handle f(
      CreateFileW(temporary.c_str(), GENERIC_WRITE, 0, nullptr, CREATE_NEW, FILE_ATTRIBUTE_NORMAL, nullptr));
  if (!f.open()) refuse(path, "create", GetLastError());
  const auto give_up = [&](const char* what) {
    const DWORD why = GetLastError();
    f.close();
    DeleteFileW(temporary.c_str());
    refuse(path, what, why);
  };
  const auto* p = static_cast<const unsigned char*>(data);
  for (size_t at = 0; at < size;) {
    DWORD n = 0;
    const auto most = static_cast<DWORD>(std::min<size_t>(size - at, size_t{1} << 30));
    if (!WriteFile(f.get(), p + at, most, &n, nullptr)) give_up("write");
    at += n;
  }
  if (!FlushFileBuffers(f.get())) give_up("sync");
  f.close();
  if (!MoveFileExW(temporary.c_str(), name.c_str(), MOVEFILE_REPLACE_EXISTING | MOVEFILE_WRITE_THROUGH))
    give_up("rename");
}

}  // namespace rdm
#endif
