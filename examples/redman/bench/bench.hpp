// The benchmarks: flags in, report out.
#pragma once
#include "common/setup.hpp"

namespace tool {

struct StepFlags {
  PoolSettings pool;
  std::vector<std::string> sets;
  double seconds = 10;
};
// Random actions in every world and every control step.
Report bench_step(StepFlags flags);

struct ObserveFlags {
  PoolSettings pool;
  std::vector<std::string> sets;
  std::string modality = "points";
  double seconds = 10;
};
// The same with pictures, points or voxels of every world in every step.
Report bench_observe(ObserveFlags flags);

struct UpdateFlags {
  std::string algo = "ppo_lag", hidden = "256,256";
  std::vector<std::string> sets;
  int32_t obs = 398, act = 40, samples = 8192, epochs = 5, minibatch = 2048, threads = 0;
  double seconds = 5;
};
// rdm_agent_update alone, on made-up data.
Report bench_update(const UpdateFlags& flags);

struct ActFlags {
  std::string hidden = "256,256";
  int32_t obs = 398, act = 40, rows = 1;
  double seconds = 2;
};
// rdm_policy_act alone.
Report bench_act(const ActFlags& flags);

struct LatencyFlags {
  PoolSettings pool;
  AgentSettings agent;
  std::vector<std::string> sets;
  int32_t calls = 1000000, ticks = 10000, units = 1;
  double hz = 1000;
};
// What a control loop waits for: a policy's act, and an agent's with a slice of an update.
Report bench_latency(LatencyFlags flags);

struct SeeingFlags {
  PoolSettings pool;
  AgentSettings agent;
  std::vector<std::string> sets;
  std::string modality = "points", encoder = "64,128";
  int32_t points = 512, horizon = 8;
  double seconds = 6;
};
// A policy that sees, part by part: clouds, its encoder, updates; and training as a whole.
Report bench_policy(SeeingFlags flags);

}  // namespace tool
