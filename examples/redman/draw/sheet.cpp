#include "draw/sheet.hpp"

#include <redman/import.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <redman/redman.hpp>

#include "common/report.hpp"

namespace tool {
namespace {

constexpr double kOpen = 0.4;  // share of a joint's range
constexpr int32_t kMostJoints = 64;

// One thing, and what holds it: a ball about `centre`.
struct Shown {
  bool robot = false;
  int32_t index = -1, joints = 0;
  double q[kMostJoints] = {};
  double lift = 0;  // m, to stand on the ground
  double centre[3] = {}, radius = 0;
};

std::array<double, 3> turned(const double* q, const double* v) {
  const double u[3] = {q[0], q[1], q[2]}, w = q[3];
  const double t[3] = {2 * (u[1] * v[2] - u[2] * v[1]), 2 * (u[2] * v[0] - u[0] * v[2]),
                       2 * (u[0] * v[1] - u[1] * v[0])};
  return {v[0] + w * t[0] + u[1] * t[2] - u[2] * t[1], v[1] + w * t[1] + u[2] * t[0] - u[0] * t[2],
          v[2] + w * t[2] + u[0] * t[1] - u[1] * t[0]};
}

// Corners of the box about a shape, in its own frame.
template <class S>
void half_sizes(const S& s, double* half) {
  const double* d = s.size;
  switch (s.kind) {
    case RDM_SHAPE_SPHERE:
      half[0] = half[1] = half[2] = d[0];
      break;
    case RDM_SHAPE_CAPSULE:
      half[0] = half[1] = d[0], half[2] = d[0] + d[1];
      break;
    case RDM_SHAPE_CYLINDER:
      half[0] = half[1] = d[0], half[2] = d[1];
      break;
    default:
      std::copy_n(d, 3, half);
  }
}

struct Bounds {
  double low[3] = {1e9, 1e9, 1e9}, high[3] = {-1e9, -1e9, -1e9};
  void add(const std::array<double, 3>& p, const double* at) {
    for (size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], p[k] + at[k]);
      high[k] = std::max(high[k], p[k] + at[k]);
    }
  }
  void add_box(const double* half, const double* q, const double* at) {
    for (int i = 0; i < 8; ++i) {
      const double c[3] = {i & 1 ? half[0] : -half[0], i & 2 ? half[1] : -half[1],
                           i & 4 ? half[2] : -half[2]};
      add(turned(q, c), at);
    }
  }
  void give(Shown* out) const {
    out->lift = -low[2];
    for (int k = 0; k < 3; ++k) out->centre[k] = 0.5 * (low[k] + high[k]);
    out->centre[2] += out->lift;
    out->radius = 0.5 * std::hypot(high[0] - low[0], high[1] - low[1], high[2] - low[2]);
  }
};

Shown show_object(int32_t index) {
  Shown out;
  out.index = index;
  rdm_object_def def;
  rdm_object_def_init(&def, sizeof def);
  redman::check(rdm_object_get_def(index, &def));
  Bounds b;
  for (int32_t i = 0; i < def.num_shapes; ++i) {
    rdm_shape_def s;
    redman::check(rdm_object_shape_at(index, i, &s));
    for (int32_t k = 0; k < s.num_points; ++k) b.add(turned(s.pose.q, s.points + 3 * k), s.pose.p);
    double half[3];
    half_sizes(s, half);
    if (s.kind != RDM_SHAPE_HULL) b.add_box(half, s.pose.q, s.pose.p);
  }
  b.give(&out);
  return out;
}

Shown show_robot(int32_t index, int32_t joints) {
  Shown out;
  out.robot = true;
  out.index = index, out.joints = joints;
  for (int32_t i = 0; i < joints; ++i) {
    rdm_joint_info j = RDM_INIT(rdm_joint_info);
    redman::check(rdm_robot_joint_at(index, i, &j));
    out.q[i] = j.lower + kOpen * (j.upper - j.lower);
  }
  std::vector<rdm_pose> links(static_cast<size_t>(joints));
  redman::check(rdm_robot_get_poses(index, out.q, links.data(), nullptr, nullptr, nullptr));
  Bounds b;
  rdm_robot_shape s;
  for (int32_t i = 0; rdm_robot_shape_at(index, i, &s) == RDM_OK; ++i) {
    static constexpr rdm_pose kRoot = {{0, 0, 0}, {0, 0, 0, 1}};
    const rdm_pose& X = s.link < 0 ? kRoot : links[static_cast<size_t>(s.link)];
    double half[3];
    half_sizes(s, half);
    Bounds own;  // in the link
    own.add_box(half, s.pose.q, s.pose.p);
    for (int c = 0; c < 8; ++c) {
      const double corner[3] = {c & 1 ? own.high[0] : own.low[0], c & 2 ? own.high[1] : own.low[1],
                                c & 4 ? own.high[2] : own.low[2]};
      b.add(turned(X.q, corner), X.p);
    }
  }
  b.give(&out);
  return out;
}

rdm_result build(void* user, rdm_scene* scene, void*) {
  const auto& shown = *static_cast<const Shown*>(user);
  rdm_shape_def ground{};
  ground.name = "ground", ground.kind = RDM_SHAPE_PLANE;
  ground.color[0] = ground.color[1] = ground.color[2] = 225, ground.color[3] = 255;
  if (const rdm_result r = rdm_scene_add_static(scene, &ground)) return r;
  const rdm_pose lifted = {{0, 0, shown.lift}, {}};
  if (!shown.robot) return rdm_scene_add_object(scene, shown.index, "object", &lifted, 1, nullptr);
  rdm_scene_robot robot;
  if (const rdm_result r = rdm_scene_robot_init(&robot, sizeof robot)) return r;
  robot.robot = shown.index, robot.name = "it";
  robot.pose.p[2] = shown.lift;
  return rdm_scene_add_robot(scene, &robot, nullptr);
}
rdm_result reset(void* user, const void*, rdm_world* world, void*, rdm_random*) {
  const auto& shown = *static_cast<const Shown*>(user);
  return shown.robot ? rdm_world_set_joints(world, 0, shown.q, nullptr, shown.joints) : RDM_OK;
}
rdm_result control(void*, const void*, rdm_world*, void*, const float*) {
  return RDM_OK;
}
rdm_result judge(void*, const void*, rdm_world*, void*, int32_t, rdm_verdict*) {
  return RDM_OK;
}
rdm_result observe(void*, const void*, const rdm_world*, const void*, float* obs) {
  obs[0] = 0;
  return RDM_OK;
}

struct Task {
  int32_t index = -1;
  ~Task() {
    if (index >= 0) rdm_task_destroy(index);
  }
};

Image picture(Shown shown, int32_t side) {
  rdm_camera_def camera{};
  camera.name = "it";
  camera.fov_y = 0.5f;
  const double away = 1.02 * shown.radius / std::sin(0.25), way[3] = {0.72, -0.48, 0.5};
  for (int k = 0; k < 3; ++k) {
    camera.target[k] = static_cast<float>(shown.centre[k]);
    camera.eye[k] = static_cast<float>(shown.centre[k] + away * way[k]);
  }
  const rdm_field_def field = {"nothing", "1", 1, 0, 0, 0};
  const rdm_cost_def cost = {"cost", "none", -1};
  rdm_task_def def;
  rdm_task_def_init(&def, sizeof def);
  def.name = "sheet_of_objects";
  def.fields = &field, def.num_fields = 1;
  def.costs = &cost, def.num_costs = 1;
  def.cameras = &camera, def.num_cameras = 1;
  def.action_dim = 1;
  def.user = &shown;
  def.build = build, def.reset = reset, def.control = control, def.judge = judge, def.observe = observe;
  Task task;
  redman::check(rdm_task_create(&task.index, &def));
  rdm_pool_config config = redman::pool_config(def.name);
  rdm_pool* made = nullptr;
  redman::check(rdm_pool_create(&made, &config));
  const std::unique_ptr<rdm_pool, void (*)(rdm_pool*)> pool(made, rdm_pool_destroy);
  redman::check(rdm_pool_reset(made, nullptr, nullptr));
  Image out{side, side, std::vector<unsigned char>(static_cast<size_t>(3 * side * side))};
  redman::check(rdm_pool_render(made, 0, "it", side, side, out.rgb.data(), nullptr, nullptr));
  return out;
}

}  // namespace

Sheet draw_sheet(int32_t side, int32_t columns) {
  Sheet out;
  std::vector<Shown> all;
  for (int32_t i = 0; i < rdm_object_count(); ++i) {
    rdm_object_info object = RDM_INIT(rdm_object_info);
    if (rdm_object_info_at(i, &object) != RDM_OK) continue;
    out.names.emplace_back(object.name);
    all.push_back(show_object(i));
  }
  for (int32_t i = 0; i < rdm_robot_count(); ++i) {
    rdm_robot_def def;
    rdm_robot_def_init(&def, sizeof def);
    if (rdm_robot_get_def(i, &def) != RDM_OK || def.num_commands >= 0) continue;
    out.names.emplace_back(def.name);
    all.push_back(show_robot(i, def.num_links));
  }
  const auto count = static_cast<int32_t>(all.size());
  out.columns = std::min(columns, count);
  const int32_t rows = (count + out.columns - 1) / out.columns;
  out.image.width = side * out.columns, out.image.height = side * rows;
  out.image.rgb.assign(3 * static_cast<size_t>(out.image.width) * static_cast<size_t>(out.image.height), 255);
  for (int32_t i = 0; i < count; ++i) {
    const Image one = picture(all[static_cast<size_t>(i)], side);
    for (int32_t y = 0; y < side; ++y) {
      const auto from = static_cast<size_t>(3 * side * y);
      const auto to =
          3 * (static_cast<size_t>(side * (i / out.columns) + y) * static_cast<size_t>(out.image.width) +
               static_cast<size_t>(side * (i % out.columns)));
      std::copy_n(one.rgb.begin() + static_cast<std::ptrdiff_t>(from), 3 * side,
                  out.image.rgb.begin() + static_cast<std::ptrdiff_t>(to));
    }
  }
  return out;
}

}  // namespace tool
