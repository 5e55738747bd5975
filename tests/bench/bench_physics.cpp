// Control steps per second of one world with two hands and a ball under random targets, one core.
//   bench_physics [iterations] [hand_hand 0|1] [repeats]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <vector>

#include "base/fpmode.hpp"
#include "base/rng.hpp"
#include "two_hands.hpp"

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
  test::TwoHands config;
  if (argc > 1) config.solver.iterations = std::atoi(argv[1]);
  if (argc > 2) config.hand_hand = std::atoi(argv[2]) != 0;
  const int repeats = argc > 3 ? std::atoi(argv[3]) : 11, steps = 400;
  test::Simulation sim(test::two_hands_def(config));
  Stream random(7, 0, Purpose::kTest);
  double share[24];
  std::vector<double> rates;
  long contacts = 0;
  for (int k = 0; k <= repeats; ++k) {
    const double start = seconds();
    for (int i = 0; i < steps; ++i) {
      for (int hand = 0; hand < 2; ++hand) {
        for (double& s : share) s = random.uniform();
        test::target_share(*sim, hand, share);
      }
      if (i % 75 == 0) sim->set_body(0, {{{0, -0.36, 0.56}, {}}, {}, {}});
      sim->step();
      if (k) contacts += sim->num_contacts();
    }
    if (k) rates.push_back(steps / (seconds() - start));
  }
  std::sort(rates.begin(), rates.end());
  std::printf("%d iterations, hand-hand %d: %.0f control steps/s (median; %.0f to %.0f), %.2f contacts\n",
              config.solver.iterations, config.hand_hand, rates[rates.size() / 2], rates.front(),
              rates.back(), static_cast<double>(contacts) / (repeats * steps));
}
