// `--shield`: in one word what stands between who acts and the worlds: "off", "project" or "predict", and options of shields
// with commas between: "predict:noise=0.4,rounds=4".
#pragma once
#include <redman/redman.h>

#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace tool {

struct ShieldWord {
  std::string word = "off";          // as it was given
  bool on = false, predicts = true;  // by copies too, or by guards alone
  std::string settings;              // lines key=value
};
// Usage for another word, or an option that shields do not have, with what there is.
ShieldWord read_shield_word(const std::string& word);
std::vector<rdm_option_spec> shield_options();
CLI::Option* add_shield_flag(CLI::App& command, std::string& word);

}  // namespace tool
