#include "shield/copies_tried.hpp"

#include <algorithm>

#include "env/copies.hpp"

namespace rdm {
namespace {

// Sums of costs are sums of small numbers: what rounds is not spent.
constexpr double kSlack = 1e-6;
constexpr uint32_t kLostStatus = kStatusDiverged | kStatusBadAction | kStatusTask;

}  // namespace

void CopiesTried::make(const Pool& of, int32_t count, int32_t threads, const HostHooks& hooks) {
  pool_ = make_copies(of, count, threads, hooks);
  count_ = count;
  costs_ = of.cost_dim();
}

void CopiesTried::carve(Arena& arena) {
  const auto n = static_cast<size_t>(count_);
  going_ = arena.make<uint8_t>(n);
  mask_ = arena.make<uint8_t>(n);
  fate_ = arena.make<Fate>(n);
  column_ = arena.make<int32_t>(n);
  ended_in_ = arena.make<int32_t>(n);
  bound_ = arena.make<double>(n * static_cast<size_t>(costs_));
}

void CopiesTried::end() {
  Pool::destroy(pool_);
  pool_ = nullptr;
}

void CopiesTried::start(int32_t i, const Pool& from, int32_t source, const double* bound) {
  pool_->copy(i, from, source);
  std::copy_n(bound, costs_, bound_ + row(i, costs_));
  going_[i] = 1;
  fate_[i] = Fate::kGoing;
  column_[i] = -1;
}

void CopiesTried::stop_all() {
  std::fill_n(going_, count_, uint8_t{0});
}

bool CopiesTried::any_going() const {
  return std::any_of(going_, going_ + count_, [](uint8_t x) { return x != 0; });
}

int64_t CopiesTried::step(int32_t steps, bool stop_at_cost) {
  std::copy_n(going_, count_, mask_);
  int64_t taken = 0;
  for (int32_t s = 0; s < steps; ++s) {
    pool_->step(mask_);
    bool more = false;
    for (int32_t i = 0; i < count_; ++i) {
      if (!mask_[i]) continue;
      taken += pool_->taken(i);
      look(i, stop_at_cost);
      mask_[i] = going_[i];
      more |= going_[i] != 0;
    }
    if (!more) break;
  }
  return taken;
}

void CopiesTried::look(int32_t i, bool stop_at_cost) {
  const Buffers& b = pool_->buffers();
  const double* bound = bound_ + row(i, costs_);
  for (int32_t k = 0; k < costs_ && column_[i] < 0; ++k)
    if (bound[k] >= 0 && pool_->spent(i, k) > bound[k] + kSlack) {
      column_[i] = k;
      ended_in_[i] = pool_->episode_step(i);
    }
  if (b.status[i] & kLostStatus)
    fate_[i] = Fate::kLost;
  else if (column_[i] >= 0 && stop_at_cost)
    fate_[i] = Fate::kCost;
  else if (b.terminated[i] || b.truncated[i])
    fate_[i] = Fate::kOver;
  else
    return;
  going_[i] = 0;
  if (column_[i] < 0) ended_in_[i] = pool_->episode_step(i);
}

double CopiesTried::excess(int32_t i) const {
  const double* bound = bound_ + row(i, costs_);
  double sum = 0;
  for (int32_t k = 0; k < costs_; ++k)
    if (bound[k] >= 0) sum += std::max(pool_->spent(i, k) - bound[k], 0.0);
  return sum;
}

}  // namespace rdm
