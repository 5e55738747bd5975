// `tasks`, `algos` and `info`: what there is, straight from the library's discovery.
#include <algorithm>
#include <cmath>
#include <redman/redman.hpp>

#include "commands.hpp"
#include "common/manual.hpp"
#include "common/names.hpp"
#include "common/presets.hpp"
#include "common/text.hpp"
#include "play/plan_word.hpp"
#include "play/shield_word.hpp"

namespace tool {
namespace {

struct ListFlags {
  std::string name;
  bool markdown = false, presets = false;
};

std::string limit_text(const std::vector<rdm_cost_info>& costs) {
  return costs.empty() || costs[0].limit < 0 ? "-" : number_text(costs[0].limit);
}

Json task_json(int32_t index, const Presets& all_presets) {
  const rdm_task t = task_at(index);
  const std::vector<rdm_field_info> parts = task_fields(index);
  Json costs = Json::array(), fields = Json::array();
  for (const rdm_cost_info& c : task_costs(index))
    costs.push_back(
        object_of({{"name", c.name}, {"limit", c.limit < 0 ? Json() : Json(c.limit)}, {"help", c.help}}));
  const auto number = [](float x) { return std::isnan(x) ? Json() : Json(x); };
  for (const rdm_field_info& f : parts)
    fields.push_back(object_of({{"name", f.name},
                                {"unit", f.unit},
                                {"offset", f.offset},
                                {"count", f.count},
                                {"low", number(f.low)},
                                {"high", number(f.high)}}));
  Json defaults = Json::object(), presets = Json::object();
  const std::vector<rdm_option> own = task_defaults(index);
  defaults.get_ref<Json::object_t&>().reserve(own.size());
  for (const rdm_option& o : own) defaults[o.key] = o.text;
  for (const ObsPreset& p : all_presets.of(t.obs_dim, parts)) {
    Json names = Json::array();
    for (const rdm_field_info& f : parts)
      if (has_columns(p, f)) names.push_back(f.name);
    presets[p.name] = object_of({{"entries", p.columns.size()}, {"fields", std::move(names)}});
  }
  return object_of({{"name", t.name},
                    {"summary", t.summary},
                    {"obs_dim", t.obs_dim},
                    {"action_dim", t.action_dim},
                    {"action_order", t.action_order},
                    {"cost_dim", t.cost_dim},
                    {"costs", std::move(costs)},
                    {"max_steps", t.max_steps},
                    {"control_dt", t.control_dt},
                    {"fields", std::move(fields)},
                    {"options", options_json(task_options(index))},
                    {"defaults", std::move(defaults)},
                    {"initial_mean", task_initial_mean(index)},
                    {"presets", std::move(presets)}});
}

std::string task_text(int32_t index) {
  const rdm_task t = task_at(index);
  std::string out = format("%s: %s\n%d observations, %d actions, %d cost%s, %d steps of %.4f s\n\n", t.name,
                           t.summary, t.obs_dim, t.action_dim, t.cost_dim, t.cost_dim == 1 ? "" : "s",
                           t.max_steps, static_cast<double>(t.control_dt));
  Table fields({"field", "unit of 1", "first entry", "count", "in the presets"}),
      costs({"cost column", "limit on its sum", "value in a control step"});
  const std::vector<rdm_field_info> parts = task_fields(index);
  const auto presets = obs_presets(t.obs_dim, parts);
  for (const rdm_field_info& f : parts) {
    std::string in;
    for (const ObsPreset& p : presets)
      if (has_columns(p, f)) in += (in.empty() ? "" : " ") + p.name;
    fields.add({f.name, f.unit, std::to_string(f.offset), std::to_string(f.count), in});
  }
  for (const rdm_cost_info& c : task_costs(index))
    costs.add({c.name, c.limit < 0 ? "-" : number_text(c.limit), c.help});
  return out + fields.text() + '\n' + costs.text() + '\n' + options_text(task_options(index));
}

// Of the task, or of all.
Presets presets_of(int32_t only) {
  std::vector<rdm_field_info> fields;
  for (int32_t i = 0; i < rdm_task_count(); ++i) {
    if (only >= 0 && i != only) continue;
    const std::vector<rdm_field_info> more = task_fields(i);
    fields.insert(fields.end(), more.begin(), more.end());
  }
  return Presets(fields);
}

// How many entries each preset of actor_obs leaves; "-": there are no such fields.
std::string presets_text(int32_t only, bool markdown, const Presets& presets) {
  const std::vector<std::string> names = {"state", "vision", "touch", "proprioception"};
  Table table({"task", names[0], names[1], names[2], names[3]});
  for (int32_t i = 0; i < rdm_task_count(); ++i) {
    if (only >= 0 && i != only) continue;
    const rdm_task t = task_at(i);
    std::vector<std::string> row = {markdown ? format("`%s`", t.name) : t.name};
    row.resize(1 + names.size(), "-");
    for (const ObsPreset& p : presets.of(t.obs_dim, task_fields(i)))
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
  const int32_t only = flags.name.empty() ? -1 : find_task(flags.name);
  const Presets presets = presets_of(only);
  for (int32_t i = 0; i < rdm_task_count(); ++i) {
    if (only >= 0 && i != only) continue;
    const rdm_task t = task_at(i);
    all.push_back(task_json(i, presets));
    const std::string name = flags.markdown ? format("`%s`", t.name) : t.name;
    table.add({name, std::to_string(t.obs_dim), std::to_string(t.action_dim), std::to_string(t.cost_dim),
               std::to_string(t.max_steps), limit_text(task_costs(i)), t.summary});
  }
  const bool page = flags.markdown && only >= 0;
  const std::string text = flags.presets    ? presets_text(only, flags.markdown, presets)
                           : page           ? task_page(only)
                           : flags.markdown ? table.markdown()
                           : only >= 0      ? task_text(only)
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

void add_list(CLI::App& app, Run& run, const char* name, const char* help, Report (*list)(const ListFlags&)) {
  auto flags = std::make_shared<ListFlags>();
  CLI::App* command = app.add_subcommand(name, help);
  if (list == list_tasks)
    command->add_flag("--presets", flags->presets,
                      "print how many entries of each task's observation every preset of actor_obs keeps");
  command->add_option("name", flags->name, "show this one with its options");
  command->add_flag("--markdown", flags->markdown,
                    "print the table of the manual's pages; with a name, the generated part of its page");
  command->callback([&run, flags, list] { run = [flags, list] { return list(*flags); }; });
}

}  // namespace

void add_tasks(CLI::App& app, Run& run) {
  add_list(app, run, "tasks", "List the tasks: observations, costs, options", list_tasks);
}

void add_algos(CLI::App& app, Run& run) {
  add_list(app, run, "algos", "List the algorithms and their options", list_algos);
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
