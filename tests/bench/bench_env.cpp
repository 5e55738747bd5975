// Where a control step's time goes: ns per world for control, judge, observe, the engine and the pool's own
// work, each of one step of a pool of many worlds; then for random actions and for a reset. One core, JSON.
//   bench_env [worlds] [steps] [option=value ...]
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>
#if defined(__x86_64__)
#include <x86intrin.h>
#endif

#include "base/error.hpp"
#include "base/fpmode.hpp"
#include "env/pool.hpp"
#include "tasks/catalog.hpp"

namespace {

using namespace rdm;
using Clock = std::chrono::steady_clock;

#if defined(__x86_64__)
uint64_t ticks() {
  return __rdtsc();
}
#else
uint64_t ticks() {
  return static_cast<uint64_t>(Clock::now().time_since_epoch().count());
}
#endif

double ns_per_tick() {
  const auto begin = Clock::now();
  const uint64_t from = ticks();
  while (Clock::now() - begin < std::chrono::milliseconds(50)) {
  }
  const auto took = std::chrono::duration<double, std::nano>(Clock::now() - begin).count();
  return took / static_cast<double>(ticks() - from);
}

// Ticks spent in each part since the last clear(). What lies between the last control and the first judge of
// a group is the engine's.
struct Parts {
  uint64_t control = 0, engine = 0, judge = 0, observe = 0;
  uint64_t calls = 0;    // of the clock
  uint64_t control_end;  // of the last one
  bool stepping = false;
  void clear() { *this = {}; }
} g_parts;

constexpr const char* kInner = "hand_over_safe_finger";

// The task, with a clock before and after each call.
class ClockedTask final : public Task {
 public:
  ClockedTask(const Options& o, const HostHooks& hooks) : info_(task_at(task_find(kInner))), hooks_(hooks) {
    inner_ = info_.make(o, hooks);
  }
  ~ClockedTask() override { info_.destroy(inner_, hooks_); }
  const Scene& scene() const override { return inner_->scene(); }
  EngineKind engine() const override { return inner_->engine(); }
  int32_t max_steps() const override { return inner_->max_steps(); }
  int32_t action_dim() const override { return inner_->action_dim(); }
  const Vector<FieldSpec>& fields() const override { return inner_->fields(); }
  const char* action_order() const override { return inner_->action_order(); }
  size_t state_bytes() const override { return inner_->state_bytes(); }
  void check_state(const void* state) const override { inner_->check_state(state); }
  void reset(World& world, void* state, Stream& stream) const override {
    inner_->reset(world, state, stream);
  }
  void control(World& world, void* state, const float* action) const override {
    const uint64_t begin = ticks();
    inner_->control(world, state, action);
    g_parts.control_end = ticks();
    g_parts.control += g_parts.control_end - begin;
    g_parts.calls += 2;
    g_parts.stepping = true;
  }
  Verdict judge(World& world, void* state, int32_t step) const override {
    const uint64_t begin = ticks();
    if (g_parts.stepping) g_parts.engine += begin - g_parts.control_end;
    g_parts.stepping = false;
    const Verdict v = inner_->judge(world, state, step);
    g_parts.judge += ticks() - begin;
    g_parts.calls += 2;
    return v;
  }
  void observe(const World& world, const void* state, float* obs) const override {
    const uint64_t begin = ticks();
    inner_->observe(world, state, obs);
    g_parts.observe += ticks() - begin;
    g_parts.calls += 2;
  }
  void hold_action(float* action) const override { inner_->hold_action(action); }
  void initial_mean(float* action) const override { inner_->initial_mean(action); }

 private:
  const TaskInfo& info_;
  HostHooks hooks_;
  Task* inner_;
};

const TaskInfo& clocked_info() {
  static const TaskInfo info = [] {
    TaskInfo t = task_at(task_find(kInner));
    t.name = "clocked";
    t.alias = nullptr;
    t.make = [](const Options& o, const HostHooks& hooks) -> Task* {
      return host_new<ClockedTask>(hooks, o, hooks);
    };
    t.destroy = [](Task* task, const HostHooks& hooks) {
      host_delete(hooks, static_cast<ClockedTask*>(task));
    };
    return t;
  }();
  return info;
}

double median(std::vector<double> x) {
  std::nth_element(x.begin(), x.begin() + static_cast<ptrdiff_t>(x.size() / 2), x.end());
  return x[x.size() / 2];
}

struct Samples {
  std::vector<double> control, engine, judge, observe, pool, random, reset;
};

}  // namespace

int main(int argc, char** argv) {
  const FpMode mode;
  register_builtin_tasks();
  register_task(clocked_info());
  const int worlds = argc > 1 ? std::atoi(argv[1]) : 64, steps = argc > 2 ? std::atoi(argv[2]) : 300;
  // no episode ends while the parts are timed
  std::vector<OptionInput> options = {{"fall_height", nullptr, -10}, {"max_steps", nullptr, 100000}};
  std::vector<std::string> keys;
  for (int i = 3; i < argc; ++i) {
    keys.emplace_back(argv[i], std::strcspn(argv[i], "="));
    keys.emplace_back(argv[i] + std::min(keys.back().size() + 1, std::strlen(argv[i])));
  }
  for (size_t i = 0; i < keys.size(); i += 2) options.push_back({keys[i].c_str(), keys[i + 1].c_str(), 0});
  PoolConfig config;
  config.task = "clocked";
  config.num_envs = worlds;
  config.options = options.data();
  config.num_options = static_cast<int32_t>(options.size());
  Pool* pool = nullptr;
  const Code code = guard([&] { pool = Pool::create(config); });
  if (code != Code::kOk) {
    std::fprintf(stderr, "bench_env: %s\n", last_error());
    return 1;
  }

  const double unit = ns_per_tick();
  uint64_t clock = ~uint64_t{0};  // what one look at the clock takes
  for (int i = 0; i < 1000; ++i) {
    const uint64_t begin = ticks();
    for (int k = 0; k < 10; ++k) static_cast<void>(ticks());
    clock = std::min(clock, (ticks() - begin) / 11);
  }

  Samples s;
  for (int step = -5; step < steps; ++step) {
    const uint64_t start = ticks();
    if (step < 0 || step % 75 == 0) pool->reset(nullptr, nullptr);
    const uint64_t fresh = ticks();
    pool->baseline(Baseline::kRandom);
    const uint64_t drawn = ticks();
    g_parts.clear();
    const uint64_t begin = ticks();
    pool->step(nullptr);
    const uint64_t end = ticks();
    if (step < 0) continue;
    const double each = unit / worlds;
    const auto ns = [&](uint64_t n, int looks) {
      const double own = static_cast<double>(n) - static_cast<double>(clock) * looks;
      return own * each;
    };
    const Parts& p = g_parts;
    s.control.push_back(ns(p.control, worlds));
    s.engine.push_back(ns(p.engine, 1));
    s.judge.push_back(ns(p.judge, worlds));
    s.observe.push_back(ns(p.observe, worlds));
    s.pool.push_back(
        ns(end - begin - p.control - p.engine - p.judge - p.observe, static_cast<int>(p.calls) - 3 * worlds));
    s.random.push_back(ns(drawn - fresh, 1));
    if (step % 75 == 0) s.reset.push_back(ns(fresh - start, 1));
  }
  Pool::destroy(pool);
  const double control = median(s.control), judge = median(s.judge), observe = median(s.observe),
               rest = median(s.pool);
  std::printf(
      "{\"task\": \"%s\", \"worlds\": %d, \"steps\": %d, \"unit\": \"ns per world and step, median\",\n"
      " \"control\": %.0f, \"judge\": %.0f, \"observe\": %.0f, \"pool\": %.0f, \"outside_engine\": %.0f,\n"
      " \"engine\": %.0f, \"baseline_random\": %.0f, \"reset\": %.0f}\n",
      kInner, worlds, steps, control, judge, observe, rest, control + judge + observe + rest,
      median(s.engine), median(s.random), median(s.reset));
}
