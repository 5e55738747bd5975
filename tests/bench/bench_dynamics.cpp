// Control steps per second of worlds whose constants are the scene's, or their own (SceneDef::adjustable),
// one core: two hands and a ball under random targets, engine articulated, 16 worlds in turn.
//   bench_dynamics [adjustable 0|1] [together] [repeats]      together 0: as many worlds as fill the lanes
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "articulated.hpp"
#include "base/fpmode.hpp"

namespace {
double seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}
}  // namespace

int main(int argc, char** argv) {
  using namespace rdm;
  const FpMode mode;
  constexpr int32_t kWorlds = 16;
  const bool adjustable = argc > 1 && std::atoi(argv[1]) != 0;
  const int repeats = argc > 3 ? std::atoi(argv[3]) : 11, steps = 400;
  SceneDef def = test::two_hands_def();
  def.adjustable = adjustable;
  test::Partners worlds(def, kWorlds);
  Stream random(7, 0, Purpose::kTest);
  for (int32_t i = 0; adjustable && i < kWorlds; ++i) {
    Dynamics& own = worlds[i].edit_dynamics();
    for (int32_t k = 0; k < own.num_links; ++k)
      own.links[k].mass = own.links[k].kp = random.uniform(0.7, 1.3);
    own.bodies[0].size = random.uniform(0.9, 1.1);
    worlds[i].set_dynamics(own);
  }
  const int32_t wanted = argc > 2 ? std::atoi(argv[2]) : 0,
                together = wanted > 0 ? wanted : worlds[0].group_size();
  std::vector<double> rates;
  for (int k = 0; k <= repeats; ++k) {
    const double start = seconds();
    for (int n = 0; n < steps; ++n) {
      for (int32_t i = 0; i < kWorlds; ++i) {
        test::random_targets(worlds[i], random);
        if ((n + i) % 75 == 0) worlds[i].set_body(0, {{{0, -0.36, 0.56}, {}}, {}, {}});
      }
      for (int32_t i = 0; i < kWorlds; i += together)
        World::step_together(worlds.data() + i, std::min(together, kWorlds - i));
    }
    if (k) rates.push_back(steps * kWorlds / (seconds() - start));
  }
  std::sort(rates.begin(), rates.end());
  std::printf("adjustable %d, %d together: %.0f control steps/s (median; %.0f to %.0f)\n", adjustable,
              together, rates[rates.size() / 2], rates.front(), rates.back());
}
