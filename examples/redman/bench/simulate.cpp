// `bench observe`: worlds x frames per second with pictures, points or voxels, beside the same steps without.
#include <redman/redman_sense.h>

#include <chrono>
#include <ctime>

#include "bench/bench.hpp"
#include "bench/malloc_count.hpp"
#include "common/names.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

using Clock = std::chrono::steady_clock;

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
    for (int i = 0; i < count; ++i) {
      pool.baseline(RDM_BASELINE_RANDOM);
      pool.step();
    }
    return std::chrono::duration<double>(Clock::now() - begin).count();
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

Report bench_observe(ObserveFlags flags) {
  apply_sets(flags.sets, flags.pool, nullptr);
  PoolSettings blind = flags.pool;
  flags.pool.options.push_back({"modality", flags.modality});
  redman::Pool pool = make_pool(flags.pool, RDM_AUTORESET_SAME_STEP),
               without = make_pool(blind, RDM_AUTORESET_SAME_STEP);
  auto sensors = redman::sized<rdm_sensors>();
  redman::check(rdm_pool_sensors(pool.get(), &sensors));
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
