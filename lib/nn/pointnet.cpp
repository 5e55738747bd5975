#include "nn/pointnet.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/error.hpp"
#include "nn/kernels.hpp"

namespace rdm {
namespace {

constexpr int32_t kTile = 96;       // points at a time; a tile of 128 features takes 48 KB
constexpr int32_t kWinners = 256;   // at a time, or as many as one row can have
constexpr int32_t kBatchRows = 64;  // whose winners are gathered, at most

size_t sz(int32_t n) {
  return static_cast<size_t>(n);
}

// Winners that one row may have.
int32_t most_winners(const PointNetShape& s) {
  return std::min(s.features(), s.points);
}
int32_t winner_rows(const PointNetShape& s) {
  return std::max(kWinners, most_winners(s));
}

int16_t millimetres(float x, float origin) {
  const double mm = 1000 * (static_cast<double>(x) - static_cast<double>(origin));
  return static_cast<int16_t>(std::lrint(std::clamp(mm, -32767.0, 32767.0)));
}

// The network's input for point p of row r of the clouds.
void see_point(const PointNetShape& s, const PointRows& clouds, size_t r, size_t p, float* x) {
  const float step = 0.001f / s.range;
  const size_t at = r * s.row_points() + 3 * p;
  for (size_t k = 0; k < 3; ++k)
    x[k] = step * static_cast<float>(clouds.points ? clouds.points[at + k]
                                                   : millimetres(clouds.metres[at + k], s.origin[k]));
  if (s.classes) {
    std::fill_n(x + 3, s.classes, 0.0f);
    x[3 + clouds.classes[r * sz(s.points) + p]] = 1;
  }
  if (!s.color) return;
  for (size_t k = 0; k < 3; ++k) x[3 + sz(s.classes) + k] = static_cast<float>(clouds.colors[at + k]) / 255;
}

template <class Make>
void make_forward(const PointNetShape& shape, PointNetScratch& s, Make&& make) {
  const MlpShape& m = shape.mlp;
  const int32_t tile = std::min(kTile, shape.points);
  s.x = make(sz(tile) * sz(m.in));
  for (int32_t half = 0; half < 2; ++half) {
    int32_t widest = 0;
    for (int32_t l = half; l < m.num_hidden; l += 2) widest = std::max(widest, m.hidden[l]);
    s.h[half] = make(sz(tile) * sz(widest));
  }
  s.z = make(sz(tile) * sz(m.out));
  s.best = make(sz(m.out));
  s.at = make(sz(m.out));
  for (int32_t l = 0; l < m.num_layers(); ++l)
    s.packed[l] = make(gemm_pack_floats(m.layer_out(l), m.layer_in(l)));
}

// The largest outputs over all points of row r, without the last bias: it moves none before another.
void largest(const PointNetShape& shape, const float* params, const PointRows& clouds, size_t r,
             const PointNetScratch& s, bool (&packed)[kMaxHidden + 1]) {
  const Kernels& kernel = kernels();
  const MlpShape& m = shape.mlp;
  std::fill_n(s.best, m.out, -std::numeric_limits<float>::infinity());
  std::fill_n(s.at, m.out, 0.0f);
  for (int32_t first = 0; first < shape.points; first += kTile) {
    const int32_t n = std::min(kTile, shape.points - first);
    see_points(shape, clouds, r, first, n, s.x);
    const float* x = s.x;
    for (int32_t l = 0; l < m.num_layers(); ++l) {
      GemmArgs g;
      g.m = n, g.n = m.layer_out(l), g.k = m.layer_in(l);
      g.a = x, g.a_row = sz(g.k), g.a_col = 1;
      g.b = params + m.weight_offset(l), g.b_row = 1, g.b_col = sz(g.k);
      g.c = l == m.num_hidden ? s.z : s.h[l & 1];
      g.activation = m.activation;
      if (l < m.num_hidden) g.bias = params + m.bias_offset(l), g.activate = true;
      g.packed = s.packed[l];
      g.is_packed = packed[l];
      kernel.gemm(g);
      packed[l] |= n > kSkinnyRows && g.n > kDotColumns && packs_whole(g.n, g.k);
      x = g.c;
    }
    kernel.max_rows(s.z, n, m.out, static_cast<float>(first), s.best, s.at);
  }
}

// Winners of consecutive rows as one batch: rows [first, first + rows), whose weight (s.dz) is not 0.
struct Winners {
  int32_t first = 0, rows = 0, count = 0;
};

// Gathers from row `first` on; weight(r, dz) gives the weights of row r's features.
template <class Weight>
Winners gather(const PointNetShape& shape, const PointRows& clouds, int32_t first, int32_t rows,
               const PointNetScratch& s, const int32_t* winner, Weight&& weight) {
  const size_t features = sz(shape.features()), in = sz(shape.mlp.in);
  Winners w{first, 0, 0};
  const int32_t room = winner_rows(shape) - most_winners(shape);
  while (first + w.rows < rows && w.rows < kBatchRows && w.count <= room) {
    const size_t r = sz(first + w.rows), row = clouds.row(r);
    float* dz = s.dz + sz(w.rows) * features;
    int32_t* slot = s.slot + sz(w.rows) * features;
    weight(r, dz);
    for (size_t j = 0; j < features; ++j) {
      slot[j] = 0;
      if (dz[j] == 0) continue;
      const auto p = sz(winner[r * features + j]);
      if (s.place[p] == 0) {
        see_point(shape, clouds, row, p, s.seen + sz(w.count) * in);
        s.place[p] = ++w.count;
      }
      slot[j] = s.place[p] - 1;
    }
    for (size_t j = 0; j < features; ++j)
      if (dz[j] != 0) s.place[winner[r * features + j]] = 0;
    ++w.rows;
  }
  return w;
}

const float* last_inputs(const MlpShape& m, const PointNetScratch& s) {
  return m.num_hidden ? s.mlp.activation[m.num_hidden - 1] : s.seen;
}

}  // namespace

void check_pointnet_shape(const PointNetShape& s) {
  if (s.points < 1 || s.points > kMaxPoints)
    fail(Code::kRange, "points: %d is outside [1, %d]", s.points, kMaxPoints);
  if (s.classes < 0 || s.classes > kMaxClasses)
    fail(Code::kRange, "point classes: %d is outside [0, %d]", s.classes, kMaxClasses);
  check_mlp_shape(s.mlp);
  if (s.mlp.in != s.channels())
    fail(Code::kRange, "encoder: it has %d inputs, not 3 and %d classes%s", s.mlp.in, s.classes,
         s.color ? " and 3 of a colour" : "");
  if (!(s.range >= 1e-3f && s.range <= 1e3f))
    fail(Code::kRange, "point range: %g m is outside [0.001, 1000]", static_cast<double>(s.range));
  for (const float x : s.origin)
    if (!(std::abs(x) <= 1e6f))
      fail(Code::kRange, "point origin: %g m is outside [-1e6, 1e6]", static_cast<double>(x));
}

void see_points(const PointNetShape& shape, const PointRows& clouds, size_t row, int32_t first, int32_t count,
                float* x) {
  for (size_t p = 0; p < sz(count); ++p)
    see_point(shape, clouds, row, sz(first) + p, x + p * sz(shape.mlp.in));
}

void need_channels(const PointNetShape& s, const PointRows& clouds, size_t rows) {
  if (s.color && !clouds.colors) fail(Code::kArgument, "point_color is NULL, but the encoder reads colours");
  if (s.classes == 0) return;
  if (!clouds.classes)
    fail(Code::kArgument, "point_class is NULL, but the encoder reads %d classes", s.classes);
  const size_t count = sz(s.points);
  for (size_t i = 0; i < rows * count; ++i)
    if (clouds.classes[i] >= s.classes)
      fail(Code::kRange, "point_class: row %zu has class %d, which is outside [0, %d)", i / count,
           int32_t{clouds.classes[i]}, s.classes);
}

void quantize_points(const PointNetShape& shape, const float* points, size_t count, int16_t* out) {
  for (size_t i = 0; i < 3 * count; ++i) out[i] = millimetres(points[i], shape.origin[i % 3]);
}

PointNetScratch carve_pointnet_scratch(Arena& arena, const PointNetShape& shape) {
  PointNetScratch s;
  make_forward(shape, s, [&](size_t count) { return arena.make<float>(count); });
  const size_t winners = sz(winner_rows(shape)), features = sz(shape.features());
  s.mlp = carve_mlp_scratch(arena, shape.mlp, winner_rows(shape));
  s.seen = arena.make<float>(winners * sz(shape.mlp.in));
  s.dz = arena.make<float>(sz(kBatchRows) * features);
  s.slot = arena.make<int32_t>(sz(kBatchRows) * features);
  s.place = arena.make<int32_t>(sz(shape.points));
  s.grad = arena.make<float>(shape.num_params());
  return s;
}

PointNetScratch cut_pointnet_scratch(ScratchCutter& cutter, const PointNetShape& shape) {
  PointNetScratch s;
  make_forward(shape, s, [&](size_t count) { return cutter.make(count); });
  return s;
}

void pointnet_forward(const PointNetShape& shape, const float* params, const PointRows& clouds, int32_t rows,
                      const PointNetScratch& scratch, float* y, size_t y_step, int32_t* winner) {
  const MlpShape& m = shape.mlp;
  const float* bias = params + m.bias_offset(m.num_hidden);
  bool packed[kMaxHidden + 1] = {};
  for (size_t r = 0; r < sz(rows); ++r, y += y_step) {
    largest(shape, params, clouds, clouds.row(r), scratch, packed);
    for (size_t j = 0; j < sz(m.out); ++j) y[j] = scratch.best[j] + bias[j];
    kernels().activate(m.activation, y, sz(m.out));
    for (size_t j = 0; winner && j < sz(m.out); ++j)
      winner[r * sz(m.out) + j] = static_cast<int32_t>(scratch.at[j]);
  }
}

void pointnet_backward(const PointNetShape& shape, const float* params, const PointRows& clouds, int32_t rows,
                       const PointNetScratch& s, const float* y, size_t y_step, const int32_t* winner,
                       const float* dy, float* grad) {
  const Kernels& kernel = kernels();
  const MlpShape& m = shape.mlp;
  const int32_t last = m.num_hidden, width = m.layer_in(last);
  const size_t features = sz(m.out), hidden = m.weight_offset(last);
  const float* weights = params + hidden;
  float *dw = grad + hidden, *db = grad + m.bias_offset(last);
  std::fill_n(grad, m.num_params(), 0.0f);
  for (int32_t first = 0; first < rows;) {
    const Winners w = gather(shape, clouds, first, rows, s, winner, [&](size_t r, float* dz) {
      std::copy_n(dy + r * features, features, dz);
      kernel.slope(m.activation, y + r * y_step, features, dz);
    });
    first += w.rows;
    float* dh = last ? s.mlp.delta[last & 1] : nullptr;
    if (last) {
      mlp_forward(m, params, s.seen, w.count, s.mlp, nullptr);
      std::fill_n(dh, sz(w.count) * sz(width), 0.0f);
    }
    for (size_t i = 0; i < sz(w.rows); ++i) {
      const float* dz = s.dz + i * features;
      kernel.spread_slots(dz, s.slot + i * features, m.out, width, last_inputs(m, s), weights, dw, dh);
      for (size_t j = 0; j < features; ++j) db[j] += dz[j];
    }
    if (!last) continue;
    mlp_backward_hidden(m, params, s.seen, w.count, s.mlp, dh, s.grad);
    for (size_t i = 0; i < hidden; ++i) grad[i] += s.grad[i];
  }
}

void pointnet_tangent(const PointNetShape& shape, const float* params, const float* direction,
                      const PointRows& clouds, int32_t rows, const PointNetScratch& s, const float* y,
                      size_t y_step, const int32_t* winner, float* dy) {
  const Kernels& kernel = kernels();
  const MlpShape& m = shape.mlp;
  const int32_t last = m.num_hidden, width = m.layer_in(last);
  const size_t features = sz(m.out);
  const float *along = direction + m.weight_offset(last), *bias = direction + m.bias_offset(last);
  for (int32_t first = 0; first < rows;) {
    const Winners w = gather(shape, clouds, first, rows, s, winner, [&](size_t r, float* dz) {
      std::fill_n(dz, features, 1.0f);
      kernel.slope(m.activation, y + r * y_step, features, dz);
    });
    if (last) {
      mlp_forward(m, params, s.seen, w.count, s.mlp, nullptr);
      mlp_tangent(m, params, direction, s.seen, w.count, s.mlp, nullptr);
    }
    for (size_t i = 0; i < sz(w.rows); ++i) {
      float* out = dy + (sz(first) + i) * features;
      const int32_t* slot = s.slot + i * features;
      std::copy_n(bias, features, out);
      kernel.dot_slots(slot, m.out, width, last_inputs(m, s), along, out);
      if (last)
        kernel.dot_slots(slot, m.out, width, s.mlp.delta[(last - 1) & 1], params + m.weight_offset(last),
                         out);
      for (size_t j = 0; j < features; ++j) out[j] *= s.dz[i * features + j];
    }
    first += w.rows;
  }
}

}  // namespace rdm
