// What `train --from` is asked for.
#pragma once
#include <cstdint>
#include <string>

namespace tool {

// Everything that `train --from` was asked for; config.json keeps it.
struct TeachSettings {
  std::string from;            // demo, a .demo or .npz file, a policy file or a run folder; "": nothing
  int32_t decisions = 640;     // of each world, in a round
  double noise = 0.05;         // mean deviation of what is added to the teacher's actions
  bool success_only = false;   // rows of episodes without success are left out
  int32_t clone_epochs = 20;   // at most, in a round
  int32_t clone_patience = 0;  // epochs without a better validation loss that end it; 0: never
  double clone_rate = 1e-3;    // Adam's
  double validation = 0.1;     // share of rows held back
  int32_t dagger = 0;          // further rounds, in which the student acts too
  double beta = 0.5;           // the teacher's share of decisions in round k: beta^k
  double start_share = 0;      // of episodes that begin at a state of the recording, in the first epoch
  double start_share_end = 0;  // in the last
  bool asked() const { return !from.empty(); }
};

}  // namespace tool
