// What exists: tasks, algorithms, robots, objects, and their tables.
#include "capi/handles.hpp"
#if RDM_WITH_SIM
#include "robot/robot.hpp"
#include "tasks/catalog.hpp"
#include "tasks/throw/throw_objects.hpp"
#endif

using namespace rdm;
using namespace rdm::capi;

#if RDM_WITH_SIM
namespace rdm::capi {
rdm_field field_of(const Task& task, int32_t i);
}

namespace {

const TaskInfo& info_at(int32_t index) {
  register_builtin_tasks();
  need_index(index, task_count(), "task");
  return task_at(index);
}

// The task with its default options.
class DefaultTask {
 public:
  explicit DefaultTask(const TaskInfo& info) : info_(info) {
    PoolConfig config;
    config.task = info.name;
    config.hooks = hooks_;
    task_ = make_task(config);
  }
  ~DefaultTask() { info_.destroy(task_, hooks_); }
  DefaultTask(const DefaultTask&) = delete;
  DefaultTask& operator=(const DefaultTask&) = delete;
  const Task& operator*() const { return *task_; }
  const Task* operator->() const { return task_; }

 private:
  const TaskInfo& info_;
  HostHooks hooks_ = host();
  Task* task_ = nullptr;
};

}  // namespace

int32_t rdm_task_count(void) {
  int32_t n = 0;
  call(nullptr, [&] {
    register_builtin_tasks();
    n = task_count();
  });
  return n;
}

rdm_result rdm_task_at(int32_t index, rdm_task* io) {
  return call(nullptr, [&] {
    check_out(io, sizeof(rdm_task), "io");
    const TaskInfo& info = info_at(index);
    const DefaultTask task(info);
    rdm_task t{};
    t.control_dt = static_cast<float>(task->scene().control_dt());
    t.name = info.name;
    t.summary = info.summary;
    t.obs_dim = obs_dim(*task);
    t.action_dim = task->action_dim();
    t.cost_dim = info.num_costs;
    t.max_steps = task->max_steps();
    t.num_fields = static_cast<int32_t>(task->fields().size());
    info.options(&t.num_options);
    int32_t seen = 0;
    sense_options(&seen);
    t.num_options += seen;
    t.num_cameras = info.num_cameras;
    t.num_defaults = info.num_defaults;
    write_struct(io, t, sizeof(rdm_task), "io");
  });
}

rdm_result rdm_task_find(const char* name, int32_t* index) {
  return call(nullptr, [&] {
    need(name, "name");
    need(index, "index");
    register_builtin_tasks();
    *index = task_find(name);
  });
}

// The name of a field belongs to the task object, which is gone after the call: so it is handed out from a
// table that lives as long as the process.
rdm_result rdm_task_field(int32_t task, int32_t i, rdm_field* out) {
  return call(nullptr, [&] {
    need(out, "out");
    const DefaultTask t(info_at(task));
    rdm_field f = field_of(*t, i);
    f.name = lasting_name(f.name);
    *out = f;
  });
}

rdm_result rdm_task_cost(int32_t task, int32_t i, rdm_cost* out) {
  return call(nullptr, [&] {
    need(out, "out");
    const TaskInfo& info = info_at(task);
    need_index(i, info.num_costs, "i");
    *out = {info.costs[i].name, info.costs[i].help, info.costs[i].limit};
  });
}

rdm_result rdm_task_option(int32_t task, int32_t i, rdm_option_info* out) {
  return call(nullptr, [&] {
    need(out, "out");
    int32_t count = 0, seen = 0;
    const OptionSpec* specs = info_at(task).options(&count);
    const OptionSpec* sense = sense_options(&seen);
    need_index(i, count + seen, "i");
    *out = describe(i < count ? specs[i] : sense[i - count]);
  });
}

rdm_camera rdm::capi::describe(const CameraSpec& c) {
  rdm_camera o{};
  o.name = c.name;
  for (int k = 0; k < 3; ++k) {
    o.eye[k] = static_cast<float>(c.eye[k]);
    o.target[k] = static_cast<float>(c.target[k]);
  }
  o.fov_y = static_cast<float>(c.fov_y);
  return o;
}

rdm_result rdm_task_camera(int32_t task, int32_t i, rdm_camera* out) {
  return call(nullptr, [&] {
    need(out, "out");
    const TaskInfo& info = info_at(task);
    need_index(i, info.num_cameras, "i");
    *out = describe(info.cameras[i]);
  });
}

rdm_result rdm_task_default(int32_t task, int32_t i, rdm_option* out) {
  return call(nullptr, [&] {
    need(out, "out");
    const TaskInfo& info = info_at(task);
    need_index(i, info.num_defaults, "i");
    *out = {info.defaults[i].key, info.defaults[i].value, 0};
  });
}

int32_t rdm_robot_count(void) {
  return num_robots();
}

rdm_result rdm_robot_at(int32_t index, rdm_robot* io) {
  return call(nullptr, [&] {
    check_out(io, sizeof(rdm_robot), "io");
    need_index(index, num_robots(), "index");
    const Robot& r = robot(index);
    rdm_robot o{};
    o.num_joints = r.links.count;
    o.num_actuated = r.num_actuated();
    o.name = r.name;
    o.summary = r.help;
    write_struct(io, o, sizeof(rdm_robot), "io");
  });
}

rdm_result rdm_robot_joint(int32_t robot_index, int32_t i, rdm_joint* out) {
  return call(nullptr, [&] {
    need(out, "out");
    need_index(robot_index, num_robots(), "robot");
    const Robot& r = robot(robot_index);
    need_index(i, r.links.count, "i");
    const RobotLink& l = r.links[i];
    rdm_joint o{};
    o.name = l.joint;
    o.lower = l.lower;
    o.upper = l.upper;
    o.kp = r.coupled(i) ? 0 : l.kp;
    o.kd = l.kd;
    o.effort = l.effort;
    o.action = -1;
    for (int32_t k = 0; k < r.num_actuated(); ++k)
      if (r.actuated(k) == i) o.action = k;
    *out = o;
  });
}

int32_t rdm_object_count(void) {
  return throw_object_count();
}

rdm_result rdm_object_at(int32_t index, rdm_object* out) {
  return call(nullptr, [&] {
    need(out, "out");
    need_index(index, throw_object_count(), "index");
    const ThrowObject& o = throw_object_at(index);
    *out = {o.name, o.shape_text, o.mass};
  });
}
#endif

#if RDM_WITH_LEARN
#include "algos/core/agent_types.hpp"

int32_t rdm_algo_count(void) {
  return algo_count();
}

rdm_result rdm_algo_at(int32_t index, rdm_algo* io) {
  return call(nullptr, [&] {
    check_out(io, sizeof(rdm_algo), "io");
    need_index(index, algo_count(), "index");
    const AlgoInfo& a = algo_at(index);
    rdm_algo o{};
    o.num_options = a.num_options;
    o.name = a.name;
    o.summary = a.summary;
    write_struct(io, o, sizeof(rdm_algo), "io");
  });
}

rdm_result rdm_algo_find(const char* name, int32_t* index) {
  return call(nullptr, [&] {
    need(name, "name");
    need(index, "index");
    *index = algo_find(name);
  });
}

rdm_result rdm_algo_option(int32_t algo, int32_t i, rdm_option_info* out) {
  return call(nullptr, [&] {
    need(out, "out");
    need_index(algo, algo_count(), "algo");
    const AlgoInfo& a = algo_at(algo);
    need_index(i, a.num_options, "i");
    *out = describe(a.options[i]);
  });
}
#endif
