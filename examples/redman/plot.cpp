// `plot`: learning curves of one or more run folders.
#include <algorithm>
#include <cmath>
#include <memory>

#include "commands.hpp"
#include "common/files.hpp"
#include "common/ownership.hpp"
#include "common/text.hpp"
#include "draw/svg.hpp"
#include "run/comparison.hpp"
#include "run/curves.hpp"
#include "run/run_data.hpp"

namespace tool {
namespace {

struct PlotFlags {
  std::vector<std::string> folders;
  std::string out = "plot.svg";
  bool out_given = false;
  bool each = false;
};

// Runs that share a line: seeds of one configuration.
struct Group {
  std::string label;
  std::vector<const RunData*> runs;
  size_t color = 0;
};

// Configurations as `report` tells them apart; with `each` a group for every run.
std::vector<Group> make_groups(const std::vector<const RunData*>& runs, bool each, bool with_limit) {
  std::vector<Group> groups;
  for (const Configuration& c : group_runs(runs)) {
    std::string label = c.label;
    if (with_limit && !c.limit_named && c.runs[0]->limit >= 0)
      label += ", limit " + number_text(c.runs[0]->limit);
    if (!each) groups.push_back({label, c.runs, groups.size()});
    for (size_t i = 0; each && i < c.runs.size(); ++i)
      groups.push_back({label + ", seed " + std::to_string(c.runs[i]->seed), {c.runs[i]}, groups.size()});
  }
  return groups;
}

// "ppo_lag (5 runs)", "ppo_lag (2 to 5 runs)" where it has more of one task than of another.
std::string legend_text(const std::string& label, size_t fewest, size_t most) {
  if (most == 1) return label;
  return label + (fewest == most ? format(" (%zu runs)", most) : format(" (%zu to %zu runs)", fewest, most));
}

Panel make_panel(const std::string& title, const std::string& column, const std::vector<Group>& groups,
                 bool share = false) {
  Panel panel;
  panel.title = title;
  panel.share = share;
  for (const Group& g : groups) panel.series.push_back(curve_of(g.runs, column, g.color));
  return panel;
}

// Runs of before a column was written have none.
bool has_numbers(const Panel& panel) {
  return std::any_of(panel.series.begin(), panel.series.end(), [](const Series& s) {
    return std::any_of(s.y.begin(), s.y.end(), [](double y) { return std::isfinite(y); });
  });
}

// A dashed line per limit: grey when all groups share it, else in the group's colour.
std::vector<Level> limit_levels(const std::vector<Group>& groups) {
  const double first = groups[0].runs[0]->limit;
  const bool shared =
      std::all_of(groups.begin(), groups.end(), [&](const Group& g) { return g.runs[0]->limit == first; });
  if (shared) return first >= 0 ? std::vector<Level>{{kGrey, first}} : std::vector<Level>{};
  std::vector<Level> levels;
  for (const Group& g : groups)
    if (g.runs[0]->limit >= 0) levels.push_back({g.color, g.runs[0]->limit});
  return levels;
}

struct Figure {
  std::string title;
  std::vector<Panel> panels;
  std::vector<LegendEntry> legend;
  size_t lines = 0;  // groups of runs
};

Figure chart_of_a_task(const std::vector<const RunData*>& runs, bool each) {
  const std::vector<Group> groups = make_groups(runs, each, true);
  Figure chart{runs[0]->task,
               {make_panel("Return of an episode", "Metrics/EpRet", groups),
                make_panel("Cost of an episode (dashed: limit)", "Metrics/EpCost", groups),
                make_panel("Lagrange multiplier", "Metrics/LagrangeMultiplier", groups),
                make_panel("Length of an episode, steps", "Metrics/EpLen", groups),
                make_panel("Episodes that end in a fall", "Metrics/FallRate", groups, true),
                make_panel("Episodes with success", "Metrics/SuccessRate", groups, true)},
               {},
               groups.size()};
  Panel violations = make_panel("Violating steps of an epoch", "Metrics/Violations", groups);
  if (has_numbers(violations)) chart.panels.push_back(std::move(violations));
  chart.panels[1].levels = limit_levels(groups);
  for (const Group& g : groups)
    chart.legend.push_back({g.color, legend_text(g.label, g.runs.size(), g.runs.size())});
  return chart;
}

// A row of panels for each task; a configuration has one colour in all of them.
Figure chart_of_tasks(const std::vector<std::vector<const RunData*>>& tasks, bool each) {
  struct Known {
    std::string label;
    size_t fewest, most;  // runs of it in one task
  };
  std::vector<Known> known;
  Figure chart{"Learning curves", {}, {}, 0};
  for (const auto& runs : tasks) {
    std::vector<Group> groups = make_groups(runs, each, false);
    for (Group& g : groups) {
      auto found =
          std::find_if(known.begin(), known.end(), [&](const Known& k) { return k.label == g.label; });
      if (found == known.end()) found = known.insert(known.end(), {g.label, g.runs.size(), g.runs.size()});
      found->fewest = std::min(found->fewest, g.runs.size());
      found->most = std::max(found->most, g.runs.size());
      g.color = static_cast<size_t>(found - known.begin());
    }
    chart.lines += groups.size();
    chart.panels.push_back(make_panel(runs[0]->task + ": return", "Metrics/EpRet", groups));
    chart.panels.push_back(make_panel("cost (dashed: limit)", "Metrics/EpCost", groups));
    chart.panels.back().levels = limit_levels(groups);
    chart.panels.push_back(make_panel("episodes with success", "Metrics/SuccessRate", groups, true));
  }
  for (const Known& k : known)
    chart.legend.push_back({chart.legend.size(), legend_text(k.label, k.fewest, k.most)});
  return chart;
}

Report run_plot(const PlotFlags& flags) {
  check_outputs({{"--out", flags.out, ".svg"}});
  if (!flags.out_given) check_default_output(flags.out, kChartMark, "--out");
  const std::vector<RunData> runs = read_runs(flags.folders);
  std::vector<std::vector<const RunData*>> tasks;
  for (const RunData& run : runs) {
    auto found = std::find_if(tasks.begin(), tasks.end(),
                              [&](const auto& others) { return others[0]->task == run.task; });
    if (found == tasks.end()) found = tasks.insert(tasks.end(), std::vector<const RunData*>());
    found->push_back(&run);
  }
  const Figure chart =
      tasks.size() == 1 ? chart_of_a_task(tasks[0], flags.each) : chart_of_tasks(tasks, flags.each);
  replace_file(flags.out, draw_chart(chart.title, chart.panels, 3, "control steps", chart.legend));
  return {{{"file", flags.out}, {"runs", runs.size()}, {"lines", chart.lines}}, "wrote " + flags.out + '\n'};
}

}  // namespace

void add_plot(CLI::App& app, Run& run) {
  auto flags = std::make_shared<PlotFlags>();
  CLI::App* command = app.add_subcommand("plot", "Draw the learning curves of run folders as SVG");
  command
      ->add_option(
          "folders", flags->folders,
          "run folders, or folders that hold some; seeds of one configuration are drawn as a mean with a "
          "band, each task as a row of panels")
      ->required();
  const CLI::Option* out = command->add_option("--out", flags->out, "SVG file to write; default: plot.svg");
  command->add_flag("--each", flags->each, "draw one line for every folder");
  command->callback([&run, flags, out] {
    flags->out_given = out->count() > 0;
    run = [flags] { return run_plot(*flags); };
  });
}

}  // namespace tool
