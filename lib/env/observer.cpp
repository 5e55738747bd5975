#include "env/observer.hpp"

#include "sense/scene_shapes.hpp"

namespace rdm {
namespace {

size_t pixels(const SenseConfig& c) {
  return static_cast<size_t>(c.width) * static_cast<size_t>(c.height);
}
size_t cloud_pixels(const SenseConfig& c) {
  return static_cast<size_t>(c.cloud_width) * static_cast<size_t>(c.cloud_height);
}
size_t cells(const SenseConfig& c) {
  const auto n = static_cast<size_t>(c.grid);
  return n * n * n;
}

template <class T>
T* make_if(Arena& arena, bool wanted, size_t count) {
  return wanted ? arena.make<T>(count) : nullptr;
}

void take_pictures(const SenseConfig& c, int32_t num_shapes, const SenseScratch& s, const SenseBuffers& b,
                   size_t env) {
  for (int32_t k = 0; k < c.num_cameras; ++k) {
    const size_t at = (env * static_cast<size_t>(c.num_cameras) + static_cast<size_t>(k)) * pixels(c);
    Image image;
    image.width = c.width;
    image.height = c.height;
    if (b.rgb) image.rgb = b.rgb + 3 * at;
    if (b.depth) image.depth = b.depth + at;
    if (b.segmentation) image.segmentation = b.segmentation + at;
    render(s.shapes, num_shapes, c.cameras[k], image, {}, s.raycast);
  }
}

void take_clouds(const SenseConfig& c, int32_t num_shapes, const Vec3& focus, Stream& stream, SenseScratch& s,
                 const SenseBuffers& b, size_t env) {
  int32_t solid = 0;
  for (int32_t i = 0; i < num_shapes; ++i)
    if (s.shapes[i].kind != ShapeKind::kPlane) s.solid[solid++] = s.shapes[i];
  DepthPicture pictures[kMaxCameras];
  s.cloud.all.count = 0;
  for (int32_t k = 0; k < c.num_cloud_cameras; ++k) {
    const size_t at = static_cast<size_t>(k) * cloud_pixels(c);
    float* depth = s.depth + at;
    int32_t* segmentation = s.segmentation + at;
    render(s.solid, solid, c.cloud_cameras[k], {c.cloud_width, c.cloud_height, nullptr, depth, segmentation},
           {}, s.raycast);
    pictures[k] = {make_view(c.cloud_cameras[k], c.cloud_width, c.cloud_height), depth};
    if (c.points)
      append_points(pictures[k].view, depth, segmentation, c.cloud_cameras[0].target, c.range, &s.cloud.all);
  }
  if (c.points) {
    const size_t row = env * static_cast<size_t>(c.num_points);
    Cloud out{b.points + 3 * row, b.point_shape + row, 0};
    thin_cloud(c.thinning, c.num_points, c.thinning_voxel, stream, s.cloud, &out);
    b.point_count[env] = out.count;
  }
  if (c.voxels)
    grid_from_depth(pictures, c.num_cloud_cameras, focus, c.grid, c.cell, b.voxels + env * cells(c));
}

}  // namespace

SenseBuffers carve_sense_buffers(Arena& arena, const SenseConfig& c, size_t num_envs) {
  const size_t images = num_envs * static_cast<size_t>(c.num_cameras) * pixels(c);
  const size_t points = num_envs * static_cast<size_t>(c.num_points);
  SenseBuffers b;
  b.rgb = make_if<uint8_t>(arena, c.rgb, 3 * images);
  b.depth = make_if<float>(arena, c.depth, images);
  b.segmentation = make_if<int32_t>(arena, c.segmentation, images);
  b.points = make_if<float>(arena, c.points, 3 * points);
  b.point_shape = make_if<int32_t>(arena, c.points, points);
  b.point_count = make_if<int32_t>(arena, c.points, num_envs);
  b.voxels = make_if<int8_t>(arena, c.voxels, num_envs * cells(c));
  return b;
}

SenseScratch carve_sense_scratch(Arena& arena, const SenseConfig& c, int32_t num_shapes) {
  SenseScratch s;
  if (!c.any()) return s;
  s.shapes = arena.make<RenderShape>(static_cast<size_t>(num_shapes));
  s.raycast = carve_raycast_scratch(arena, num_shapes);
  if (!c.clouds()) return s;
  const size_t all = static_cast<size_t>(c.num_cloud_cameras) * cloud_pixels(c);
  s.solid = arena.make<RenderShape>(static_cast<size_t>(num_shapes));
  s.depth = arena.make<float>(all);
  s.segmentation = arena.make<int32_t>(all);
  if (c.points) s.cloud = carve_cloud_scratch(arena, static_cast<int32_t>(all), c.thinning);
  return s;
}

void sense_world(const SenseConfig& c, const World& world, const Vec3& focus, Stream stream, SenseScratch& s,
                 const SenseBuffers& b, size_t env) {
  if (!c.any()) return;
  const int32_t num_shapes = gather_shapes(world, s.shapes);
  if (c.pictures()) take_pictures(c, num_shapes, s, b, env);
  if (c.clouds()) take_clouds(c, num_shapes, focus, stream, s, b, env);
}

}  // namespace rdm
