// Critics of a row and an action, in pairs: two of the reward, two of each limited cost, each with a slow copy that
// targets are made of (Fujimoto et al. 2018, "Addressing function approximation error in actor-critic methods").
//
//   reward   y = r + d  min over the two of Q'(s', a')     the smaller one, so that no error is climbed
//   cost     y = c + d  max over the two of Q'_c(s', a')   the larger one, so that no error hides a cost; at least 0
//   loss     1/B sum (Q - y)^2 of each, a network of its own with an Adam of its own
//   target   w' <- (1 - tau) w' + tau w  after each step
//
// With layer_norm hidden layers are normalised (nn/mlp.hpp), which keeps many steps a decision from diverging (Hiraoka
// et al. 2022, "Dropout Q-functions"; the dropout is left out).
//
// Networks are spread over the threads, each over all rows of a part, so no sum depends on the number of threads.
// Names of tensors: reward_q1.0.weight, cost0_q2.1.bias; 0 is the column of the cost.
#pragma once
#include "algos/core/batch_workers.hpp"
#include "algos/core/resolved_config.hpp"
#include "algos/core/state_io.hpp"
#include "algos/off_policy/replay.hpp"
#include "nn/adam.hpp"

namespace rdm {

// What checks of a state read: the numbers of a list that is being checked, and the bound on what a network may give.
struct StateNumbers {
  const StateView<float>& list;
  float operator[](size_t i) const { return list[i]; }
};
inline constexpr double kMaxQOutput = 1e18;

class QCritics {
 public:
  // Pairs: the reward's, then those of the limited costs.
  static int32_t num_pairs(const ResolvedAgentConfig& resolved) { return 1 + resolved.num_limited; }
  void carve(Arena& arena, const ResolvedAgentConfig& resolved, bool layer_norm);
  // Weights from the streams of networks 16 and on; targets are copies. workers must outlive it.
  void open(const ResolvedAgentConfig& resolved, BatchWorkers& workers);
  void restart_targets();

  int32_t pairs() const { return pairs_; }
  int32_t count() const { return 2 * pairs_; }  // networks; pair p has 2 p and 2 p + 1
  // Of a row: entries of the observation, then the action.
  int32_t row_inputs() const { return shape_.in - action_dim_; }
  int32_t inputs() const { return shape_.in; }
  // x [rows][inputs] of normalised observations obs [rows][obs_dim] and action [rows][action_dim].
  void gather(const float* obs, const float* action, int32_t rows, float* x) const;

  // For networks [first, last), rows <= kPartRows of x [rows][inputs]:
  // values of the slow copies, or of the networks, to out(net) [rows].
  void values(int32_t first, int32_t last, bool slow, const float* x, int32_t rows);
  // adds the gradient of scale (Q - y)^2 to the network's, or begins it; y(pair) [rows] are the targets.
  void gradients(int32_t first, int32_t last, const float* x, int32_t rows, float scale, bool begins);
  // adds the gradient of the sum of weight_i Q(s_i, a_i), with weight(net) [rows].
  void lift(int32_t first, int32_t last, const float* x, int32_t rows);
  // d(weight_i Q(s_i, a_i)) / d(a_i) to slopes(net) [rows][action_dim], of what `values` saw last; weight(net) [rows].
  void slopes(int32_t first, int32_t last, const float* x, int32_t rows);
  // A step of Adam along the gradients, and the slow copies follow by tau.
  void step(int32_t first, int32_t last, double rate, double max_norm, double tau);

  float* out(int32_t net) const { return out_ + static_cast<size_t>(net) * kPartRows; }
  float* y(int32_t pair) const { return y_ + static_cast<size_t>(pair) * kPartRows; }
  float* weight(int32_t net) const { return weight_ + static_cast<size_t>(net) * kPartRows; }
  const float* slopes(int32_t net) const {
    return slopes_ + static_cast<size_t>(net) * kPartRows * static_cast<size_t>(action_dim_);
  }
  // Sum of squared errors of a network since gradients began.
  double loss(int32_t net) const { return loss_[net]; }
  double sum(int32_t net) const { return sum_[net]; }  // of its values, likewise
  int64_t skipped() const { return skipped_; }
  const float* gradient(int32_t net) const { return grad_ + static_cast<size_t>(net) * step_; }

  int32_t num_tensors() const { return count() * 2 * shape_.num_layers(); }
  static int32_t num_tensors(const ResolvedAgentConfig& resolved);
  // name [kTensorNameSize].
  bool tensor(int32_t index, char* name, TensorInfo* out) const;
  void visit(StateIo& io);

 private:
  float* params(int32_t net) const { return params_ + static_cast<size_t>(net) * step_; }
  float* slow(int32_t net) const { return slow_ + static_cast<size_t>(net) * step_; }
  void add_gradient(int32_t net, const MlpScratch& scratch, const float* x, int32_t rows, const float* dq,
                    bool begins);
  template <class Body>
  void spread(int32_t first, int32_t last, Body&& body);

  const ResolvedAgentConfig* resolved_ = nullptr;
  BatchWorkers* workers_ = nullptr;
  MlpShape shape_;
  int32_t pairs_ = 0, action_dim_ = 0;
  const int32_t* columns_ = nullptr;  // [row_inputs()] of a row; null: all
  size_t step_ = 0;                   // floats from one network to the next
  // [networks][step_]
  float *params_ = nullptr, *slow_ = nullptr, *grad_ = nullptr, *part_ = nullptr;
  Adam* adam_ = nullptr;  // [networks]
  // [networks or pairs][kPartRows], slopes_ [..][action_dim]
  float *out_ = nullptr, *dout_ = nullptr, *weight_ = nullptr, *y_ = nullptr, *slopes_ = nullptr;
  double *loss_ = nullptr, *sum_ = nullptr, *norm_ = nullptr;
  MlpScratch* scratch_ = nullptr;  // [networks]
  int64_t skipped_ = 0;
};

}  // namespace rdm
