// A frozen policy as a planner or a shield asks for it; a view of what somebody else owns.
#pragma once
#include <cstdint>

namespace rdm {

class MeanPolicy {
 public:
  // Mean actions [rows][action_dim] of obs [rows][obs_dim].
  virtual void act(const float* obs, int32_t rows, float* action) = 0;
  virtual int32_t repeat() const = 0;  // control steps that it holds an action

 protected:
  ~MeanPolicy() = default;
};

}  // namespace rdm
