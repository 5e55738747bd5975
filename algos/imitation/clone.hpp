// Behaviour cloning: the actor's mean is fitted to labels before it learns from rewards.
//
// Observations' statistics are those of the recording first (a clone that sees unscaled rows learns a tenth
// of it). Whole episodes are held back for validation, since neighbours in time are nearly the same row; with
// one episode single rows are. Adam on shuffled minibatches, its rate falling linearly from epoch to epoch;
// the weights with the least validation loss are kept. Same seed, same bytes, for any number of threads.
// An actor with a GRU learns minibatches of paths (demo_memory.hpp), which have batch_rows rows or a path more; what it
// remembers before each is found anew in each epoch. Of one episode paths are held back.
#pragma once
#include "algos/imitation/regression.hpp"
#include "algos/rollout/episodes.hpp"
#include "base/cancel.hpp"

namespace rdm {

// As rdm_clone_config.
struct CloneOptions {
  int32_t epochs = 30, batch_rows = 512, patience = 5;
  double learning_rate = 1e-3, learning_rate_end = 1e-5, validation = 0.1, action_std = 0;
  uint64_t seed = 0;
  bool feed_normalizer = true;
  int32_t capacity = 0;
  double *train_loss = nullptr, *validation_loss = nullptr;  // [capacity]
};

struct CloneReport {
  int32_t epochs = 0, best_epoch = 0;
  bool stopped = false;
  int32_t train_rows = 0, validation_rows = 0;
  double train_loss = 0, validation_loss = kNothing;
};

// All that it changes is the actor's block with its optimiser and the statistics; nothing when it throws.
// Error(kRange, kUnsupported, kArgument), kCancelled.
CloneReport clone_actor(const ResolvedAgentConfig& resolved, const DemoRows& demo, const CloneOptions& how,
                        const Regression& regression, Networks& nets, Normalizer& normalizer,
                        CancelFlag& cancel);

}  // namespace rdm
