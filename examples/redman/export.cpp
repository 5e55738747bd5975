// `export`: a policy as a file for other programs.
#include <redman/sense.hpp>
#include <redman/shield.hpp>
#include <redman/team.hpp>

#include "commands.hpp"
#include "common/files.hpp"
#include "common/names.hpp"
#include "common/numbers.hpp"
#include "common/presets.hpp"
#include "common/text.hpp"
#include "network/c_source.hpp"
#include "network/probe.hpp"
#include "play/actor.hpp"
#include "play/shield_word.hpp"

namespace tool {
namespace {

struct ExportFlags {
  std::string policy, group, file, onnx, safetensors, c, name, probe, shield = "off";
  bool int8 = false, name_given = false;
  int32_t probes = 1000;
  uint64_t seed = 0;
};

// A world of the policy's task with the options of its run; none where that has another layout than the
// policy knows, or is not here (a host's own environment).
std::optional<redman::Pool> world_of(const redman::Policy& policy, const ActorChoice& choice, uint64_t seed) {
  try {
    PoolSettings settings;
    settings.seed = seed;
    adopt_task(choice, false, {}, settings);
    redman::Pool pool = make_pool(settings, RDM_AUTORESET_OFF);
    if (pool.spec().layout_hash == policy.info().layout_hash && *policy.info().task) return pool;
  } catch (const Usage&) {
  }
  return {};
}

// Every second row becomes what the policy meets where it plays.
void play_rows(redman::Pool pool, const ActorChoice& choice, std::vector<float>& obs, Clouds& clouds) {
  Actor actor(choice, pool);
  const auto count = static_cast<size_t>(choice.points), width = pool.obs().width();
  pool.reset();
  for (size_t row = 0; row < obs.size() / width; row += 2) {
    const rdm_sensors seen = redman::sensors(pool);
    std::copy_n(pool.obs()[0].begin(), width, obs.begin() + static_cast<std::ptrdiff_t>(row * width));
    std::copy_n(seen.points, 3 * count, clouds.points.begin() + static_cast<std::ptrdiff_t>(3 * row * count));
    if (!clouds.classes.empty())
      std::copy_n(seen.point_class, count, clouds.classes.begin() + static_cast<std::ptrdiff_t>(row * count));
    if (seen.point_color)
      std::copy_n(seen.point_color, 3 * count,
                  clouds.colors.begin() + static_cast<std::ptrdiff_t>(3 * row * count));
    actor.act(pool);
    pool.step();
    if (!pool.terminated()[0] && !pool.truncated()[0]) continue;
    pool.reset();
    actor.restart();
  }
}

// Random observations and what the policy does, of one with a memory in one episode (kProbeEpisode); of one with eyes, beside random clouds and played ones.
Json probe_json(const redman::Policy& policy, const Network& network, const ActorChoice& choice,
                const ActionBounds& bounds, const ExportFlags& flags) {
  const auto rows = static_cast<size_t>(flags.probes);
  auto obs = probe_observations(network, rows, flags.seed);
  Clouds clouds = probe_clouds(network, rows, flags.seed);
  const Eyes& eyes = network.eyes;
  bool played = false;
  if (eyes.points)
    if (auto pool = world_of(policy, choice, flags.seed))
      play_rows(std::move(*pool), choice, obs, clouds), played = true;
  Json json = {{"rows", flags.probes}, {"obs_dim", network.obs_dim}, {"action_dim", network.action_dim}};
  std::vector<float> actions = mean_actions(policy, obs, clouds);
  hold_to(bounds, actions);
  json["action"] = std::move(actions);
  json["obs"] = std::move(obs);
  if (network.memory.size) json["state_dim"] = network.memory.size, json["episode"] = kProbeEpisode;
  if (eyes.points == 0) return json;
  json["num_points"] = eyes.points;
  json["played"] = played;
  json["points"] = std::move(clouds.points);
  if (eyes.classes) json["point_class"] = std::move(clouds.classes);
  if (eyes.color) json["point_color"] = std::move(clouds.colors);
  return json;
}

std::vector<ObsField> seen_fields(const std::vector<rdm_field_info>& fields,
                                  const std::vector<int32_t>& columns) {
  std::vector<ObsField> out;
  for (const rdm_field_info& f : fields)
    out.push_back({f.name, f.unit, f.offset, f.count, has_columns({"", columns}, f)});
  return out;
}

// The preset that leaves just these columns; "" for none.
std::string preset_of(int32_t obs_dim, const std::vector<rdm_field_info>& fields,
                      const std::vector<int32_t>& columns) {
  if (fields.empty()) return "";
  for (const ObsPreset& p : obs_presets(obs_dim, fields))
    if (p.columns == columns) return p.name;
  return "";
}

// What the guards of the first cost leave of [-1, 1].
ActionBounds bounds_of(const std::optional<redman::Pool>& pool) {
  std::vector<float> normals, bounds;
  const std::vector<redman::Guard> guards = pool ? redman::guards(*pool) : std::vector<redman::Guard>();
  for (const redman::Guard& g : guards) {
    if (g.info.column != 0) continue;
    if (g.info.entry < 0)
      throw Usage(
          "--shield project: a guard of the task is about several entries of the action, but a C file can "
          "only bound single ones; project its actions with rdm_project");
    normals.insert(normals.end(), g.normal.begin(), g.normal.end());
    bounds.push_back(g.info.bound);
  }
  if (bounds.empty())
    throw Usage(
        "--shield project: the policy's task declares no guards with the options of its run; the throwing "
        "tasks do with cost_mode=command");
  const std::vector<float> ends[] = {std::vector<float>(guards[0].normal.size(), -1.0f),
                                     std::vector<float>(guards[0].normal.size(), 1.0f)};
  return {redman::project(normals, bounds, ends[0].data(), ends[0].size()),
          redman::project(normals, bounds, ends[1].data(), ends[1].size())};
}

// The bytes of one group's policy; Usage with the names of those that there are.
redman::Bytes group_of(const redman::Policy& team, const std::string& name) {
  const std::vector<std::string> names = redman::groups(team);
  std::string all;
  for (size_t i = 0; i < names.size(); ++i) {
    if (names[i] == name) return redman::group_bytes(team, static_cast<int32_t>(i));
    all += (i ? ", " : "") + names[i];
  }
  throw Usage(
      "--group " + name + ": " +
      (names.empty() ? "the policy is one network and has no groups" : "the policy's groups are " + all));
}

Report run_export(const ExportFlags& flags) {
  if (flags.onnx.empty() && flags.safetensors.empty() && flags.c.empty() && flags.probe.empty() &&
      flags.file.empty())
    throw Usage(
        "export: there is nothing to write; give --c FILE, --onnx FILE, --safetensors FILE, --rdm FILE or "
        "--probe "
        "FILE");
  if (flags.name_given) check_c_name(flags.name);
  const ShieldWord shield = read_shield_word(flags.shield);
  if (shield.on && (shield.predicts || flags.shield.find(':') != std::string::npos))
    throw Usage("--shield " + flags.shield +
                ": a C file can only project; give --shield project without options");
  const ActorChoice choice = choose_actor(flags.policy);
  if (choice.file.empty() || choice.recording)
    throw Usage(
        "--policy " + flags.policy +
        ": it is not a network; give a policy file, a run folder or trained:TASK. To export what else "
        "plays, record it (redman rollout --record FILE.npz) and learn from that (redman train --from "
        "FILE.npz)");
  check_outputs({{"--rdm", flags.file, ".rdm"},
                 {"--onnx", flags.onnx, ".onnx"},
                 {"--safetensors", flags.safetensors, ".safetensors"},
                 {"--c", flags.c, ".c .h .inc"},
                 {"--probe", flags.probe, ".json"}},
                {{"--policy", choice.file}});
  redman::Policy policy(choice.file.c_str());
  redman::Bytes own;
  if (!flags.group.empty()) {
    if (shield.on) throw Usage("--group: a group's file has no guards, which are of the whole action");
    own = group_of(policy, flags.group);
    policy = redman::Policy(own);
  }
  Network network(policy);
  const auto world = world_of(policy, choice, 0);  // lends the names of its fields
  const auto fields = world ? fields_of(*world) : std::vector<rdm_field_info>();
  const std::vector<int32_t> columns = policy_columns(policy.get());
  const ActionBounds bounds = shield.on ? bounds_of(world) : ActionBounds();
  if (const std::string preset = preset_of(network.obs_dim, fields, columns); !preset.empty())
    network.metadata.push_back({"observation_preset", preset});
  Json json = {{"policy", choice.file}};
  std::string text;
  const auto write = [&](const char* kind, const std::string& file, const std::string& bytes) {
    replace_file(file, bytes);
    json[kind] = file;
    json[std::string(kind) + "_bytes"] = bytes.size();
    text += format("wrote %s, %zu bytes\n", file.c_str(), bytes.size());
  };
  if (!flags.file.empty())
    write("rdm", flags.file, own.empty() ? read_file(choice.file) : std::string(own.begin(), own.end()));
  if (!flags.onnx.empty()) write("onnx", flags.onnx, onnx_bytes(network));
  if (!flags.safetensors.empty()) write("safetensors", flags.safetensors, safetensors_bytes(network));
  if (!flags.c.empty()) {
    const std::string name = flags.name_given ? flags.name : c_name_of(policy.info().task);
    const CSource source = c_source(policy, network, name, seen_fields(fields, columns), bounds, flags.int8);
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
  if (!flags.probe.empty())
    write("probe", flags.probe, probe_json(policy, network, choice, bounds, flags).dump());
  return {json, text};
}

}  // namespace

void add_export(CLI::App& app, Run& run) {
  auto flags = std::make_shared<ExportFlags>();
  CLI::App* command = app.add_subcommand("export", "Write a policy as C source, ONNX or safetensors");
  command
      ->add_option("--policy", flags->policy,
                   "policy file, run folder, or trained:TASK: networks of all algorithms, with a memory, a "
                   "latent, point clouds or groups too; not demonstrations, planners and baselines")
      ->required();
  command
      ->add_option("--group", flags->group,
                   "group of a team's policy, such as left: its network alone, with its own actions")
      ->type_name("NAME");
  command->add_option("--rdm", flags->file, "policy file to write, of the group alone with --group");
  CLI::Option* c =
      command->add_option("--c", flags->c, "C99 file to write: one function without heap and library calls");
  CLI::Option* name =
      command
          ->add_option("--name", flags->name, "prefix of the names in the C file; default: the task's name")
          ->needs(c);
  command->add_flag("--int8", flags->int8, "store the weights of the C file in 8 bits")->needs(c);
  CLI::Option* onnx = command->add_option(
      "--onnx", flags->onnx, "ONNX file to write: normalisation, network and clipping in one graph");
  CLI::Option* safetensors =
      command->add_option("--safetensors", flags->safetensors, "safetensors file to write");
  command
      ->add_option(
          "--shield", flags->shield,
          "project: the C file, and the actions of --probe, keep the guards of the policy's task; off")
      ->type_name("WORD")
      ->needs(c)
      ->excludes(onnx)
      ->excludes(safetensors);
  CLI::Option* probe =
      command->add_option("--probe", flags->probe,
                          "JSON file to write: random observations with the policy's mean actions, to check "
                          "other implementations");
  command->add_option("--probes", flags->probes, "number of observations in --probe")
      ->check(between(1, 100000))
      ->needs(probe);
  command->add_option("--seed", flags->seed, "seed of the observations of --probe")->needs(probe);
  command->callback([&run, flags, name] {
    flags->name_given = name->count() > 0;
    run = [flags] { return run_export(*flags); };
  });
}

}  // namespace tool
