// truth: the engine beside pencil and paper, and MuJoCo. Every row is one case: what it measures here, what
// is right, how near it must be. Deterministic; the exit status is 1 where a row is off, 2 for words that it
// does not know.
//   truth [--share] [--only WORD] [--jobs N] [--json | --markdown] [--page FILE]
//         [--skills TOOL POLICIES] [--times]
// --share takes the checks that together last less than a minute; --page compares the rows with those between
// the marks of a page; --skills adds the shipped policies at other substeps, minutes. Rows of the pending list
// (pending.cpp) may be off, and may not hold.
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <set>
#include <thread>

#include "table.hpp"

namespace truth {
namespace {

struct Words {
  bool share = false, json = false, markdown = false, times = false;
  std::string only, page, tool, policies;
  int jobs = 1;
};

const char* word(Verdict v) {
  switch (v) {
    case Verdict::kHeld:
      return "holds";
    case Verdict::kPending:
      return "pending";
    case Verdict::kHeldButPending:
      return "HOLDS: remove it from the pending list";
    default:
      return "OFF";
  }
}

std::string quoted(const std::string& s) {
  std::string out = "\"";
  for (const char c : s) {
    if (c == '"' || c == '\\') out += '\\';
    out += c == '\n' ? ' ' : c;
  }
  return out + "\"";
}

std::string number(double x) {
  return std::isfinite(x) ? text("%.9g", x) : "null";
}

std::string markdown_row(const Row& r) {
  const std::string unit = r.unit.empty() ? "" : " " + r.unit;
  return "| " + r.name + " | " + (r.note.empty() ? print(r.ours) + unit : "none") + " | " + print(r.exact) +
         unit + " | " + print(r.tolerance) + " | " + (r.mujoco.empty() ? "-" : r.mujoco) + " | " +
         word(verdict(r)) + " |";
}

void print_json(const std::vector<Row>& rows) {
  std::printf("[\n");
  for (size_t i = 0; i < rows.size(); ++i) {
    const Row& r = rows[i];
    std::printf(
        " {\"group\": %s, \"case\": %s, \"ours\": %s, \"exact\": %s, \"tolerance\": %s, \"unit\": %s, "
        "\"mujoco\": %s, \"verdict\": %s, \"note\": %s}%s\n",
        quoted(r.group).c_str(), quoted(r.name).c_str(), number(r.ours).c_str(), number(r.exact).c_str(),
        number(r.tolerance).c_str(), quoted(r.unit).c_str(), quoted(r.mujoco).c_str(),
        quoted(word(verdict(r))).c_str(), quoted(r.note).c_str(), i + 1 < rows.size() ? "," : "");
  }
  std::printf("]\n");
}

void print_markdown(const std::vector<Row>& rows) {
  std::string group;
  for (const Row& r : rows) {
    if (r.group != group) {
      std::printf(
          "%s**%s**\n\n| case | ours | exact | tolerance | MuJoCo is off by | verdict |\n"
          "|---|---|---|---|---|---|\n",
          group.empty() ? "" : "\n", r.group.c_str());
      group = r.group;
    }
    std::printf("%s\n", markdown_row(r).c_str());
  }
}

void print_plain(const std::vector<Row>& rows) {
  std::string group;
  for (const Row& r : rows) {
    if (r.group != group) std::printf("%s\n", r.group.c_str());
    group = r.group;
    std::printf("  %-8s %-72s ours %-11s exact %-9s tolerance %-9s %s %s%s%s\n",
                verdict(r) == Verdict::kHeldButPending ? "HOLDS" : word(verdict(r)), r.name.c_str(),
                print(r.ours).c_str(), print(r.exact).c_str(), print(r.tolerance).c_str(), r.unit.c_str(),
                r.mujoco.empty() ? "" : "MuJoCo: ", r.mujoco.c_str(),
                r.note.empty() ? "" : (" (" + r.note + ")").c_str());
  }
}

// Each row must be a line between the page's marks; where `all`, nothing else may be.
int differences(const std::vector<Row>& rows, const std::string& page, bool all) {
  std::ifstream file(page);
  std::set<std::string> lines;
  bool inside = false, marked = false;
  for (std::string line; std::getline(file, line);) {
    if (line == "<!-- end of truth -->") inside = false;
    if (inside && line.rfind("| ", 0) == 0 && line.rfind("| case |", 0) != 0) lines.insert(line);
    if (line == "<!-- truth -->") inside = marked = true;
  }
  if (!marked) {
    std::fprintf(stderr, "%s has no mark <!-- truth -->\n", page.c_str());
    return 1;
  }
  int found = 0;
  for (const Row& r : rows) {
    if (lines.erase(markdown_row(r)) > 0) continue;
    ++found;
    std::fprintf(stderr, "%s has not this row; bash cmake/truth_table.sh writes it:\n%s\n", page.c_str(),
                 markdown_row(r).c_str());
  }
  if (!all) return found;
  for (const std::string& line : lines) {
    ++found;
    std::fprintf(stderr, "%s has a row that is not the table's; bash cmake/truth_table.sh removes it:\n%s\n",
                 page.c_str(), line.c_str());
  }
  return found;
}

int run(const Words& words) {
  Checks all, checks;
  add_flight_and_spin(all);
  add_chains(all);
  add_friction(all);
  add_resting(all);
  add_tunnelling(all);
  add_mass_ratios(all);
  add_joints(all);
  add_drives(all);
  add_contact_laws(all);
  add_sleepers(all);
  add_ode(all);
  add_statics(all);
  add_convergence(all);
  if (!words.tool.empty()) add_skills(all, words.tool, words.policies);
  for (Check& c : all)
    if ((!words.share || c.share) && (c.group + "/" + c.name).find(words.only) != std::string::npos)
      checks.push_back(std::move(c));
  if (checks.empty()) {
    std::fprintf(stderr, "truth: no check has '%s' in its name\n", words.only.c_str());
    return 2;
  }

  std::vector<Rows> found;
  for (const Check& c : checks) found.emplace_back(c.group);
  std::vector<double> seconds(checks.size());
  std::atomic<size_t> next{0};
  const auto work = [&] {
    for (size_t i; (i = next++) < checks.size();) {
      const auto start = std::chrono::steady_clock::now();
      try {
        checks[i].run(found[i]);
      } catch (const std::exception& e) {
        found[i].fail(checks[i].name, e.what());
      }
      seconds[i] = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    }
  };
  std::vector<std::thread> helpers;
  for (int i = 1; i < words.jobs; ++i) helpers.emplace_back(work);
  work();
  for (std::thread& t : helpers) t.join();

  std::vector<Row> rows;
  std::set<std::string> names;
  int bad = 0;
  for (const Rows& r : found)
    for (const Row& row : r.all()) {
      rows.push_back(row);
      if (names.insert(row.name).second) continue;
      std::fprintf(stderr, "truth: two rows are called '%s'\n", row.name.c_str());
      ++bad;
    }
  if (words.json) {
    print_json(rows);
  } else if (words.markdown) {
    print_markdown(rows);
  } else {
    print_plain(rows);
  }
  if (words.times)
    for (size_t i = 0; i < checks.size(); ++i)
      std::fprintf(stderr, "%7.2f s %s/%s\n", seconds[i], checks[i].group.c_str(), checks[i].name.c_str());

  int held = 0, waiting = 0;
  for (const Row& r : rows) {
    const Verdict v = verdict(r);
    held += v == Verdict::kHeld;
    waiting += v == Verdict::kPending;
    if (v == Verdict::kHeld || v == Verdict::kPending) continue;
    ++bad;
    const std::string ours = r.note.empty() ? print(r.ours) + " " + r.unit : r.note;
    if (v == Verdict::kHeldButPending) {
      std::fprintf(stderr, "'%s' holds (%s): remove it from the pending list\n", r.name.c_str(),
                   ours.c_str());
    } else {
      std::fprintf(stderr, "'%s' is off: %s, not within %s of %s\n", r.name.c_str(), ours.c_str(),
                   print(r.tolerance).c_str(), print(r.exact).c_str());
    }
  }
  if (!words.share && words.only.empty() &&
      !words.tool.empty())  // a name that is no row's would wait for ever
    for (const std::string& name : pending_names()) {
      if (names.count(name) > 0) continue;
      std::fprintf(stderr, "'%s' of the pending list is no row: remove it from the pending list\n",
                   name.c_str());
      ++bad;
    }
  if (!words.page.empty()) {
    const bool all = !words.share && words.only.empty() && !words.tool.empty();
    bad += differences(rows, words.page, all);
  }
  std::fprintf(stderr, "%zu rows: %d hold, %d pending, %d wrong\n", rows.size(), held, waiting, bad);
  if (!words.json && !words.markdown) std::printf("%d passed, %d failed\n", held, bad);
  return bad > 0 ? 1 : 0;
}

}  // namespace
}  // namespace truth

int main(int argc, char** argv) {
  truth::Words words;
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    const int left = argc - 1 - i;
    if (a == "--share") {
      words.share = true;
    } else if (a == "--json") {
      words.json = true;
    } else if (a == "--markdown") {
      words.markdown = true;
    } else if (a == "--times") {
      words.times = true;
    } else if (a == "--only" && left > 0) {
      words.only = argv[++i];
    } else if (a == "--page" && left > 0) {
      words.page = argv[++i];
    } else if (a == "--jobs" && left > 0) {
      words.jobs = std::atoi(argv[++i]);
    } else if (a == "--skills" && left > 1) {
      words.tool = argv[++i];
      words.policies = argv[++i];
    } else {
      std::fprintf(stderr,
                   "usage: truth [--share] [--only WORD] [--jobs N] [--json | --markdown] [--page FILE] "
                   "[--skills TOOL POLICIES] [--times]\n");
      return 2;
    }
  }
  return truth::run(words);
}
