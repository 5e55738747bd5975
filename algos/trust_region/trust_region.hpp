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
#include "algos/core/option_tables.hpp"
#include "algos/first_order/ratio_loss.hpp"
#include "algos/trust_region/conjugate_gradient.hpp"
#include "algos/trust_region/fisher.hpp"

namespace rdm {

struct TrustOptions : CgOptions, FisherOptions {
  double trust_kl;
  int32_t line_search_steps;
  double line_search_decay;
};
inline constexpr auto kTrustRows = option_rows<TrustOptions>(
    row<&TrustOptions::trust_kl>(basic(
        number_option("trust_kl", 0.01, 1e-9, 1e3,
                      "bound of the KL divergence of one policy step; 0.01 to 0.02 in the papers", true))),
    row<&CgOptions::iterations>(integer_option("cg_iterations", 15, 1, 1000,
                                               "largest number of conjugate-gradient iterations", true)),
    row<&CgOptions::tolerance>(
        number_option("cg_tolerance", 1e-6, 0, 1,
                      "residual relative to the right-hand side at which conjugate gradients stop", true)),
    row<&FisherOptions::cg_damping>(
        number_option("cg_damping", 0.1, 0, 1e6, "amount added to the diagonal of the Fisher matrix", true)),
    row<&FisherOptions::fisher_stride>(legacy(integer_option(
        "fisher_stride", 1, 1, 1 << 20, "the Fisher matrix is computed from every n-th sample", true))),
    row<&TrustOptions::line_search_steps>(integer_option(
        "line_search_steps", 15, 1, 1000, "largest number of step lengths that the line search tries", true)),
    row<&TrustOptions::line_search_decay>(
        number_option("line_search_decay", 0.8, 0.01, 0.99,
                      "factor from one step length of the line search to the next", true)),
    row<&FisherOptions::kl_mean_over_dims>(
        legacy(flag_option("kl_mean_over_dims", false,
                           "average KL and Fisher matrix over action dimensions, as other implementations "
                           "do; false: sum them"))));

// Vectors are laid out as the actor's block of parameters.
class TrustRegion {
 public:
  // with_cost: also the two vectors of a cost gradient.
  void carve(Arena& arena, const ResolvedAgentConfig& resolved, const Networks& nets, bool with_cost);
  void open(const ResolvedAgentConfig& resolved, const Rollout& rollout, Networks& nets,
            BatchWorkers& workers, Learner& learner);
  void read_live(const Options& options);

  // Gradients at the policy as it is over the listed rows: of the gain, by which all steps rise, and of
  // limited cost `cost` (< 0: none); then x = H^-1 G and p = H^-1 b. Job after job until there is none.
  // share scales the region's radius.
  void begin_linearize(const Batch& batch, int32_t cost, double share);
  Job linearize_on();
  void linearize(const Batch& batch, int32_t cost, double share) {
    begin_linearize(batch, cost, share);
    while (Job job = linearize_on()) job.finish();
  }
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
  // accept(before, after) holds; else theta stays as it was. Job after job until there is none; then taken()
  // is f, 0 for none.
  Job begin_search();
  template <class Accept>
  Job search_on(Accept&& accept) {
    if (tried_ == 0)
      before_ = learner_->measured();
    else if (in_region() && accept(before_, learner_->measured()))
      return end_search(fraction_, learner_->measured());
    return next_try();
  }
  double taken() const { return taken_; }
  template <class Accept>
  double search(Accept&& accept) {
    for (Job job = begin_search(); job; job = search_on(accept)) job.finish();
    return taken_;
  }
  // What the last search left the policy at.
  const Surrogate& reached() const { return reached_; }

 private:
  // Of linearize: what comes next, or what a job has left.
  enum class Stage { kRows, kGain, kGainThere, kSolveGain, kProductThere, kCostThere, kSolveCost, kDone };

  Job begin_gradient(const PolicyLoss& loss);
  // The last gradient into out, conjugate gradients for it into x.
  void begin_solve(float sign, float* out, float* x);
  Job solve_on();
  void keep_base();
  const float* base() const;
  bool in_region() const;
  Job next_try();
  Job end_search(double taken, const Surrogate& reached);
  void move(double f);

  Networks* nets_ = nullptr;
  Learner* learner_ = nullptr;
  Fisher fisher_;
  CgWork cg_work_;
  TrustOptions options_{};
  ConjugateGradient cg_;
  size_t size_ = 0;
  float* base_ = nullptr;  // of a team
  float *g_ = nullptr, *x_ = nullptr, *b_ = nullptr, *p_ = nullptr, *step_ = nullptr;
  Batch batch_;
  Stage stage_ = Stage::kDone;
  GainLoss gain_;
  CostLoss cost_loss_{0};
  int32_t cost_ = -1, tried_ = 0;
  double q_ = 0, r_ = 0, s_ = 0, bb_ = 0, delta_ = 0.01;
  double fraction_ = 1, taken_ = 0;  // of the step: what is tried, what was taken
  Surrogate before_, reached_;
};

}  // namespace rdm
