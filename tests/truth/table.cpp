#include "table.hpp"

#include <cmath>
#include <cstdarg>
#include <cstdio>
#include <exception>

namespace truth {

Verdict verdict(const Row& row) {
  const bool held = std::fabs(row.ours - row.exact) <= row.tolerance;  // not for what is no number
  if (is_pending(row.name)) return held ? Verdict::kHeldButPending : Verdict::kPending;
  return held ? Verdict::kHeld : Verdict::kOff;
}

void Rows::add(Row row, double ours, const std::string& note) {
  row.ours = ours;
  row.note = note;
  row.group = group_;
  rows_.push_back(std::move(row));
}

void Rows::add(Row row, const std::function<double()>& measure) {
  double ours = std::nan("");
  std::string note;
  try {
    ours = measure();
  } catch (const std::exception& e) {
    note = e.what();
  }
  add(std::move(row), ours, note);
}

void Rows::fail(const std::string& name, const std::string& why) {
  add(Row(name, 0, 0), std::nan(""), why);
}

std::string print(double x) {
  if (std::isnan(x)) return "none";
  if (std::fabs(x) < 1e-12) x = 0;
  return text("%.5g", x);
}

std::string text(const char* format, ...) {
  char out[512];
  va_list args;
  va_start(args, format);
  std::vsnprintf(out, sizeof out, format, args);
  va_end(args);
  return out;
}

}  // namespace truth
