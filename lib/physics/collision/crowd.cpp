#include "physics/collision/crowd.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/simd.hpp"
#include "physics/collision/broadphase.hpp"

namespace rdm {
namespace {

constexpr int32_t kLeastPairs = 2016;  // of 64 bodies with each other

}  // namespace

// Neither a robot's shape nor a plane.
bool Crowd::counts(const Scene& scene, const ShapePair& pair) {
  return std::min(pair.a, pair.b) >= scene.first_body_shape &&
         scene.shapes[static_cast<size_t>(pair.a)].radius >= 0 &&
         scene.shapes[static_cast<size_t>(pair.b)].radius >= 0;
}

// use(a, partners), in the order of the pairs.
template <class Use>
void Crowd::each_run(const Scene& scene, const Use& use) {
  int32_t a = -1;
  Partners run{};
  for (int32_t k = 0; k < static_cast<int32_t>(scene.pairs.size()); ++k) {
    const ShapePair& pair = scene.pairs[static_cast<size_t>(k)];
    if (!counts(scene, pair)) continue;
    if (a == pair.a && k == run.first_pair + run.count && pair.b == run.first_shape + run.count) {
      ++run.count;
      continue;
    }
    if (a >= 0) use(a, run);
    a = pair.a;
    run = {k, pair.b, 1};
  }
  if (a >= 0) use(a, run);
}

void Crowd::carve(const Scene& scene, Arena& arena) {
  const auto pairs = std::count_if(scene.pairs.begin(), scene.pairs.end(),
                                   [&](const ShapePair& pair) { return counts(scene, pair); });
  num_shapes_ = 0;
  if (pairs < kLeastPairs) return;
  num_shapes_ = static_cast<int32_t>(scene.shapes.size()) - scene.first_body_shape;
  size_t runs = 0;
  each_run(scene, [&](int32_t, const Partners&) { ++runs; });
  words_ = (scene.pairs.size() + 63) / 64;
  shapes_ = arena.make<int32_t>(static_cast<size_t>(num_shapes_));
  const auto room = static_cast<size_t>(num_shapes_ + kFloat4Lanes);
  begins_ = arena.make<Begin>(room);
  sorted_.low = arena.make<float>(room);
  sorted_.shape = arena.make<int32_t>(room);
  for (int r = 0; r < 2; ++r) {
    sorted_.center[r] = arena.make<float>(room);
    sorted_.half[r] = arena.make<float>(room);
  }
  partners_ = arena.make<Partners>(runs);
  partners_end_ = arena.make<int32_t>(scene.shapes.size() + 1);
  meet_ = arena.make<uint64_t>(words_);
}

// Runs are sorted by their shape, and stay in order within it.
void Crowd::make(const Scene& scene) {
  if (num_shapes_ == 0) return;
  int32_t* const ends = partners_end_;
  each_run(scene, [&](int32_t a, const Partners&) { ++ends[a + 1]; });
  for (size_t i = 0; i < scene.shapes.size(); ++i) ends[i + 1] += ends[i];
  // each beginning moves to its end while its runs are put in place, which is where the next one's begins
  each_run(scene, [&](int32_t a, const Partners& run) { partners_[ends[a]++] = run; });
  for (size_t i = scene.shapes.size(); i > 0; --i) ends[i] = ends[i - 1];
  ends[0] = 0;
  num_shapes_ = 0;
  for (int32_t i = scene.first_body_shape; i < static_cast<int32_t>(scene.shapes.size()); ++i)
    if (scene.shapes[static_cast<size_t>(i)].radius >= 0) shapes_[num_shapes_++] = i;
}

int32_t Crowd::pair_of(int32_t a, int32_t b) const {
  for (int32_t k = partners_end_[a]; k < partners_end_[a + 1]; ++k) {
    const Partners& run = partners_[k];
    if (b >= run.first_shape && b < run.first_shape + run.count) return run.first_pair + b - run.first_shape;
  }
  return -1;
}

// Along which the centres vary most.
int Crowd::widest_axis(const Bound* bounds) const {
  double most = -1;
  int widest = 0;
  for (int r = 0; r < 3; ++r) {
    double sum = 0, squares = 0;
    for (int32_t i = 0; i < num_shapes_; ++i) {
      const auto x = static_cast<double>(bounds[shapes_[i]].center[r]);
      sum += x;
      squares += x * x;
    }
    const double spread = squares - sum * sum / num_shapes_;
    if (!(spread > most)) continue;
    most = spread;
    widest = r;
  }
  return widest;
}

// The boxes of a and b meet.
void Crowd::meet(int32_t a, int32_t b) {
  int32_t pair = pair_of(a, b);
  if (pair < 0) pair = pair_of(b, a);
  if (pair >= 0) meet_[pair / 64] |= uint64_t{1} << (pair % 64);
}

const uint64_t* Crowd::search(const Bound* bounds, const Extent* extents) {
  std::fill_n(meet_, words_, uint64_t{0});
  const int along = widest_axis(bounds), across[2] = {(along + 1) % 3, (along + 2) % 3};
  int32_t count = 0;
  for (int32_t i = 0; i < num_shapes_; ++i) {
    const int32_t shape = shapes_[i];
    const float low = bounds[shape].center[along] - extents[shape].half[along];
    if (low == low) begins_[count++] = {low, shape};  // a NaN touches nothing, and has no order
  }
  std::sort(begins_, begins_ + count, [](const Begin& a, const Begin& b) { return a.low < b.low; });
  for (int32_t i = 0; i < count + kFloat4Lanes; ++i) {
    const bool past = i >= count;
    const int32_t shape = begins_[past ? 0 : i].shape;
    sorted_.low[i] = past ? HUGE_VALF : begins_[i].low;
    sorted_.shape[i] = shape;
    for (int r = 0; r < 2; ++r) {
      sorted_.center[r][i] = bounds[shape].center[across[r]];
      sorted_.half[r][i] = extents[shape].half[across[r]];
    }
  }
  for (int32_t i = 0; i < count; ++i) {
    const int32_t shape = sorted_.shape[i];
    const Float4 high = splat(bounds[shape].center[along] + extents[shape].half[along]);
    Float4 center[2], half[2];
    for (int r = 0; r < 2; ++r) {
      center[r] = splat(sorted_.center[r][i]);
      half[r] = splat(sorted_.half[r][i]);
    }
    for (int32_t k = i + 1; k < count; k += kFloat4Lanes) {
      const Int4 begun = load4(sorted_.low + k) < high;
      Int4 both = begun;
      for (int r = 0; r < 2; ++r)
        both &= abs(load4(sorted_.center[r] + k) - center[r]) < load4(sorted_.half[r] + k) + half[r];
      for (uint32_t bits = bits_of(both); bits != 0; bits &= bits - 1)
        meet(shape, sorted_.shape[k + std::countr_zero(bits)]);
      if (bits_of(begun) != 15) break;
    }
  }
  return meet_;
}

}  // namespace rdm
