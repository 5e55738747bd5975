#include "env/options/sense.hpp"

#include <cstring>
#include <iterator>

#include "base/error.hpp"
#include "base/text.hpp"

namespace rdm {
namespace {

struct SenseOptions {
  const char *modality, *cameras, *cloud_cameras;  // of the Options
  int32_t sense_every, image_width, image_height, cloud_width, cloud_height;
  double cloud_range;
  int32_t points;
  Thinning sampling;
  double sampling_voxel, point_noise, point_dropout;
  int32_t goal_points;
  bool point_color;
  double camera_noise;
  int32_t voxels;
  double voxel_size;
};
constexpr auto kSenseRows = option_rows<SenseOptions>(
    row<&SenseOptions::modality>(basic(text_option(
        "modality", "state", nullptr,
        "sensors of each world: state, or any of rgb, depth, segmentation, points, voxels, joined by +"))),
    row<&SenseOptions::sense_every>(
        integer_option("sense_every", 1, 1, 10000,
                       "control steps from one sensor frame to the next; e.g. the policy's action_repeat")),
    row<&SenseOptions::cameras>(basic(text_option(
        "cameras", "front", nullptr, "cameras that give rgb, depth and segmentation, joined by +"))),
    row<&SenseOptions::image_width>(
        integer_option("image_width", 64, 1, 2048, "width of rgb, depth and segmentation images, pixels")),
    row<&SenseOptions::image_height>(
        integer_option("image_height", 64, 1, 2048, "height of rgb, depth and segmentation images, pixels")),
    row<&SenseOptions::cloud_cameras>(text_option("cloud_cameras", "above+side_right+side_left", nullptr,
                                                  "depth cameras that give points and voxels, joined by +")),
    row<&SenseOptions::cloud_width>(
        integer_option("cloud_width", 96, 1, 512, "width of each depth camera of cloud_cameras, pixels")),
    row<&SenseOptions::cloud_height>(
        integer_option("cloud_height", 96, 1, 512, "height of each depth camera of cloud_cameras, pixels")),
    row<&SenseOptions::cloud_range>(
        number_option("cloud_range", 2, 0.01, 100,
                      "points farther than this from the target of the first cloud camera are left out, m")),
    row<&SenseOptions::points>(
        basic(integer_option("points", 2048, 1, 65536, "number of points in the cloud of a world"))),
    row<&SenseOptions::sampling, Thinning::kFurthest, Thinning::kRandom, Thinning::kVoxel>(
        text_option("sampling", "furthest", "furthest|random|voxel",
                    "how points are selected: furthest-point sampling, at random, or one per voxel")),
    row<&SenseOptions::sampling_voxel>(
        number_option("sampling_voxel", 0.01, 0.001, 1, "side of a voxel of sampling=voxel, m")),
    row<&SenseOptions::point_noise>(number_option(
        "point_noise", 0, 0, 0.5, "standard deviation of the noise on each coordinate of a point, m")),
    row<&SenseOptions::point_dropout>(number_option(
        "point_dropout", 0, 0, 1, "share of the points that are lost; copies of the others replace them")),
    row<&SenseOptions::goal_points>(
        integer_option("goal_points", 0, 0, 65535,
                       "this many of the points, the last ones, lie on the object at its goal pose")),
    row<&SenseOptions::point_color>(
        flag_option("point_color", false, "points carry the colour of the surface they lie on")),
    row<&SenseOptions::camera_noise>(number_option("camera_noise", 0, 0, 1,
                                                   "in each episode, position and target of cloud_cameras "
                                                   "are shifted by up to this along each axis, m")),
    row<&SenseOptions::voxels>(
        integer_option("voxels", 16, 1, 128, "number of cells along each side of the local voxel grid")),
    row<&SenseOptions::voxel_size>(
        number_option("voxel_size", 0.03, 0.001, 1, "side of a voxel of the local grid, m")));

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
    if (count == kMaxCameras) fail(Code::kRange, "%s: there are more than %d", key, kMaxCameras);
    out[count++] = camera_of(info, task, word);
  });
  if (count == 0) fail(Code::kArgument, "%s: it names no camera", key);
  return count;
}

}  // namespace

const OptionSpec* sense_options(int32_t* count) {
  *count = static_cast<int32_t>(kSenseRows.size());
  return kSenseRows.specs;
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
  const SenseOptions o = kSenseRows.read(options);
  SenseConfig c;
  struct Word {
    const char* name;
    bool* flag;
  };
  bool state = false;
  const Word words[] = {{"state", &state},     {"rgb", &c.rgb},
                        {"depth", &c.depth},   {"segmentation", &c.segmentation},
                        {"points", &c.points}, {"voxels", &c.voxels}};
  each_word(o.modality, [&](const char* word) {
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
  c.every = o.sense_every;
  if (c.pictures()) {
    c.num_cameras = read_cameras(o.cameras, info, task, "cameras", c.cameras);
    c.width = o.image_width;
    c.height = o.image_height;
  }
  if (c.clouds()) {
    c.num_cloud_cameras = read_cameras(o.cloud_cameras, info, task, "cloud_cameras", c.cloud_cameras);
    c.cloud_width = o.cloud_width;
    c.cloud_height = o.cloud_height;
    c.range = o.cloud_range;
    c.camera_noise = o.camera_noise;
  }
  if (c.points) {
    c.num_points = o.points;
    c.thinning = o.sampling;
    c.thinning_voxel = o.sampling_voxel;
    c.point_noise = o.point_noise;
    c.point_dropout = o.point_dropout;
    c.point_color = o.point_color;
    c.goal_points = o.goal_points;
    if (c.goal_points && !task.has_goal())
      fail(Code::kArgument, "goal_points: task %s has no object with a goal pose", info.name);
    if (c.goal_points >= c.num_points)
      fail(Code::kRange, "goal_points: %d is outside [0, points - 1 = %d]", c.goal_points, c.num_points - 1);
  }
  if (c.voxels) {
    c.grid = o.voxels;
    c.cell = o.voxel_size;
  }
  return c;
}

}  // namespace rdm
