#include "algos/offline/vae.hpp"

#include <algorithm>
#include <cmath>

#include "algos/off_policy/replay.hpp"
#include "base/elementary.hpp"
#include "nn/kernels.hpp"
#include "nn/squash.hpp"

namespace rdm {
namespace {

constexpr uint32_t kEncoderStream = 64, kDecoderStream = 65;  // of initial weights, behind those of critics
constexpr float kLeastLogStd = -4, kMostLogStd = 4;

float clamped(float log_std) {
  return std::clamp(log_std, kLeastLogStd, kMostLogStd);
}

}  // namespace

void ActionVae::carve(Arena& arena, const ResolvedAgentConfig& resolved, int32_t row_inputs, int32_t rows) {
  row_inputs_ = row_inputs;
  action_dim_ = resolved.config.action_dim;
  latent_ = 2 * action_dim_;
  MlpShape shape = resolved.reward_critic;
  shape.in = row_inputs_ + action_dim_, shape.out = 2 * latent_;
  encoder_.carve(arena, shape, rows);
  shape.in = row_inputs_ + latent_, shape.out = action_dim_;
  decoder_.carve(arena, shape, rows);
  const size_t n = count_of(rows);
  for (float** code : {&code_, &dcode_}) *code = arena.make<float>(n * count_of(2 * latent_));
  input_ = arena.make<float>(n * count_of(decoder_.shape.in));
  for (float** a : {&action_, &daction_}) *a = arena.make<float>(n * count_of(action_dim_));
  for (float** z : {&noise_, &dz_}) *z = arena.make<float>(n * count_of(latent_));
}

void ActionVae::open(const ResolvedAgentConfig& resolved) {
  encoder_.open(resolved.config.seed, kEncoderStream, 1);
  decoder_.open(resolved.config.seed, kDecoderStream, 1);
}

void ActionVae::encode(const float* x, int32_t rows) {
  encoder_.forward(x, rows, code_);
}

void ActionVae::decode(const float* x, const float* z, int32_t rows, float* action) {
  const size_t own = count_of(row_inputs_), dim = count_of(action_dim_), latent = count_of(latent_);
  for (size_t i = 0; i < count_of(rows); ++i) {
    std::copy_n(x + i * (own + dim), own, input_ + i * (own + latent));
    std::copy_n(z + i * latent, latent, input_ + i * (own + latent) + own);
  }
  decoder_.forward(input_, rows, action);
  squash(Squash::kMean, action, count_of(rows) * dim);
}

// With z = m + std e: dz goes on to m, and times std e to log std. Each mean is over rows and entries.
void ActionVae::gradient(const float* x, int32_t rows, double share, Stream& noise, bool begins) {
  const size_t n = count_of(rows), dim = count_of(action_dim_), latent = count_of(latent_),
               own = count_of(row_inputs_);
  encode(x, rows);
  noise.normals(noise_, static_cast<int>(n * latent));
  for (size_t i = 0; i < n; ++i) {
    const float* const m = code_ + i * 2 * latent;
    for (size_t j = 0; j < latent; ++j) {
      const double std = elementary::exp(static_cast<double>(clamped(m[latent + j])));
      dz_[i * latent + j] = m[j] + static_cast<float>(std) * noise_[i * latent + j];
    }
  }
  decode(x, dz_, rows, action_);
  if (begins) loss_ = 0;
  const double each = share / static_cast<double>(dim), kl = 0.5 * share / static_cast<double>(latent);
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < dim; ++j) {
      const float a = action_[i * dim + j], away = a - x[i * (own + dim) + own + j];
      daction_[i * dim + j] = static_cast<float>(2 * each) * away * (1 - a * a);
      loss_ += each * static_cast<double>(away) * static_cast<double>(away);
    }
  decoder_.backward(input_, rows, daction_, begins, row_inputs_, dz_);
  for (size_t i = 0; i < n; ++i)
    for (size_t j = 0; j < latent; ++j) {
      const size_t at = i * 2 * latent + j;
      const float log_std = clamped(code_[at + latent]), m = code_[at], dz = dz_[i * latent + j];
      const double std = elementary::exp(static_cast<double>(log_std)), variance = std * std;
      dcode_[at] = dz + static_cast<float>(kl) * m;
      const double down = static_cast<double>(dz * noise_[i * latent + j]) * std + kl * (variance - 1);
      dcode_[at + latent] = code_[at + latent] == log_std ? static_cast<float>(down) : 0;
      loss_ += 0.5 * kl * (static_cast<double>(m * m) + variance - 1 - 2 * static_cast<double>(log_std));
    }
  encoder_.backward(x, rows, dcode_, begins);
}

void ActionVae::step(double rate, double max_norm) {
  encoder_.step(rate, max_norm);
  decoder_.step(rate, max_norm);
}

void ActionVae::distance(const float* x, int32_t rows, float* out) {
  encode(x, rows);
  const size_t latent = count_of(latent_);
  for (size_t i = 0; i < count_of(rows); ++i) {
    double sum = 0;
    for (size_t j = 0; j < latent; ++j) {
      const auto m = static_cast<double>(code_[i * 2 * latent + j]),
                 log_std = static_cast<double>(clamped(code_[i * 2 * latent + latent + j]));
      sum += 0.5 * (m * m + elementary::exp(2 * log_std) - 1 - 2 * log_std);
    }
    out[i] = static_cast<float>(sum / static_cast<double>(latent));
  }
}

bool ActionVae::tensor(int32_t index, char* name, TensorInfo* out) const {
  const int32_t behind = index - encoder_.num_tensors();
  return behind < 0 ? encoder_.tensor(index, "action_encoder", name, out)
                    : decoder_.tensor(behind, "action_decoder", name, out);
}

void ActionVae::visit(StateIo& io, double bound) {
  io.section("AVAE");
  encoder_.visit(io, bound);
  decoder_.visit(io, bound);
}

}  // namespace rdm
