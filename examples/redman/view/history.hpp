// What the worlds were, step by step: exact states, as many of the last ones as fit into so many bytes.
#pragma once
#include <cstdint>
#include <deque>
#include <redman/redman.hpp>
#include <vector>

namespace tool {

class History {
 public:
  // What a step gave, of all worlds: rows that no state has.
  struct Rows {
    std::vector<float> reward, episode_return, cost, episode_cost, action;
    std::vector<int32_t> step;
    std::vector<uint8_t> ended, success, stepped_in;
  };
  struct Moment {
    redman::Bytes state;  // of all worlds
    Rows rows;
  };
  explicit History(size_t most_bytes) : most_(most_bytes) {}

  // Moments have numbers that go up by one; the newest always stays.
  int64_t first() const { return first_; }
  int64_t last() const { return first_ + static_cast<int64_t>(moments_.size()) - 1; }
  const Moment& at(int64_t number) const { return moments_[static_cast<size_t>(number - first_)]; }
  size_t bytes() const { return bytes_; }

  void add(Moment moment);
  void drop_after(int64_t number);
  void clear();  // numbers go on

 private:
  static size_t size_of(const Moment& m);
  size_t most_, bytes_ = 0;
  int64_t first_ = 0;
  std::deque<Moment> moments_;
};

}  // namespace tool
