// `bench latency`: what a control loop waits for. A frozen policy acts, call after call; and an agent acts by its
// mean and does a slice of an update, tick after tick, as beside a robot.
#include <algorithm>
#include <thread>

#include "bench/bench.hpp"
#include "common/clock.hpp"
#include "common/names.hpp"
#include "common/setting.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

// How long each of many calls took, in seconds.
class Times {
 public:
  explicit Times(int64_t count) { took_.reserve(static_cast<size_t>(count)); }
  template <class F>
  void time(F&& f) {
    const auto begin = Clock::now();
    f();
    took_.push_back(since(begin));
  }
  int64_t count() const { return static_cast<int64_t>(took_.size()); }
  Json microseconds() {
    std::sort(took_.begin(), took_.end());
    return {{"median", at(0.5)},
            {"p99", at(0.99)},
            {"p99.9", at(0.999)},
            {"p99.99", at(0.9999)},
            {"worst", at(1)}};
  }

 private:
  double at(double share) const {
    const auto i = static_cast<size_t>(share * static_cast<double>(took_.size()));
    return 1e6 * took_[std::min(i, took_.size() - 1)];
  }
  std::vector<double> took_;
};

// Waits for each tick; from a missed one on it counts anew.
class Ticks {
 public:
  explicit Ticks(double hz)
      : period_(hz > 0 ? std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / hz))
                       : Clock::duration::zero()),
        next_(Clock::now()) {}
  void wait() {
    next_ = std::max(next_ + period_, Clock::now());
    std::this_thread::sleep_until(next_);
  }

 private:
  Clock::duration period_;
  Clock::time_point next_;
};

Times time_policy(const redman::Policy& policy, const redman::Pool& pool, int64_t calls) {
  const size_t worlds = pool.num_envs(), dim = pool.obs().width();
  std::vector<float> action(pool.action().width());
  redman::Bytes scratch(policy.scratch_bytes(1));
  Times times(calls);
  for (int64_t i = 0; i < calls; ++i) {
    const float* obs = pool.obs().data() + static_cast<size_t>(i) % worlds * dim;
    times.time([&] { policy.act(obs, 1, nullptr, action.data(), scratch.data(), scratch.size()); });
  }
  return times;
}

// A decision is one control step here, for an update takes as long whatever was seen.
void fill_horizon(redman::Agent& agent, redman::Pool& pool, int32_t horizon) {
  auto t = redman::sized<rdm_transition>();
  t.reward = pool.reward().data();
  t.cost = pool.cost().data();
  t.terminated = pool.terminated().data();
  t.truncated = pool.truncated().data();
  for (int32_t i = 0; i < horizon; ++i) {
    agent.act(pool.obs().data(), RDM_ACT_SAMPLE, pool.action().data());
    pool.step();
    agent.record(t);
  }
}

}  // namespace

Report bench_latency(LatencyFlags flags) {
  apply_sets(flags.sets, flags.pool, &flags.agent);
  redman::Pool pool = make_pool(flags.pool, RDM_AUTORESET_SAME_STEP);
  pool.reset();
  redman::Agent agent =
      make_agent(flags.agent, pool, cost_limits(pool, {}), flags.pool.seed, flags.pool.threads);
  const int32_t horizon = std::stoi(agent_setting(agent, flags.agent.algo, "horizon"));
  fill_horizon(agent, pool, horizon);
  agent.update(pool.obs().data());  // warm-up

  Times calls = time_policy(redman::Policy(agent.policy()), pool, flags.calls);
  Times ticks(flags.ticks);
  std::vector<float> action(pool.num_envs() * pool.action().width());
  int64_t updates = 0;
  for (; ticks.count() < flags.ticks; ++updates) {
    fill_horizon(agent, pool, horizon);
    const float* obs = pool.obs().data();
    Ticks clock(flags.hz);
    bool begun = false, done = false;
    while (!done) {
      clock.wait();
      ticks.time([&] {
        agent.act(obs, RDM_ACT_MEAN, action.data());
        if (begun)
          done = agent.update_slice(flags.units);
        else
          agent.update_begin(obs);
      });
      begun = true;
    }
  }
  const int64_t count = ticks.count();
  const Json call = calls.microseconds(), tick = ticks.microseconds();
  const Json json = {{"task", task_at(pool.spec().task).name},
                     {"envs", flags.pool.envs},
                     {"threads", flags.pool.threads},
                     {"horizon", horizon},
                     {"calls", flags.calls},
                     {"policy_act_us", call},
                     {"hz", flags.hz},
                     {"units", flags.units},
                     {"ticks", count},
                     {"ticks_per_update", static_cast<double>(count) / static_cast<double>(updates)},
                     {"tick_us", tick}};
  const auto line = [](const char* what, int64_t n, const Json& us) {
    return format("%s: %lld, median %.1f us, 99.9 %% within %.1f us, worst %.1f us\n", what,
                  static_cast<long long>(n), us["median"].get<double>(), us["p99.9"].get<double>(),
                  us["worst"].get<double>());
  };
  return {json,
          line("acts of a policy", flags.calls, call) + line("acts with a slice of an update", count, tick)};
}

}  // namespace tool
