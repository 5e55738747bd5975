// The redman command-line tool: simulate, train, evaluate and look, written against the public headers alone.
// Results go to stdout, progress and errors to stderr. Exit status: 0 good, 1 the work failed, 2 wrong usage.
#include <algorithm>
#include <cctype>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <iterator>
#include <locale>
#include <new>
#include <redman/redman.hpp>
#include <regex>

#if defined(_WIN32)
#include <fcntl.h>
#include <io.h>
#endif

#include "commands.hpp"
#include "common/names.hpp"
#include "common/numbers.hpp"
#include "common/plugin.hpp"
#include "common/setup.hpp"
#include "common/text.hpp"

namespace {

using namespace tool;

struct Arguments {
  std::vector<std::string> words;
  std::vector<std::string> plugins;
  bool json = false;
};

// --json and --plugin may stand anywhere, and flags may be written with underscores or capitals. `help train` is
// `train --help`.
Arguments read_arguments(int argc, char** argv) {
  Arguments out;
  for (int i = 1; i < argc; ++i) {
    std::string word = argv[i];
    if (word.rfind("--", 0) == 0) {
      const size_t end = std::min(word.find('='), word.size());
      for (size_t k = 2; k < end; ++k)
        word[k] = word[k] == '_' ? '-' : static_cast<char>(std::tolower(static_cast<unsigned char>(word[k])));
    }
    if (word == "--json")
      out.json = true;
    else
      out.words.push_back(word);
  }
  if (!out.words.empty() && out.words.front() == "help") {
    out.words.erase(out.words.begin());
    out.words.push_back("--help");
  }
  return out;
}

void print_result(const Report& report, bool json) {
  const std::string text = json ? json_text(report.json) + '\n' : printable(report.text);
  std::fwrite(text.data(), 1, text.size(), stdout);
  if (std::fflush(stdout) != 0 || std::ferror(stdout))
    throw Failure(std::string("cannot write to stdout: ") + std::strerror(errno));
}

int fail(const std::string& text, int status, bool json) {
  std::string line = printable(with_flags(text));
  std::replace(line.begin(), line.end(), '\n', ' ');
  std::fprintf(stderr, "redman: %s\n", line.c_str());
  if (json) std::printf("%s\n", json_text({{"error", line}, {"status", status}}).c_str());
  return status;
}

std::vector<std::string> subcommands_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* sub : app.get_subcommands([](const CLI::App*) { return true; }))
    names.push_back(sub->get_name());
  return names;
}

std::vector<std::string> flags_of(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* o : app.get_options())
    for (const std::string& name : o->get_lnames()) names.push_back("--" + name);
  for (const char* name : {"--json", "--plugin"}) names.emplace_back(name);
  return names;
}

// The first flag that the command does not have, "" when it has them all.
std::string unknown_flag(const CLI::App& command, const std::vector<std::string>& words) {
  const std::vector<std::string> known = flags_of(command);
  for (const std::string& word : words) {
    const std::string flag = word.substr(0, word.find('='));
    if (flag == "--") break;
    if (flag.rfind("--", 0) == 0 && std::find(known.begin(), known.end(), flag) == known.end()) return flag;
  }
  return "";
}

// The deepest command that was named, its path, and why the word after it names none below it; "" when it does.
struct Named {
  const CLI::App* command;
  std::string path, unknown;
};
Named named_command(const CLI::App& app, const std::vector<std::string>& words) {
  Named out{&app, "redman", ""};
  size_t depth = 0;
  for (; !out.command->get_subcommands().empty(); ++depth) {
    out.command = out.command->get_subcommands().front();
    out.path += ' ' + out.command->get_name();
  }
  const std::vector<std::string> below = subcommands_of(*out.command);
  const std::string next = depth < words.size() ? words[depth] : "";
  if (!below.empty() && !next.empty() && next[0] != '-')
    out.unknown = "subcommand" + out.path.substr(std::strlen("redman")) + ' ' + next + ": unknown" +
                  nearest_hint(next, below) + "; see " + out.path + " --help";
  return out;
}

// Sentences of CLI11 in the words of the tool's own.
std::string plain_text(std::string text) {
  static const std::pair<std::regex, const char*> kPlain[] = {
      {std::regex("1 required \\S+ missing"), "it needs a value"},
      {std::regex("At Most 1 required but received (\\d+)"), "it is given $1 times; give it once"},
      {std::regex("The following arguments? (?:was|were) not expected: (.*)"),
       "$1: the command takes no such argument"},
      {std::regex("^(\\w+) is required"), "argument $1 is missing"},
      {std::regex("(\\S+) is required"), "$1 is missing"},
      {std::regex("(\\S+) requires (\\S+)"), "$1 is for $2, which is missing"},
      {std::regex("(\\S+) excludes (\\S+)"), "$1 and $2 exclude each other"}};
  for (const auto& [theirs, ours] : kPlain) text = std::regex_replace(text, theirs, ours);
  return text;
}

// CLI11 answers an unknown subcommand or flag with a list of unexpected arguments, and a number that does not
// fit into a flag's type as one that it cannot convert.
std::string usage_text(const CLI::App& app, const CLI::ParseError& error, const Arguments& arguments) {
  const Named named = named_command(app, arguments.words);
  if (!named.unknown.empty()) return named.unknown;
  const std::string see = "; see " + named.path + " --help";
  // first: CLI11 takes the value of an unknown flag for an argument, and complains of that
  const std::string flag = unknown_flag(*named.command, arguments.words);
  if (!flag.empty()) return flag + ": unknown" + nearest_hint(flag, flags_of(*named.command)) + see;
  std::string text = error.what();
  std::replace(text.begin(), text.end(), '\n', ' ');
  text = plain_text(text);
  const std::string unread = "Could not convert: ";
  if (text.rfind(unread, 0) == 0) {
    text = text.substr(unread.size()) + ": out of range";
    if (const size_t equals = text.find(" = "); equals != std::string::npos) text.replace(equals, 3, " ");
  }
  return text + see;
}

// Everything that was asked for; throws what failed.
void work(CLI::App& app, Run& run, const Arguments& arguments) {
  try {
    redman::check(rdm_check_abi(RDM_ABI, RDM_VERSION));
    load_plugins(arguments.plugins);
    if (arguments.words.empty()) throw CLI::CallForHelp();
    std::locale::global(std::locale::classic());  // C's too: a plugin may have set another for its own texts
    app.parse(std::vector<std::string>(arguments.words.rbegin(), arguments.words.rend()));
    print_result(run(), arguments.json);
  } catch (const CLI::CallForHelp&) {
    // CLI11 answers --help before it looks at words that it does not know
    if (const Named named = named_command(app, arguments.words); !named.unknown.empty())
      throw Usage(named.unknown);
    const std::string text = app.help();  // of the subcommand, if there is one
    print_result({{{"help", text}}, text + '\n'}, arguments.json);
  } catch (const CLI::CallForVersion&) {
    const Json build = build_json();
    const std::string version = build["version"];
    print_result({{{"version", version}, {"abi", build["abi"]}}, "redman " + version + '\n'}, arguments.json);
  } catch (const CLI::CallForAllHelp&) {
    const std::string text = app.help("", CLI::AppFormatMode::All);
    print_result({{{"help", text}}, text + '\n'}, arguments.json);
  }
}

// In the order of the help, by group.
struct Command {
  const char* name;
  void (*add)(CLI::App&, Run&);
  const char* group;
  const char* example;
};
constexpr char kPlay[] = "Train and play", kLook[] = "Look", kLists[] = "Tasks, algorithms, robots, objects",
               kFiles[] = "Files and this program";
constexpr Command kCommands[] = {
    {"train", add_train, kPlay, "redman train --task hand_over_safe_finger --steps 1e6 --out runs/first"},
    {"sweep", add_sweep, kPlay,
     "redman sweep --tasks ball_run,car_run --algos ppo_lag,cpo --seeds 0..4 --out runs/sweep"},
    {"data", add_data, kPlay, "redman data make hand_over_safe_finger --rows 1e5 --out set.npz"},
    {"learn", add_learn, kPlay, "redman learn --from set.npz --algo td3_bc_lag --steps 1e5 --out policy.rdm"},
    {"eval", add_eval, kPlay, "redman eval --policy runs/first --episodes 100"},
    {"rollout", add_rollout, kPlay, "redman rollout --policy runs/first --episodes 10 --record rollout.npz"},
    {"plan", add_plan, kPlay, "redman plan --task hand_over_safe_finger --method cem --samples 128"},
    {"baseline", add_baseline, kPlay, "redman baseline --task ball_run --policy hold --policy random"},
    {"bench", add_bench, kPlay, "redman bench step --task hand_over_safe_finger --envs 64"},
    {"render", add_render, kLook, "redman render --policy runs/first --html episode.html"},
    {"view", add_view, kLook, "redman view --task hand_over_safe_finger --policy trained --open"},
    {"plot", add_plot, kLook, "redman plot runs/first --out curve.svg"},
    {"report", add_report, kLook, "redman report runs --html report.html"},
    {"compare", add_compare, kLook, "redman compare examples/results/runs.csv --where part=command"},
    {"tasks", add_tasks, kLists, "redman tasks hand_over_safe_finger"},
    {"algos", add_algos, kLists, "redman algos ppo_lag"},
    {"robots", add_robots, kLists, "redman robots"},
    {"objects", add_objects, kLists, "redman objects"},
    {"robot", add_robot, kLists, "redman robot hand.urdf --check --out hand.robot"},
    {"object", add_object, kLists,
     "redman object mug.stl --name my_mug --scale 0.001 --mass 0.2 --out my_mug.object"},
    {"hull", add_hull, kLists, "redman hull mug.stl --scale 0.001 --points 24"},
    {"export", add_export, kFiles, "redman export --policy runs/first --c policy.c"},
    {"info", add_info, kFiles, "redman info shield"},
    {"completion", add_completion, kFiles, "source <(redman completion bash)"},
};
constexpr char kFooter[] =
    "With --json, stdout is one JSON object on one line. Names: case is ignored, '-' equals '_'.";

// An example above what every help ends with.
std::string footer_of(const std::string& examples) {
  return "Example:\n  " + examples + "\n\n" + kFooter;
}

// One that the first word names goes without the others: CLI11 takes most of a short command's time to note the
// flags of all. A completion completes every command.
void add_commands(CLI::App& app, Run& run, const std::vector<std::string>& words) {
  const Command* asked = std::find_if(std::begin(kCommands), std::end(kCommands),
                                      [&](const Command& c) { return !words.empty() && words[0] == c.name; });
  const bool alone = asked != std::end(kCommands) && asked->add != add_completion;
  for (const Command& c : kCommands) {
    if (alone && &c != asked) continue;
    c.add(app, run);
    CLI::App* command = app.get_subcommand(c.name);
    command->group(c.group)->footer(footer_of(c.example));
    for (CLI::App* below : command->get_subcommands([](CLI::App*) { return true; }))
      if (below->get_footer().empty())
        below->footer(footer_of(std::string("redman ") + c.name + ' ' + below->get_name()));
      else  // an example of its own
        below->footer(footer_of(below->get_footer()));
  }
}

int run_tool(int argc, char** argv) {
  Arguments arguments = read_arguments(argc, argv);
  const bool json = arguments.json;

  CLI::App app("Safe dexterous manipulation: simulate, train, evaluate, look.", "redman");
  app.require_subcommand(1);
  app.option_defaults()->always_capture_default();
  Run run;
  add_commands(app, run, arguments.words);
  // After the commands, which would inherit it.
  app.footer(
      footer_of("redman train --task hand_over_safe_finger --steps 1e6 --out runs/first\n"
                "  redman eval --policy runs/first\n"
                "  redman render --policy runs/first --html episode.html\n\n"
                "redman help COMMAND explains a command."));
  app.set_version_flag("--version", "", "Print the version and exit");
  app.set_help_all_flag("--help-all", "Help of every subcommand");
  std::vector<std::string> plugins;  // for the help; they are taken before
  app.add_option("--plugin", plugins, kPluginHelp)->type_name("FILE");
  check_numbers(app);
  try {
    arguments.plugins = take_plugins(arguments.words);
    work(app, run, arguments);
    return 0;
  } catch (const CLI::ParseError& e) {
    return fail(usage_text(app, e, arguments), 2, json);
  } catch (const Usage& e) {
    return fail(e.what(), 2, json);
  } catch (const std::bad_alloc&) {
    return fail("out of memory: use fewer worlds or a shorter horizon", 1, json);
  } catch (const std::exception& e) {
    return fail(e.what(), 1, json);
  } catch (...) {
    return fail("something was thrown that is not a std::exception: this is a fault of redman or of a plugin",
                1, json);
  }
}

// Where there is not even the memory to say so by the ways above.
int fail_without_memory(int argc, char** argv) {
  for (int i = 1; i < argc; ++i)
    if (std::strcmp(argv[i], "--json") == 0) std::puts("{\"error\":\"out of memory\",\"status\":1}");
  std::fputs("redman: out of memory\n", stderr);
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
#if defined(_WIN32)
  _setmode(_fileno(stdout), _O_BINARY);  // the same lines as elsewhere
#else
  std::signal(SIGXFSZ, SIG_IGN);  // a file size limit then is an error of write, with a text
#endif
  try {
    return run_tool(argc, argv);
  } catch (...) {
    return fail_without_memory(argc, argv);
  }
}
