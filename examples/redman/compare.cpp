// `compare`: which algorithms can be told apart by the scores of their runs, in a table of one's own.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>

#include "commands.hpp"
#include "common/files.hpp"
#include "common/text.hpp"
#include "run/scores.hpp"

namespace tool {
namespace {

struct CompareFlags {
  std::string file;
  ScoreColumns columns{"algorithm", "", "return", {}};
  std::vector<std::string> where;
  bool less = false, markdown = false;
};

std::vector<Scored> read_scores(CompareFlags flags) {
  for (const std::string& where : flags.where) {
    const size_t equals = where.find('=');
    if (equals == std::string::npos) throw Usage("--where " + printable(where) + ": it is not column=text");
    flags.columns.where.emplace_back(where.substr(0, equals), where.substr(equals + 1));
  }
  const std::string text = read_file(flags.file);
  std::vector<Scored> scores;
  try {
    scores = parse_scores(text.data(), text.size(), flags.columns);
  } catch (const Failure& e) {
    throw Failure(flags.file + ": " + e.what());
  }
  // less is better: their order, not their signs, is what changes
  sort_scores(scores);
  if (flags.less) std::reverse(scores.begin(), scores.end());
  return scores;
}

// The intervals of the differences of each two rows, of which each takes as many draws as all else of a row.
class Differences {
 public:
  explicit Differences(const std::vector<Strata>& runs) : runs_(runs) {}
  const Interval& operator()(size_t i, size_t j) {
    const auto [at, first] = found_.try_emplace({i, j});
    if (first) at->second = difference_interval(runs_[i], runs_[j]);
    return at->second;
  }

 private:
  const std::vector<Strata>& runs_;
  std::map<std::pair<size_t, size_t>, Interval> found_;
};

Json pairs_json(const std::vector<Scored>& scores, bool less, Differences& differences) {
  Json pairs = Json::array();
  if (scores.size() > kMostGrouped) return pairs;
  for (size_t i = 0; i < scores.size(); ++i)
    for (size_t j = i + 1; j < scores.size(); ++j) {
      const Strata &a = scores[less ? j : i].runs, &b = scores[less ? i : j].runs;
      const Improvement better = improvement_of(a, b);
      pairs.push_back({{"better", scores[i].name},
                       {"than", scores[j].name},
                       {"probability", better.probability},
                       {"interval", interval_json(better.interval)},
                       {"difference", iqm_of(scores[i].runs) - iqm_of(scores[j].runs)},
                       {"difference_interval", interval_json(differences(i, j))}});
    }
  return pairs;
}

Report run_compare(const CompareFlags& flags) {
  const std::vector<Scored> scores = read_scores(flags);
  std::vector<Strata> runs;
  for (const Scored& s : scores) runs.push_back(s.runs);
  Differences differences(runs);
  const std::vector<std::string> groups = group_letters(runs, std::ref(differences));
  Json rows = Json::array();
  Table table({flags.columns.of, "runs", "mean", "sd", "IQM", "95% interval of it", "group"});
  size_t fewest = SIZE_MAX;
  for (size_t i = 0; i < scores.size(); ++i) {
    Sample all;
    for (const Sample& task : scores[i].runs) {
      all.insert(all.end(), task.begin(), task.end());
      fewest = std::min(fewest, task.size());
    }
    const Interval interval = iqm_interval(scores[i].runs);
    rows.push_back({{"name", scores[i].name},
                    {"runs", all.size()},
                    {"mean", mean_of(all)},
                    {"sd", deviation_of(all)},
                    {"iqm", iqm_of(all)},
                    {"interval", interval_json(interval)},
                    {"group", groups[i]}});
    table.add({flags.markdown ? '`' + scores[i].name + '`' : scores[i].name, std::to_string(all.size()),
               format("%.4g", mean_of(all)), all.size() > 1 ? format("%.3g", deviation_of(all)) : "-",
               format("%.4g", iqm_of(all)), interval_text(interval), groups[i].empty() ? "-" : groups[i]});
  }
  Json remarks = Json::array();
  if (fewest < 2)
    remarks.push_back("one run has no interval and no group");
  else if (fewest * scores[0].runs.size() < kFewRuns)
    remarks.push_back(format("intervals of fewer than %zu runs are too narrow", kFewRuns));
  std::string text = flags.markdown ? table.markdown() : table.text();
  if (!flags.markdown)
    for (const Json& remark : remarks) text += remark.get<std::string>() + '\n';
  return {{{"value", flags.columns.value},
           {"tasks", scores[0].runs.size()},
           {"interval_level", kLevel},
           {"rows", rows},
           {"pairs", pairs_json(scores, flags.less, differences)},
           {"remarks", remarks}},
          text};
}

}  // namespace

void add_compare(CLI::App& app, Run& run) {
  auto flags = std::make_shared<CompareFlags>();
  CLI::App* command = app.add_subcommand("compare",
                                         "Compare algorithms by the scores of their runs: interquartile "
                                         "means with intervals, and groups that do not differ significantly");
  command->add_option("file", flags->file, "CSV file: a header line, then one line for each run")->required();
  command->add_option("--of", flags->columns.of, "column whose values are compared")->type_name("COLUMN");
  command
      ->add_option("--over", flags->columns.over,
                   "column of the tasks; their scores must be on one scale; none: all runs are of one task")
      ->type_name("COLUMN");
  command->add_option("--value", flags->columns.value, "column that holds the scores")->type_name("COLUMN");
  command->add_option("--where", flags->where, "use only lines with this text in the column; repeatable")
      ->allow_extra_args(false)
      ->type_name("COLUMN=TEXT");
  command->add_flag("--less", flags->less, "a smaller score is better");
  command->add_flag("--markdown", flags->markdown, "print a Markdown table");
  command->callback([&run, flags] { run = [flags] { return run_compare(*flags); }; });
}

}  // namespace tool
