// The inside of a pool, shared by its source files.
#pragma once
#include "base/error.hpp"
#include "base/fpmode.hpp"
#include "env/disturbance.hpp"
#include "env/observer.hpp"
#include "env/resolved_config.hpp"

namespace rdm {

// Where a world stands between two calls.
enum class Phase : uint32_t {
  kNew = 0,  // never reset
  kRunning = 1,
  kEnded = 2,  // the episode is over: next-step mode resets it by itself, mode off waits for reset()
};

// One world's episode, part of the saved state.
struct Episode {
  uint64_t seed;
  Stream reset, policy;
  Phase phase;
  int32_t step;
  uint8_t terminated, truncated;  // as in the buffers while the phase is kEnded
  double sum_reward, sum_cost[kMaxTaskCosts];
};

struct Counters {
  int32_t contacts_max;
  int64_t contacts_sum, steps, diverged, overflowed, bad_actions, task_failed, unconverged, slowed;
  int64_t violations;
};

// Where episodes may begin, beside the task's own start.
struct Starts {
  Vector<unsigned char> records;  // [count][record_bytes] as write_world has them
  size_t record_bytes = 0;
  int64_t count = 0;
  uint64_t mark = 0;
  double share = 0;
};

// All that belongs to world i beside its buffer rows.
struct Slot {
  World* world;
  void* task_state;
  Episode episode;
  Counters counters;
  WorldDisturbance disturbance;
  Stream start;     // whether and where in Starts an episode begins
  uint32_t status;  // of the episode that runs, or has ended and waits for its reset: OR over its steps
  int32_t taken;    // control steps of the last step
  uint32_t
      course;  // changes whenever a reset or a new state breaks the sequence of steps (a shield's plan ends)
  double
      magnitude[kMaxTaskCosts];  // with option action_repeat: sums over these of cost_raw where it is above 0
  bool goes_on;                  // a further control step of this step would be of the same episode
};

inline constexpr int32_t kMaxGroup = 16;
inline constexpr int32_t kFewWorlds = 4;

// A reward or cost beyond it is as good as not finite; sums of an episode stay below the other, and both are
// finite as floats.
inline constexpr double kMaxVerdict = 1e20, kMaxSum = 1e30;

// What a worker needs to step worlds. It steps its own range of worlds first, then takes pieces of other workers'
// ranges; it works in the memory of the first world of its range.
struct alignas(Arena::kAlign) Block {
  float* action;  // [action_dim] clipped
  SenseScratch sense;
  // Worlds that have their targets and wait for the engine, and their numbers.
  World* group[kMaxGroup];
  int32_t member[kMaxGroup];
  int32_t waiting;
  int32_t failed;  // first world with an error, -1: none
  Error error;

  // Runs f, for world `env`; an error stays here and stops no other world.
  template <class F>
  void attempt(int32_t env, F&& f);
};

// What a step of a task that takes rows works in (pool_rows.cpp).
struct RowWork {
  TaskRows rows;
  int32_t* env = nullptr;     // [num_envs] of the rows
  uint8_t* waits = nullptr;   // [num_envs] for the engine
  uint8_t* ended = nullptr;   // [num_envs] and the next episode has to begin
  Episode* before = nullptr;  // [num_envs] of rows that begin
  Code* result = nullptr;     // [num_envs] of beginning

  void carve(Arena& arena, const ResolvedPoolConfig& plan);
};

struct Pool::Impl : ResolvedPoolConfig {
  explicit Impl(const PoolConfig& c) : ResolvedPoolConfig(c) {}
  ~Impl();

  // Rows, slots and blocks: the same cuts for measuring and for real. The worlds' own cuts follow them.
  struct Carved {
    Buffers buffers;
    SenseBuffers sensed;
    Slot* slots = nullptr;
    Block* blocks = nullptr;
    char* task_errors = nullptr;
    unsigned char* tried_state = nullptr;
    WorldDisturbance tried;
    RowWork work;
  };
  static Carved carve_rows(const ResolvedPoolConfig& plan, Arena& arena);
  static size_t arena_bytes(const ResolvedPoolConfig& plan);
  void build();
  void name_streams(int32_t env, uint64_t seed, uint32_t number);

  // --- stepping
  void check_ready(const uint8_t* mask) const;
  // Resets world, streams go on, writes obs. Where the task fails in it: its code; the world then is as it
  // was made, and the episode the one before.
  Code begin_episode(int32_t env);
  // Its three parts, of which the second calls the task. open_episode returns the episode before.
  Episode open_episode(int32_t env);
  bool show_first(int32_t env);  // after a task's reset and observe; false: an entry is not finite
  Code settle_episode(int32_t env, const Episode& before, Code code, bool good);
  void renew(int32_t env);
  void forget_episode(int32_t env);         // as if the world had never been reset
  void restart(int32_t env);                // a step that only resets
  void show_reset(int32_t env, Code code);  // rows of a step that only reset
  void count(int32_t env, uint32_t status);
  // Runs f, which calls the task; the code of a host's one that failed in it, and the world's text says how.
  template <class F>
  Code attempt_task(int32_t env, F&& f);
  void keep_error(int32_t env, const char* why);
  bool begin_at_start(int32_t env);  // an episode that has begun; true: it now is one of `starts`
  void clear_rows(int32_t env);      // reward, costs, flags, status, sums; final_obs becomes obs
  // What is shown of control step `step`, 0 at a reset; false: an entry is not finite.
  bool observe(int32_t env, int32_t step, float* row);
  bool show(int32_t env, int32_t step, float* row);  // what the task has written, made what is seen
  void see(int32_t env, Block& block);               // pictures, points and voxels
  void see_again(int32_t begin, int32_t end);        // of worlds whose state was set
  template <class F>
  void look_round(int32_t begin, int32_t end, Block& block, F&& named);
  // A control step of the block's worlds for which wanted(env).
  template <class F>
  void control_step(int32_t begin, int32_t end, Block& block, F&& wanted);
  // It has three parts, so that the engine can take several worlds at once: all that comes before it, the
  // engine and what comes behind for all that wait, and what comes behind for one world.
  void start_step(int32_t env, Block& block);
  void step_group(Block& block);
  void finish_step(int32_t env);
  bool engine_failed(int32_t env);  // counts what the engine did; a world that diverged has lost its step
  void judged(int32_t env, Verdict* verdict, bool finite);
  void lose_step(int32_t env, uint32_t status);
  void close_step(int32_t env, const Verdict& verdict, uint32_t status, bool lost);
  bool costs_count(const Verdict& verdict) const;  // column 0, or one with a limit, is above 0
  void write_verdict(int32_t env, const Verdict& verdict, uint32_t status);

  // --- stepping a task that takes rows
  void reset_rows(const uint64_t* seeds, const uint8_t* mask);
  void step_rows(const uint8_t* mask);
  template <class F>
  void control_step_rows(F&& wanted);
  void engine_rows();
  void finish_rows();
  void begin_rows();
  template <class F>
  void pick(F&& wanted);
  template <class F>
  void call_rows(F&& f);
  template <class F>
  void drop_failed(F&& failed);
  // f(begin, end, block) for runs of worlds that are all of them together, f(env, block) for every world, on
  // the workers. Both rethrow the error of the lowest world when all is done. `whole`: one run for each
  // block, for worlds that are named by a mask: their groups are fullest in long runs.
  template <class F>
  void each_block(F&& f, bool whole = false);
  template <class F>
  void each_world(const uint8_t* mask, F&& f);

  // --- state
  // Error(kFormat) unless the bytes are a state of so many worlds of this pool, or of the other number, which
  // it returns; then the worlds can be read.
  int32_t open_state(Reader& in, int32_t worlds, int32_t other = 0, uint32_t* version = nullptr) const;
  void write_world(int32_t env, Writer& out) const;
  // Reads a world's record without taking any of it: the phase of its episode. Error(kFormat) for what no
  // world of this pool can have.
  Phase check_world(Reader& in);
  // Of a record that check_world has passed. keep_streams: those of the disturbances stay the world's own.
  void read_world(int32_t env, Reader& in, bool keep_streams = false);
  void copy_world(int32_t env, const Impl& from, int32_t source);

  int32_t rank = 0, ranks = 1;
  float* obs(int32_t env) const { return buffers.obs + env * static_cast<ptrdiff_t>(obs_dim); }
  float* final_obs(int32_t env) const { return buffers.final_obs + env * static_cast<ptrdiff_t>(obs_dim); }
  float* action(int32_t env) const { return buffers.action + env * static_cast<ptrdiff_t>(action_dim); }
  float* cost_row(float* column, int32_t env) const {
    return column + env * static_cast<ptrdiff_t>(cost_dim);
  }

  Arena arena;
  Buffers buffers;
  SenseBuffers sensed;
  Slot* slots = nullptr;                 // [num_envs]
  Block* blocks = nullptr;               // [num_blocks]
  char* task_errors = nullptr;           // [num_envs][kErrorTextSize] of a host's task; null for other ones
  unsigned char* tried_state = nullptr;  // [state_bytes] of a record that is looked at
  WorldDisturbance tried;                // likewise
  RowWork work;                          // of a task that takes rows
  unsigned char* pristine = nullptr;     // a world's state before anything happened: what a reset starts from
  size_t pristine_size = 0;
  Starts starts;
  uint64_t layout = 0;     // layout_hash of the task
  int32_t group_size = 1;  // worlds that the engine takes together, at most
  Workers* workers = nullptr;
};

template <class F>
void Block::attempt(int32_t env, F&& f) {
  try {
    f();
  } catch (const Error& e) {
    if (failed >= 0 && failed < env) return;
    failed = env;
    error = e;
  }
}

template <class F>
void Pool::Impl::each_block(F&& f, bool whole) {
  struct Call {
    Impl* impl;
    F* f;
    bool lends;
  } call{this, &f, slots[0].world->lends()};
  const int32_t count = num_blocks(), all = config.num_envs;
  for (int32_t b = 0; b < count; ++b) blocks[b].failed = -1;
  // whole groups, and not so few that taking a piece weighs more than a step of a small world
  const int32_t piece = (kFewWorlds + group_size - 1) / group_size * group_size;
  workers->run_pieces(
      all, count, whole || !call.lends ? all : piece,
      [](void* context, int32_t b, int32_t begin, int32_t end) {
        const Call& c = *static_cast<Call*>(context);
        Impl& m = *c.impl;
        const World& home = *m.slots[m.block_begin(b)].world;
        if (c.lends)
          for (int32_t env = begin; env < end; ++env) m.slots[env].world->borrow(home);
        (*c.f)(begin, end, m.blocks[b]);
      },
      &call);
  const Block* first = nullptr;
  for (int32_t b = 0; b < count; ++b)
    if (blocks[b].failed >= 0 && (!first || blocks[b].failed < first->failed)) first = &blocks[b];
  if (first) throw first->error;
}

template <class F>
void Pool::Impl::each_world(const uint8_t* mask, F&& f) {
  each_block([&](int32_t begin, int32_t end, Block& block) {
    for (int32_t env = begin; env < end; ++env)
      if (!mask || mask[env]) block.attempt(env, [&] { f(env, block); });
  });
}

template <class F>
Code Pool::Impl::attempt_task(int32_t env, F&& f) {
  try {
    f();
    return Code::kOk;
  } catch (const Error& e) {
    if (!task_errors) throw;
    keep_error(env, e.text);
    return e.code;
  }
}

template <class F>
void Pool::Impl::look_round(int32_t begin, int32_t end, Block& block, F&& named) {
  if (!sense.any()) return;
  for (int32_t env = begin; env < end; ++env)
    if (named(env) && slots[env].episode.step % sense.every == 0)
      block.attempt(env, [&] { see(env, block); });
}

}  // namespace rdm
