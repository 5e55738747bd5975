// An imitation term that fades, beside any algorithm's loss of the policy (Rajeswaran et al. 2018, DAPG):
//
//   loss + w decay^k L,   k epochs since the actor began to learn, L as in regression.hpp with 1 / sigma^2
//
// L is of rows drawn anew for each minibatch, as many as it has, or as there are; a trust region draws once
// an epoch, and its line search sees the term too. Of an actor with a GRU paths are drawn (demo_memory.hpp), from what
// the policy that acted remembers before them, until there are as many rows. DAPG weighs the whole log-likelihood by the largest
// advantage; here advantages are standardised, and sigma is left to the algorithm: at deviations of a few
// hundredths the likelihood's pull on sigma would open it.
#pragma once
#include "algos/core/job.hpp"
#include "algos/imitation/regression.hpp"

namespace rdm {

class Imitation {
 public:
  void open(const ResolvedAgentConfig& resolved, const Regression& regression);

  // Copies the rows; rows 0: none. The mark tells recordings apart.
  void set(const DemoRows& demo, uint64_t mark, const HostHooks& hooks);
  bool has_rows() const { return demo_.rows > 0; }
  bool wanted() const { return resolved_->shared.imitation > 0; }

  // The weight of an epoch, `done` ones after the actor began to learn.
  void begin_epoch(int32_t done);
  // What the policy of this epoch remembers of the recording, before the first draw; none where nothing is needed.
  Job remember();
  bool active() const { return weight_ > 0 && rows_ > 0; }
  void draw(int32_t rows);  // for a batch of so many
  // Where it is active: the term, in term() when the job is done; unless grad is null its gradient is added to
  // the actor's block of grad.
  Job begin(float* grad);
  double term() const { return weight_ * fit_.loss(); }

  // Error(kFormat) for a state that was saved beside other rows.
  void visit(StateIo& io);

 private:
  bool advance(bool) { return regression_->advance(fit_); }
  bool advance_memory(bool) { return regression_->remember_on(demo_, group_); }

  const ResolvedAgentConfig* resolved_ = nullptr;
  const Regression* regression_ = nullptr;
  Vector<float> obs_, label_;
  Vector<int16_t> points_;
  Vector<uint8_t> classes_, colors_;
  Vector<int32_t> order_;  // [samples of an epoch]
  DemoMemory memory_;
  DemoRows demo_;
  uint64_t mark_ = 0;
  Stream stream_;
  double weight_ = 0;
  int32_t items_ = 0, rows_ = 0;  // drawn
  int32_t group_ = 0;             // of remember's chunks
  Fit fit_;
};

}  // namespace rdm
