// Log-odds occupancy maps over OctoMap's octree (Moravec and Elfes, "High resolution maps from wide angle
// sonar", 1985; Hornung et al., "OctoMap: an efficient probabilistic 3D mapping framework based on octrees",
// 2013).
//
// A voxel's belief is l = log(p / (1 - p)), and the readings of it count as independent, so that Bayes' rule
// is a sum (Hornung et al., eq. 2 to 4):
//   l <- clamp(l + log(p_z / (1 - p_z)), l_low, l_high),  p_z = hit where a ray ends, miss where one passes.
// The bounds keep the map able to change its mind, and make regions equal, which the tree joins: a leaf of
// depth d stands for 8^(16 - d) voxels, an inner node for the largest value below it, so that a search for
// what is occupied leaves out whatever branch is below the threshold.
//
// insert: in each scan a voxel changes once; ends of rays first, then what the rays passed (Amanatides and
// Woo's walk, voxel_walk.hpp), less the ends. update: down to the leaf, split or made as need be, and up
// again: join equal children, else take their largest value. Queries go down from the root and leave out what
// cannot meet them: boxes by separating axes (Gottschalk et al., 1996: 3 + 3 face normals and 9 products of
// edges), the nearest voxel by branch and bound, rays by the same walk as scans.
#include "sense/map/occupancy.hpp"

#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"
#include "base/error.hpp"
#include "base/text.hpp"
#include "sense/map/occupancy_tree.hpp"

namespace rdm {
namespace {

constexpr uint64_t kMinMemory = 1u << 20, kMaxMemory = uint64_t{64} << 30;  // bytes; more than 32 bits hold
// The workspace takes about a quarter of the memory, and never more than this many voxels of a scan.
constexpr size_t kBytesPerKey = 40, kMaxKeys = 1u << 22;

float log_odds(double p) {
  return static_cast<float>(elementary::log(p / (1 - p)));
}

void check_range(const char* name, double v, double low, double high) {
  if (!(v >= low && v <= high))
    fail(Code::kRange, "%s: %s is outside [%s, %s]", name, Number(v).text, Number(low).text,
         Number(high).text);
}

void check(const OccupancyConfig& c) {
  check_range("resolution", c.resolution, 0.001, 10);
  const uint64_t memory = c.memory;  // a size_t, which may have 32 bits
  if (memory < kMinMemory || memory > kMaxMemory)
    fail(Code::kRange, "memory: %llu is outside [%llu, %llu]", static_cast<unsigned long long>(memory),
         static_cast<unsigned long long>(kMinMemory), static_cast<unsigned long long>(kMaxMemory));
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

void Occupancy::end_inserts() {
  set_ = KeySet();
  arena_ = Arena();
}

uint64_t Occupancy::insert(const Vec3& origin, const float* points, size_t count) {
  if (set_.capacity() == 0) fail(Code::kState, "insert: the map no longer takes inserts");
  const VoxelLattice lattice(tree_->getResolution());
  VoxelKey key;
  if (!finite(origin)) fail(Code::kArgument, "origin is not finite");
  if (!lattice.key(origin, &key))
    fail(Code::kRange, "origin: (%g, %g, %g) lies outside the map, which has %d voxels on each side",
         origin.x, origin.y, origin.z, kKeyCount);
  const uint64_t before = dropped_;
  const auto point = [&](size_t i) { return Vec3{points[3 * i], points[3 * i + 1], points[3 * i + 2]}; };
  const auto near = [&](const Vec3& p) { return max_range_ == 0 || norm(p - origin) <= max_range_; };
  // what a depth of 0 becomes, a sensor's word for nothing, and what no ray leads to
  const auto at_eye = [&](const Vec3& p) { return norm(p - origin) < tree_->getResolution(); };
  for (size_t begin = 0, end = 0; begin < count; begin = end) {
    // ends of rays first: what is occupied in this scan is not free in it
    set_.shrink(0);
    for (; end < count && set_.size() < set_.capacity() / 2; ++end)
      if (const Vec3 p = point(end); lattice.key(p, &key) && near(p) && !at_eye(p)) set_.add(pack(key));
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
      if (!finite(p) || at_eye(p)) continue;
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

// ---- what the map knows: points, boxes, rays, distances, grids ----

namespace {

constexpr MapCube kWhole{{{0, 0, 0}}, 0};

// Goes through the leaves at or above `threshold` whose cubes pass enter(cube), nearest to nothing in
// particular; visit(cube) returns false to end it all.
template <class Enter, class Visit>
bool each_occupied(const MapTree& tree, float threshold, const MapNode* node, const MapCube& cube,
                   const Enter& enter, const Visit& visit) {
  // a node's value is the largest of its children's
  if (node->getLogOdds() < threshold || !enter(cube)) return true;
  if (!tree.nodeHasChildren(node)) return visit(cube);
  for (unsigned i = 0; i < 8; ++i)
    if (const MapNode* next = tree.child(node, i))
      if (!each_occupied(tree, threshold, next, cube.child(i), enter, visit)) return false;
  return true;
}

float probability_of(float log_odds) {
  return static_cast<float>(1 / (1 + elementary::exp(-static_cast<double>(log_odds))));
}

double square(double v) {
  return v * v;
}

double square_distance(const Vec3& p, const Vec3& low, double side) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) sum += square(std::max({low[i] - p[i], p[i] - (low[i] + side), 0.0}));
  return sum;
}

// The nearest occupied leaf, near branches first: `best` is the square of the smallest distance so far.
void search_nearest(const MapTree& tree, const VoxelLattice& lattice, float threshold, const MapNode* node,
                    const MapCube& cube, const Vec3& p, double* best) {
  struct Branch {
    double distance;
    const MapNode* node;
    unsigned i;
  } branches[8];
  int count = 0;
  for (unsigned i = 0; i < 8; ++i) {
    const MapNode* next = tree.child(node, i);
    if (!next || next->getLogOdds() < threshold) continue;
    const MapCube c = cube.child(i);
    const double distance = square_distance(p, c.low(lattice), c.side(lattice));
    if (distance >= *best) continue;
    int at = count++;
    for (; at > 0 && branches[at - 1].distance > distance; --at) branches[at] = branches[at - 1];
    branches[at] = {distance, next, i};
  }
  for (int k = 0; k < count && branches[k].distance < *best; ++k) {
    if (!tree.nodeHasChildren(branches[k].node))
      *best = branches[k].distance;
    else
      search_nearest(tree, lattice, threshold, branches[k].node, cube.child(branches[k].i), p, best);
  }
}

// Separating axes of a cube and a turned box: 15 candidates, the same for all cubes of the map.
class TurnedBox {
 public:
  TurnedBox(const Pose& X_WB, const Vec3& half) : p_(X_WB.p) {
    const Mat3 R = to_matrix(X_WB.q);
    const auto add = [&](const Vec3& axis, double reach) {
      axes_[count_++] = {axis, std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z), reach};
    };
    const auto reach_along = [&](const Vec3& axis) {
      double reach = 0;
      for (int k = 0; k < 3; ++k) reach += half[k] * std::abs(dot(axis, R.col(k)));
      return reach;
    };
    Vec3 units[3];
    for (int i = 0; i < 3; ++i) {
      units[i][i] = 1;
      add(units[i], reach_along(units[i]));
    }
    for (int j = 0; j < 3; ++j) add(R.col(j), half[j]);
    for (const Vec3& unit : units)
      for (int j = 0; j < 3; ++j) {
        const Vec3 axis = cross(unit, R.col(j));
        if (dot(axis, axis) >= 1e-12) add(axis, reach_along(axis));
      }
  }
  bool meets(const Vec3& low, double side) const {
    const double h = 0.5 * side;
    const Vec3 d = p_ - (low + Vec3{h, h, h});
    if (std::abs(d.x) <= h && std::abs(d.y) <= h && std::abs(d.z) <= h) return true;  // holds the middle
    for (int i = 0; i < count_; ++i)
      if (std::abs(dot(d, axes_[i].n)) > h * axes_[i].cube + axes_[i].reach) return false;
    return true;
  }

 private:
  struct Axis {
    Vec3 n;              // of any length
    double cube, reach;  // of a cube of half a side of one, and of the box
  };
  Vec3 p_;
  Axis axes_[15];
  int count_ = 0;
};

}  // namespace

float Occupancy::at(const Vec3& p) const {
  const VoxelLattice lattice(tree_->getResolution());
  VoxelKey key;
  const MapNode* leaf = lattice.key(p, &key) ? MapCursor(*tree_).leaf(key) : nullptr;
  return leaf ? probability_of(leaf->getLogOdds()) : -1;
}

void Occupancy::query(const float* points, size_t count, float* probability) const {
  const VoxelLattice lattice(tree_->getResolution());
  MapCursor cursor(*tree_);
  float last = 0, known = 0.5f;  // most voxels hold one of few values
  for (size_t i = 0; i < count; ++i, points += 3) {
    VoxelKey key;
    const MapNode* leaf = lattice.key({points[0], points[1], points[2]}, &key) ? cursor.leaf(key) : nullptr;
    if (leaf && leaf->getLogOdds() != last) {
      last = leaf->getLogOdds();
      known = probability_of(last);
    }
    probability[i] = leaf ? known : -1;
  }
}

void Occupancy::each_in_box(const Vec3& low, const Vec3& high, void (*visit)(void*, const OccupiedVoxel&),
                            void* context) const {
  const VoxelLattice lattice(tree_->getResolution());
  if (!tree_->getRoot()) return;
  each_occupied(
      *tree_, threshold_log_, tree_->getRoot(), kWhole,
      [&](const MapCube& cube) {
        const Vec3 at = cube.low(lattice);
        const double side = cube.side(lattice);
        for (int i = 0; i < 3; ++i)
          if (at[i] > high[i] || at[i] + side < low[i]) return false;
        return true;
      },
      [&](const MapCube& cube) {
        const double side = cube.side(lattice);
        visit(context, {cube.low(lattice) + 0.5 * Vec3{side, side, side}, side});
        return true;
      });
}

bool Occupancy::meets_box(const Pose& X_WB, const Vec3& half) const {
  const VoxelLattice lattice(tree_->getResolution());
  const TurnedBox turned(X_WB, half);
  if (!tree_->getRoot()) return false;
  return !each_occupied(
      *tree_, threshold_log_, tree_->getRoot(), kWhole,
      [&](const MapCube& cube) { return turned.meets(cube.low(lattice), cube.side(lattice)); },
      [](const MapCube&) { return false; });
}

bool Occupancy::cast(const Vec3& from, const Vec3& direction, double range, bool through_unknown,
                     Vec3* hit) const {
  const VoxelLattice lattice(tree_->getResolution());
  const double length = norm(direction);
  if (!finite(from) || !(length > 0) || !std::isfinite(length))
    fail(Code::kArgument, "direction: its length is %g", length);
  if (!(range > 0)) fail(Code::kRange, "range: %g is not positive", range);
  const double bound = VoxelLattice::kMiddle * lattice.size;
  const Vec3 unit = (1 / length) * direction;
  for (int i = 0; i < 3; ++i) {  // up to the border of the lattice
    if (std::abs(from[i]) >= bound)
      fail(Code::kRange, "from: it lies outside the map, which reaches %g m", bound);
    if (unit[i] != 0)
      range = std::min(range, (bound - (unit[i] > 0 ? from[i] : -from[i])) / std::abs(unit[i]) * (1 - 1e-12));
  }
  bool found = false;
  MapCursor cursor(*tree_);
  walk_voxels(lattice, from, from + range * unit, [&](const VoxelKey& key, double t) {
    const MapNode* leaf = cursor.leaf(key);
    if (!leaf) return through_unknown;
    if (leaf->getLogOdds() < threshold_log_) return true;
    found = true;
    *hit = from + t * range * unit;
    return false;
  });
  return found;
}

double Occupancy::distance(const Vec3& p, double most) const {
  const MapNode* root = tree_->getRoot();
  if (!finite(p)) fail(Code::kArgument, "a point is not finite");
  if (!root || root->getLogOdds() < threshold_log_) return most;
  double best = most * most;
  search_nearest(*tree_, VoxelLattice(tree_->getResolution()), threshold_log_, root, kWhole, p, &best);
  return best < most * most ? std::sqrt(best) : most;
}

void Occupancy::grid(const Pose& X_WG, const int32_t n[3], double side, int8_t* out) const {
  const VoxelLattice lattice(tree_->getResolution());
  const Mat3 R = to_matrix(X_WG.q);
  MapCursor cursor(*tree_);
  const auto middle = [&](int axis, int32_t i) { return (i + 0.5 - 0.5 * n[axis]) * side; };
  for (int32_t x = 0; x < n[0]; ++x)
    for (int32_t y = 0; y < n[1]; ++y)
      for (int32_t z = 0; z < n[2]; ++z) {
        VoxelKey key;
        const Vec3 p = X_WG.p + R * Vec3{middle(0, x), middle(1, y), middle(2, z)};
        const MapNode* leaf = lattice.key(p, &key) ? cursor.leaf(key) : nullptr;
        *out++ = static_cast<int8_t>(!leaf ? -1 : leaf->getLogOdds() >= threshold_log_);
      }
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
