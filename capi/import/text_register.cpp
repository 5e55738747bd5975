#include "text_register.hpp"

#include <algorithm>

#include "base/names.hpp"
#include "env/options/simulation_rows.hpp"
#include "task_program.hpp"
#include "term_table.hpp"

namespace rdm::import {
namespace {

// What rdm_task_create must know before any scene is built: names, fields, costs, options, cameras. The
// task's build reads terms and scene, with the values that options have then.
class Registration {
 public:
  explicit Registration(TextTask* task) : task_(*task), top_{task->root, "", nullptr} {}

  rdm_task_def def() {
    top_.only({"task", "options", "learn", "material", "friction", "robot", "tree", "body", "static", "draw",
               "camera", "observe", "reward", "cost", "success", "fall", "end"});
    rdm_task_def d;
    rdm_task_def_init(&d, sizeof d);
    if (!top_.find("task")) top_.bad(RDM_ERROR_FORMAT, 1, "there is no [task]");
    const Table t = top_.section("task");
    t.only({"name", "summary", "max_steps", "obs_limit", "gravity"});
    d.name = task_.keep(t.as_text(t.need("name"), "name"));
    d.summary = task_.keep(t.text("summary", ""));
    d.max_steps = t.integer("max_steps", 100, 1, 100000);
    d.obs_limit = 5;
    t.number("obs_limit", &d.obs_limit);
    fields();
    costs();
    options();
    cameras();
    defaults();
    const auto give = [](const auto& rows, auto* array, int32_t* count) {
      *array = rows.data();
      *count = static_cast<int32_t>(rows.size());
    };
    give(task_.fields, &d.fields, &d.num_fields);
    give(task_.costs, &d.costs, &d.num_costs);
    give(task_.options, &d.options, &d.num_options);
    give(task_.cameras, &d.cameras, &d.num_cameras);
    give(task_.defaults, &d.defaults, &d.num_defaults);
    d.action_dim = 1;  // build says
    d.state_bytes = sizeof(State);
    d.instance_bytes = sizeof(Program);
    d.user = &task_;
    return d;
  }

 private:
  void fields() {
    for (const Table& t : top_.rows("observe")) {
      const TermRow& row = term_of(t, true);
      double scale = 1;
      // a scale that is an option's name has no value yet
      if (const toml::node* n = t.find("scale"); n && !n->is_string()) scale = t.as_number(*n, "scale");
      std::string unit = t.text("unit", row.unit);
      if (!t.find("unit") && scale != 1) unit = format("%g %s", 1 / scale, row.unit);
      task_.stands("fields", task_.fields.size(), line_of(t.t), t.what);
      // one entry until build says how many; equal bounds are none
      task_.fields.push_back({task_.keep(field_name(t)), task_.keep(unit), 1, 0, 0, 0});
    }
    if (task_.fields.empty()) top_.bad(RDM_ERROR_FORMAT, 1, "there is no [[observe]]");
  }
  void costs() {
    for (const Table& t : top_.rows("cost")) {
      const char* name = task_.keep(t.as_text(t.need("name"), "name"));
      double limit = -1;
      t.number("limit", &limit);
      const auto same = [&](const rdm_cost_def& c) { return same_name(c.name, name); };
      const auto there = std::find_if(task_.costs.begin(), task_.costs.end(), same);
      if (there == task_.costs.end()) {
        if (task_.costs.size() == RDM_MAX_COSTS)
          t.bad(RDM_ERROR_RANGE, line_of(t.t), "there are more than %d costs", RDM_MAX_COSTS);
        task_.stands("costs", task_.costs.size(), line_of(t.t), t.what);
        task_.costs.push_back({name, task_.keep(t.text("help", term_of(t, false).name)), limit});
      } else if (t.find("limit") || t.find("help")) {
        t.bad(RDM_ERROR_FORMAT, line_of(t.t), "limit and help: only the first row of a cost may have them");
      }
    }
    if (task_.costs.empty()) top_.bad(RDM_ERROR_FORMAT, 1, "there is no [[cost]]");
  }
  void options() {
    const Table all = top_.section("options");
    for (const auto& [key, value] : all.t) {
      const std::string name(key.str());
      rdm_option_def o{};
      o.key = task_.keep(name);
      const toml::table* own = value.as_table();
      // a table declares an option of this task; a value sets the default of one that every task has
      const Table t{own ? *own : all.t, "options: " + clean(name), nullptr};
      if (own)
        own_option(t, &o);
      else
        shared_option(t, value, &o);
      task_.stands("options", task_.options.size(), line_of(key.source()), t.what);
      task_.options.push_back(o);
    }
  }
  void own_option(const Table& t, rdm_option_def* o) {
    t.only({"default", "low", "high", "help", "integer", "range", "choices"});
    const toml::node& n = t.need("default");  // its type is the option's kind
    o->help = task_.keep(t.text("help", "option of the task's file"));
    if (n.is_boolean()) {
      o->kind = RDM_KIND_FLAG;
      o->number = n.as_boolean()->get() ? 1 : 0;
      o->high = 1;
    } else if (n.is_string()) {
      o->kind = RDM_KIND_TEXT;
      o->text = task_.keep(t.as_text(n, "default"));
      if (const toml::node* c = t.find("choices")) {
        const toml::array* words = c->as_array();
        if (!words || words->empty())
          t.bad(RDM_ERROR_FORMAT, line_of(*c), "choices is not a list of strings");
        std::string joined;
        for (const toml::node& word : *words)
          joined += (joined.empty() ? "" : "|") + t.as_text(word, "choices");
        o->choices = task_.keep(joined);
      }
    } else {
      o->kind = t.flag("integer") ? RDM_KIND_INTEGER : RDM_KIND_NUMBER;
      o->number = t.as_number(n, "default");
      o->low = t.as_number(t.need("low"), "low");
      o->high = t.as_number(t.need("high"), "high");
      if (t.flag("range", o->kind == RDM_KIND_NUMBER)) o->choices = "a..b";
      if (!(o->low <= o->number && o->number <= o->high))
        t.bad(RDM_ERROR_RANGE, line_of(n), "default: %g is outside [%g, %g]", o->number, o->low, o->high);
    }
  }
  void shared_option(const Table& t, const toml::node& value, rdm_option_def* o) {
    const OptionSpec* row = nullptr;
    std::vector<std::string> names;
    for (const OptionSpec& r : kSimulationRows.specs) {
      names.emplace_back(r.key);
      if (rdm::same_name(r.key, o->key)) row = &r;
    }
    if (!row)
      t.bad(RDM_ERROR_NOT_FOUND, line_of(value),
            "no task has an option of this name%s; write your own as { default = , low = , high = , help = }",
            nearest_hint(o->key, names).c_str());
    o->kind = static_cast<int32_t>(row->kind);
    if (row->kind == OptionKind::kText)
      o->text = task_.keep(t.as_text(value, o->key));
    else if (const auto* flag = value.as_boolean())
      o->number = flag->get() ? 1 : 0;
    else
      o->number = t.as_number(value, o->key);
  }
  void cameras() {
    for (const Table& t : top_.rows("camera")) {
      t.only({"name", "eye", "target", "fov", "up", "cx", "cy"});
      rdm_camera_def c{};
      c.name = task_.keep(t.as_text(t.need("name"), "name"));
      const auto eye = t.list(t.need("eye"), "eye", 3, 3), target = t.list(t.need("target"), "target", 3, 3);
      double up[3] = {}, fov = 0.785398163397448, cx = 0, cy = 0;
      t.numbers("up", up, 3);
      t.number("fov", &fov);
      t.number("cx", &cx);
      t.number("cy", &cy);
      for (size_t k = 0; k < 3; ++k) {
        c.eye[k] = static_cast<float>(eye[k]);
        c.target[k] = static_cast<float>(target[k]);
        c.up[k] = static_cast<float>(up[k]);
      }
      c.fov_y = static_cast<float>(fov);
      c.cx = static_cast<float>(cx);
      c.cy = static_cast<float>(cy);
      task_.stands("cameras", task_.cameras.size(), line_of(t.t), t.what);
      task_.cameras.push_back(c);
    }
  }
  void defaults() {
    const Table all = top_.section("learn");
    for (const auto& [key, value] : all.t) {
      const std::string name(key.str());
      rdm_option o{task_.keep(name), nullptr, 0};
      if (value.is_string())
        o.text = task_.keep(all.as_text(value, name.c_str()));
      else if (const auto* flag = value.as_boolean())
        o.number = flag->get() ? 1 : 0;
      else
        o.number = all.as_number(value, name.c_str());
      task_.stands("defaults", task_.defaults.size(), line_of(key.source()), "learn: " + clean(name));
      task_.defaults.push_back(o);
    }
  }

  TextTask& task_;
  Table top_;
};

}  // namespace

rdm_task_def registration_of(TextTask* task) {
  return Registration(task).def();
}

}  // namespace rdm::import
