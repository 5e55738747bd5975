// The quality table: every experiment of quality_*.hpp in every column, as one JSON document
// {"columns": {...}, "experiments": {experiment: {row: {column: number or null}}}}.
//   bench_quality [experiment or column]...      all of both by default
// null: the engine is not in this build, the column is no judge of this experiment, or the world diverged.
#include <cstdio>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "base/error.hpp"
#include "quality_arm.hpp"
#include "quality_grasp.hpp"
#include "quality_towers.hpp"

namespace {
using namespace rdm;
using namespace rdm::test;

struct Row {
  std::string name;
  double value;
};
using Rows = std::vector<Row>;

struct Experiment {
  const char* name;
  std::function<std::optional<Rows>(const Column&)> run;
};

// An experiment whose rows need no other column.
template <class R, class Run>
Experiment absolute(const char* name, Run run, Rows (*rows)(const R&)) {
  return {name, [=](const Column& column) -> std::optional<Rows> { return rows(run(column)); }};
}

// One whose rows compare with the reference, which is run once, for the first column that asks.
template <class R, class Run>
Experiment compared(const char* name, Run run, Rows (*rows)(const R&, const R&)) {
  const auto reference = std::make_shared<std::optional<R>>();
  return {name, [=](const Column& column) -> std::optional<Rows> {
            if (column.reference) {
              *reference = run(column);
              return rows(**reference, **reference);
            }
            const R result = run(column);
            if (!*reference) *reference = run(reference_column());
            return rows(result, **reference);
          }};
}

// One that asks more of ODE's exact solver than it can do.
template <class R, class Run>
Experiment piled(const char* name, Run run, Rows (*rows)(const R&)) {
  return {name, [=](const Column& column) -> std::optional<Rows> {
            if (column.solver.exact) return std::nullopt;
            return rows(run(column));
          }};
}

// One of which only the articulated engine knows: bodies fall asleep.
template <class R, class Run>
Experiment sleeping(const char* name, Run run, Rows (*rows)(const R&)) {
  return {name, [=](Column column) -> std::optional<Rows> {
            if (column.engine != EngineKind::kArticulated) return std::nullopt;
            column.solver.sleep_time = 0.25;
            return rows(run(column));
          }};
}

Rows sag_rows(const Sag& s, const Sag& r) {
  return {{"wrist_rad", s.joint[0]},
          {"wrist_ratio", s.joint[0] / r.joint[0]},
          {"proximal_ratio", s.joint[1] / r.joint[1]},
          {"middle_ratio", s.joint[2] / r.joint[2]},
          {"distal_ratio", s.joint[3] / r.joint[3]}};
}

Rows rest_rows(const Rest& s, const Rest& r) {
  return {{"sag_ratio", s.sag / r.sag}, {"jitter_m_s", s.jitter}, {"drift_mm", 1e3 * s.drift}};
}

Rows throw_rows(const Throw& s, const Throw& r) {
  double speed = 0, speed_bias = 0, speed_square = 0, apex = 0, apex_bias = 0, apex_square = 0;
  for (int i = 0; i < Throw::kStarts; ++i) {
    const double dv = s.speed[i] - r.speed[i], dz = s.apex[i] - r.apex[i];
    speed += s.speed[i] / Throw::kStarts;
    speed_bias += dv / Throw::kStarts;
    speed_square += dv * dv / Throw::kStarts;
    apex += s.apex[i] / Throw::kStarts;
    apex_bias += dz / Throw::kStarts;
    apex_square += dz * dz / Throw::kStarts;
  }
  return {{"speed_m_s", speed},
          {"speed_bias_m_s", speed_bias},
          {"speed_rms_m_s", std::sqrt(speed_square)},
          {"apex_m", apex},
          {"apex_bias_mm", 1e3 * apex_bias},
          {"apex_rms_mm", 1e3 * std::sqrt(apex_square)},
          {"wrist_rate_rad_s", s.wrist_rate}};
}

double rms_error(const Flick& s, const Flick& r, int joint) {
  double sum = 0;
  for (int k = 0; k < Flick::kTicks; ++k) sum += square(s.angle[k][joint] - r.angle[k][joint]);
  return std::sqrt(sum / Flick::kTicks);
}
Rows flick_rows(const Flick& s, const Flick& r) {
  return {{"wrist_rms_rad", rms_error(s, r, 0)},  {"proximal_rms_rad", rms_error(s, r, 1)},
          {"middle_rms_rad", rms_error(s, r, 2)}, {"distal_rms_rad", rms_error(s, r, 3)},
          {"wrist_rate_rad_s", s.wrist_rate},     {"proximal_rate_rad_s", s.finger_rate}};
}

Rows reach_rows(const Reach& s, const Reach& r) {
  return {{"arm_rms", rms_error(s, r, 0, kArmLinks)},
          {"hand_rms_rad", rms_error(s, r, kArmLinks, kArmHandLinks)}};
}

Rows limits_rows(const Limits& s) {
  return {
      {"pushed_rad", s.worst}, {"steady_rad", s.steady}, {"wrist_rad", s.wrist}, {"impact_rad", s.impact}};
}

Rows squeeze_rows(const Squeeze& s) {
  return {{"median_mm", 1e3 * quantile(s.depth, 0.5)},
          {"p99_mm", 1e3 * quantile(s.depth, 0.99)},
          {"max_mm", 1e3 * quantile(s.depth, 1)},
          {"held", 1.0 * s.held},
          {"starts", 1.0 * s.starts},
          {"ball_speed_m_s", s.ball_speed},
          {"joint_rate_rad_s", s.joint_rate},
          {"contacts", s.contacts}};
}

double rms_error(const Swing& s, const Swing& r, int mark) {
  double sum = 0;
  for (int i = 0; i < kHandLinks; ++i)
    sum += square(std::remainder(s.angle[mark][i] - r.angle[mark][i], 2 * kPi));
  return std::sqrt(sum / kHandLinks);
}
Rows swing_rows(const Swing& s, const Swing& r) {
  return {{"gain_at_0.25_J", s.gain[0]},
          {"gain_at_0.5_J", s.gain[1]},
          {"gain_at_1_J", s.gain[2]},
          {"kinetic_at_1_J", s.kinetic},
          {"rms_at_0.25_rad", rms_error(s, r, 0)},
          {"rms_at_0.5_rad", rms_error(s, r, 1)}};
}

Rows crash_rows(const Crash& s) {
  return {{"linear_error", s.linear},
          {"angular_error", s.angular},
          {"kinetic_share", s.kinetic},
          {"touching_steps", 1.0 * s.touching}};
}

Rows hinge_rows(const Hinge& s) {
  return {{"period_ratio", s.period}, {"amplitude_ratio", s.amplitude}, {"spin_ratio", s.spin}};
}

Rows fall_rows(const Fall& s) {
  return {{"way_ratio", s.way}, {"rebound_mm", 1e3 * s.rebound}};
}

Rows incline_rows(const Incline& s) {
  return {{"least_ratio", s.least}, {"most_ratio", s.most}};
}

Rows slide_rows(const Slide& s) {
  return {{"least_ratio", s.least}, {"most_ratio", s.most}, {"aside", s.aside}};
}

Rows roll_rows(const Roll& s) {
  return {{"speed_ratio", s.speed}, {"spin_ratio", s.spin}};
}

Rows pile_rows(const Pile& s) {
  return {{"motion_mm", 1e3 * s.motion},        {"rms_speed_m_s", s.speed},
          {"depth_mm", 1e3 * s.depth},          {"contacts", s.contacts},
          {"overflow", s.overflow ? 1.0 : 0.0}, {"substep_us", s.microseconds}};
}

Rows jenga_rows(const Jenga& s) {
  Rows rows = pile_rows(s.standing);
  rows.push_back({"after_middle_mm", 1e3 * s.after_middle});
  rows.push_back({"after_side_mm", 1e3 * s.after_side});
  return rows;
}

std::vector<Experiment> all_experiments() {
  return {
      compared(
          "sag", [](const Column& c) { return sag(c); }, sag_rows),
      compared(
          "rest_50g", [](const Column& c) { return rest(c, 0.05); }, rest_rows),
      compared(
          "rest_200g", [](const Column& c) { return rest(c, 0.2); }, rest_rows),
      compared("throw", throw_ball, throw_rows),
      compared(
          "reach", [](const Column& c) { return reach(c); }, reach_rows),
      compared(
          "flick", [](const Column& c) { return flick(c); }, flick_rows),
      absolute("limits", limits, limits_rows),
      absolute(
          "squeeze", [](const Column& c) { return squeeze(c, c.reference ? 1 : 20); }, squeeze_rows),
      compared("swing", swing, swing_rows),
      absolute("incline", incline, incline_rows),
      absolute("slide", slide, slide_rows),
      absolute("roll", roll, roll_rows),
      piled(
          "stack_5", [](const Column& c) { return stack(c, 5); }, pile_rows),
      piled(
          "stack_10", [](const Column& c) { return stack(c, 10); }, pile_rows),
      absolute("crash", crash, crash_rows),
      absolute("hinge", hinge, hinge_rows),
      absolute("fall", fall, fall_rows),
      piled("jenga", jenga, jenga_rows),
      sleeping(
          "stack_10_asleep", [](const Column& c) { return stack(c, 10); }, pile_rows),
      sleeping("jenga_asleep", jenga, jenga_rows),
  };
}

void print_value(const char* name, double value, bool first) {
  std::printf("%s\"%s\": ", first ? "" : ", ", name);
  if (std::isfinite(value))
    std::printf("%.6g", value);
  else
    std::printf("null");
}

// False when a column failed by anything but an engine that this build has not.
bool print_experiment(const Experiment& experiment, const std::vector<Column>& columns) {
  bool good = true;
  const Rows* any = nullptr;
  std::vector<std::optional<Rows>> cells;
  for (const Column& column : columns) {
    const double start = thread_seconds();
    std::optional<Rows> rows;
    try {
      rows = experiment.run(column);
    } catch (const Error& e) {
      if (e.code != Code::kUnsupported) {
        good = false;
        std::fprintf(stderr, "%s, %s: %s\n", experiment.name, column.name, e.text);
      }
    }
    if (rows) rows->push_back({"seconds", thread_seconds() - start});
    cells.push_back(std::move(rows));
  }
  for (const auto& cell : cells)
    if (cell) any = &*cell;
  std::printf("    \"%s\": {", experiment.name);
  for (size_t r = 0; any && r < any->size(); ++r) {
    std::printf("%s\n      \"%s\": {", r ? "," : "", (*any)[r].name.c_str());
    for (size_t c = 0; c < columns.size(); ++c)
      print_value(columns[c].name, cells[c] ? (*cells[c])[r].value : NAN, c == 0);
    std::printf("}");
  }
  std::printf("}");
  std::fflush(stdout);
  return good;
}

void print_columns(const std::vector<Column>& columns) {
  std::printf("  \"columns\": {\n");
  for (const Column& c : columns)
    std::printf("    \"%s\": {\"engine\": \"%s\", \"exact\": %s, \"h\": %.6g, \"iterations\": %d}%s\n",
                c.name, c.engine == EngineKind::kOde ? "ode" : "articulated",
                c.solver.exact ? "true" : "false", c.solver.h, c.solver.iterations,
                &c == &columns.back() ? "" : ",");
  std::printf("  },\n");
}

// Keeps those of `all` that `words` name, or all when none is named; counts in `used`.
template <class T>
std::vector<T> chosen(const std::vector<T>& all, int argc, char** argv, int* used) {
  std::vector<T> out;
  for (const T& item : all)
    for (int i = 1; i < argc; ++i)
      if (std::strcmp(argv[i], item.name) == 0) {
        out.push_back(item);
        ++*used;
      }
  return out.empty() ? all : out;
}

}  // namespace

int main(int argc, char** argv) {
  int used = 0;
  const auto columns = chosen(all_columns(), argc, argv, &used);
  const auto experiments = chosen(all_experiments(), argc, argv, &used);
  if (used != argc - 1) {
    std::fprintf(stderr, "bench_quality [experiment or column]...; columns:");
    for (const Column& c : all_columns()) std::fprintf(stderr, " %s", c.name);
    std::fprintf(stderr, "; experiments:");
    for (const Experiment& e : all_experiments()) std::fprintf(stderr, " %s", e.name);
    std::fprintf(stderr, "\n");
    return 2;
  }
  bool good = true;
  std::printf("{\n");
  print_columns(columns);
  std::printf("  \"experiments\": {\n");
  for (size_t i = 0; i < experiments.size(); ++i) {
    good &= print_experiment(experiments[i], columns);
    std::printf("%s\n", i + 1 < experiments.size() ? "," : "");
  }
  std::printf("  }\n}\n");
  return good ? 0 : 1;
}
