#include "view/history.hpp"

namespace tool {

size_t History::size_of(const Moment& m) {
  const Rows& r = m.rows;
  const size_t floats =
      r.reward.size() + r.episode_return.size() + r.cost.size() + r.episode_cost.size() + r.action.size();
  return sizeof m + m.state.size() + sizeof(float) * floats + sizeof(int32_t) * r.step.size() +
         r.ended.size() + r.success.size() + r.stepped_in.size();
}

void History::add(Moment moment) {
  bytes_ += size_of(moment);
  moments_.push_back(std::move(moment));
  for (; bytes_ > most_ && moments_.size() > 1; ++first_) {
    bytes_ -= size_of(moments_.front());
    moments_.pop_front();
  }
}

void History::drop_after(int64_t number) {
  for (; last() > number; moments_.pop_back()) bytes_ -= size_of(moments_.back());
}

void History::clear() {
  first_ = last() + 1;
  moments_.clear();
  bytes_ = 0;
}

}  // namespace tool
