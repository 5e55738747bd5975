// Many steps and many resets of every task: the resident memory stays flat, no world diverges without a
// reason, everything that is written stays finite. Random actions, worlds reset in turn at every hundredth
// step.
//
//   hard_soak [--steps N] [--seconds S] [--jobs J] [--only TEXT] [--pairs TASK] [--json FILE]
// --pairs: TASK with every hand on every arm. N control steps of one world, summed over worlds, for each task
// (1e7), or what fits into S seconds for all tasks together, J of them at a time (2). The slowest tasks come
// first.
#include <fstream>

#include "isolate.hpp"
#include "worlds.hpp"

using namespace hard;

namespace {

constexpr int32_t kEnvs = 16, kBetweenResets = 100;
constexpr long kGrowth = 1 << 20;  // bytes of resident memory after the first tenth: pages of the allocator

struct Soak {
  char task[64] = "";
  long steps = 0, resets = 0, episodes = 0;
  long diverged = 0, overflowed = 0;
  int contacts_max = 0;
  double contacts_mean = 0, drift = 0, seconds = 0;
  long resident = 0, growth = 0, world = 0;  // bytes; world: of one, its share of the pool
  bool done = false;
  char note[256] = "";
};

long resident_bytes() {
  long pages = 0, resident = 0;
  std::ifstream in("/proc/self/statm");
  in >> pages >> resident;
  return resident * sysconf(_SC_PAGESIZE);
}

void soak(const World& w, long steps, double seconds, Soak& out) {
  std::snprintf(out.task, sizeof out.task, "%s", w.name().c_str());
  PoolOf pool;
  HARD_REQUIRE(pool.make(w, kEnvs) == RDM_OK, "%s", rdm_last_error());
  HARD_REQUIRE(rdm_pool_reset(pool.handle, nullptr, nullptr) == RDM_OK, "%s", rdm_last_error());
  size_t ours = 0, engines = 0;
  HARD_REQUIRE(rdm_pool_config_memory(&pool.config, &ours, &engines) == RDM_OK, "%s", rdm_last_error());
  out.world = static_cast<long>((ours + engines) / kEnvs);
  const double begin = now();
  long warm = 0, t = 0;
  const auto share = [&] {
    return std::max(static_cast<double>(t) * kEnvs / static_cast<double>(steps),
                    seconds > 0 ? (now() - begin) / seconds : 0);
  };
  for (; share() < 1; ++t) {
    uint8_t mask[kEnvs] = {};
    if (t % kBetweenResets < kEnvs) {
      mask[t % kBetweenResets] = 1;
      HARD_REQUIRE(rdm_pool_reset(pool.handle, nullptr, mask) == RDM_OK, "%s", rdm_last_error());
      ++out.resets;
    }
    HARD_REQUIRE(rdm_pool_baseline(pool.handle, RDM_BASELINE_RANDOM) == RDM_OK, "%s", rdm_last_error());
    HARD_REQUIRE(rdm_pool_step(pool.handle) == RDM_OK, "%s", rdm_last_error());
    for (int32_t i = 0; i < kEnvs; ++i) out.episodes += pool.rows.terminated[i] || pool.rows.truncated[i];
    const char* bad = pool.broken_row();
    HARD_REQUIRE(!bad, "%s is out of its bounds after %ld steps", bad, t);
    if (warm == 0 && t > 20 && share() > 0.1) warm = resident_bytes();
  }
  out.seconds = now() - begin;
  out.resident = resident_bytes();
  out.growth = warm ? out.resident - warm : 0;
  rdm_pool_stats s{};
  s.struct_size = sizeof s;
  HARD_REQUIRE(rdm_pool_get_stats(pool.handle, &s) == RDM_OK, "%s", rdm_last_error());
  out.steps = s.steps;
  out.diverged = s.diverged;
  out.overflowed = s.overflowed;
  out.contacts_max = s.contacts_max;
  out.contacts_mean = s.contacts_mean;
  out.drift = s.joint_drift;
  HARD_REQUIRE(s.steps == t * kEnvs, "%lld steps are counted of %ld", static_cast<long long>(s.steps),
               t * kEnvs);
  HARD_REQUIRE(out.growth <= kGrowth, "resident memory grew by %ld bytes", out.growth);
  HARD_REQUIRE(s.diverged == 0, "%lld worlds diverged", static_cast<long long>(s.diverged));
  out.done = true;
}

Soak* g_soak = nullptr;

}  // namespace

int main(int argc, char** argv) {
  const auto steps = static_cast<long>(std::atof(argument(argc, argv, "--steps", "1e7").c_str()));
  const double seconds = std::atof(argument(argc, argv, "--seconds", "0").c_str());
  const int jobs = std::max(1, std::atoi(argument(argc, argv, "--jobs", "2").c_str()));
  const std::string only = argument(argc, argv, "--only", ""), json = argument(argc, argv, "--json", "");
  const std::string pairs = argument(argc, argv, "--pairs", "");
  std::vector<World> worlds;
  for (const World& w : pairs.empty() ? all_worlds() : all_pairs(pairs))
    if (w.engine != "ode" && w.name().find(only) != std::string::npos) worlds.push_back(w);
  if (worlds.empty()) return 2;
  // rates decide the order and, with a bound on time, the shares: half of it by need, half the same for all
  std::vector<double> need;
  for (const World& w : worlds) {
    PoolOf pool;
    HARD_REQUIRE(pool.make(w, kEnvs) == RDM_OK, "%s", rdm_last_error());
    HARD_REQUIRE(rdm_pool_reset(pool.handle, nullptr, nullptr) == RDM_OK, "%s", rdm_last_error());
    const double t = now();
    int n = 0;
    for (; n < 2 || (now() - t < 0.1 && n < 1000); ++n) rdm_pool_step(pool.handle);
    need.push_back((now() - t) / n / kEnvs * static_cast<double>(steps));
  }
  std::vector<size_t> order(worlds.size());
  for (size_t i = 0; i < order.size(); ++i) order[i] = i;
  std::sort(order.begin(), order.end(), [&](size_t a, size_t b) { return need[a] > need[b]; });
  double all = 0;
  for (double n : need) all += n;

  void* memory =
      mmap(nullptr, sizeof(Soak) * worlds.size(), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  g_soak = new (memory) Soak[worlds.size()];
  size_t next = 0, ended = 0;
  int running = 0;
  while (ended < worlds.size()) {
    while (running < jobs && next < worlds.size()) {
      const size_t i = order[next++];
      double share = 0;
      if (seconds > 0 && all > seconds * jobs)
        share = seconds * jobs * (0.5 * need[i] / all + 0.5 / static_cast<double>(worlds.size()));
      std::fflush(nullptr);
      if (fork() == 0) {
        static Soak* mine;
        mine = g_soak + i;
        on_broken = [](const char* text) { std::snprintf(mine->note, sizeof mine->note, "%s", text); };
        soak(worlds[i], steps, share, *mine);
        _exit(0);
      }
      ++running;
    }
    int status = 0;
    if (waitpid(-1, &status, 0) < 0) break;
    --running;
    ++ended;
  }
  long passed = 0, failed = 0;
  std::printf("%-36s %10s %8s %9s %9s %8s %9s %8s %9s %9s %8s %8s %8s\n", "soak", "steps", "resets",
              "episodes", "diverged", "cut off", "contacts", "mean", "drift mm", "MB", "grew kB", "steps/s",
              "kB each");
  std::string text = "[";
  for (size_t i : order) {
    const Soak& s = g_soak[i];
    (s.done ? passed : failed) += 1;
    const std::string name = worlds[i].name();
    std::printf("%-36s %10ld %8ld %9ld %9ld %8ld %9d %8.2f %9.4f %9.1f %8.0f %8.0f %8.0f%s%s\n", name.c_str(),
                s.steps, s.resets, s.episodes, s.diverged, s.overflowed, s.contacts_max, s.contacts_mean,
                1e3 * s.drift, static_cast<double>(s.resident) / 1048576,
                static_cast<double>(s.growth) / 1024, static_cast<double>(s.steps) / s.seconds,
                static_cast<double>(s.world) / 1024, s.done ? "" : "  ",
                s.done    ? ""
                : *s.note ? s.note
                          : "died");
    char row[512];
    std::snprintf(
        row, sizeof row,
        "%s\n {\"task\": \"%s\", \"steps\": %ld, \"resets\": %ld, \"episodes\": %ld, \"diverged\": %ld, "
        "\"overflowed\": %ld, \"contacts_max\": %d, \"contacts_mean\": %.3f, \"joint_drift\": %.3g, "
        "\"resident_bytes\": %ld, \"growth_bytes\": %ld, \"world_bytes\": %ld, \"seconds\": %.1f, \"ok\": "
        "%s}",
        text.size() > 1 ? "," : "", name.c_str(), s.steps, s.resets, s.episodes, s.diverged, s.overflowed,
        s.contacts_max, s.contacts_mean, s.drift, s.resident, s.growth, s.world, s.seconds,
        s.done ? "true" : "false");
    text += row;
  }
  if (!json.empty()) std::ofstream(json) << text << "\n]\n";
  std::printf("%ld passed, %ld failed\n", passed, failed);
  return failed != 0;
}
