// A TensorBoard event file: what progress.csv says, row for row, as scalars under the names of its columns.
#pragma once
#include <cstdint>
#include <string>

namespace tool {

// "events.out.tfevents.<unix seconds>.redman"; rows stand at that time and their Time/Total.
std::string event_file_name(int64_t unix_seconds);

// Records (TFRecord: length, masked CRC32C, bytes, masked CRC32C) with an Event of tensorboard's event.proto
// each. The file's first one, then one for a row of progress.csv: step TotalEnvSteps, no value for what is no
// number.
std::string event_head(int64_t unix_seconds);
std::string event_row(const std::string& header, const std::string& row, int64_t unix_seconds);
// Head and all rows of a progress.csv. The same text gives the same bytes, so a reader that follows the file
// stays in step when a run goes on from a checkpoint.
std::string event_bytes(const std::string& progress, int64_t unix_seconds);

// CRC-32C, Castagnoli.
uint32_t crc32c(const std::string& bytes);

}  // namespace tool
