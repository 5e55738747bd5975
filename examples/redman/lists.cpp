// `tasks`, `algos` and `info`: what there is, straight from the library's discovery.
#include <algorithm>
#include <cmath>
#include <redman/redman.hpp>

#include "commands.hpp"
#include "common/manual.hpp"
#include "common/names.hpp"
#include "common/presets.hpp"
#include "common/setup.hpp"
#include "common/text.hpp"
#include "play/plan_word.hpp"
#include "play/shield_word.hpp"

namespace tool {
namespace {

struct ListFlags {
  std::string name;
  std::vector<std::string> sets;
  bool markdown = false, presets = false;
};

// One world of a task, whose rows are what is listed: with default options, or those of --set.
struct World {
  rdm_task task;
  PoolSettings settings;
  redman::Pool pool;
  rdm_spec spec;
  std::vector<rdm_field_info> fields;
  bool own() const { return !settings.options.empty(); }
};

World world_with(int32_t index, const std::vector<std::string>& sets) {
  const rdm_task task = task_at(index);
  PoolSettings settings;
  settings.task = task.name;
  apply_sets(sets, settings, nullptr);
  redman::Pool pool = make_pool(settings, RDM_AUTORESET_OFF);
  const rdm_spec spec = pool.spec();
  auto fields = fields_of(pool);
  return {task, std::move(settings), std::move(pool), spec, std::move(fields)};
}

std::string limit_text(const std::vector<rdm_cost_info>& costs) {
  return costs.empty() || costs[0].limit < 0 ? "-" : number_text(costs[0].limit);
}

Json task_json(const World& w, const Presets& all_presets) {
  const rdm_task& t = w.task;
  const int32_t index = w.spec.task;
  Json costs = Json::array(), fields = Json::array(), joints = Json::array();
  for (const rdm_cost_info& c : task_costs(index))
    costs.push_back(
        object_of({{"name", c.name}, {"limit", c.limit < 0 ? Json() : Json(c.limit)}, {"help", c.help}}));
  const auto number = [](float x) { return std::isnan(x) ? Json() : Json(x); };
  for (const rdm_field_info& f : w.fields)
    fields.push_back(object_of({{"name", f.name},
                                {"unit", f.unit},
                                {"offset", f.offset},
                                {"count", f.count},
                                {"low", number(f.low)},
                                {"high", number(f.high)}}));
  for (const auto& [entry, j] : motors_of(w.pool))
    joints.push_back(
        object_of({{"action", entry}, {"name", j.name}, {"lower", j.lower}, {"upper", j.upper}}));
  Json defaults = Json::object(), presets = Json::object();
  const std::vector<rdm_option> own = task_defaults(index);
  defaults.get_ref<Json::object_t&>().reserve(own.size());
  for (const rdm_option& o : own) defaults[o.key] = o.text;
  for (const ObsPreset& p : all_presets.of(w.spec.obs_dim, w.fields)) {
    Json names = Json::array();
    for (const rdm_field_info& f : w.fields)
      if (has_columns(p, f)) names.push_back(f.name);
    presets[p.name] = object_of({{"entries", p.columns.size()}, {"fields", std::move(names)}});
  }
  return object_of(
      {{"name", t.name},
       {"summary", t.summary},
       {"obs_dim", w.spec.obs_dim},
       {"action_dim", w.spec.action_dim},
       {"action_order", w.own() ? Json() : Json(t.action_order)},  // known of default options alone
       {"joints", std::move(joints)},
       {"cost_dim", t.cost_dim},
       {"costs", std::move(costs)},
       {"max_steps", w.spec.max_steps},
       {"control_dt", w.spec.control_dt},
       {"fields", std::move(fields)},
       {"options", options_json(task_options(index))},
       {"defaults", std::move(defaults)},
       {"initial_mean", w.pool.initial_mean()},
       {"presets", std::move(presets)}});
}

// Of a world with options of its own without the table of options, which has the defaults.
std::string task_text(const World& w) {
  const rdm_task& t = w.task;
  const int32_t index = w.spec.task;
  std::string out = format(
      "%s: %s\n%d observations, %d actions%s, %d cost%s, %d steps of %.4f s\n\n", t.name, t.summary,
      w.spec.obs_dim, w.spec.action_dim, w.own() ? "" : format(" (%s)", t.action_order).c_str(), t.cost_dim,
      t.cost_dim == 1 ? "" : "s", w.spec.max_steps, static_cast<double>(w.spec.control_dt));
  Table fields({"field", "unit of 1", "first entry", "count", "in the presets"}),
      joints({"action entry", "joint", "range, rad or m"}),
      costs({"cost column", "limit on its sum", "value in a control step"});
  const auto presets = obs_presets(w.spec.obs_dim, w.fields);
  for (const rdm_field_info& f : w.fields) {
    std::string in;
    for (const ObsPreset& p : presets)
      if (has_columns(p, f)) in += (in.empty() ? "" : " ") + p.name;
    fields.add({f.name, f.unit, std::to_string(f.offset), std::to_string(f.count), in});
  }
  for (const rdm_cost_info& c : task_costs(index))
    costs.add({c.name, c.limit < 0 ? "-" : number_text(c.limit), c.help});
  const Motors motors = motors_of(w.pool);
  for (const auto& [entry, j] : motors)
    joints.add({std::to_string(entry), j.name, format("%.4g .. %.4g", j.lower, j.upper)});
  return out + fields.text() + '\n' + (motors.empty() ? "" : joints.text() + '\n') + costs.text() +
         (w.own() ? "" : '\n' + options_text(task_options(index)));
}

Presets presets_of(const std::vector<World>& worlds) {
  std::vector<rdm_field_info> fields;
  for (const World& w : worlds) fields.insert(fields.end(), w.fields.begin(), w.fields.end());
  return Presets(fields);
}

// How many entries each preset of actor_obs leaves; "-": there are no such fields.
std::string presets_text(const std::vector<World>& worlds, bool markdown, const Presets& presets) {
  const std::vector<std::string> names = {"state", "vision", "touch", "proprioception"};
  Table table({"task", names[0], names[1], names[2], names[3]});
  for (const World& w : worlds) {
    std::vector<std::string> row = {markdown ? format("`%s`", w.task.name) : w.task.name};
    row.resize(1 + names.size(), "-");
    for (const ObsPreset& p : presets.of(w.spec.obs_dim, w.fields))
      row[1 + static_cast<size_t>(std::find(names.begin(), names.end(), p.name) - names.begin())] =
          std::to_string(p.columns.size());
    table.add(row);
  }
  return markdown ? table.markdown() : table.text();
}

Report list_tasks(const ListFlags& flags) {
  Json all = Json::array();
  Table table(
      {"task", "obs entries", "action entries", "cost columns", "max steps", "cost limit", "summary"});
  if (flags.name.empty() && !flags.sets.empty()) throw Usage("--set: name the task whose option it is");
  std::vector<World> worlds;
  const int32_t only = flags.name.empty() ? -1 : find_task(flags.name);
  for (int32_t i = 0; i < rdm_task_count(); ++i)
    if (only < 0 || i == only) worlds.push_back(world_with(i, flags.sets));
  if (only >= 0) say_idle(flags.sets, worlds[0].settings);
  const Presets presets = presets_of(worlds);
  for (const World& w : worlds) {
    all.push_back(task_json(w, presets));
    const std::string name = flags.markdown ? format("`%s`", w.task.name) : w.task.name;
    table.add({name, std::to_string(w.spec.obs_dim), std::to_string(w.spec.action_dim),
               std::to_string(w.spec.cost_dim), std::to_string(w.spec.max_steps),
               limit_text(task_costs(w.spec.task)), w.task.summary});
  }
  const bool page = flags.markdown && only >= 0;
  const std::string text = flags.presets    ? presets_text(worlds, flags.markdown, presets)
                           : page           ? task_page(only)
                           : flags.markdown ? table.markdown()
                           : only >= 0      ? task_text(worlds[0])
                                            : table.text();
  return {object_of({{"tasks", std::move(all)}}), text};
}

Report list_algos(const ListFlags& flags) {
  Json all = Json::array();
  Table table({"algorithm", "summary"});
  const int32_t only = flags.name.empty() ? -1 : find_algo(flags.name);
  std::string text;
  for (int32_t i = 0; i < rdm_algo_count(); ++i) {
    if (only >= 0 && i != only) continue;
    const rdm_algo a = algo_at(i);
    const auto options = algo_options(i);
    all.push_back(object_of({{"name", a.name}, {"summary", a.summary}, {"params", options_json(options)}}));
    table.add({flags.markdown ? format("`%s`", a.name) : a.name, a.summary});
    if (only >= 0) text = format("%s: %s\n\n", a.name, a.summary) + options_text(options);
  }
  if (flags.markdown) text = only >= 0 ? algo_page(only) : table.markdown();
  return {object_of({{"algos", std::move(all)}}), text.empty() ? table.text() : text};
}

// Options that go with a flag in one word, as `--policy plan:...` and `--shield predict:...`.
Report show_options(const std::string& whose) {
  const auto table = whose == "planner" ? planner_options() : shield_options();
  return {{{"options", options_json(table)}}, options_text(table)};
}

Report show_info() {
  Json json = build_json();
  json["simulator"] = (rdm_features() & RDM_FEATURE_SIM) != 0;
  json["learner"] = (rdm_features() & RDM_FEATURE_LEARN) != 0;
  std::string text;
  for (const auto& [key, value] : json.items())
    text +=
        format("%-10s ", key.c_str()) + (value.is_string() ? value.get<std::string>() : value.dump()) + '\n';
  return {std::move(json), text};
}

CLI::Option* add_markdown_flag(CLI::App& command, ListFlags& flags) {
  return command.add_flag(
      "--markdown", flags.markdown,
      "print the table of the manual's pages; with a name, the generated part of its page");
}

}  // namespace

void add_tasks(CLI::App& app, Run& run) {
  auto flags = std::make_shared<ListFlags>();
  CLI::App* command = app.add_subcommand("tasks", "List the tasks: observations, actions, costs, options");
  command->add_flag("--presets", flags->presets,
                    "print how many entries of each task's observation every preset of actor_obs keeps");
  add_task_flag(*command, flags->name, "name",
                "show this one, by name or by its file (.task), with its options; with --set, the "
                "observations and actions that it then has");
  CLI::Option* markdown = add_markdown_flag(*command, *flags);
  add_set_flag(*command, flags->sets)->excludes(markdown);
  command->callback([&run, flags] { run = [flags] { return list_tasks(*flags); }; });
}

void add_algos(CLI::App& app, Run& run) {
  auto flags = std::make_shared<ListFlags>();
  CLI::App* command = app.add_subcommand("algos", "List the algorithms and their options");
  command->add_option("name", flags->name, "show this one with its options");
  add_markdown_flag(*command, *flags);
  command->callback([&run, flags] { run = [flags] { return list_algos(*flags); }; });
}

void add_info(CLI::App& app, Run& run) {
  auto whose = std::make_shared<std::string>();
  CLI::App* command = app.add_subcommand("info", "Print versions and how the library was built");
  command->add_option("options", *whose, "list the options of the planner or the shield instead")
      ->check(one_of({"planner", "shield"}));
  command->callback(
      [&run, whose] { run = [whose] { return whose->empty() ? show_info() : show_options(*whose); }; });
}

}  // namespace tool
