#include "sense/cloud/furthest.hpp"

#include <algorithm>
#include <limits>

#include "base/error.hpp"

namespace rdm {
namespace {

constexpr int32_t kBucket = 16;  // points of a bucket at most
using Node = FurthestScratch::Node;
using Item = FurthestScratch::Item;

// The least power of two of buckets that hold `count` points.
int32_t num_buckets(int32_t count) {
  int32_t buckets = 1;
  while (buckets * kBucket < count) buckets *= 2;
  return buckets;
}

class Sampler {
 public:
  Sampler(const FurthestScratch& s, int32_t count) : s_(s), count_(count), buckets_(num_buckets(count)) {}

  void build(const float* points) {
    for (int32_t i = 0; i < count_; ++i)
      s_.items[i] = {{points[3 * i], points[3 * i + 1], points[3 * i + 2]}, i};
    build(1, 0, count_, 0, buckets_);
  }

  int32_t place_of(int32_t point) const {
    int32_t at = 0;
    while (s_.index[at] != point || s_.distance[at] < 0) ++at;
    return at;
  }
  // Takes the point at a place into the chosen ones; returns the place of the one that is then the furthest.
  int32_t choose(int32_t place) {
    p_ = Float4{s_.x[place], s_.y[place], s_.z[place], 0};
    s_.distance[place] = -1;  // behind its equals, which are at 0
    update(1);
    return s_.nodes[1].at;
  }

 private:
  // Items [begin, end) into the buckets [bucket, bucket + buckets) of node k: halves along the longest side.
  void build(int32_t k, int32_t begin, int32_t end, int32_t bucket, int32_t buckets) {
    Node& node = s_.nodes[k];
    constexpr float kInf = std::numeric_limits<float>::infinity();
    node.low = splat(kInf);
    node.high = splat(-kInf);
    for (int32_t i = begin; i < end; ++i) {
      const float* p = s_.items[i].p;
      const Float4 v{p[0], p[1], p[2], 0};
      node.low = min(node.low, v);
      node.high = max(node.high, v);
    }
    node.best = begin < end ? kInf : -1;
    node.at = bucket * kBucket;
    if (buckets == 1) return fill(begin, end, bucket);
    const Float4 side = node.high - node.low;
    const int axis = side[0] >= side[1] ? (side[0] >= side[2] ? 0 : 2) : side[1] >= side[2] ? 1 : 2;
    const int32_t middle = begin + (end - begin) / 2;
    std::nth_element(s_.items + begin, s_.items + middle, s_.items + end,
                     [axis](const Item& a, const Item& b) {
                       return a.p[axis] < b.p[axis] || (a.p[axis] == b.p[axis] && a.index < b.index);
                     });
    build(2 * k, begin, middle, bucket, buckets / 2);
    build(2 * k + 1, middle, end, bucket + buckets / 2, buckets / 2);
  }

  void fill(int32_t begin, int32_t end, int32_t bucket) {
    std::sort(s_.items + begin, s_.items + end,
              [](const Item& a, const Item& b) { return a.index < b.index; });
    const int32_t at = bucket * kBucket;
    for (int32_t i = 0; i < kBucket; ++i) {
      const bool real = begin + i < end;
      const Item item = real ? s_.items[begin + i] : Item{{0, 0, 0}, 0};
      s_.x[at + i] = item.p[0];
      s_.y[at + i] = item.p[1];
      s_.z[at + i] = item.p[2];
      s_.index[at + i] = item.index;
      s_.distance[at + i] = real ? std::numeric_limits<float>::infinity() : -1;
    }
  }

  bool in_reach(const Node& node) const {
    const Float4 gap = max(max(node.low - p_, p_ - node.high), splat(0));
    const Float4 square = gap * gap;
    return square[0] + square[1] + square[2] <=
           node.best;  // equal: the node of a chosen point and its equals
  }

  // After a child or a bucket has changed.
  void update(int32_t k) {
    Node& node = s_.nodes[k];
    if (k >= buckets_) return update_bucket(node, (k - buckets_) * kBucket);
    const Node *a = &s_.nodes[2 * k], *b = a + 1;
    if (in_reach(*a)) update(2 * k);
    if (in_reach(*b)) update(2 * k + 1);
    const bool second = b->best > a->best || (b->best == a->best && s_.index[b->at] < s_.index[a->at]);
    node.best = second ? b->best : a->best;
    node.at = second ? b->at : a->at;
  }

  void update_bucket(Node& node, int32_t at) {
    const Float4 px = splat(p_[0]), py = splat(p_[1]), pz = splat(p_[2]);
    Float4 most = splat(-1);
    for (int32_t i = at; i < at + kBucket; i += kFloat4Lanes) {
      const Float4 dx = load4(s_.x + i) - px, dy = load4(s_.y + i) - py, dz = load4(s_.z + i) - pz;
      const Float4 d = min(load4(s_.distance + i), dx * dx + dy * dy + dz * dz);
      store4(s_.distance + i, d);
      most = max(most, d);
    }
    node.best = largest(most);
    int32_t i = at;
    while (s_.distance[i] != node.best) ++i;
    node.at = i;
  }

  const FurthestScratch& s_;
  int32_t count_, buckets_;
  Float4 p_{};
};

}  // namespace

FurthestScratch carve_furthest_scratch(Arena& arena, int32_t max_points) {
  if (max_points < 0 || max_points > kMaxCloud)
    fail(Code::kRange, "max_points: %d is outside [0, %d]", max_points, kMaxCloud);
  const auto buckets = static_cast<size_t>(num_buckets(max_points)), places = buckets * kBucket;
  FurthestScratch s;
  s.max_points = max_points;
  s.items = arena.make<Item>(static_cast<size_t>(max_points));
  s.nodes = arena.make<Node>(2 * buckets);
  s.x = arena.make<float>(places);
  s.y = arena.make<float>(places);
  s.z = arena.make<float>(places);
  s.distance = arena.make<float>(places);
  s.index = arena.make<int32_t>(places);
  return s;
}

void sample_furthest(const float* points, int32_t count, int32_t wanted, int32_t start,
                     const FurthestScratch& scratch, int32_t* chosen) {
  if (count < 1 || count > scratch.max_points)
    fail(Code::kRange, "count: %d is outside [1, %d]", count, scratch.max_points);
  if (wanted < 1 || wanted > count) fail(Code::kRange, "wanted: %d is outside [1, %d]", wanted, count);
  if (start < 0 || start >= count) fail(Code::kRange, "start: %d is outside [0, %d)", start, count);
  Sampler sampler(scratch, count);
  sampler.build(points);
  chosen[0] = start;
  int32_t place = sampler.place_of(start);
  for (int32_t i = 1; i < wanted; ++i) {
    place = sampler.choose(place);
    chosen[i] = scratch.index[place];
  }
}

}  // namespace rdm
