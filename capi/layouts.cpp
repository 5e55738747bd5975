#include "capi/layouts.hpp"

#if RDM_WITH_SIM
namespace rdm::capi {
namespace {
std::mutex g_mutex;
Layout* g_first = nullptr;
}  // namespace

void Layout::list(uint64_t hash, const rdm_field* fields, int32_t count) {
  const std::lock_guard lock(g_mutex);
  hash_ = hash, fields_ = fields, count_ = count;
  next_ = g_first, link_ = &g_first;
  if (next_) next_->link_ = &next_;
  g_first = this;
}

void Layout::end() {
  const std::lock_guard lock(g_mutex);  // before link_, which the neighbours write
  if (!link_) return;
  *link_ = next_;
  if (next_) next_->link_ = link_;
  link_ = nullptr;
}

KnownLayout::KnownLayout(uint64_t hash) : lock_(g_mutex), layout_(g_first) {
  while (layout_ && layout_->hash_ != hash) layout_ = layout_->next_;
}

}  // namespace rdm::capi
#endif
