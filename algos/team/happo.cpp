// HAPPO (Kuba et al. 2022, "Trust region policy optimisation in multi-agent reinforcement learning", algorithm 4): the
// groups of a team learn one after the other, in an order that is drawn in each epoch, and each takes into account
// what those before it have become.
//
//   max over theta_i of the mean of min(rho_i M A, clip(rho_i) M A),   M = product of rho_j of the groups before i
//
// M A is an estimate of the advantage of i's actions given the new policies of those before, so that the whole step
// improves the team's return as one step of a joint policy would (their lemma 1). A is the team's, standardised once.
// The critics learn in the first turn. With one group it is PPO, to the byte.
#include "algos/algo_registry.hpp"
#include "algos/core/groups.hpp"
#include "algos/first_order/ppo.hpp"
#include "algos/team/turns.hpp"

namespace rdm {
namespace {

struct HappoOptions : PpoOptions, GroupOptions {};
constexpr auto kHappoRows = option_rows<HappoOptions>(kPpoRows, kGroupRows);

class Happo : public Ppo {
 public:
  explicit Happo(ResolvedAgentConfig&& resolved) : Ppo(std::move(resolved)) {}

 protected:
  void opened() override { turns_.open(config().seed, nets()); }
  int32_t turns() const override { return turns_.count(); }
  Job begin_turn(int32_t turn) override {
    if (turn == 0) turns_.draw();
    nets().focus = turns_.group(turn);
    return turn == 0 ? Job() : learner().begin_weigh(whole_batch(), turns_.group(turn - 1), kAnyRatio);
  }
  void visit_state(StateIo& io) override {
    Ppo::visit_state(io);
    if (nets().num_groups) turns_.visit(io);
  }

 private:
  Turns turns_;
};

}  // namespace

constinit const AlgoRow kHappo =
    make_algo_row<Happo>("happo", "PPO of a team whose groups learn one after the other (Kuba et al. 2022)",
                         kHappoRows, Costs::kNone, nullptr, &kPpo);

}  // namespace rdm
