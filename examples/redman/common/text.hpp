// Text for people: printf into a string, and tables with aligned columns or in Markdown.
#pragma once
#include <string>
#include <vector>

namespace tool {

// printf into a string.
[[gnu::format(printf, 1, 2)]] std::string format(const char* pattern, ...);

// A number as short as it reads back to the same double: "40", "0.1".
std::string number_text(double value);

// An error or deviation in two digits, without any behind the point where it is large: "0.54", "120".
std::string error_text(double value);

// The text as a terminal may have it: control characters but '\n' and '\t' become '?', bytes that are no
// UTF-8 become U+FFFD.
std::string printable(const std::string& text);
bool is_utf8(const std::string& text);
// The same where HTML and SVG may have it, between tags and in quotes.
std::string html_text(const std::string& text);

// The cells of a line with commas between them, at most `most` and one more.
std::vector<std::string> cells_of(const std::string& line, size_t most);

// The words of a text with `between` between them: "a|b" has two.
std::vector<std::string> words_of(const std::string& text, const std::string& between);
// The other way round.
std::string joined(const std::vector<std::string>& words, const std::string& between);

// "1.2k", "3.5M": a count for progress lines and axes.
std::string short_count(double value);

class Table {
 public:
  explicit Table(std::vector<std::string> header) : header_(std::move(header)) {}
  void add(std::vector<std::string> row) { rows_.push_back(std::move(row)); }
  std::string text() const;      // aligned, two spaces between columns
  std::string markdown() const;  // "| a | b |" lines

 private:
  std::vector<std::string> header_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace tool
