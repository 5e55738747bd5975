// rdm_world_* and rdm_random_*: a world as the functions of a host's task see it.
#include <cmath>

#include "base/bit_cast.hpp"
#include "capi/own_task.hpp"
#include "capi/pose.hpp"
#if RDM_WITH_SIM
#include "physics/gravity_torques.hpp"
#endif

#if RDM_WITH_SIM
using namespace rdm;
using namespace rdm::capi;

namespace {

void put_motion(const Motion& m, rdm_motion* out) {
  out->pose = to_abi(m.X);
  put(m.v, out->v);
  put(m.w, out->w);
}
void to_floats(const Vec3& v, float out[3]) {
  for (int k = 0; k < 3; ++k) out[k] = static_cast<float>(v[k]);
}

World& look(const rdm_world* world) {
  need_handle(world);
  return *world->world;
}
World& change(rdm_world* world) {
  need_handle(world);
  if (world->fixed) fail(Code::kState, "world: it cannot be changed in observe");
  return *world->world;
}

Motion motion_from(const rdm_motion* in) {
  need(in, "motion");
  return {from_abi(in->pose), vec(in->v), vec(in->w)};
}

Vec3 need_vector(const double* v, const char* name) {
  need(v, name);
  const Vec3 out = vec(v);
  if (!finite(out)) fail(Code::kArgument, "%s is not finite", name);
  return out;
}

void need_robot(const World& w, int32_t robot) {
  need_index(robot, static_cast<int64_t>(w.scene().def.articulations.size()), "robot");
}
void need_free_base(const World& w, int32_t robot) {
  need_robot(w, robot);
  const ArticulationDef& def = w.scene().def.articulations[static_cast<size_t>(robot)];
  if (!def.free_base) fail(Code::kState, "robot %s: its base is fixed and cannot be moved", def.name.text);
}
void need_numbers(const double* x, size_t n, size_t wanted, const char* name) {
  if (n != wanted) fail(Code::kRange, "n: there are %zu %s, but the robot has %zu", n, name, wanted);
  need(x, name);
}

void need_joints(const World& w, int32_t first, size_t n) {
  const int32_t all = w.scene().num_links;
  if (first < 0 || first > all || n > static_cast<size_t>(all - first))
    fail(Code::kRange, "first, n: %zu joints from %d on are more than the %d that there are", n, first, all);
}

double* place_of(const rdm_factor& f, int64_t materials, Dynamics* d) {
  const auto link = [&] { return need_index(f.index, d->num_links, "link"), &d->links[f.index]; };
  const auto base = [&] { return need_index(f.index, d->num_bases, "robot"), &d->bases[f.index]; };
  const auto body = [&] { return need_index(f.index, d->num_bodies, "body"), &d->bodies[f.index]; };
  switch (f.what) {
    case RDM_SCALE_GRAVITY:
      return &d->gravity;
    case RDM_SCALE_LINK_MASS:
      return &link()->mass;
    case RDM_SCALE_LINK_KP:
      return &link()->kp;
    case RDM_SCALE_LINK_KD:
      return &link()->kd;
    case RDM_SCALE_LINK_EFFORT:
      return &link()->effort;
    case RDM_SCALE_LINK_FRICTION:
      return &link()->friction;
    case RDM_SCALE_BASE_MASS:
      return &base()->mass;
    case RDM_SCALE_BASE_DAMPING:
      return &base()->damping;
    case RDM_SCALE_BODY_MASS:
      return &body()->mass;
    case RDM_SCALE_BODY_SIZE:
      return &body()->size;
    case RDM_SCALE_BODY_LINEAR_DAMPING:
      return &body()->linear_damping;
    case RDM_SCALE_BODY_ANGULAR_DAMPING:
      return &body()->angular_damping;
    case RDM_SCALE_FRICTION:
      need_index(f.index, materials, "index");
      need_index(f.other, materials, "other");
      return &d->friction[Dynamics::friction_index(f.index, f.other)];
    default:
      fail(Code::kRange, "what: %d is outside [0, 12]", f.what);
  }
}

template <class F>
auto draw(rdm_random* random, F&& f) -> decltype(f(std::declval<Stream&>())) {
  if (!random) return 0;
  auto s = rdm::bit_cast<Stream>(*random);
  const auto out = f(s);
  *random = rdm::bit_cast<rdm_random>(s);
  return out;
}

}  // namespace

int32_t rdm_world_number(const rdm_world* world) {
  return is_handle(world) ? world->world->number() : -1;
}

void* rdm_world_user(const rdm_world* world) {
  return is_handle(world) ? world->scene->user : nullptr;
}

rdm_result rdm_world_get_joints(const rdm_world* world, rdm_joints* io) {
  return call_inside([&] {
    const World& w = look(world);
    rdm_joints j{};
    j.count = w.scene().num_links;
    j.control_dt = w.scene().control_dt();
    j.q = w.q();
    j.qd = w.qd();
    j.target = w.target();
    j.torque = w.torque();
    write_struct(io, j, sizeof(rdm_joints), "io");
  });
}

rdm_result rdm_world_get_link(const rdm_world* world, int32_t link, rdm_motion* out) {
  return call_inside([&] {
    const World& w = look(world);
    need(out, "out");
    need_index(link, w.scene().num_links, "link");
    put_motion(w.link(link), out);
  });
}

rdm_result rdm_world_get_base(const rdm_world* world, int32_t robot, rdm_motion* out) {
  return call_inside([&] {
    const World& w = look(world);
    need(out, "out");
    need_robot(w, robot);
    put_motion(w.base(robot), out);
  });
}

rdm_result rdm_world_get_body(const rdm_world* world, int32_t body, rdm_motion* out) {
  return call_inside([&] {
    const World& w = look(world);
    need(out, "out");
    need_index(body, w.scene().num_bodies, "body");
    put_motion(w.body(body), out);
  });
}

rdm_result rdm_world_get_shape(const rdm_world* world, int32_t shape, rdm_pose* out) {
  return call_inside([&] {
    const World& w = look(world);
    need(out, "out");
    need_index(shape, static_cast<int64_t>(w.scene().shapes.size()), "shape");
    *out = to_abi(w.shape_pose(shape));
  });
}

rdm_result rdm_world_get_sensor(const rdm_world* world, int32_t sensor, double force[3], double torque[3]) {
  return call_inside([&] {
    const World& w = look(world);
    need_index(sensor, static_cast<int64_t>(w.scene().sensors.size()), "sensor");
    need(force, "force");
    need(torque, "torque");
    const Wrench& s = w.sensor(sensor);
    put(s.force, force);
    put(s.torque, torque);
  });
}

rdm_result rdm_world_get_touch(const rdm_world* world, int32_t group, int32_t* pairs, double* force) {
  return call_inside([&] {
    const World& w = look(world);
    need_index(group, static_cast<int64_t>(world->scene->groups.size()), "group");
    const TouchGroup& g = world->scene->groups[static_cast<size_t>(group)];
    if (pairs) {
      int32_t touched = 0;
      for (const int32_t pair : g.pairs) touched += w.pair_touched(pair);
      *pairs = touched;
    }
    if (!force) return;
    double sum = 0;
    for (int32_t i = 0; i < w.num_contacts(); ++i) {
      const Contact& c = w.contacts()[i];
      const uint8_t x = g.sides[static_cast<size_t>(c.shape_a)], y = g.sides[static_cast<size_t>(c.shape_b)];
      if (((x & 1) && (y & 2)) || ((x & 2) && (y & 1))) sum += norm(c.force);
    }
    *force = sum;
  });
}

rdm_result rdm_world_get_contacts(const rdm_world* world, rdm_contact* out, size_t capacity, size_t* count) {
  return call_inside([&] {
    const World& w = look(world);
    need(count, "count");
    need_room(out, capacity, "out");
    *count = static_cast<size_t>(w.num_contacts());
    for (size_t i = 0; i < std::min(capacity, *count); ++i) {
      const Contact& c = w.contacts()[i];
      out[i].shape_a = c.shape_a;
      out[i].shape_b = c.shape_b;
      to_floats(c.p, out[i].position);
      to_floats(c.n, out[i].normal);
      to_floats(c.force, out[i].force);
      out[i].depth = static_cast<float>(c.depth);
    }
  });
}

rdm_result rdm_world_get_overlap(rdm_world* world, int32_t body, double* depth) {
  return call_inside([&] {
    World& w = change(world);
    need(depth, "depth");
    need_index(body, w.scene().num_bodies, "body");
    *depth = w.body_overlap(body);
  });
}

rdm_result rdm_world_set_body(rdm_world* world, int32_t body, const rdm_motion* motion) {
  return call_inside([&] {
    World& w = change(world);
    need_index(body, w.scene().num_bodies, "body");
    w.set_body(body, motion_from(motion));
  });
}

rdm_result rdm_world_set_base(rdm_world* world, int32_t robot, const rdm_motion* motion) {
  return call_inside([&] {
    World& w = change(world);
    need_free_base(w, robot);
    w.set_base(robot, motion_from(motion));
  });
}

rdm_result rdm_world_set_joints(rdm_world* world, int32_t robot, const double* q, const double* qd,
                                size_t n) {
  return call_inside([&] {
    World& w = change(world);
    need_robot(w, robot);
    const auto a = static_cast<size_t>(robot);
    need_numbers(q, n, w.scene().def.articulations[a].links.size(), "q");
    const double still[kMaxRobotLinks] = {};
    w.set_joints(robot, q, qd ? qd : still);
    const int32_t first = w.scene().link_offset[a];
    for (int32_t i = 0; i < static_cast<int32_t>(n); ++i) {
      const JointDef& joint = w.scene().link(first + i).joint;
      w.target()[first + i] = std::clamp(q[i], joint.lower, joint.upper);
    }
  });
}

rdm_result rdm_world_set_targets(rdm_world* world, int32_t first, const double* targets, size_t n) {
  return call_inside([&] {
    World& w = change(world);
    need_joints(w, first, n);
    if (n > 0) need(targets, "targets");
    for (size_t i = 0; i < n; ++i)
      if (!bounded(targets[i], kStateBound))
        fail(Code::kArgument, "targets[%zu] is not finite or beyond %g", i, kStateBound);
    std::copy_n(targets, n, w.target() + first);
  });
}

rdm_result rdm_world_set_commands(rdm_world* world, int32_t robot, const double* commands, size_t n) {
  return call_inside([&] {
    World& w = change(world);
    need_robot(w, robot);
    const PlacedRobot& r = world->scene->robots[static_cast<size_t>(robot)];
    need_numbers(commands, n, r.commands.size(), "commands");
    for (size_t i = 0; i < n; ++i)
      if (!std::isfinite(commands[i])) fail(Code::kArgument, "commands[%zu] is not finite", i);
    double* target = w.target();
    for (size_t i = 0; i < n; ++i) {
      const PlacedRobot::Command& c = r.commands[i];
      const double a =
          c.curve ? c.curve->at(commands[i])
                  : std::clamp(c.lower + 0.5 * (commands[i] + 1) * (c.upper - c.lower), c.lower, c.upper);
      const double before = target[c.joint];
      target[c.joint] = std::clamp(a, before - c.rate, before + c.rate);
    }
    for (const PlacedRobot::Follower& f : r.followers) target[f.joint] = f.curve->at(commands[f.command]);
  });
}

rdm_result rdm_world_set_feedforward(rdm_world* world, int32_t first, const double* efforts, size_t n) {
  return call_inside([&] {
    World& w = change(world);
    if (!w.feedforward())
      fail(Code::kState,
           "world: its scene has no feed-forward; call rdm_scene_set_feedforward when it is built");
    need_joints(w, first, n);
    if (n > 0) need(efforts, "efforts");
    for (size_t i = 0; i < n; ++i)
      if (!bounded(efforts[i], kFeedforwardBound))
        fail(Code::kArgument, "efforts[%zu] is not finite or beyond %g", i, kFeedforwardBound);
    std::copy_n(efforts, n, w.feedforward() + first);
  });
}

rdm_result rdm_world_get_gravity(const rdm_world* world, int32_t robot, double* efforts, size_t n) {
  return call_inside([&] {
    const World& w = look(world);
    need_robot(w, robot);
    const auto links = w.scene().def.articulations[static_cast<size_t>(robot)].links.size();
    need_numbers(efforts, n, links, "efforts");
    gravity_torques(w, robot, efforts);
  });
}

rdm_result rdm_world_set_factors(rdm_world* world, const rdm_factor* factors, size_t count) {
  return call_inside([&] {
    World& w = change(world);
    if (!w.dynamics())
      fail(Code::kState,
           "world: its scene is not adjustable; call rdm_scene_set_adjustable when it is built");
    if (count > SIZE_MAX / 64) fail(Code::kRange, "count: %zu is too large", count);
    if (count > 0) need(factors, "factors");
    Dynamics& d = w.edit_dynamics();
    const auto materials = static_cast<int64_t>(world->scene->materials.size());
    for (size_t i = 0; i < count; ++i) check_reserved(factors[i], "factors");
    for (size_t i = 0; i < count; ++i) *place_of(factors[i], materials, &d) = factors[i].factor;
    w.set_dynamics(d);
  });
}

rdm_result rdm_world_push_body(rdm_world* world, int32_t body, const double force[3],
                               const double torque[3]) {
  return call_inside([&] {
    World& w = change(world);
    need_index(body, w.scene().num_bodies, "body");
    const Vec3 f = need_vector(force, "force"), t = need_vector(torque, "torque");
    w.push_body(body, f, t);
  });
}

rdm_result rdm_world_push_base(rdm_world* world, int32_t robot, const double force[3],
                               const double torque[3]) {
  return call_inside([&] {
    World& w = change(world);
    need_free_base(w, robot);
    const Vec3 f = need_vector(force, "force"), t = need_vector(torque, "torque");
    w.push_base(robot, f, t);
  });
}

rdm_result rdm_world_push_link(rdm_world* world, int32_t link, const double force[3], const double point[3]) {
  return call_inside([&] {
    World& w = change(world);
    need_index(link, w.scene().num_links, "link");
    const Vec3 f = need_vector(force, "force"), p = need_vector(point, "point");
    w.push_link(link, f, p);
  });
}

uint64_t rdm_random_bits(rdm_random* random) {
  return draw(random, [](Stream& s) { return s.next(); });
}

double rdm_random_uniform(rdm_random* random, double low, double high) {
  return draw(random, [&](Stream& s) { return s.uniform(low, high); });
}

double rdm_random_normal(rdm_random* random) {
  return draw(random, [](Stream& s) {
    float out = 0;
    s.normals(&out, 1);
    return static_cast<double>(out);
  });
}

rdm_result rdm_random_split(rdm_random* random, rdm_random* out) {
  return call_inside([&] {
    need(random, "random");
    need(out, "out");
    *out = rdm::bit_cast<rdm_random>(Stream(rdm_random_bits(random), 0, Purpose::kReset));
  });
}
#endif
