// What a task is to the pool: a constant description, and per world reset, control, observation, verdict.
//
// A task draws only from the stream it is given and keeps its per-world values in its own plain struct, which
// the pool carves, saves and restores as bytes.
#pragma once
#include <cstdint>
#include <limits>
#include <memory>

#include "base/error.hpp"
#include "base/option.hpp"
#include "base/rng.hpp"
#include "physics/world.hpp"

namespace rdm {

class OptionTable;

inline constexpr int kMaxTaskCosts = 16;

inline constexpr float kUnbounded = std::numeric_limits<float>::quiet_NaN();
struct FieldSpec {
  Name name;
  const char* unit;  // static
  int32_t count;
  // what no entry ever leaves; kUnbounded: nothing but the task's obs_limit
  float low = kUnbounded, high = kUnbounded;
};
struct CostSpec {
  const char* name;
  const char* help;
  double limit;  // default limit per episode, < 0: none
};
// As Camera (sense/render/camera.hpp).
struct CameraSpec {
  const char* name;
  Vec3 eye, target;  // m
  double fov_y;      // rad
  Vec3 up = {0, 0, 1};
  int32_t mount = 0;
  double cx = 0, cy = 0;
};
// What a task recommends: an option of agents, NAME:key of the algorithm NAME, or shield:key of shields.
struct LearnerDefault {
  const char* key;
  const char* value;
};

struct Verdict {
  double reward = 0;
  double cost[kMaxTaskCosts] = {};      // as the buffers have them
  double cost_raw[kMaxTaskCosts] = {};  // the measured value behind each
  bool terminated = false, success = false;
};

// The worlds that a task's function is called for at once; what it fills is there before.
struct TaskRows {
  int32_t count = 0;
  World** worlds = nullptr;     // [count]
  void** states = nullptr;      // [count]
  Code* codes = nullptr;        // [count] kOk, unless the function failed for that world alone; then
  char** texts = nullptr;       // [count] each [kErrorTextSize] says why
  Stream** streams = nullptr;   // [count] reset
  float* actions = nullptr;     // [count][action_dim] control: clipped
  int32_t* steps = nullptr;     // [count] judge
  Verdict* verdicts = nullptr;  // [count] judge
  float* obs = nullptr;         // [count][obs_dim] observe
};

// A half space of clipped actions, normal . a <= bound.
struct Guard {
  int32_t column = 0;  // of the cost that is 0 within it
  float bound = 0;
};

class DynamicsDraws;

// One task with its options laid in: constant after creation, shared by all worlds of a pool.
class Task {
 public:
  virtual ~Task() = default;
  virtual const Scene& scene() const = 0;
  virtual EngineKind engine() const = 0;
  virtual int32_t max_steps() const = 0;
  virtual int32_t action_dim() const = 0;
  virtual const Vector<FieldSpec>& fields() const = 0;  // in order; offsets are the running sums
  virtual const char* action_order() const = 0;         // joins the layout hash
  virtual size_t state_bytes() const = 0;               // of the task's per-world struct
  virtual size_t kept_bytes() const { return 0; }       // at its end, which a reset does not zero before
  // Error(kFormat) for a per-world struct that no world of this task can have: an index out of range, a
  // number that is not finite. Called for the bytes of a saved state before anything reads them; zeroed bytes
  // (a world that was never reset) and whatever reset, control and judge leave pass.
  virtual void check_state(const void* state) const = 0;
  virtual void reset(World& world, void* state, Stream& stream) const = 0;
  // Draws anew, in the middle of an episode, what a reset draws of the world's dynamics.
  virtual void redraw(World&, Stream&) const {}
  // Of what a reset draws of the world's dynamics; null: nothing.
  virtual const DynamicsDraws* draws() const { return nullptr; }
  // Clipped actions [action_dim] to drive targets (and base wrenches) of the next control step.
  virtual void control(World& world, void* state, const float* action) const = 0;
  // After the control step. `step` counts from 1 within the episode.
  virtual Verdict judge(World& world, void* state, int32_t step) const = 0;
  // Whoever asks for an observation then bounds its entries by +-obs_limit().
  virtual void observe(const World& world, const void* state, float* obs) const = 0;
  // Whether the pool calls these, on the thread that called it and for all worlds together, in the place of the
  // four above. An Error that comes out is every world's of the call.
  virtual bool takes_rows() const { return false; }
  virtual void reset_rows(const TaskRows&) const {}
  virtual void control_rows(const TaskRows&) const {}
  virtual void judge_rows(const TaskRows&) const {}
  virtual void observe_rows(const TaskRows&) const {}
  virtual float obs_limit() const { return std::numeric_limits<float>::infinity(); }
  // What the local grid of voxels is about, m: the first free body, unless the task knows better.
  virtual Vec3 focus(const World& world, const void* state) const;
  // Where the first free body is to be brought, of a task that has such a goal.
  virtual bool has_goal() const { return false; }
  virtual Pose goal_pose(const void*) const { return {}; }
  // Cameras on what moves, whose places follow from the options; names as those of the registry's row.
  virtual const Vector<CameraSpec>& mounted_cameras() const;
  // The hold action: the nominal start pose, base entries 0. [action_dim]
  virtual void hold_action(float* action) const = 0;
  // Mean action that a new policy starts from. [action_dim]
  virtual void initial_mean(float* action) const = 0;
  // Row i of the half spaces that costs of the action alone leave: while all those of a column are kept, from an
  // episode's first step on, its cost is 0 exactly, whatever else happens. normal [action_dim]. False: there are no
  // more.
  virtual bool guard_at(int32_t, Guard*, float*) const { return false; }
  // Row i of the ways to share the action out between the agents of a team: a key "groups.NAME", and the list as agents
  // read it (option groups). Both live as long as the task. False: there are no more.
  virtual bool group_set_at(int32_t, const char**, const char**) const { return false; }
  // The limit on column 0 that each episode draws for itself, of a world's state; null: what stands for all. Without
  // such draws the limit of all episodes, -1: that of the costs' table.
  virtual bool draws_limit() const { return false; }
  virtual double limit(const void*) const { return -1; }
  // Gives the episode of a world's state another limit in its middle, and shows it in its row of observations.
  // Error(kUnsupported) for a task that does not show limits, Error(kRange) for one that it may not have.
  virtual void set_limit(void*, double, float*) const {
    fail(Code::kUnsupported,
         "limit: these worlds do not observe one; option limit_range makes them, with budget");
  }
  // Entry of the action that drives a joint of the scene; -1: none, or nobody knows.
  virtual int32_t action_of(int32_t) const { return -1; }
};

// What stands behind a row that was added while the program runs, in the place of its three functions.
class TaskSource {
 public:
  virtual const struct TaskInfo& info() const = 0;
  virtual const OptionSpec* options(int32_t* count) const = 0;
  // `user` is the pool's.
  virtual Task* make(const Options& options, const HostHooks& hooks, void* user) const = 0;
  virtual void destroy(Task* task, const HostHooks& hooks) const = 0;
  virtual void end() noexcept = 0;  // it was removed and its last user is gone

 protected:
  ~TaskSource() = default;
};

// One row of the registry: static data, but for rows with a source.
struct TaskInfo {
  const char* name;
  const char* alias;  // Safety-Gymnasium's id, null: none
  const char* summary;
  // The table, static after the first call; with `chosen` given, filled there by what it says was chosen.
  const OptionSpec* (*options)(int32_t* count, OptionTable* chosen);
  const CostSpec* costs;
  int32_t num_costs;
  const CameraSpec* cameras;
  int32_t num_cameras;
  const LearnerDefault* defaults;
  int32_t num_defaults;
  Task* (*make)(const Options& options, const HostHooks& hooks);
  void (*destroy)(Task* task, const HostHooks& hooks);
  TaskSource* source = nullptr;  // of a row that was added
};
// Ends a task that make made with the same hooks.
struct EndTask {
  const TaskInfo* info = nullptr;
  HostHooks hooks;
  void operator()(Task* task) const;
};
using TaskHandle = std::unique_ptr<Task, EndTask>;
TaskHandle make_task(const TaskInfo& info, const Options& options, const HostHooks& hooks,
                     void* user = nullptr);
const OptionSpec* task_options(const TaskInfo& info, int32_t* count, OptionTable* chosen = nullptr);

// The rows by number and by name. Any number of threads may look while others add and remove; numbers:
// base/numbered.hpp.
void register_task(const TaskInfo& info);  // static data
// Error(kArgument) for a name that is taken; the source is then the caller's still.
int32_t add_task(TaskSource* source);
void remove_task(int32_t index);  // who holds a reference keeps it; Error(kArgument) for a static one
bool task_listed(int32_t index);
int32_t task_count();                    // one behind the last number
const TaskInfo& task_at(int32_t index);  // of an added task: as long as someone holds a reference
int32_t task_find(const char* name);     // Error(kNotFound) with the nearest name; aliases count

// While it lives, the task stays.
class TaskRef {
 public:
  TaskRef() = default;
  explicit TaskRef(int32_t index);  // Error(kRange); Error(kNotFound): it was destroyed
  TaskRef(const TaskRef&) = delete;
  TaskRef& operator=(const TaskRef&) = delete;
  TaskRef(TaskRef&& other) noexcept;
  TaskRef& operator=(TaskRef&& other) noexcept;
  ~TaskRef();
  const TaskInfo& operator*() const { return *info_; }
  const TaskInfo* operator->() const { return info_; }

 private:
  int32_t index_ = -1;  // of an added one
  const TaskInfo* info_ = nullptr;
};

int32_t obs_dim(const Task& task);
FieldSpec bounded_field(const Task& task, int32_t i);  // its bounds within obs_limit; kUnbounded: none
uint64_t layout_hash(const Task& task);                // field names, counts, action order, action count

}  // namespace rdm
