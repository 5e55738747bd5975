// An encoder that learns to tell the points of clouds apart before anything is at stake.
//
// For each point a head sees what the last hidden layer makes of it and the features of its cloud, and gives
// log-odds of its label; cross-entropy, mean over points, by Adam. So the hidden layers learn where a point
// belongs and the features what the cloud is made of. The head is thrown away afterwards. Chunks are reduced
// in order, as everywhere (learner.hpp).
#pragma once
#include "algos/core/batch_workers.hpp"
#include "algos/rollout/episodes.hpp"
#include "base/cancel.hpp"

namespace rdm {

// As rdm_pretrain_config.
struct PretrainOptions {
  int32_t num_labels = 0, epochs = 20, batch_rows = 16;
  double learning_rate = 1e-3, validation = 0.1;
  uint64_t seed = 0;
};

struct PretrainReport {
  int32_t train_rows = 0, validation_rows = 0;
  double train_loss = 0, validation_loss = kNothing, accuracy = 0, most_common = 0;
};

// What is minimised, of the listed clouds, and its gradient: params [the encoder's, then the head's], grad
// likewise. For tests; takes memory from the hooks in force.
size_t segmentation_params(const PointNetShape& eyes, int32_t num_labels);
double segmentation_loss(const PointNetShape& eyes, const PointRows& clouds, const uint8_t* label,
                         int32_t num_labels, const int32_t* order, int32_t rows, BatchWorkers& workers,
                         const float* params, float* grad);

// clouds [rows] as points, label [rows][points]. All that it changes is the encoder with its optimiser;
// nothing when it throws. Error(kRange, kArgument), kCancelled.
PretrainReport pretrain_eyes(const ResolvedAgentConfig& resolved, const PointRows& clouds,
                             const uint8_t* label, int32_t rows, const PretrainOptions& how, Networks& nets,
                             BatchWorkers& workers, CancelFlag& cancel);

}  // namespace rdm
