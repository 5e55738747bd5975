// N worlds of one task, stepped together over the workers, with buffers, episodes and autoreset. Mirrors
// rdm_pool_*; all memory is carved at creation, step allocates nothing.
#pragma once
#include <cstdint>

#include "base/arena.hpp"
#include "base/memory_block.hpp"
#include "base/workers.hpp"
#include "env/observer.hpp"
#include "env/task.hpp"

namespace rdm {

enum class Autoreset : int32_t { kSameStep = 0, kNextStep = 1, kOff = 2 };
inline constexpr uint32_t kStatusBadAction = 4u;
inline constexpr uint32_t kStatusTask = 8u;  // a function of a host's task failed

struct PoolConfig {
  int32_t num_envs = 1, num_threads = 0;
  const char* task = nullptr;
  uint64_t seed = 0;
  Autoreset autoreset = Autoreset::kSameStep;
  const OptionInput* options = nullptr;
  int32_t num_options = 0;
  const char* settings = nullptr;  // lines key=value, laid over the options
  int32_t group_size = 0;  // worlds that the engine steps together, at most; 0: as many as it likes to
  HostHooks hooks;
  void* user = nullptr;  // handed on to the task of a host
};

// The arrays of a pool, with the meaning and shapes of rdm_buffers, each named here alone: F(type, member,
// entries of a world's row). width_obs, width_action and width_cost are the dimensions where it is used.
#define RDM_POOL_BUFFERS(F)          \
  F(float, obs, width_obs)           \
  F(float, final_obs, width_obs)     \
  F(float, action, width_action)     \
  F(float, reward, 1)                \
  F(float, cost, width_cost)         \
  F(float, cost_raw, width_cost)     \
  F(float, episode_return, 1)        \
  F(float, episode_cost, width_cost) \
  F(int32_t, episode_step, 1)        \
  F(uint32_t, status, 1)             \
  F(uint32_t, episode_status, 1)     \
  F(uint8_t, terminated, 1)          \
  F(uint8_t, truncated, 1)           \
  F(uint8_t, success, 1)

struct Buffers {
#define RDM_MEMBER(type, name, width) type* name = nullptr;
  RDM_POOL_BUFFERS(RDM_MEMBER)
#undef RDM_MEMBER
};

struct PoolStats {
  int32_t contacts_max = 0;
  double contacts_mean = 0, joint_drift = 0;
  double solver_residual = 0;  // m/s; NaN: the engine does not measure it
  int64_t steps = 0, diverged = 0, overflowed = 0, bad_actions = 0, task_failed = 0, unconverged = 0,
          slowed = 0;
  int64_t violations = 0;  // control steps in which column 0, or a cost with a limit, was above 0
};

enum class Baseline : int32_t { kZero = 0, kHold = 1, kRandom = 2 };

class Pool {
 public:
  // Validates the config, whose hooks must be those of `count`: takes from it what create takes from its hooks,
  // in the same order, and at last what `side` says (null: nothing) that whoever makes the pool takes beside
  // it. *engines: bytes that these take, an estimate; may be null.
  using SideBytes = size_t(const Task& task, const TaskInfo& info);
  static void measure(const PoolConfig& config, MemoryCount* count, size_t* engines,
                      SideBytes* side = nullptr);
  static Pool* create(const PoolConfig& config);
  static void destroy(Pool* p);

  const Task& task() const;
  int32_t task_index() const;
  const Options& options() const;
  uint64_t options_hash() const;     // task name and every option's value
  const PoolConfig& config() const;  // pointers inside are not valid any more
  int32_t obs_dim() const;
  int32_t cost_dim() const;
  // As Task::guard_at; none where actions are delayed, as what is done is then not what is asked for.
  bool guard_at(int32_t i, Guard* guard, float* normal) const;
  int32_t repeat() const;            // control steps of one step, at most
  double limit(int32_t env) const;   // as Task::limit of the world's episode
  int32_t taken(int32_t env) const;  // control steps of the world's last step; 0: it was a reset
  // Sum over these of a cost's measured value where it is above 0.
  double magnitude(int32_t env, int32_t cost) const;
  const Buffers& buffers() const;
  const SenseConfig& sense() const;
  const SenseBuffers& sensed() const;  // written by reset and step
  void bind(const Buffers& host);      // non-null pointers take over; contents are copied

  // A seed that is given names the streams alone, as of the only world of a pool. Where the task of a host
  // fails in it: the error of the lowest such world, which is as a new one then; the others have begun.
  void reset(const uint64_t* seeds, const uint8_t* mask);
  // A world in which the task of a host fails is truncated with kStatusTask, and the others go on.
  void step(const uint8_t* mask);             // null: all
  const char* task_error(int32_t env) const;  // what failed last in a world; "": nothing so far
  // Episodes begin, with probability `share`, at one of `count` states of single worlds, each of so many
  // bytes; they are copied. Error(kFormat) where one is no running world's of this pool: nothing changes.
  // mark tells such sets apart. count -1: the states stay.
  void set_starts(const unsigned char* states, size_t state_bytes, int64_t count, uint64_t mark,
                  double share);
  void baseline(Baseline kind);

  size_t state_size(int32_t env) const;
  void get_state(int32_t env, Writer& out) const;               // env -1: all
  void set_state(int32_t env, const void* bytes, size_t size);  // all checks before any change
  // The worlds are a part of those of `ranks` pools of as many: so their streams are numbered, and a state of
  // all is one of which set_state takes this part. Error(kState) after the first reset.
  void set_rank(int32_t rank, int32_t ranks);
  int32_t rank() const;
  int32_t ranks() const;
  // The state of all worlds of pools, from each one's of its own, in their order.
  struct StateBytes {
    const unsigned char* bytes;
    size_t size;
  };
  static void join_states(const StateBytes* parts, int32_t count, Writer& out);
  uint64_t hash(int32_t env) const;
  // World `env` (-1: every one) becomes world `source` of a pool of the same task and options, which may be
  // this one: what set_state(get_state) does, with the rows of the last step too. Error(kArgument) for a pool
  // that differs, Error(kRange) for a world that is not there. No heap use.
  void copy(int32_t env, const Pool& from, int32_t source);
  // In the middle of an episode, what a world draws for itself is drawn anew from `stream`: its dynamics, and the
  // noise to come of what it shows and does.
  void redraw(int32_t env, Stream& stream);
  // Error(kArgument) for a pool that differs, by the names of the two.
  void need_same(const Pool& from, const char* name, const char* own) const;
  // Of the episode that runs in a world, or has ended there: control steps so far, sums of rewards and of a
  // cost; running: false after its end.
  bool running(int32_t env) const;
  bool begun(int32_t env) const;  // it was reset
  int32_t episode_step(int32_t env) const;
  double gained(int32_t env) const;
  double spent(int32_t env, int32_t cost) const;
  // Task::set_limit of the episode that runs in a world, -1: in each. Error(kState) where none does: nothing changes.
  void set_limit(int32_t env, double limit);
  // Which of the pool's episodes a world is in: it stays while the episode does, and in saved states and copies.
  // Episodes that draw nothing at their reset may have the same one.
  uint64_t episode_mark(int32_t env) const;
  // A number that stays while steps alone move a world: resets, saved states, copies and set_joints change it.
  uint32_t course(int32_t env) const;
  // As World::place_joints; the observation is then of these, and the world's other rows are those of no step.
  // Error(kState) where no episode runs; that of a host's task that fails to observe, whose row stays.
  void set_joints(int32_t env, const double* q, const double* qd);

  World& world(int32_t env);
  const World& world(int32_t env) const;
  PoolStats stats() const;
  int64_t violations() const;  // of the stats, without measuring worlds
  int64_t violations(int32_t env) const;
  Workers& workers();

 private:
  Pool();
  ~Pool();
  static void end(Pool* p, const HostHooks& hooks);
  struct Impl;
  friend struct Impl;
  Impl* impl_;
};

}  // namespace rdm
