// CPO (Achiam et al. 2017): the trust region's step under a linearised cost limit (cpo_problem.hpp).
//
// c = J_c - limit in the units of the cost surrogate, a mean of rho A_c over decisions (option
// violation_scale: divided by an episode's decisions; the authors' code divides by an episode's length too).
// The line search wants KL <= delta, the cost surrogate to rise by at most max(-c, 0), and, unless the
// problem was a recovery, the reward's not to fall (the paper's section 6.1; 6.2 for the recovery). Of
// several limited costs each epoch follows the most violated one (several_costs=worst); the paper has one.
// Where a limit of 0 is kept (JudgedCosts::spotless) the step is TRPO's: c is 0 and b noise there, and a step
// along the plane b'y = 0 raises the cost surrogate by its curvature, so that no shorter one is accepted.
#pragma once
#include "algos/trust_region/trpo.hpp"

namespace rdm {

struct CpoOptions : TrpoOptions, ViolationOptions, OneCostOptions, WindowOptions {};
inline constexpr auto kCpoRows =
    option_rows<CpoOptions>(kTrpoRows, kViolationRows, kOneCostRows, kWindowRows);

class Cpo : public Trpo {
 public:
  explicit Cpo(ResolvedAgentConfig&& resolved) : Trpo(std::move(resolved)) {}

 protected:
  void begin_epoch(const JudgedCosts& costs, int32_t epoch) override;
  bool constrained() const override { return true; }
  int32_t followed_cost() const override { return free_ ? -1 : cost_; }
  void aim() override { keep_reward_ = solve(free_ ? 0 : c_ + added_); }
  bool accept(const Surrogate& before, const Surrogate& after) const override;
  double cost_weight(int32_t i) const override { return i == cost_ ? nu_ : 0; }
  void visit_state(StateIo& io) override;

  // Sets the region's step for the constraint value c = violation(); returns whether the reward must not
  // fall.
  virtual bool solve(double c);
  double nu_ = 0;
  double added_ = 0;  // to the cost surrogate in this epoch, before the step: by others of a team

 private:
  int32_t cost_ = 0;  // the limited cost that this epoch follows
  double c_ = 0;
  bool free_ = false;  // no limit can bind
  bool keep_reward_ = false;
};

}  // namespace rdm
