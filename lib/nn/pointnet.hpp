// PointNet (Qi et al. 2017) without its transform nets: one network for every point of a cloud, the largest
// of each of its outputs over the points, and an activation of these, which are the features of the cloud:
//
//   f_j = act(max_p z_j(x_p)),   x_p = (q_p step, one-hot class of p, colour of p)
//
// Any order of the points gives the same bytes, and so do points that come twice. act rises, so it is applied
// to the largest alone. z never is in memory as a whole: points go through in tiles that stay in the cache.
//
// Each feature belongs to the one point that won it (the first of equal ones). So backward and tangent passes
// run on winners alone, at most as many as there are features: a few per cent of the forward pass.
#pragma once
#include <algorithm>

#include "nn/mlp.hpp"
#include "nn/scratch.hpp"

namespace rdm {

inline constexpr int32_t kMaxPoints = 16384;  // of a cloud
inline constexpr int32_t kMaxClasses = 64;

struct PointNetShape {
  MlpShape mlp;          // in: channels(); out: features, linear; activation: of features too
  int32_t points = 0;    // of each cloud; 0: there is no such network
  int32_t classes = 0;   // of points, 0: they have none
  bool color = false;    // points have one
  float origin[3] = {};  // m, where points are (0, 0, 0) to the network
  float range = 0.25f;   // m from there that are 1 to it

  int32_t channels() const { return 3 + classes + (color ? 3 : 0); }  // that it sees of a point
  int32_t features() const { return points ? mlp.out : 0; }
  size_t num_params() const { return points ? mlp.num_params() : 0; }
  size_t row_points() const { return static_cast<size_t>(points) * 3; }
};
// Error(kRange) for what is outside the bounds above, or an input that is not channels().
void check_pointnet_shape(const PointNetShape& shape);

// Largest magnitude of the network's inputs.
inline double largest_point(const PointNetShape& s) {
  return std::max(1.0, 32.767 / static_cast<double>(s.range));
}

// Millimetres from the origin, whole and within +-32767: what the network sees of a point however it comes,
// so that acting and learning agree bit by bit. points, out [count][3], m.
void quantize_points(const PointNetShape& shape, const float* points, size_t count, int16_t* out);

// Clouds of rows of a batch, somebody else's arrays: row i is row order[i stride] of them, or row i.
struct PointRows {
  const int16_t* points = nullptr;   // [][points][3] as quantize_points gives them
  const float* metres = nullptr;     // where points is null: [][points][3], m
  const uint8_t* classes = nullptr;  // [][points], each less than shape.classes; null without
  const uint8_t* colors = nullptr;   // [][points][3]; null without
  const float* features = nullptr;   // [][features] of a network that stands still; null: to be computed
  const int32_t* winner = nullptr;   // [][features] beside these, for a backward pass
  const int32_t* order = nullptr;
  int32_t stride = 1;

  explicit operator bool() const { return points || metres || features; }
  // The same without the first rows, of clouds that are not listed.
  PointRows from(const PointNetShape& s, size_t first) const {
    PointRows r = *this;
    const size_t count = first * static_cast<size_t>(s.points);
    if (points) r.points += 3 * count;
    if (metres) r.metres += 3 * count;
    if (classes) r.classes += count;
    if (colors) r.colors += 3 * count;
    if (features) r.features += first * static_cast<size_t>(s.features());
    if (winner) r.winner += first * static_cast<size_t>(s.features());
    return r;
  }
  size_t row(size_t i) const {
    return order ? static_cast<size_t>(order[i * static_cast<size_t>(stride)]) : i;
  }
};

// Error(kArgument, kRange) unless these rows have the classes and colours that the network sees.
void need_channels(const PointNetShape& shape, const PointRows& clouds, size_t rows);

// What the network's first layer sees of points [first, first + count) of row `row` of the arrays: x
// [count][in].
void see_points(const PointNetShape& shape, const PointRows& clouds, size_t row, int32_t first, int32_t count,
                float* x);

// Workspace of one thread for any number of rows.
struct PointNetScratch {
  // forward: a tile of points
  float *x = nullptr, *h[2] = {}, *z = nullptr;  // [tile][in], [tile][widest hidden], [tile][features]
  float *best = nullptr, *at = nullptr;          // [features] the largest so far, and its point
  float* packed[kMaxHidden + 1] = {};
  // backward: winners of some rows
  MlpScratch mlp;
  float *seen = nullptr, *dz = nullptr;       // [winners][in], [rows][features]
  int32_t *slot = nullptr, *place = nullptr;  // [rows][features], [points]: 1 + slot of a winner, or 0
  float* grad = nullptr;                      // [num_params]
};
PointNetScratch carve_pointnet_scratch(Arena& arena, const PointNetShape& shape);
// Enough for the forward pass alone.
PointNetScratch cut_pointnet_scratch(ScratchCutter& cutter, const PointNetShape& shape);

// Features of rows to y, y_step apart; winner [rows][features], null: not wanted.
void pointnet_forward(const PointNetShape& shape, const float* params, const PointRows& clouds, int32_t rows,
                      const PointNetScratch& scratch, float* y, size_t y_step, int32_t* winner);

// grad [num_params] is overwritten with d(loss)/d(params), given dy [rows][features] and what the forward
// pass over the same rows gave. Sums over rows are taken in a fixed order.
void pointnet_backward(const PointNetShape& shape, const float* params, const PointRows& clouds, int32_t rows,
                       const PointNetScratch& scratch, const float* y, size_t y_step, const int32_t* winner,
                       const float* dy, float* grad);

// dy [rows][features] along a direction of the parameters, likewise.
void pointnet_tangent(const PointNetShape& shape, const float* params, const float* direction,
                      const PointRows& clouds, int32_t rows, const PointNetScratch& scratch, const float* y,
                      size_t y_step, const int32_t* winner, float* dy);

}  // namespace rdm
