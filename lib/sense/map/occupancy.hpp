// A map of what is occupied, free and unknown in space, made of scans: OctoMap's tree of voxels with a bound
// on its memory. Nothing of OctoMap is seen here; nothing is printed.
#pragma once
#include <cstdint>
#include <type_traits>

#include "base/arena.hpp"
#include "base/file.hpp"
#include "base/vec.hpp"
#include "sense/cloud/key_set.hpp"

namespace rdm {

struct OccupancyConfig {
  double resolution = 0.02;   // side of a voxel, m, 0.001 to 10
  size_t memory = 64u << 20;  // bytes of tree and workspace at most, 1 MiB to 64 GiB
  double max_range = 4;       // m: longer rays clear the way so far and say no more; 0: none is too long
  double hit = 0.7,
         miss = 0.4;  // probability that a voxel is occupied, given a ray that ends or passes there
  double low = 0.1192, high = 0.971;  // probabilities are kept between these
  double threshold = 0.5;             // occupied from here on
};

struct OccupancyInfo {
  double resolution = 0;
  size_t nodes = 0, bytes = 0, bytes_max = 0;  // of the tree
  uint64_t dropped = 0;                        // updates that found no memory, since create or clear
};

struct OccupiedVoxel {
  Vec3 centre;
  double side = 0;  // a multiple of the resolution where the tree has joined voxels
};

enum class MapFormat { kBinary, kFull };  // .bt: occupied or free; .ot: the probabilities too

class MapTree;

// One writer at a time; const members may run on any number of threads while nobody writes.
class Occupancy {
 public:
  // Error(kRange) for a config outside the bounds above.
  static Occupancy* create(const OccupancyConfig& config, const HostHooks& hooks);
  static void destroy(Occupancy* map);

  // One scan: rays from `origin` to points [count][3], m. Each voxel changes once: occupied where a ray ends,
  // free where rays only pass. Points that are not finite are left out. Returns how many voxels found no
  // memory; they are left out, those that exist go on being updated. Error(kArgument) when origin is not
  // finite, kRange when it lies outside the lattice of 65536 voxels a side.
  uint64_t insert(const Vec3& origin, const float* points, size_t count);
  // Gives back the memory that insert works with, some quarter of the map's: there are no more inserts (kState).
  void end_inserts();
  void clear();

  // Probability that the voxel of each point [count][3] is occupied; -1: unknown.
  void query(const float* points, size_t count, float* probability) const;
  float at(const Vec3& p) const;
  // visit(voxel) for the occupied voxels that meet the box.
  template <class Visit>
  void box(const Vec3& low, const Vec3& high, Visit&& visit) const {
    each_in_box(
        low, high,
        [](void* context, const OccupiedVoxel& v) {
          (*static_cast<std::remove_reference_t<Visit>*>(context))(v);
        },
        &visit);
  }
  // True when an occupied voxel meets the turned box of half sizes `half` at X_WB.
  bool meets_box(const Pose& X_WB, const Vec3& half) const;
  // The first occupied voxel on the way from `from` along `direction` (any length) up to `range` m, and where
  // the ray enters it. Unknown voxels stop the ray unless `through_unknown`.
  bool cast(const Vec3& from, const Vec3& direction, double range, bool through_unknown, Vec3* hit) const;
  // Distance from p to the nearest point of an occupied voxel, m; `most` when there is none so near.
  double distance(const Vec3& p, double most) const;
  // States at the centres of a grid of n[0] x n[1] x n[2] cells of `side` m about the frame G, x outermost:
  // 1 occupied, 0 free, -1 unknown.
  void grid(const Pose& X_WG, const int32_t n[3], double side, int8_t* out) const;

  // The map as OctoMap's own programs read and write it.
  void write(MapFormat format, Vector<unsigned char>& out) const;
  // Takes both formats and the file's resolution; on an error (kFormat, or kMemory when the map does not fit)
  // nothing changes.
  void read(const void* bytes, size_t size);
  FileLimits file_limits() const;  // of files that read() may take: Error(kMemory) beyond

  OccupancyInfo info() const;

 private:
  void each_in_box(const Vec3& low, const Vec3& high, void (*visit)(void*, const OccupiedVoxel&),
                   void* context) const;
  void apply(size_t begin, size_t end, float change);
  bool update(uint64_t key, float change);
  HostHooks hooks_;
  Arena arena_;
  MapTree* tree_ = nullptr;
  KeySet set_;
  double max_range_ = 0;
  float hit_ = 0, miss_ = 0, low_ = 0, high_ = 0, threshold_log_ = 0;  // log-odds
  size_t bytes_max_ = 0;
  uint64_t dropped_ = 0;
};

}  // namespace rdm
