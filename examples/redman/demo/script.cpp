// Reading the text of a demonstration.
#include "demo/script.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "common/names.hpp"
#include "common/setting.hpp"
#include "common/text.hpp"
#include "demo/hand.hpp"
#include "teach/settings.hpp"

namespace tool {
namespace {

constexpr double kMost = 1e6;  // of any number

// One line as words, and what is wrong with it.
class Line {
 public:
  Line(const std::string& file, int number, const std::string& text) : file_(file), number_(number) {
    std::istringstream in(text.substr(0, text.find('#')));
    for (std::string word; in >> word;) words_.push_back(word);
  }
  bool empty() const { return at_ >= words_.size(); }
  int number() const { return number_; }
  [[noreturn]] void bad(const std::string& what) const {
    throw Failure(format("demo %s, line %d: %s", file_.c_str(), number_, what.c_str()));
  }
  std::string word(const char* what) {
    if (empty()) bad(std::string("expected ") + what);
    return words_[at_++];
  }
  bool take(const char* word) {
    if (empty() || words_[at_] != word) return false;
    ++at_;
    return true;
  }
  double number(const char* what, bool* degrees = nullptr) {
    const std::string text = word(what);
    char* end = nullptr;
    const double v = std::strtod(text.c_str(), &end);
    const std::string unit = end;
    if (degrees) *degrees = unit == "deg";
    if (end == text.c_str() || !(std::abs(v) <= kMost) || (!unit.empty() && !(degrees && *degrees)))
      bad("'" + text + "' is not " + what);
    return v;
  }
  double number_from_zero(const char* what) {
    const double v = number(what);
    if (v < 0) bad("'" + words_[at_ - 1] + "' is negative: expected " + what);
    return v;
  }
  // Whether the next word is a number or begins like one; names begin otherwise.
  bool number_follows() const { return !empty() && std::strchr("+-.0123456789", words_[at_][0]) != nullptr; }
  void end() const {
    if (!empty()) bad("'" + words_[at_] + "' is one word too many");
  }

 private:
  std::string file_;
  int number_;
  std::vector<std::string> words_;
  size_t at_ = 0;
};

std::pair<std::string, std::string> read_pair(Line& line) {
  const std::string pair = line.word("key=value");
  const size_t equals = pair.find('=');
  if (equals == 0 || equals == std::string::npos) line.bad("'" + pair + "' is not key=value");
  return {pair.substr(0, equals), pair.substr(equals + 1)};
}

std::pair<std::string, std::string> read_teach(Line& line) {
  auto pair = read_pair(line);
  const TeachField* field = find_teach_field(pair.first);
  if (!field) line.bad("'" + pair.first + "' is not a setting of train --from that a demonstration can give");
  char* end = nullptr;
  const double v = std::strtod(pair.second.c_str(), &end);
  if (pair.second.empty() || *end || !(v >= field->least && v <= field->most) ||
      (field->whole && v != std::floor(v)))
    line.bad(format("%s=%s is not a %snumber of %g .. %g", field->name, pair.second.c_str(),
                    field->whole ? "whole " : "", field->least, field->most));
  return pair;
}

DemoScript::Condition read_condition(Line& line) {
  DemoScript::Condition c;
  c.line = line.number();
  c.field = line.word("an observation such as object.position[2]");
  const std::string sign = line.word("< or >");
  if (sign != "<" && sign != ">") line.bad("'" + sign + "' is neither < nor >");
  c.below = sign == "<";
  c.value = line.number("a number");
  return c;
}

// ENTRY = VALUE [at T] [over T], or ENTRY follows AIM [+|- NUMBER] by MEASURED gain K [limit M] [at T].
DemoScript::Command read_command(Line& line, const std::string& entry) {
  DemoScript::Command c;
  c.line = line.number();
  c.entry = entry;
  if (line.take("=")) {
    c.value = line.number("an action or an angle such as 30deg", &c.degrees);
  } else if (line.take("follows")) {
    c.follows = true;
    if (line.number_follows()) {
      c.value = line.number("a number");
    } else {
      c.aim = line.word("a number or an observation");
      if (line.take("+")) c.value = line.number("a number");
      if (line.take("-")) c.value = -line.number("a number");
    }
    if (!line.take("by")) line.bad("expected 'by' and the observation to steer");
    c.measured = line.word("an observation");
    if (!line.take("gain")) line.bad("expected 'gain' and a number");
    c.gain = line.number("a number");
    if (line.take("limit")) c.limit = line.number_from_zero("a bound");
  } else {
    line.bad("expected '=' or 'follows' after " + entry);
  }
  while (!line.empty()) {
    if (line.take("at"))
      c.at = line.number_from_zero("a time in s");
    else if (!c.follows && line.take("over"))
      c.over = line.number_from_zero("a time in s");
    else
      line.end();
  }
  return c;
}

// right.palm = X Y Z [turned RX RY RZ] [at T] [over T]
DemoScript::Motion read_motion(Line& line, const std::string& word, size_t dot) {
  DemoScript::Motion m;
  m.line = line.number();
  m.left = word.substr(0, dot) == "left";
  m.point = word.substr(dot + 1);
  if (!line.take("=")) line.bad("expected '=' after " + word);
  for (double& x : m.p) x = line.number("a place in m, x y z");
  while (!line.empty()) {
    if (line.take("turned")) {
      m.turned = true;
      for (double& x : m.turn) x = line.number("three rotations in degrees");
    } else if (line.take("at")) {
      m.at = line.number_from_zero("a time in s");
    } else if (line.take("over")) {
      m.over = line.number_from_zero("a time in s");
    } else {
      line.end();
    }
  }
  return m;
}

// The palm, or a fingertip, of one side; else it is an entry.
bool names_point(const std::string& word, size_t* dot) {
  *dot = word.find('.');
  const std::string side = word.substr(0, *dot);
  if (*dot == std::string::npos || (side != "right" && side != "left")) return false;
  const std::string point = word.substr(*dot + 1);
  return point == "palm" || (point.size() > 4 && point.substr(point.size() - 4) == "_tip");
}

// Scripts that the tool carries for a task.
std::vector<DemoScript> carried(const std::string& task) {
  std::vector<DemoScript> out;
  for (const CarriedDemo* c = kCarriedDemos; c->name; ++c) {
    if (!same_name(std::string(c->name).substr(0, task.size()), task)) continue;
    DemoScript script = parse_demo(c->text, std::strlen(c->text), c->name + std::string(".demo"));
    if (same_name(script.task, task)) out.push_back(std::move(script));
  }
  return out;
}

// Robots have a shorter name too.
bool same_value(const std::string& a, const std::string& b) {
  int32_t i = -1, k = -1;
  return same_name(a, b) || (!a.empty() && rdm_robot_find(a.c_str(), &i) == RDM_OK &&
                             rdm_robot_find(b.c_str(), &k) == RDM_OK && i == k);
}

bool holds(const Options& when, const Options& options) {
  return std::all_of(when.begin(), when.end(), [&](const auto& pair) {
    return same_value(option_of(options, pair.first), pair.second);
  });
}

}  // namespace

DemoScript parse_demo(const char* text, size_t size, const std::string& file) {
  if (size > kMostDemoBytes)
    throw Failure(format("demo %s: longer than %zu bytes", file.c_str(), kMostDemoBytes));
  DemoScript script;
  script.file = file;
  std::istringstream in(std::string(text, size));
  int number = 0;
  for (std::string row; std::getline(in, row);) {
    Line line(file, ++number, row);
    if (line.empty()) continue;
    const std::string word = line.word("a word");
    if (word == "task") {
      script.task = line.word("the task's name");
    } else if (word == "set" || word == "when") {
      script.options.push_back(read_pair(line));
      if (word == "when") script.when.push_back(script.options.back());
    } else if (word == "teach") {
      script.teach.push_back(read_teach(line));
    } else if (word == "learn") {
      script.learn.push_back(read_pair(line));
    } else if (word == "phase") {
      script.phases.emplace_back();
      script.phases.back().name = line.word("the phase's name");
    } else if (script.phases.empty()) {
      line.bad("'" + word + "' comes before the first phase");
    } else if (word == "for") {
      script.phases.back().seconds = line.number_from_zero("a time in s");
    } else if (word == "until") {
      script.phases.back().until.push_back(read_condition(line));
    } else if (size_t dot = 0; names_point(word, &dot)) {
      script.phases.back().motions.push_back(read_motion(line, word, dot));
    } else {
      script.phases.back().commands.push_back(read_command(line, word));
    }
    line.end();
  }
  if (script.task.empty()) throw Failure("demo " + file + ": it has no line 'task NAME'");
  if (script.phases.empty()) throw Failure("demo " + file + ": it has no phase");
  return script;
}

bool has_builtin_demo(const std::string& task) {
  return !carried(task_at(find_task(task)).name).empty();
}

DemoScript builtin_demo(const std::string& task, const Options& options) {
  const std::string name = task_at(find_task(task)).name;
  std::vector<DemoScript> scripts = carried(name);
  DemoScript* best = nullptr;
  for (DemoScript& script : scripts)
    if (holds(script.when, options) && (!best || script.when.size() > best->when.size())) best = &script;
  if (!best)
    throw Failure("policy demo: there is no demonstration of " + name + "; write one, and give its file");
  return std::move(*best);
}

}  // namespace tool
