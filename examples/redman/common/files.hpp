// Whole files, read and replaced.
#pragma once
#include <cstddef>
#include <string>

namespace tool {

bool file_exists(const std::string& path);  // a regular file
bool is_folder(const std::string& path);
// Failure when it cannot be read, is no regular file or is longer than `most` bytes.
std::string read_file(const std::string& path, size_t most = size_t{1} << 28);

// A file's new content, written and synced beside it: nothing is lost until commit() puts it in its place, in
// one move. Where a symbolic link stands, the file that it leads to is replaced; what is no regular file (a
// device, a FIFO, a folder) is refused. A kill leaves the old or the new content, and perhaps a temporary
// file
// "<name>.tmp-<process>-<random>", which the next writer of the same file sweeps.
class PreparedFile {
 public:
  PreparedFile(const std::string& path, const std::string& bytes);  // Failure when it cannot be written
  ~PreparedFile();
  PreparedFile(const PreparedFile&) = delete;
  PreparedFile& operator=(const PreparedFile&) = delete;
  void commit();

 private:
  [[noreturn]] void give_up(int error);
  std::string path_, target_, temporary_;
  int file_ = -1;
};

// Failure when something stands at `path` that is no regular file.
void check_replaceable(const std::string& path);
// Both steps at once.
void replace_file(const std::string& path, const std::string& bytes);

// Removes the temporary files that killed writers of `path` have left. `alone`: nobody else can be writing
// it.
void sweep_temporaries(const std::string& path, bool alone);

}  // namespace tool
