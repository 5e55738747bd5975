// MACPO (Gu et al. 2023, "Safe multi-agent reinforcement learning for multi-robot control"): the groups of a team
// take CPO's step one after the other, in an order that is drawn in each epoch.
//
//   max over theta_i of E[M rho_i A_r]   subject to   J_c + E[M rho_i A_c] <= d,   KL(old_i || new_i) <= delta,
//
// M the product of the probability ratios of the groups that have stepped before i. Each problem is solved as CPO's
// (trust_region/cpo_problem.hpp), on its own network alone: at i's turn its constraint value is J_c - d and what the
// groups before have added, E[M A_c].
//
// With option ratio_max each factor of M is held within [1/x, x], as importance weights are truncated elsewhere: the
// few rows whose ratios are far out no longer decide the surrogate, which is then biased by what they lose.
//
// Departures: one multiplier problem, exact, where the authors solve it with a first-order bound on delta as well;
// the line search measures the group's own KL. With one group it is CPO, to the byte.
#include "algos/algo_registry.hpp"
#include "algos/core/groups.hpp"
#include "algos/team/turns.hpp"
#include "algos/trust_region/cpo.hpp"

namespace rdm {
namespace {

struct MacpoOptions : CpoOptions, GroupOptions {
  double ratio_max;
};
constexpr auto kMacpoRows = option_rows<MacpoOptions>(
    kCpoRows, kGroupRows,
    row<&MacpoOptions::ratio_max>(number_option(
        "ratio_max", kAnyRatio, 1, kAnyRatio,
        "each group's ratio is held within [1/x, x] before it weighs the rows of the groups behind it",
        true)));

class Macpo : public Cpo {
 public:
  explicit Macpo(ResolvedAgentConfig&& resolved) : Cpo(std::move(resolved)) {}

 protected:
  void opened() override {
    Cpo::opened();
    turns_.open(config().seed, nets());
  }
  void read_live() override {
    Cpo::read_live();
    ratio_max_ = kMacpoRows.read(options()).ratio_max;
  }
  void begin_step() override {
    turn_ = 0;
    kl_ = 0;
    turns_.draw();
    nets().focus = turns_.group(0);
    begin_own_step();
  }
  Job step_on() override {
    switch (stage_) {
      case Stage::kStep:
        if (Job job = Cpo::step_on()) return job;
        kl_ += region().reached().kl;
        if (++turn_ == turns_.count()) {
          nets().focus = -1;
          stage_ = Stage::kOver;
          return {};
        }
        stage_ = Stage::kWeighed;
        return learner().begin_weigh(whole_batch(), turns_.group(turn_ - 1), ratio_max_);
      case Stage::kWeighed:
        nets().focus = turns_.group(turn_);
        stage_ = Stage::kMeasured;
        return learner().begin_measure(whole_batch());
      case Stage::kMeasured:
        added_ = followed_cost() < 0 ? 0 : learner().measured().cost[followed_cost()];
        begin_own_step();
        return step_on();
      case Stage::kOver:
        break;
    }
    return {};
  }
  void report(Learned& out) const override {
    Cpo::report(out);
    out.mean.kl = out.last_kl = kl_;
  }
  void visit_state(StateIo& io) override {
    Cpo::visit_state(io);
    if (nets().num_groups) turns_.visit(io);
  }

 private:
  // What comes next, or what a job has left.
  enum class Stage { kStep, kWeighed, kMeasured, kOver };
  void begin_own_step() {
    stage_ = Stage::kStep;
    Cpo::begin_step();
  }

  Turns turns_;
  Stage stage_ = Stage::kStep;
  int32_t turn_ = 0;
  double kl_ = 0;  // of all groups so far
  double ratio_max_ = 0;
};

}  // namespace

constinit const AlgoRow kMacpo =
    make_algo_row<Macpo>("macpo", "CPO of a team whose groups step one after the other (Gu et al. 2023)",
                         kMacpoRows, Costs::kOne, nullptr, &kCpo);

}  // namespace rdm
