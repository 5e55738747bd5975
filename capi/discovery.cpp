// What exists: tasks, algorithms, robots, objects, and their tables.
#include "capi/handles.hpp"
#if RDM_WITH_SIM
#include <array>
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "base/lasting.hpp"
#include "env/dynamics_shown.hpp"
#include "env/options/budget.hpp"
#include "env/options/disturb.hpp"
#include "env/options/repeat.hpp"
#include "robot/robots.hpp"
#include "tasks/catalog.hpp"
#endif

using namespace rdm;
using namespace rdm::capi;

#if RDM_WITH_SIM
namespace {

TaskRef ref_at(int32_t index) {
  register_builtin_tasks();
  return TaskRef(index);
}

struct OptionTableView {
  const OptionSpec* rows;
  int32_t count;
};
// A task's own, and those that every task has.
std::array<OptionTableView, 6> tables_of(const TaskInfo& info) {
  std::array<OptionTableView, 6> t;
  t[0].rows = task_options(info, &t[0].count);
  t[1].rows = sense_options(&t[1].count);
  t[2].rows = repeat_options(&t[2].count);
  t[3].rows = disturb_options(&t[3].count);
  t[4].rows = budget_options(&t[4].count);
  t[5].rows = dynamics_options(&t[5].count);
  return t;
}

// What a task with its default options has.
struct Described {
  rdm_task task{};
  std::vector<rdm_field_info> fields;
};

Described describe(const TaskInfo& info) {
  Options options;
  for (const OptionTableView& table : tables_of(info)) options.add_table(table.rows, table.count);
  const TaskHandle task = make_task(info, options, host());
  Described d;
  d.task.control_dt = static_cast<float>(task->scene().control_dt());
  d.task.name = lasting(info.name);
  d.task.summary = lasting(info.summary);
  d.task.obs_dim = obs_dim(*task);
  d.task.action_dim = task->action_dim();
  d.task.cost_dim = info.num_costs;
  d.task.max_steps = task->max_steps();
  d.task.num_fields = static_cast<int32_t>(task->fields().size());
  d.task.num_options = options.count();
  d.task.num_cameras = info.num_cameras;
  d.task.num_defaults = info.num_defaults;
  d.task.action_order = lasting(task->action_order());
  for (int32_t i = 0; i < d.task.num_fields; ++i) {
    d.fields.push_back(field_of(*task, i));
    d.fields.back().name = lasting(d.fields.back().name);
    d.fields.back().unit = lasting(d.fields.back().unit);
  }
  return d;
}

// Made when it is first asked for and kept as long as the task is listed.
struct Known {
  std::mutex mutex;
  std::map<int32_t, std::shared_ptr<const Described>> tasks;
};
Known& known() {
  static auto* const all = new Known;
  return *all;
}

std::shared_ptr<const Described> described(int32_t index) {
  const TaskRef info = ref_at(index);
  Known& k = known();
  {
    const std::lock_guard lock(k.mutex);
    const auto it = k.tasks.find(index);
    if (it != k.tasks.end()) return it->second;
  }
  auto made = std::make_shared<const Described>(describe(*info));  // takes a while, and may call the host
  const std::lock_guard lock(k.mutex);
  if (!task_listed(index)) return made;  // removed meanwhile, and forgotten
  return k.tasks.try_emplace(index, std::move(made)).first->second;
}

}  // namespace

void rdm::capi::forget_task(int32_t index) {
  Known& k = known();
  const std::lock_guard lock(k.mutex);
  k.tasks.erase(index);
}

int32_t rdm_task_count(void) {
  int32_t n = 0;
  call([&] {
    register_builtin_tasks();
    n = task_count();
  });
  return n;
}

rdm_result rdm_task_at(int32_t index, rdm_task* io) {
  return call([&] {
    check_out(io, kFirstTaskSize, "io");
    write_struct(io, described(index)->task, kFirstTaskSize, "io");
  });
}

rdm_result rdm_task_find(const char* name, int32_t* index) {
  return call([&] {
    need(name, "name");
    need(index, "index");
    register_builtin_tasks();
    *index = task_find(name);
  });
}

rdm_result rdm_task_field_at(int32_t task, int32_t i, rdm_field_info* io) {
  return call([&] {
    check_out(io, sizeof(rdm_field_info), "io");
    const auto d = described(task);
    need_index(i, d->task.num_fields, "i");
    write_struct(io, d->fields[static_cast<size_t>(i)], sizeof(rdm_field_info), "io");
  });
}

rdm_result rdm_task_cost_at(int32_t task, int32_t i, rdm_cost_info* io) {
  return call([&] {
    check_out(io, sizeof(rdm_cost_info), "io");
    const TaskRef ref = ref_at(task);
    const TaskInfo& info = *ref;
    need_index(i, info.num_costs, "i");
    rdm_cost_info o{};
    o.name = lasting(info.costs[i].name);
    o.help = lasting(info.costs[i].help);
    o.limit = info.costs[i].limit;
    write_struct(io, o, sizeof(rdm_cost_info), "io");
  });
}

rdm_result rdm_task_option_at(int32_t task, int32_t i, rdm_option_spec* io) {
  return call([&] {
    check_out(io, sizeof(rdm_option_spec), "io");
    const TaskRef info = ref_at(task);
    const auto tables = tables_of(*info);
    int32_t count = 0;
    for (const OptionTableView& t : tables) count += t.count;
    need_index(i, count, "i");
    rdm_option_spec o{};
    for (const OptionTableView& t : tables) {
      if (i >= 0 && i < t.count) o = describe(t.rows[i]);
      i -= t.count;
    }
    for (const char** text : {&o.key, &o.help, &o.text, &o.choices}) *text = lasting(*text);
    write_struct(io, o, sizeof(rdm_option_spec), "io");
  });
}

rdm_camera_info rdm::capi::describe(const CameraSpec& c) {
  rdm_camera_info o{};
  o.mount = c.mount;
  o.name = c.name;
  for (int k = 0; k < 3; ++k) {
    o.eye[k] = static_cast<float>(c.eye[k]);
    o.target[k] = static_cast<float>(c.target[k]);
    o.up[k] = static_cast<float>(c.up[k]);
  }
  o.fov_y = static_cast<float>(c.fov_y);
  o.cx = static_cast<float>(c.cx);
  o.cy = static_cast<float>(c.cy);
  return o;
}

rdm_result rdm_task_camera_at(int32_t task, int32_t i, rdm_camera_info* io) {
  return call([&] {
    check_out(io, sizeof(rdm_camera_info), "io");
    const TaskRef ref = ref_at(task);
    const TaskInfo& info = *ref;
    need_index(i, info.num_cameras, "i");
    rdm_camera_info o = describe(info.cameras[i]);
    o.name = lasting(o.name);
    write_struct(io, o, sizeof(rdm_camera_info), "io");
  });
}

rdm_result rdm_task_default_at(int32_t task, int32_t i, rdm_option* out) {
  return call([&] {
    need(out, "out");
    const TaskRef ref = ref_at(task);
    const TaskInfo& info = *ref;
    need_index(i, info.num_defaults, "i");
    *out = {lasting(info.defaults[i].key), lasting(info.defaults[i].value), 0};
  });
}

int32_t rdm_robot_count(void) {
  return num_robots();
}

rdm_result rdm_robot_at(int32_t index, rdm_robot* io) {
  return call([&] {
    check_out(io, sizeof(rdm_robot), "io");
    const RobotRef ref(index);
    const Robot& r = *ref;
    rdm_robot o{};
    o.num_joints = r.links.count;
    o.num_actuated = r.num_actuated();
    o.name = lasting(r.name);
    o.summary = lasting(r.help);
    write_struct(io, o, sizeof(rdm_robot), "io");
  });
}
#endif

#if RDM_WITH_LEARN
#include "algos/core/agent_types.hpp"

int32_t rdm_algo_count(void) {
  return algo_count();
}

rdm_result rdm_algo_at(int32_t index, rdm_algo* io) {
  return call([&] {
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
  return call([&] {
    need(name, "name");
    need(index, "index");
    *index = algo_find(name);
  });
}

rdm_result rdm_algo_option_at(int32_t algo, int32_t i, rdm_option_spec* io) {
  return call([&] {
    check_out(io, sizeof(rdm_option_spec), "io");
    need_index(algo, algo_count(), "algo");
    const AlgoInfo& a = algo_at(algo);
    need_index(i, a.num_options, "i");
    write_struct(io, describe(a.options[i]), sizeof(rdm_option_spec), "io");
  });
}
#endif
