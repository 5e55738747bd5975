// `export`: a policy as a file for other programs.
#include <cmath>

#include "commands.hpp"
#include "common/files.hpp"
#include "common/text.hpp"
#include "network/network.hpp"
#include "play/actor.hpp"

namespace tool {
namespace {

struct ExportFlags {
  std::string policy, onnx, safetensors, probe;
  int32_t probes = 1000;
  uint64_t seed = 0;
};

// Plain uniform numbers: splitmix64.
float signed_unit(uint64_t& state) {
  uint64_t z = state += 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return static_cast<float>((z ^ (z >> 31)) >> 40) * 0x1p-23f - 1;
}

// Random observations and what the policy does: the normaliser's range, and every tenth row far outside it.
Json probe_json(const redman::Policy& policy, const Network& network, const ExportFlags& flags) {
  const auto rows = static_cast<size_t>(flags.probes), in = static_cast<size_t>(network.obs_dim),
             out = static_cast<size_t>(network.action_dim);
  const NamedTensor *shift = network.find("normalizer.shift"), *scale = network.find("normalizer.scale");
  std::vector<float> obs(rows * in), action(rows * out);
  uint64_t random = flags.seed;
  for (size_t i = 0; i < rows * in; ++i) {
    const float x = signed_unit(random) * (i / in % 10 == 9 ? 30.0f : 2.0f);
    obs[i] = shift ? shift->values[i % in] + x / scale->values[i % in] : x;
  }
  policy.act(obs.data(), flags.probes, nullptr, action.data());
  return {{"rows", flags.probes},
          {"obs_dim", network.obs_dim},
          {"action_dim", network.action_dim},
          {"obs", obs},
          {"action", action}};
}

Report run_export(const ExportFlags& flags) {
  if (flags.onnx.empty() && flags.safetensors.empty() && flags.probe.empty())
    throw Usage("export: nothing to write; give --onnx FILE, --safetensors FILE or --probe FILE");
  const ActorChoice choice = choose_actor(flags.policy);
  if (choice.file.empty()) throw Usage("--policy " + flags.policy + ": a baseline is no network");
  const redman::Policy policy(choice.file.c_str());
  const Network network(policy);
  Json json = {{"policy", choice.file}};
  std::string text;
  const auto write = [&](const char* kind, const std::string& file, const std::string& bytes) {
    replace_file(file, bytes);
    json[kind] = file;
    json[std::string(kind) + "_bytes"] = bytes.size();
    text += format("wrote %s, %zu bytes\n", file.c_str(), bytes.size());
  };
  if (!flags.onnx.empty()) write("onnx", flags.onnx, onnx_bytes(network));
  if (!flags.safetensors.empty()) write("safetensors", flags.safetensors, safetensors_bytes(network));
  if (!flags.probe.empty()) write("probe", flags.probe, probe_json(policy, network, flags).dump());
  return {json, text};
}

}  // namespace

void add_export(CLI::App& app, Run& run) {
  auto flags = std::make_shared<ExportFlags>();
  CLI::App* command = app.add_subcommand("export", "Write a policy as ONNX or safetensors");
  command->add_option("--policy", flags->policy, "policy file or run folder")->required();
  command->add_option("--onnx", flags->onnx, "ONNX file to write: normaliser, network and clip in one graph");
  command->add_option("--safetensors", flags->safetensors, "safetensors file to write");
  command->add_option(
      "--probe", flags->probe,
      "JSON file to write: random observations and this policy's mean actions, to check others by");
  command->add_option("--probes", flags->probes, "rows of --probe")->check(CLI::Range(1, 100000));
  command->add_option("--seed", flags->seed, "of --probe");
  command->callback([&run, flags] { run = [flags] { return run_export(*flags); }; });
}

}  // namespace tool
