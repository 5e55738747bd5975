// Whole files, read and replaced.
#pragma once
#include <string>

namespace tool {

bool file_exists(const std::string& path);
bool is_folder(const std::string& path);
std::string read_file(const std::string& path);  // Failure when it cannot be read
// Writes a temporary file beside `path`, syncs it and renames it: a kill leaves the old or the new content.
void replace_file(const std::string& path, const std::string& bytes);

}  // namespace tool
