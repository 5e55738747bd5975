// rdm_task_check: what a task promises, tried: its functions one by one with guards around what they write,
// twice from the same seed, after save and restore; then whole pools with one thread and with two.
#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <memory>

#include "base/bit_cast.hpp"
#include "base/hash.hpp"
#include "capi/handles.hpp"

#if RDM_WITH_SIM
#include "base/format.hpp"
#include "env/fields.hpp"
#include "env/resolved_config.hpp"
#include "tasks/catalog.hpp"
#if defined(__GLIBC__)
#include <malloc.h>
#endif

using namespace rdm;
using namespace rdm::capi;

namespace {

constexpr int32_t kEpisodes = 3, kMostSteps = 100, kRestores = 5;  // of the functions alone
constexpr int32_t kPoolSteps = 60, kPoolWorlds = 4;                // of pools
constexpr size_t kGuard = 256;                                     // bytes before and behind what is written
constexpr unsigned char kGuardByte = 0xa5;
constexpr uint32_t kUnwritten = 0x7fc5a5a5;  // a float that is no number

// Bytes in use on the heap, where the C library tells.
size_t heap_in_use() {
#if defined(__GLIBC__) && (__GLIBC__ > 2 || __GLIBC_MINOR__ >= 33)
  const struct mallinfo2 info = mallinfo2();
  return info.uordblks + info.hblkhd;
#else
  return 0;
#endif
}

enum class Part { kReset, kObserve, kControl, kJudge, kCheckState };
constexpr const char* kPartNames[] = {"reset", "observe", "control", "judge", "check_state"};

// Which of a task's functions leaves memory behind, call after call.
struct Heap {
  int32_t calls[5] = {}, grown[5] = {};
};

// Whether the host still wants to know.
struct Patience {
  const char* task;
  rdm_stop stop;
  void* user;
  int64_t steps = 0;
  void ask() const {
    if (stop && stop(user, steps) != 0)
      fail(Code::kCancelled, "task %s: the host ended the check after %lld control steps", task,
           static_cast<long long>(steps));
  }
};

// Bytes that a function may write, between two guards.
class Guarded {
 public:
  explicit Guarded(size_t size) : size_(size), bytes_(size + 2 * kGuard + Arena::kAlign, kGuardByte) {
    const auto at = reinterpret_cast<uintptr_t>(bytes_.data() + kGuard);
    first_ = bytes_.data() + kGuard + (Arena::kAlign - at % Arena::kAlign) % Arena::kAlign;
  }
  unsigned char* data() { return first_; }
  const unsigned char* data() const { return first_; }
  size_t size() const { return size_; }
  // How far from the end (positive) or from the beginning (negative) a byte was written; 0: none was.
  int64_t broken() const {
    const auto front = static_cast<size_t>(first_ - bytes_.data());
    for (size_t i = front + size_; i < bytes_.size(); ++i)
      if (bytes_[i] != kGuardByte) return static_cast<int64_t>(i - front - size_) + 1;
    for (size_t i = front; i-- > 0;)
      if (bytes_[i] != kGuardByte) return -static_cast<int64_t>(front - i);
    return 0;
  }

 private:
  size_t size_;
  Vector<unsigned char> bytes_;
  unsigned char* first_;
};

// What a call has left behind.
struct Trace {
  Part part;
  int32_t step;
  uint64_t world, state, row;  // hashes; row: of the observation or of the verdict
};

// One world and the bytes of a task, whose functions are called one by one.
class Stage {
 public:
  Stage(const ResolvedPoolConfig& plan, Heap* heap, Patience* patience)
      : plan_(plan),
        task_(*plan.task),
        heap_(heap),
        patience_(patience),
        state_(task_.state_bytes()),
        obs_(sizeof(float) * static_cast<size_t>(plan.obs_dim)),
        action_(sizeof(float) * static_cast<size_t>(plan.action_dim)) {
    Arena measure;
    World::measure(task_.engine(), task_.scene(), measure);
    arena_ = Arena(plan.config.hooks, measure.used());
    world_ = World::create(task_.engine(), task_.scene(), arena_, plan.config.hooks);
    pristine_ = saved();
  }
  ~Stage() { World::destroy(world_, plan_.config.hooks); }
  Stage(const Stage&) = delete;
  Stage& operator=(const Stage&) = delete;

  Vector<Trace> trace;

  void reset(uint64_t seed) {
    step_ = 0;
    load(pristine_);
    std::memset(state_.data(), 0, state_.size());
    Stream stream(seed, 0, Purpose::kReset);
    call(Part::kReset, [&] { task_.reset(*world_, state_.data(), stream); });
    note(Part::kReset, 0);
    look();
  }

  // A control step; false when the episode is over or the world diverged.
  bool step(Stream& actions) {
    patience_->ask();
    ++patience_->steps;
    ++step_;
    auto* action = reinterpret_cast<float*>(action_.data());
    actions.signed_units(action, plan_.action_dim);
    const uint64_t before = hash_bytes(action, action_.size());
    call(Part::kControl, [&] { task_.control(*world_, state_.data(), action); });
    if (hash_bytes(action, action_.size()) != before) broken(Part::kControl, "it changes the action");
    note(Part::kControl, 0);
    world_->step();
    if (world_->status() & kStatusDiverged) return false;
    Verdict v;
    call(Part::kJudge, [&] { v = task_.judge(*world_, state_.data(), step_); });
    check(v);
    uint64_t row = hash_bytes(&v.reward, sizeof v.reward);
    row = hash_bytes(v.cost, sizeof v.cost, row);
    row = hash_bytes(v.cost_raw, sizeof v.cost_raw, row);
    const bool flags[] = {v.terminated, v.success};
    note(Part::kJudge, hash_bytes(flags, sizeof flags, row));
    look();
    return !v.terminated && step_ < task_.max_steps();
  }

  // The world and the task's bytes, and back.
  Vector<unsigned char> saved() const {
    Writer count(nullptr, 0);
    world_->save(count);
    Vector<unsigned char> bytes(count.size());
    Writer out(bytes.data(), bytes.size());
    world_->save(out);
    return bytes;
  }
  void take(const Stage& other) {
    load(other.saved());
    std::memcpy(state_.data(), other.state_.data(), state_.size());
    step_ = other.step_;
  }

  int32_t steps() const { return step_; }

 private:
  void load(const Vector<unsigned char>& bytes) {
    Reader in(bytes.data(), bytes.size(), "world");
    world_->load(in);
  }

  [[noreturn]] [[gnu::format(printf, 3, 4)]] void broken(Part part, const char* format, ...) const;

  // Calls one of the task's functions and looks at what is around its bytes.
  template <class F>
  void call(Part part, F&& f) {
    const size_t before = heap_in_use();
    const Code code = guard(f);
    const size_t after = heap_in_use();
    const auto i = static_cast<size_t>(part);
    ++heap_->calls[i];
    heap_->grown[i] += after > before;
    if (code != Code::kOk) {
      char text[kErrorTextSize];
      std::snprintf(text, sizeof text, "%s", last_error());
      fail(Code::kArgument, "%s; step %d", text, step_);
    }
    need_guards(part, state_, "its state");
    need_guards(part, obs_, "the row of observations");
    need_guards(part, action_, "the action");
  }
  void need_guards(Part part, const Guarded& bytes, const char* what) const {
    const int64_t at = bytes.broken();
    if (at > 0)
      broken(part, "it writes past the end of %s, byte %lld of %zu", what,
             static_cast<long long>(at) + static_cast<long long>(bytes.size()) - 1, bytes.size());
    if (at < 0) broken(part, "it writes before %s", what);
  }

  void note(Part part, uint64_t row) {
    const Vector<unsigned char> world = saved();
    trace.push_back(
        {part, step_, hash_bytes(world.data(), world.size()), hash_bytes(state_.data(), state_.size()), row});
  }

  void check(const Verdict& v) const {
    if (!std::isfinite(v.reward)) broken(Part::kJudge, "the reward is not finite");
    for (int32_t k = 0; k < plan_.cost_dim; ++k) {
      const char* name = plan_.info->costs[k].name;
      if (!std::isfinite(v.cost[k])) broken(Part::kJudge, "cost %s is not finite", name);
      if (v.cost[k] < 0) broken(Part::kJudge, "cost %s is %g, less than 0", name, v.cost[k]);
      if (!std::isfinite(v.cost_raw[k])) broken(Part::kJudge, "the raw value of cost %s is not finite", name);
    }
  }

  // The observation: all of it written, in its bounds, the same once more; and the state is one that
  // check_state takes.
  void look() {
    auto* row = reinterpret_cast<float*>(obs_.data());
    const uint64_t state = hash_bytes(state_.data(), state_.size());
    uint64_t first = 0;
    for (const uint32_t paper : {kUnwritten, kUnwritten ^ 0xff00u}) {
      std::fill_n(row, plan_.obs_dim, rdm::bit_cast<float>(paper));
      call(Part::kObserve, [&] { task_.observe(*world_, state_.data(), row); });
      if (hash_bytes(state_.data(), state_.size()) != state) broken(Part::kObserve, "it changes its state");
      check_row(row, paper);
      const uint64_t hash = hash_bytes(row, obs_.size());
      if (first != 0 && hash != first) broken(Part::kObserve, "called twice it writes other numbers");
      first = hash;
    }
    note(Part::kObserve, first);
    call(Part::kCheckState, [&] { task_.check_state(state_.data()); });
  }
  void check_row(const float* row, uint32_t paper) const {
    int32_t i = 0;
    for (const FieldSpec& f : task_.fields())
      for (int32_t k = 0; k < f.count; ++k, ++i) {
        if (rdm::bit_cast<uint32_t>(row[i]) == paper)
          broken(Part::kObserve, "entry %d of field %s is not written", k, f.name.text);
        const auto value = static_cast<double>(row[i]);
        if (!std::isfinite(value))
          broken(Part::kObserve, "entry %d of field %s is not finite", k, f.name.text);
        if (row[i] < f.low || row[i] > f.high)
          broken(Part::kObserve, "entry %d of field %s is %.9g, outside [%g, %g]", k, f.name.text, value,
                 static_cast<double>(f.low), static_cast<double>(f.high));
      }
  }

  const ResolvedPoolConfig& plan_;
  const Task& task_;
  Heap* heap_;
  Patience* patience_;
  Arena arena_;
  World* world_ = nullptr;
  Guarded state_, obs_, action_;
  Vector<unsigned char> pristine_;
  int32_t step_ = 0;
};

void Stage::broken(Part part, const char* format, ...) const {
  char text[kErrorTextSize];
  va_list arguments;
  va_start(arguments, format);
  print_list(text, sizeof text, format, arguments);
  va_end(arguments);
  fail(Code::kArgument, "task %s: %s: %s; step %d", plan_.info->name, kPartNames[static_cast<int>(part)],
       text, step_);
}

// The first call after which two runs differ.
void compare(const char* task, const Vector<Trace>& a, const Vector<Trace>& b, const char* when) {
  for (size_t i = 0; i < std::min(a.size(), b.size()); ++i) {
    const char* what = a[i].row != b[i].row       ? a[i].part == Part::kJudge ? "its verdict" : "its row"
                       : a[i].state != b[i].state ? "the state"
                       : a[i].world != b[i].world ? "the world"
                                                  : nullptr;
    if (what)
      fail(Code::kArgument, "task %s: %s: %s differs %s; step %d", task,
           kPartNames[static_cast<int>(a[i].part)], what, when, a[i].step);
  }
  if (a.size() != b.size())
    fail(Code::kArgument, "task %s: judge: the length of an episode differs %s", task, when);
}

void check_functions(const ResolvedPoolConfig& plan, Patience* patience) {
  Heap heap;
  Stage one(plan, &heap, patience), two(plan, &heap, patience), other(plan, &heap, patience);
  for (int32_t e = 0; e < kEpisodes; ++e) {
    const auto seed = static_cast<uint64_t>(11 + e);
    // a world of another seed steps in between: nothing of it may be seen
    Stream actions(seed, 0, Purpose::kTest), same = actions, others(seed, 1, Purpose::kTest);
    one.trace.clear();
    two.trace.clear();
    other.trace.clear();
    other.reset(seed + 1000);
    one.reset(seed);
    bool goes_on = true, others_on = true;
    while (goes_on && one.steps() < kMostSteps) {
      goes_on = one.step(actions);
      if (!others_on) other.reset(seed + 1000);
      others_on = other.step(others);
    }
    two.reset(seed);
    for (goes_on = true; goes_on && two.steps() < kMostSteps;) goes_on = two.step(same);
    compare(plan.info->name, one.trace, two.trace, "for the same seed");

    // from some places on, in another world
    const int32_t length = one.steps();
    for (int32_t k = 0; k < kRestores && length > 1; ++k) {
      Stream start(seed, 0, Purpose::kTest);
      one.reset(seed);
      while (one.steps() < length * k / kRestores) one.step(start);
      Stream again = start;
      two.take(one);
      one.trace.clear();
      two.trace.clear();
      for (goes_on = true; goes_on && one.steps() < length;) goes_on = one.step(start);
      for (goes_on = true; goes_on && two.steps() < length;) goes_on = two.step(again);
      compare(plan.info->name, one.trace, two.trace, "after save and restore");
    }
  }
  for (size_t i = 0; i < 5; ++i)
    if (heap.calls[i] >= 16 && heap.grown[i] > heap.calls[i] * 9 / 10)
      fail(Code::kArgument, "task %s: %s does not free all of its memory in %d of %d calls", plan.info->name,
           kPartNames[i], heap.grown[i], heap.calls[i]);
}

struct EndPool {
  void operator()(Pool* p) const { Pool::destroy(p); }
};
using PoolPtr = std::unique_ptr<Pool, EndPool>;

void compare_rows(const Pool& a, const Pool& b, const char* task, int32_t step, const char* when) {
  const Buffers &x = a.buffers(), &y = b.buffers();
  const auto same = [&](const auto* p, const auto* q, int32_t width, const char* what) {
    for (int32_t i = 0; i < kPoolWorlds; ++i)
      if (std::memcmp(p + i * width, q + i * width, sizeof *p * static_cast<size_t>(width)) != 0)
        fail(Code::kArgument, "task %s: %s of world %d differs %s; step %d", task, what, i, when, step);
  };
  same(x.obs, y.obs, a.obs_dim(), "the observation");
  same(x.reward, y.reward, 1, "the reward");
  same(x.cost, y.cost, a.cost_dim(), "a cost");
  same(x.cost_raw, y.cost_raw, a.cost_dim(), "a raw cost");
  same(x.terminated, y.terminated, 1, "the end");
  same(x.success, y.success, 1, "the success");
  for (int32_t i = 0; i < kPoolWorlds; ++i)
    if (a.hash(i) != b.hash(i))
      fail(Code::kArgument, "task %s: the state of world %d differs %s; step %d", task, i, when, step);
}

// No function of the task may fail in a world.
void step_pool(const PoolPtr& p, Baseline actions, int32_t step, Patience* patience) {
  patience->ask();
  p->baseline(actions);
  p->step(nullptr);
  for (int32_t i = 0; i < kPoolWorlds; ++i) {
    patience->steps += p->taken(i);
    if (p->buffers().status[i] & kStatusTask) fail(Code::kArgument, "%s; step %d", p->task_error(i), step);
  }
}

// The functions of many that a step calls get one row each time.
void step_apart(const PoolPtr& p, Patience* patience) {
  patience->ask();
  p->baseline(Baseline::kRandom);
  for (int32_t i = 0; i < kPoolWorlds; ++i) {
    uint8_t mask[kPoolWorlds] = {};
    mask[i] = 1;
    p->step(mask);
    patience->steps += p->taken(i);
  }
}

void check_rows(const PoolConfig& config, const char* task, Patience* patience) {
  const PoolPtr together(Pool::create(config)), apart(Pool::create(config));
  together->reset(nullptr, nullptr);
  for (int32_t i = 0; i < kPoolWorlds; ++i) {
    uint8_t mask[kPoolWorlds] = {};
    mask[i] = 1;
    apart->reset(nullptr, mask);
  }
  for (int32_t step = 1; step <= kPoolSteps; ++step) {
    step_pool(together, Baseline::kRandom, step, patience);
    step_apart(apart, patience);
    compare_rows(*together, *apart, task, step, "when it is computed together with other worlds");
  }
}

void check_pools(PoolConfig config, const char* task, Patience* patience) {
  config.num_envs = kPoolWorlds;
  const PoolPtr one(Pool::create(config));
  if (one->task().takes_rows()) check_rows(config, task, patience);
  config.num_threads = 2;
  const PoolPtr two(Pool::create(config)), restored(Pool::create(config));
  one->reset(nullptr, nullptr);
  two->reset(nullptr, nullptr);
  Vector<unsigned char> bytes;
  for (int32_t step = 1; step <= kPoolSteps; ++step) {
    step_pool(one, Baseline::kRandom, step, patience);
    step_pool(two, Baseline::kRandom, step, patience);
    compare_rows(*one, *two, task, step, "with two threads");
    if (step > kPoolSteps / 2) {
      step_pool(restored, Baseline::kRandom, step, patience);
      compare_rows(*one, *restored, task, step, "in a pool that was restored");
    } else if (step == kPoolSteps / 2) {
      bytes.resize(one->state_size(-1));
      Writer out(bytes.data(), bytes.size());
      one->get_state(-1, out);
      restored->set_state(-1, bytes.data(), bytes.size());
    }
  }
  one->reset(nullptr, nullptr);
  for (int32_t step = 1; step <= kPoolSteps; ++step) {
    step_pool(one, Baseline::kHold, step, patience);
    for (int32_t i = 0; i < kPoolWorlds; ++i)
      if (one->buffers().status[i] & kStatusDiverged)
        fail(Code::kArgument, "task %s: world %d diverges with the hold action; step %d", task, i, step);
  }
}

}  // namespace

rdm_result rdm_task_check(const char* task, const char* settings, rdm_stop stop, void* user, char* error,
                          size_t error_size) {
  const rdm_result r = call([&] {
    need(task, "task");
    if (error && error_size < 1) fail(Code::kRange, "error_size: it is 0, but error is not NULL");
    register_builtin_tasks();
    PoolConfig config;
    config.hooks = host();
    config.task = task;
    config.settings = settings;
    Patience patience{task, stop, user};
    {
      const ResolvedPoolConfig plan(config);
      check_functions(plan, &patience);
    }
    check_pools(config, task, &patience);
  });
  if (r != RDM_OK && error && error_size > 0) copy_text(error, error_size, last_error());
  return r;
}
#endif
