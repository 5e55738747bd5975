// Which parts a row has, by the layout hash of a pool that lives: a policy is checked against numbers alone, and
// the text for another layout is to name the part that differs.
#pragma once
#include <mutex>

#include "redman/redman.h"

namespace rdm::capi {

// A pool's layout, in the list while the pool lives. Its fields outlive end().
class Layout {
 public:
  Layout() = default;
  Layout(const Layout&) = delete;
  Layout& operator=(const Layout&) = delete;
  void list(uint64_t hash, const rdm_field* fields, int32_t count);
  void end();  // also of one that is not listed

 private:
  friend class KnownLayout;
  uint64_t hash_ = 0;
  const rdm_field* fields_ = nullptr;  // [count_]
  int32_t count_ = 0;
  Layout *next_ = nullptr, **link_ = nullptr;  // link_: what points here
};

// The fields of some pool with that layout, of which none ends while this lives.
class KnownLayout {
 public:
  explicit KnownLayout(uint64_t hash);
  const rdm_field* fields() const { return layout_ ? layout_->fields_ : nullptr; }
  int32_t count() const { return layout_ ? layout_->count_ : 0; }

 private:
  std::lock_guard<std::mutex> lock_;
  const Layout* layout_;
};

}  // namespace rdm::capi
