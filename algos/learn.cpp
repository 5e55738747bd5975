// The learning half of PolicyGradient: gradients of minibatches, cut into pieces and folded in order.
#include <cmath>
#include <cstring>

#include "algos/policy_gradient.hpp"
#include "nn/gaussian.hpp"

namespace rdm {

void PolicyGradient::shuffle(int32_t count) {
  int32_t* order = rollout_.order;
  for (int32_t i = count - 1; i > 0; --i)
    std::swap(order[i], order[shuffle_.below(static_cast<uint32_t>(i) + 1)]);
}

void PolicyGradient::learn() {
  const int32_t count = valid_rows_;
  if (count == 0) return;
  const int32_t parts = std::min(plan_.options.integer("minibatches"), count);
  const int32_t size = (count + parts - 1) / parts;
  const double rate = schedule_.rate(epoch_);
  BatchSums all;
  for (int32_t pass = 0; pass < plan_.options.integer("passes"); ++pass) {
    shuffle(count);
    BatchSums sums;
    for (int32_t first = 0; first < count; first += size) {
      check_cancel();
      sums += step_minibatch(rollout_.order + first, std::min(size, count - first), rate);
    }
    all += sums;
    ++learned_.passes;
    learned_.pass_kl = sums.kl / count;
    if (live_.early_stop_kl > 0 && batch_kl(count) > live_.early_stop_kl) break;
  }
  const double samples = static_cast<double>(count) * learned_.passes;
  learned_.mean_kl = all.kl / samples;
  learned_.loss_policy = all.loss / samples;
  learned_.loss_reward = all.reward_loss / samples;
  learned_.loss_cost = all.cost_loss / samples;
  learned_.clip_fraction = all.clipped / samples;
}

BatchSums PolicyGradient::step_minibatch(const int32_t* order, int32_t rows, double rate) {
  read_log_std(log_std_);
  BatchSums sums;
  sweep(
      *workers_, plan_.lanes, num_pieces(rows),
      [&](int32_t l, int32_t piece) {
        const int32_t first = piece * kPieceRows;
        piece_gradient(lanes_[l], order + first, std::min(kPieceRows, rows - first), rows,
                       piece == 0 ? grad_ : lanes_[l].grad);
      },
      [&](int32_t first, int32_t n) {
        for (int32_t l = 0; l < n; ++l) sums += lanes_[l].sums;
        fold_gradients(first, n);
      });
  apply_gradients(rate);
  return sums;
}

void PolicyGradient::piece_gradient(Lane& lane, const int32_t* order, int32_t rows, int32_t batch_rows,
                                    float* grad) const {
  const size_t dim = plan_.obs_dim();
  for (int32_t i = 0; i < rows; ++i)
    std::memcpy(lane.obs + static_cast<size_t>(i) * dim, rollout_.obs + static_cast<size_t>(order[i]) * dim,
                dim * sizeof(float));
  lane.sums = BatchSums();
  const MlpShape& actor = nets_.shape[Networks::kActor];
  mlp_forward(actor, nets_.net(Networks::kActor), lane.obs, rows, lane.actor, lane.out);
  std::memset(grad, 0, nets_.std_size * sizeof(float));
  PolicyPiece piece;
  piece.order = order;
  piece.rows = rows;
  piece.mean = lane.out;
  piece.log_std = log_std_;
  piece.old_log_std = old_log_std_;
  piece.scale = 1 / static_cast<float>(batch_rows);
  piece.dmean = lane.dout;
  piece.dlog_std = grad;
  piece.sums = &lane.sums;
  policy_loss(piece);
  mlp_backward(actor, nets_.net(Networks::kActor), lane.obs, rows, lane.actor, lane.dout,
               grad + nets_.std_size);
  lane.sums.reward_loss = critic_gradient(lane, Networks::kReward, order, rows, batch_rows, grad);
  if (nets_.count > Networks::kCost)
    lane.sums.cost_loss = critic_gradient(lane, Networks::kCost, order, rows, batch_rows, grad);
}

// Squared error against the targets; returns its sum over the rows (and columns).
double PolicyGradient::critic_gradient(Lane& lane, Networks::Index net, const int32_t* order, int32_t rows,
                                       int32_t batch_rows, float* grad) const {
  const MlpShape& shape = nets_.shape[net];
  const auto out = static_cast<size_t>(shape.out);
  const float* target = net == Networks::kReward ? rollout_.target : rollout_.cost_target;
  mlp_forward(shape, nets_.net(net), lane.obs, rows, lane.critic, lane.out);
  const float scale = 2 / static_cast<float>(batch_rows);
  double loss = 0;
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i)
    for (size_t k = 0; k < out; ++k) {
      const float error = lane.out[i * out + k] - target[static_cast<size_t>(order[i]) * out + k];
      lane.dout[i * out + k] = scale * error;
      loss += static_cast<double>(error) * static_cast<double>(error);
    }
  mlp_backward(shape, nets_.net(net), lane.obs, rows, lane.critic, lane.dout, grad + nets_.block[net].offset);
  return loss;
}

// grad_ += the lanes' gradients, in order. Piece 0 wrote into grad_ itself.
void PolicyGradient::fold_gradients(int32_t first, int32_t n) {
  const int32_t begin = first == 0 ? 1 : 0;
  if (begin >= n) return;
  const auto ranges = static_cast<size_t>(n), size = nets_.size;
  spread(*workers_, n, [&](int32_t range) {
    const auto k = static_cast<size_t>(range);
    const size_t from = size * k / ranges, to = size * (k + 1) / ranges;
    for (int32_t l = begin; l < n; ++l) {
      const float* part = lanes_[l].grad;
      for (size_t i = from; i < to; ++i) grad_[i] += part[i];
    }
  });
}

void PolicyGradient::apply_gradients(double rate) {
  double norm[3];
  spread(*workers_, nets_.count, [&](int32_t i) {
    Block& b = nets_.block[i];
    float *grad = grad_ + b.offset, *params = nets_.params + b.offset;
    const bool actor = i == Networks::kActor;
    if (actor) {
      for (size_t j = 0; j < plan_.action_dim(); ++j)
        grad[j] = learn_std_ ? grad[j] - static_cast<float>(live_.entropy) : 0;
    } else if (live_.critic_l2 > 0) {
      const auto twice = static_cast<float>(2 * live_.critic_l2);
      for (size_t j = 0; j < b.size; ++j) grad[j] += twice * params[j];
    }
    norm[i] = adam_step(b.adam, params, grad, actor ? rate : live_.critic_rate, live_.max_grad_norm);
  });
  for (int32_t i = 0; i < nets_.count; ++i)
    if (!std::isfinite(norm[i])) ++skipped_;
  clamp_log_std(nets_, plan_.options);
}

// KL(old || now), mean over the first `count` rows of the order.
double PolicyGradient::batch_kl(int32_t count) {
  read_log_std(log_std_);
  double sum = 0;
  const auto dim = plan_.action_dim();
  sweep(
      *workers_, plan_.lanes, num_pieces(count),
      [&](int32_t l, int32_t piece) {
        Lane& lane = lanes_[l];
        const int32_t first = piece * kPieceRows, rows = std::min(kPieceRows, count - first);
        const int32_t* order = rollout_.order + first;
        for (int32_t i = 0; i < rows; ++i)
          std::memcpy(lane.obs + static_cast<size_t>(i) * plan_.obs_dim(),
                      rollout_.obs + static_cast<size_t>(order[i]) * plan_.obs_dim(),
                      plan_.obs_dim() * sizeof(float));
        mlp_forward(nets_.shape[Networks::kActor], nets_.net(Networks::kActor), lane.obs, rows, lane.actor,
                    lane.out);
        lane.sums = BatchSums();
        for (int32_t i = 0; i < rows; ++i)
          lane.sums.kl += static_cast<double>(
              gaussian_kl(rollout_.mean + static_cast<size_t>(order[i]) * dim, old_log_std_,
                          lane.out + static_cast<size_t>(i) * dim, log_std_, plan_.config.action_dim));
      },
      [&](int32_t, int32_t n) {
        for (int32_t l = 0; l < n; ++l) sum += lanes_[l].sums.kl;
      });
  return sum / count;
}

}  // namespace rdm
