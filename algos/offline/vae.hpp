// What a recorded action is like: a conditional variational autoencoder of actions (Kingma and Welling 2014; Sohn, Lee and
// Yan 2015).
//
//   encoder   (s, a) -> m, log std of a latent vector of 2 numbers for each entry of an action
//   decoder   (s, z) -> tanh: the action again, z = m + std e with e normal
//   loss      mean of (a' - a)^2 + 1/2 mean of KL(N(m, std) || N(0, 1)), over rows and entries
//
// An action that was not recorded has a latent vector far from N(0, 1): `distance` is that KL.
#pragma once
#include "algos/offline/side_net.hpp"

namespace rdm {

class ActionVae {
 public:
  // row_inputs: numbers of an observation. rows: of a call, at most.
  void carve(Arena& arena, const ResolvedAgentConfig& resolved, int32_t row_inputs, int32_t rows);
  void open(const ResolvedAgentConfig& resolved);

  // Adds to the gradient of the loss, or begins it; share: 1 / rows of the whole batch. x [rows][row_inputs + action_dim],
  // recorded.
  void gradient(const float* x, int32_t rows, double share, Stream& noise, bool begins);
  void step(double rate, double max_norm);
  double loss() const { return loss_; }  // since gradients began
  // KL of each row's latent vector to N(0, 1), a mean over its entries.
  void distance(const float* x, int32_t rows, float* out);
  // Actions [rows][action_dim] of latent vectors z [rows][latent()], at the observations of x.
  void decode(const float* x, const float* z, int32_t rows, float* action);
  int32_t latent() const { return latent_; }
  int64_t skipped() const { return encoder_.skipped + decoder_.skipped; }
  // Of action_encoder, then of action_decoder.
  static int32_t num_tensors(const ResolvedAgentConfig& resolved) {
    return 4 * resolved.reward_critic.num_layers();
  }
  bool tensor(int32_t index, char* name, TensorInfo* out) const;
  void visit(StateIo& io, double bound);

 private:
  void encode(const float* x, int32_t rows);
  SideNet encoder_, decoder_;
  int32_t row_inputs_ = 0, action_dim_ = 0, latent_ = 0;
  // [rows]: of the encoder, its gradient, what the decoder reads, gives, and their gradients
  float *code_ = nullptr, *dcode_ = nullptr, *input_ = nullptr, *action_ = nullptr, *daction_ = nullptr,
        *noise_ = nullptr, *dz_ = nullptr;
  double loss_ = 0;
};

}  // namespace rdm
