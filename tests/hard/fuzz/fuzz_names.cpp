// Patterns of names: "pattern\nname", both as long as they like. What matches is compared with a table of all
// beginnings, and no pair takes more steps than its lengths multiplied: long runs of the pattern's own characters
// ('*', '?' and letters that are almost the name) are the seeds.
#include <chrono>

#include "base/names.hpp"
#include "fuzz.hpp"

namespace hard {
namespace {

constexpr size_t kMostCompared = 2000;  // letters of each side in the table

// Row by row: whether the pattern's first i characters match the name's first j.
bool expected(const std::string& pattern, const std::string& name) {
  std::vector<bool> row(name.size() + 1, false);
  row[0] = true;
  for (const char p : pattern) {
    std::vector<bool> next(name.size() + 1, false);
    next[0] = p == '*' && row[0];
    for (size_t j = 1; j <= name.size(); ++j)
      next[j] = p == '*' ? next[j - 1] || row[j]
                         : row[j - 1] && (p == '?' || rdm::fold_letter(p) == rdm::fold_letter(name[j - 1]));
    row = next;
  }
  return row.back();
}

Bytes seed(const std::string& pattern, const std::string& name) {
  return bytes_of(pattern + '\n' + name);
}
std::string times(size_t count, const std::string& text) {
  std::string out;
  for (size_t i = 0; i < count; ++i) out += text;
  return out;
}

}  // namespace

std::vector<Bytes> seeds() {
  const std::string stars(1000, '*'), letters(1000, 'a');
  return {seed("wrist*", "wrist_pitch"),
          seed(stars + '#', letters),
          seed(times(300, "*a"), letters),
          seed(times(300, "*a") + "*#", letters),
          seed(times(300, "*?"), letters),
          seed(times(300, "?*") + '#', letters),
          seed('*' + letters.substr(1) + 'b', letters + letters),
          seed(letters, letters),
          seed("", ""),
          seed("*", "")};
}
void whole(unsigned char*, size_t) {}
size_t fixed_bytes() {
  return 0;
}

void one(const unsigned char* data, size_t size) {
  std::string text(reinterpret_cast<const char*>(data), size);
  for (char& c : text)
    if (c == '\0') c = ' ';
  const size_t line = std::min(text.find('\n'), text.size());
  const std::string pattern = text.substr(0, line), name = line < text.size() ? text.substr(line + 1) : "";
  const auto begin = std::chrono::steady_clock::now();
  const bool matches = rdm::name_matches(pattern.c_str(), name.c_str());
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  const double steps = static_cast<double>(pattern.size() + 1) * static_cast<double>(name.size() + 1);
  HARD_REQUIRE(seconds < 1 + 1e-6 * steps, "%zu and %zu letters took %g s", pattern.size(), name.size(),
               seconds);
  if (pattern.size() <= kMostCompared && name.size() <= kMostCompared)
    HARD_REQUIRE(matches == expected(pattern, name), "%s: %s", pattern.c_str(), name.c_str());
  const char* names[] = {name.c_str(), "wrist_pitch"};
  (void)rdm::Nearest(pattern.c_str(), names, 2);
}

}  // namespace hard
