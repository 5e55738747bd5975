// `bench step`, `bench observe`: control steps under random actions, blind and with pictures, points or
// voxels.
#include <redman/sense.h>

#include <algorithm>
#include <ctime>

#include "bench/bench.hpp"
#include "bench/malloc_count.hpp"
#include "common/clock.hpp"
#include "common/names.hpp"
#include "common/posix.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

void random_steps(redman::Pool& pool, int count) {
  for (int i = 0; i < count; ++i) {
    pool.baseline(RDM_BASELINE_RANDOM);
    pool.step();
  }
}

// Resident bytes of a world: what a pool of many adds to a process that has made one already, after episodes
// have touched its memory.
double bytes_per_env(PoolSettings settings) {
  constexpr int32_t kMany = 64;
  constexpr int kSteps = 20;
  settings.envs = std::max(settings.threads, 1);
  redman::Pool first = make_pool(settings, RDM_AUTORESET_SAME_STEP);
  first.reset();
  random_steps(first, kSteps);
  settings.envs = std::max(settings.envs, kMany);
  const size_t before = resident_bytes();
  redman::Pool pool = make_pool(settings, RDM_AUTORESET_SAME_STEP);
  pool.reset();
  random_steps(pool, kSteps);
  const size_t after = resident_bytes();
  return (static_cast<double>(after) - static_cast<double>(before)) / settings.envs;
}

struct Rate {
  double per_second = 0, cpu_seconds = 0;  // control steps of one world; processor time of each
  double allocations = 0;                  // in each step of the pool
};

// Of all threads of this process: unlike the clock, it stands while others have the processor.
double cpu_seconds() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

Rate measure(redman::Pool& pool, double seconds) {
  const auto run = [&](int count) {
    const auto begin = Clock::now();
    random_steps(pool, count);
    return since(begin);
  };
  pool.reset();
  int chunk = 1;
  while (run(chunk) < 0.05 * seconds) chunk *= 2;
  double took = 0;
  int64_t steps = 0;
  const int64_t before = allocation_count();
  const double cpu = cpu_seconds();
  for (; took < seconds; steps += chunk) took += run(chunk);
  const auto count = static_cast<double>(steps), frames = count * static_cast<double>(pool.num_envs());
  return {frames / took, (cpu_seconds() - cpu) / frames,
          before < 0 ? -1 : static_cast<double>(allocation_count() - before) / count};
}

}  // namespace

Report bench_step(StepFlags flags) {
  apply_sets(flags.sets, flags.pool, nullptr);
  const double bytes = bytes_per_env(flags.pool);
  redman::Pool pool = make_pool(flags.pool, RDM_AUTORESET_SAME_STEP);
  pool.reset();
  const auto begin = Clock::now();
  do random_steps(pool, 10);
  while (since(begin) < std::min(1.0, 0.2 * flags.seconds));

  double seconds = 0, cpu = 0, drift = 0;
  int64_t steps = 0, allocations = 0;
  int chunk = 1;
  while (seconds < flags.seconds) {
    const int64_t allocated = allocation_count();
    const auto clock = Clock::now();
    const double cpu_before = cpu_seconds();
    random_steps(pool, chunk);
    cpu += cpu_seconds() - cpu_before;
    const double took = since(clock);
    allocations += allocation_count() - allocated;
    seconds += took;
    steps += chunk;
    drift = std::max(drift, pool.stats().joint_drift);
    if (took < 0.02) chunk *= 2;
  }
  const double rate = static_cast<double>(steps) * flags.pool.envs / seconds;
  const double per_step =
      allocation_count() < 0 ? -1 : static_cast<double>(allocations) / static_cast<double>(steps);
  const rdm_pool_stats stats = pool.stats();
  const Json json = {{"task", task_at(pool.spec().task).name},
                     {"envs", flags.pool.envs},
                     {"threads", flags.pool.threads},
                     {"steps_per_second", rate},
                     {"steps_per_cpu_second", rate * seconds / std::max(cpu, 1e-9)},
                     {"bytes_per_env", bytes},
                     {"allocations_per_step", per_step},
                     {"max_joint_drift_m", drift},
                     {"contacts_mean", stats.contacts_mean},
                     {"contacts_max", stats.contacts_max},
                     {"overflowed", stats.overflowed},
                     {"diverged", stats.diverged},
                     {"seconds", seconds}};
  return {json,
          format("%.0f control steps/s (%d worlds, %d threads), %.0f kB per world, %g allocations per step, "
                 "largest joint gap %.3g m\n",
                 rate, flags.pool.envs, flags.pool.threads, bytes / 1e3, per_step, drift)};
}

Report bench_observe(ObserveFlags flags) {
  refuse_flags(flags.sets, {"modality"});
  apply_sets(flags.sets, flags.pool, nullptr);
  PoolSettings blind = flags.pool;
  flags.pool.options.push_back({"modality", flags.modality});
  redman::Pool pool = make_pool(flags.pool, RDM_AUTORESET_SAME_STEP),
               without = make_pool(blind, RDM_AUTORESET_SAME_STEP);
  auto sensors = redman::sized<rdm_sensors>();
  redman::check(rdm_pool_get_sensors(pool.get(), &sensors));
  const Rate seeing = measure(pool, 0.7 * flags.seconds), bare = measure(without, 0.3 * flags.seconds);
  const double microseconds = 1e6 * (seeing.cpu_seconds - bare.cpu_seconds);
  Json json = {{"task", task_at(pool.spec().task).name},
               {"modality", flags.modality},
               {"envs", flags.pool.envs},
               {"threads", flags.pool.threads},
               {"frames_per_second", seeing.per_second},
               {"steps_per_second_without", bare.per_second},
               {"sense_cpu_microseconds", microseconds},
               {"allocations_per_step", seeing.allocations},
               {"cameras", sensors.num_cameras},
               {"width", sensors.width},
               {"height", sensors.height},
               {"points", sensors.num_points},
               {"voxels", sensors.num_voxels}};
  if (sensors.point_count) {
    double sum = 0;
    for (size_t i = 0; i < pool.num_envs(); ++i) sum += sensors.point_count[i];
    json["points_differing"] = sum / static_cast<double>(pool.num_envs());
  }
  return {
      json,
      format("%.0f worlds x frames per second of %s (%d worlds, %d threads), physics with it; %.0f without; "
             "%.0f us of a processor a frame, %g allocations per step\n",
             seeing.per_second, flags.modality.c_str(), flags.pool.envs, flags.pool.threads, bare.per_second,
             microseconds, seeing.allocations)};
}

}  // namespace tool
