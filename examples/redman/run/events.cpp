#include "run/events.hpp"

#include <array>
#include <cmath>
#include <cstdlib>

#include "network/protobuf.hpp"
#include "run/progress.hpp"

namespace tool {
namespace {

constexpr double kMostSteps = 9007199254740992, kMostScalar = 3e38;
constexpr const char* kName = "events.out.tfevents.";

std::string little_endian(uint64_t value, int bytes) {
  std::string out;
  for (int i = 0; i < bytes; ++i) out += static_cast<char>(value >> 8 * i);
  return out;
}

std::string masked(const std::string& bytes) {
  const uint32_t crc = crc32c(bytes);
  return little_endian((crc >> 15 | crc << 17) + 0xa282ead8u, 4);
}

std::string record_of(const Message& event) {
  const std::string length = little_endian(event.bytes().size(), 8);
  return length + masked(length) + event.bytes() + masked(event.bytes());
}

}  // namespace

uint32_t crc32c(const std::string& bytes) {
  static const auto kTable = [] {
    std::array<uint32_t, 256> table{};
    for (uint32_t i = 0; i < 256; ++i) {
      table[i] = i;
      for (int k = 0; k < 8; ++k) table[i] = table[i] >> 1 ^ (table[i] & 1 ? 0x82f63b78u : 0);
    }
    return table;
  }();
  uint32_t crc = ~0u;
  for (const char c : bytes) crc = crc >> 8 ^ kTable[(crc ^ static_cast<unsigned char>(c)) & 255];
  return ~crc;
}

std::string event_file_name(int64_t unix_seconds) {
  return kName + std::to_string(unix_seconds) + ".redman";
}

std::string event_head(int64_t unix_seconds) {
  Message event;
  event.wide(1, static_cast<double>(unix_seconds));
  event.text(3, "brain.Event:2");
  return record_of(event);
}

std::string event_row(const std::string& header, const std::string& row, int64_t unix_seconds) {
  const std::string text = header + '\n' + row + '\n';
  const Columns columns = parse_progress(text.data(), text.size());
  const auto value = [&](const char* name) {
    const auto found = columns.find(name);
    return found == columns.end() || found->second.empty() ? std::nan("") : found->second[0];
  };
  const double steps = value("TotalEnvSteps");
  if (!(steps >= 0 && steps <= kMostSteps)) return "";
  Message summary;
  for (const auto& [name, cells] : columns) {
    if (name == "TotalEnvSteps" || name == "Train/TotalSteps" || !(std::abs(cells[0]) <= kMostScalar))
      continue;
    Message scalar;
    scalar.text(1, name);
    scalar.number(2, static_cast<float>(cells[0]));
    summary.message(1, scalar);
  }
  const double total = value("Time/Total");
  Message event;
  event.wide(1, static_cast<double>(unix_seconds) + (std::isnan(total) ? 0 : total));
  event.integer(2, static_cast<int64_t>(steps));
  event.message(5, summary);
  return record_of(event);
}

std::string event_bytes(const std::string& progress, int64_t unix_seconds) {
  std::string out = event_head(unix_seconds);
  const size_t first = progress.find('\n');
  if (first == std::string::npos) return out;
  const std::string header = progress.substr(0, first);
  for (size_t at = first + 1, end; (end = progress.find('\n', at)) != std::string::npos; at = end + 1)
    out += event_row(header, progress.substr(at, end - at), unix_seconds);
  return out;
}

}  // namespace tool
