// What the worlds of a pool see, and the sampling of a host's own clouds.
#include <cmath>

#include "capi/handles.hpp"

#if RDM_WITH_SIM
#include "sense/cloud/furthest.hpp"

using namespace rdm;
using namespace rdm::capi;

rdm_result rdm_pool_get_sensors(const rdm_pool* p, rdm_sensors* io) {
  return call_on(p, [&] {
    const SenseConfig& c = p->pool->sense();
    const SenseBuffers& b = p->pool->sensed();
    rdm_sensors s{};
    s.num_cameras = c.num_cameras;
    s.width = c.width;
    s.height = c.height;
    s.num_points = c.num_points;
    s.num_voxels = c.grid;
    s.voxel_size = static_cast<float>(c.cell);
    s.rgb = b.rgb;
    s.depth = b.depth;
    s.segmentation = b.segmentation;
    s.points = b.points;
    s.point_shape = b.point_shape;
    s.point_count = b.point_count;
    s.voxels = b.voxels;
    s.point_class = b.point_class;
    s.point_color = b.point_color;
    s.num_classes = c.points ? point_classes(c, p->pool->task().scene()) : 0;
    write_struct(io, s, kFirstSensorsSize, "io");
  });
}

rdm_result rdm_pool_camera_at(const rdm_pool* p, int32_t i, rdm_camera_info* io) {
  return call_on(p, [&] {
    check_out(io, sizeof(rdm_camera_info), "io");
    const CameraSpec* c = i < 0 ? nullptr : camera_at(task_at(p->pool->task_index()), p->pool->task(), i);
    if (!c) fail(Code::kRange, "i: %d is past the last camera", i);
    write_struct(io, describe(*c), sizeof(rdm_camera_info), "io");
  });
}

rdm_result rdm_pool_sensor_camera_at(const rdm_pool* p, int32_t cloud, int32_t i, rdm_camera_info* io) {
  return call_on(p, [&] {
    check_out(io, sizeof(rdm_camera_info), "io");
    if (cloud < 0 || cloud > 1) fail(Code::kRange, "cloud: %d is outside [0, 1]", cloud);
    const SenseConfig& c = p->pool->sense();
    need_index(i, cloud ? c.num_cloud_cameras : c.num_cameras, "i");
    const char* name = (cloud ? c.cloud_cameras : c.cameras)[i].name.text;
    write_struct(io, describe(camera_spec(task_at(p->pool->task_index()), p->pool->task(), name)),
                 sizeof(rdm_camera_info), "io");
  });
}

namespace {
size_t sampling_bytes(int32_t count) {
  Arena measure;
  carve_furthest_scratch(measure, count);
  return measure.used();
}
}  // namespace

size_t rdm_sample_scratch(size_t count) {
  return count < 1 || count > kMaxCloud ? 0 : sampling_bytes(static_cast<int32_t>(count)) + kScratchSlack;
}

rdm_result rdm_sample_furthest(const float* points, size_t count, size_t wanted, int32_t start,
                               int32_t* chosen, void* scratch, size_t scratch_bytes) {
  return call([&] {
    need(points, "points");
    need(chosen, "chosen");
    need(scratch, "scratch");
    if (count < 1 || count > kMaxCloud) fail(Code::kRange, "count: %zu is outside [1, %d]", count, kMaxCloud);
    if (wanted < 1 || wanted > count) fail(Code::kRange, "wanted: %zu is outside [1, %zu]", wanted, count);
    const auto n = static_cast<int32_t>(count);
    need_index(start, n, "start");
    const size_t bytes = sampling_bytes(n);
    scratch = aligned_scratch(scratch, scratch_bytes, bytes);
    for (size_t i = 0; i < 3 * count; ++i)
      if (!std::isfinite(points[i])) fail(Code::kArgument, "points: entry %zu is not finite", i);
    HostHooks lent;  // an arena over the caller's memory
    lent.user = scratch;
    lent.alloc = [](void* user, size_t, size_t) { return user; };
    lent.release = [](void*, void*, size_t, size_t) {};
    Arena arena(lent, bytes);
    sample_furthest(points, n, static_cast<int32_t>(wanted), start, carve_furthest_scratch(arena, n), chosen);
  });
}
#endif
