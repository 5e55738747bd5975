// Whole files, read and replaced.
#pragma once
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tool {

bool file_exists(const std::string& path);  // a regular file
bool is_folder(const std::string& path);
// Of a file or folder that is not there: "; nearest is runs/a/policy.rdm" of the names beside it, "; there is no
// folder runs/a", or "" when no name is near.
std::string missing_file_hint(const std::string& path);
// Why it cannot be read: "no such file; nearest is ...", "it is not a regular file"; "" when it can be.
std::string why_no_file(const std::string& path);
// Failure when it cannot be read, is no regular file or is longer than `most` bytes.
std::string read_file(const std::string& path, size_t most = size_t{1} << 26);

// A file's new content, written beside it: nothing is lost until commit() syncs it and puts it in its place,
// in one move. Where a symbolic link stands, the file that it leads to is replaced; what is no regular file
// (a device, a FIFO, a folder) is refused. A kill leaves the old or the new content, and perhaps a temporary
// file "<name>.tmp-<process>-<random>", which the next writer of the same file sweeps.
class PreparedFile {
 public:
  explicit PreparedFile(const std::string& path);  // empty; Failure when it cannot be written
  PreparedFile(const std::string& path, const std::string& bytes);  // written and synced
  ~PreparedFile();
  PreparedFile(const PreparedFile&) = delete;
  PreparedFile& operator=(const PreparedFile&) = delete;
  void write(const void* bytes, size_t size);                      // at the end
  void write_at(uint64_t offset, const void* bytes, size_t size);  // over what was written
  uint64_t size() const { return size_; }
  void commit();

 private:
  [[noreturn]] void give_up(int error);
  void sync();
  std::string path_, target_, temporary_;
  int file_ = -1;
  uint64_t size_ = 0;
  bool synced_ = false;
};

// Bytes that wait on the disk of a file that is to be made; nobody else sees them, and they go with the
// process.
class ScratchFile {
 public:
  explicit ScratchFile(const std::string& beside);  // Failure when its folder cannot be written to
  ~ScratchFile();
  ScratchFile(const ScratchFile&) = delete;
  ScratchFile& operator=(const ScratchFile&) = delete;
  void write(const std::string& bytes);  // at the end
  void read(uint64_t offset, void* to, size_t size) const;
  uint64_t size() const { return size_; }

 private:
  std::string path_;
  int file_ = -1;
  uint64_t size_ = 0;
};

// A regular file, read in parts. Failure when it cannot be.
class OpenFile {
 public:
  explicit OpenFile(const std::string& path);
  ~OpenFile();
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  uint64_t size() const { return size_; }
  void read(uint64_t offset, void* to, size_t size) const;

 private:
  std::string path_;
  int file_ = -1;
  uint64_t size_ = 0;
};

// Its first bytes, or all of a shorter one.
std::string beginning_of(const std::string& path, size_t bytes);
// Failure when something stands at `path` that is no regular file, or a training's.
void check_replaceable(const std::string& path);
// A file by its flag: {"--out", path, ".npz .csv"}. Path "": none. The last are the endings that its name may have, "" all.
struct FileOfFlag {
  std::string flag, path, endings = "";
};
using FilesByFlag = std::vector<FileOfFlag>;
// Before the work, of all files that a command is to write: Usage where two are one file, one is a file that the command reads,
// or a name has another ending; Failure where the file could not be written. Nothing is left behind.
void check_outputs(const FilesByFlag& written, const FilesByFlag& read = {});
// Both steps at once.
void replace_file(const std::string& path, const std::string& bytes);

// What stands between a file's name and a temporary one's end, and whether `name` is that of a temporary file
// of `of`, whoever wrote it: the tool or the library.
inline constexpr const char* kTemporary = ".tmp-";
bool is_temporary(const std::string& name, const std::string& of);
// Removes the temporary files that killed writers of `path` have left. `alone`: nobody else can be writing
// it.
void sweep_temporaries(const std::string& path, bool alone);

}  // namespace tool
