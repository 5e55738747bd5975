// The order in which the groups of a team learn in one epoch, one after the other: drawn anew in each epoch, the same
// on all ranks.
#pragma once
#include <numeric>

#include "algos/core/networks.hpp"
#include "algos/core/state_io.hpp"
#include "base/shuffle.hpp"

namespace rdm {

inline constexpr double kAnyRatio = 1e9;  // as a bound of the ratios that weigh rows: none

class Turns {
 public:
  void open(uint64_t seed, const Networks& nets) {
    stream_ = Stream(seed, 0, Purpose::kTurns);
    count_ = nets.num_groups;
  }
  int32_t count() const { return std::max(count_, 1); }
  void draw() {
    std::iota(order_, order_ + count_, 0);
    shuffle(stream_, order_, count_);
  }
  // The group whose turn it is; -1: all is one.
  int32_t group(int32_t turn) const { return count_ > 0 ? order_[turn] : -1; }
  void visit(StateIo& io) {
    io.section("TURN");
    io.stream(stream_);
  }

 private:
  Stream stream_;
  int32_t count_ = 0;
  int32_t order_[kMaxGroups] = {};
};

}  // namespace rdm
