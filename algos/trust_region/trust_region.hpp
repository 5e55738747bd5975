// Steps of the actor in a trust region (Schulman et al. 2015, section 6 and appendix C): gradients over the
// whole batch, natural gradients, line search.
//
//   max G'y (+ constraints)  subject to  y'H y / 2 <= delta,   H = F + damping I (fisher.hpp)
//   1. linearize   G of the gain, b of a cost; x = H^-1 G, p = H^-1 b by conjugate gradients
//   2. the algorithm solves the problem in the span of x, p (and b) and says how far along each: set_step
//   3. search      theta + f y, f = 1, decay, decay^2 ... until the true KL is within delta and the
//                  surrogates of the batch are as the algorithm wants them
//
// delta is trust_kl: 0.01 as in the papers' locomotion, 0.02 in preset=paper, but 0.15 in the defaults of
// throws, as measured on them. With lr_schedule=linear the radius shrinks as a learning rate would.
#pragma once
#include "algos/agent/learner.hpp"
#include "algos/trust_region/conjugate_gradient.hpp"
#include "algos/trust_region/fisher.hpp"
#include "base/cancel.hpp"

namespace rdm {

// Vectors are laid out as the actor's block of parameters.
class TrustRegion {
 public:
  // with_cost: also the two vectors of a cost gradient.
  void carve(Arena& arena, const ResolvedAgentConfig& resolved, const Networks& nets, bool with_cost);
  void open(CancelFlag& cancel, const ResolvedAgentConfig& resolved, const Rollout& rollout, Networks& nets,
            BatchWorkers& workers, Learner& learner);
  void read_live(const Options& options);

  // Gradients at the policy as it is over the listed rows: of the gain, by which all steps rise, and of
  // limited cost `cost` (< 0: none); then x = H^-1 G and p = H^-1 b.
  // share scales the region's radius.
  void linearize(const Batch& batch, int32_t cost, double share);
  // Scalars of the linearised problem: q = G'x, r = b'x, s = b'p, b'b.
  double q() const { return q_; }
  double r() const { return r_; }
  double s() const { return s_; }
  double bb() const { return bb_; }
  double delta() const { return delta_; }

  // step = along_x x + along_p p + along_b b.
  void set_step(double along_x, double along_p, double along_b);
  const float* step() const { return step_; }

  // Tries theta + f step for f = 1, decay, decay^2, ... until the KL is within delta, all is finite and
  // accept(before, after) holds; else theta stays as it was. Returns f, 0 for none.
  template <class Accept>
  double search(Accept&& accept) {
    save();
    const Surrogate before = measure();
    double f = 1;
    for (int32_t i = 0; i < tries_; ++i, f *= decay_) {
      move(f);
      const Surrogate after = measure();
      if (!after.finite() || after.kl / dims_ > delta_ || !accept(before, after)) continue;
      reached_ = after;
      return f;
    }
    restore();
    reached_ = before;
    return 0;
  }
  // What the last search left the policy at.
  const Surrogate& reached() const { return reached_; }

 private:
  void gradient_of(const PolicyLoss& loss, float sign, float* out);
  void solve(const float* b, float* x);
  void save();
  void restore();
  void move(double f);
  Surrogate measure();

  CancelFlag* cancel_ = nullptr;
  const ResolvedAgentConfig* resolved_ = nullptr;
  Networks* nets_ = nullptr;
  Learner* learner_ = nullptr;
  Fisher fisher_;
  CgWork cg_;
  CgOptions cg_options_;
  size_t size_ = 0;
  float *g_ = nullptr, *x_ = nullptr, *b_ = nullptr, *p_ = nullptr, *step_ = nullptr, *before_ = nullptr;
  Batch batch_;
  int32_t tries_ = 15;
  double q_ = 0, r_ = 0, s_ = 0, bb_ = 0, limit_ = 0.01, delta_ = 0.01, decay_ = 0.8, dims_ = 1;
  Surrogate reached_;
};

}  // namespace rdm
