#include "algos/imitation/demo_memory.hpp"

#include <algorithm>

#include "algos/core/by_episode.hpp"
#include "algos/imitation/regression.hpp"

namespace rdm {

void DemoMemory::open(const ResolvedAgentConfig& resolved, const DemoRows& demo) {
  if (!resolved.remembers() || demo.rows == 0) return;
  const auto rows = static_cast<size_t>(demo.rows);
  Vector<int32_t> last(static_cast<size_t>(demo.episodes()), -1);
  before_.assign(rows, -1);
  for (int32_t i = 0; i < demo.rows; ++i) {
    int32_t& previous = last[static_cast<size_t>(demo.episode_of(i))];
    before_[static_cast<size_t>(i)] = previous;
    previous = i;
  }
  if (resolved.gru.units == 0) return;
  cut(demo, resolved.memory_chunk());
  units_ = static_cast<size_t>(resolved.state_units());
  state_.assign(path_.size() * units_, 0);
}

void DemoMemory::cut(const DemoRows& demo, int32_t length) {
  row_.resize(before_.size());
  for (int32_t i = 0; i < demo.rows; ++i) row_[static_cast<size_t>(i)] = i;
  std::sort(row_.begin(), row_.end(), by_episode([&](int32_t i) { return demo.episode_of(i); }));
  for (int32_t at = 0; at < demo.rows; ++at) {
    const bool begins = before_[static_cast<size_t>(row_[static_cast<size_t>(at)])] < 0;
    if (begins) episode_.push_back(paths());
    if (begins || path_.back().rows == length) path_.push_back({at, 0});
    ++path_.back().rows;
  }
  episode_.push_back(paths());
}

void DemoMemory::attach(DemoRows& demo) {
  demo.before = before_.empty() ? nullptr : before_.data();
  demo.memory = path_.empty() ? nullptr : this;
}

}  // namespace rdm
