// Names that people type: compared without regard to case and '-' or '_', matched against patterns, and the
// nearest known ones for an error text. Header-only: the importers use it too.
#pragma once
#include <algorithm>
#include <climits>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "base/format.hpp"

namespace rdm {

inline char fold_letter(char c) {
  if (c == '-') return '_';
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

// Keys and names match without regard to case, and '-' equals '_'.
inline bool same_name(const char* a, const char* b) {
  for (; *a && *b; ++a, ++b)
    if (fold_letter(*a) != fold_letter(*b)) return false;
  return *a == *b;
}

// As same_name, where a '*' of the pattern stands for any letters or none and a '?' for one. At most
// |pattern| x |name| steps.
inline bool name_matches(const char* pattern, const char* name) {
  const char *star = nullptr, *from = nullptr;  // the last '*', and the name behind what it stands for
  while (*name) {
    if (*pattern == '*') {
      star = pattern++, from = name;
    } else if (*pattern && (*pattern == '?' || fold_letter(*pattern) == fold_letter(*name))) {
      ++pattern, ++name;
    } else if (star) {
      pattern = star + 1, name = ++from;
    } else {
      return false;
    }
  }
  while (*pattern == '*') ++pattern;
  return !*pattern;
}

inline constexpr int kUnlike = INT_MAX;
inline constexpr size_t kMostCompared = 64;  // letters of a name

inline size_t compared_length(const char* name) {
  size_t n = 0;
  while (n < kMostCompared && name[n]) ++n;
  return n;
}

// Letters to insert, remove, replace or swap with the next (Damerau 1964) between `word` and the whole of `known`,
// and in *begin between it and that beginning of `known` which differs least.
inline int edit_distance(const char* word, const char* known, int* begin) {
  const size_t n = compared_length(word), m = compared_length(known);
  int rows[3][kMostCompared + 1];  // of the word's letter, of the one before it, and of that before it
  int *row = rows[0], *last = rows[1], *older = rows[2];
  for (size_t j = 0; j <= m; ++j) row[j] = static_cast<int>(j);
  const auto same = [&](size_t i, size_t j) { return fold_letter(word[i - 1]) == fold_letter(known[j - 1]); };
  for (size_t i = 1; i <= n; ++i) {
    int* const free = older;
    older = last, last = row, row = free;
    row[0] = static_cast<int>(i);
    for (size_t j = 1; j <= m; ++j) {
      row[j] = std::min({last[j] + 1, row[j - 1] + 1, last[j - 1] + !same(i, j)});
      if (i > 1 && j > 1 && same(i, j - 1) && same(i - 1, j)) row[j] = std::min(row[j], older[j - 2] + 1);
    }
  }
  *begin = *std::min_element(row, row + m + 1);
  return row[m];
}

// How far a mistyped word is from a known name; kUnlike when nobody can have meant that. Least where the word is
// the name but for a slip, then where it is the beginning of the name, then of a part of it ("finger" of
// hand_over_safe_finger), then where the name is the beginning of the word.
inline int name_distance(const char* word, const char* known) {
  constexpr size_t kLeastPart = 3;  // letters
  const size_t n = compared_length(word), m = compared_length(known);
  int begin = 0, best = kUnlike;
  const int whole = edit_distance(word, known, &begin);
  if (3 * static_cast<size_t>(whole) <= std::max(n, m) + 2) best = 2 * whole;
  if (n < kLeastPart) return best;
  const auto near = [&](int slips) { return 4 * static_cast<size_t>(slips) <= n + 1; };
  if (near(begin)) best = std::min(best, 2 * begin + 1);
  for (const char* p = known; p != known + m; ++p) {
    if (!std::strchr("_-. :", *p) || !p[1]) continue;
    edit_distance(word, p + 1, &begin);
    if (near(begin)) best = std::min(best, 2 * begin + 2);
  }
  size_t same = 0;
  while (same < m && same < n && fold_letter(word[same]) == fold_letter(known[same])) ++same;
  if (same == m && m >= kLeastPart) best = std::min(best, 3 + static_cast<int>(n - m));
  return best;
}

// Index of the nearest name, the first of several; -1 when none is near.
inline int32_t nearest_name(const char* name, const char* const* names, int32_t count) {
  int32_t best = -1;
  int least = kUnlike;
  for (int32_t i = 0; i < count; ++i) {
    const int d = name_distance(name, names[i]);
    if (d < least) least = d, best = i;
  }
  return best;
}

// What an error text says of a name that is unknown: "; nearest is ppo_lag", "; nearest are a, b and c" of
// several that are equally near, "; nearest are a, b, c and 4 more", or "" when none is near.
struct Nearest {
  static constexpr int32_t kMostNamed = 3, kMostLookedAt = 500;  // a file may hold any number of names
  Nearest(const char* name, const char* const* names, int32_t count) {
    count = std::min(count, kMostLookedAt);
    int least = kUnlike;
    int32_t near = 0, named = 0;
    int32_t found[kMostLookedAt];
    for (int32_t i = 0; i < count; ++i) {
      const int d = name_distance(name, names[i]);
      if (d < least) least = d, near = 0;
      const auto same = [&](int32_t other) { return same_name(names[other], names[i]); };
      if (d == least && d != kUnlike && std::none_of(found, found + near, same)) found[near++] = i;
    }
    size_t at = 0;
    const auto add = [&](const char* before, const char* word) {
      at += static_cast<size_t>(print_text(text + at, sizeof text - at, "%s%.63s", before, word));
    };
    while (named < std::min(near, kMostNamed)) {
      const char* word = names[found[named++]];
      add(named == 1      ? (near == 1 ? "; nearest is " : "; nearest are ")
          : named == near ? " and "
                          : ", ",
          word);
    }
    if (near > named) print_text(text + at, sizeof text - at, " and %d more", static_cast<int>(near - named));
  }
  char text[kMostNamed * 66 + 48] = "";
};

}  // namespace rdm
