#include "algos/trust_region/fisher.hpp"

#include <algorithm>

#include "algos/rollout/sequences.hpp"
#include "base/elementary.hpp"

namespace rdm {

void Fisher::carve(Arena& arena, const ResolvedAgentConfig& resolved) {
  weight_ = arena.make<float>(resolved.state_std() ? 0 : resolved.action_dim());
  if (!resolved.sees() || resolved.frozen) return;
  const size_t count = static_cast<size_t>(resolved.samples) * static_cast<size_t>(resolved.eyes.features());
  features_ = arena.make<float>(count);
  winner_ = arena.make<int32_t>(count);
}

void Fisher::open(const ResolvedAgentConfig& resolved, const Rollout& rollout, const Networks& nets,
                  BatchWorkers& workers) {
  resolved_ = &resolved;
  rollout_ = &rollout;
  nets_ = &nets;
  workers_ = &workers;
}

Job Fisher::begin_rows(const Batch& batch) {
  batch_ = batch;
  int32_t own = 0;
  for (int32_t b = 0; b < batch.blocks; ++b) own += (batch.segment(b).rows + stride() - 1) / stride();
  rows_ = static_cast<int32_t>(workers_->ranks().total(own));
  for (size_t j = 0; !nets_->state_std() && j < resolved_->action_dim(); ++j) {
    const auto log_std = static_cast<double>(nets_->log_std()[j] + resolved_->log_share);
    weight_[j] = static_cast<float>(elementary::exp(-2 * log_std) / (rows_ * dims()));
  }
  if (!features_) return {};
  sweep_ = Sweep(batch, stride());
  return Job::of<&Fisher::advance_rows>(this);
}

bool Fisher::advance_rows(bool) {
  const auto width = static_cast<size_t>(nets_->eyes.features());
  workers_->cut(sweep_, resolved_->chunk_rows);
  workers_->each(sweep_, [&](const Workspace& workspace, const Chunk& chunk) {
    const PointRows seen = rollout_->clouds(chunk.order, stride());
    pointnet_forward(nets_->eyes, nets_->eyes_net(), seen, chunk.rows, workspace.actor.eyes,
                     workspace.actor.dfeatures, width, workspace.actor.winner);
    for (size_t i = 0; i < static_cast<size_t>(chunk.rows); ++i) {
      std::copy_n(workspace.actor.dfeatures + i * width, width, features_ + seen.row(i) * width);
      std::copy_n(workspace.actor.winner + i * width, width, winner_ + seen.row(i) * width);
    }
  });
  return sweep_.over();
}

PointRows Fisher::clouds(const int32_t* rows) const {
  PointRows c = rollout_->clouds(rows, stride());
  if (features_) c.features = features_, c.winner = winner_;
  return c;
}

void Fisher::weigh(const float* y, int32_t n, float* dy) const {
  const size_t dim = resolved_->action_dim();
  if (!nets_->state_std()) {
    for (size_t i = 0; i < static_cast<size_t>(n); ++i)
      for (size_t j = 0; j < dim; ++j) dy[i * dim + j] *= weight_[j];
    return;
  }
  const double share = 1 / (rows_ * dims());
  for (size_t i = 0; i < static_cast<size_t>(n); ++i)
    for (size_t j = 0; j < dim; ++j) {
      const size_t mean = 2 * i * dim + j, log_std = mean + dim;
      dy[mean] *= static_cast<float>(share * elementary::exp(-2 * static_cast<double>(y[log_std])));
      dy[log_std] *= static_cast<float>(2 * share);
    }
  nets_->gate_std(y, n, dy);
}

Job Fisher::begin_product(const float* v, float* out) {
  v_ = v;
  out_ = out;
  sweep_ = Sweep(batch_, stride());
  return Job::of<&Fisher::advance_product>(this);
}

bool Fisher::advance_product(bool) {
  workers_->cut(sweep_, resolved_->chunk_rows);
  workers_->each(sweep_, [&](Workspace& w, const Chunk& chunk) { multiply_chunk(w, chunk); });
  workers_->reduce(sweep_, out_, nets_->std_size, nets_->block[Networks::kActor].size);
  if (sweep_.over()) end_product();
  return sweep_.over();
}

void Fisher::multiply_chunk(Workspace& workspace, const Chunk& chunk) {
  const size_t skip = nets_->std_size, size = nets_->block[Networks::kActor].size;
  float* grad = BatchWorkers::gradient_of(workspace, out_);
  const int32_t n = chunk.rows;
  if (n == 0) return std::fill(grad + skip, grad + size, 0.0f);
  if (nets_->gru.units) return multiply_sequences(workspace, chunk, grad);
  const PointRows seen = clouds(chunk.order);
  gather_obs(*rollout_, chunk.order, stride(), n, workspace.obs);
  nets_->forward_actor(workspace.obs, seen, n, workspace.actor, workspace.out);
  nets_->tangent_actor(v_ + skip, workspace.obs, seen, n, workspace.actor, workspace.dout);
  weigh(workspace.out, n, workspace.dout);
  nets_->backward_actor(workspace.obs, seen, n, workspace.actor, workspace.dout, grad);
}

// The same through the sequences of the chunk, from the states before them, which are constants.
void Fisher::multiply_sequences(Workspace& workspace, const Chunk& chunk, float* grad) const {
  const int32_t n = chunk.rows;
  const auto width = static_cast<size_t>(nets_->shape[Networks::kActor].out);
  const SequenceSpace& s = workspace.sequences;
  const MemorySteps memory = gather_sequences(*rollout_, chunk.order, n, workspace, stride());
  nets_->forward_memory(workspace.obs, memory, workspace.actor, s.out);
  take_outputs(s, n, width, workspace.out);
  nets_->tangent_memory(v_ + nets_->std_size, workspace.obs, memory, workspace.actor, s.out);
  take_outputs(s, n, width, workspace.dout);
  weigh(workspace.out, n, workspace.dout);
  give_gradients(s, n, width, workspace.dout);
  nets_->backward_memory(workspace.obs, memory, workspace.actor, s.dout, grad);
}

void Fisher::end_product() {
  const size_t skip = nets_->std_size, size = nets_->block[Networks::kActor].size;
  workers_->ranks().sum(out_ + skip, size - skip, nullptr, 0);
  const auto damping = static_cast<float>(options_.cg_damping), own = static_cast<float>(2 / dims());
  for (size_t j = 0; j < skip; ++j) out_[j] = (own + damping) * v_[j];
  for (size_t j = skip; j < size; ++j) out_[j] += damping * v_[j];
}

}  // namespace rdm
