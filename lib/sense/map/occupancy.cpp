#include "sense/map/occupancy.hpp"

#include <algorithm>

#include "base/elementary.hpp"
#include "base/error.hpp"
#include "sense/map/occupancy_tree.hpp"

namespace rdm {
namespace {

constexpr double kMinMemory = 1u << 20, kMaxMemory = 64.0 * (1u << 30);  // bytes; more than 32 bits hold
// The workspace takes about a quarter of the memory, and never more than this many voxels of a scan.
constexpr size_t kBytesPerKey = 40, kMaxKeys = 1u << 22;

float log_odds(double p) {
  return static_cast<float>(elementary::log(p / (1 - p)));
}

void check_range(const char* name, double v, double low, double high) {
  if (!(v >= low && v <= high)) fail(Code::kRange, "%s: %g is outside [%g, %g]", name, v, low, high);
}

void check(const OccupancyConfig& c) {
  check_range("resolution", c.resolution, 0.001, 10);
  check_range("memory", static_cast<double>(c.memory), kMinMemory, kMaxMemory);
  check_range("max_range", c.max_range, 0, 1e6);
  check_range("hit", c.hit, 0.5, 0.999);
  check_range("miss", c.miss, 0.001, 0.5);
  check_range("low", c.low, 0.001, 0.5);
  check_range("high", c.high, 0.5, 0.999);
  check_range("threshold", c.threshold, c.low, c.high);
}

}  // namespace

Occupancy* Occupancy::create(const OccupancyConfig& c, const HostHooks& hooks) {
  check(c);
  const size_t keys = std::min(kMaxKeys, c.memory / 4 / kBytesPerKey);
  Arena measure;
  KeySet(measure, keys);
  Occupancy* map = host_new<Occupancy>(hooks);
  try {
    map->hooks_ = hooks;
    map->arena_ = Arena(hooks, measure.used());
    map->set_ = KeySet(map->arena_, keys);
    map->tree_ = new MapTree(c.resolution);
  } catch (...) {
    host_delete(hooks, map);
    throw;
  }
  map->bytes_max_ = c.memory - measure.used();
  map->max_range_ = c.max_range;
  map->threshold_ = c.threshold;
  map->hit_ = log_odds(c.hit);
  map->miss_ = log_odds(c.miss);
  map->low_ = log_odds(c.low);
  map->high_ = log_odds(c.high);
  map->threshold_log_ = log_odds(c.threshold);
  return map;
}

void Occupancy::destroy(Occupancy* map) {
  if (!map) return;
  delete map->tree_;
  host_delete(map->hooks_, map);
}

void Occupancy::clear() {
  tree_->empty();
  dropped_ = 0;
}

// One voxel's log-odds; the values above it follow. False, and nothing changes, when it needs memory that is
// not the map's to take; std::bad_alloc, and nothing changes, when the machine has none.
bool Occupancy::update(uint64_t packed, float change) {
  const VoxelKey key = unpack(packed);
  MapTree& tree = *tree_;
  MapNode* path[kMapDepth + 1];
  int d = 0;
  path[0] = tree.getRoot();
  if (path[0])
    while (d < kMapDepth && (path[d + 1] = tree.child(path[d], MapTree::index(key, d)))) ++d;
  const bool found = path[0] && (d == kMapDepth || !tree.nodeHasChildren(path[d]));
  const int old = path[0] ? d : -1;  // nodes deeper than this are new
  if (found) {                       // this voxel, or joined ones that hold it
    const float now = path[d]->getLogOdds();
    if (change >= 0 ? now >= high_ : now <= low_) return true;
  }
  if (d < kMapDepth) {
    const auto levels = static_cast<size_t>(kMapDepth - d);
    const size_t nodes = (found ? 8 : 1) * levels + (path[0] ? 0 : 1);
    if (tree.bytes() + nodes * kNodeBytes + levels * kListBytes > bytes_max_) return false;
    if (!path[0]) path[0] = tree.make_root();
    try {
      for (; d < kMapDepth; ++d) {
        const unsigned i = MapTree::index(key, d);
        if (found)
          tree.split(path[d]);
        else
          tree.make_child(path[d], i);
        path[d + 1] = tree.child(path[d], i);
      }
    } catch (...) {  // no memory after all: back to the tree as it was
      while (--d >= std::max(old, 0))
        if (found)
          tree.join(path[d]);
        else
          tree.drop_child(path[d], MapTree::index(key, d));
      if (old < 0) tree.drop_root();
      throw;
    }
  }
  path[d]->setLogOdds(std::clamp(path[d]->getLogOdds() + change, low_, high_));
  while (--d >= 0) {
    if (tree.join(path[d])) continue;
    const float value = path[d]->getMaxChildLogOdds();
    if (d <= old && value == path[d]->getLogOdds()) break;  // nothing changes further up
    path[d]->setLogOdds(value);
  }
  return true;
}

void Occupancy::apply(size_t begin, size_t end, float change) {
  for (size_t i = begin; i < end; ++i) dropped_ += !update(set_[i], change);
}

uint64_t Occupancy::insert(const Vec3& origin, const float* points, size_t count) {
  const VoxelLattice lattice(tree_->getResolution());
  VoxelKey key;
  if (!finite(origin)) fail(Code::kArgument, "origin is not finite");
  if (!lattice.key(origin, &key))
    fail(Code::kRange, "origin: (%g, %g, %g) lies outside the lattice of %d voxels a side", origin.x,
         origin.y, origin.z, kKeyCount);
  const uint64_t before = dropped_;
  const auto point = [&](size_t i) { return Vec3{points[3 * i], points[3 * i + 1], points[3 * i + 2]}; };
  const auto near = [&](const Vec3& p) { return max_range_ == 0 || norm(p - origin) <= max_range_; };
  for (size_t begin = 0, end = 0; begin < count; begin = end) {
    // ends of rays first: what is occupied in this scan is not free in it
    set_.shrink(0);
    for (; end < count && set_.size() < set_.capacity() / 2; ++end)
      if (const Vec3 p = point(end); lattice.key(p, &key) && near(p)) set_.add(pack(key));
    const size_t ends = set_.size();
    apply(0, ends, hit_);
    const auto pass = [&](const VoxelKey& at, double) {
      if (set_.full()) {
        apply(ends, set_.size(), miss_);
        set_.shrink(ends);
      }
      set_.add(pack(at));
      return true;
    };
    for (size_t i = begin; i < end; ++i) {
      Vec3 p = point(i);
      if (!finite(p)) continue;
      if (!near(p)) p = origin + max_range_ / norm(p - origin) * (p - origin);
      VoxelKey last;
      if (!lattice.key(p, &last)) continue;
      walk_voxels(lattice, origin, p, [&](const VoxelKey& at, double t) {
        const bool is_last = at.k[0] == last.k[0] && at.k[1] == last.k[1] && at.k[2] == last.k[2];
        return !is_last && pass(at, t);
      });
    }
    apply(ends, set_.size(), miss_);
  }
  return dropped_ - before;
}

OccupancyInfo Occupancy::info() const {
  OccupancyInfo info;
  info.resolution = tree_->getResolution();
  info.nodes = tree_->size();
  info.bytes = tree_->bytes();
  info.bytes_max = bytes_max_;
  info.dropped = dropped_;
  return info;
}

}  // namespace rdm
