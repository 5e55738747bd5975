#include "common/text.hpp"

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

std::string error_text(double value) {
  return format(std::abs(value) >= 99.5 ? "%.0f" : "%.2g", value);
}

std::string number_text(double value) {
  for (int digits = 6; digits < 17; ++digits) {
    std::string s = format("%.*g", digits, value);
    if (std::strtod(s.c_str(), nullptr) == value) return s;
  }
  return format("%.17g", value);
}

namespace {

// Length of the character that begins at s[i], 0 where none does: overlong forms, surrogates and what lies
// beyond U+10FFFF are none.
size_t character_size(const std::string& s, size_t i) {
  const auto byte = [&](size_t k) { return i + k < s.size() ? static_cast<unsigned char>(s[i + k]) : 0u; };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  const size_t size = first >= 0xc2 && first < 0xe0   ? 2
                      : first >= 0xe0 && first < 0xf0 ? 3
                      : first >= 0xf0 && first < 0xf5 ? 4
                                                      : 0;
  for (size_t k = 1; k < size; ++k)
    if ((byte(k) & 0xc0) != 0x80) return 0;
  if ((first == 0xe0 && byte(1) < 0xa0) || (first == 0xed && byte(1) >= 0xa0) ||
      (first == 0xf0 && byte(1) < 0x90) || (first == 0xf4 && byte(1) >= 0x90))
    return 0;
  return size;
}

bool is_control(const std::string& s, size_t i, size_t size) {
  const auto first = static_cast<unsigned char>(s[i]);
  if (size == 1) return (first < 0x20 && first != '\n' && first != '\t') || first == 0x7f;
  return size == 2 && first == 0xc2 && static_cast<unsigned char>(s[i + 1]) < 0xa0;  // U+0080 .. U+009F
}

}  // namespace

bool is_utf8(const std::string& text) {
  for (size_t i = 0, size = 0; i < text.size(); i += size)
    if ((size = character_size(text, i)) == 0) return false;
  return true;
}

std::string printable(const std::string& text) {
  std::string out;
  for (size_t i = 0; i < text.size();) {
    const size_t size = character_size(text, i);
    if (size == 0)
      out += "\xef\xbf\xbd";
    else if (is_control(text, i, size))
      out += '?';
    else
      out.append(text, i, size);
    i += std::max<size_t>(size, 1);
  }
  return out;
}

std::string html_text(const std::string& text) {
  std::string out;
  for (const char c : printable(text)) {
    if (c == '<')
      out += "&lt;";
    else if (c == '>')
      out += "&gt;";
    else if (c == '&')
      out += "&amp;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

std::vector<std::string> words_of(const std::string& text, const std::string& between) {
  std::vector<std::string> out;
  for (size_t at = 0, next = 0; at <= text.size(); at = next + between.size()) {
    next = std::min(text.find(between, at), text.size());
    out.push_back(text.substr(at, next - at));
  }
  return out;
}

std::string joined(const std::vector<std::string>& words, const std::string& between) {
  std::string out;
  for (size_t i = 0; i < words.size(); ++i) out += (i ? between : "") + words[i];
  return out;
}

std::string short_count(double value) {
  const double size = std::abs(value);
  if (size >= 1e6) return format("%.3gM", value / 1e6);
  if (size >= 1e3) return format("%.3gk", value / 1e3);
  return format("%.3g", value);
}

std::vector<std::string> cells_of(const std::string& line, size_t most) {
  std::vector<std::string> cells;
  for (size_t at = 0; at <= line.size() && cells.size() <= most;) {
    const size_t end = std::min(line.find(',', at), line.size());
    cells.push_back(line.substr(at, end - at));
    at = end + 1;
  }
  return cells;
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
    for (const auto& cell : row) {
      out += "| ";
      for (size_t i = 0; i < cell.size(); ++i) {
        if (cell[i] == '|' && (i == 0 || cell[i - 1] != '\\')) out += '\\';  // else it would end the cell
        out += cell[i];
      }
      out += ' ';
    }
    out += "|\n";
  };
  line(header_);
  for (size_t i = 0; i < header_.size(); ++i) out += "|---";
  out += "|\n";
  for (const auto& row : rows_) line(row);
  return out;
}

}  // namespace tool
