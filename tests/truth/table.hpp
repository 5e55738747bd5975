// The rows of the truth table: what was measured beside what is right, and whether it is near enough.
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace truth {

struct Row {
  Row(std::string called, double is, double within, std::string in = "", std::string beside = "")
      : name(std::move(called)),
        exact(is),
        tolerance(within),
        unit(std::move(in)),
        mujoco(std::move(beside)) {}
  std::string name;      // unique in the table
  double exact = 0;      // pencil and paper's, or MuJoCo's where `source` says so
  double tolerance = 0;  // |ours - exact| may be this
  std::string unit;      // of the three, "" for a ratio or a count
  std::string mujoco;    // what MuJoCo 2.2.2 is off by in the same case, with its step; "": not measured
  double ours = 0;
  std::string note;  // why there is no number
  std::string group;
};

enum class Verdict { kHeld, kOff, kPending, kHeldButPending };
bool is_pending(const std::string& row);  // pending.cpp: waits for what is not built yet
std::vector<std::string> pending_names();
Verdict verdict(const Row& row);

// What a check says. A measurement that throws makes a row without a number, which is off.
class Rows {
 public:
  explicit Rows(std::string group) : group_(std::move(group)) {}
  void add(Row row, double ours, const std::string& note = "");
  void add(Row row, const std::function<double()>& measure);
  void fail(const std::string& name, const std::string& why);
  const std::vector<Row>& all() const { return rows_; }

 private:
  std::string group_;
  std::vector<Row> rows_;
};

// One group of measurements that share simulations.
struct Check {
  std::string group;  // heading in the table
  std::string name;
  bool share;  // part of the default check: together less than a minute
  std::function<void(Rows&)> run;
};
using Checks = std::vector<Check>;

// One function per file.
void add_flight_and_spin(Checks& checks);
void add_chains(Checks& checks);
void add_friction(Checks& checks);
void add_resting(Checks& checks);
void add_tunnelling(Checks& checks);
void add_mass_ratios(Checks& checks);
void add_joints(Checks& checks);
void add_drives(Checks& checks);
void add_contact_laws(Checks& checks);
void add_sleepers(Checks& checks);
void add_ode(Checks& checks);
void add_statics(Checks& checks);
void add_convergence(Checks& checks);
// Success of the shipped policies at other substeps, by the tool: `redman eval`.
void add_skills(Checks& checks, const std::string& tool, const std::string& policies);

std::string print(double x);  // five digits that matter, the same text on every machine
std::string text(const char* format, ...) __attribute__((format(printf, 1, 2)));

}  // namespace truth
