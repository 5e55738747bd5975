// rdm_map_*: occupancy maps.
#include <algorithm>

#include "base/file.hpp"
#include "capi/handles.hpp"
#include "capi/pose.hpp"

#if RDM_WITH_SIM
#include "base/text.hpp"
#include "sense/map/occupancy.hpp"
#include "sense/scene_shapes.hpp"

using namespace rdm;
using namespace rdm::capi;

struct rdm_map {
  static constexpr Tag kTag = Tag::kMap;
  static constexpr bool kOneAtATime = false;
  Tag tag = kTag;
  mutable InUse in_use;
  HostHooks hooks;
  char error[kErrorTextSize] = "";
  Occupancy* map = nullptr;
};

namespace {

constexpr size_t kFirstSize = offsetof(rdm_map_config, error);  // of a config

rdm_map_config default_config() {
  const OccupancyConfig d;
  rdm_map_config c{};
  c.resolution = d.resolution;
  c.memory = d.memory;
  c.max_range = d.max_range;
  c.hit = d.hit;
  c.miss = d.miss;
  c.low = d.low;
  c.high = d.high;
  c.threshold = d.threshold;
  return c;
}

Vec3 to_vec(const float v[3]) {
  return {v[0], v[1], v[2]};
}
void to_floats(const Vec3& v, float out[3]) {
  for (int k = 0; k < 3; ++k) out[k] = static_cast<float>(v[k]);
}

void need_points(const float* points, size_t count, const char* name) {
  if (count > 0) need(points, name);
  if (count > SIZE_MAX / 16) fail(Code::kRange, "count: %zu is too large", count);
}

void need_finite_points(const float* points, size_t count) {
  for (size_t i = 0; i < 3 * count; ++i)
    if (!std::isfinite(points[i])) fail(Code::kArgument, "points: point %zu is not finite", i / 3);
}

MapFormat format_of(const char* path) {
  const size_t n = std::strlen(path);
  if (n >= 3 && same_name(path + n - 3, ".bt")) return MapFormat::kBinary;
  if (n >= 3 && same_name(path + n - 3, ".ot")) return MapFormat::kFull;
  fail(Code::kArgument, "path: %s ends neither in .bt nor in .ot", Quoted(path).text);
}

}  // namespace

rdm_result rdm_map_config_init(rdm_map_config* c, size_t size) {
  return call([&] { init_struct(c, size, kFirstSize, default_config(), "c"); });
}

rdm_result rdm_map_create(rdm_map** out, const rdm_map_config* c) {
  return call_with(c, [&] {
    need(out, "out");
    const auto in = read_struct(c, kFirstSize, default_config(), "config");
    check_error(in);
    OccupancyConfig config;
    config.resolution = in.resolution;
    config.memory = static_cast<size_t>(std::min<uint64_t>(in.memory, SIZE_MAX));
    config.max_range = in.max_range;
    config.hit = in.hit;
    config.miss = in.miss;
    config.low = in.low;
    config.high = in.high;
    config.threshold = in.threshold;
    const HostHooks hooks = hooks_from(in.host);
    rdm_map* m = host_new<rdm_map>(hooks);
    m->hooks = hooks;
    try {
      m->map = Occupancy::create(config, hooks);
    } catch (...) {
      host_delete(hooks, m);
      throw;
    }
    *out = m;
  });
}

void rdm_map_destroy(rdm_map* m) {
  if (!may_end(m)) return;
  Occupancy::destroy(m->map);
  retire(m);
  host_delete(m->hooks, m);
}

const char* rdm_map_error(const rdm_map* m) {
  return is_handle(m) ? m->error : "map: NULL, not a map, or destroyed";
}

rdm_result rdm_map_get_info(const rdm_map* m, rdm_map_info* io) {
  return call_on(m, [&] {
    const OccupancyInfo i = m->map->info();
    rdm_map_info out{};
    out.full = i.dropped > 0;
    out.resolution = i.resolution;
    out.nodes = i.nodes;
    out.bytes = i.bytes;
    out.bytes_max = i.bytes_max;
    out.dropped = i.dropped;
    write_struct(io, out, sizeof(rdm_map_info), "io");
  });
}

rdm_result rdm_map_clear(rdm_map* m) {
  return call_on(m, [&] { m->map->clear(); });
}

rdm_result rdm_map_insert(rdm_map* m, const float origin[3], const float* points, size_t count,
                          uint64_t* dropped) {
  return call_on(m, [&] {
    need(origin, "origin");
    need_points(points, count, "points");
    const uint64_t lost = m->map->insert(to_vec(origin), points, count);
    if (dropped) *dropped = lost;
  });
}

rdm_result rdm_map_scan(rdm_map* m, rdm_pool* p, int32_t env, const char* camera, int32_t w, int32_t h,
                        const int32_t* skip, size_t num_skip, uint64_t* dropped) {
  return call_on(m, [&] {
    const Use use(p);
    need_index(env, p->pool->config().num_envs, "env");
    if (num_skip > SIZE_MAX / 16) fail(Code::kRange, "num_skip: %zu is too large", num_skip);
    if (num_skip > 0) need(skip, "skip");
    const HostScope scope(m->hooks);
    const Camera eye = pool_camera(p, env, camera);
    const View view = make_view(eye, w, h);
    const size_t pixels = static_cast<size_t>(w) * static_cast<size_t>(h);
    Vector<float> depth(pixels), points;
    Vector<int32_t> segmentation(pixels);
    const int32_t count = gather_shapes(p->pool->world(env), p->shapes);
    for (size_t i = 0; i < num_skip; ++i) need_index(skip[i], count, "skip");
    render(p->shapes, count, eye, {w, h, nullptr, depth.data(), segmentation.data()}, {}, p->raycast);
    points.reserve(3 * pixels);
    for (size_t i = 0; i < pixels; ++i) {
      const int32_t shape = segmentation[i];
      if (shape < 0 || std::find(skip, skip + num_skip, shape) != skip + num_skip) continue;
      const size_t row = i / static_cast<size_t>(w), column = i % static_cast<size_t>(w);
      const Vec3 at = view.point(static_cast<double>(column) + 0.5, static_cast<double>(row) + 0.5, depth[i]);
      for (int k = 0; k < 3; ++k) points.push_back(static_cast<float>(at[k]));
    }
    const uint64_t lost = m->map->insert(eye.eye, points.data(), points.size() / 3);
    if (dropped) *dropped = lost;
  });
}

rdm_result rdm_map_get_probabilities(const rdm_map* m, const float* points, size_t count,
                                     float* probability) {
  return call_on(m, [&] {
    need_points(points, count, "points");
    if (count > 0) need(probability, "probability");
    need_finite_points(points, count);
    m->map->query(points, count, probability);
  });
}

rdm_result rdm_map_get_voxels(const rdm_map* m, const float low[3], const float high[3], rdm_voxel* out,
                              size_t capacity, size_t* count) {
  return call_on(m, [&] {
    need(low, "low");
    need(high, "high");
    need(count, "count");
    if (capacity > 0) need(out, "out");
    for (int k = 0; k < 3; ++k)
      if (!(low[k] <= high[k])) fail(Code::kArgument, "low[%d] is not at or below high[%d]", k, k);
    size_t n = 0;
    m->map->box(to_vec(low), to_vec(high), [&](const OccupiedVoxel& v) {
      if (n < capacity) {
        to_floats(v.centre, out[n].centre);
        out[n].side = static_cast<float>(v.side);
      }
      ++n;
    });
    *count = n;
  });
}

rdm_result rdm_map_meets(const rdm_map* m, const rdm_pose* pose, const float half[3], int32_t* meets) {
  return call_on(m, [&] {
    const Pose at = need_pose(pose, "pose");
    need(half, "half");
    need(meets, "meets");
    for (int k = 0; k < 3; ++k)
      if (!(half[k] >= 0 && half[k] < 1e6f))
        fail(Code::kRange, "half[%d]: %g is outside [0, 1e6)", k, static_cast<double>(half[k]));
    *meets = m->map->meets_box(at, to_vec(half));
  });
}

rdm_result rdm_map_raycast(const rdm_map* m, const float origin[3], const float direction[3], float range,
                           int32_t through_unknown, float hit[3], int32_t* found) {
  return call_on(m, [&] {
    need(origin, "origin");
    need(direction, "direction");
    need(hit, "hit");
    need(found, "found");
    Vec3 at;
    *found = m->map->cast(to_vec(origin), to_vec(direction), range, through_unknown != 0, &at);
    if (*found) to_floats(at, hit);
  });
}

rdm_result rdm_map_get_distances(const rdm_map* m, const float* points, size_t count, float most,
                                 float* distance) {
  return call_on(m, [&] {
    need_points(points, count, "points");
    if (count > 0) need(distance, "distance");
    need_finite_points(points, count);
    if (!(most > 0 && most <= 1e6f))
      fail(Code::kRange, "most: %g is outside (0, 1e6]", static_cast<double>(most));
    for (size_t i = 0; i < count; ++i)
      distance[i] = static_cast<float>(m->map->distance(to_vec(points + 3 * i), most));
  });
}

rdm_result rdm_map_get_grid(const rdm_map* m, const rdm_pose* pose, const int32_t n[3], float side,
                            int8_t* out) {
  return call_on(m, [&] {
    const Pose at = need_pose(pose, "pose");
    need(n, "n");
    need(out, "out");
    for (int k = 0; k < 3; ++k)
      if (n[k] < 1 || n[k] > 1024) fail(Code::kRange, "n[%d]: %d is outside [1, 1024]", k, n[k]);
    if (!(side > 0 && side <= 1e3f))
      fail(Code::kRange, "side: %g is outside (0, 1000]", static_cast<double>(side));
    m->map->grid(at, n, side, out);
  });
}

rdm_result rdm_map_write(const rdm_map* m, int32_t format, void* bytes, size_t capacity, size_t* size) {
  return call_on(m, [&] {
    need(size, "size");
    if (format != RDM_MAP_BINARY && format != RDM_MAP_FULL)
      fail(Code::kRange, "format: %d is outside [0, 1]", format);
    const HostScope scope(m->hooks);
    Vector<unsigned char> file;
    m->map->write(format == RDM_MAP_BINARY ? MapFormat::kBinary : MapFormat::kFull, file);
    if (bytes && capacity < file.size())
      fail(Code::kRange, "capacity: %zu bytes are too few, %zu are needed", capacity, file.size());
    if (bytes) std::copy(file.begin(), file.end(), static_cast<unsigned char*>(bytes));
    *size = file.size();
  });
}

rdm_result rdm_map_write_file(const rdm_map* m, const char* path) {
  return call_on(m, [&] {
    need(path, "path");
    const HostScope scope(m->hooks);
    Vector<unsigned char> file;
    m->map->write(format_of(path), file);
    write_file(path, file.data(), file.size());
  });
}

rdm_result rdm_map_read(rdm_map* m, const void* bytes, size_t size) {
  return call_on(m, [&] {
    need(bytes, "bytes");
    m->map->read(bytes, size);
  });
}

rdm_result rdm_map_read_file(rdm_map* m, const char* path) {
  return call_on(m, [&] {
    need(path, "path");
    const HostScope scope(m->hooks);
    const auto file = read_file(path, m->map->file_limits());
    m->map->read(file.data(), file.size());
  });
}
#endif
