// What the worlds of a pool see: the options that every task has beside its own.
#pragma once
#include <cstdint>

#include "base/option_rows.hpp"
#include "env/task.hpp"
#include "sense/cloud/cloud.hpp"
#include "sense/render/camera.hpp"

namespace rdm {

inline constexpr int32_t kMaxCameras = 8;

// The rows, static.
const OptionSpec* sense_options(int32_t* count);

struct SenseConfig {
  bool rgb = false, depth = false, segmentation = false, points = false, voxels = false;
  int32_t num_cameras = 0, width = 0, height = 0;  // of the pictures
  Camera cameras[kMaxCameras];
  int32_t num_cloud_cameras = 0, cloud_width = 0, cloud_height = 0;  // of points and voxels
  Camera cloud_cameras[kMaxCameras];
  int32_t num_points = 0;
  Thinning thinning = Thinning::kFurthest;
  double thinning_voxel = 0, range = 0;  // m
  double point_noise = 0;                // m, deviation of each coordinate
  double point_dropout = 0;              // share of the points that are lost
  bool point_color = false;
  int32_t goal_points = 0;  // of num_points, the last
  double camera_noise = 0;  // m, half width of an episode's draw of eye and target of a cloud camera
  int32_t grid = 0;         // cells along a side
  double cell = 0;          // m

  int32_t every = 1;  // control steps of an episode between two looks

  bool pictures() const { return rgb || depth || segmentation; }
  bool clouds() const { return points || voxels; }
  bool any() const { return pictures() || clouds(); }
};
// Error(kArgument) for a modality that is unknown, Error(kNotFound) for a camera that is neither the task's
// nor one of the three that every task has for clouds.
SenseConfig sense_from(const Options& options, const TaskInfo& info, const Task& task);

// A camera of the task, mounted or not, or "above", "side_right", "side_left": those for clouds, about
// (0, -0.5, 0.5), of tasks that name none so.
// The i-th of these, null past the end.
const CameraSpec* camera_at(const TaskInfo& info, const Task& task, int32_t i);
const CameraSpec& camera_spec(const TaskInfo& info, const Task& task, const char* name);
Camera camera_of(const TaskInfo& info, const Task& task, const char* name);

}  // namespace rdm
