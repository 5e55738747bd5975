// Pictures, points and voxels of the worlds of a pool: their buffers, and how one world's rows are filled.
#pragma once
#include "env/options/sense.hpp"
#include "sense/cloud/depth_grid.hpp"
#include "sense/render/raycast.hpp"

namespace rdm {

// Rows of all worlds, null where the modality is off.
struct SenseBuffers {
  uint8_t* rgb = nullptr;           // [env][camera][height][width][3]
  float* depth = nullptr;           // [env][camera][height][width], m, 0: nothing
  int32_t* segmentation = nullptr;  // the same, shape, -1: nothing
  float* points = nullptr;          // [env][num_points][3]
  int32_t* point_shape = nullptr;   // [env][num_points]
  int32_t* point_count = nullptr;   // [env] how many differ; the rest repeats them
  uint8_t* point_class = nullptr;   // [env][num_points] below point_classes
  uint8_t* point_color = nullptr;   // [env][num_points][3] sRGB, 0 where nothing was seen
  int8_t* voxels = nullptr;         // [env][grid][grid][grid]
};
SenseBuffers carve_sense_buffers(Arena& arena, const SenseConfig& config, size_t num_envs);

// What a point can lie on: one of the articulations, then of the free bodies, last anything else, or nothing.
uint8_t point_class(const Scene& scene, int32_t shape);
// How many there are, and with goal_points one more, of these; at most 255 and this: the last bodies of a
// larger scene share one.
int32_t point_classes(const SenseConfig& config, const Scene& scene);

// Workspace of one thread.
struct SenseScratch {
  RenderShape *shapes = nullptr, *solid = nullptr;  // [num_shapes]; those that are no planes
  RaycastScratch raycast;
  float* depth = nullptr;  // [cloud camera][height][width]
  int32_t* segmentation = nullptr;
  CloudScratch cloud;
};
SenseScratch carve_sense_scratch(Arena& arena, const SenseConfig& config, int32_t num_shapes);

// Fills the rows of world `env`. Points and voxels do not see planes. `focus` is the middle of the voxels,
// `goal` where goal_points show the first free body;
// `points` draws points and their noise, `cameras`, the same throughout an episode, where cameras stand.
void sense_world(const SenseConfig& config, const World& world, const Vec3& focus, const Pose& goal,
                 Stream points, Stream cameras, SenseScratch& scratch, const SenseBuffers& buffers,
                 size_t env);

}  // namespace rdm
