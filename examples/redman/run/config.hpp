// config.json: what a run was asked for, with the defaults written out.
#pragma once
#include <cstddef>
#include <map>
#include <redman/shield.hpp>
#include <string>

#include "common/setup.hpp"
#include "common/task_files.hpp"
#include "play/shield_word.hpp"
#include "teach/settings.hpp"

namespace tool {

// What `train` was asked for: everything needed to do it again.
struct RunSettings {
  PoolSettings pool;
  AgentSettings agent;
  std::vector<std::string> limits;  // as --cost-limit had them
  double rated_limit = -1;          // of an episode's column 0, by option cost_limit_per_step; < 0: not so
  int64_t steps = 1000000;          // control steps, all worlds
  int32_t eval_every = 10;          // epochs
  int32_t checkpoint_every = 10;    // epochs
  bool events = true;               // an event file for TensorBoard
  OwnFiles own;
  TeachSettings teach;         // `from` "": nobody teaches
  ShieldWord shield;           // that rollouts are under
  std::string save_recording;  // file for what the teacher showed, "": none; not kept
  // Of a run of redman.train in Python, which alone can continue it: "module:Class" of its task, "": another
  // task; whether its reward or its costs are functions there. `limits` is empty where its costs are.
  std::string task_class;
  bool functions = false;
  std::string version, kernels;  // of the library that began it or went on with it last; "": unknown
};

// The text of the file. `pool`, `agent` and the shield (null: none) say what the options came to; limits [cost_dim].
std::string config_text(const RunSettings& settings, const redman::Pool& pool, const redman::Agent& agent,
                        const std::vector<double>& limits, int64_t steps_per_epoch,
                        const redman::Shield* shield = nullptr);

// Failure when a member is missing, of the wrong kind or out of range. Whether task, algorithm and options
// exist is for the pool and the agent to say.
RunSettings parse_config(const char* text, size_t size);

// The part that a plot is labelled with.
struct RunLabel {
  std::string task, algo;
  uint64_t seed = 0;
};
RunLabel parse_label(const char* text, size_t size);

// Everything that two runs may differ in, "algo_cfgs.clip" as text: without the seed, threads, the build and
// what is written out elsewhere.
using FlatConfig = std::map<std::string, std::string>;
FlatConfig parse_flat_config(const char* text, size_t size);

}  // namespace tool
