// Hard treatment of both engines and its figures, as one JSON document {"rows": [...]}.
//   bench_hostile [case|all] [control steps of a row] [engine|both] [task] [seed]
// Case: a name of hostile.hpp. The steps of a row are spread over 64 worlds.
#include <cinttypes>
#include <cstdio>
#include <cstdlib>
#include <ctime>

#include "hostile.hpp"

namespace {

double seconds() {
  timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// False when a call failed.
bool run(const hostile::Case& c, int64_t steps, const char* engine, const char* task, uint64_t seed,
         bool first) {
  constexpr int32_t kWorlds = 64;
  const double start = seconds();
  hostile::Trial trial(task, engine, c, kWorlds, seed);
  if (!trial.pool()) {
    std::fprintf(stderr, "%s\n", rdm_last_error());
    return false;
  }
  for (int64_t i = 0; i * kWorlds < steps; ++i) trial.step();
  trial.finish();
  const hostile::Figures& f = trial.figures();
  std::printf("%s\n  {\"case\": \"%s\", \"engine\": \"%s\", \"task\": \"%s\", \"seed\": %" PRIu64
              ", \"result\": %d, \"steps\": %" PRId64 ", \"episodes\": %" PRId64
              ", \"seconds\": %.1f,\n"
              "   \"not_finite\": %" PRId64 ", \"diverged\": %" PRId64 ", \"overflowed\": %" PRId64
              ", \"other_bits\": %" PRId64 ", \"unflagged\": %" PRId64 ", \"stuck\": %" PRId64 ",\n",
              first ? "" : ",", c.name, engine, task, seed, trial.result(), f.steps, f.episodes,
              seconds() - start, f.not_finite, f.diverged, f.overflowed, f.other, f.unflagged, f.stuck);
  std::printf(
      "   \"contacts_mean\": %.3f, \"contacts_max\": %d, \"object_distance\": %.4g, "
      "\"object_height\": %.4g, \"object_speed\": %.4g,\n"
      "   \"joint_rate\": %.4g, \"joint_excess\": %.4g, \"tip_fast\": %.3g, \"rotation_error\": %.2g, "
      "\"contact_depth\": %.4g, \"contact_force\": %.4g,\n   \"events\": [",
      f.contacts_mean, f.contacts_max, f.object_distance, f.object_height, f.object_speed, f.joint_rate,
      f.joint_excess, f.tip_fast, f.rotation_error, f.contact_depth, f.contact_force);
  for (const hostile::Event& e : trial.events())
    std::printf("%s{\"step\": %" PRId64 ", \"env\": %d, \"status\": %u}",
                &e == &trial.events()[0] ? "" : ", ", e.step, e.env, e.status);
  std::printf("]}");
  std::fflush(stdout);
  return trial.result() == RDM_OK;
}

}  // namespace

int main(int argc, char** argv) {
  const std::string which = argc > 1 ? argv[1] : "all", engines = argc > 3 ? argv[3] : "both";
  const int64_t steps = argc > 2 ? std::atoll(argv[2]) : 200000;
  const char* task = argc > 4 ? argv[4] : "hand_over_safe_finger";
  const uint64_t seed = argc > 5 ? std::strtoull(argv[5], nullptr, 10) : 1;
  bool good = true, first = true;
  std::printf("{\"rows\": [");
  for (const hostile::Case& c : hostile::cases()) {
    if (which != "all" && which != c.name) continue;
    for (const char* engine : {"articulated", "ode"}) {
      if (engines != "both" && engines != engine) continue;
      good = run(c, steps, engine, task, seed, first) && good;
      first = false;
    }
  }
  std::printf("\n]}\n");
  return good ? 0 : 1;
}
