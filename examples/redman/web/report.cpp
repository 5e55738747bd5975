#include "web/report.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "common/report.hpp"
#include "common/text.hpp"
#include "run/curves.hpp"
#include "web/page.hpp"

namespace tool {
namespace {

constexpr size_t kPoints = 300;  // of a line; the page is to be small

double short_number(double v) {
  return std::strtod(format("%.5g", v).c_str(), nullptr);
}

// Four digits, and none behind the point of what is large.
std::string short_text(double v) {
  return std::abs(v) >= 1000 ? format("%.0f", v) : format("%.4g", v);
}

// Mean and deviation of value(item): "12.3 &plusmn; 0.4".
template <class Items, class Value>
std::string mean_and_error(const Items& items, Value value) {
  Sample values;
  for (const auto& i : items) values.push_back(value(i));
  std::string out = short_text(mean_of(values));
  if (values.size() > 1) out += " <small>&plusmn; " + error_text(deviation_of(values)) + "</small>";
  return out;
}

std::string per_cent(double share) {
  return format("%.0f %%", 100 * share);
}

std::string cell(const std::string& html, const char* kind = "number") {
  return format("<td class=\"%s\">", kind) + html + "</td>";
}

std::string chip(size_t color) {
  return format("<i class=\"chip\" style=\"--c:%s\" data-c=\"%zu\"></i>", palette_color(color), color);
}

std::string duration(double seconds) {
  if (seconds < 90) return format("%.0f s", seconds);
  if (seconds < 5400) return format("%.0f min", seconds / 60);
  return format("%.1f h", seconds / 3600);
}

std::string rank_row(const Configuration& c, const std::string& group) {
  const Outcome mean = c.mean();
  const auto good = static_cast<size_t>(std::count_if(c.outcomes.begin(), c.outcomes.end(),
                                                      [](const Outcome& o) { return o.score().feasible; }));
  const bool feasible = mean.score().feasible;
  std::vector<TrainingEnd> ends;
  for (const RunData* run : c.runs) ends.push_back(training_end(*run));
  std::string out = feasible ? "<tr>" : "<tr class=\"over\">";
  out += cell(group, "name") + cell(chip(c.color) + html_text(c.label), "name");
  out += cell(format("<b class=\"%s\">%s</b> <small>%zu of %zu</small>", feasible ? "yes" : "no",
                     feasible ? "within" : "over", good, c.runs.size()),
              "state");
  out += cell(mean_and_error(c.outcomes, [](const Outcome& o) { return o.ret; }));
  for (size_t k = 0; k < mean.costs.size(); ++k) {
    const CostOutcome& cost = mean.costs[k];
    if (k > 0 && cost.limit < 0) continue;
    const std::string value = mean_and_error(
        c.outcomes, [k](const Outcome& o) { return k < o.costs.size() ? o.costs[k].mean : 0; });
    out += cell(value + (cost.limit < 0 ? "" : format(" <small>/ %.4g</small>", cost.limit)),
                cost.limit >= 0 && cost.mean > cost.limit ? "number bad" : "number");
  }
  out += cell(per_cent(mean.success)) + cell(per_cent(mean.falls)) + cell(format("%.0f", mean.length));
  out += cell(mean_and_error(ends, [](const TrainingEnd& e) { return e.ret; }) + " @ " +
              mean_and_error(ends, [](const TrainingEnd& e) { return e.cost; }));
  double over = 0;
  for (const TrainingEnd& e : ends) over += e.over / static_cast<double>(ends.size());
  out += cell(per_cent(over));
  double steps = 0, seconds = 0;
  for (const TrainingEnd& e : ends) {
    steps = std::max(steps, e.steps);
    seconds += e.seconds / static_cast<double>(ends.size());
  }
  return out + cell(short_count(steps)) + cell(duration(seconds)) + "</tr>\n";
}

std::string ranking(const TaskReport& t) {
  std::string costs;
  const std::vector<CostOutcome> columns = t.configurations[0].mean().costs;
  for (size_t k = 0; k < columns.size(); ++k)
    if (k == 0 || columns[k].limit >= 0) costs += "<th>" + html_text(columns[k].name) + " / limit</th>";
  std::string out =
      "<div class=\"wide\"><table "
      "class=\"ranking\"><thead><tr><th>group</th><th>configuration</th><th>limits</th><th>return</th>" +
      costs +
      "<th>success</th><th>falls</th><th>length</th><th>training, last tenth</th><th>epochs over</th>"
      "<th>steps</th><th>time</th></tr></thead><tbody>\n";
  for (size_t i = 0; i < t.configurations.size(); ++i) out += rank_row(t.configurations[i], t.seeds[i].group);
  out += "</tbody></table></div>\n";
  const bool all = std::all_of(t.configurations.begin(), t.configurations.end(),
                               [](const Configuration& c) { return c.mean().evaluated; });
  out += "<p class=\"hint\">Within the limits first, then by return. ";
  out +=
      all ? format("The policy that each run kept, on its mean action, over %d fresh episodes", t.episodes)
          : std::string(
                "Means over the last tenth of training, exploration included, where a run was not evaluated");
  return out +
         "; &plusmn; is the standard deviation over seeds. <q>2 of 3</q>: so many seeds are within. "
         "Training: "
         "return @ cost with exploration, and the share of epochs over a limit. Rows that share a letter are "
         "not "
         "told apart by their returns: the 95 % interval of the difference of their interquartile means "
         "holds 0, "
         "each pair for itself.</p>\n";
}

std::string number_or_dash(double v) {
  return std::isfinite(v) ? short_text(v) : "&ndash;";
}

std::string seeds_table(const TaskReport& t) {
  const std::vector<CostOutcome> columns = t.configurations[0].mean().costs;
  const bool normalised = std::any_of(t.seeds.begin(), t.seeds.end(),
                                      [](const Seeds& s) { return std::isfinite(s.normalised_return); });
  std::string out =
      "<h3>Over seeds</h3>\n<div class=\"wide\"><table><thead><tr><th>configuration</th><th>seeds</th>"
      "<th>return</th><th>sd</th><th>IQM</th><th>95 % interval</th>";
  if (normalised) out += "<th>of PPO&rsquo;s return</th>";
  for (const CostOutcome& c : columns)
    if (c.limit > 0) out += "<th>" + html_text(c.name) + " of its limit</th>";
  out += "<th>cost per step, all training</th><th>violating steps, all training</th></tr></thead><tbody>\n";
  size_t fewest = SIZE_MAX;
  for (size_t i = 0; i < t.seeds.size(); ++i) {
    const Seeds& s = t.seeds[i];
    const Configuration& c = t.configurations[i];
    fewest = std::min(fewest, c.runs.size());
    out += "<tr>" + cell(chip(c.color) + html_text(c.label), "name") + cell(std::to_string(c.runs.size())) +
           cell(short_text(s.return_mean)) + cell(number_or_dash(s.return_sd)) +
           cell(short_text(s.return_iqm)) +
           cell(s.return_interval.known() ? interval_text(s.return_interval) : "&ndash;");
    if (normalised) out += cell(number_or_dash(s.normalised_return));
    for (size_t k = 0; k < columns.size(); ++k)
      if (columns[k].limit > 0)
        out += cell(k < s.cost_ratio.size() ? number_or_dash(s.cost_ratio[k]) : "&ndash;");
    out += cell(number_or_dash(s.training_cost_rate)) + cell(number_or_dash(s.training_violating_steps)) +
           "</tr>\n";
  }
  out +=
      "</tbody></table></div>\n<p class=\"hint\">IQM: the interquartile mean of the runs&rsquo; returns, "
      "with the "
      "interval of a bootstrap over runs";
  if (fewest < kFewRuns)
    out += format(", which is too narrow for fewer than %zu of them and is none for one", kFewRuns);
  return out +
         ". Costs of training are column 0 with exploration, violating steps those in which it or a limited "
         "cost "
         "was above 0; &ndash;: not measured.</p>\n";
}

struct Chart {
  std::string column, title;
  std::string limit;  // name of the cost that it shows
  bool share, main;
};

std::vector<Chart> charts_of(const TaskReport& t) {
  std::vector<Chart> out = {{"Metrics/EpRet", "Return of an episode", "", false, true}};
  const std::vector<CostOutcome> costs = t.configurations[0].mean().costs;
  for (size_t k = 0; k < costs.size(); ++k) {
    const std::string tail = k == 0 ? "" : '/' + costs[k].name;
    out.push_back({"Metrics/EpCost" + tail, k == 0 ? "Cost of an episode" : "Cost: " + costs[k].name,
                   costs[k].name, false, k == 0 || costs[k].limit >= 0});
  }
  out.push_back({"Metrics/Violations", "Violating steps of an epoch", "", false, true});
  out.push_back({"Metrics/SuccessRate", "Episodes with success", "", true, true});
  out.push_back({"Metrics/FallRate", "Episodes that end in a fall", "", true, false});
  out.push_back({"Metrics/EpLen", "Length of an episode, steps", "", false, false});
  for (size_t k = 0; k < costs.size(); ++k) {
    const std::string tail = k == 0 ? "" : '/' + costs[k].name;
    out.push_back({"Metrics/LagrangeMultiplier" + tail, "Multiplier" + (k == 0 ? "" : ": " + costs[k].name),
                   "", false, false});
  }
  const std::pair<const char*, const char*> others[] = {
      {"Metrics/TestEpRet", "Return on the mean action"},
      {"Metrics/TestEpCost", "Cost on the mean action"},
      {"Train/KL", "KL of an update"},
      {"Train/LR", "Learning rate"},
      {"Train/PolicyStd", "Deviation of actions"},
      {"Train/Entropy", "Entropy"},
      {"Train/ClipFraction", "Clipped samples"},
      {"Loss/Loss_reward_critic", "Loss of the reward critic"},
      {"Loss/Loss_cost_critic", "Loss of the cost critic"},
      {"Shield/Refused", "Decisions that the shield refused"},
      {"Shield/Unproven", "Decisions in which nothing was known to be clean"},
      {"Shield/Inevitable", "Violating steps of these decisions"},
      {"Time/FPS", "Control steps per second"}};
  for (const auto& [column, title] : others) out.push_back({column, title, "", false, false});
  return out;
}

Panel panel_of(const TaskReport& t, const Chart& chart) {
  Panel panel;
  panel.title = chart.title;
  panel.share = chart.share;
  std::vector<Level> levels;
  for (const Configuration& c : t.configurations) {
    panel.series.push_back(curve_of(c.runs, chart.column, c.color, kPoints));
    for (const CostOutcome& cost : c.outcomes[0].costs)
      if (!chart.limit.empty() && cost.name == chart.limit && cost.limit >= 0)
        levels.push_back({c.color, cost.limit});
  }
  const bool shared =
      std::all_of(levels.begin(), levels.end(), [&](const Level& l) { return l.y == levels[0].y; });
  if (!levels.empty()) panel.levels = shared ? std::vector<Level>{{kGrey, levels[0].y}} : levels;
  return panel;
}

// A line that is 0 wherever it is a number says nothing.
bool says_something(const Panel& panel) {
  if (!panel.levels.empty()) return true;
  for (const Series& s : panel.series)
    for (const double y : s.y)
      if (std::isfinite(y) && y != 0) return true;
  return false;
}

// x and y of each line, for the readout under the pointer.
Json readings(const Panel& panel) {
  Json out = Json::array();
  for (const Series& s : panel.series) {
    Json x = Json::array(), y = Json::array();
    for (size_t i = 0; i < s.y.size(); ++i) {
      if (!std::isfinite(s.y[i])) continue;
      x.push_back(short_number(s.x[i]));
      y.push_back(short_number(s.y[i]));
    }
    out.push_back({{"c", s.color}, {"x", x}, {"y", y}});
  }
  return out;
}

std::string curves(const TaskReport& t, Json& data) {
  std::string legend = "<p class=\"legend\">", main, others;
  for (const Configuration& c : t.configurations)
    legend += format("<button data-c=\"%zu\" aria-pressed=\"true\">", c.color) + chip(c.color) +
              html_text(c.label) +
              (c.runs.size() > 1 ? format(" <small>%zu seeds</small>", c.runs.size()) : "") + "</button> ";
  for (const Chart& chart : charts_of(t)) {
    const Panel panel = panel_of(t, chart);
    if (!says_something(panel)) continue;
    (chart.main ? main : others) += format("<figure data-panel=\"%zu\">", data["panels"].size()) +
                                    draw_panel(panel, "control steps") + "</figure>\n";
    data["panels"].push_back({{"share", chart.share}, {"lines", readings(panel)}});
  }
  return legend + "</p>\n<div class=\"charts\">" + main +
         "</div>\n<details><summary>More curves</summary><div class=\"charts\">" + others +
         "</div></details>\n";
}

std::string differences_table(const TaskReport& t) {
  const std::vector<Difference> list = differences(t.configurations);
  if (list.empty()) return "";
  std::string out =
      "<h3>What the configurations differ in</h3>\n<div class=\"wide\"><table><thead><tr><th>setting</th>";
  for (const Configuration& c : t.configurations)
    out += "<th>" + chip(c.color) + html_text(c.label) + "</th>";
  out += "</tr></thead><tbody>\n";
  for (const Difference& d : list) {
    out += "<tr>" + cell(html_text(d.key), "name");
    for (const std::string& v : d.values) out += cell(v.empty() ? "&ndash;" : html_text(v));
    out += "</tr>\n";
  }
  return out + "</tbody></table></div>\n";
}

std::string runs_table(const TaskReport& t) {
  std::string out =
      "<details><summary>Every run</summary><div "
      "class=\"wide\"><table><thead><tr><th>run</th><th>seed</th><th>limits</th>"
      "<th>return</th><th>cost</th><th>success</th><th>length</th><th>steps</th><th>time</th></tr></"
      "thead><tbody>\n";
  for (const Configuration& c : t.configurations)
    for (size_t i = 0; i < c.runs.size(); ++i) {
      const Outcome& o = c.outcomes[i];
      const TrainingEnd end = training_end(*c.runs[i]);
      const bool good = o.score().feasible;
      out += "<tr>" + cell(chip(c.color) + html_text(c.runs[i]->path), "name") +
             cell(std::to_string(c.runs[i]->seed)) +
             cell(good ? "<b class=\"yes\">within</b>" : "<b class=\"no\">over</b>", "state") +
             cell(format("%.4g", o.ret)) + cell(o.costs.empty() ? "" : format("%.4g", o.costs[0].mean)) +
             cell(per_cent(o.success)) + cell(format("%.0f", o.length)) + cell(short_count(end.steps)) +
             cell(duration(end.seconds)) + "</tr>\n";
    }
  return out + "</tbody></table></div></details>\n";
}

std::string common_settings(const TaskReport& t) {
  const std::vector<Difference> list = differences(t.configurations);
  std::string out = "<details><summary>What they share</summary><p class=\"settings\">";
  for (const auto& [key, value] : t.configurations[0].runs[0]->config) {
    const auto differs =
        std::any_of(list.begin(), list.end(), [&k = key](const Difference& d) { return d.key == k; });
    if (!differs && !value.empty())
      out += "<span>" + html_text(key) + " <b>" + html_text(value) + "</b></span> ";
  }
  return out + "</p></details>\n";
}

std::string strips(const TaskReport& t) {
  std::string out;
  for (size_t i = 0; i < t.strips.size(); ++i) {
    if (t.strips[i].png.empty()) continue;
    const Configuration& c = t.configurations[i];
    out += "<figure class=\"strip\"><figcaption>" + chip(c.color) + html_text(c.label + t.strips[i].caption) +
           "</figcaption><img alt=\"" + html_text("moments of an episode of " + c.label) +
           "\" src=\"data:image/png;base64," + base64(t.strips[i].png.data(), t.strips[i].png.size()) +
           "\"></figure>\n";
  }
  return out.empty() ? "" : "<h3>An episode of each</h3>\n" + out;
}

}  // namespace

std::string report_page(const std::vector<TaskReport>& tasks) {
  Json data = {{"panels", Json::array()}};
  std::string body, names;
  size_t runs = 0;
  for (const TaskReport& t : tasks) {
    for (const Configuration& c : t.configurations) runs += c.runs.size();
    names += (names.empty() ? "" : ", ") + t.task;
    body += "<section>\n<h2>" + html_text(t.task) + " <small>" + html_text(t.summary) + "</small></h2>\n" +
            ranking(t) + seeds_table(t);
    for (const std::string& note : t.notes) body += "<p class=\"note\">" + html_text(note) + "</p>\n";
    body += strips(t) + "<h3>Learning curves</h3>\n" + curves(t, data) + differences_table(t) +
            runs_table(t) + common_settings(t) + "</section>\n";
  }
  return filled_page("report.html", {{"title", html_text("Runs: " + names)},
                                     {"about", format("%zu runs", runs)},
                                     {"body", body},
                                     {"data", script_json(json_text(data))}});
}

}  // namespace tool
