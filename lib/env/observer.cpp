#include "env/observer.hpp"

#include <algorithm>

#include "sense/mounted_camera.hpp"
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

void take_pictures(const SenseConfig& c, const World& world, int32_t num_shapes, const SenseScratch& s,
                   const SenseBuffers& b, size_t env) {
  for (int32_t k = 0; k < c.num_cameras; ++k) {
    const size_t at = (env * static_cast<size_t>(c.num_cameras) + static_cast<size_t>(k)) * pixels(c);
    Image image;
    image.width = c.width;
    image.height = c.height;
    if (b.rgb) image.rgb = b.rgb + 3 * at;
    if (b.depth) image.depth = b.depth + at;
    if (b.segmentation) image.segmentation = b.segmentation + at;
    render(s.shapes, num_shapes, placed(c.cameras[k], world), image, {}, s.raycast);
  }
}

// Off its place by draws of up to `noise` m of eye and target.
Camera moved(Camera camera, double noise, Stream& stream) {
  if (!(noise > 0)) return camera;
  for (Vec3* p : {&camera.eye, &camera.target})
    for (int k = 0; k < 3; ++k) (*p)[k] += noise * stream.signed_unit();
  return camera;
}

int32_t scene_classes(const Scene& scene) {
  return std::min(255, static_cast<int32_t>(scene.def.articulations.size()) + scene.num_bodies + 1);
}

// Classes and colours of the points [first, first + count) of a world's row.
void mark_points(const World& world, const SenseScratch& s, const SenseBuffers& b, size_t first,
                 int32_t count, int32_t goal_class) {
  for (size_t i = first; i < first + static_cast<size_t>(count); ++i) {
    const int32_t shape = b.point_shape[i];
    b.point_class[i] = goal_class >= 0 ? static_cast<uint8_t>(goal_class) : point_class(world.scene(), shape);
    for (size_t k = 0; b.point_color && k < 3; ++k)
      b.point_color[3 * i + k] = shape < 0 ? uint8_t{0} : s.shapes[shape].color[k];
  }
}

// Depth pictures of s.solid by the cameras of clouds, and with points all that they show to s.cloud.all.
void look(const SenseConfig& c, const Camera* cameras, int32_t solid, SenseScratch& s,
          DepthPicture* pictures) {
  s.cloud.all.count = 0;
  for (int32_t k = 0; k < c.num_cloud_cameras; ++k) {
    const size_t at = static_cast<size_t>(k) * cloud_pixels(c);
    float* depth = s.depth + at;
    int32_t* segmentation = s.segmentation + at;
    render(s.solid, solid, cameras[k], {c.cloud_width, c.cloud_height, nullptr, depth, segmentation}, {},
           s.raycast);
    pictures[k] = {make_view(cameras[k], c.cloud_width, c.cloud_height), depth};
    if (c.points)
      append_points(pictures[k].view, depth, segmentation, cameras[0].target, c.range, &s.cloud.all);
  }
}

// The shapes of body 0 alone, as if it were at the goal.
int32_t place_goal(const World& world, int32_t num_shapes, const Pose& goal, SenseScratch& s) {
  const Pose X_GW = goal * inverse(world.body(0).X);
  int32_t solid = 0;
  for (int32_t i = 0; i < num_shapes; ++i) {
    const SceneShape& shape = world.scene().shapes[static_cast<size_t>(i)];
    if (shape.carrier != Carrier::kBody || shape.index != 0) continue;
    s.solid[solid] = s.shapes[i];
    s.solid[solid].X_WS = X_GW * s.shapes[i].X_WS;
    s.solid[solid].X_WS.q = normalized(s.solid[solid].X_WS.q);
    ++solid;
  }
  return solid;
}

void take_clouds(const SenseConfig& c, const World& world, int32_t num_shapes, const Vec3& focus,
                 const Pose& goal, Stream& stream, Stream& draws, SenseScratch& s, const SenseBuffers& b,
                 size_t env) {
  int32_t solid = 0;
  for (int32_t i = 0; i < num_shapes; ++i)
    if (s.shapes[i].kind != ShapeKind::kPlane) s.solid[solid++] = s.shapes[i];
  Camera cameras[kMaxCameras];
  for (int32_t k = 0; k < c.num_cloud_cameras; ++k)
    cameras[k] = placed(moved(c.cloud_cameras[k], c.camera_noise, draws), world);
  DepthPicture pictures[kMaxCameras];
  look(c, cameras, solid, s, pictures);
  const size_t row = env * static_cast<size_t>(c.num_points);
  const int32_t seen = c.num_points - c.goal_points;
  if (c.points) {
    Cloud out{b.points + 3 * row, b.point_shape + row, 0};
    thin_cloud(c.thinning, seen, c.thinning_voxel, stream, s.cloud, &out);
    if (c.point_noise > 0 || c.point_dropout > 0)
      disturb_cloud(c.point_noise, c.point_dropout, seen, stream, &out);
    b.point_count[env] = out.count;
    mark_points(world, s, b, row, seen, -1);
  }
  if (c.voxels)
    grid_from_depth(pictures, c.num_cloud_cameras, focus, c.grid, c.cell, b.voxels + env * cells(c));
  if (c.goal_points) {
    const size_t at = row + static_cast<size_t>(seen);
    look(c, cameras, place_goal(world, num_shapes, goal, s), s, pictures);
    Cloud out{b.points + 3 * at, b.point_shape + at, 0};
    thin_cloud(c.thinning, c.goal_points, c.thinning_voxel, stream, s.cloud, &out);
    mark_points(world, s, b, at, c.goal_points, scene_classes(world.scene()));
  }
}

}  // namespace

int32_t point_classes(const SenseConfig& c, const Scene& scene) {
  return scene_classes(scene) + (c.goal_points ? 1 : 0);
}

uint8_t point_class(const Scene& scene, int32_t shape) {
  const int32_t last = scene_classes(scene) - 1;
  if (shape < 0) return static_cast<uint8_t>(last);
  const SceneShape& s = scene.shapes[static_cast<size_t>(shape)];
  if (s.articulation >= 0) return static_cast<uint8_t>(std::min(s.articulation, last - 1));
  if (s.carrier != Carrier::kBody) return static_cast<uint8_t>(last);
  return static_cast<uint8_t>(
      std::min(static_cast<int32_t>(scene.def.articulations.size()) + s.index, last - 1));
}

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
  b.point_class = make_if<uint8_t>(arena, c.points, points);
  b.point_color = make_if<uint8_t>(arena, c.points && c.point_color, 3 * points);
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

void sense_world(const SenseConfig& c, const World& world, const Vec3& focus, const Pose& goal, Stream points,
                 Stream cameras, SenseScratch& s, const SenseBuffers& b, size_t env) {
  if (!c.any()) return;
  const int32_t num_shapes = gather_shapes(world, s.shapes);
  if (c.pictures()) take_pictures(c, world, num_shapes, s, b, env);
  if (c.clouds()) take_clouds(c, world, num_shapes, focus, goal, points, cameras, s, b, env);
}

}  // namespace rdm
