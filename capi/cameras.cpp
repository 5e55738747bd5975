// Looking into a world: shapes, poses, contacts, rays.
#include "capi/handles.hpp"
#include "capi/pose.hpp"
#include "redman/deprecated.h"

#if RDM_WITH_SIM
#include <cmath>
#include <limits>

#include "physics/limits.hpp"
#include "sense/mounted_camera.hpp"
#include "sense/ray.hpp"

using namespace rdm;
using namespace rdm::capi;

namespace {

World& world_of(const rdm_pool* p, int32_t env) {
  need_index(env, p->pool->config().num_envs, "env");
  return p->pool->world(env);
}

void to_floats(const Vec3& v, float out[3]) {
  for (int k = 0; k < 3; ++k) out[k] = static_cast<float>(v[k]);
}

}  // namespace

Camera rdm::capi::pool_camera(const rdm_pool* p, int32_t env, const char* name) {
  need(name, "camera");
  return placed(camera_of(task_at(p->pool->task_index()), p->pool->task(), name), p->pool->world(env));
}

rdm_result rdm_pool_shape_at(const rdm_pool* p, int32_t i, rdm_shape_info* io) {
  return call_on(p, [&] {
    check_out(io, sizeof(rdm_shape_info), "io");
    const auto& shapes = p->pool->task().scene().shapes;
    need_index(i, static_cast<int64_t>(shapes.size()), "i");
    const SceneShape& s = shapes[static_cast<size_t>(i)];
    rdm_shape_info o{};
    o.kind = static_cast<int32_t>(s.def.kind);
    o.fixed = s.carrier == Carrier::kStatic;
    std::copy(s.def.color, s.def.color + 3, o.color);
    o.color[3] = 255;
    o.name = s.def.name.text;
    for (int k = 0; k < 3; ++k) o.size[k] = s.def.size[k];
    write_struct(io, o, sizeof(rdm_shape_info), "io");
  });
}

rdm_result rdm_pool_get_hull(const rdm_pool* p, int32_t i, float* points, size_t capacity, size_t* count) {
  return call_on(p, [&] {
    need(count, "count");
    const Scene& scene = p->pool->task().scene();
    need_index(i, static_cast<int64_t>(scene.shapes.size()), "i");
    const Hull* hull = scene.hull_of(scene.shapes[static_cast<size_t>(i)]);
    if (!hull) fail(Code::kArgument, "i: shape %d is not a hull", i);
    need_room(points, capacity, "points");
    *count = static_cast<size_t>(hull->num_points);
    for (size_t k = 0; k < std::min(capacity, *count); ++k) to_floats(hull->points[k], points + 3 * k);
  });
}

rdm_result rdm_pool_get_poses(const rdm_pool* p, int32_t env, rdm_pose* poses) {
  return call_on(p, [&] {
    const World& world = world_of(p, env);
    need(poses, "poses");
    const auto count = static_cast<int32_t>(world.scene().shapes.size());
    for (int32_t i = 0; i < count; ++i) poses[i] = to_abi(world.shape_pose(i));
  });
}

// Of 0.1, which has no memory for doubles; deprecated.h says why it is a function of its own.
rdm_result rdm_pool_poses(const rdm_pool* p, int32_t env, float* pose) {
  return call_on(p, [&] {
    const World& world = world_of(p, env);
    need(pose, "pose");
    const auto count = static_cast<int32_t>(world.scene().shapes.size());
    for (int32_t i = 0; i < count; ++i, pose += 7) {
      const rdm_pose X = to_abi(world.shape_pose(i));
      std::transform(X.p, X.p + 3, pose, [](double v) { return static_cast<float>(v); });
      std::transform(X.q, X.q + 4, pose + 3, [](double v) { return static_cast<float>(v); });
    }
  });
}

rdm_result rdm_pool_get_contacts(const rdm_pool* p, int32_t env, rdm_contact* out, size_t capacity,
                                 size_t* count) {
  return call_on(p, [&] {
    const World& world = world_of(p, env);
    need(count, "count");
    need_room(out, capacity, "out");
    *count = static_cast<size_t>(world.num_contacts());
    for (size_t i = 0; i < std::min(capacity, *count); ++i) {
      const Contact& c = world.contacts()[i];
      rdm_contact o{};
      o.shape_a = c.shape_a;
      o.shape_b = c.shape_b;
      to_floats(c.p, o.position);
      to_floats(c.n, o.normal);
      to_floats(c.force, o.force);
      o.depth = static_cast<float>(c.depth);
      out[i] = o;
    }
  });
}

rdm_result rdm_pool_raycast(const rdm_pool* p, int32_t env, const double origin[3], const double direction[3],
                            double range, rdm_ray_hit* io) {
  return call_on(p, [&] {
    const World& world = world_of(p, env);
    need(origin, "origin");
    need(direction, "direction");
    check_out(io, sizeof(rdm_ray_hit), "io");
    const Vec3 from{origin[0], origin[1], origin[2]}, along{direction[0], direction[1], direction[2]};
    if (!bounded(from))
      fail(Code::kArgument, "origin: it is not finite, or its magnitude is above %g", kStateBound);
    const double length = norm(along);
    if (!(length > 0 && std::isfinite(length)))
      fail(Code::kArgument, "direction: its length is 0 or not finite");
    if (!(range > 0)) fail(Code::kRange, "range: %g is not above 0", range);
    RayHit hit;
    rdm_ray_hit out{};
    out.shape = -1;
    out.distance = std::numeric_limits<double>::quiet_NaN();
    std::fill_n(out.point, 3, out.distance);
    std::fill_n(out.normal, 3, out.distance);
    if (cast_ray(world, from, (1 / length) * along, range, &hit)) {
      out.shape = hit.shape;
      out.distance = hit.distance;
      for (int k = 0; k < 3; ++k) out.point[k] = hit.p[k], out.normal[k] = hit.n[k];
    }
    write_struct(io, out, sizeof(rdm_ray_hit), "io");
  });
}

rdm_result rdm_pool_push(rdm_pool* p, int32_t env, int32_t shape, const float force[3]) {
  return call_on(p, [&] {
    World& world = world_of(p, env);
    need(force, "force");
    const auto& shapes = world.scene().shapes;
    need_index(shape, static_cast<int64_t>(shapes.size()), "shape");
    const SceneShape& s = shapes[static_cast<size_t>(shape)];
    const Vec3 f{force[0], force[1], force[2]};
    if (!finite(f)) fail(Code::kArgument, "force is not finite");
    if (!world.scene().moves(s)) fail(Code::kArgument, "shape: %s never moves", s.def.name.text);
    if (s.carrier == Carrier::kBody)
      world.push_body(s.index, f, {});
    else if (s.carrier == Carrier::kBase)
      world.push_base(s.articulation, f, {});
    else
      world.push_link(s.index, f, world.link(s.index).X * world.scene().link(s.index).inertia.com);
  });
}
#elif RDM_STUBS
rdm_result rdm_pool_poses(const rdm_pool* p, int32_t env, float*) {
  return rdm_pool_get_poses(p, env, nullptr);
}
#endif
