// What a map knows: points, boxes, rays, distances, grids.
#include <algorithm>
#include <cmath>

#include "base/elementary.hpp"
#include "base/error.hpp"
#include "sense/map/occupancy_tree.hpp"

namespace rdm {
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

// Separating axes of a cube and a turned box: 15 candidates.
class TurnedBox {
 public:
  TurnedBox(const Pose& X_WB, const Vec3& half) : R_(to_matrix(X_WB.q)), p_(X_WB.p), half_(half) {}
  bool meets(const Vec3& low, double side) const {
    const double h = 0.5 * side;
    const Vec3 d = p_ - (low + Vec3{h, h, h});
    for (int i = 0; i < 3; ++i) {
      const double reach =
          std::abs(R_(i, 0)) * half_.x + std::abs(R_(i, 1)) * half_.y + std::abs(R_(i, 2)) * half_.z;
      if (std::abs(d[i]) > h + reach) return false;
    }
    for (int j = 0; j < 3; ++j) {
      const Vec3 axis = R_.col(j);
      const double cube = h * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
      if (std::abs(dot(d, axis)) > cube + half_[j]) return false;
    }
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        Vec3 unit;
        unit[i] = 1;
        const Vec3 axis = cross(unit, R_.col(j));
        if (dot(axis, axis) < 1e-12) continue;
        const double cube = h * (std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z));
        double reach = 0;
        for (int k = 0; k < 3; ++k) reach += half_[k] * std::abs(dot(axis, R_.col(k)));
        if (std::abs(dot(d, axis)) > cube + reach) return false;
      }
    return true;
  }

 private:
  Mat3 R_;
  Vec3 p_, half_;
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
    fail(Code::kArgument, "direction: of length %g", length);
  if (!(range > 0)) fail(Code::kRange, "range: %g is not positive", range);
  const double bound = kKeyCount / 2 * lattice.size;
  const Vec3 unit = (1 / length) * direction;
  for (int i = 0; i < 3; ++i) {  // up to the border of the lattice
    if (std::abs(from[i]) >= bound) fail(Code::kRange, "from: outside the lattice of %g m", bound);
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

}  // namespace rdm
