// `export`: a policy as a file for other programs.
#include "commands.hpp"
#include "common/files.hpp"
#include "common/text.hpp"
#include "network/c_source.hpp"
#include "network/probe.hpp"
#include "play/actor.hpp"

namespace tool {
namespace {

struct ExportFlags {
  std::string policy, onnx, safetensors, c, name, probe;
  bool int8 = false, name_given = false;
  int32_t probes = 1000;
  uint64_t seed = 0;
};

// Random observations and what the policy does.
Json probe_json(const redman::Policy& policy, const Network& network, const ExportFlags& flags) {
  const auto obs = probe_observations(network, static_cast<size_t>(flags.probes), flags.seed);
  return {{"rows", flags.probes},
          {"obs_dim", network.obs_dim},
          {"action_dim", network.action_dim},
          {"obs", obs},
          {"action", mean_actions(policy, obs)}};
}

// What the observation is made of, as the policy's task has it with the options of its run; empty when that
// is not the layout that the policy knows.
std::vector<ObsField> fields_of(const redman::Policy& policy, const ActorChoice& choice) {
  std::vector<ObsField> fields;
  try {
    PoolSettings settings;
    settings.task = policy.info().task;
    settings.options = choice.options;
    const redman::Pool pool = make_pool(settings, RDM_AUTORESET_OFF);
    if (pool.spec().layout_hash != policy.info().layout_hash) return {};
    for (int32_t i = 0; i < pool.spec().num_fields; ++i) {
      rdm_field f;
      redman::check(rdm_pool_field(pool.get(), i, &f));
      fields.push_back({f.name, f.unit, f.offset, f.count});
    }
  } catch (const Usage&) {  // a host's own environment, or a task that is not here
    return {};
  }
  return fields;
}

Report run_export(const ExportFlags& flags) {
  if (flags.onnx.empty() && flags.safetensors.empty() && flags.c.empty() && flags.probe.empty())
    throw Usage("export: nothing to write; give --c FILE, --onnx FILE, --safetensors FILE or --probe FILE");
  if (flags.name_given) check_c_name(flags.name);
  const ActorChoice choice = choose_actor(flags.policy);
  if (choice.file.empty() || choice.recording)
    throw Usage("--policy " + flags.policy +
                ": it is no network; give a policy file, a run folder or trained:TASK");
  const redman::Policy policy(choice.file.c_str());
  if (policy.info().num_points > 0 && !(flags.onnx.empty() && flags.c.empty() && flags.probe.empty()))
    throw Failure("export: " + choice.file +
                  " sees points; such policies are written by --safetensors alone");
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
  if (!flags.c.empty()) {
    const std::string name = flags.name_given ? flags.name : c_name_of(policy.info().task);
    const CSource source = c_source(policy, network, name, fields_of(policy, choice), flags.int8);
    write("c", flags.c, source.text);
    json["file"] = flags.c;
    json["bytes"] = source.text.size();
    json["name"] = name;
    if (flags.int8) {
      json["largest_error"] = source.largest_error;
      json["rms_error"] = source.rms_error;
      text += format("8-bit weights: actions differ by %.2g at most, %.2g in root mean square\n",
                     source.largest_error, source.rms_error);
    }
  }
  if (!flags.probe.empty()) write("probe", flags.probe, probe_json(policy, network, flags).dump());
  return {json, text};
}

}  // namespace

void add_export(CLI::App& app, Run& run) {
  auto flags = std::make_shared<ExportFlags>();
  CLI::App* command = app.add_subcommand("export", "Write a policy as C source, ONNX or safetensors");
  command->add_option("--policy", flags->policy, "policy file, run folder, or trained:TASK")->required();
  CLI::Option* c = command->add_option("--c", flags->c,
                                       "C99 file to write: one function that needs no heap and no library");
  CLI::Option* name =
      command->add_option("--name", flags->name, "begins the names in the C file; default: the task")
          ->needs(c);
  command->add_flag("--int8", flags->int8, "weights of the C file in 8 bits")->needs(c);
  command->add_option("--onnx", flags->onnx, "ONNX file to write: normaliser, network and clip in one graph");
  command->add_option("--safetensors", flags->safetensors, "safetensors file to write");
  command->add_option(
      "--probe", flags->probe,
      "JSON file to write: random observations and this policy's mean actions, to check others by");
  command->add_option("--probes", flags->probes, "rows of --probe")->check(CLI::Range(1, 100000));
  command->add_option("--seed", flags->seed, "of --probe");
  command->callback([&run, flags, name] {
    flags->name_given = name->count() > 0;
    run = [flags] { return run_export(*flags); };
  });
}

}  // namespace tool
