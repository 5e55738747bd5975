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

namespace {

// Terms of rows, and their derivatives by what the actor gives.
class Terms {
 public:
  Terms(const ResolvedAgentConfig& resolved, const Networks& nets, const Fit& fit)
      : nets_(nets),
        precise_(fit.precise),
        scale_(static_cast<float>(fit.weight / fit.rows)),
        dim_(resolved.action_dim()),
        out_(static_cast<size_t>(nets.shape[Networks::kActor].out)) {
    std::fill_n(precision_, dim_, 1.0f);
    for (size_t j = 0; precise_ && !nets.state_std() && j < dim_; ++j)
      precision_[j] = precision_of(nets.log_std()[j] + resolved.log_share);
  }
  // Of outputs y, whose derivatives dy become.
  void add(const float* y, const float* label, float* dy) {
    for (size_t j = 0; precise_ && nets_.state_std() && j < dim_; ++j)
      precision_[j] = precision_of(y[dim_ + j]);
    for (size_t j = 0; j < dim_; ++j) {
      const float error = y[j] - std::clamp(label[j], -1.0f, 1.0f), pull = precision_[j] * error;
      dy[j] = scale_ * pull;
      sum_ += static_cast<double>(pull) * static_cast<double>(error);
    }
    for (size_t j = dim_; j < out_; ++j) dy[j] = 0;
  }
  double sum() const { return sum_; }

 private:
  static float precision_of(float log_std) {
    return static_cast<float>(elementary::exp(-2 * static_cast<double>(log_std)));
  }

  const Networks& nets_;
  bool precise_;
  float scale_;
  size_t dim_, out_;
  float precision_[kMaxActions];
  double sum_ = 0;
};

}  // namespace

double Regression::chunk(Workspace& workspace, const Fit& fit, const int32_t* order, int32_t items,
                         float* grad) const {
  const DemoRows& demo = *fit.demo;
  if (demo.memory) return chunk_of_paths(workspace, fit, order, items, grad);
  const size_t dim = resolved_->action_dim();
  const auto out = static_cast<size_t>(nets_->shape[Networks::kActor].out);
  const float* x = gather(workspace, demo, order, items);
  PointRows clouds = demo.clouds;
  clouds.order = order;
  nets_->forward_actor(x, clouds, items, workspace.actor, workspace.out);
  Terms terms(*resolved_, *nets_, fit);
  for (size_t i = 0; i < static_cast<size_t>(items); ++i)
    terms.add(workspace.out + i * out, demo.label + static_cast<size_t>(order[i]) * dim,
              workspace.dout + i * out);
  if (!grad) return terms.sum();
  std::memset(grad, 0, nets_->std_size * sizeof(float));
  nets_->backward_actor(x, clouds, items, workspace.actor, workspace.dout, grad);
  return terms.sum();
}

double Regression::chunk_of_paths(Workspace& workspace, const Fit& fit, const int32_t* path, int32_t count,
                                  float* grad) const {
  const DemoRows& demo = *fit.demo;
  const size_t dim = resolved_->action_dim();
  const auto out = static_cast<size_t>(nets_->shape[Networks::kActor].out);
  const MemorySteps m = forward_paths(workspace, demo, path, count);
  const SequenceSpace& s = workspace.sequences;
  Terms terms(*resolved_, *nets_, fit);
  for (int32_t step = 0; step < m.steps; ++step)
    for (int32_t q = 0; q < count; ++q) {
      const size_t at = static_cast<size_t>(step * count + q) * out;
      if (step < demo.memory->rows(path[q]))
        terms.add(s.out + at, demo.label + static_cast<size_t>(demo.memory->row(path[q], step)) * dim,
                  s.dout + at);
      else
        std::fill_n(s.dout + at, out, 0.0f);
    }
  if (!grad) return terms.sum();
  std::memset(grad, 0, nets_->std_size * sizeof(float));
  nets_->backward_memory(workspace.obs, m, workspace.actor, s.dout, grad);
  return terms.sum();
}

MemorySteps Regression::forward_paths(Workspace& workspace, const DemoRows& demo, const int32_t* path,
                                      int32_t count) const {
  const SequenceSpace& s = workspace.sequences;
  const size_t dim = resolved_->obs_dim();
  const auto units = static_cast<size_t>(resolved_->state_units());
  int32_t steps = 0;
  for (int32_t q = 0; q < count; ++q) {
    std::copy_n(demo.memory->state(path[q]), units, s.h0 + static_cast<size_t>(q) * units);
    steps = std::max(steps, demo.memory->rows(path[q]));
  }
  float* x = workspace.obs;
  for (int32_t step = 0; step < steps; ++step)
    for (int32_t q = 0; q < count; ++q, x += dim) {
      if (step < demo.memory->rows(path[q]))
        std::copy_n(demo.obs + static_cast<size_t>(demo.memory->row(path[q], step)) * dim, dim, x);
      else
        std::fill_n(x, dim, 0.0f);
    }
  collector_->normalized(workspace.obs, steps * count, workspace.obs);
  const MemorySteps m{steps, count, s.h0, nullptr};
  nets_->forward_memory(workspace.obs, m, workspace.actor, s.out);
  return m;
}

// Path by path of all these episodes at once; what one leaves is where the next begins.
void Regression::remember_episodes(Workspace& workspace, const DemoRows& demo, int32_t first,
                                   int32_t count) const {
  DemoMemory& memory = *demo.memory;
  int32_t* const path = workspace.sequences.env;
  const auto units = static_cast<size_t>(resolved_->state_units());
  for (int32_t k = 0;; ++k) {
    int32_t going = 0;  // episodes of which a path follows this one
    for (int32_t e = first; e < first + count; ++e)
      if (memory.first_path(e) + k + 1 < memory.first_path(e + 1)) path[going++] = memory.first_path(e) + k;
    if (going == 0) return;
    const MemorySteps m = forward_paths(workspace, demo, path, going);
    const float* h = workspace.actor.memory.h + static_cast<size_t>((m.steps - 1) * going) * units;
    for (int32_t q = 0; q < going; ++q, h += units) std::copy_n(h, units, memory.state(path[q] + 1));
  }
}

bool Regression::remember_on(const DemoRows& demo, int32_t& group) const {
  if (!demo.memory) return true;
  group = workers_->sweep_group(
      demo.memory->episodes(), chunk_items(demo), group,
      [&](Workspace& workspace, int32_t first, int32_t n) { remember_episodes(workspace, demo, first, n); },
      [](int32_t, int32_t) {});
  return group < 0;
}

bool Regression::advance(Fit& fit) const {
  const size_t end = nets_->block[Networks::kReward].offset;
  fit.group = workers_->sweep_group(
      fit.items, chunk_items(*fit.demo), fit.group,
      [&](Workspace& workspace, int32_t first, int32_t n) {
        float* to = first == 0 && !fit.add ? fit.grad : workspace.grad;
        workspace.sums = BatchSums();
        workspace.sums.loss = chunk(workspace, fit, fit.order + first, n, fit.grad ? to : nullptr);
      },
      [&](int32_t group, int32_t n) {
        for (int32_t i = 0; i < n; ++i) fit.sum += (*workers_)[i].sums.loss;
        // of group 0 the first is there already
        if (fit.grad) workers_->reduce(fit.add ? group + 1 : group, n, fit.grad, 0, end);
      });
  return fit.group < 0;
}

double Regression::gradient(const DemoRows& demo, const int32_t* order, int32_t items, bool precise,
                            double weight, float* grad) const {
  int32_t rows = 0;
  for (int32_t i = 0; i < items; ++i) rows += demo.rows_of(order[i]);
  Fit fit{&demo, order, items, rows, precise, weight, grad};
  while (!advance(fit)) {
  }
  return fit.loss();
}

double Regression::loss(const DemoRows& demo, const int32_t* order, int32_t items, bool precise) const {
  return gradient(demo, order, items, precise, 0, nullptr);
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
