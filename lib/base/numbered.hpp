// Things by number. Numbers are given in turn: one comes again when all others were given since, so that one
// that was kept too long names nothing for as long as can be. The row of what was removed goes with its last
// user, so the list is as long as what there is. Whoever has one locks it.
#pragma once
#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "base/error.hpp"

namespace rdm {

template <class T>
class Numbered {
 public:
  struct Row {
    int32_t number;
    int32_t users;  // references, and one for the list
    bool listed;    // not removed
    T what;
  };

  // Numbers in [first, end).
  explicit Numbered(const char* what, int32_t first = 0, int32_t end = std::numeric_limits<int32_t>::max())
      : what_(what), first_(first), end_(end), next_(first), given_(first) {}

  // Error(kMemory), Error(kRange) where all numbers are in use: nothing changes.
  int32_t add(T what) {
    if (rows_.size() >= static_cast<size_t>(end_ - first_))
      fail(Code::kRange, "%s: all %d numbers are in use", what_, end_ - first_);
    int32_t number = next_;
    auto at = place(number);
    while (number == end_ || (at != rows_.end() && at->number == number)) {
      number = number == end_ ? first_ : number + 1;
      at = place(number);
    }
    rows_.insert(at, {number, 1, true, std::move(what)});
    next_ = number + 1;
    given_ = std::max(given_, next_);
    return number;
  }
  // One behind the last number that is listed, first where none is.
  int32_t count() const {
    for (auto row = rows_.rbegin(); row != rows_.rend(); ++row)
      if (row->listed) return row->number + 1;
    return first_;
  }
  // Null for one that was removed and has no user, or was never given.
  Row* find(int32_t number) {
    const auto row = place(number);
    return row != rows_.end() && row->number == number ? &*row : nullptr;
  }
  // Error(kRange): the number was never given.
  void need(int32_t number) const {
    if (number < 0 || number >= given_)
      fail(Code::kRange, "%s: %d is outside [0, %d)", what_, number, given_);
  }
  // Error(kNotFound) too: it was removed, and has no user.
  Row& row(int32_t number) {
    need(number);
    Row* const found = find(number);
    if (!found) fail(Code::kNotFound, "%s %d was destroyed", what_, number);
    return *found;
  }
  // Error(kNotFound) for all that were removed.
  Row& listed(int32_t number) {
    Row& found = row(number);
    if (!found.listed) fail(Code::kNotFound, "%s %d was destroyed", what_, number);
    return found;
  }
  // A user less; true: it was the last one, and *what is the caller's to end.
  bool release(int32_t number, T* what) {
    Row* const row = find(number);
    if (--row->users > 0) return false;
    *what = std::move(row->what);
    rows_.erase(rows_.begin() + (row - rows_.data()));
    return true;
  }
  auto begin() const { return rows_.begin(); }
  auto end() const { return rows_.end(); }

 private:
  auto place(int32_t number) {
    return std::lower_bound(rows_.begin(), rows_.end(), number,
                            [](const Row& r, int32_t n) { return r.number < n; });
  }

  std::vector<Row> rows_;  // by number; the process's own memory, as no handle has it
  const char* what_;       // one of them, in texts
  int32_t first_, end_;
  int32_t next_;   // that is looked at
  int32_t given_;  // behind all that were given
};

}  // namespace rdm
