// Map files (.bt and .ot): what loads answers every question; what does not load leaves the map as it was.
#include <redman/map.h>

#include "fuzz.hpp"

namespace hard {
namespace {

rdm_map* make_map() {
  rdm_map_config c;
  rdm_map_config_init(&c, sizeof c);
  c.resolution = 0.1;
  c.memory = 1 << 20;
  rdm_map* m = nullptr;
  HARD_REQUIRE(rdm_map_create(&m, &c) == RDM_OK, "%s", rdm_last_error());
  return m;
}

void fill(rdm_map* m, int count) {
  std::vector<float> points;
  for (int i = 0; i < 3 * count; ++i) points.push_back(static_cast<float>((i * 37) % 23) * 0.05f);
  const float origin[3] = {0, 0, 1};
  HARD_REQUIRE(rdm_map_insert(m, origin, points.data(), static_cast<size_t>(count), nullptr) == RDM_OK, "%s",
               rdm_last_error());
}

Bytes saved(const rdm_map* m, int32_t format) {
  size_t n = 0;
  HARD_REQUIRE(rdm_map_write(m, format, nullptr, 0, &n) == RDM_OK, "%s", rdm_last_error());
  Bytes out(n);
  HARD_REQUIRE(rdm_map_write(m, format, out.data(), n, &n) == RDM_OK, "%s", rdm_last_error());
  return out;
}

}  // namespace

std::vector<Bytes> seeds() {
  std::vector<Bytes> out;
  for (int count : {0, 1, 8}) {
    rdm_map* m = make_map();
    if (count) fill(m, count);
    out.push_back(saved(m, RDM_MAP_BINARY));
    out.push_back(saved(m, RDM_MAP_FULL));
    rdm_map_destroy(m);
  }
  return out;
}
void whole(unsigned char*, size_t) {}
size_t fixed_bytes() {
  return 0;
}

void one(const unsigned char* data, size_t size) {
  static rdm_map* m = make_map();
  static const Bytes good = [] {
    fill(m, 4);
    return saved(m, RDM_MAP_FULL);
  }();
  const rdm_result r = rdm_map_read(m, data, size);
  if (r != RDM_OK) {
    require_refusal(r);
    static unsigned n = 0;
    if (++n % 16 == 0) HARD_REQUIRE(saved(m, RDM_MAP_FULL) == good, "a load that failed changed the map");
    return;
  }
  rdm_map_info info{};
  info.struct_size = sizeof info;
  HARD_REQUIRE(rdm_map_get_info(m, &info) == RDM_OK && info.bytes <= info.bytes_max, "%llu bytes of %llu",
               static_cast<unsigned long long>(info.bytes), static_cast<unsigned long long>(info.bytes_max));
  const float point[3] = {0.2f, 0.2f, 0.2f}, low[3] = {-1, -1, -1}, high[3] = {2, 2, 2};
  const float half[3] = {1, 1, 1}, down[3] = {0, 0, -1};
  const rdm_pose pose{};
  float p = 0, hit[3], distance = 0;
  rdm_voxel voxel[4];
  size_t n = 0;
  int32_t yes = 0;
  const int32_t cells[3] = {4, 4, 4};
  int8_t grid[64];
  HARD_REQUIRE(rdm_map_get_probabilities(m, point, 1, &p) == RDM_OK && (p == -1 || (p >= 0 && p <= 1)),
               "probability %g", static_cast<double>(p));
  HARD_REQUIRE(rdm_map_get_voxels(m, low, high, voxel, 4, &n) == RDM_OK, "%s", rdm_last_error());
  HARD_REQUIRE(rdm_map_meets(m, &pose, half, &yes) == RDM_OK, "%s", rdm_last_error());
  HARD_REQUIRE(rdm_map_raycast(m, high, down, 3, 1, hit, &yes) == RDM_OK, "%s", rdm_last_error());
  HARD_REQUIRE(rdm_map_get_distances(m, point, 1, 1, &distance) == RDM_OK && std::isfinite(distance), "%s",
               rdm_last_error());
  HARD_REQUIRE(rdm_map_get_grid(m, &pose, cells, 0.1f, grid) == RDM_OK, "%s", rdm_last_error());
  const Bytes again = saved(m, RDM_MAP_FULL);
  HARD_REQUIRE(rdm_map_read(m, again.data(), again.size()) == RDM_OK, "a saved map does not load: %s",
               rdm_last_error());
  HARD_REQUIRE(rdm_map_read(m, good.data(), good.size()) == RDM_OK, "%s", rdm_last_error());
}

}  // namespace hard
