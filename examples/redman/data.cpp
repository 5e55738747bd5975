// `data`: makes sets of episodes for learning without new steps, and says what is in them.
#include <algorithm>

#include "commands.hpp"
#include "common/clock.hpp"
#include "common/files.hpp"
#include "common/names.hpp"
#include "common/numbers.hpp"
#include "common/setup.hpp"
#include "common/text.hpp"
#include "data/make.hpp"
#include "data/mcap.hpp"
#include "data/published.hpp"
#include "data/set.hpp"
#include "data/summary.hpp"

namespace tool {
namespace {

struct DataMakeFlags {
  MakeSettings make;
  std::string preset = "none", out;
  double rows = 1e5;
  bool list = false;
};

bool file_ends_in(const std::string& text, const std::string& end) {
  return text.size() > end.size() && same_name(text.substr(text.size() - end.size()), end);
}

Report list_published() {
  Table table({"published set", "task", "rows of an episode", "limits"});
  Json rows = Json::array();
  for (const Published& p : published_dsrl()) {
    const std::string limits =
        number_text(p.limits[0]) + ", " + number_text(p.limits[1]) + ", " + number_text(p.limits[2]);
    table.add({p.name, p.task, std::to_string(p.max_steps), limits});
    rows.push_back({{"name", p.name}, {"task", p.task}, {"max_steps", p.max_steps}, {"limits", p.limits}});
  }
  return {{{"published", rows}}, table.text()};
}

Report run_data_make(DataMakeFlags flags) {
  MakeSettings& make = flags.make;
  if (flags.list && !make.pool.task.empty())
    throw Usage("--list lists all published sets; leave out " + printable(make.pool.task));
  if (flags.list) return list_published();
  if (make.pool.task.empty()) throw Usage("data make: give a task, or the name of a published set (--list)");
  const Published* published = find_published(make.pool.task);
  const bool by_name = published && !same_name(make.pool.task, published->task);
  if (by_name || same_name(flags.preset, "dsrl")) {
    if (!published) {
      std::vector<std::string> names;
      for (const Published& p : published_dsrl()) names.emplace_back(p.task);
      throw Usage("--preset dsrl: it has no set of task " + printable(make.pool.task) +
                  nearest_hint(make.pool.task, names) + "; redman data make --list has them all");
    }
    make.pool.task = published->task;
    make.published = published->name;
    make.limits.assign(std::begin(published->limits), std::end(published->limits));
    make.pool.options = options_of(*published);
  } else if (make.pool.task.rfind("Offline", 0) == 0) {
    std::vector<std::string> names;
    for (const Published& p : published_dsrl()) names.emplace_back(p.name);
    throw Usage("data set " + printable(make.pool.task) + ": unknown" + nearest_hint(make.pool.task, names) +
                "; redman data make --list has them all");
  }
  const std::string out = flags.out.empty()
                              ? std::string(make.published ? make.published : make.pool.task.c_str()) + ".npz"
                              : flags.out;
  if (!file_ends_in(out, ".npz"))
    throw Usage("--out " + printable(out) +
                ": its name does not end in .npz; data convert makes other files of it");
  check_outputs({{"--out", out}});
  make.rows = static_cast<uint64_t>(whole_number(flags.rows, "--rows"));
  const auto begun = Clock::now();
  const DataSet set = make_set(make);
  write_set(set, out);
  const double spent = since(begun);
  Json json = summary_json(set);
  json["file"] = out;
  json["seconds"] = spent;
  return {json, summary_text(json) + format("wrote %s in %.1f s\n", out.c_str(), spent)};
}

Report run_data_info(const std::string& path) {
  const DataSet set = read_set(path);
  Json json = summary_json(set);
  json["file"] = path;
  json["metadata"] = set.metadata;
  return {json, summary_text(json)};
}

struct DataConvertFlags {
  std::string from, to;
  bool keep_unfinished = false;
};

// The endings of files that the tool reads and writes; Usage for others.
enum class DataFile { kArrays, kMcap };
DataFile data_file(const std::string& path, const char* what) {
  if (file_ends_in(path, ".npz")) return DataFile::kArrays;
  if (file_ends_in(path, ".mcap")) return DataFile::kMcap;
  for (const char* end : {".hdf5", ".h5", ".minari", ".lerobot"})
    if (file_ends_in(path, end))
      throw Usage(std::string(what) + ' ' + printable(path) +
                  ": such files are read and written in Python: python3 -m redman data convert FROM TO");
  throw Usage(std::string(what) + ' ' + printable(path) +
              ": its name does not end in .npz or .mcap, nor in .hdf5, .minari or .lerobot for python3 -m "
              "redman data convert");
}

Report run_data_convert(const DataConvertFlags& flags) {
  const DataFile from = data_file(flags.from, "FROM"), to = data_file(flags.to, "TO");
  check_outputs({{"TO", flags.to}}, {{"FROM", flags.from}});
  DataSet set = from == DataFile::kMcap ? read_mcap(flags.from) : read_set(flags.from);
  Json left_out = Json::array();
  std::vector<DataEpisode> kept;
  for (size_t i = 0; i < set.episodes.size(); ++i) {
    if (!flags.keep_unfinished && !set.episodes[i].ended())
      left_out.push_back(i);
    else
      kept.push_back(std::move(set.episodes[i]));
  }
  set.episodes = std::move(kept);
  to == DataFile::kMcap ? write_mcap(set, flags.to) : write_set(set, flags.to);
  std::string text =
      format("wrote %s: %llu rows in %zu episodes, hash %s\n", flags.to.c_str(),
             static_cast<unsigned long long>(set.rows()), set.episodes.size(), hash_text(set).c_str());
  if (!left_out.empty())
    text += format(
        "left out, because they have no end: %zu episodes; the first is %llu. --keep-unfinished takes them\n",
        left_out.size(), left_out[0].get<unsigned long long>());
  return {{{"file", flags.to},
           {"rows", set.rows()},
           {"episodes", set.episodes.size()},
           {"left_out", left_out},
           {"hash", hash_text(set)}},
          text};
}

void add_data_convert(CLI::App& data, Run& run) {
  auto flags = std::make_shared<DataConvertFlags>();
  CLI::App* command =
      data.add_subcommand("convert", "Convert a data set between arrays (.npz) and MCAP (.mcap)");
  command->footer("redman data convert set.npz set.mcap");
  command->add_option("from", flags->from, "file to read: .npz or .mcap")->required();
  command->add_option("to", flags->to, "file to write: .npz or .mcap")->required();
  command->add_flag("--keep-unfinished", flags->keep_unfinished, "also take episodes without an end");
  command->callback([&run, flags] { run = [flags] { return run_data_convert(*flags); }; });
}

void add_data_make(CLI::App& data, Run& run) {
  auto flags = std::make_shared<DataMakeFlags>();
  flags->make.pool.task = "";
  CLI::App* command =
      data.add_subcommand("make", "Make a data set: a mixture of policies on both sides of the cost limit");
  command->footer("redman data make hand_over_safe_finger --rows 1e5 --out set.npz");
  add_task_flag(*command, flags->make.pool.task, "task,--task",
                "task, by name or by its file (.task), or a published set's name");
  command->add_option("--rows", flags->rows, "number of rows at least; the last episode is whole")
      ->check(between(1.0, 1e9));
  command
      ->add_option("--preset", flags->preset,
                   "dsrl: lengths and limits of the published set of this task; none")
      ->check(one_of({"none", "dsrl"}));
  command
      ->add_option(
          "--policy", flags->make.policies,
          "who plays: trained, a policy file, a run folder, demo or a .demo file; repeatable; default: "
          "trained, where there is one")
      ->allow_extra_args(false);
  command->add_option("--out", flags->out, "file to write (.npz); default: the task's or the set's name");
  command->add_option("--seed", flags->make.pool.seed, "seed of the worlds and of the noise");
  command->add_option("--threads", flags->make.pool.threads,
                      "number of threads; 0: the calling thread alone");
  command->add_flag("--list", flags->list, "list the published sets that can be made");
  add_set_flag(*command, flags->make.sets);
  command->callback([&run, flags] { run = [flags] { return run_data_make(*flags); }; });
}

void add_data_info(CLI::App& data, Run& run) {
  auto path = std::make_shared<std::string>();
  CLI::App* command =
      data.add_subcommand("info", "Say what a data set or a recording (.npz) holds, and its hash");
  command->footer("redman data info set.npz");
  command->add_option("file", *path, "file to read")->required();
  command->callback([&run, path] { run = [path] { return run_data_info(*path); }; });
}

}  // namespace

void add_data(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("data", "Make, describe and convert sets of episodes to learn from");
  command->require_subcommand(1);
  add_data_make(*command, run);
  add_data_info(*command, run);
  add_data_convert(*command, run);
}

}  // namespace tool
