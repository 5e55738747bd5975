// `completion`: a script for bash, zsh or fish that completes subcommands, flags and the names of tasks and
// algorithms, written from the command line itself.
#include <algorithm>
#include <redman/redman.hpp>

#include "commands.hpp"
#include "common/names.hpp"
#include "common/objects.hpp"
#include "common/plugin.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

struct Flag {
  std::vector<std::string> names;  // "--task", "-h"
  std::string help;
  bool takes_value;
  std::string words;  // that the value may be, "": anything
};

struct Command {
  std::vector<std::string> path;  // {} for redman itself, {"bench", "step"}
  std::string help;
  std::vector<Flag> flags;
  std::vector<std::string> children;
  std::string words;  // of an argument without a flag
};

std::string joined(const std::vector<std::string>& list, const char* between = " ") {
  std::string out;
  for (const std::string& item : list) out += (out.empty() ? "" : between) + item;
  return out;
}

std::string task_words() {
  std::vector<std::string> names;
  for (int32_t i = 0; i < rdm_task_count(); ++i) names.push_back(task_at(i).name);
  return joined(names);
}

std::string algo_words() {
  std::vector<std::string> names;
  for (int32_t i = 0; i < rdm_algo_count(); ++i) names.push_back(algo_at(i).name);
  return joined(names);
}

std::string robot_words() {
  std::vector<std::string> names;
  for (int32_t i = 0; i < rdm_robot_count(); ++i) {
    auto robot = redman::sized<rdm_robot>();
    if (rdm_robot_at(i, &robot) == RDM_OK) names.emplace_back(robot.name);
  }
  return joined(names);
}

// Of a flag, or of the arguments that a command takes without one: then `name` is all of the command's words.
std::string value_words(const std::string& name, bool positional) {
  if (name == "task" || name == "tasks" || (name == "data make" && positional)) return task_words();
  if (name == "algo" || name == "algos") return algo_words();
  if (name == "robot" && positional) return robot_words();
  if (name == "object" && positional) return joined(object_names());
  if (name == "kind") return "hand arm other";
  if (name == "policy") return "zero hold random demo plan";
  if (name == "shield") return "off project predict";
  if (name == "info") return "planner shield";
  if (name == "completion") return "bash zsh fish";
  return "";
}

Flag flag_of(const CLI::Option& option) {
  Flag flag{{}, option.get_description(), option.get_items_expected_max() > 0, ""};
  for (const std::string& name : option.get_lnames()) flag.names.push_back("--" + name);
  for (const std::string& name : option.get_snames()) flag.names.push_back("-" + name);
  if (flag.takes_value)
    flag.words = value_words(option.get_lnames().empty() ? "" : option.get_lnames()[0], false);
  return flag;
}

void gather_commands(const CLI::App& app, const std::vector<std::string>& path, std::vector<Command>& out) {
  Command command{path, app.get_description(), {}, {}, value_words(joined(path), true)};
  for (const CLI::Option* option : app.get_options())
    if (!option->get_positional() || !option->get_lnames().empty()) command.flags.push_back(flag_of(*option));
  command.flags.push_back({{"--json"}, "one JSON object on one line", false, ""});
  if (!path.empty()) command.flags.push_back({{"--plugin"}, kPluginHelp, true, ""});
  const auto children = app.get_subcommands([](const CLI::App*) { return true; });
  for (const CLI::App* child : children) command.children.push_back(child->get_name());
  if (path.empty()) {
    const std::string names = joined(command.children);
    command.children.emplace_back("help");
    out.push_back({{"help"}, "Explain a command", {}, {}, names});
  }
  out.push_back(command);
  for (const CLI::App* child : children) {
    std::vector<std::string> longer = path;
    longer.push_back(child->get_name());
    gather_commands(*child, longer, out);
  }
}

// As it stands between single quotes; `also` are characters that a backslash must stand before.
std::string escaped(const std::string& text, const std::string& also = "") {
  std::string out;
  for (const char c : text) {
    if (also.find(c) != std::string::npos) out += '\\';
    out += c == '\'' ? std::string("'\\''") : std::string(1, c == '\n' ? ' ' : c);
  }
  return out;
}

std::string in_quotes(const std::string& text) {
  return '\'' + escaped(text) + '\'';
}

std::string head(const char* first, const char* shell, const char* how) {
  return format("%s completion of redman, as `redman completion %s` prints it%s.\n", first, shell, how);
}

// The loop with which bash and zsh find the subcommand among the words before the cursor.
std::string path_cases(const std::vector<Command>& commands) {
  std::vector<std::string> known;
  for (const Command& c : commands)
    if (!c.path.empty()) known.push_back(in_quotes(c.path.size() == 1 ? ' ' + c.path[0] : joined(c.path)));
  return joined(known, " | ");
}

std::string bash_script(const std::vector<Command>& commands) {
  std::string out = head("#", "bash", ": source it");
  out +=
      "_redman() {\n"
      "  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command= words= values= "
      "i\n"
      "  for ((i = 1; i < COMP_CWORD; ++i)); do\n"
      "    case \"$command ${COMP_WORDS[i]}\" in\n      " +
      path_cases(commands) +
      ") command=\"${command:+$command }${COMP_WORDS[i]}\" ;;\n"
      "    esac\n  done\n"
      "  case $command in\n";
  std::string choices;
  std::vector<std::string> chosen;
  for (const Command& c : commands) {
    std::vector<std::string> words = c.children, values;
    for (const Flag& f : c.flags) {
      words.insert(words.end(), f.names.begin(), f.names.end());
      if (f.takes_value) values.insert(values.end(), f.names.begin(), f.names.end());
      const std::string names = joined(f.names, " | ");
      if (!f.words.empty() && std::find(chosen.begin(), chosen.end(), names) == chosen.end()) {
        choices += "        " + names + ") words=" + in_quotes(f.words) + " ;;\n";
        chosen.push_back(names);
      }
    }
    out += "    " + in_quotes(joined(c.path)) +
           ") words=" + in_quotes(joined(words) + (c.words.empty() ? "" : ' ' + c.words)) +
           " values=" + in_quotes(joined(values)) + " ;;\n";
  }
  return out +
         "  esac\n  case \" $values \" in\n    *\" $before \"*)\n      words=\n      case $before in\n" +
         choices +
         "      esac\n      ;;\n  esac\n"
         "  COMPREPLY=($(compgen -W \"$words\" -- \"$word\"))\n"
         "}\n"
         "complete -o default -F _redman redman\n";
}

std::string zsh_script(const std::vector<Command>& commands) {
  std::string out = "#compdef redman\n" + head("#", "zsh", ": _redman in a folder of $fpath");
  out +=
      "local command= last=1 i\n"
      "for ((i = 2; i < CURRENT; ++i)); do\n"
      "  case \"$command $words[i]\" in\n    " +
      path_cases(commands) +
      ") command=\"${command:+$command }$words[i]\" last=$i ;;\n"
      "  esac\ndone\n"
      "words=(\"${(@)words[last,-1]}\")\n((CURRENT -= last - 1))\n"
      "case $command in\n";
  for (const Command& c : commands) {
    out += "  " + in_quotes(joined(c.path)) + ")\n    _arguments";
    for (const Flag& f : c.flags)
      for (const std::string& name : f.names)
        out += " \\\n      " + in_quotes('*' + name) + "'[" + escaped(f.help, "[]:") + "]'" +
               (f.takes_value ? f.words.empty() ? "':value:_files'" : in_quotes(":value:(" + f.words + ')')
                              : "");
    std::vector<std::string> words = c.children;
    if (!c.words.empty()) words.push_back(c.words);
    out += words.empty() ? " \\\n      '*:file:_files'\n"
                         : " \\\n      " + in_quotes("1: :(" + joined(words) + ')') + '\n';
    out += "    ;;\n";
  }
  return out + "esac\n";
}

std::string fish_script(const std::vector<Command>& commands) {
  std::string out = head("#", "fish", ": redman.fish in a folder of $fish_complete_path");
  for (const Command& c : commands) {
    std::string when = c.path.empty() ? "__fish_use_subcommand" : "";
    for (const std::string& word : c.path)
      when += (when.empty() ? "" : "; and ") + ("__fish_seen_subcommand_from " + word);
    const std::string line = "complete -c redman -n " + in_quotes(when);
    for (const Command& child : commands)
      if (child.path.size() == c.path.size() + 1 &&
          std::equal(c.path.begin(), c.path.end(), child.path.begin()))
        out += line + " -f -a " + child.path.back() + " -d " + in_quotes(child.help) + '\n';
    if (!c.words.empty()) out += line + " -f -a " + in_quotes(c.words) + '\n';
    for (const Flag& f : c.flags) {
      out += line;
      for (const std::string& name : f.names)
        out += name[1] == '-' ? " -l " + name.substr(2) : " -s " + name.substr(1);
      if (f.takes_value) out += f.words.empty() ? " -r" : " -r -a " + in_quotes(f.words);
      out += " -d " + in_quotes(f.help) + '\n';
    }
  }
  return out;
}

Report run_completion(const CLI::App& app, const std::string& shell) {
  std::vector<Command> commands;
  gather_commands(app, {}, commands);
  const std::string text = shell == "bash"  ? bash_script(commands)
                           : shell == "zsh" ? zsh_script(commands)
                                            : fish_script(commands);
  return {{{"shell", shell}, {"script", text}}, text};
}

}  // namespace

void add_completion(CLI::App& app, Run& run) {
  auto shell = std::make_shared<std::string>();
  CLI::App* command =
      app.add_subcommand("completion", "Print a shell script that completes command lines of this tool");
  command->add_option("shell", *shell, "shell: bash, zsh or fish")
      ->required()
      ->check(one_of({"bash", "zsh", "fish"}));
  command->callback([&app, &run, shell] { run = [&app, shell] { return run_completion(app, *shell); }; });
}

}  // namespace tool
