#include "run/scores.hpp"

#include <algorithm>

#include "common/names.hpp"
#include "common/numbers.hpp"
#include "common/report.hpp"
#include "common/text.hpp"

namespace tool {
namespace {

constexpr size_t kMostCells = 1000;

size_t column_at(const std::vector<std::string>& header, const std::string& name) {
  const auto found = std::find(header.begin(), header.end(), name);
  if (found == header.end()) throw Failure("there is no column " + name + nearest_hint(name, header));
  return static_cast<size_t>(found - header.begin());
}

// The place of a text in a list, to which a new one is added.
size_t place_of(const std::string& text, std::vector<std::string>& list) {
  const auto found = std::find(list.begin(), list.end(), text);
  if (found != list.end()) return static_cast<size_t>(found - list.begin());
  list.push_back(text);
  return list.size() - 1;
}

}  // namespace

std::vector<Scored> parse_scores(const char* text, size_t size, const ScoreColumns& columns) {
  std::vector<std::string> header, tasks, names;
  std::vector<std::pair<size_t, std::string>> where;
  size_t of = 0, over = 0, value = 0;
  std::vector<Scored> out;
  size_t line = 0;
  for (size_t at = 0; at < size;) {
    const auto* end = std::find(text + at, text + size, '\n');
    std::string row(text + at, end);
    at = static_cast<size_t>(end - text) + 1;
    ++line;
    if (!row.empty() && row.back() == '\r') row.pop_back();
    if (row.empty()) continue;
    if (row.find('"') != std::string::npos) throw Failure("line " + std::to_string(line) + " has quotes");
    const std::vector<std::string> cells = cells_of(row, kMostCells);
    if (header.empty()) {
      header = cells;
      of = column_at(header, columns.of);
      value = column_at(header, columns.value);
      if (!columns.over.empty()) over = column_at(header, columns.over);
      for (const auto& [name, wanted] : columns.where) where.emplace_back(column_at(header, name), wanted);
      continue;
    }
    // what an older writer left out at the end is empty
    const auto cell = [&](size_t k) { return k < cells.size() ? cells[k] : std::string(); };
    if (std::any_of(where.begin(), where.end(), [&](const auto& w) { return cell(w.first) != w.second; }))
      continue;
    double score = 0;
    if (!read_number(cell(value), &score))
      throw Failure("line " + std::to_string(line) + ", column " + columns.value + ": '" +
                    printable(cell(value)) +
                    "' is not a number: leave the run out, or give it the score of a failure");
    const size_t name = place_of(cell(of), names);
    const size_t task = place_of(columns.over.empty() ? "" : cell(over), tasks);
    if (name == out.size()) out.push_back({cell(of), {}});
    if (out[name].runs.size() <= task) out[name].runs.resize(task + 1);
    out[name].runs[task].push_back(score);
  }
  if (out.empty()) throw Failure("no run matches");
  for (const Scored& s : out)
    for (size_t t = 0; t < tasks.size(); ++t)
      if (t >= s.runs.size() || s.runs[t].empty())
        throw Failure(printable(s.name) + " has no run of " + printable(tasks[t]) + ", which others have");
  return out;
}

void sort_scores(std::vector<Scored>& scores) {
  std::stable_sort(scores.begin(), scores.end(),
                   [](const Scored& a, const Scored& b) { return iqm_of(a.runs) > iqm_of(b.runs); });
}

}  // namespace tool
