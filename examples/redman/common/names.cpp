#ifndef RDM_EXPERIMENTAL
#define RDM_EXPERIMENTAL
#endif
#include "common/names.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cctype>
#include <redman/redman.hpp>

#include "common/task_files.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

std::string folded(std::string s) {
  for (char& c : s) c = c == '-' ? '_' : static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return s;
}

int32_t find(rdm_result (*find_name)(const char*, int32_t*), const std::string& name) {
  int32_t index = -1;
  const rdm_result r = find_name(name.c_str(), &index);
  if (r == RDM_ERROR_UNSUPPORTED) throw Failure(rdm_last_error());
  if (r != RDM_OK) throw Usage(rdm_last_error());
  return index;
}

// All entries of a list of the ABI: get(i, &entry) until it answers RANGE.
template <class T, class Get>
std::vector<T> collect(int32_t count, Get get) {
  T row{};
  if constexpr (requires { row.struct_size; }) row.struct_size = sizeof row;
  std::vector<T> out(static_cast<size_t>(count), row);
  for (int32_t i = 0; i < count; ++i) redman::check(get(i, &out[static_cast<size_t>(i)]));
  return out;
}

Json default_json(const rdm_option_spec& o) {
  if (o.kind == RDM_KIND_TEXT || o.text) return o.text ? o.text : "";
  if (o.kind == RDM_KIND_FLAG) return o.number != 0;
  if (o.kind == RDM_KIND_INTEGER) return static_cast<int64_t>(o.number);
  return o.number;
}

std::string bounds_text(const rdm_option_spec& o) {
  if (o.kind == RDM_KIND_TEXT) return o.choices ? o.choices : "text";
  if (o.kind == RDM_KIND_FLAG) return "true|false";
  return number_text(o.low) + " .. " + number_text(o.high) + (o.choices ? ", or a range" : "");
}

}  // namespace

bool same_name(const std::string& a, const std::string& b) {
  return folded(a) == folded(b);
}

std::string nearest_hint(const std::string& word, const std::vector<std::string>& names) {
  std::string lines;
  for (const std::string& name : names) lines += name + '\n';
  char text[4 * RDM_TEXT_SIZE];
  redman::check(rdm_nearest_names(word.c_str(), lines.c_str(), text, sizeof text));
  return text;
}

CLI::Validator one_of(const std::vector<std::string>& words) {
  std::string list;
  for (const std::string& word : words) list += (list.empty() ? "" : ",") + word;
  return CLI::Validator(
      [words, list](std::string& value) {
        for (const std::string& word : words)
          if (same_name(word, value)) {
            value = word;
            return std::string();
          }
        return value + " is not one of " + list + nearest_hint(value, words);
      },
      "{" + list + "}");
}

int32_t find_task(const std::string& name) {
  return find(rdm_task_find, task_name(name));
}
int32_t find_algo(const std::string& name) {
  return find(rdm_algo_find, name);
}

rdm_task task_at(int32_t index) {
  auto t = redman::sized<rdm_task>();
  redman::check(rdm_task_at(index, &t));
  return t;
}

rdm_algo algo_at(int32_t index) {
  auto a = redman::sized<rdm_algo>();
  redman::check(rdm_algo_at(index, &a));
  return a;
}

std::vector<rdm_field_info> task_fields(int32_t task) {
  return collect<rdm_field_info>(task_at(task).num_fields, [&](int32_t i, rdm_field_info* out) {
    return rdm_task_field_at(task, i, out);
  });
}

std::vector<rdm_cost_info> task_costs(int32_t task) {
  return collect<rdm_cost_info>(
      task_at(task).cost_dim, [&](int32_t i, rdm_cost_info* out) { return rdm_task_cost_at(task, i, out); });
}

std::vector<rdm_option> task_defaults(int32_t task) {
  return collect<rdm_option>(task_at(task).num_defaults,
                             [&](int32_t i, rdm_option* out) { return rdm_task_default_at(task, i, out); });
}

std::vector<rdm_field_info> fields_of(const redman::Pool& pool) {
  return collect<rdm_field_info>(pool.spec().num_fields, [&](int32_t i, rdm_field_info* out) {
    return rdm_pool_field_at(pool.get(), i, out);
  });
}

Motors motors_of(const redman::Pool& pool) {
  const auto joints = collect<rdm_joint_info>(pool.spec().num_joints, [&](int32_t i, rdm_joint_info* out) {
    return rdm_pool_joint_at(pool.get(), i, out);
  });
  Motors motors;
  for (const rdm_joint_info& joint : joints)
    if (joint.action >= 0) motors[joint.action] = joint;
  return motors;
}

std::vector<rdm_option_spec> task_options(int32_t task) {
  return collect<rdm_option_spec>(task_at(task).num_options, [&](int32_t i, rdm_option_spec* out) {
    return rdm_task_option_at(task, i, out);
  });
}

std::vector<rdm_option_spec> algo_options(int32_t algo) {
  return collect<rdm_option_spec>(algo_at(algo).num_options, [&](int32_t i, rdm_option_spec* out) {
    return rdm_algo_option_at(algo, i, out);
  });
}

bool has_option(const std::vector<rdm_option_spec>& table, const std::string& key) {
  return std::any_of(table.begin(), table.end(), [&](const auto& o) {
    const std::string known = o.key;  // "noise.tip_force" is one of "noise.FIELD"
    const size_t dot = known.rfind('.') + 1;
    const bool open = dot > 0 && known.substr(dot) == "FIELD";
    return same_name(known, key) ||
           (open && key.size() > dot && same_name(known.substr(0, dot), key.substr(0, dot)));
  });
}

Json build_json() {
  auto b = redman::sized<rdm_build>();
  redman::check(rdm_build_info(&b));
  return {{"version", b.version},     {"abi", b.abi},           {"ode", b.ode},
          {"eigen", b.eigen},         {"ccd", b.ccd},           {"octomap", b.octomap},
          {"precision", b.precision}, {"compiler", b.compiler}, {"kernels", b.kernels},
          {"differs", b.differs}};
}

const char* level_name(int32_t level) {
  return level == RDM_LEVEL_BASIC ? "basic" : level == RDM_LEVEL_ADVANCED ? "advanced" : "legacy";
}

Json options_json(const std::vector<rdm_option_spec>& table) {
  Json out = Json::array();
  for (const rdm_option_spec& o : table) {
    const bool text = o.kind == RDM_KIND_TEXT;
    Json row = object_of({{"key", o.key},
                          {"default", default_json(o)},
                          {"low", text ? Json() : Json(o.low)},
                          {"high", text ? Json() : Json(o.high)},
                          {"help", o.help},
                          {"live", o.live != 0},
                          {"level", level_name(o.level)}});
    if (text && o.choices) row["choices"] = o.choices;
    if (!text && o.choices) row["range"] = true;
    out.push_back(std::move(row));
  }
  return out;
}

std::string default_text(const rdm_option_spec& o) {
  if (o.text) return o.text;
  if (o.kind == RDM_KIND_TEXT) return "";
  if (o.kind == RDM_KIND_FLAG) return o.number != 0 ? "true" : "false";
  return number_text(o.number);
}

// One table for each level that has rows, the basic one first.
std::string options_text(const std::vector<rdm_option_spec>& table) {
  std::string text;
  for (const int32_t level : {RDM_LEVEL_BASIC, RDM_LEVEL_ADVANCED, RDM_LEVEL_LEGACY}) {
    Table out({std::string(level_name(level)) + " option", "default", "values", "meaning"});
    bool any = false;
    for (const rdm_option_spec& o : table) {
      if (o.level != level) continue;
      out.add({o.key, default_text(o), bounds_text(o), o.help});
      any = true;
    }
    if (any) text += (text.empty() ? "" : "\n") + out.text();
  }
  return text;
}

}  // namespace tool
