// redman/map.hpp: the owner of a map. C++17, experimental.
//
//   redman::Map map(redman::map_config(0.02));
//   map.scan(pool, 0, "top", 96, 96);
//   if (map.meets(pose, half)) ...
#ifndef REDMAN_MAP_HPP
#define REDMAN_MAP_HPP
#include <redman/map.h>

#include <redman/pool.hpp>

namespace redman {

// The defaults of rdm_map_config_init with a resolution, m.
inline rdm_map_config map_config(double resolution) {
  rdm_map_config c;
  check(rdm_map_config_init(&c, sizeof c));
  c.resolution = resolution;
  return c;
}

class Map {
 public:
  explicit Map(const rdm_map_config& config) : handle_(made(rdm_map_create, &config)) {}
  rdm_map* get() const { return handle_.get(); }
  rdm_map_info info() const {
    auto i = sized<rdm_map_info>();
    check(rdm_map_get_info(get(), &i));
    return i;
  }
  void clear() { check(rdm_map_clear(get())); }
  // Both return the number of voxels that found no memory.
  uint64_t insert(const float origin[3], const float* points, size_t count) {
    uint64_t dropped = 0;
    check(rdm_map_insert(get(), origin, points, count, &dropped));
    return dropped;
  }
  uint64_t scan(const Pool& pool, int32_t env, const char* camera, int32_t w, int32_t h,
                const std::vector<int32_t>& skip = {}) {
    uint64_t dropped = 0;
    check(rdm_map_scan(get(), pool.get(), env, camera, w, h, skip.data(), skip.size(), &dropped));
    return dropped;
  }
  // For one point [3] each; the C functions take many.
  float query(const float point[3]) const {
    float probability = 0;
    check(rdm_map_get_probabilities(get(), point, 1, &probability));
    return probability;
  }
  float distance(const float point[3], float most) const {
    float d = 0;
    check(rdm_map_get_distances(get(), point, 1, most, &d));
    return d;
  }
  std::vector<rdm_voxel> box(const float low[3], const float high[3]) const {
    size_t count = 0;
    check(rdm_map_get_voxels(get(), low, high, nullptr, 0, &count));
    std::vector<rdm_voxel> out(count);
    check(rdm_map_get_voxels(get(), low, high, out.data(), out.size(), &count));
    return out;
  }
  bool meets(const rdm_pose& pose, const float half[3]) const {
    int32_t yes = 0;
    check(rdm_map_meets(get(), &pose, half, &yes));
    return yes != 0;
  }
  // True when an occupied voxel is hit; `hit` is then the point of entry.
  bool raycast(const float origin[3], const float direction[3], float range, float hit[3],
               bool through_unknown = false) const {
    int32_t found = 0;
    check(rdm_map_raycast(get(), origin, direction, range, through_unknown, hit, &found));
    return found != 0;
  }
  // RDM_MAP_BINARY or RDM_MAP_FULL: the bytes of a file.
  Bytes save(int32_t format) const {
    size_t size = 0;
    check(rdm_map_write(get(), format, nullptr, 0, &size));
    Bytes bytes(size);
    check(rdm_map_write(get(), format, bytes.data(), bytes.size(), &size));
    return bytes;
  }
  void load(const Bytes& bytes) { check(rdm_map_read(get(), bytes.data(), bytes.size())); }
  void save_file(const char* path) const { check(rdm_map_write_file(get(), path)); }
  void load_file(const char* path) { check(rdm_map_read_file(get(), path)); }

 private:
  Handle<rdm_map, rdm_map_destroy> handle_;
};

}  // namespace redman
#endif
