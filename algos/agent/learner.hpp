// The learning half of an agent: gradients of batches, cut into chunks and reduced in order, and Adam steps.
//
// Of a batch B of N rows the learner follows the gradient of
//
//   policy   1/N sum_B L(rho, A) - entropy H(pi) + the imitation term (imitation/imitation.hpp)
//   critics  1/N sum_B (V - target)^2 + l2 |w|^2
//
// with L the algorithm's (PolicyLoss), rho = pi(a|s) / pi_old(a|s), V of the reward or of a limited cost,
// each network with an Adam of its own (Kingma and Ba 2015) behind a bound on its gradient's norm, or one
// bound for all (joint_grad_norm). With value_clip the squared error is the larger one of V's and of V_old +
// clip(V - V_old, +-value_clip)'s, as PPO's first code had it; that is no part of the paper.
//
// The stages of gradient(): gather the chunk's observations, forward through the actor, loss and its
// derivatives by mean and log deviation, backward; the same for each critic; chunks' gradients added in
// order, blocks and ranks along their tree. measure() is the forward half alone: what the policy as it is now
// would gain, cost and how far it is from the one that acted, KL(old || now). The kl that an Epoch reports is
// summed in gradient(), so each minibatch's is of before its own step: 0 for one pass over one minibatch.
//
// By hand rather than by Eigen: every sum here runs in a fixed order whatever the processor's vectors and the
// number of threads, which Eigen's products and reductions do not promise; the matrix products are lib/nn's.
#pragma once
#include "algos/core/batch_workers.hpp"
#include "algos/core/networks.hpp"
#include "algos/rollout/rollout.hpp"

namespace rdm {

class Imitation;

// A chunk of a batch as a policy loss sees it. Row i of its means is mean_step i further on, of its
// deviations std_step i: 0 where one serves all.
struct PolicyChunk {
  const Rollout* rollout = nullptr;
  const int32_t* order = nullptr;  // [rows] rows of the rollout
  int32_t rows = 0;
  const float* mean = nullptr;     // [action_dim] of the policy that is learned
  const float* log_std = nullptr;  // [action_dim] of its innovation
  float scale = 1;                 // 1 / rows of the batch
  float* dmean = nullptr;          // out: scale d(loss)/d(mean) [action_dim]
  float* dlog_std = nullptr;       // added to: scale d(loss)/d(log_std) [action_dim]
  BatchSums* sums = nullptr;       // added to: loss, kl, clipped
  size_t mean_step = 0, std_step = 0;

  const float* mean_of(size_t i) const { return mean + i * mean_step; }
  const float* log_std_of(size_t i) const { return log_std + i * std_step; }
  float* dmean_of(size_t i) const { return dmean + i * mean_step; }
  float* dlog_std_of(size_t i) const { return dlog_std + i * std_step; }
};

class PolicyLoss {
 public:
  // Runs on any thread and must not throw.
  virtual void add(const PolicyChunk& chunk) const = 0;
  // The entropy bonus and the imitation term belong to this loss.
  virtual bool explores() const { return true; }

 protected:
  ~PolicyLoss() = default;
};

class Learner {
 public:
  void carve(Arena& arena, const ResolvedAgentConfig& resolved, size_t num_params);
  // All must outlive the learner.
  void open(const ResolvedAgentConfig& resolved, const Rollout& rollout, Networks& nets,
            BatchWorkers& workers);
  void read_live(const Options& options);

  // Gradients of mean loss over the listed rows: the policy's (null: none) less the entropy bonus, and, if
  // asked, the critics' squared errors with their L2 term. Valid until the next call.
  BatchSums gradient(const PolicyLoss* policy, bool critics, const Batch& batch);
  const float* gradient() const { return grad_; }
  // Adam steps along what the last gradient computed; actor_share: actor_rate over its first value, which the
  // critics may follow. A network whose gradient is not finite stays as it is.
  void step(double actor_rate, double actor_share = 1);

  // The policy's loss has this term too, where it is active; null: none.
  void imitate(const Imitation* term) { imitation_ = term; }
  double imitation() const;

  // Of the policy as it is now, over the listed rows. clip > 0: each sample's cost is
  // max(rho A_c, clip(rho, 1 - clip, 1 + clip) A_c), so that only a fall of the cost can be hidden.
  Surrogate measure(const Batch& batch, float clip = 0);
  double kl(const Batch& batch) { return measure(batch).kl; }
  // Steps that were left out so far.
  int64_t skipped() const { return skipped_; }
  void visit(StateIo& io);

 private:
  void refresh_log_std();
  // The policy at the outputs that a workspace holds; its derivatives go to the workspace's and to grad.
  PolicyChunk chunk_of(Workspace& workspace, const int32_t* order, int32_t rows, float* grad) const;
  void policy_gradient(Workspace& workspace, const PolicyLoss& policy, const int32_t* order, int32_t rows,
                       float* grad) const;
  double critic_gradient(Workspace& workspace, Networks::Index net, const int32_t* order, int32_t rows,
                         float* grad) const;
  void measure_rows(Workspace& workspace, const int32_t* order, int32_t rows, float clip) const;
  void add_penalties(const PolicyLoss* policy);
  double joint_scale(int32_t first, int32_t last) const;
  BatchSums sums_of_blocks();

  const ResolvedAgentConfig* resolved_ = nullptr;
  const Rollout* rollout_ = nullptr;
  Networks* nets_ = nullptr;
  BatchWorkers* workers_ = nullptr;
  float* grad_ = nullptr;                 // [Networks::size]
  float* log_std_ = nullptr;              // [action_dim] of the innovation; none with std_mode=state
  BatchSums* block_sums_ = nullptr;       // [this rank's blocks]
  Surrogate* block_surrogate_ = nullptr;  // likewise
  float scale_ = 1;                       // 1 / rows of the batch
  size_t begin_ = 0, end_ = 0;            // of grad_: what the last gradient covers
  bool policy_ = false, critics_ = false, learn_std_ = true, joint_norm_ = false, follow_actor_ = false;
  float value_clip_ = 0;
  double critic_rate_ = 0, entropy_ = 0, max_norm_ = 0, critic_l2_ = 0;
  int64_t skipped_ = 0;
  const Imitation* imitation_ = nullptr;
};

}  // namespace rdm
