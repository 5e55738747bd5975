// Things by number. A number is never given twice; the row of what was removed goes with its last user, so
// the list is as long as what there is. Whoever has one locks it.
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

  explicit Numbered(const char* what, int32_t first = 0) : what_(what), next_(first) {}

  // Error(kMemory), Error(kRange) after 2^31 of them: nothing changes.
  int32_t add(T what) {
    if (next_ == std::numeric_limits<int32_t>::max())
      fail(Code::kRange, "all %d numbers were given in this process", next_);
    rows_.push_back({next_, 1, true, std::move(what)});
    return next_++;
  }
  int32_t given() const { return next_; }  // the first number that was not
  // Null for one that was removed and has no user, or was never given.
  Row* find(int32_t number) {
    const auto row = std::lower_bound(rows_.begin(), rows_.end(), number,
                                      [](const Row& r, int32_t n) { return r.number < n; });
    return row != rows_.end() && row->number == number ? &*row : nullptr;
  }
  // Error(kRange): the number was never given.
  void need(int32_t number) const {
    if (number < 0 || number >= next_) fail(Code::kRange, "%s: %d is outside [0, %d)", what_, number, next_);
  }
  // Error(kNotFound) too: it was removed, and has no user.
  Row& row(int32_t number) {
    need(number);
    Row* const found = find(number);
    if (!found) fail(Code::kNotFound, "%s %d was removed", what_, number);
    return *found;
  }
  // Error(kNotFound) for all that were removed.
  Row& listed(int32_t number) {
    Row& found = row(number);
    if (!found.listed) fail(Code::kNotFound, "%s %d was removed", what_, number);
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
  std::vector<Row> rows_;  // by number; the process's own memory, as no handle has it
  const char* what_;       // one of them, in texts
  int32_t next_;
};

}  // namespace rdm
