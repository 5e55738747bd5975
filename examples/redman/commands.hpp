// The subcommands. Each adds itself to the command line; when it is the one that was asked for, it leaves in
// `run` what main then calls.
#pragma once
#include <CLI/CLI.hpp>
#include <functional>

#include "common/report.hpp"

namespace tool {

using Run = std::function<Report()>;

void add_tasks(CLI::App& app, Run& run);
void add_algos(CLI::App& app, Run& run);
void add_train(CLI::App& app, Run& run);
void add_sweep(CLI::App& app, Run& run);
void add_data(CLI::App& app, Run& run);
void add_learn(CLI::App& app, Run& run);
void add_eval(CLI::App& app, Run& run);
void add_baseline(CLI::App& app, Run& run);
void add_rollout(CLI::App& app, Run& run);
void add_plan(CLI::App& app, Run& run);
void add_render(CLI::App& app, Run& run);
void add_view(CLI::App& app, Run& run);
void add_bench(CLI::App& app, Run& run);
void add_info(CLI::App& app, Run& run);
void add_export(CLI::App& app, Run& run);
void add_plot(CLI::App& app, Run& run);
void add_report(CLI::App& app, Run& run);
void add_compare(CLI::App& app, Run& run);
void add_hull(CLI::App& app, Run& run);
void add_robots(CLI::App& app, Run& run);
void add_robot(CLI::App& app, Run& run);
void add_objects(CLI::App& app, Run& run);
void add_object(CLI::App& app, Run& run);
void add_completion(CLI::App& app, Run& run);

}  // namespace tool
