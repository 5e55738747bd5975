// The actor's learning rate from epoch to epoch: constant, falling linearly, or adapted to the KL.
#pragma once
#include "algos/core/shared_options.hpp"
#include "algos/core/state_io.hpp"

namespace rdm {

class RateSchedule {
 public:
  void open(const SharedOptions& options);  // which must outlive it
  void read_live();
  // Rate of the epoch that follows `done` finished ones.
  double rate(int32_t done) const;
  // The linear schedule's share of the rate at that time; 1 with others.
  double share(int32_t done) const;
  // rate() over learning_rate, whatever the schedule.
  double change(int32_t done) const { return base_ > 0 ? rate(done) / base_ : 1; }
  // After the epoch that followed `done` finished ones, with its KL(old || new), mean over all passes.
  void adapt(double kl, int32_t done);
  void visit(StateIo& io);

 private:
  const SharedOptions* o_ = nullptr;
  double base_ = 0, adapted_ = 0;
};

}  // namespace rdm
