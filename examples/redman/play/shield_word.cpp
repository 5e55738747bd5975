#include "play/shield_word.hpp"

#include <redman/shield.h>

#include <CLI/CLI.hpp>

#include "common/names.hpp"
#include "common/setup.hpp"

namespace tool {

std::vector<rdm_option_spec> shield_options() {
  std::vector<rdm_option_spec> out;
  rdm_option_spec row = RDM_INIT(rdm_option_spec);
  for (int32_t i = 0; rdm_shield_option_at(i, &row) == RDM_OK; ++i) out.push_back(row);
  return out;
}

ShieldWord read_shield_word(const std::string& word) {
  const std::vector<std::string> known = {"off", "project", "predict"};
  const size_t colon = word.find(':');
  const std::string kind = word.substr(0, colon), flag = "--shield " + word + ": ";
  const bool project = same_name(kind, known[1]);
  if (!project && !same_name(kind, known[0]) && !same_name(kind, known[2]))
    throw Usage(flag + "no such shield" + nearest_hint(kind, known) +
                "; there are off, project and predict[:key=value,...]");
  ShieldWord out;
  out.word = word;
  out.on = !same_name(kind, known[0]);
  out.predicts = !project;
  if (out.on) out.settings = project ? "predict=false\n" : "predict=true\n";  // over those of a run
  if (!out.on && colon != std::string::npos) throw Usage(flag + "off has no options");
  const auto table = shield_options();
  GivenOnce given;
  for (size_t at = colon; at != std::string::npos;) {
    const size_t end = word.find(',', at + 1);
    const std::string item = word.substr(at + 1, end == std::string::npos ? end : end - at - 1);
    const auto [key, value] = split_pair(item, "--shield:");
    given.add(key, "--shield " + word);
    std::vector<std::string> keys;
    for (const rdm_option_spec& row : table) keys.push_back(row.key);
    if (same_name(key, "predict")) throw Usage(flag + "the words project and predict set that option");
    if (!has_option(table, key))
      throw Usage(flag + "shields have no option " + key + nearest_hint(key, keys));
    out.settings += key + '=' + value + '\n';
    at = end;
  }
  return out;
}

CLI::Option* add_shield_flag(CLI::App& command, std::string& word) {
  return command
      .add_option("--shield", word,
                  "safety filter of every decision: off; project: replace it by the nearest action within "
                  "the task's guards; predict[:key=value,...]: simulate it in a copy of the world, and "
                  "replace it if a cost would follow (`redman info shield` lists the keys)")
      ->type_name("WORD");
}

}  // namespace tool
