// The learning half of an agent: gradients of batches, cut into chunks and reduced in order, and Adam steps.
//
// Of a batch B of N rows the learner follows the gradient of
//
//   policy   1/N sum_B L(rho, A) - entropy H(pi) + the imitation term (imitation/imitation.hpp)
//   critics  1/N sum_B (V - target)^2 + l2 |w|^2
//   latent   1/N sum_B |z - mu|^2, of a student (option latent_from=history) in the place of both: z of its encoder, mu
//            of the teacher's, and nothing but its encoder learns
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
#include "algos/core/job.hpp"
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
  // Groups of the actor that learn, [first_part, last_part): each has a ratio of its own. One where all is one network.
  size_t first_part = 0, last_part = 1;

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
  // Whether it counts samples that its bound on the policy leaves out.
  virtual bool clips() const { return false; }

 protected:
  ~PolicyLoss() = default;
};

// Of a policy that stands still: how far it is from the one that acted.
class StillLoss final : public PolicyLoss {
 public:
  void add(const PolicyChunk& chunk) const override;
  bool explores() const override { return false; }
};

class Learner {
 public:
  void carve(Arena& arena, const ResolvedAgentConfig& resolved, size_t num_params);
  // All must outlive the learner.
  void open(const ResolvedAgentConfig& resolved, const Rollout& rollout, Networks& nets,
            BatchWorkers& workers);

  // Gradients of mean loss over the listed rows: the policy's (null: none) less the entropy bonus, and, if
  // asked, the critics' squared errors with their L2 term. When the job is done they are in gradient(), what
  // was summed beside them in sums(), both until the next job; the loss must live as long.
  Job begin_gradient(const PolicyLoss* policy, bool critics, const Batch& batch);
  const float* gradient() const { return grad_; }
  const BatchSums& sums() const { return sums_; }
  BatchSums gradient(const PolicyLoss* policy, bool critics, const Batch& batch) {
    begin_gradient(policy, critics, batch).finish();
    return sums_;
  }
  // Adam steps along what the last gradient computed; actor_share: actor_rate over its first value, which the
  // critics may follow. A network whose gradient is not finite stays as it is.
  void step(double actor_rate, double actor_share = 1);

  // The policy's loss has this term too, where it is active; null: none.
  void imitate(Imitation* term) { imitation_ = term; }

  // Of the policy as it is now, over the listed rows, in measured() when the job is done. clip > 0: each
  // sample's cost is max(rho A_c, clip(rho, 1 - clip, 1 + clip) A_c), so that only a fall of the cost can be
  // hidden. term: the gain is less the imitation term, as the gradient's loss has it.
  Job begin_measure(const Batch& batch, float clip = 0, bool term = false);
  const Surrogate& measured() const { return measured_; }
  Surrogate measure(const Batch& batch, float clip = 0) {
    begin_measure(batch, clip).finish();
    return measured_;
  }
  // Multiplies the advantages of the listed rows, those that the policy climbs and those of costs, by the probability
  // ratio of one group's actions: then others of the team learn from what they are worth beside its new policy. A ratio
  // is held within [1 / most, most].
  Job begin_weigh(const Batch& batch, int32_t group, double most);
  // What the actor gives for each of the listed rows, to row `order[i]` of out [samples][outputs of the actor].
  Job begin_outputs(const Batch& batch, float* out);
  double kl(const Batch& batch) { return measure(batch).kl; }
  // Steps that were left out so far.
  int64_t skipped() const { return skipped_; }
  void visit(StateIo& io);

 private:
  const SharedOptions& shared() const { return resolved_->shared; }
  void refresh_log_std();
  // The policy at the outputs that a workspace holds; its derivatives go to the workspace's and to grad.
  PolicyChunk chunk_of(Workspace& workspace, const int32_t* order, int32_t rows, float* grad) const;
  // What the policy as it is now gives for listed rows, to the workspace's out; and from its dout back to grad. With a
  // GRU through their sequences. The workspace's obs have the rows, stacked, without one.
  MemorySteps forward_policy(Workspace& workspace, const int32_t* order, int32_t rows) const;
  void backward_policy(Workspace& workspace, const MemorySteps& memory, const int32_t* order, int32_t rows,
                       float* grad) const;
  void policy_gradient(Workspace& workspace, const PolicyLoss& policy, const int32_t* order, int32_t rows,
                       float* grad) const;
  double critic_gradient(Workspace& workspace, Networks::Index net, const int32_t* order, int32_t rows,
                         float* grad) const;
  void measure_rows(Workspace& workspace, const int32_t* order, int32_t rows) const;
  bool advance_gradient(bool whole);
  bool advance_measure(bool whole);
  bool advance_weigh(bool whole);
  bool advance_outputs(bool whole);
  // Networks [first, last) of one chunk.
  void chunk_gradient(Workspace& workspace, const Chunk& chunk, int32_t first, int32_t last) const;
  void end_gradient();
  void end_measure();
  void add_penalties();
  void step_groups(int32_t net, double rate, double bound);
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
  // Of the last gradient or measure.
  Sweep sweep_;
  const PolicyLoss* policy_ = nullptr;
  bool critics_ = false;
  int32_t first_net_ = 0, last_net_ = 0, net_ = 0;  // those that take part; the next one of the group at hand
  size_t begin_ = 0, end_ = 0;                      // of grad_
  float scale_ = 1;                                 // 1 / rows of the batch
  float clip_ = 0;
  bool with_term_ = false;
  size_t weighed_ = 0;        // group
  double most_weight_ = 0;    // of its ratios
  float* outputs_ = nullptr;  // of begin_outputs
  Job term_;                  // behind the rows: the imitation term's
  BatchSums sums_;
  Surrogate measured_;

  int64_t skipped_ = 0;
  Imitation* imitation_ = nullptr;
};

}  // namespace rdm
