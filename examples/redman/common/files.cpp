#include "common/files.hpp"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <optional>
#include <vector>

#include "common/names.hpp"
#include "common/ownership.hpp"
#include "common/posix.hpp"
#include "common/report.hpp"
#include "common/text.hpp"

namespace tool {
namespace fs = std::filesystem;
namespace {

// Where a write to `path` has to go: through symbolic links, dangling ones too.
std::string target_of(const std::string& path) {
  constexpr int kMostLinks = 40;
  fs::path at = path;
  std::error_code error;
  for (int i = 0; fs::is_symlink(fs::symlink_status(at, error)); ++i) {
    if (i == kMostLinks) throw Failure("cannot write " + path + ": too many symbolic links");
    const fs::path to = fs::read_symlink(at, error);
    if (error) throw Failure("cannot write " + path + ": " + error.message());
    at = to.is_absolute() ? to : at.parent_path() / to;
  }
  return at.string();
}

// The permissions of what is replaced; none where there is nothing.
std::optional<mode_t> check_target(const std::string& path, const std::string& target) {
  struct stat s {};
  if (stat(target.c_str(), &s) != 0) return {};
  if (!S_ISREG(s.st_mode)) throw Failure("cannot write " + path + ": it is not a regular file");
  // a rename asks for the right to change the folder alone
  if (access(target.c_str(), W_OK) != 0) throw Failure("cannot write " + path + ": " + std::strerror(errno));
  return s.st_mode & 0777;
}

uint64_t random_number() {
  uint64_t out = 0;
  if (getentropy(&out, sizeof out) != 0)
    throw Failure(std::string("cannot draw a random number: ") + std::strerror(errno));
  return out;
}

// 0, or what went wrong.
int write_all(int file, uint64_t offset, const void* bytes, size_t size) {
  for (size_t done = 0; done < size;) {
    const ssize_t n =
        pwrite(file, static_cast<const char*>(bytes) + done, size - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno != EINTR) return errno;
    if (n > 0) done += static_cast<size_t>(n);
  }
  return 0;
}

// Null, or what went wrong.
const char* read_all(int file, uint64_t offset, void* to, size_t size) {
  for (size_t done = 0; done < size;) {
    const ssize_t n =
        pread(file, static_cast<char*>(to) + done, size - done, static_cast<off_t>(offset + done));
    if (n < 0 && errno != EINTR) return std::strerror(errno);
    if (n == 0) return "it ends too early";
    if (n > 0) done += static_cast<size_t>(n);
  }
  return nullptr;
}

// A process of that number may live elsewhere, with a file system in common: it holds a lock on its file.
bool is_abandoned(const std::string& temporary, const char* process) {
  const long pid = std::strtol(process, nullptr, 10);
  if (pid <= 0 || pid > INT_MAX || !process_is_gone(static_cast<int>(pid))) return false;
  const int file = open(temporary.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC);
  if (file < 0) return false;
  const bool free = flock(file, LOCK_EX | LOCK_NB) == 0;
  close(file);
  return free;
}

}  // namespace

bool file_exists(const std::string& path) {
  std::error_code error;
  return fs::is_regular_file(path, error);
}

bool is_folder(const std::string& path) {
  std::error_code error;
  return fs::is_directory(path, error);
}

std::string missing_file_hint(const std::string& path) {
  constexpr size_t kMostNames = 500;
  const fs::path whole = path, folder = whole.parent_path();
  std::error_code error;
  if (!folder.empty() && !fs::is_directory(folder, error)) return "; there is no folder " + folder.string();
  std::vector<std::string> names;
  fs::directory_iterator at(folder.empty() ? "." : folder, error);
  for (; !error && at != fs::directory_iterator() && names.size() < kMostNames; at.increment(error))
    if (const std::string name = at->path().filename().string(); is_utf8(name)) names.push_back(name);
  std::sort(names.begin(), names.end());
  std::string hint = nearest_hint(whole.filename().string(), names);
  if (!hint.empty() && !folder.empty()) hint += " in " + folder.string();
  return hint;
}

std::string why_no_file(const std::string& path) {
  std::error_code error;
  if (fs::is_regular_file(path, error)) return "";
  if (fs::exists(path, error)) return "it is not a regular file";
  return "no such file" + missing_file_hint(path);
}

std::string read_file(const std::string& path, size_t most) {
  const int file = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);  // a FIFO is not waited for
  struct stat s {};
  std::string problem, bytes;
  if (file < 0 || fstat(file, &s) != 0)
    problem = std::strerror(errno) + (errno == ENOENT ? missing_file_hint(path) : std::string());
  else if (!S_ISREG(s.st_mode))
    problem = "it is not a regular file";
  else if (static_cast<uint64_t>(s.st_size) > most)
    problem = "it is longer than " + std::to_string(most) + " bytes";
  if (problem.empty()) {
    bytes.resize(static_cast<size_t>(s.st_size));
    size_t done = 0;
    while (done < bytes.size()) {
      const ssize_t n = read(file, bytes.data() + done, bytes.size() - done);
      if (n < 0 && errno == EINTR) continue;
      if (n < 0) problem = std::strerror(errno);
      if (n <= 0) break;
      done += static_cast<size_t>(n);
    }
    bytes.resize(done);
  }
  if (file >= 0) close(file);
  if (!problem.empty()) throw Failure("cannot read " + path + ": " + problem);
  return bytes;
}

PreparedFile::PreparedFile(const std::string& path) : path_(path), target_(target_of(path)) {
  const std::optional<mode_t> kept = check_target(path_, target_);
  sweep_temporaries(target_, false);
  do {
    temporary_ =
        target_ + kTemporary +
        format("%d-%016llx", static_cast<int>(getpid()), static_cast<unsigned long long>(random_number()));
    file_ =
        open(temporary_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, kept.value_or(0666));
  } while (file_ < 0 && errno == EEXIST);
  if (file_ < 0) give_up(errno);
#if !defined(_WIN32)
  if (kept) fchmod(file_, *kept);  // what the umask took
#endif
  flock(file_, LOCK_EX | LOCK_NB);  // best effort: says that the writer lives
}

PreparedFile::PreparedFile(const std::string& path, const std::string& bytes) : PreparedFile(path) {
  write(bytes.data(), bytes.size());
  sync();
}

PreparedFile::~PreparedFile() {
  if (file_ < 0) return;
  close(file_);
  unlink(temporary_.c_str());
}

void PreparedFile::write(const void* bytes, size_t size) {
  write_at(size_, bytes, size);
  size_ += size;
}

void PreparedFile::write_at(uint64_t offset, const void* bytes, size_t size) {
  synced_ = false;
  const int error = write_all(file_, offset, bytes, size);
  if (error) give_up(error);
}

void PreparedFile::sync() {
  if (!synced_ && fsync(file_) != 0) give_up(errno);
  synced_ = true;
}

void PreparedFile::commit() {
  sync();
  check_target(path_, target_);
#if defined(_WIN32)  // which does not rename what is open
  close(file_);
  file_ = -1;
#endif
  std::error_code error;
  fs::rename(temporary_, target_, error);
  if (error) give_up(error.value());
  if (file_ >= 0) close(file_);
  file_ = -1;
  sync_folder(fs::path(target_).parent_path().string());  // the rename itself is atomic
}

void PreparedFile::give_up(int error) {
  if (file_ >= 0) close(file_);
  if (!temporary_.empty()) unlink(temporary_.c_str());
  file_ = -1;
  throw Failure("cannot write " + path_ + ": " + std::strerror(error) +
                (error == ENOENT ? missing_file_hint(target_) : std::string()));
}

ScratchFile::ScratchFile(const std::string& beside) : path_(beside) {
  const std::string target = target_of(beside);
  const std::string name =
      target + kTemporary +
      format("%d-%016llx", static_cast<int>(getpid()), static_cast<unsigned long long>(random_number()));
  file_ = open_nameless(target, name);
  if (file_ < 0) throw Failure("cannot write " + path_ + ": " + std::strerror(errno));
}

ScratchFile::~ScratchFile() {
  close(file_);
}

void ScratchFile::write(const std::string& bytes) {
  const int error = write_all(file_, size_, bytes.data(), bytes.size());
  if (error) throw Failure("cannot write " + path_ + ": " + std::strerror(error));
  size_ += bytes.size();
}

void ScratchFile::read(uint64_t offset, void* to, size_t size) const {
  const char* problem = read_all(file_, offset, to, size);
  if (problem) throw Failure("cannot write " + path_ + ": " + problem);
}

OpenFile::OpenFile(const std::string& path) : path_(path) {
  file_ = open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);  // a FIFO is not waited for
  struct stat s {};
  const bool found = file_ >= 0 && fstat(file_, &s) == 0;
  if (found && S_ISREG(s.st_mode)) {
    size_ = static_cast<uint64_t>(s.st_size);
    return;
  }
  const std::string problem = found             ? "it is not a regular file"
                              : errno == ENOENT ? std::strerror(errno) + missing_file_hint(path)
                                                : std::strerror(errno);
  if (file_ >= 0) close(file_);
  throw Failure("cannot read " + path + ": " + problem);
}

OpenFile::~OpenFile() {
  close(file_);
}

void OpenFile::read(uint64_t offset, void* to, size_t size) const {
  const char* problem = read_all(file_, offset, to, size);
  if (problem) throw Failure("cannot read " + path_ + ": " + problem);
}

std::string beginning_of(const std::string& path, size_t bytes) {
  const OpenFile file(path);
  std::string out(std::min<uint64_t>(bytes, file.size()), '\0');
  if (!out.empty()) file.read(0, out.data(), out.size());
  return out;
}

void check_replaceable(const std::string& path) {
  check_target(path, path);
  if (is_run_file(target_of(path)))
    throw Failure("cannot write " + path + ": it is a file of a training run; give another name");
}

namespace {

// Of names that have one: those without are fine.
void check_ending(const FileOfFlag& file) {
  const std::string ending = fs::path(file.path).extension().string();
  if (ending.empty() || file.endings.empty()) return;
  const std::vector<std::string> known = words_of(file.endings, " ");
  for (const std::string& word : known)
    if (same_name(ending, word)) return;
  throw Usage(file.flag + ' ' + file.path + ": its name does not end in " + joined(known, " or "));
}

}  // namespace

void check_outputs(const FilesByFlag& written, const FilesByFlag& read) {
  FilesByFlag others = read;
  for (const FileOfFlag& file : written) {
    if (file.path.empty()) continue;
    check_replaceable(file.path);
    for (const FileOfFlag& other : others) {
      std::error_code error;
      if (!other.path.empty() &&
          (fs::path(file.path).lexically_normal() == fs::path(other.path).lexically_normal() ||
           fs::equivalent(file.path, other.path, error)))
        throw Usage(file.flag + ' ' + file.path + ": it is the file of " + other.flag +
                    "; give another name");
    }
    others.push_back(file);
  }
  for (const FileOfFlag& file : written)
    if (!file.path.empty()) check_ending(file);
  for (const FileOfFlag& file : written)
    if (!file.path.empty()) PreparedFile(file.path);  // goes again
}

void replace_file(const std::string& path, const std::string& bytes) {
  check_replaceable(path);
  PreparedFile file(path, bytes);
  file.commit();
}

bool is_temporary(const std::string& name, const std::string& of) {
  const std::string head = of + kTemporary;
  if (name.compare(0, head.size(), head) != 0) return false;
  const std::string tail = name.substr(head.size());  // "<process>-<16 digits>", of the library's the latter
  const size_t dash = tail.find('-'), random = dash == std::string::npos ? 0 : dash + 1;
  return tail.size() == random + 16 &&
         tail.find_first_not_of("0123456789abcdef", random) == std::string::npos &&
         (random == 0 || (dash > 0 && tail.find_first_not_of("0123456789") == dash));
}

void sweep_temporaries(const std::string& path, bool alone) {
  const fs::path whole = path;
  const std::string folder = whole.parent_path().string(), head = whole.filename().string() + kTemporary;
  std::error_code error;
  fs::directory_iterator at(folder.empty() ? "." : folder, error);
  for (; !error && at != fs::directory_iterator(); at.increment(error)) {
    const std::string name = at->path().filename().string();
    if (!is_temporary(name, whole.filename().string())) continue;
    const std::string file = at->path().string();
    if (!fs::is_regular_file(at->symlink_status(error))) continue;
    if (alone || is_abandoned(file, name.c_str() + head.size())) unlink(file.c_str());
  }
}

}  // namespace tool
