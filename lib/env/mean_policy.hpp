// A frozen policy as a planner or a shield asks for it; a view of what somebody else owns.
#pragma once
#include <cmath>
#include <cstdint>

namespace rdm {

class MeanPolicy {
 public:
  // Mean actions [rows][action_dim] of obs [rows][obs_dim]; state [rows][state_dim()] is what it remembers of each
  // before the decision, and becomes what it remembers after it. It hangs on the observations alone, not on actions.
  virtual void act(const float* obs, int32_t rows, float* state, float* action) = 0;
  virtual int32_t state_dim() const = 0;  // 0: it has no memory, and state may be null
  virtual int32_t repeat() const = 0;     // control steps that it holds an action

 protected:
  ~MeanPolicy() = default;
};

// A network that overflows on an observation leaves no state that can be gone on from: the one before stays then.
inline bool sound_state(const float* state, int32_t dim) {
  bool good = true;
  for (int32_t j = 0; j < dim; ++j) good &= std::isfinite(state[j]);
  return good;
}

}  // namespace rdm
