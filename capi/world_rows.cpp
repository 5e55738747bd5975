// rdm_world_get_many and rdm_world_set_many: what the functions of one world do, for many of them.
#include "capi/own_task.hpp"

#if RDM_WITH_SIM
using namespace rdm;
using namespace rdm::capi;

namespace {

constexpr size_t kMotion = 13, kPose = 7, kWrench = 6, kTouch = 2, kPlace = 2;
constexpr size_t kMostRows = 65536, kMostItems = 4096, kRobotJoints = kMaxRobotLinks;

size_t doubles_of(int32_t what) {
  switch (what) {
    case RDM_QUANTITY_LINK:
    case RDM_QUANTITY_BASE:
    case RDM_QUANTITY_BODY:
      return kMotion;
    case RDM_QUANTITY_SHAPE:
      return kPose;
    case RDM_QUANTITY_SENSOR:
    case RDM_QUANTITY_BODY_PUSH:
    case RDM_QUANTITY_BASE_PUSH:
    case RDM_QUANTITY_LINK_PUSH:
      return kWrench;
    case RDM_QUANTITY_TOUCH:
      return kTouch;
    case RDM_QUANTITY_JOINT:
      return kPlace;
    default:
      return 1;
  }
}

bool can_set(int32_t what) {
  return what == RDM_QUANTITY_TARGET || what == RDM_QUANTITY_BASE || what == RDM_QUANTITY_BODY ||
         (what >= RDM_QUANTITY_JOINT && what <= RDM_QUANTITY_LINK_PUSH);
}

double* put_pose(const rdm_pose& pose, double* x) {
  x = std::copy_n(pose.p, 3, x);
  return std::copy_n(pose.q, 4, x);
}

rdm_motion motion_of(const double* x) {
  rdm_motion m;
  std::copy_n(x, 3, m.pose.p);
  std::copy_n(x + 3, 4, m.pose.q);
  std::copy_n(x + 7, 3, m.v);
  std::copy_n(x + 10, 3, m.w);
  return m;
}

// What a function of one world returned; its text stays.
void good(rdm_result r) {
  if (r != RDM_OK) fail(static_cast<Code>(r), "%s", last_error());
}

// Item i of one world to x; what the joints are is asked for once a row.
void get_one(const rdm_world* world, int32_t what, int32_t i, double* x) {
  rdm_motion m;
  rdm_pose pose;
  int32_t pairs = 0;
  switch (what) {
    case RDM_QUANTITY_LINK:
      good(rdm_world_get_link(world, i, &m));
      break;
    case RDM_QUANTITY_BASE:
      good(rdm_world_get_base(world, i, &m));
      break;
    case RDM_QUANTITY_BODY:
      good(rdm_world_get_body(world, i, &m));
      break;
    case RDM_QUANTITY_SHAPE:
      good(rdm_world_get_shape(world, i, &pose));
      put_pose(pose, x);
      return;
    case RDM_QUANTITY_SENSOR:
      return good(rdm_world_get_sensor(world, i, x, x + 3));
    default:
      good(rdm_world_get_touch(world, i, &pairs, x + 1));
      x[0] = pairs;
      return;
  }
  x = put_pose(m.pose, x);
  x = std::copy_n(m.v, 3, x);
  std::copy_n(m.w, 3, x);
}

void get_joints(const rdm_world* world, int32_t what, int32_t first, size_t count, double* x) {
  rdm_joints j{};
  j.struct_size = sizeof j;
  good(rdm_world_get_joints(world, &j));
  if (first < 0 || first > j.count || count > static_cast<size_t>(j.count - first))
    fail(Code::kRange, "first, count: %zu joints from joint %d on are not all among the %d of the scene",
         count, first, j.count);
  const double* const of[] = {j.q, j.qd, j.target, j.torque};
  std::copy_n(of[what] + first, count, x);
}

void set_joints(rdm_world* world, int32_t first, size_t count, const double* x) {
  double q[kRobotJoints], qd[kRobotJoints];
  if (count > kRobotJoints)
    fail(Code::kRange, "count: %zu joints are too many, a robot has at most %zu", count, kRobotJoints);
  for (size_t k = 0; k < count; ++k) q[k] = x[2 * k], qd[k] = x[2 * k + 1];
  good(rdm_world_set_joints(world, first, q, qd, count));
}

void set_one(rdm_world* world, int32_t what, int32_t i, const double* x) {
  rdm_motion m;
  switch (what) {
    case RDM_QUANTITY_BASE:
      m = motion_of(x);
      return good(rdm_world_set_base(world, i, &m));
    case RDM_QUANTITY_BODY:
      m = motion_of(x);
      return good(rdm_world_set_body(world, i, &m));
    case RDM_QUANTITY_BODY_PUSH:
      return good(rdm_world_push_body(world, i, x, x + 3));
    case RDM_QUANTITY_BASE_PUSH:
      return good(rdm_world_push_base(world, i, x, x + 3));
    default:
      return good(rdm_world_push_link(world, i, x, x + 3));
  }
}

template <class F>
rdm_result each(rdm_world** worlds, size_t n, size_t count, const double* x, F&& f) {
  return call_inside([&] {
    if (n == 0 || count == 0) return;
    need(worlds, "worlds");
    need(x, "x");
    if (n > kMostRows || count > kMostItems)
      fail(Code::kRange, "n, count: %zu worlds and %zu items; at most %zu worlds and %zu items are allowed",
           n, count, kMostRows, kMostItems);
    for (size_t i = 0; i < n; ++i) f(worlds[i], i);
  });
}

}  // namespace

rdm_result rdm_world_get_many(rdm_world** worlds, size_t n, int32_t what, int32_t first, size_t count,
                              double* x) {
  const size_t width = doubles_of(what);
  if (what < RDM_QUANTITY_Q || what > RDM_QUANTITY_TOUCH)
    return call_inside([&] { fail(Code::kRange, "what: %d cannot be read, only 0 to 9 can", what); });
  return each(worlds, n, count, x, [&](const rdm_world* world, size_t row) {
    double* const at = x + row * count * width;
    if (what >= RDM_QUANTITY_Q && what <= RDM_QUANTITY_TORQUE)
      return get_joints(world, what, first, count, at);
    for (size_t k = 0; k < count; ++k) get_one(world, what, first + static_cast<int32_t>(k), at + k * width);
  });
}

rdm_result rdm_world_set_many(rdm_world** worlds, size_t n, int32_t what, int32_t first, size_t count,
                              const double* x) {
  const size_t width = doubles_of(what);
  if (!can_set(what))
    return call_inside(
        [&] { fail(Code::kRange, "what: %d cannot be set, only 2, 5, 6 and 10 to 15 can", what); });
  return each(worlds, n, count, x, [&](rdm_world* world, size_t row) {
    const double* const at = x + row * count * width;
    switch (what) {
      case RDM_QUANTITY_TARGET:
        return good(rdm_world_set_targets(world, first, at, count));
      case RDM_QUANTITY_COMMAND:
        return good(rdm_world_set_commands(world, first, at, count));
      case RDM_QUANTITY_FEEDFORWARD:
        return good(rdm_world_set_feedforward(world, first, at, count));
      case RDM_QUANTITY_JOINT:
        return set_joints(world, first, count, at);
      case RDM_QUANTITY_BASE:
      case RDM_QUANTITY_BODY:
      case RDM_QUANTITY_BODY_PUSH:
      case RDM_QUANTITY_BASE_PUSH:
      case RDM_QUANTITY_LINK_PUSH:
        for (size_t k = 0; k < count; ++k)
          set_one(world, what, first + static_cast<int32_t>(k), at + k * width);
        return;
      default:
        return;
    }
  });
}
#endif
