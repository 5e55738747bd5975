#include "algos/imitation/regression.hpp"

#include <algorithm>
#include <cstring>

#include "base/elementary.hpp"

namespace rdm {

void Regression::open(const ResolvedAgentConfig& resolved, const Collector& collector, const Networks& nets,
                      BatchWorkers& workers) {
  resolved_ = &resolved;
  collector_ = &collector;
  nets_ = &nets;
  workers_ = &workers;
}

const float* Regression::gather(const Workspace& workspace, const DemoRows& demo, const int32_t* order,
                                int32_t rows) const {
  const size_t dim = resolved_->obs_dim(), width = resolved_->seen_dim();
  const auto row_of = [&](int32_t row) { return demo.obs + static_cast<size_t>(row) * dim; };
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i)
    std::memcpy(workspace.obs + i * dim, row_of(order[i]), dim * sizeof(float));
  const float* x = collector_->normalized(workspace.obs, rows, workspace.obs);
  if (resolved_->history == 1) return x;
  const Normalizer& n = collector_->normalizer();
  const Rollout& r = collector_->rollout();
  const auto entries = static_cast<size_t>(r.width);
  for (auto i = static_cast<size_t>(rows); i-- > 0;) {  // from the last row on: they begin in the same place
    float* const to = workspace.obs + i * width;
    std::memmove(to, workspace.obs + i * dim, dim * sizeof(float));
    float* past = to + dim;
    int32_t row = order[i];
    for (int32_t k = 0; k < r.depth; ++k, past += entries) {
      if (row >= 0) row = demo.before[row];
      for (size_t j = 0; j < entries; ++j) {
        const size_t column = r.columns ? static_cast<size_t>(r.columns[j]) : j;
        if (row < 0)
          past[j] = 0;
        else if (collector_->normalizes())
          past[j] = std::clamp((row_of(row)[column] - n.shift[column]) * n.scale[column], -n.clip, n.clip);
        else
          past[j] = row_of(row)[column];
      }
    }
  }
  return workspace.obs;
}

double Regression::chunk(const Workspace& workspace, const DemoRows& demo, const int32_t* order, int32_t rows,
                         bool precise, float scale, float* grad) const {
  const size_t dim = resolved_->action_dim();
  const auto out = static_cast<size_t>(nets_->shape[Networks::kActor].out);
  const float* x = gather(workspace, demo, order, rows);
  PointRows clouds = demo.clouds;
  clouds.order = order;
  nets_->forward_actor(x, clouds, rows, workspace.actor, workspace.out);
  float precision[kMaxActions];
  std::fill_n(precision, dim, 1.0f);
  double sum = 0;
  for (size_t i = 0; i < static_cast<size_t>(rows); ++i) {
    const float *mean = workspace.out + i * out, *label = demo.label + static_cast<size_t>(order[i]) * dim;
    float* dmean = workspace.dout + i * out;
    for (size_t j = 0; precise && j < dim && (i == 0 || nets_->state_std()); ++j) {
      const float l = nets_->state_std() ? mean[dim + j] : nets_->log_std()[j] + resolved_->log_share;
      precision[j] = static_cast<float>(elementary::exp(-2 * static_cast<double>(l)));
    }
    for (size_t j = 0; j < dim; ++j) {
      const float error = mean[j] - std::clamp(label[j], -1.0f, 1.0f), pull = precision[j] * error;
      dmean[j] = scale * pull;
      sum += static_cast<double>(pull) * static_cast<double>(error);
    }
    for (size_t j = dim; j < out; ++j) dmean[j] = 0;
  }
  if (!grad) return sum;
  std::memset(grad, 0, nets_->std_size * sizeof(float));
  nets_->backward_actor(x, clouds, rows, workspace.actor, workspace.dout, grad);
  return sum;
}

bool Regression::advance(Fit& fit) const {
  const auto scale = static_cast<float>(fit.weight / fit.rows);
  const size_t end = nets_->block[Networks::kReward].offset;
  fit.group = workers_->sweep_group(
      fit.rows, resolved_->chunk_rows, fit.group,
      [&](Workspace& workspace, int32_t first, int32_t n) {
        float* to = first == 0 && !fit.add ? fit.grad : workspace.grad;
        workspace.sums = BatchSums();
        workspace.sums.loss =
            chunk(workspace, *fit.demo, fit.order + first, n, fit.precise, scale, fit.grad ? to : nullptr);
      },
      [&](int32_t group, int32_t n) {
        for (int32_t i = 0; i < n; ++i) fit.sum += (*workers_)[i].sums.loss;
        // of group 0 the first is there already
        if (fit.grad) workers_->reduce(fit.add ? group + 1 : group, n, fit.grad, 0, end);
      });
  return fit.group < 0;
}

double Regression::gradient(const DemoRows& demo, const int32_t* order, int32_t rows, bool precise,
                            double weight, float* grad) const {
  Fit fit{&demo, order, rows, precise, weight, grad};
  while (!advance(fit)) {
  }
  return fit.loss();
}

double Regression::loss(const DemoRows& demo, const int32_t* order, int32_t rows, bool precise) const {
  return gradient(demo, order, rows, precise, 0, nullptr);
}

void Regression::features(const DemoRows& demo, float* out) const {
  const PointNetShape& eyes = nets_->eyes;
  const auto width = static_cast<size_t>(eyes.features());
  workers_->sweep(
      demo.rows, resolved_->chunk_rows, [&](const Workspace& workspace, int32_t first, int32_t n) {
        pointnet_forward(eyes, nets_->eyes_net(), demo.clouds.from(eyes, static_cast<size_t>(first)), n,
                         workspace.actor.eyes, out + static_cast<size_t>(first) * width, width, nullptr);
      });
}

}  // namespace rdm
