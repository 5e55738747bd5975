#include "common/manual.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <redman/redman.hpp>

#include "common/names.hpp"
#include "common/presets.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

// Where a table of fields is too long to be read, and its fingers become one row.
constexpr size_t kLongTable = 24;

std::string marked(const char* name, const std::string& text) {
  return format("<!-- %s -->\n", name) + text + format("<!-- end of %s -->\n", name);
}

std::string folded_away(const std::string& title, const std::string& text) {
  return "<details><summary>" + title + "</summary>\n\n" + text + "\n</details>\n";
}

std::string code(const std::string& text) {
  return text.empty() ? "" : '`' + text + '`';
}

// Text of the library in a cell.
std::string table_cell(const std::string& text) {
  std::string out;
  for (const char c : text)
    if (c == '<')
      out += "&lt;";
    else if (c == '*' || c == '|')
      out += std::string("\\") + c;
    else
      out += c;
  return out;
}

std::string entries_text(int32_t first, int32_t count) {
  return count == 1 ? std::to_string(first) : format("%d to %d", first, first + count - 1);
}

std::string range_text(double low, double high) {
  return std::isnan(low) || std::isnan(high) ? "-" : number_text(low) + " to " + number_text(high);
}

// Of the task's defaults of algorithms those that count: a later one replaces an earlier one.
std::vector<rdm_option> last_defaults(int32_t index) {
  std::vector<rdm_option> out;
  for (const rdm_option& o : task_defaults(index)) {
    const auto same = std::find_if(out.begin(), out.end(),
                                   [&](const rdm_option& p) { return std::string(p.key) == o.key; });
    if (same == out.end())
      out.push_back(o);
    else
      *same = o;
  }
  return out;
}

// ---- facts ----

std::string facts_of(int32_t index) {
  const rdm_task t = task_at(index);
  const double dt = static_cast<double>(t.control_dt);
  Table table({"property", "value"});
  table.add({"control step", format("%.4g s (%.4g Hz)", dt, 1 / dt)});
  table.add({"episode", t.max_steps == 1
                            ? "1 control step"
                            : format("at most %d control steps, %.4g s", t.max_steps, dt * t.max_steps)});
  for (const rdm_option& o : last_defaults(index))
    if (std::string(o.key) == "action_repeat")
      table.add(
          {"decision", format("a new policy decides every %s control steps (`action_repeat`)", o.text)});
  table.add({"action", format("%d number%s in [-1, 1]", t.action_dim, t.action_dim == 1 ? "" : "s")});
  std::string seen;
  for (const ObsPreset& p : obs_presets(t.obs_dim, task_fields(index)))
    if (p.name != "state") seen += format("; `%s`: %zu", p.name.c_str(), p.columns.size());
  table.add({"observation", format("%d number%s", t.obs_dim, t.obs_dim == 1 ? "" : "s") + seen});
  std::string limits;
  for (const rdm_cost_info& c : task_costs(index))
    if (c.limit >= 0)
      limits +=
          format("; `%s` has the limit %s on its sum over an episode", c.name, number_text(c.limit).c_str());
  table.add({"costs", format("%d column%s", t.cost_dim, t.cost_dim == 1 ? "" : "s") + limits});
  std::string cameras;
  for (int32_t i = 0; i < t.num_cameras; ++i) {
    auto camera = redman::sized<rdm_camera_info>();
    redman::check(rdm_task_camera_at(index, i, &camera));
    cameras += (i ? ", `" : "`") + std::string(camera.name) + '`';
  }
  table.add({"cameras", cameras});
  return table.markdown();
}

// ---- actions ----

// "right_FFJ2" -> "FFJ2": one row stands for both hands.
std::string bare_joint(const std::string& name) {
  for (const char* side : {"right_", "left_"})
    if (name.rfind(side, 0) == 0) return name.substr(std::string(side).size());
  return name;
}

// Each word of the order is one entry; or a group, where "joints" are all that have a motor and what lies
// between two of them is shared evenly.
std::vector<int32_t> group_sizes(const std::vector<std::string>& words, const Motors& motors,
                                 int32_t entries) {
  if (static_cast<int32_t>(words.size()) == entries) return std::vector<int32_t>(words.size(), 1);
  const auto joints = [&](size_t w) { return words[w].find("joints") != std::string::npos; };
  std::vector<int32_t> sizes;
  int32_t at = 0;
  for (size_t w = 0; w < words.size();) {
    size_t next = w;
    while (next < words.size() && !joints(next)) ++next;
    const bool motor = next == w;
    if (motor) ++next;
    int32_t end = at;
    const auto side = [&](int32_t i) { return std::string(motors.at(i).name).substr(0, 4); };
    while (end < entries && (motors.count(end) != 0) == motor && (!motor || side(end) == side(at))) ++end;
    for (; w < next; ++w) sizes.push_back((end - at) / static_cast<int32_t>(next - w)), at += sizes.back();
  }
  return sizes;
}

std::string joint_table(const Motors& motors) {
  struct Row {
    std::string entries;
    std::vector<std::string> cells;
  };
  std::vector<Row> rows;
  const auto number = [](double x) { return std::isfinite(x) && x < 1e6 ? format("%.4g", x) : "-"; };
  for (const auto& [entry, j] : motors) {
    const std::vector<std::string> cells = {'`' + bare_joint(j.name) + '`',
                                            format("%.4g to %.4g", j.lower, j.upper), number(j.kp),
                                            number(j.kd), number(j.effort)};
    const auto same = std::find_if(rows.begin(), rows.end(), [&](const Row& r) { return r.cells == cells; });
    if (same == rows.end())
      rows.push_back({std::to_string(entry), cells});
    else
      same->entries += ", " + std::to_string(entry);
  }
  Table table({"action entry", "joint", "range, rad", "stiffness kp, N m/rad", "damping kd, N m s/rad",
               "effort limit, N m"});
  for (Row& r : rows) {
    r.cells.insert(r.cells.begin(), r.entries);
    table.add(r.cells);
  }
  return table.markdown();
}

std::string actions_of(int32_t index) {
  const rdm_task t = task_at(index);
  const redman::Pool pool(redman::pool_config(t.name));
  const Motors motors = motors_of(pool);
  const std::vector<std::string> words = words_of(t.action_order, ", ");
  const std::vector<int32_t> sizes = group_sizes(words, motors, t.action_dim);
  Table table({"action entries", "what they move", "count"});
  int32_t at = 0;
  std::string side;  // "right ", of groups that do not say it
  for (size_t w = 0; w < words.size(); at += sizes[w++]) {
    const size_t joints = words[w].find("joints");
    if (joints != std::string::npos) side = words[w].substr(0, joints);
    table.add({entries_text(at, sizes[w]), joints == std::string::npos ? side + words[w] : words[w],
               std::to_string(sizes[w])});
  }
  std::string text = table.markdown();
  if (!motors.empty()) text += '\n' + folded_away("Joints", joint_table(motors));
  return text;
}

// ---- observations ----

std::string fields_table(const std::vector<rdm_field_info>& fields, int32_t obs_dim) {
  Table table({"field", "entries", "count", "unit of 1", "range", "in the presets"});
  const auto presets = obs_presets(obs_dim, fields);
  for (const rdm_field_info& f : fields) {
    std::string in;
    for (const ObsPreset& p : presets)
      if (has_columns(p, f)) in += (in.empty() ? "" : ", ") + p.name;
    table.add({code(f.name), entries_text(f.offset, f.count), std::to_string(f.count), f.unit,
               range_text(static_cast<double>(f.low), static_cast<double>(f.high)), in});
  }
  return table.markdown();
}

// "right.ff_tip_force" -> "right.*_tip_force": one row for all fingers.
std::string finger_pattern(const std::string& name) {
  const size_t tip = name.find("_tip_"), dot = name.rfind('.', tip);
  if (tip == std::string::npos) return name;
  return (dot == std::string::npos ? "" : name.substr(0, dot + 1)) + '*' + name.substr(tip);
}

std::string observations_of(int32_t index) {
  const rdm_task t = task_at(index);
  const std::vector<rdm_field_info> fields = task_fields(index);
  if (fields.size() <= kLongTable) return fields_table(fields, t.obs_dim);
  struct Group {
    std::string name, unit;
    int32_t size, count;
  };
  std::vector<Group> groups;
  for (const rdm_field_info& f : fields) {
    const std::string name = finger_pattern(f.name);
    const auto same =
        std::find_if(groups.begin(), groups.end(), [&](const Group& g) { return g.name == name; });
    if (same == groups.end())
      groups.push_back({name, f.unit, f.count, 1});
    else
      ++same->count;
  }
  Table table({"field", "count", "unit of 1"});
  for (const Group& g : groups)
    table.add(
        {code(g.name), g.count == 1 ? std::to_string(g.size) : format("%d x %d", g.count, g.size), g.unit});
  return table.markdown() + '\n' +
         folded_away(format("All %zu fields with their entries, ranges and presets", fields.size()),
                     fields_table(fields, t.obs_dim));
}

// ---- costs ----

std::string costs_of(int32_t index) {
  Table table({"cost column", "limit on its sum", "value in a control step (raw: the value in `cost_raw`)"});
  for (const rdm_cost_info& c : task_costs(index))
    table.add({code(c.name), c.limit < 0 ? "-" : number_text(c.limit), table_cell(c.help)});
  return table.markdown();
}

// ---- options ----

struct OptionGroup {
  std::string key, value, values, help;
  double low = 0, high = 0;  // of the defaults that it stands for
  int32_t count = 0;
};

std::string values_of(const rdm_option_spec& o) {
  if (o.kind == RDM_KIND_FLAG) return "`true`, `false`";
  if (o.kind != RDM_KIND_TEXT)
    return number_text(o.low) + " to " + number_text(o.high) + (o.choices ? ", or a range" : "");
  if (!o.choices) return "text";
  std::string out;
  for (const std::string& word : words_of(o.choices, "|")) out += (out.empty() ? "`" : ", `") + word + '`';
  return out;
}

// "joint.FFJ2.kp" -> "joint.JOINT.kp", "link.palm.mass" -> "link.LINK.mass".
std::string option_pattern(const std::string& key) {
  const std::vector<std::string> words = words_of(key, ".");
  if (words.size() != 3) return key;
  if (words[0] == "joint") return "joint.JOINT." + words[2];
  if (words[0] == "link") return "link.LINK." + words[2];
  return key;
}

std::string option_rows_text(const std::vector<rdm_option_spec>& options, size_t* rows) {
  std::vector<OptionGroup> groups;
  for (const rdm_option_spec& o : options) {
    const std::string key = option_pattern(o.key);
    auto same =
        std::find_if(groups.begin(), groups.end(), [&](const OptionGroup& g) { return g.key == key; });
    if (same == groups.end())
      same = groups.insert(same,
                           {key, default_text(o), values_of(o), table_cell(o.help), o.number, o.number, 0});
    same->low = std::min(same->low, o.number);
    same->high = std::max(same->high, o.number);
    ++same->count;
  }
  Table table({"option", "default", "values", "meaning"});
  for (const OptionGroup& g : groups)
    table.add({code(g.key),
               g.low < g.high ? number_text(g.low) + " to " + number_text(g.high) : code(g.value), g.values,
               g.help});
  *rows = groups.size();
  return table.markdown();
}

// A table of the options of which `want` is true, "" where there are none.
std::string options_where(const std::vector<rdm_option_spec>& all,
                          const std::function<bool(const rdm_option_spec&)>& want, size_t* rows) {
  std::vector<rdm_option_spec> some;
  std::copy_if(all.begin(), all.end(), std::back_inserter(some), want);
  *rows = 0;
  return some.empty() ? "" : option_rows_text(some, rows);
}

// The basic ones, the others folded away.
std::string options_by_level(const std::vector<rdm_option_spec>& options, const std::string& what) {
  size_t rows;
  std::string text = options_where(
      options, [](const auto& o) { return o.level == RDM_LEVEL_BASIC; }, &rows);
  for (const auto& [level, name] :
       {std::pair{RDM_LEVEL_ADVANCED, "advanced"}, {RDM_LEVEL_LEGACY, "legacy"}}) {
    const std::string more = options_where(
        options, [level = level](const auto& o) { return o.level == level; }, &rows);
    if (!more.empty())
      text += (text.empty() ? "" : "\n") +
              folded_away(format("%zu %s %s", rows, name, rows == 1 ? "option" : what.c_str()), more);
  }
  return text;
}

std::string learner_defaults(int32_t index) {
  Table table({"option", "value for this task"});
  size_t count = 0;
  for (const rdm_option& o : last_defaults(index)) {
    table.add({code(o.key), code(o.text)});
    ++count;
  }
  if (count == 0) return "";
  return '\n' + folded_away(format("%zu defaults that this task sets (<code>NAME:KEY</code>: only for "
                                   "that algorithm, or for the shield)",
                                   count),
                            table.markdown());
}

bool replays(int32_t algo) {
  return has_option(algo_options(algo), "replay_rows");
}

// By all algorithms of the kind of one: that learn from a replay memory, or that do not.
bool shared_by_kind(const std::string& key, int32_t algo) {
  for (int32_t i = 0; i < rdm_algo_count(); ++i)
    if (replays(i) == replays(algo) && !has_option(algo_options(i), key)) return false;
  return true;
}

std::string algo_options_text(int32_t index) {
  std::vector<rdm_option_spec> own, shared;
  for (const rdm_option_spec& o : algo_options(index))
    (shared_by_kind(o.key, index) ? shared : own).push_back(o);
  const char* const whose = replays(index) ? "options that all algorithms with a replay memory have"
                                           : "options that all algorithms have";
  size_t rows;
  std::string text;
  if (!own.empty()) text = option_rows_text(own, &rows) + '\n';
  const std::string basic = options_where(
      shared, [](const auto& o) { return o.level == RDM_LEVEL_BASIC; }, &rows);
  text += folded_away(format("%zu basic %s", rows, whose), basic);
  std::erase_if(shared, [](const auto& o) { return o.level == RDM_LEVEL_BASIC; });
  return text + '\n' + options_by_level(shared, whose);
}

}  // namespace

std::string task_page(int32_t index) {
  const rdm_task t = task_at(index);
  return format("# %s\n\n%s.\n\n", t.name, t.summary) + marked("facts", facts_of(index)) + "\n## Actions\n" +
         marked("actions", actions_of(index)) + "\n## Observations\n" +
         marked("observations", observations_of(index)) + "\n## Costs\n" + marked("costs", costs_of(index)) +
         "\n## Options\n" +
         marked("options", options_by_level(task_options(index), "options") + learner_defaults(index));
}

std::string algo_page(int32_t index) {
  const rdm_algo a = algo_at(index);
  return format("# %s\n\n%s.\n\n## Options\n", a.name, a.summary) +
         marked("options", algo_options_text(index));
}

}  // namespace tool
