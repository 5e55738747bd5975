// OctoMap's tree, made quiet, with a count of its memory; for lib/sense/occupancy*.cpp alone.
//
// OctoMap reports to the console from within its headers; the library may not, so its reports are taken out
// before the tree is read.
#pragma once
#include <octomap/octomap_types.h>
#undef OCTOMAP_WARNING
#undef OCTOMAP_WARNING_STR
#undef OCTOMAP_ERROR
#undef OCTOMAP_ERROR_STR
#undef OCTOMAP_DEBUG
#undef OCTOMAP_DEBUG_STR
#define OCTOMAP_WARNING(...) ((void)0)
#define OCTOMAP_WARNING_STR(...) ((void)0)
#define OCTOMAP_ERROR(...) ((void)0)
#define OCTOMAP_ERROR_STR(...) ((void)0)
#define OCTOMAP_DEBUG(...) ((void)0)
#define OCTOMAP_DEBUG_STR(...) ((void)0)
#include <octomap/OcTree.h>

#include "sense/cloud/voxel_walk.hpp"
#include "sense/map/occupancy.hpp"

namespace rdm {

using MapNode = octomap::OcTreeNode;
inline constexpr int kMapDepth = 16;
// What the C library's allocator gives for a node, and for the list of its children.
inline constexpr size_t kNodeBytes = 32, kListBytes = 80;

// Every node but the leaves has a list of children; lists are never empty. OctoMap takes memory from operator
// new: where that is refused, std::bad_alloc leaves the nodes that were there as they were.
class MapTree : public octomap::OcTree {
 public:
  explicit MapTree(double resolution) : octomap::OcTree(resolution) {}

  size_t bytes() const { return size() * kNodeBytes + lists_ * kListBytes; }
  MapNode* make_root() {
    root = new MapNode();
    ++tree_size;
    size_changed = true;
    return root;
  }
  MapNode* make_child(MapNode* node, unsigned i) {
    const bool first = !nodeHasChildren(node);
    try {
      MapNode* made = createNodeChild(node, i);
      lists_ += first;
      return made;
    } catch (...) {
      if (first) drop_list(node);
      throw;
    }
  }
  // The child must have none itself.
  void drop_child(MapNode* node, unsigned i) {
    deleteNodeChild(node, i);
    if (nodeHasChildren(node)) return;
    drop_list(node);
    --lists_;
  }
  void drop_root() {
    delete root;
    root = nullptr;
    --tree_size;
    size_changed = true;
  }
  // The child, or null.
  MapNode* child(MapNode* node, unsigned i) const {
    return nodeChildExists(node, i) ? getNodeChild(node, i) : nullptr;
  }
  const MapNode* child(const MapNode* node, unsigned i) const {
    return nodeChildExists(node, i) ? getNodeChild(node, i) : nullptr;
  }
  void split(MapNode* node) {
    for (unsigned i = 0; i < 8; ++i) try {
        make_child(node, i)->copyData(*node);
      } catch (...) {
        while (i > 0) drop_child(node, --i);
        throw;
      }
  }
  bool join(MapNode* node) {
    if (!pruneNode(node)) return false;
    --lists_;
    return true;
  }
  void empty() {
    clear();
    lists_ = 0;
  }
  // Which child of a node of depth d the voxel is in.
  static unsigned index(const VoxelKey& key, int d) {
    const int bit = kMapDepth - 1 - d;
    return static_cast<unsigned>((key.k[0] >> bit & 1) | (key.k[1] >> bit & 1) << 1 |
                                 (key.k[2] >> bit & 1) << 2);
  }

 private:
  // OctoMap lets nobody but its own tree at a node's list, and would leak an empty one.
  struct Opened : MapNode {
    static auto list() { return &Opened::children; }
  };
  static void drop_list(MapNode* node) {
    auto& list = node->*Opened::list();
    delete[] list;
    list = nullptr;
  }
  size_t lists_ = 0;
};

// Finds leaves one after the other; what two voxels have in common of the way down is gone once. To be thrown
// away when the tree changes.
class MapCursor {
 public:
  explicit MapCursor(const MapTree& tree) : tree_(tree) { path_[0] = tree.getRoot(); }

  // The leaf that holds the voxel, or null: unknown.
  const MapNode* leaf(const VoxelKey& key) {
    if (!path_[0]) return nullptr;
    const int32_t change = (key.k[0] ^ last_.k[0]) | (key.k[1] ^ last_.k[1]) | (key.k[2] ^ last_.k[2]);
    const int common =
        change ? __builtin_clz(static_cast<unsigned>(change)) - (31 - kMapDepth) - 1 : kMapDepth;
    int d = common < depth_ ? common : depth_;
    last_ = key;
    for (; d < kMapDepth; ++d) {
      const unsigned i = MapTree::index(key, d);
      if (!tree_.nodeChildExists(path_[d], i)) {
        depth_ = d;
        return tree_.nodeHasChildren(path_[d]) ? nullptr : path_[d];
      }
      path_[d + 1] = tree_.getNodeChild(path_[d], i);
    }
    depth_ = d;
    return path_[d];
  }

 private:
  const MapTree& tree_;
  const MapNode* path_[kMapDepth + 1] = {};
  VoxelKey last_ = {{0, 0, 0}};
  int depth_ = 0;  // of the last node on the path
};

// A cube of the tree on the way down: the key of its lowest voxel and its depth.
struct MapCube {
  VoxelKey key;
  int depth = 0;

  int32_t voxels() const { return 1 << (kMapDepth - depth); }  // along a side
  MapCube child(unsigned i) const {
    const int32_t half = voxels() / 2;
    return {{{key.k[0] + (i & 1 ? half : 0), key.k[1] + (i & 2 ? half : 0), key.k[2] + (i & 4 ? half : 0)}},
            depth + 1};
  }
  Vec3 low(const VoxelLattice& l) const { return {l.low(key.k[0]), l.low(key.k[1]), l.low(key.k[2])}; }
  double side(const VoxelLattice& l) const { return voxels() * l.size; }
};

}  // namespace rdm
