#include "env/options/sense.hpp"

#include <cstring>
#include <iterator>

#include "base/error.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

constexpr OptionSpec kRows[] = {
    text_option("modality", "state", nullptr,
                "what worlds see: state, or any of rgb, depth, segmentation, points, voxels joined by +"),
    text_option("cameras", "front", nullptr, "cameras of rgb, depth and segmentation, joined by +"),
    integer_option("image_width", 64, 1, 2048, "of rgb, depth and segmentation, pixels"),
    integer_option("image_height", 64, 1, 2048, "of rgb, depth and segmentation, pixels"),
    text_option("cloud_cameras", "above+side_right+side_left", nullptr,
                "depth cameras of points and voxels, joined by +"),
    integer_option("cloud_width", 96, 1, 512, "of a depth camera of points and voxels, pixels"),
    integer_option("cloud_height", 96, 1, 512, "of a depth camera of points and voxels, pixels"),
    number_option("cloud_range", 2, 0.01, 100,
                  "points further than this from what the first cloud camera looks at are left out, m"),
    integer_option("points", 2048, 1, 65536, "points of a world"),
    text_option("sampling", "furthest", "furthest|random|voxel", "how points are chosen of those seen"),
    number_option("sampling_voxel", 0.01, 0.001, 1, "sampling = voxel: side of a voxel, m"),
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

int32_t read_cameras(const char* list, const TaskInfo& task, const char* key, Camera* out) {
  int32_t count = 0;
  each_word(list, [&](const char* word) {
    if (count == kMaxCameras) fail(Code::kRange, "%s: more than %d", key, kMaxCameras);
    out[count++] = camera_of(task, word);
  });
  if (count == 0) fail(Code::kArgument, "%s: none is named", key);
  return count;
}

}  // namespace

const OptionSpec* sense_options(int32_t* count) {
  *count = static_cast<int32_t>(std::size(kRows));
  return kRows;
}

const CameraSpec& camera_spec(const TaskInfo& task, const char* name) {
  Vector<const char*> names;
  const auto look = [&](const CameraSpec* specs, int32_t count) -> const CameraSpec* {
    for (int32_t i = 0; i < count; ++i) {
      if (same_name(specs[i].name, name)) return &specs[i];
      names.push_back(specs[i].name);
    }
    return nullptr;
  };
  const CameraSpec* c = look(task.cameras, task.num_cameras);
  if (!c) c = look(kCloudCameras, static_cast<int32_t>(std::size(kCloudCameras)));
  if (c) return *c;
  fail(Code::kNotFound, "camera %s: unknown%s", Quoted(name).text,
       Nearest(name, names.data(), static_cast<int32_t>(names.size())).text);
}

Camera camera_of(const TaskInfo& task, const char* name) {
  const CameraSpec& c = camera_spec(task, name);
  return {c.name, c.eye, c.target, c.fov_y};
}

SenseConfig sense_from(const Options& options, const TaskInfo& task) {
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
  if (c.pictures()) {
    c.num_cameras = read_cameras(options.text("cameras"), task, "cameras", c.cameras);
    c.width = options.integer("image_width");
    c.height = options.integer("image_height");
  }
  if (c.clouds()) {
    c.num_cloud_cameras = read_cameras(options.text("cloud_cameras"), task, "cloud_cameras", c.cloud_cameras);
    c.cloud_width = options.integer("cloud_width");
    c.cloud_height = options.integer("cloud_height");
    c.range = options.number("cloud_range");
  }
  if (c.points) {
    c.num_points = options.integer("points");
    const char* sampling = options.text("sampling");
    c.thinning = same_name(sampling, "random")  ? Thinning::kRandom
                 : same_name(sampling, "voxel") ? Thinning::kVoxel
                                                : Thinning::kFurthest;
    c.thinning_voxel = options.number("sampling_voxel");
  }
  if (c.voxels) {
    c.grid = options.integer("voxels");
    c.cell = options.number("voxel_size");
  }
  return c;
}

}  // namespace rdm
