// Whole files: read one, or replace one so that a kill at any moment leaves the old or the new content.
#pragma once
#include <cstddef>

#include "base/host.hpp"

namespace rdm {

// Error(kNotFound) when there is none, Error(kIo) for any other failure.
Vector<unsigned char> read_file(const char* path);

// Writes path.tmp-<pid>, syncs, renames, syncs the folder. On Error(kIo) (full disk, no right) the old
// file is untouched and the temporary one is gone.
void write_file(const char* path, const void* data, size_t size);

}  // namespace rdm
