// The joints of robots and of a pool's worlds: what they are, where they are, and where they are put.
#include "capi/handles.hpp"
#include "capi/joint.hpp"

#if RDM_WITH_SIM
#include "base/lasting.hpp"
#include "robot/robots.hpp"

using namespace rdm;
using namespace rdm::capi;

static_assert(static_cast<int>(RDM_JOINT_PRISMATIC) == static_cast<int>(JointKind::kPrismatic));

namespace {

int32_t joints_of(const rdm_pool* p, int32_t env, size_t count) {
  need_index(env, p->pool->config().num_envs, "env");
  const int32_t joints = p->pool->task().scene().num_links;
  if (count != static_cast<size_t>(joints))
    fail(Code::kRange, "count: it is %zu, but the pool has %d joints", count, joints);
  return joints;
}

}  // namespace

rdm_result rdm_robot_joint_at(int32_t robot, int32_t i, rdm_joint_info* io) {
  return call([&] {
    const RobotRef ref(robot);
    const Robot& r = *ref;
    need_index(i, r.links.count, "i");
    const RobotLink& l = r.links[i];
    rdm_joint_info o = joint_info(l, r.coupled(i));
    o.name = lasting(l.joint);
    o.parent = l.parent;
    o.action = r.action_of(i);
    write_struct(io, o, sizeof(rdm_joint_info), "io");
  });
}

rdm_result rdm_pool_joint_at(const rdm_pool* p, int32_t i, rdm_joint_info* io) {
  return call_on(p, [&] {
    const Task& task = p->pool->task();
    const Scene& scene = task.scene();
    need_index(i, scene.num_links, "i");
    const JointDef& j = scene.link(i).joint;
    rdm_joint_info o = joint_info(j, j.coupled_to >= 0);
    o.name = j.name.text;
    o.parent = scene.frames[static_cast<size_t>(i)].parent;
    o.action = task.action_of(i);
    write_struct(io, o, sizeof(rdm_joint_info), "io");
  });
}

rdm_result rdm_pool_get_joints(const rdm_pool* p, int32_t env, double* q, double* qd, size_t count) {
  return call_on(p, [&] {
    const int32_t joints = joints_of(p, env, count);
    const World& world = p->pool->world(env);
    if (q) std::copy_n(world.q(), joints, q);
    if (qd) std::copy_n(world.qd(), joints, qd);
  });
}

rdm_result rdm_pool_set_joints(rdm_pool* p, int32_t env, const double* q, const double* qd, size_t count) {
  return call_on(p, [&] {
    joints_of(p, env, count);
    p->pool->set_joints(env, q, qd);
  });
}
#endif
