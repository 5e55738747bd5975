#include "algos/imitation/pretrain.hpp"

#include <algorithm>
#include <cmath>

#include "algos/imitation/need.hpp"
#include "base/elementary.hpp"
#include "base/error.hpp"
#include "base/shuffle.hpp"

namespace rdm {
namespace {

constexpr int32_t kTile = 128;      // points at a time
constexpr int32_t kHeadWidth = 64;  // of the head's hidden layer
constexpr int32_t kChunk = 2;       // clouds by one thread at a time
constexpr double kMaxNorm = 1;      // of a gradient

size_t sz(int32_t n) {
  return static_cast<size_t>(n);
}

// What one thread works with.
struct Lane {
  PointNetScratch eyes;
  MlpScratch points, head;  // of a tile
  float *features = nullptr, *dfeatures = nullptr;
  int32_t* winner = nullptr;
  float *x = nullptr, *rows = nullptr, *drows = nullptr, *dh = nullptr;
  float *logits = nullptr, *dlogits = nullptr;
  float *grad = nullptr, *part = nullptr;  // [encoder, then head]
  double loss = 0;
  int64_t right = 0;
};

MlpShape head_of(const MlpShape& m, int32_t labels) {
  MlpShape head;
  head.in = m.layer_in(m.num_hidden) + m.out, head.out = labels;
  head.num_hidden = 1, head.hidden[0] = kHeadWidth;
  head.activation = m.activation;
  return head;
}

class Pretraining {
 public:
  Pretraining(const PointNetShape& eyes, const PointRows& clouds, const uint8_t* label, int32_t labels,
              BatchWorkers& workers)
      : eyes_(eyes), clouds_(clouds), label_(label), workers_(workers) {
    const MlpShape& m = eyes.mlp;
    width_ = m.layer_in(m.num_hidden);
    head_ = head_of(m, labels);
    Arena measure;
    carve(measure);
    arena_ = Arena(host(), measure.used());
    carve(arena_);
  }
  const MlpShape& head() const { return head_; }
  size_t size() const { return eyes_.num_params() + head_.num_params(); }

  struct Sums {
    double loss = 0;
    int64_t right = 0;
  };
  // Over the listed clouds: summed cross-entropy of points, and points told right; grad [size()] of the mean
  // loss of a point, null: not wanted.
  Sums run(const float* params, const int32_t* order, int32_t rows, float* grad) {
    Sums sums;
    const float scale = 1 / static_cast<float>(static_cast<double>(rows) * eyes_.points);
    if (grad) std::fill_n(grad, size(), 0.0f);
    workers_.sweep(
        rows, kChunk,
        [&](const Workspace& workspace, int32_t first, int32_t n) {
          Lane& lane = lanes_[&workspace - &workers_[0]];
          chunk(lane, params, order + first, n, scale, grad != nullptr);
        },
        [&](int32_t, int32_t n) {
          for (int32_t i = 0; i < n; ++i) {
            sums.loss += lanes_[i].loss, sums.right += lanes_[i].right;
            for (size_t j = 0; grad && j < size(); ++j) grad[j] += lanes_[i].grad[j];
          }
        });
    return sums;
  }

 private:
  void carve(Arena& arena) {
    const auto count = sz(workers_.count()), features = sz(eyes_.features()), tile = sz(kTile);
    lanes_ = arena.make<Lane>(count);
    for (size_t i = 0; i < count; ++i) {
      Lane l;
      l.eyes = carve_pointnet_scratch(arena, eyes_);
      l.points = carve_mlp_scratch(arena, eyes_.mlp, kTile);
      l.head = carve_mlp_scratch(arena, head_, kTile);
      l.features = arena.make<float>(features);
      l.dfeatures = arena.make<float>(features);
      l.winner = arena.make<int32_t>(features);
      l.x = arena.make<float>(tile * sz(eyes_.mlp.in));
      l.rows = arena.make<float>(tile * sz(head_.in));
      l.drows = arena.make<float>(tile * sz(head_.in));
      l.dh = arena.make<float>(tile * sz(width_));
      l.logits = arena.make<float>(tile * sz(head_.out));
      l.dlogits = arena.make<float>(tile * sz(head_.out));
      l.grad = arena.make<float>(size());
      l.part = arena.make<float>(size());
      if (lanes_) lanes_[i] = l;
    }
  }

  void chunk(Lane& l, const float* params, const int32_t* order, int32_t n, float scale, bool learn) const {
    l.loss = 0, l.right = 0;
    if (learn) std::fill_n(l.grad, size(), 0.0f);
    for (int32_t i = 0; i < n; ++i) {
      PointRows one = clouds_;
      one.order = order + i;
      pointnet_forward(eyes_, params, one, 1, l.eyes, l.features, sz(eyes_.features()), l.winner);
      std::fill_n(l.dfeatures, eyes_.features(), 0.0f);
      for (int32_t first = 0; first < eyes_.points; first += kTile)
        tile(l, params, one, first, std::min(kTile, eyes_.points - first), scale, learn);
      if (!learn) continue;
      pointnet_backward(eyes_, params, one, 1, l.eyes, l.features, sz(eyes_.features()), l.winner,
                        l.dfeatures, l.part);
      for (size_t j = 0; j < eyes_.num_params(); ++j) l.grad[j] += l.part[j];
    }
  }

  void tile(Lane& l, const float* params, const PointRows& one, int32_t first, int32_t n, float scale,
            bool learn) const {
    const MlpShape& m = eyes_.mlp;
    const size_t in = sz(head_.in), width = sz(width_), features = sz(m.out), kinds = sz(head_.out);
    const float* const head = params + eyes_.num_params();
    see_points(eyes_, one, one.row(0), first, n, l.x);
    mlp_forward(m, params, l.x, n, l.points, nullptr);
    const float* h = m.num_hidden ? l.points.activation[m.num_hidden - 1] : l.x;
    for (size_t p = 0; p < sz(n); ++p) {
      std::copy_n(h + p * width, width, l.rows + p * in);
      std::copy_n(l.features, features, l.rows + p * in + width);
    }
    mlp_forward(head_, head, l.rows, n, l.head, l.logits);
    const uint8_t* label = label_ + one.row(0) * sz(eyes_.points) + sz(first);
    for (size_t p = 0; p < sz(n); ++p) judge(l, l.logits + p * kinds, label[p], scale, l.dlogits + p * kinds);
    if (!learn) return;
    float* const head_part = l.part + eyes_.num_params();
    mlp_backward(head_, head, l.rows, n, l.head, l.dlogits, head_part, 0, l.drows);
    for (size_t j = 0; j < head_.num_params(); ++j) l.grad[eyes_.num_params() + j] += head_part[j];
    for (size_t p = 0; p < sz(n); ++p) {
      std::copy_n(l.drows + p * in, width, l.dh + p * width);
      for (size_t j = 0; j < features; ++j) l.dfeatures[j] += l.drows[p * in + width + j];
    }
    if (m.num_hidden == 0) return;
    mlp_backward_hidden(m, params, l.x, n, l.points, l.dh, l.part);
    for (size_t j = 0; j < m.weight_offset(m.num_hidden); ++j) l.grad[j] += l.part[j];
  }

  // Cross-entropy of one point and its derivative by the log-odds.
  void judge(Lane& l, const float* logits, uint8_t label, float scale, float* dlogits) const {
    const size_t kinds = sz(head_.out);
    const float* best = std::max_element(logits, logits + kinds);
    double sum = 0;
    for (size_t k = 0; k < kinds; ++k)
      sum += elementary::exp(static_cast<double>(logits[k]) - static_cast<double>(*best));
    l.loss += elementary::log(sum) + static_cast<double>(*best) - static_cast<double>(logits[label]);
    l.right += best - logits == label;
    for (size_t k = 0; k < kinds; ++k) {
      const double share = elementary::exp(static_cast<double>(logits[k]) - static_cast<double>(*best)) / sum;
      dlogits[k] = scale * static_cast<float>(share - (k == label ? 1 : 0));
    }
  }

  PointNetShape eyes_;
  PointRows clouds_;
  const uint8_t* label_;
  BatchWorkers& workers_;
  MlpShape head_;
  int32_t width_ = 0;  // of what the head sees of a point
  Arena arena_;
  Lane* lanes_ = nullptr;
};

double share_of_commonest(const uint8_t* label, size_t points, const int32_t* order, int32_t rows,
                          int32_t labels) {
  Vector<int64_t> count(sz(labels));
  for (int32_t i = 0; i < rows; ++i)
    for (size_t p = 0; p < points; ++p) ++count[label[sz(order[i]) * points + p]];
  return static_cast<double>(*std::max_element(count.begin(), count.end())) /
         (static_cast<double>(rows) * static_cast<double>(points));
}

}  // namespace

size_t segmentation_params(const PointNetShape& eyes, int32_t num_labels) {
  return eyes.num_params() + head_of(eyes.mlp, num_labels).num_params();
}

double segmentation_loss(const PointNetShape& eyes, const PointRows& clouds, const uint8_t* label,
                         int32_t num_labels, const int32_t* order, int32_t rows, BatchWorkers& workers,
                         const float* params, float* grad) {
  Pretraining training(eyes, clouds, label, num_labels, workers);
  return training.run(params, order, rows, grad).loss / (static_cast<double>(rows) * eyes.points);
}

PretrainReport pretrain_eyes(const ResolvedAgentConfig& resolved, const PointRows& clouds,
                             const uint8_t* label, int32_t rows, const PretrainOptions& how, Networks& nets,
                             BatchWorkers& workers, CancelFlag& cancel) {
  const PointNetShape& eyes = resolved.eyes;
  need("num_labels", how.num_labels, 2, kMaxClasses);
  need("epochs", how.epochs, 1, 100000);
  need("batch_rows", how.batch_rows, 1, 4096);
  need("learning_rate", how.learning_rate, 0, 10);
  need("validation", how.validation, 0, 0.9);
  const size_t points = sz(eyes.points);
  for (size_t i = 0; i < sz(rows) * points; ++i)
    if (label[i] >= how.num_labels)
      fail(Code::kRange, "label: row %zu has %d, which is outside [0, %d)", i / points, int32_t{label[i]},
           how.num_labels);
  Pretraining training(eyes, clouds, label, how.num_labels, workers);
  const size_t size = training.size(), encoder = eyes.num_params();
  Vector<float> params(nets.eyes_net(), nets.eyes_net() + encoder), grad(size), m(size), v(size);
  params.resize(size);
  Stream stream(how.seed, 1, Purpose::kClone);  // 0: rdm_agent_clone's
  mlp_init(training.head(), stream, 1, params.data() + encoder);
  Adam adam;
  adam.size = size, adam.m = m.data(), adam.v = v.data();
  Vector<int32_t> order(sz(rows));
  for (int32_t i = 0; i < rows; ++i) order[sz(i)] = i;
  shuffle(stream, order.data(), rows);
  PretrainReport out;
  out.validation_rows = std::min(rows - 1, static_cast<int32_t>(how.validation * rows));
  out.train_rows = rows - out.validation_rows;
  for (int32_t e = 0; e < how.epochs; ++e) {
    const double done = how.epochs > 1 ? static_cast<double>(e) / (how.epochs - 1) : 0;
    shuffle(stream, order.data(), out.train_rows);
    double sum = 0;
    for (int32_t first = 0; first < out.train_rows; first += how.batch_rows) {
      cancel.check();
      const int32_t n = std::min(how.batch_rows, out.train_rows - first);
      sum += training.run(params.data(), order.data() + first, n, grad.data()).loss;
      adam_step(adam, params.data(), grad.data(), how.learning_rate * (1 - 0.9 * done), kMaxNorm);
    }
    out.train_loss = sum / (static_cast<double>(out.train_rows) * eyes.points);
  }
  if (!std::isfinite(out.train_loss))
    fail(Code::kArgument, "learning_rate: the encoder's weights overflowed");
  const int32_t judged = out.validation_rows ? out.validation_rows : rows;
  const int32_t* held = order.data() + (rows - judged);
  const auto sums = training.run(params.data(), held, judged, nullptr);
  const double count = static_cast<double>(judged) * eyes.points;
  if (out.validation_rows) out.validation_loss = sums.loss / count;
  out.accuracy = static_cast<double>(sums.right) / count;
  out.most_common = share_of_commonest(label, points, held, judged, how.num_labels);

  std::copy_n(params.begin(), encoder, nets.eyes_net());
  Adam& own = nets.block[Networks::kActor].adam;
  const size_t at = own.size - encoder;
  std::fill_n(own.m + at, encoder, 0.0f);
  std::fill_n(own.v + at, encoder, 0.0f);
  return out;
}

}  // namespace rdm
