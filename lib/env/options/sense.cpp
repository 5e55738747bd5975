#include "env/options/sense.hpp"

#include <cstring>
#include <iterator>

#include "base/error.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

constexpr OptionSpec kSenseRows[] = {
    basic(text_option(
        "modality", "state", nullptr,
        "what worlds see: state, or any of rgb, depth, segmentation, points, voxels joined by +")),
    integer_option(
        "sense_every", 1, 1, 10000,
        "control steps of an episode from look to look: rows show the last one; a policy's action_repeat"),
    basic(text_option("cameras", "front", nullptr, "cameras of rgb, depth and segmentation, joined by +")),
    integer_option("image_width", 64, 1, 2048, "of rgb, depth and segmentation, pixels"),
    integer_option("image_height", 64, 1, 2048, "of rgb, depth and segmentation, pixels"),
    text_option("cloud_cameras", "above+side_right+side_left", nullptr,
                "depth cameras of points and voxels, joined by +"),
    integer_option("cloud_width", 96, 1, 512, "of a depth camera of points and voxels, pixels"),
    integer_option("cloud_height", 96, 1, 512, "of a depth camera of points and voxels, pixels"),
    number_option("cloud_range", 2, 0.01, 100,
                  "points further than this from what the first cloud camera looks at are left out, m"),
    basic(integer_option("points", 2048, 1, 65536, "points of a world")),
    text_option("sampling", "furthest", "furthest|random|voxel", "how points are chosen of those seen"),
    number_option("sampling_voxel", 0.01, 0.001, 1, "sampling = voxel: side of a voxel, m"),
    number_option("point_noise", 0, 0, 0.5, "deviation of the noise on each coordinate of a point, m"),
    number_option("point_dropout", 0, 0, 1, "share of the points that are lost; others stand for them"),
    integer_option("goal_points", 0, 0, 65535,
                   "of the points, the last so many lie on the object where it is to be brought"),
    flag_option("point_color", false, "points have the colours of what they lie on"),
    number_option(
        "camera_noise", 0, 0, 1,
        "half width of the draw, each episode, by which eye and target of cloud_cameras are off, m"),
    integer_option("voxels", 16, 1, 128, "cells along a side of the local grid"),
    number_option("voxel_size", 0.03, 0.001, 1, "side of a cell, m"),
};

constexpr double kCloudFov = 57 * kPi / 180;
constexpr CameraSpec kCloudCameras[] = {
    {"above", {0, -0.5, 0.95}, {0, -0.5, 0.5}, kCloudFov},
    {"side_right", {0.4, -0.5, 0.75}, {0, -0.5, 0.5}, kCloudFov},
    {"side_left", {-0.4, -0.5, 0.75}, {0, -0.5, 0.5}, kCloudFov},
};

// Calls f(word) for each word of a list joined by '+' or ','.
template <class F>
void each_word(const char* list, F&& f) {
  char word[kOptionTextSize];
  for (const char* at = list; *at;) {
    const size_t n = std::strcspn(at, "+,");
    std::memcpy(word, at, n);
    word[n] = '\0';
    f(word);
    at += n;
    if (*at) ++at;
  }
}

int32_t read_cameras(const char* list, const TaskInfo& info, const Task& task, const char* key, Camera* out) {
  int32_t count = 0;
  each_word(list, [&](const char* word) {
    if (count == kMaxCameras) fail(Code::kRange, "%s: more than %d", key, kMaxCameras);
    out[count++] = camera_of(info, task, word);
  });
  if (count == 0) fail(Code::kArgument, "%s: none is named", key);
  return count;
}

}  // namespace

const OptionSpec* sense_options(int32_t* count) {
  *count = static_cast<int32_t>(std::size(kSenseRows));
  return kSenseRows;
}

const CameraSpec* camera_at(const TaskInfo& info, const Task& task, int32_t i) {
  if (i < info.num_cameras) return &info.cameras[i];
  i -= info.num_cameras;
  const Vector<CameraSpec>& mounted = task.mounted_cameras();
  const auto riding = static_cast<int32_t>(mounted.size());
  if (i < riding) return &mounted[static_cast<size_t>(i)];
  i -= riding;
  return i < static_cast<int32_t>(std::size(kCloudCameras)) ? &kCloudCameras[i] : nullptr;
}

const CameraSpec& camera_spec(const TaskInfo& info, const Task& task, const char* name) {
  Vector<const char*> names;
  for (int32_t i = 0; const CameraSpec* c = camera_at(info, task, i); ++i) {
    if (same_name(c->name, name)) return *c;
    names.push_back(c->name);
  }
  fail(Code::kNotFound, "camera %s: unknown%s", Quoted(name).text,
       Nearest(name, names.data(), static_cast<int32_t>(names.size())).text);
}

Camera camera_of(const TaskInfo& info, const Task& task, const char* name) {
  const CameraSpec& c = camera_spec(info, task, name);
  const Scene& scene = task.scene();
  const auto links = static_cast<int32_t>(scene.num_links),
             bases = static_cast<int32_t>(scene.def.articulations.size());
  if (c.mount < -bases || c.mount > links)
    fail(Code::kRange, "camera %s: mount %d is outside [%d, %d]", c.name, c.mount, -bases, links);
  return {c.name, c.eye, c.target, c.fov_y, c.up, c.mount, c.cx, c.cy};
}

SenseConfig sense_from(const Options& options, const TaskInfo& info, const Task& task) {
  SenseConfig c;
  struct Word {
    const char* name;
    bool* flag;
  };
  bool state = false;
  const Word words[] = {{"state", &state},     {"rgb", &c.rgb},
                        {"depth", &c.depth},   {"segmentation", &c.segmentation},
                        {"points", &c.points}, {"voxels", &c.voxels}};
  each_word(options.text("modality"), [&](const char* word) {
    const char* names[std::size(words)];
    for (size_t i = 0; i < std::size(words); ++i) {
      names[i] = words[i].name;
      if (!same_name(word, words[i].name)) continue;
      *words[i].flag = true;
      return;
    }
    fail(Code::kArgument, "modality %s: unknown%s", Quoted(word).text,
         Nearest(word, names, static_cast<int32_t>(std::size(words))).text);
  });
  c.every = options.integer("sense_every");
  if (c.pictures()) {
    c.num_cameras = read_cameras(options.text("cameras"), info, task, "cameras", c.cameras);
    c.width = options.integer("image_width");
    c.height = options.integer("image_height");
  }
  if (c.clouds()) {
    c.num_cloud_cameras =
        read_cameras(options.text("cloud_cameras"), info, task, "cloud_cameras", c.cloud_cameras);
    c.cloud_width = options.integer("cloud_width");
    c.cloud_height = options.integer("cloud_height");
    c.range = options.number("cloud_range");
    c.camera_noise = options.number("camera_noise");
  }
  if (c.points) {
    c.num_points = options.integer("points");
    const char* sampling = options.text("sampling");
    c.thinning = same_name(sampling, "random")  ? Thinning::kRandom
                 : same_name(sampling, "voxel") ? Thinning::kVoxel
                                                : Thinning::kFurthest;
    c.thinning_voxel = options.number("sampling_voxel");
    c.point_noise = options.number("point_noise");
    c.point_dropout = options.number("point_dropout");
    c.point_color = options.flag("point_color");
    c.goal_points = options.integer("goal_points");
    if (c.goal_points && !task.has_goal())
      fail(Code::kArgument, "goal_points: task %s brings no object to a pose", info.name);
    if (c.goal_points >= c.num_points)
      fail(Code::kRange, "goal_points: %d is outside [0, points - 1 = %d]", c.goal_points, c.num_points - 1);
  }
  if (c.voxels) {
    c.grid = options.integer("voxels");
    c.cell = options.number("voxel_size");
  }
  return c;
}

}  // namespace rdm
