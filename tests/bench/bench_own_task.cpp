// What a task of a host's own costs beside the library's: grasp in both ways, in turns.
//
//   bench_own_task [rounds]
#include <redman/redman.h>

#include <chrono>
#include <cstdio>
#include <cstdlib>

#include "own_grasp.hpp"

namespace {

double seconds_of(rdm_pool* pool, int steps) {
  const auto begin = std::chrono::steady_clock::now();
  for (int i = 0; i < steps; ++i) {
    rdm_pool_baseline(pool, RDM_BASELINE_RANDOM);
    rdm_pool_step(pool);
  }
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

rdm_pool* make(const char* task, int32_t envs) {
  rdm_pool_config c;
  rdm_pool_config_init(&c, sizeof c);
  c.task = task;
  c.num_envs = envs;
  rdm_pool* p = nullptr;
  if (rdm_pool_create(&p, &c) || rdm_pool_reset(p, nullptr, nullptr)) std::printf("%s\n", rdm_last_error());
  return p;
}

}  // namespace

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 20;
  constexpr int kEnvs = 16, kSteps = 74;
  rdm::test::GraspTask grasp;
  const rdm::test::Registered made(grasp.def);
  rdm_pool* pools[2] = {make("grasp", kEnvs), make("own_grasp", kEnvs)};
  double best[2] = {1e30, 1e30};
  for (int round = 0; round < rounds; ++round)
    for (int k = 0; k < 2; ++k) best[k] = std::min(best[k], seconds_of(pools[k], kSteps));
  const double ours = best[0] / (kEnvs * kSteps) * 1e9, own = best[1] / (kEnvs * kSteps) * 1e9;
  std::printf(
      "ns a control step of a world, best of %d rounds: built in %.0f, through callbacks %.0f, +%.0f ns, "
      "ratio %.4f\n",
      rounds, ours, own, own - ours, own / ours);
  for (rdm_pool* p : pools) rdm_pool_destroy(p);
  return 0;
}
