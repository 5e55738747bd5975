// `bench update`, `bench act`: how fast an agent learns from made-up data, and a frozen policy acts.
#include "bench/bench.hpp"
#include "bench/malloc_count.hpp"
#include "common/clock.hpp"
#include "common/names.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

// Standard-normal-like numbers for fake data: the sum of uniforms, from a plain generator.
class Noise {
 public:
  float normal() {
    float sum = -6;
    for (int i = 0; i < 12; ++i) sum += unit();
    return sum;
  }
  float unit() {
    state_ = state_ * 6364136223846793005u + 1442695040888963407u;
    return static_cast<float>(state_ >> 40) * 0x1p-24f;
  }

 private:
  uint64_t state_ = 1;
};

// Fills an agent's horizon with made-up observations, rewards and costs.
class FakeWorld {
 public:
  FakeWorld(size_t envs, size_t obs, size_t actions)
      : obs_(envs * obs), action_(envs * actions), reward_(envs), cost_(envs), terminated_(envs) {}
  const float* fill(redman::Agent& agent, int32_t horizon) {
    auto t = redman::sized<rdm_transition>();
    t.reward = reward_.data();
    t.cost = cost_.data();
    t.terminated = terminated_.data();
    for (int32_t s = 0; s < horizon; ++s) {
      for (float& x : obs_) x = noise_.normal();
      agent.act(obs_.data(), RDM_ACT_SAMPLE, action_.data());
      for (float& x : reward_) x = noise_.normal();
      for (float& x : cost_) x = noise_.unit() < 0.2f ? 1.0f : 0.0f;
      for (uint8_t& x : terminated_) x = noise_.unit() < 0.02f;
      agent.record(t);
    }
    return obs_.data();
  }

 private:
  std::vector<float> obs_, action_, reward_, cost_;
  std::vector<uint8_t> terminated_;
  Noise noise_;
};

}  // namespace

Report bench_update(const UpdateFlags& flags) {
  int32_t envs = 64;
  while (flags.samples % envs != 0) envs /= 2;
  const int32_t horizon = flags.samples / envs;
  const std::string passes = std::to_string(flags.epochs), length = std::to_string(horizon),
                    parts = std::to_string(std::max(flags.samples / flags.minibatch, 1));
  const auto table = algo_options(find_algo(flags.algo));
  Options options;
  const auto lay = [&](const char* key, const std::string& value) {
    if (has_option(table, key)) options.emplace_back(key, value);
  };
  lay("hidden", flags.hidden);
  lay("horizon", length);
  lay("passes", passes);
  lay("minibatches", parts);
  lay("early_stop_kl", "0");
  refuse_flags(flags.sets, {"hidden"});
  GivenOnce keys;
  for (const std::string& s : flags.sets) {
    options.push_back(split_pair(s, "--set"));
    keys.add(options.back().first, "--set " + s);
  }
  const auto raw = raw_options(options);
  auto config = redman::agent_config(flags.obs, flags.act, envs);
  const double limit = 10;
  config.algo = flags.algo.c_str();
  config.num_threads = flags.threads;
  config.cost_limits = &limit;
  config.options = raw.data();
  config.num_options = static_cast<int32_t>(raw.size());
  size_t bytes = 0;
  as_usage([&] { redman::check(rdm_agent_config_memory(&config, &bytes)); });
  redman::Agent agent(config);
  FakeWorld world(static_cast<size_t>(envs), static_cast<size_t>(flags.obs), static_cast<size_t>(flags.act));
  agent.update(world.fill(agent, horizon));  // warm-up

  double seconds = 0;
  int64_t work = 0, passes_done = 0, updates = 0, allocations = 0;
  while (seconds < flags.seconds || updates < 3) {
    const float* last = world.fill(agent, horizon);
    const int64_t allocated = allocation_count();
    const auto clock = Clock::now();
    const rdm_epoch e = agent.update(last);
    seconds += since(clock);
    allocations += allocation_count() - allocated;
    work += int64_t{flags.samples} * e.passes;
    passes_done += e.passes;  // of a learner from a replay memory: gradient steps
    ++updates;
  }
  const double rate = static_cast<double>(work) / seconds,
               passes_rate = static_cast<double>(passes_done) / seconds;
  const double per_update =
      allocation_count() < 0 ? -1 : static_cast<double>(allocations) / static_cast<double>(updates);
  const Json json = {{"algo", algo_at(find_algo(flags.algo)).name},
                     {"samples", flags.samples},
                     {"threads", flags.threads},
                     {"samples_per_second", rate},
                     {"passes_per_second", passes_rate},
                     {"allocations_per_update", per_update},
                     {"bytes", bytes},
                     {"updates", updates},
                     {"seconds", seconds}};
  return {json, format("%.0f samples/s (samples x passes; %lld updates), %.4g passes/s, %g allocations per "
                       "update, %.1f MB\n",
                       rate, static_cast<long long>(updates), passes_rate, per_update,
                       static_cast<double>(bytes) / 1e6)};
}

Report bench_act(const ActFlags& flags) {
  const rdm_option hidden = {"hidden", flags.hidden.c_str(), 0};
  auto config = redman::agent_config(flags.obs, flags.act, 1);
  config.options = &hidden;
  config.num_options = 1;
  const redman::Policy policy(as_usage([&] { return redman::Agent(config); }).policy());
  const auto rows = static_cast<size_t>(flags.rows);
  std::vector<float> obs(rows * static_cast<size_t>(flags.obs)),
      action(rows * static_cast<size_t>(flags.act));
  Noise noise;
  for (float& x : obs) x = noise.normal();
  redman::Bytes scratch(policy.scratch_bytes(flags.rows));
  const auto act = [&] {
    policy.act(obs.data(), flags.rows, nullptr, action.data(), scratch.data(), scratch.size());
  };
  act();

  double seconds = 0;
  int64_t calls = 0, chunk = 1;
  const int64_t allocated = allocation_count();
  while (seconds < flags.seconds) {
    const auto clock = Clock::now();
    for (int64_t i = 0; i < chunk; ++i) act();
    const double took = since(clock);
    seconds += took;
    calls += chunk;
    if (took < 0.02) chunk *= 2;
  }
  const double rate = static_cast<double>(calls) * flags.rows / seconds;
  const double per_call =
      allocated < 0 ? -1 : static_cast<double>(allocation_count() - allocated) / static_cast<double>(calls);
  const Json json = {{"rows", flags.rows},
                     {"actions_per_second", rate},
                     {"allocations_per_call", per_call},
                     {"seconds", seconds}};
  return {json,
          format("%.0f actions/s (%d rows a call), %g allocations per call\n", rate, flags.rows, per_call)};
}

}  // namespace tool
