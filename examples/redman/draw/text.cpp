#include "draw/text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>

namespace tool {

std::string format(const char* pattern, ...) {
  va_list args, again;
  va_start(args, pattern);
  va_copy(again, args);
  const int n = std::vsnprintf(nullptr, 0, pattern, args);
  va_end(args);
  std::string out(static_cast<size_t>(std::max(n, 0)), '\0');
  std::vsnprintf(out.data(), out.size() + 1, pattern, again);
  va_end(again);
  return out;
}

std::string number_text(double value) {
  for (int digits = 6; digits < 17; ++digits) {
    std::string s = format("%.*g", digits, value);
    if (std::strtod(s.c_str(), nullptr) == value) return s;
  }
  return format("%.17g", value);
}

std::string short_count(double value) {
  const double size = std::abs(value);
  if (size >= 1e6) return format("%.3gM", value / 1e6);
  if (size >= 1e3) return format("%.3gk", value / 1e3);
  return format("%.3g", value);
}

std::string Table::text() const {
  std::vector<size_t> width;
  for (const auto& h : header_) width.push_back(h.size());
  for (const auto& row : rows_)
    for (size_t i = 0; i < row.size(); ++i) width[i] = std::max(width[i], row[i].size());
  std::string out;
  const auto line = [&](const std::vector<std::string>& row) {
    std::string s;
    for (size_t i = 0; i < row.size(); ++i)
      s += row[i] + std::string(i + 1 < row.size() ? width[i] + 2 - row[i].size() : 0, ' ');
    out += s.substr(0, s.find_last_not_of(' ') + 1) + '\n';
  };
  line(header_);
  for (const auto& row : rows_) line(row);
  return out;
}

std::string Table::markdown() const {
  std::string out;
  const auto line = [&](const std::vector<std::string>& row) {
    for (const auto& cell : row) out += "| " + cell + ' ';
    out += "|\n";
  };
  line(header_);
  for (size_t i = 0; i < header_.size(); ++i) out += "|---";
  out += "|\n";
  for (const auto& row : rows_) line(row);
  return out;
}

}  // namespace tool
