// `bench`: the flags of its parts.
#include "bench/bench.hpp"

#include <memory>

#include "commands.hpp"
#include "common/numbers.hpp"
#include "common/setup.hpp"

namespace tool {
namespace {

void add_network_flags(CLI::App& command, int32_t& obs, int32_t& act, std::string& hidden) {
  command.add_option("--obs", obs, "observations");
  command.add_option("--act", act, "actions");
  command.add_option("--hidden", hidden, "widths of the hidden layers, such as 256,256");
}

void add_seconds(CLI::App& command, double& seconds) {
  command.add_option("--seconds", seconds, "time to measure for")
      ->check(above_zero())
      ->check(finite_to(86400));
}

}  // namespace

void add_bench(CLI::App& app, Run& run) {
  CLI::App* bench = app.add_subcommand("bench", "Measure the rates of stepping, learning and acting");
  bench->require_subcommand(1);

  auto step = std::make_shared<StepFlags>();
  step->pool.envs = 64;
  CLI::App* command = bench->add_subcommand("step", "Control steps per second under random actions");
  add_pool_flags(*command, step->pool, "task");
  add_seconds(*command, step->seconds);
  add_set_flag(*command, step->sets);
  command->callback([&run, step] { run = [step] { return bench_step(*step); }; });

  auto observe = std::make_shared<ObserveFlags>();
  observe->pool.envs = 16;
  command = bench->add_subcommand("observe", "Worlds x frames per second with pictures, points or voxels");
  add_pool_flags(*command, observe->pool, "task");
  command->add_option("--modality", observe->modality, "as the option modality");
  add_seconds(*command, observe->seconds);
  add_set_flag(*command, observe->sets);
  command->callback([&run, observe] { run = [observe] { return bench_observe(*observe); }; });

  auto update = std::make_shared<UpdateFlags>();
  const auto positive = at_least(1);
  command = bench->add_subcommand("update", "Samples per second that an agent learns from");
  command->add_option("--algo", update->algo, "algorithm");
  add_network_flags(*command, update->obs, update->act, update->hidden);
  command->add_option("--samples", update->samples, "decisions of an epoch")->check(positive);
  command->add_option("--epochs", update->epochs, "passes over them")->check(positive);
  command->add_option("--minibatch", update->minibatch, "samples of a minibatch")->check(positive);
  command->add_option("--threads", update->threads, "threads; 0: the caller's own");
  add_seconds(*command, update->seconds);
  add_set_flag(*command, update->sets);
  command->callback([&run, update] { run = [update] { return bench_update(*update); }; });

  auto policy = std::make_shared<SeeingFlags>();
  policy->pool.envs = 64;
  command = bench->add_subcommand("policy", "Time of a policy that reads points, part by part");
  add_pool_flags(*command, policy->pool, "task");
  command->add_option("--algo", policy->agent.algo, "algorithm");
  command->add_option("--modality", policy->modality, "what it observes: points");
  command->add_option("--points", policy->points, "of a cloud")->check(CLI::Range(1, 16384));
  command->add_option("--encoder", policy->encoder, "widths of its layers, such as 64,128");
  command->add_option("--horizon", policy->horizon, "decisions of a world in an epoch")
      ->check(CLI::Range(1, 4096));
  add_seconds(*command, policy->seconds);
  add_set_flag(*command, policy->sets);
  command->callback([&run, policy] { run = [policy] { return bench_policy(*policy); }; });

  auto act = std::make_shared<ActFlags>();
  command = bench->add_subcommand("act", "Actions per second of a frozen policy");
  add_network_flags(*command, act->obs, act->act, act->hidden);
  command->add_option("--rows", act->rows, "observations in a call")->check(positive);
  add_seconds(*command, act->seconds);
  command->callback([&run, act] { run = [act] { return bench_act(*act); }; });

  auto latency = std::make_shared<LatencyFlags>();
  latency->pool.envs = 8;
  command = bench->add_subcommand("latency",
                                  "Latency of an act of a policy, and of an act with a slice of an update");
  add_pool_flags(*command, latency->pool, "task");
  command->add_option("--algo", latency->agent.algo, "algorithm");
  command->add_option("--calls", latency->calls, "acts of a policy")->check(positive);
  command->add_option("--ticks", latency->ticks, "acts of an agent with a slice of an update")
      ->check(positive);
  command->add_option("--units", latency->units, "pieces of work in a slice")->check(positive);
  command->add_option("--hz", latency->hz, "ticks per second; 0: without a wait")
      ->check(at_least(0))
      ->check(finite_to(1e6));
  add_set_flag(*command, latency->sets);
  command->callback([&run, latency] { run = [latency] { return bench_latency(*latency); }; });
}

}  // namespace tool
