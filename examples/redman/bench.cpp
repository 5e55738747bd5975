// `bench`: the flags of its parts.
#include "bench/bench.hpp"

#include <memory>

#include "commands.hpp"
#include "common/numbers.hpp"
#include "common/setup.hpp"

namespace tool {
namespace {

void add_network_flags(CLI::App& command, int32_t& obs, int32_t& act, std::string& hidden) {
  command.add_option("--obs", obs, "number of entries of an observation");
  command.add_option("--act", act, "number of entries of an action");
  command.add_option("--hidden", hidden, "widths of the hidden layers, for example 256,256");
}

void add_seconds(CLI::App& command, double& seconds) {
  command.add_option("--seconds", seconds, "duration of the measurement, s")
      ->check(above_zero())
      ->check(finite_to(86400));
}

}  // namespace

void add_bench(CLI::App& app, Run& run) {
  CLI::App* bench =
      app.add_subcommand("bench", "Measure how fast worlds step, agents learn and policies act");
  bench->require_subcommand(1);

  auto step = std::make_shared<StepFlags>();
  step->pool.envs = 64;
  CLI::App* command = bench->add_subcommand("step", "Control steps per second with random actions");
  add_pool_flags(*command, step->pool, "task");
  add_seconds(*command, step->seconds);
  add_set_flag(*command, step->sets);
  command->callback([&run, step] { run = [step] { return bench_step(*step); }; });

  auto observe = std::make_shared<ObserveFlags>();
  observe->pool.envs = 16;
  command =
      bench->add_subcommand("observe", "Frames per second, over all worlds, with images, points or voxels");
  add_pool_flags(*command, observe->pool, "task");
  command->add_option("--modality", observe->modality, "sensors to measure, as in the option modality");
  add_seconds(*command, observe->seconds);
  add_set_flag(*command, observe->sets);
  command->callback([&run, observe] { run = [observe] { return bench_observe(*observe); }; });

  auto update = std::make_shared<UpdateFlags>();
  const auto positive = at_least(1);
  command = bench->add_subcommand("update", "Samples per second in an agent's update");
  command->add_option("--algo", update->algo, "algorithm");
  add_network_flags(*command, update->obs, update->act, update->hidden);
  command->add_option("--samples", update->samples, "number of decisions in an epoch")->check(positive);
  command->add_option("--epochs", update->epochs, "number of passes over the data of an epoch")
      ->check(positive);
  command->add_option("--minibatch", update->minibatch, "number of samples in a minibatch")->check(positive);
  command->add_option("--threads", update->threads, "number of threads; 0: the calling thread alone");
  add_seconds(*command, update->seconds);
  add_set_flag(*command, update->sets);
  command->callback([&run, update] { run = [update] { return bench_update(*update); }; });

  auto policy = std::make_shared<SeeingFlags>();
  policy->pool.envs = 64;
  command = bench->add_subcommand("policy", "Time that each part of a point-cloud policy takes");
  add_pool_flags(*command, policy->pool, "task");
  command->add_option("--algo", policy->agent.algo, "algorithm");
  command->add_option("--modality", policy->modality, "sensors of the policy: points");
  command->add_option("--points", policy->points, "number of points in a cloud")->check(between(1, 16384));
  command->add_option("--encoder", policy->encoder, "widths of the encoder's layers, for example 64,128");
  command->add_option("--horizon", policy->horizon, "number of decisions of each world in an epoch")
      ->check(between(1, 4096));
  add_seconds(*command, policy->seconds);
  add_set_flag(*command, policy->sets);
  command->callback([&run, policy] { run = [policy] { return bench_policy(*policy); }; });

  auto act = std::make_shared<ActFlags>();
  command = bench->add_subcommand("act", "Actions per second of a frozen policy");
  add_network_flags(*command, act->obs, act->act, act->hidden);
  command->add_option("--rows", act->rows, "number of observations in a call")->check(positive);
  add_seconds(*command, act->seconds);
  command->callback([&run, act] { run = [act] { return bench_act(*act); }; });

  auto latency = std::make_shared<LatencyFlags>();
  latency->pool.envs = 8;
  command = bench->add_subcommand("latency", "Latency of one action, alone and with a slice of an update");
  add_pool_flags(*command, latency->pool, "task");
  command->add_option("--algo", latency->agent.algo, "algorithm");
  command->add_option("--calls", latency->calls, "number of actions of a policy to time")->check(positive);
  command
      ->add_option("--ticks", latency->ticks,
                   "number of actions of an agent, each with a slice of an update, to time")
      ->check(positive);
  command->add_option("--units", latency->units, "number of pieces of work in a slice")->check(positive);
  command->add_option("--hz", latency->hz, "ticks per second, Hz; 0: without waiting")
      ->check(at_least(0))
      ->check(finite_to(1e6));
  add_set_flag(*command, latency->sets);
  command->callback([&run, latency] { run = [latency] { return bench_latency(*latency); }; });
}

}  // namespace tool
