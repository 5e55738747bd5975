// Counts calls of the C allocator in this process, those of the library and its engines included.
#pragma once
#include <cstdint>

namespace tool {

// malloc, calloc, realloc, posix_memalign, aligned_alloc, memalign since the process began; -1 in builds with
// a sanitizer, whose allocator is not to be taken from it.
int64_t allocation_count();

}  // namespace tool
