// The program of examples/c over redman.hpp: owners, views and exceptions.
//
//   hello POLICY [bench]
#include <cstdio>
#include <ctime>
#include <redman/redman.hpp>

// Worlds at the start of their first episode, with actions that hold the start pose.
static redman::Pool make_pool(const char* task, int32_t num_envs, uint64_t seed) {
  auto config = redman::pool_config(task, num_envs);
  config.seed = seed;
  config.autoreset = RDM_AUTORESET_NEXT_STEP;  // ended worlds rest until the next step
  redman::Pool pool(config);
  pool.reset();
  pool.baseline(RDM_BASELINE_HOLD);
  return pool;
}

struct Outcome {
  double sum = 0, cost = 0;     // of world 0
  unsigned long long hash = 0;  // of all states
};

// 75 steps; policy null: the start pose is held.
static Outcome play(const redman::Policy* policy) {
  auto pool = make_pool("hand_over_safe_finger", 4, 7);
  if (policy) policy->check_fits(pool.spec());
  Outcome o;
  for (int t = 0; t < 75; ++t) {
    if (policy && t % policy->info().action_repeat == 0)
      policy->act(pool.obs().data(), 4, nullptr, pool.action().data());
    pool.step();
    o.sum += pool.reward()[0];
    o.cost += pool.cost()[0][0];
  }
  o.hash = pool.hash();
  return o;
}

// CPU seconds of one step of the pool.
static double measure(const char* task, int32_t num_envs, int calls) {
  auto pool = make_pool(task, num_envs, 0);
  for (int t = 0; t < calls; ++t) pool.step();  // warms up
  const std::clock_t start = std::clock();
  for (int t = 0; t < calls; ++t) pool.step();
  return static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / calls;
}

int main(int argc, char** argv) try {
  if (argc < 2) throw std::invalid_argument("usage: hello POLICY [bench]");
  Outcome o = play(nullptr);
  std::printf("hold cost %.0f hash %016llx\n", o.cost, o.hash);
  const redman::Policy policy(argv[1]);
  o = play(&policy);
  std::printf("policy return %.4f cost %.0f hash %016llx\n", o.sum, o.cost, o.hash);
  if (argc > 2) {
    std::printf("bandit %.0f ns a step\n", 1e9 * measure("bandit", 1, 1000000));
    std::printf("hand_over %.0f steps/s of 1 world\n", 1 / measure("hand_over_safe_finger", 1, 40000));
    std::printf("hand_over %.0f steps/s of 64 worlds\n", 64 / measure("hand_over_safe_finger", 64, 1000));
  }
} catch (const std::exception& error) {
  std::fprintf(stderr, "hello: %s\n", error.what());
  return 1;
}
