// Learning through a memory (option memory): a horizon is cut into paths of memory_chunk decisions of one
// environment, sequences, of each of which the state before its first decision was kept. Gradients flow back from the
// rows of a list to the begin of their sequences and not further (truncated back-propagation through time), and not
// over a decision before which the memory was cleared.
//
// A list may hold any rows whose sequences stand together, each in the order of time. Decisions of a sequence that
// are not listed, such as invalid ones, are run through and have no loss; those behind its last listed one are not
// looked at. So a list that is cut within a sequence gives the same sum of gradients, for some more work.
#pragma once
#include "algos/core/batch_workers.hpp"
#include "algos/rollout/rollout.hpp"

namespace rdm {

// The sequences of n listed rows, every stride-th of the list, in the workspace: their observations in obs
// [steps][count][seen_dim].
MemorySteps gather_sequences(const Rollout& r, const int32_t* order, int32_t n, Workspace& workspace,
                             int32_t stride = 1);
// What the actor gave for the listed rows, from all steps' outputs to out [n][width]; and back, zeros elsewhere.
void take_outputs(const SequenceSpace& s, int32_t n, size_t width, float* out);
void give_gradients(const SequenceSpace& s, int32_t n, size_t width, const float* dout);

// Lists the valid rows of environments [first, first + count) sequence by sequence, from entry `at` of order on;
// returns their number. With a stream the sequences are shuffled before.
int32_t list_sequences(const Rollout& r, int32_t first, int32_t count, int32_t at, Stream* shuffled);
// Sequences in the order of time, as list_sequences then shuffles them.
void restart_sequences(const Rollout& r, int32_t first, int32_t count);

}  // namespace rdm
