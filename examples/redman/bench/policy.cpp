// `bench policy`: what a policy that sees points costs, part by part: clouds, encoder, update, and all
// together.
#include <chrono>
#include <redman/sense.hpp>

#include "bench/bench.hpp"
#include "common/names.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

using Clock = std::chrono::steady_clock;

// Calls f until `seconds` have gone by; seconds of a call.
template <class F>
double time_of(double seconds, F&& f) {
  int64_t calls = 0;
  const auto begin = Clock::now();
  double took = 0;
  do {
    f();
    ++calls;
    took = std::chrono::duration<double>(Clock::now() - begin).count();
  } while (took < seconds);
  return took / static_cast<double>(calls);
}

redman::Pool worlds(PoolSettings settings, const char* modality, const SeeingFlags& flags) {
  settings.options.insert(
      settings.options.begin(),
      {{"modality", modality}, {"points", std::to_string(flags.points)}, {"sampling", "voxel"}});
  redman::Pool pool = make_pool(settings, RDM_AUTORESET_SAME_STEP);
  pool.reset();
  return pool;
}

redman::Agent learner(const SeeingFlags& flags, const redman::Pool& pool, bool seeing) {
  AgentSettings agent = flags.agent;
  agent.options.insert(agent.options.begin(), {{"actor_obs", "vision"},
                                               {"encoder", seeing ? flags.encoder : ""},
                                               {"encoder_points", std::to_string(flags.points)}});
  agent.options.emplace_back("horizon", std::to_string(flags.horizon));
  return make_agent(agent, pool, cost_limits(pool, {}), flags.pool.seed, flags.pool.threads);
}

// A decision is one control step here, for an update takes as long whatever was seen.
rdm_epoch collect_and_update(redman::Agent& agent, redman::Pool& pool, int32_t horizon, double* seconds) {
  auto t = redman::sized<rdm_transition>();
  t.reward = pool.reward().data();
  t.cost = pool.cost().data();
  t.terminated = pool.terminated().data();
  t.truncated = pool.truncated().data();
  const rdm_points points = redman::points(redman::sensors(pool));
  for (int32_t i = 0; i < horizon; ++i) {
    redman::act(agent, pool.obs().data(), points, RDM_ACT_SAMPLE, pool.action().data());
    pool.step();
    agent.record(t);
  }
  const auto begin = Clock::now();
  const rdm_epoch e = agent.update(pool.obs().data());
  *seconds += std::chrono::duration<double>(Clock::now() - begin).count();
  return e;
}

}  // namespace

Report bench_policy(SeeingFlags flags) {
  if (!same_name(flags.modality, "points"))
    throw Usage("--modality " + flags.modality + ": a policy can only read points");
  refuse_flags(flags.sets, {"modality", "points", "encoder", "horizon"});
  apply_sets(flags.sets, flags.pool, &flags.agent);
  const double part = flags.seconds / 6, worlds_count = flags.pool.envs;

  PoolSettings as_trained = flags.pool;
  AgentSettings own = flags.agent;
  own.options.insert(own.options.begin(),
                     {{"encoder", flags.encoder}, {"encoder_points", std::to_string(flags.points)}});
  give_eyes(own, as_trained);
  redman::Pool seen = worlds(as_trained, "points", flags), blind = worlds(flags.pool, "state", flags);
  const auto step = [](redman::Pool& pool) {
    pool.baseline(RDM_BASELINE_RANDOM);
    pool.step();
  };
  double cloud_ms;
  {
    redman::Pool each = worlds(flags.pool, "points", flags);  // a cloud in every step
    cloud_ms =
        1e3 * (time_of(part, [&] { step(each); }) - time_of(part, [&] { step(blind); })) / worlds_count;
  }

  redman::Agent agent = learner(flags, seen, true), other = learner(flags, blind, false);
  const redman::Policy policy(agent.policy()), without(other.policy());
  const auto rows = static_cast<int32_t>(seen.num_envs());
  redman::Bytes scratch(std::max(policy.scratch_bytes(rows), without.scratch_bytes(rows)));
  std::vector<float> action(seen.num_envs() * seen.action().width());
  const rdm_points points = redman::points(redman::sensors(seen));
  const double encoder_ms =
      1e3 *
      (time_of(part,
               [&] {
                 redman::act(policy, seen.obs().data(), points, rows, nullptr, action.data(), scratch.data(),
                             scratch.size());
               }) -
       time_of(part,
               [&] {
                 without.act(seen.obs().data(), rows, nullptr, action.data(), scratch.data(), scratch.size());
               })) /
      worlds_count;

  // whole epochs as training has them, then some by hand, of which the update is timed
  agent.rollout(seen);
  int64_t frames = -agent.rollout(seen).env_steps, samples = 0, decisions = 0;
  double all = 0, update = 0;
  for (int64_t last = 0; all < 2 * part || last == 0;) {
    const auto begin = Clock::now();
    last = agent.rollout(seen).env_steps;
    all += std::chrono::duration<double>(Clock::now() - begin).count();
    if (all >= 2 * part) frames += last;
  }
  for (int64_t epochs = 0; update < part || epochs < 3; ++epochs) {
    const rdm_epoch e = collect_and_update(agent, seen, flags.horizon, &update);
    samples += int64_t{flags.pool.envs} * flags.horizon * e.passes;
    decisions += int64_t{flags.pool.envs} * flags.horizon;
  }
  const double rate = static_cast<double>(samples) / update, fps = static_cast<double>(frames) / all,
               update_ms = 1e3 * update / static_cast<double>(decisions);
  const Json json = {{"task", task_at(seen.spec().task).name},
                     {"points", flags.points},
                     {"encoder", flags.encoder},
                     {"envs", flags.pool.envs},
                     {"threads", flags.pool.threads},
                     {"cloud_ms", cloud_ms},
                     {"encoder_ms", encoder_ms},
                     {"update_ms", update_ms},
                     {"samples_per_second", rate},
                     {"frames_per_second", fps}};
  return {json, format("a cloud %.3f ms, its features %.3f ms, a decision's update %.3f ms; %.0f samples/s "
                       "(samples x passes); %.0f frames/s with training\n",
                       cloud_ms, encoder_ms, update_ms, rate, fps)};
}

}  // namespace tool
